//! A line that shows how far an evaluation is: episodes, control steps per second, time left. Silent unless on a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use msk::runtime::evaluate::{EpisodeRecord, Watcher};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Watches an evaluation.
pub struct Progress {
    bar: ProgressBar,
    start: Instant,
    steps: AtomicU64,
    ended: AtomicU64,
    successes: AtomicU64,
}

impl Progress {
    /// Of `episodes`, of which `done` are there already.
    pub fn new(episodes: u64, done: u64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(episodes), ProgressDrawTarget::stderr_with_hz(10));
        // The template is a constant of this file; without it the bar has its default look.
        if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} episodes  {msg}  {elapsed} (left {eta})") {
            bar.set_style(style);
        }
        bar.set_position(done);
        bar.reset_eta();
        bar.enable_steady_tick(Duration::from_millis(200));
        let zero = || AtomicU64::new(0);
        Self { bar, start: Instant::now(), steps: zero(), ended: zero(), successes: zero() }
    }

    /// Takes the line away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn show(&self, steps: u64) {
        let rate = steps as f64 / self.start.elapsed().as_secs_f64().max(1e-3);
        let (ended, successes) = (self.ended.load(Ordering::Relaxed), self.successes.load(Ordering::Relaxed));
        self.bar.set_message(format!("{successes}/{ended} succeeded  {rate:.0} steps/s"));
    }
}

impl Watcher for Progress {
    fn stepped(&self) {
        let steps = self.steps.fetch_add(1, Ordering::Relaxed) + 1;
        // Often enough for the eye, seldom enough not to be felt.
        if steps.is_multiple_of(64) && !self.bar.is_hidden() {
            self.show(steps);
        }
    }

    fn ended(&self, record: &EpisodeRecord) {
        self.ended.fetch_add(1, Ordering::Relaxed);
        self.successes.fetch_add(u64::from(record.success), Ordering::Relaxed);
        self.bar.inc(1);
        self.show(self.steps.load(Ordering::Relaxed));
    }
}
