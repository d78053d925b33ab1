//! `play`: the body as a motion has it, for a while.
//!
//! A motion that is played becomes two keyframes: from the first to the second its table is followed, joints by name, the root
//! along its path from where the root stands, in the direction in which it faces. What the changes of the statement set, they set
//! for all of that time.

use super::{Draft, Key};
use crate::check::context::{Checked, Checker, Reported};
use crate::check::dimension::Dimension;
use crate::diagnostics::codes;
use crate::extremes::between;
use crate::graph::NodeId;
use crate::init::{Following, Parts, Path, Start};
use crate::motion::{Motion, RootPart, problems};
use crate::numbers::for_people;
use crate::resolve::scope::{Declared, Definition};
use crate::syntax::tree::{Change, ExprKind, Played, Playing};
use crate::task::{Init, Setting};
use std::sync::Arc;

impl<'a> Checker<'a> {
    /// Gives the step at which it ends: `at 1 s play motion "walk.csv" start 25 % for 2 s { root.heading = 90 deg }`
    pub(super) fn play(&mut self, playing: &'a Playing, draft: &mut Draft, drawn: &mut Vec<NodeId>) -> Checked<u32> {
        let step = match &playing.time {
            Some(time) => self.next_step(time, draft)?,
            None if draft.keys.is_empty() && draft.is_open() => 0,
            None => {
                let message = "a motion after others needs a start time";
                let diagnostic = self.diagnostic(codes::tests::TEST_ORDER, playing.span, message);
                return Err(self.report(diagnostic.help("write `at 2 s play ...`")));
            }
        };
        let mut scene = draft.latest().clone();
        let set = self.situation(&playing.situation, &mut scene)?;
        let (motion, start, after) = self.played_motion(playing, step, drawn)?;
        let steps = self.played_for(playing, &motion, start)?;
        let assigned = assigned_root_parts(playing);
        let parts = self.played_parts(&motion, &set, &assigned);
        let moves = [RootPart::X, RootPart::Y].iter().any(|part| parts.root.contains(part));
        if moves {
            self.must_stand_somewhere(playing, &scene.init)?;
        }
        forget(&mut scene.init, &parts);
        let path = Path { begun: after, origin: scene.init.root.position, heading: scene.course };
        let mut following = Following { motion, start, after, parts, path: Some(path) };
        if step > 0 && draft.keys.is_empty() {
            draft.keys.push(Key::still(0, draft.begins.clone()));
        }
        let mut last = scene.clone();
        scene.init.follows = Some(following.clone());
        draft.keys.push(Key { step, scene, plays: true });
        following.after += f64::from(steps) * self.timing.interval;
        match start {
            // What comes later begins where the motion has ended.
            Start::Phase(phase) => {
                following.write(phase, 0.0, &mut last.init);
                last.init.velocities.clear();
            }
            Start::Drawn(_) => last.init.follows = Some(following),
        }
        let end = step.saturating_add(steps);
        self.must_be_seen(end, playing.span)?;
        draft.keys.push(Key::still(end, last));
        Ok(end)
    }

    /// The motion, the phase at which it was entered, and how long ago (s) that is when it begins to play.
    fn played_motion(&mut self, playing: &'a Playing, step: u32, drawn: &mut Vec<NodeId>) -> Checked<(Arc<Motion>, Start, f64)> {
        match &playing.motion {
            Played::File(path) => {
                let start = match &playing.start {
                    Some(start) => self.fixed_number(start, Dimension::NONE, "`start`")?,
                    None => 0.0,
                };
                if let (false, Some(written)) = ((0.0..=1.0).contains(&start), &playing.start) {
                    let diagnostic = self
                        .diagnostic(codes::composition::MOTION, written.span, "a motion starts at a constant or random phase")
                        .expected("a number from 0 to 1")
                        .found(for_people(start));
                    return Err(self.report(diagnostic));
                }
                let table = self.table(self.place.file, path)?;
                let problems = problems(&table.motion, table.file, self.vocabulary);
                let misfit = Reported::among(&problems);
                // A motion that a reference follows as well is reported once.
                if !self.diagnostics.iter().any(|diagnostic| problems.contains(diagnostic)) {
                    self.diagnostics.extend(problems);
                }
                misfit.map_or(Ok((table.motion, Start::Phase(start), 0.0)), Err)
            }
            Played::Reference(name) => {
                let declared = self.names.find(self.place, &name.text);
                if !matches!(declared, Some((Declared { definition: Definition::Reference(_), .. }, _))) {
                    let known = self.references.iter().map(|known| known.name.clone()).collect();
                    return Err(self.unknown_name(&name.text, name.span, known));
                }
                let known = self.known_reference(&name.text, name.span)?;
                let known = self.references[known].clone();
                if let Some(start) = &playing.start {
                    let message = "a reference determines its own phase at every time";
                    let diagnostic = self.diagnostic(codes::composition::MOTION, start.span, message);
                    return Err(self.report(diagnostic.help("play its table to choose a phase: `play motion \"...\" start 0.5`")));
                }
                let start = match self.graph.constant_value(known.start) {
                    Some(phase) => Start::Phase(phase),
                    None => {
                        let place = drawn.iter().position(|node| *node == known.start).unwrap_or(drawn.len());
                        if place == drawn.len() {
                            drawn.push(known.start);
                        }
                        Start::Drawn(place)
                    }
                };
                Ok((known.motion, start, f64::from(step) * self.timing.interval))
            }
        }
    }

