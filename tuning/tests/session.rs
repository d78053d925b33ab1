//! The loop: rounds, rules, log, best, budget, interruption and resumption.

use crate::support;

use msk_evaluate::{EpisodeRecord, Trial};
use msk_runtime::policy::PolicySource;
use msk_tuning::reasoner::{Proposal, Reasoner, ReasonerError, Request, RuleBook};
use msk_tuning::session::{Ended, KeptRules, Objective, OnFailure, Round, Session, SessionError, Settings, Watcher};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use support::trial;

fn settings() -> Settings {
    Settings {
        policy: PolicySource::built_in("random").unwrap(),
        seed: 3,
        interval: 25,
        rules: KeptRules { step: 0.2, norm: None },
        outside: vec![],
        objective: Objective::Survival,
        rounds: 3,
        steps: None,
        on_failure: OnFailure::Keep,
    }
}

/// Looks on, and interrupts at a step.
#[derive(Default)]
struct Looker {
    steps: AtomicU64,
    stop_at: Option<u64>,
    stop: AtomicBool,
}

impl Watcher for Looker {
    fn stepped(&self) {
        let steps = self.steps.fetch_add(1, Ordering::Relaxed) + 1;
        if self.stop_at == Some(steps) {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
    fn ended(&self, _: &EpisodeRecord) {}
    fn round(&self, _: &Round) {}
    fn asking(&self, _: &str) {}
}

type Answer = Result<Vec<(&'static str, f64)>, ReasonerError>;

/// Gives prepared answers, round after round.
struct Scripted(fn(&Request) -> Answer);

impl Reasoner for Scripted {
    fn name(&self) -> String {
        "says".into()
    }
    fn propose(&self, request: &Request, _: &AtomicBool) -> Result<Proposal, ReasonerError> {
        let weights = (self.0)(request)?.into_iter().map(|(term, weight)| (term.to_owned(), weight)).collect();
        Ok(Proposal { weights, reason: "because".into(), by: String::new() })
    }
}

fn open(folder: &Path, settings: Settings, trial: &Trial) -> Session {
    Session::open(folder, settings, trial.clone(), |message| panic!("{message}")).unwrap()
}

fn run(session: &mut Session, reasoner: &dyn Reasoner, threads: usize) -> Ended {
    let looker = Looker::default();
    session.run(reasoner, NonZeroUsize::new(threads).unwrap(), &looker.stop, &looker).unwrap()
}

/// The log without times.
fn timeless(folder: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("rounds.jsonl")).unwrap();
    let line = |line: &str| {
        let round: Round = serde_json::from_str(line).unwrap();
        serde_json::to_string(&Round { time: 0, ..round }).unwrap()
    };
    text.lines().map(line).collect()
}

#[test]
fn a_session_changes_weights_within_the_rules_and_logs_everything() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let out = folder.path().join("tune");
    let mut session = open(&out, settings(), &trial);
    // Far too much, a wrong sign, and one that is fixed.
    let reasoner = Scripted(|_| Ok(vec![("pose", 1000.0), ("effort", 5.0), ("wave", 9.0)]));
    assert_eq!(run(&mut session, &reasoner, 2), Ended::Budget);
    let rounds = session.rounds();
    assert_eq!(rounds.len(), 3);
    let weight = |round: usize, term: usize| rounds[round].weights[term].1;
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    for (round, growth) in [(0, 1.0), (1, 1.2), (2, 1.44)] {
        close(weight(round, 0), 10.0 * growth);
        close(weight(round, 2), -0.8_f64.powi(round as i32));
        assert_eq!((weight(round, 1), weight(round, 3)), (5.0, 2.0));
    }
    let first = &rounds[0];
    assert!(first.prompt.contains("Answer with data only") && first.rejected.is_none());
    assert_eq!(first.proposal.as_ref().unwrap().reason, "because");
    close(first.applied.as_ref().unwrap()[0].1, 12.0);
    assert!(first.statistics.steps >= 25 && first.statistics.steps < 35);
    // The last round is not followed by any: no reasoner is asked.
    assert!(rounds[2].proposal.is_none() && rounds[2].prompt.is_empty());
    // Episodes follow on each other, each with the version that rewarded it.
    assert_eq!((rounds[0].episodes[1], rounds[1].episodes[1]), (rounds[1].episodes[0], rounds[2].episodes[0]));
    let journal = std::fs::read_to_string(out.join("episodes.jsonl")).unwrap();
    for (index, line) in journal.lines().enumerate() {
        let record: EpisodeRecord = serde_json::from_str(line).unwrap();
        assert_eq!(record.episode, index as u64);
        let round = rounds.iter().find(|round| (round.episodes[0]..round.episodes[1]).contains(&record.episode)).unwrap();
        assert_eq!((&record.weights_version, &record.weights.0), (&round.version, &round.weights));
    }
    assert!(out.join("best.toml").exists());
    assert!(std::fs::read_to_string(out.join("weights.toml")).unwrap().starts_with("[lean]\npose = 14.3999"));
}

#[test]
fn one_interval_counts_the_steps_of_all_workers() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let logs = [1, 4].map(|threads| {
        let out = folder.path().join(format!("on-{threads}"));
        assert_eq!(run(&mut open(&out, settings(), &trial), &RuleBook, threads), Ended::Budget);
        timeless(&out)
    });
    assert_eq!(logs[0], logs[1], "a round is the same on any number of workers");
}

