//! One episode of a test.

use super::TestError;
use super::returns::{Returns, Tally};
use crate::rollout::Rollout;
use msk_physics::Workspace;
use msk_program::task::TaskState;
use msk_program::testing::{Run, Take};
use msk_runtime::episode::{Ending, Environment, EpisodeKey};
use msk_runtime::policy::{self, PolicyError, PolicySource};
use msk_runtime::script::Script;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

/// What an episode of a test has shown.
#[derive(Debug, Clone)]
pub(super) struct Played {
    /// What was seen at the steps that were asked for, as far as they were reached.
    kept: Vec<(u32, Seen)>,
    /// What was seen at the last step.
    pub(super) last: Seen,
    /// What was seen of each episode of a moment that is only reset; empty if it is played.
    pub(super) resets: Vec<Seen>,
    /// Its number.
    pub steps: u32,
    /// How it ended; `None` where the take was over before the task.
    pub ending: Option<Ending>,
    /// What it has earned, played as far as it was.
    pub returns: Returns,
}

/// How far a take is played.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    /// As far as the script goes.
    Until,
    /// Until the task ends it, or its horizon: what it earns is compared.
    Horizon,
}

/// What was seen at a step.
#[derive(Debug, Clone)]
pub(super) struct Seen {
    /// Which phase of a sequence was present; 0 in a task by itself.
    pub phase: usize,
    /// Empty where a fault came before.
    pub metrics: Vec<f64>,
}

impl Seen {
    fn now(episode: &Environment) -> Self {
        let report = episode.report();
        Self { phase: report.phase as usize, metrics: report.metrics.clone() }
    }
}

impl Played {
    /// Which episodes the moment has: those that were reset, or the one that was played.
    pub(super) fn episodes(&self) -> usize {
        self.resets.len().max(1)
    }

    /// What was seen of an episode; of one that was played, as of [`Self::seen`].
    pub(super) fn seen_of(&self, episode: usize, step: Option<u32>) -> Option<&Seen> {
        if self.resets.is_empty() { self.seen(step) } else { self.resets.get(episode) }
    }

    /// What was seen at a step, or at the last; `None` if it was not reached or a fault came before.
    pub(super) fn seen(&self, step: Option<u32>) -> Option<&Seen> {
        let found = match step {
            None => Some(&self.last),
            Some(step) => self.kept.iter().find(|(known, _)| *known == step).map(|(_, seen)| seen),
        };
        found.filter(|seen| !seen.metrics.is_empty())
    }
}

/// Plays a take, with the policy that is tested if there is one; metrics are kept at the `wanted` steps. `look` sees the environment after its
/// reset and after every control step of what is played.
pub(super) fn play(
    episode: &mut Environment,
    take: &Take,
    wanted: BTreeSet<u32>,
    (extent, tested): (Extent, Option<&PolicySource>),
    look: &mut dyn FnMut(&Environment),
) -> Result<Played, TestError> {
    let mut playing = Playing::begin(episode, take, wanted, (extent, tested));
    if take.resets.is_none() {
        look(episode);
    }
    while playing.advance(episode, look)? {}
    Ok(playing.finish(episode))
}

/// A take that is being played, always in the same environment.
pub(super) struct Playing<'a> {
    script: Option<Script>,
    run: Option<Run>,
    /// The policy that is tested.
    tested: Option<&'a PolicySource>,
    /// When the script is over, and when all is: control steps.
    ends: [u32; 2],
    /// Whether a pose waits for its forward pass.
    posed: bool,
    watch: Watch,
    resets: Vec<Seen>,
}

