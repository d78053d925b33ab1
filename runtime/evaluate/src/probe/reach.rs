//! What no pose reaches: thresholds, ends and success that never hold or never fail, terms that never contribute or always do.
//!
//! Many poses are drawn (`poses`), always the same ones; what all of them decide alike is searched for, from the pose that comes
//! nearest, by small changes. What is then still decided alike is reported with the numbers that were met.

use super::at;
use super::poses::Room;
use super::search::{Goal, Range, Search, Shown, Tally};
use msk_compiler::diagnostics::codes::probing;
use msk_compiler::diagnostics::{Code, Diagnostic, FileId, Span};
use msk_compiler::survey::{About, Subject, Survey};
use msk_physics::scalar::Real;
use msk_program::frame::Sensor;
use msk_program::numbers::for_people;
use msk_program::spoken::SpokenUnit;
use msk_program::task::CompiledTask;
use msk_runtime::episode::{EpisodeKey, Stream};
use std::collections::{BTreeMap, BTreeSet};

/// How many poses are drawn.
const POSES: usize = 200;
/// A term contributes nothing where it is below this part of its highest value, or of 1.
const NOTHING: f64 = 1e-3;
/// A length of a body that stands just misses its threshold if it does by less than this, m, ...
const JUST: f64 = 0.05;
/// ... in so many of the poses that stand, ...
const OFTEN: f64 = 0.2;
/// ... which miss it alike, m.
const AS_NEAR: f64 = 0.01;
/// Several comparisons that cannot be met together must miss each other by so much, m or rad.
const TOGETHER: f64 = 0.1;
/// A term that always contributes more than this part of its range can hardly be earned.
const MOST: f64 = 0.5;

/// Poses of a body in a scene, always the same.
pub(super) fn draw(room: &mut Room<'_>) -> Vec<Shown> {
    let mut chance = Stream::new(EpisodeKey::default(), "probe/poses");
    let mut shown = Vec::new();
    for _ in 0..POSES {
        let pose = room.draw(&mut chance);
        if room.show(&pose) {
            shown.push(Shown { frame: room.frame.clone(), stands: room.stands(&pose), pose });
        }
    }
    shown
}

/// Contacts of which the poses show both that there is one and that there is none.
fn trusted(survey: &Survey<'_>, shown: &[Shown]) -> BTreeSet<Sensor> {
    let both = |offset: usize| {
        let touching = shown.iter().filter(|shown| shown.frame[offset] != 0.0).count();
        touching > 0 && touching < shown.len()
    };
    survey.contacts().filter(|(_, offset)| both(*offset)).map(|(sensor, _)| sensor).collect()
}

/// A comparison of which is known in which way it is decided, if it is.
struct Verdict {
    /// It never holds, or never fails; `None` if both were met.
    never: Option<bool>,
    message: String,
}

