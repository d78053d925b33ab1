//! Episodes under policies in the lanes of a worker: what a [`Rollout`](crate::rollout::Rollout) is for one, for up to eight at once.

use msk_physics::Rates;
use msk_physics::lanes::WIDTH;
use msk_runtime::action::{ActionBuffer, ActsOn};
use msk_runtime::episode::{Controlled, Engine, Episode, EpisodeKey, GroupScratch, Member};
use msk_runtime::policy::{Policy, PolicyContext, PolicyError};

/// An episode with the policy that acts in it, in a lane.
pub(crate) struct LaneRollout<'a> {
    pub engine: &'a Engine,
    pub policy: Box<dyn Policy + 'a>,
    pub episode: Episode,
    rates: Option<Rates>,
    weights: Vec<f64>,
    action: ActionBuffer,
}

impl<'a> LaneRollout<'a> {
    /// An episode that must be [`reset`](Self::reset) before it is played, rewarded by `weights`, one per term.
    pub fn new(engine: &'a Engine, weights: Vec<f64>, policy: Box<dyn Policy + 'a>) -> Self {
        let (episode, action) = (engine.episode(), engine.action(ActsOn::Task));
        Self { engine, policy, episode, rates: None, weights, action }
    }

    /// Begins the episode `key` in a lane, then resets the policy. `look` sees the first snapshot before.
    ///
    /// # Errors
    /// The policy cannot act.
    pub fn reset(
        &mut self,
        lane: usize,
        key: EpisodeKey,
        scratch: &mut GroupScratch,
        look: &mut dyn FnMut(&PolicyContext<'_>),
    ) -> Result<(), PolicyError> {
        self.rates = scratch.begin(lane, self.engine, (key, &[]), &mut self.episode);
        // An episode that could not begin has nothing that a policy could look at.
        let ready = match self.is_over() {
            true => Ok(()),
            false => {
                let context = self.engine.context(&self.episode, &self.weights, scratch.lane(lane));
                look(&context);
                self.policy.reset(&context)
            }
        };
        self.action = self.engine.action(self.policy.acts_on());
        ready
    }

    /// Whether the episode has ended.
    pub fn is_over(&self) -> bool {
        self.episode.ending().is_some()
    }

    /// What a policy may look at, in the lane of the episode.
    pub fn context<'b>(&'b self, lane: usize, scratch: &'b GroupScratch) -> PolicyContext<'b> {
        self.engine.context(&self.episode, &self.weights, scratch.lane(lane))
    }
}

/// Takes one control step with each of the episodes that go on, by their lanes. Gives what keeps some policies from acting, with their lanes:
/// their episodes are not stepped.
pub(crate) fn step(mut rollouts: [Option<&mut LaneRollout<'_>>; WIDTH], scratch: &mut GroupScratch) -> Vec<(usize, PolicyError)> {
    for place in &mut rollouts {
        place.take_if(|rollout| rollout.is_over());
    }
    let unable = act(&mut rollouts, scratch);
    unable.iter().for_each(|(lane, _)| rollouts[*lane] = None);
    scratch.step(rollouts.map(|place| {
        let LaneRollout { engine, episode, rates, weights, action, .. } = place?;
        Some(Member { engine, episode, rates, weights, action: (&*action).into() })
    }));
    unable
}

/// Lets every policy act; gives what keeps some from acting, with their lanes.
fn act(rollouts: &mut [Option<&mut LaneRollout<'_>>], scratch: &mut GroupScratch) -> Vec<(usize, PolicyError)> {
    let (mut unable, mut controlled) = (Vec::new(), Vec::new());
    for (lane, rollout) in rollouts.iter_mut().enumerate() {
        let Some(LaneRollout { engine, episode, policy, action, weights, .. }) = rollout.as_deref_mut() else { continue };
        let action = &mut action.entries;
        if policy.controls().is_none() {
            let acted = policy.act(&engine.context(episode, weights, scratch.lane(lane)), action);
            unable.extend(acted.err().map(|error| (lane, error)));
        } else if let Some(controls) = policy.controls() {
            controlled.push(Controlled { lane, engine, episode, weights, controls, entries: &[], action });
        }
    }
    let acted = scratch.control(&mut controlled);
    let lanes: Vec<usize> = controlled.iter().map(|member| member.lane).collect();
    unable.extend(lanes.into_iter().zip(acted).filter_map(|(lane, acted)| {
        let reason = acted.err()?.to_string();
        let policy = rollouts[lane].as_ref().map_or_else(String::new, |rollout| rollout.policy.name().to_owned());
        Some((lane, PolicyError::Unable { policy, reason }))
    }));
    unable
}