impl<'a> Playing<'a> {
    /// Resets the environment. The end that is reported is that of the time that the take gives, however far it is played.
    pub(super) fn begin(
        episode: &mut Environment,
        take: &Take,
        wanted: BTreeSet<u32>,
        (extent, tested): (Extent, Option<&'a PolicySource>),
    ) -> Self {
        let task = episode.task().clone();
        let until = take.until.unwrap_or(task.horizon);
        let mut playing = Self {
            script: None,
            run: take.run.clone().filter(|_| take.resets.is_none()),
            tested,
            ends: [0; 2],
            posed: false,
            watch: Watch { wanted, until, kept: Vec::new(), over: None, tally: Tally::new(&task) },
            resets: Vec::new(),
        };
        match take.resets {
            Some(count) => playing.resets = reset(episode, take, count),
            None => {
                playing.script = begin(episode, take, EpisodeKey::default());
                let end = if extent == Extent::Horizon { task.horizon } else { until };
                playing.ends = [take.run.as_ref().map_or(end, |run| run.from), end];
                playing.watch.begin(episode);
            }
        }
        playing
    }

    /// Goes on until a pose waits for its [forward pass](msk_runtime::episode::PassGroup::pass); gives whether one does, else the take is
    /// over.
    pub(super) fn advance(&mut self, episode: &mut Environment, look: &mut dyn FnMut(&Environment)) -> Result<bool, TestError> {
        let [script_ends, end] = self.ends;
        if std::mem::take(&mut self.posed) {
            episode.evaluate_pose();
            self.watch.step(episode);
            look(episode);
        }
        while episode.ending().is_none() && episode.steps() < script_ends {
            let next = episode.steps() + 1;
            // Two steps after the last keyframe nothing changes any more but time.
            if let Some(script) = self.script.as_ref().filter(|script| next <= script.last() + 2) {
                episode.pose(&mut |model, body, state, workspace| script.place(next, model, body, state, workspace))?;
                self.posed = true;
                return Ok(true);
            }
            episode.hold()?;
            self.watch.step(episode);
            look(episode);
        }
        if let Some(run) = self.run.take().filter(|_| episode.ending().is_none()) {
            episode.end_script();
            // A process that does not answer is given up at its time limit.
            let stop = AtomicBool::new(false);
            let mut policy = match run.is_of_given_policy() {
                true => self.tested.ok_or(PolicyError::NotGiven)?.open(&stop)?,
                false => policy::create(&run.policy)?,
            };
            let mut rollout = Rollout::resume(episode, policy.as_mut())?;
            while rollout.episode.ending().is_none() && rollout.episode.steps() < end {
                rollout.step::<TestError>()?;
                self.watch.step(rollout.episode);
                look(rollout.episode);
            }
        }
        Ok(false)
    }

    /// What a take that is over has shown.
    pub(super) fn finish(self, episode: &Environment) -> Played {
        let Self { watch, resets, .. } = self;
        let (last, steps, ending) = watch.over.unwrap_or_else(|| over(episode));
        Played { kept: watch.kept, last, resets, steps, ending, returns: watch.tally.finish(episode) }
    }
}

/// Resets the first episodes of seed 0, up to one that meets a fault: what was seen of each.
fn reset(episode: &mut Environment, take: &Take, count: u32) -> Vec<Seen> {
    let mut resets = Vec::new();
    for number in 0..count {
        episode.reset_given(EpisodeKey { episode: number.into(), ..EpisodeKey::default() }, &take.given);
        resets.push(Seen::now(episode));
        if episode.ending().is_some() {
            break;
        }
    }
    resets
}

/// What is looked at while a take is played.
struct Watch {
    /// At these steps metrics are kept.
    wanted: BTreeSet<u32>,
    /// When the take is over by its own account.
    until: u32,
    kept: Vec<(u32, Seen)>,
    /// What was there then.
    over: Option<(Seen, u32, Option<Ending>)>,
    tally: Tally,
}

impl Watch {
    fn begin(&mut self, episode: &Environment) {
        if self.wanted.contains(&0) && episode.ending().is_none() {
            self.kept.push((0, Seen::now(episode)));
        }
    }

    fn step(&mut self, episode: &Environment) {
        self.tally.add(episode);
        if self.wanted.contains(&episode.steps()) && !episode.report().metrics.is_empty() {
            self.kept.push((episode.steps(), Seen::now(episode)));
        }
        if self.over.is_none() && episode.steps() == self.until {
            self.over = Some(over(episode));
        }
    }
}

fn over(episode: &Environment) -> (Seen, u32, Option<Ending>) {
    (Seen::now(episode), episode.steps(), episode.ending().cloned())
}

/// Begins with the script, or as the task does where there is none.
pub(super) fn begin(episode: &mut Environment, take: &Take, key: EpisodeKey) -> Option<Script> {
    if take.script.is_empty() {
        episode.reset_given(key, &take.given);
        return None;
    }
    let context = episode.context();
    let (model, body, task) = (context.model.clone(), context.body.clone(), episode.task().clone());
    let script = std::cell::OnceCell::new();
    let mut prepare = |drawn: &TaskState, scratch: &mut Workspace<f64>| {
        // Called once, before anything is placed.
        let _ = script.set(Script::new(&take.script, &task, drawn, &model, &body, scratch));
    };
    episode.reset_playing(key, &take.given, &mut prepare, &mut |model, body, state, workspace| {
        let activation = match script.get() {
            Some(Ok(script)) => script.place(0, model, body, state, workspace)?,
            Some(Err(out_of_reach)) => return Err(out_of_reach.clone()),
            None => 0.0,
        };
        if let (true, Some(first)) = (take.run.is_some() && take.script.len() == 1, take.script.first()) {
            body.launch(&first.init, state);
        }
        Ok(activation)
    });
    script.into_inner()?.ok()
}