/// Looks at all phases of a task in the poses `shown`; `begins` are records of initial states.
pub(super) fn probe(task: &CompiledTask, room: &mut Room<'_>, shown: &[Shown], begins: &[Vec<f64>]) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    let mut comparisons: BTreeMap<(FileId, Span), Vec<Verdict>> = BTreeMap::new();
    let begins_standing = room.begins_standing();
    for phase in 0..Survey::phases(task) {
        let Some(mut survey) = Survey::new(task, phase) else { continue };
        let trusted = trusted(&survey, shown);
        let mut tallies = vec![Tally::default(); survey.subjects().len()];
        for (place, shown) in shown.iter().enumerate() {
            survey.look(&shown.frame, &trusted);
            for (subject, tally) in tallies.iter_mut().enumerate() {
                tally.see(&survey, subject, place, shown.stands);
            }
        }
        for frame in begins.iter().filter(|_| phase == 0) {
            survey.look(frame, &trusted);
            for (subject, tally) in tallies.iter_mut().enumerate() {
                tally.see(&survey, subject, 0, false);
            }
        }
        let standing = begins_standing && phase == 0;
        let mut search = Search { room: &mut *room, survey: &mut survey, trusted: &trusted, looked: shown.len() };
        let mut decided = Vec::new();
        // Comparisons come last, and a condition that reads a reported one is not reported itself.
        for subject in (0..tallies.len()).rev() {
            let about = search.survey.subjects()[subject].clone();
            let tally = &mut tallies[subject];
            if about.range.single().is_some() {
                continue;
            }
            let verdict = match about.about {
                About::Term(_) => term(&mut search, subject, &about, tally, shown, standing),
                _ => condition(&mut search, subject, &about, tally, shown)
                    .or_else(|| standing.then(|| missed_on_feet(&mut search, subject, &about, tally, shown)).flatten()),
            };
            if about.about == About::Comparison {
                let never = verdict.as_ref().map(|verdict| verdict.1);
                let message = verdict.map_or(String::new(), |verdict| verdict.2);
                decided.extend(never.is_some().then_some(subject));
                comparisons.entry(about.at).or_default().push(Verdict { never, message });
            } else if let Some((code, _, message)) = verdict
                && !decided.iter().any(|known| search.survey.reads(subject, *known))
            {
                diagnostics.push(warning(code, &about, named(task, &about) + &message));
            }
        }
    }
    for (place, verdicts) in comparisons {
        // A formula of a library is reported only where it is never reached by any caller.
        let Some(first) = verdicts.first().filter(|first| verdicts.iter().all(|other| other.never == first.never)) else {
            continue;
        };
        if first.never.is_some() {
            diagnostics.push(unreached(place, first.message.clone()));
        }
    }
    diagnostics
}

fn unreached(place: (FileId, Span), message: String) -> Diagnostic {
    at(probing::UNREACHED, place, message)
        .help("look for a wrong landmark, unit or sign; if it is intended, write `allow unreached \"...\"`")
}

/// What a subject is called in messages.
fn named(task: &CompiledTask, subject: &Subject) -> String {
    match subject.about {
        About::Term(index) => format!("the term `{}`", task.terms[index].name),
        About::Termination(index) => format!("the termination `{}`", task.terminations[index]),
        About::Finish(index) => format!("the reason to finish `{}`", task.finishes[index]),
        About::Success => "success".to_owned(),
        About::Comparison => "this".to_owned(),
    }
}

fn warning(code: &'static Code, subject: &Subject, message: String) -> Diagnostic {
    let help = if code == probing::ALWAYS_REWARDED {
        "reward something that can be missed, or write `allow always_rewarded \"...\"`".to_owned()
    } else {
        let lint = code.lint.map_or(code.id, |lint| lint.name);
        format!("look for a wrong landmark, unit or sign; if it is intended, write `allow {lint} \"...\"`")
    };
    at(code, subject.at, message).help(help)
}

