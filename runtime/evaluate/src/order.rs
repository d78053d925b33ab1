//! The order in which episodes enter the journal: that of the plan, whichever ends first.
//!
//! Workers end episodes in an order that depends on their speed. The journal has the bytes of one worker that plays one episode after the
//! other: an episode that ends early is held until all before it have entered. Workers wait rather than run ahead without bound, so what
//! is held fits into memory however many episodes there are.

use super::EpisodeRecord;
use super::episode_set::{EpisodeSet, Job};
use super::shard::Shard;
use std::collections::{BTreeMap, BTreeSet};

/// How far episodes may be begun before the first that has not entered.
const WINDOW: u64 = 512;

/// What a worker is to do.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// Play this episode.
    Play(Job),
    /// Others are too far behind.
    Wait,
    /// Every episode is handed out.
    Over,
}

#[cfg(test)]
impl Turn {
    /// The episode that is to be played.
    pub fn job(self) -> Option<Job> {
        if let Self::Play(job) = self { Some(job) } else { None }
    }
}

/// Hands out the episodes of a plan and takes them back in order.
#[derive(Debug)]
pub(super) struct Order {
    tasks: usize,
    /// Of each task.
    episodes: u64,
    /// The episodes that are played here.
    shard: Shard,
    /// In the journal from the beginning.
    done: EpisodeSet,
    /// The next to be handed out.
    next: Job,
    /// Handed out before those in front of them.
    ahead: BTreeSet<Job>,
    /// The first that has neither entered nor is given up.
    due: Job,
    /// Ended before their turn.
    held: BTreeMap<Job, EpisodeRecord>,
    /// Tasks that the policy cannot act on: the first episode that showed it, and the reason.
    skipped: BTreeMap<usize, (u64, String)>,
}

impl Order {
    /// Of `tasks` tasks with so many episodes each, or a shard of these, of which some are in the journal and some have ended early.
    pub fn new((tasks, episodes): (usize, u64), shard: Shard, done: EpisodeSet, held: BTreeMap<Job, EpisodeRecord>) -> Self {
        Self { tasks, episodes, shard, done, next: (0, 0), ahead: BTreeSet::new(), due: (0, 0), held, skipped: BTreeMap::new() }
    }

    /// Episodes that are still to be played.
    pub fn missing(&self) -> u64 {
        let all = self.shard.among(self.episodes.saturating_mul(self.tasks as u64));
        all.saturating_sub(self.done.len()).saturating_sub(self.held.len() as u64)
    }

    /// Whether some episodes of a task are still to be played.
    pub fn misses(&self, task: usize) -> bool {
        let held = self.held.range((task, 0)..=(task, u64::MAX)).count() as u64;
        self.done.count(task) + held < self.shard.of_task(task, self.episodes)
    }

    /// Hands out an episode.
    pub fn claim(&mut self) -> Turn {
        // What had ended early in an earlier attempt may have entered without being handed out.
        self.next = self.next.max(self.due);
        while let Some(job) = self.within(self.next) {
            if !self.ahead.remove(&job) && self.is_wanted(job) {
                if self.is_beyond(job) {
                    return Turn::Wait;
                }
                self.next = (job.0, job.1 + 1);
                return Turn::Play(job);
            }
            self.next = (job.0, job.1 + 1);
        }
        Turn::Over
    }

    /// Hands out the first episode of a task that `fits`, if there is one within reach.
    pub fn claim_of(&mut self, fits: &dyn Fn(usize) -> bool) -> Option<Job> {
        let mut next = self.next.max(self.due);
        while let Some(job) = self.within(next).filter(|job| !self.is_beyond(*job)) {
            if !fits(job.0) {
                next = (job.0 + 1, 0);
                continue;
            }
            if !self.ahead.contains(&job) && self.is_wanted(job) {
                self.ahead.insert(job);
                return Some(job);
            }
            next = (job.0, job.1 + 1);
        }
        None
    }

    /// Whether an episode has not ended yet, and somebody wants to know how it does.
    fn is_wanted(&self, job: Job) -> bool {
        !self.done.contains(job) && !self.held.contains_key(&job) && !self.is_given_up(job)
    }