#[test]
fn an_interrupted_session_goes_on_to_the_same_end() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let whole = folder.path().join("whole");
    run(&mut open(&whole, settings(), &trial), &RuleBook, 2);
    let cut = folder.path().join("cut");
    for stop_at in [15, 22, 30] {
        let looker = Looker { stop_at: Some(stop_at), ..Looker::default() };
        let mut session = open(&cut, settings(), &trial);
        let ended = session.run(&RuleBook, NonZeroUsize::MIN, &looker.stop, &looker).unwrap();
        assert_eq!(ended, Ended::Interrupted);
    }
    assert_eq!(run(&mut open(&cut, settings(), &trial), &RuleBook, 2), Ended::Budget);
    assert_eq!(timeless(&cut), timeless(&whole));
    // And with a larger budget further.
    let mut session = open(&cut, Settings { rounds: 4, ..settings() }, &trial);
    assert_eq!(run(&mut session, &RuleBook, 2), Ended::Budget);
    assert_eq!(session.rounds().len(), 4);
}

#[test]
fn what_was_logged_and_not_yet_applied_is_applied_on_return() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let out = folder.path().join("tune");
    let one_more = Settings { rounds: 2, ..settings() };
    run(&mut open(&out, one_more.clone(), &trial), &RuleBook, 1);
    let log = std::fs::read_to_string(out.join("rounds.jsonl")).unwrap();
    let first: Round = serde_json::from_str(log.lines().next().unwrap()).unwrap();
    let next = first.next.unwrap();
    // As if the program had died after the first line of the log: the file is the one before, the journal has no more.
    std::fs::write(out.join("rounds.jsonl"), format!("{}\n{}", log.lines().next().unwrap(), &log.lines().nth(1).unwrap()[..40]))
        .unwrap();
    let store = msk_tuning::store::Store::open(&out.join("weights.toml")).unwrap();
    let before = store.history().unwrap().into_iter().find(|entry| entry.version == next.before).unwrap();
    std::fs::write(out.join("weights.toml"), before.text).unwrap();
    let mut session = open(&out, one_more, &trial);
    assert_eq!(store.read().unwrap().unwrap().text, next.text);
    assert_eq!(run(&mut session, &RuleBook, 1), Ended::Budget);
    assert_eq!(
        timeless(&out),
        log.lines()
            .map(|line| {
                let round: Round = serde_json::from_str(line).unwrap();
                serde_json::to_string(&Round { time: 0, ..round }).unwrap()
            })
            .collect::<Vec<_>>()
    );
}