type Finding = (&'static Code, bool, String);

/// A condition that never holds or never fails.
fn condition(
    search: &mut Search<'_, '_, '_, '_>,
    subject: usize,
    about: &Subject,
    tally: &mut Tally,
    shown: &[Shown],
) -> Option<Finding> {
    for wanted in [true, false] {
        let (lack, place) = if wanted { tally.to_hold } else { tally.to_fail };
        let Some(start) = place.and_then(|place| shown.get(place)).filter(|_| lack > 0.0) else { continue };
        let looked = search.looked;
        if search.run(subject, Goal::Hold(wanted), start, false, tally) {
            continue;
        }
        // What only fails together may yet be met by poses that are hard to find.
        let missing = if wanted { tally.to_hold.0 } else { tally.to_fail.0 };
        if about.about != About::Comparison && missing < TOGETHER {
            continue;
        }
        return Some((probing::UNREACHED, wanted, decided(about, tally, wanted, search.looked - looked + shown.len(), "poses")));
    }
    None
}

/// A length that just misses its threshold in every pose that stands, as that of an ankle above a flat foot: poses that lie may
/// reach it, but they are not what is meant.
fn missed_on_feet(
    search: &mut Search<'_, '_, '_, '_>,
    subject: usize,
    about: &Subject,
    tally: &mut Tally,
    shown: &[Shown],
) -> Option<Finding> {
    if about.about != About::Comparison || about.unit.si != "m" {
        return None;
    }
    for wanted in [true, false] {
        let gaps = tally.on_feet[usize::from(!wanted)].clone();
        let nearest = gaps.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let near = gaps.iter().filter(|(gap, _)| *gap < nearest.0 + AS_NEAR).count();
        let just = 0.0 < nearest.0 && nearest.0 < JUST && near as f64 > OFTEN * gaps.len() as f64;
        let Some(start) = shown.get(nearest.1).filter(|_| just) else { continue };
        let looked = search.looked;
        // Only what stands counts now.
        let mut standing = Tally::default();
        for (_, place) in &gaps {
            search.survey.look_at(subject, &shown[*place].frame, search.trusted);
            standing.see(search.survey, subject, *place, true);
        }
        if !search.run(subject, Goal::Hold(wanted), start, true, &mut standing) {
            let poses = search.looked - looked + gaps.len();
            return Some((
                probing::UNREACHED,
                wanted,
                decided(about, &standing, wanted, poses, "poses with a flat foot on the ground"),
            ));
        }
    }
    None
}

/// In which way a condition is decided, in words.
fn decided(about: &Subject, tally: &Tally, wanted: bool, count: usize, poses: &str) -> String {
    let word = if wanted { "holds in none" } else { "fails in none" };
    if about.about != About::Comparison {
        return format!(" {word} of {count} {poses}");
    }
    let [left, right] = tally.sides.map(|side| between(side, &about.unit));
    format!("this {word} of {count} {poses}: {left} on the left, {right} on the right")
}

/// `0.2 to 1.2 m`
fn between([low, high]: [f64; 2], unit: &SpokenUnit) -> String {
    let amount = |value: f64| for_people(unit.amount(value));
    unit.with_unit(&if high - low < 1e-4 { amount(low) } else { format!("{} to {}", amount(low), amount(high)) })
}

/// `0`, `3e-20`
fn amount(value: f64) -> String {
    for_people(value.at_least(0.0))
}

/// A term that never contributes or always does.
fn term(
    search: &mut Search<'_, '_, '_, '_>,
    subject: usize,
    about: &Subject,
    tally: &mut Tally,
    shown: &[Shown],
    standing: bool,
) -> Option<Finding> {
    let largest = about.range.high.at_least(-about.range.low);
    let nothing = NOTHING * if largest.is_finite() { largest } else { 1.0 };
    let start = |place: Option<usize>| place.and_then(|place| shown.get(place));
    let sized = |range: &Range| start(if range.high.0 >= -range.low.0 { range.high.1 } else { range.low.1 });
    if tally.all.size() < nothing {
        let begin = if tally.all.size() > 0.0 { sized(&tally.all) } else { start(tally.to_hold.1) }?;
        let looked = search.looked;
        let reached = search.run(subject, Goal::Reward(nothing), begin, false, tally);
        // What only fails together may yet be met by poses that are hard to find.
        if reached || (tally.all.size() <= 0.0 && tally.to_hold.0 < TOGETHER) {
            return None;
        }
        let poses = search.looked - looked + shown.len();
        let message = format!(" is {} at most in {poses} poses: it contributes nothing", amount(tally.all.size()));
        return Some((probing::NEVER_REWARDED, true, message));
    }
    if !standing || about.reads_ends || tally.standing.high.1.is_none() {
        return None;
    }
    let half = about.range.low + MOST * (about.range.high - about.range.low);
    if half.is_finite() && tally.standing.low.0 > half {
        let begin = start(tally.standing.low.1)?;
        let looked = search.looked;
        if !search.run(subject, Goal::Less(half), begin, true, tally) {
            let (low, high) = (tally.standing.low.0, about.range.high);
            let poses = search.looked - looked + shown.iter().filter(|shown| shown.stands).count();
            let message = format!(
                " is at least {} of {} in {poses} poses with a flat foot on the ground: it rewards almost any behaviour",
                for_people(low),
                for_people(high)
            );
            return Some((probing::ALWAYS_REWARDED, true, message));
        }
    }
    None
}