    /// Whether others are too far behind for an episode to begin.
    fn is_beyond(&self, job: Job) -> bool {
        self.number(job) - self.number(self.due) >= WINDOW
    }

    /// Whether nobody wants to know how an episode ends, because its task is skipped.
    pub fn is_given_up(&self, (task, episode): Job) -> bool {
        self.skipped.get(&task).is_some_and(|(first, _)| episode >= *first)
    }

    /// Whether an episode enters as soon as it has ended.
    pub fn is_due(&self, job: Job) -> bool {
        self.due == job
    }

    /// Takes an episode that has ended.
    pub fn end(&mut self, job: Job, record: EpisodeRecord) {
        self.held.insert(job, record);
    }

    /// Gives up a task from an episode on: of several that show that the policy cannot act, the first gives the reason, whichever is
    /// noticed first. Gives whether the task was not skipped before.
    pub fn skip(&mut self, (task, episode): Job, reason: String) -> bool {
        let known = self.skipped.get(&task);
        let is_new = known.is_none();
        if known.is_none_or(|(first, _)| episode < *first) {
            self.skipped.insert(task, (episode, reason));
            self.held.retain(|job, _| job.0 != task || job.1 < episode);
        }
        is_new
    }

    /// The episodes whose turn has come, in order.
    pub fn ready(&mut self) -> Vec<EpisodeRecord> {
        let mut ready = Vec::new();
        while let Some(job) = self.within(self.due) {
            match self.held.remove(&job) {
                Some(record) => ready.push(record),
                None if self.done.contains(job) || self.is_given_up(job) => {}
                None => {
                    self.due = job;
                    break;
                }
            }
            self.due = (job.0, job.1 + 1);
        }
        ready
    }

    /// Whether every episode has entered or is given up.
    pub fn is_complete(&self) -> bool {
        self.within(self.due).is_none()
    }

    /// The tasks that were skipped with their reasons, by their places.
    pub fn into_skipped(self) -> Vec<(usize, String)> {
        self.skipped.into_iter().map(|(task, (_, reason))| (task, reason)).collect()
    }

    /// The first episode of the shard from `job` on, which may lie behind the last of its task.
    fn within(&self, job: Job) -> Option<Job> {
        let number = self.shard.first_from(self.number(job))?;
        let task = usize::try_from(number.checked_div(self.episodes)?).ok()?;
        (task < self.tasks).then_some((task, number % self.episodes))
    }

    fn number(&self, (task, episode): Job) -> u64 {
        self.episodes.saturating_mul(task as u64).saturating_add(episode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(task: usize, episode: u64) -> EpisodeRecord {
        let line = format!(
            r#"{{"task":"{task}","policy":"zero","seed":0,"episode":{episode},"success":true,"terminated_by":[],"truncated":true,
            "fault":null,"steps":10,"return":1.5,"terms":{{}},"values":{{}},"task_hash":"a","model_hash":"b"}}"#
        );
        serde_json::from_str(&line).unwrap()
    }

    fn order(done: &[Job]) -> Order {
        let mut set = EpisodeSet::default();
        done.iter().for_each(|job| assert!(set.insert(*job)));
        Order::new((2, 3), Shard::WHOLE, set, BTreeMap::new())
    }

    fn ready(order: &mut Order) -> Vec<Job> {
        order.ready().iter().map(|record| (record.task.parse().unwrap(), record.episode)).collect()
    }

    fn claimed(order: &mut Order) -> Vec<Job> {
        std::iter::from_fn(|| order.claim().job()).collect()
    }

    #[test]
    fn an_episode_of_a_later_task_may_be_handed_out_first_and_is_so_once() {
        let mut order = order(&[(1, 0)]);
        let second = |task: usize| task == 1;
        assert_eq!(order.claim().job(), Some((0, 0)));
        assert_eq!(
            [order.claim_of(&second), order.claim_of(&second), order.claim_of(&second)],
            [Some((1, 1)), Some((1, 2)), None]
        );
        order.end((1, 1), record(1, 1));
        let rest: Vec<Option<Job>> = (0..3).map(|_| order.claim().job()).collect();
        assert_eq!(rest, [Some((0, 1)), Some((0, 2)), None]);
        // What was handed out last enters first.
        for job in [(1, 2), (0, 2), (0, 0)] {
            order.end(job, record(job.0, job.1));
        }
        assert_eq!(ready(&mut order), [(0, 0)]);
        order.end((0, 1), record(0, 1));
        assert_eq!(ready(&mut order), [(0, 1), (0, 2), (1, 1), (1, 2)]);
        assert!(order.is_complete());
    }