#[test]
fn a_reasoner_that_fails_is_logged_and_the_session_goes_on_or_stops_as_set() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let fails = Scripted(|request| match request.round {
        1 => Err(ReasonerError::Refuses("not today".into())),
        2 => Ok(vec![("pose", f64::NAN)]),
        _ => Ok(vec![("pose", 11.0)]),
    });
    let keep = folder.path().join("keep");
    let mut session = open(&keep, Settings { rounds: 4, ..settings() }, &trial);
    assert_eq!(run(&mut session, &fails, 1), Ended::Budget);
    let rejected: Vec<_> = session.rounds().iter().map(|round| round.rejected.clone().unwrap_or_default()).collect();
    assert!(rejected[0].contains("not today") && rejected[1].contains("not a number from -1e9 to 1e9"), "{rejected:?}");
    let pose: Vec<f64> = session.rounds().iter().map(|round| round.weights[0].1).collect();
    assert_eq!(pose, [10.0, 10.0, 10.0, 11.0], "the weights stay");

    let stop = folder.path().join("stop");
    let mut session = open(&stop, Settings { on_failure: OnFailure::Stop, ..settings() }, &trial);
    assert_eq!(run(&mut session, &fails, 1), Ended::Failed);
    assert_eq!(session.rounds().len(), 1);
}

#[test]
fn a_fixed_norm_is_kept_inside_the_scope() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let kept = Settings { rules: KeptRules { step: 0.2, norm: Some(30.0) }, outside: vec!["effort".into()], ..settings() };
    let mut session = open(&folder.path().join("tune"), kept, &trial);
    run(&mut session, &Scripted(|_| Ok(vec![("pose", 30.0), ("alive", 10.0)])), 1);
    for round in session.rounds() {
        let [pose, alive, effort, wave] = [0, 1, 2, 3].map(|term| round.weights[term].1);
        assert!((pose + alive - 30.0).abs() < 1e-9, "{pose} {alive}");
        assert_eq!((effort, wave), (-1.0, 2.0));
    }
    // 20 and 10 at first. `pose` wishes for more than a step, `alive` to stay: the sizes are shifted by 8, and 8 is as far
    // as `alive` may go down.
    let first = &session.rounds()[0];
    assert!((first.weights[0].1 - 20.0).abs() < 1e-9);
    assert!((first.applied.as_ref().unwrap()[0].1 - 22.0).abs() < 1e-9, "{first:?}");
}

#[test]
fn another_session_and_senseless_settings_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let out = folder.path().join("tune");
    drop(open(&out, settings(), &trial));
    let refused = |settings: Settings| match Session::open(&out, settings, trial.clone(), |_| {}) {
        Ok(_) => panic!("it was accepted"),
        Err(error) => error.to_string(),
    };
    assert!(refused(Settings { interval: 60, ..settings() }).contains("its interval is 25, not 60"));
    assert!(refused(Settings { seed: 4, ..settings() }).contains("seed is 3, not 4"));
    assert!(refused(Settings { interval: 0, ..settings() }).contains("at least 1"));
    assert!(refused(Settings { rules: KeptRules { step: 1.5, norm: None }, ..settings() }).contains("at most 1"));
    assert!(refused(Settings { outside: vec!["psoe".into()], ..settings() }).contains("did you mean `pose`"));
    assert!(refused(Settings { objective: Objective::parse("-sway"), ..settings() }).contains("it logs: pelvis.height"));
    let far = Settings { rules: KeptRules { step: 0.2, norm: Some(500.0) }, ..settings() };
    assert!(refused(far).contains("may be 5..30"));
    let _first = open(&out, settings(), &trial);
    assert!(matches!(Session::open(&out, settings(), trial.clone(), |_| {}), Err(SessionError::Journal(_))), "one at a time");
}

#[test]
fn a_journal_without_the_episodes_of_a_round_is_reported_with_the_first_that_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let out = folder.path().join("tune");
    run(&mut open(&out, settings(), &trial), &RuleBook, 1);
    let journal = std::fs::read_to_string(out.join("episodes.jsonl")).unwrap();
    let lines: Vec<&str> = journal.split_inclusive('\n').collect();
    for lost in [0, lines.len() - 1] {
        let kept: String = lines.iter().enumerate().filter(|(index, _)| *index != lost).map(|(_, line)| *line).collect();
        std::fs::write(out.join("episodes.jsonl"), kept).unwrap();
        let error = Session::open(&out, Settings { rounds: 5, ..settings() }, trial.clone(), |_| {}).err().unwrap();
        assert!(matches!(error, SessionError::Episodes { missing, .. } if missing == lost as u64), "{error}");
    }
}
