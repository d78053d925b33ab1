//! An episode of doing nothing: a task whose reward or success `zero` gets is not learnt.
//!
//! Every muscle rests, whatever the action space, for one episode, to its end or for [`MOST_STEPS`]. That must not succeed. The policy
//! `cmc` holds the pose for as many steps: a task in which resting earns more per step rewards giving up.

use super::at;
use crate::EvaluationError;
use crate::rollout::Rollout;
use msk_compiler::diagnostics::codes::probing;
use msk_compiler::diagnostics::{Diagnostic, Stage, allowance};
use msk_program::numbers::for_people;
use msk_program::task::CompiledTask;
use msk_runtime::action::REST;
use msk_runtime::episode::{Ending, Environment, EpisodeKey};
use msk_runtime::library::BodyLibrary;
use msk_runtime::policy::{ActsOn, ComputedMuscleControl, Policy, PolicyContext, PolicyError};
use rayon::prelude::*;
use std::sync::Arc;

/// Control steps that are played at most.
const MOST_STEPS: u32 = 3000;

/// Resting earns more than holding the pose if it does by this part of what holding earns.
const MARGIN: f64 = 0.05;

/// Plays an episode of each task at rest, on all cores, and one that holds the pose for as long: what no `allow` covers, and every `allow`
/// of what this looks for that covers nothing. `played` is called after each task.
pub fn episodes(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary, played: &(dyn Fn() + Sync)) -> Vec<Diagnostic> {
    let judged = tasks.par_iter().map(|task| {
        let (mut warnings, mut allowances) = (Vec::new(), task.places.allowances.clone());
        if judge(task, bodies, &mut warnings).is_none() {
            // Nothing is known of a task that cannot be played, so no `allow` is needless.
            allowances.iter_mut().for_each(|allowance| allowance.fulfilled = true);
        }
        allowance::apply(&mut allowances, &mut warnings);
        played();
        (warnings, allowances)
    });
    let (warnings, allowances): (Vec<_>, Vec<_>) = judged.unzip();
    let mut found = warnings.concat();
    found.extend(allowance::unfulfilled(allowances.iter().flatten(), Stage::Play));
    found
}

/// Muscles at rest. The policy `zero` gives the entry of the action space that asks for nothing, which may be a controller at work.
struct Resting;

impl Policy for Resting {
    fn name(&self) -> &str {
        "rest"
    }

    fn acts_on(&self) -> ActsOn {
        ActsOn::Muscles
    }

    fn reset(&mut self, _context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        Ok(())
    }

    fn act(&mut self, _context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        action.fill(REST);
        Ok(())
    }
}

/// What came of an episode.
struct Played {
    steps: u32,
    success: bool,
    /// The contribution of each term to the return.
    terms: Vec<f64>,
}

impl Played {
    fn per_step(&self, sum: f64) -> f64 {
        sum / f64::from(self.steps)
    }

    fn mean(&self) -> f64 {
        self.per_step(self.terms.iter().sum())
    }
}

/// Looks at one task; `None` if it cannot be played.
fn judge(task: &Arc<CompiledTask>, bodies: &BodyLibrary, warnings: &mut Vec<Diagnostic>) -> Option<()> {
    let staged = bodies.stage(&task.body, &task.scene).ok()?;
    let mut episode = Environment::new(staged.model, staged.body, task.clone()).ok()?;
    let rest = play(&mut episode, &mut Resting, MOST_STEPS)?;
    if rest.success {
        let message = format!("doing nothing succeeds in `{}`", task.name);
        let diagnostic = at(probing::REST_SUCCEEDS, task.places.success, message)
            .found(format!("success after {} steps with every muscle at rest", rest.steps))
            .help("require something that only the movement achieves, or write `allow rest_succeeds \"...\"`");
        warnings.push(diagnostic);
    }
    // A policy that cannot act sets no measure.
    let Some(held) = play(&mut episode, &mut ComputedMuscleControl::default(), rest.steps) else { return Some(()) };
    let (resting, holding) = (rest.mean(), held.mean());
    if resting > holding + MARGIN * holding.abs() {
        let gain = |index: usize| rest.per_step(rest.terms[index]) - held.per_step(held.terms[index]);
        let most = (0..task.terms.len()).max_by(|&a, &b| gain(a).total_cmp(&gain(b)))?;
        let name = &task.terms[most].name;
        let message =
            format!("in `{}` doing nothing earns more than holding the pose, most of all by the term `{name}`", task.name);
        let diagnostic = at(probing::REWARDS_REST, *task.places.terms.get(most)?, message)
            .expected(format!("at rest less than {} per step, as `cmc` earns over {} steps", for_people(holding), held.steps))
            .found(format!("{} per step, {} more by `{name}`", for_people(resting), for_people(gain(most))))
            .help(
                "reward what a fall ends, or charge the termination; if holding the pose is not intended, write `allow rewards_rest \"...\"`",
            );
        warnings.push(diagnostic);
    }
    Some(())
}

/// Plays at most so many steps of the first episode; `None` if the policy cannot act, or a fault ends it.
fn play(episode: &mut Environment, policy: &mut dyn Policy, most: u32) -> Option<Played> {
    let mut rollout = Rollout::reset(episode, EpisodeKey::default(), policy).ok()?;
    while rollout.episode.ending().is_none() && rollout.episode.steps() < most {
        rollout.step::<EvaluationError>().ok()?;
    }
    let terms = episode.episode().totals().to_vec();
    let whole = episode.steps() > 0 && !matches!(episode.ending(), Some(Ending::Fault(_)));
    whole.then(|| Played { steps: episode.steps(), success: episode.ending().is_some() && episode.success(), terms })
}