    #[test]
    fn episodes_enter_in_order_whichever_ends_first() {
        let mut order = order(&[(0, 1)]);
        assert_eq!(order.missing(), 5);
        assert_eq!(claimed(&mut order), [(0, 0), (0, 2), (1, 0), (1, 1), (1, 2)]);
        order.end((1, 0), record(1, 0));
        order.end((0, 2), record(0, 2));
        assert_eq!(ready(&mut order), []);
        order.end((0, 0), record(0, 0));
        assert_eq!(ready(&mut order), [(0, 0), (0, 2), (1, 0)]);
        order.end((1, 2), record(1, 2));
        assert!(ready(&mut order).is_empty() && !order.is_complete());
        order.end((1, 1), record(1, 1));
        assert_eq!(ready(&mut order), [(1, 1), (1, 2)]);
        assert!(order.is_complete());
        assert_eq!(order.claim(), Turn::Over);
    }

    #[test]
    fn a_shard_has_its_own_episodes_only() {
        let mut order = Order { shard: "2/4".parse().unwrap(), ..order(&[]) };
        assert!(order.missing() == 2 && order.misses(0) && order.misses(1));
        assert_eq!(ready(&mut order), []);
        assert_eq!(claimed(&mut order), [(0, 1), (1, 2)]);
        assert!(order.is_due((0, 1)));
        order.end((1, 2), record(1, 2));
        order.end((0, 1), record(0, 1));
        assert_eq!(ready(&mut order), [(0, 1), (1, 2)]);
        assert!(order.is_complete());
        let order = Order { shard: "6/6".parse().unwrap(), ..self::order(&[]) };
        assert!(!order.misses(0) && order.misses(1));
    }

    #[test]
    fn a_task_is_skipped_from_the_first_episode_on_that_shows_it() {
        let mut order = order(&[]);
        assert_eq!(claimed(&mut order).len(), 6);
        order.end((0, 2), record(0, 2));
        assert!(order.skip((0, 2), "later".into()));
        assert!(!order.skip((0, 1), "first".into()));
        assert!(!order.skip((0, 2), "again".into()));
        order.end((1, 0), record(1, 0));
        assert_eq!(ready(&mut order), []);
        order.end((0, 0), record(0, 0));
        assert_eq!(ready(&mut order), [(0, 0), (1, 0)]);
        assert!(order.is_given_up((0, 1)) && !order.is_given_up((0, 0)));
        assert_eq!(order.into_skipped(), [(0, "first".to_owned())]);
    }

    #[test]
    fn what_ended_early_before_an_interruption_is_not_played_again() {
        let mut order = Order { held: BTreeMap::from([((0, 1), record(0, 1)), ((1, 2), record(1, 2))]), ..order(&[(0, 0)]) };
        assert!(order.missing() == 3 && order.misses(0) && order.misses(1));
        assert_eq!(ready(&mut order), [(0, 1)]);
        assert_eq!(claimed(&mut order), [(0, 2), (1, 0), (1, 1)]);
    }

    #[test]
    fn workers_wait_for_an_episode_that_takes_long() {
        let mut order = Order::new((1, 10 * WINDOW), Shard::WHOLE, EpisodeSet::default(), BTreeMap::new());
        let early = claimed(&mut order);
        assert_eq!(early.len() as u64, WINDOW);
        assert_eq!(order.claim(), Turn::Wait);
        early.iter().skip(1).for_each(|job| order.end(*job, record(job.0, job.1)));
        assert!(ready(&mut order).is_empty() && order.claim() == Turn::Wait);
        order.end((0, 0), record(0, 0));
        assert_eq!(order.ready().len() as u64, WINDOW);
        assert_eq!(order.claim(), Turn::Play((0, WINDOW)));
        assert_eq!(Order::new((3, 0), Shard::WHOLE, EpisodeSet::default(), BTreeMap::new()).claim(), Turn::Over);
    }
}