    /// For how many control steps it is played: as long as written, else one turn of a cycle, or up to the motion's end.
    fn played_for(&mut self, playing: &'a Playing, motion: &Motion, start: Start) -> Checked<u32> {
        let steps = match &playing.duration {
            Some(duration) => self.script_step(duration)?,
            None => {
                let rest = match start {
                    Start::Phase(phase) if !motion.cycle => 1.0 - phase,
                    _ => 1.0,
                };
                // As many steps as reach the end.
                between((rest * motion.duration / self.timing.interval - 1e-9).ceil(), 0.0, 1e7) as u32
            }
        };
        if steps > 0 {
            return Ok(steps);
        }
        let span = playing.duration.as_ref().map_or(playing.span, |duration| duration.span);
        Err(self.error(codes::tests::TEST_ORDER, span, "`play` takes a duration"))
    }

    /// What the scene takes from a motion: all that it moves but for what the changes set.
    fn played_parts(&self, motion: &Motion, set: &[bool], assigned: &[RootPart]) -> Parts {
        let joints = self.vocabulary.joints.iter().enumerate();
        let moved = joints.filter(|(index, joint)| joint.independent && !set.get(*index).copied().unwrap_or(false));
        Parts {
            joints: moved.filter_map(|(index, joint)| Some((index, motion.joint(&joint.name)?))).collect(),
            root: RootPart::ALL.into_iter().filter(|part| motion.root(*part).is_some() && !assigned.contains(part)).collect(),
            velocity: false,
        }
    }

    /// A path begins somewhere, which must be known while compiling.
    fn must_stand_somewhere(&mut self, playing: &'a Playing, init: &Init) -> Checked<()> {
        let drawn = |(setting, _): &(Setting, usize)| matches!(setting, Setting::RootPosition(_) | Setting::RootHeading);
        let on_a_path = init.follows.as_ref().is_some_and(|following| following.path.is_some());
        if init.root.meets.is_empty() && !init.drawn.iter().any(drawn) && !on_a_path {
            return Ok(());
        }
        let message = "the start of the path of this motion is not known at compile time";
        let diagnostic = self
            .diagnostic(codes::composition::MOTION, playing.span, message)
            .help("set it: `play ... { root.at = [0 m, 0 m], root.heading = 0 deg }`");
        Err(self.report(diagnostic))
    }
}

/// Parts of the root that the changes decide; `at` and `heading` set where the path begins.
fn assigned_root_parts(playing: &Playing) -> Vec<RootPart> {
    let named = playing.situation.changes.iter().filter_map(|change| {
        let Change::Assign(assignment) = change else { return None };
        let ExprKind::Field { base, name } = &assignment.target.kind else { return None };
        let of_root = matches!(&base.kind, ExprKind::Name(word) if word.text == "root");
        of_root.then_some(name.text.as_str())
    });
    named
        .filter_map(|name| match name {
            "height" | "lift" => Some(RootPart::Height),
            "pitch" => Some(RootPart::Pitch),
            "roll" => Some(RootPart::Roll),
            _ => None,
        })
        .collect()
}

/// What the motion moves is no longer drawn, and follows no other motion.
fn forget(init: &mut Init, parts: &Parts) {
    let moved = |setting: &Setting| match setting {
        Setting::Coordinate(joint) => parts.joints.iter().any(|(known, _)| known == joint),
        Setting::RootHeight => parts.root.contains(&RootPart::Height),
        Setting::RootPosition(_) | Setting::RootHeading => true,
        Setting::RootPitch => parts.root.contains(&RootPart::Pitch),
        Setting::RootRoll => parts.root.contains(&RootPart::Roll),
        _ => false,
    };
    init.drawn.retain(|(setting, _)| !moved(setting));
    parts.joints.iter().for_each(|(joint, _)| init.release(Setting::Coordinate(*joint)));
    init.follows = None;
    init.velocities.clear();
}
