//! What is shown while an evaluation runs: a row for each task as it ends and, on a terminal, a line that tells how far it is.

use crate::terminal;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use msk::compiler::numbers::fixed;
use msk::evaluate::{EpisodeRecord, Plan, Resumed, TaskSummary, Watcher};
use msk::physics::scalar::Real;
use std::io::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A line on a terminal that shows how far something is, drawn at most so often in a second.
pub fn line(length: u64, template: &'static str, rate: u8) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr_with_hz(rate));
    // Templates are constants of this program; without one the bar has its default look.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// How far one episode is, on a terminal: a line of its control steps, which is to be taken away at the end.
pub fn steps(horizon: u32) -> ProgressBar {
    line(horizon.into(), "{bar:24} {pos}/{len} steps  {elapsed} (left {eta})", 10)
}

/// Watches an evaluation.
pub struct Progress {
    bar: ProgressBar,
    start: Instant,
    steps: AtomicU64,
    ended: AtomicU64,
    successes: AtomicU64,
    tasks: Mutex<Vec<Task>>,
}

/// How far a task is.
struct Task {
    name: String,
    /// Of the plan.
    episodes: u64,
    ended: u64,
    successes: u64,
    total: f64,
    /// Of the episodes that were played now.
    seconds: f64,
}

impl Task {
    fn add(&mut self, record: &EpisodeRecord) {
        self.ended += 1;
        self.successes += u64::from(record.success);
        self.total += record.total;
        self.seconds += record.wall_time;
    }
}

impl Progress {
    /// Of a plan, of which some episodes are there already.
    pub fn new(plan: &Plan, resumed: &Resumed) -> Self {
        let bar = line(plan.episodes(), "{bar:24} {pos}/{len} episodes  {msg}  {elapsed} (left {eta})", 10);
        bar.set_position(resumed.episodes());
        bar.reset_eta();
        bar.enable_steady_tick(Duration::from_millis(200));
        let task = |(place, task): (usize, TaskSummary)| {
            let episodes = plan.episodes_of(place);
            let total = task.total.map_or(0.0, |total| total.mean * task.episodes as f64);
            Task { name: task.task, episodes, ended: task.episodes, successes: task.successes, total, seconds: 0.0 }
        };
        let mut tasks: Vec<Task> = resumed.summary().tasks.into_iter().enumerate().map(task).collect();
        for (place, record) in resumed.early() {
            tasks.get_mut(place).into_iter().for_each(|task| task.add(record));
        }
        let zero = || AtomicU64::new(0);
        Self { bar, start: Instant::now(), steps: zero(), ended: zero(), successes: zero(), tasks: Mutex::new(tasks) }
    }

    /// Takes the line away; the rows stay.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn show(&self, steps: u64) {
        let rate = steps as f64 / self.start.elapsed().as_secs_f64().at_least(1e-3);
        let (ended, successes) = (self.ended.load(Ordering::Relaxed), self.successes.load(Ordering::Relaxed));
        self.bar.set_message(format!("{successes}/{ended} succeeded  {rate:.0} steps/s"));
    }

    /// Prints a row for the task number `trial`, which is left as it is by `change`, if that wants one.
    fn row(&self, trial: usize, change: impl FnOnce(&mut Task) -> Option<String>) {
        let mut tasks = self.tasks.lock().unwrap_or_else(PoisonError::into_inner);
        let width = tasks.iter().map(|task| task.name.chars().count()).max().unwrap_or(0);
        let Some(task) = tasks.get_mut(trial) else { return };
        let Some(row) = change(task) else { return };
        // Nothing is left to be done when standard error itself cannot be written.
        self.bar.suspend(|| {
            let _ = writeln!(terminal::notes(), "{:<width$}  {row}", task.name);
        });
    }
}

impl Watcher for Progress {
    fn stepped(&self) {
        let steps = self.steps.fetch_add(1, Ordering::Relaxed) + 1;
        // Often enough for the eye, seldom enough not to be felt; where steps are slow, each.
        let slow = || self.start.elapsed().as_secs() > steps / 64;
        if !self.bar.is_hidden() && (steps.is_multiple_of(64) || slow()) {
            self.show(steps);
        }
    }

    fn ended(&self, trial: usize, record: &EpisodeRecord) {
        self.ended.fetch_add(1, Ordering::Relaxed);
        self.successes.fetch_add(u64::from(record.success), Ordering::Relaxed);
        self.bar.inc(1);
        self.show(self.steps.load(Ordering::Relaxed));
        self.row(trial, |task| {
            task.add(record);
            let Task { episodes, ended, successes, total, seconds, .. } = task;
            let mean = *total / *ended as f64;
            (ended == episodes)
                .then(|| format!("{successes:>3} of {ended} succeeded  return {:>9}  {seconds:>6.1} s", fixed(mean, 1)))
        });
    }

    fn skipped(&self, trial: usize, reason: &str) {
        self.row(trial, |_| Some(format!("skipped: {reason}")));
    }
}
