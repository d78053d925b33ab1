//! `msk run --live`: one episode in a browser on this machine, while it is being played.

use super::PAGE;
use super::server::{Answer, Server};
use crate::error::Error;
use crate::html::Film;
use crate::terminal;
use msk::evaluate::Trial;
use msk::runtime::episode::Environment;
use msk::view::{Caption, Recording, page};
use serde_json::{Value, json};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How often the episode is handed to readers, if there are any.
const OFTEN: Duration = Duration::from_secs(1);
/// How long the page of the whole episode can still be fetched by others after its first reader has it.
const LINGER: Duration = Duration::from_secs(2);
/// How often the end of that is looked for.
const TICK: Duration = Duration::from_millis(100);
/// Points of a curve at most.
const MOST: usize = 600;

/// A page that shows an episode while it is being played.
pub struct Live {
    server: Server,
    caption: Caption,
    horizon: u32,
    period: f64,
    /// Names of the reward terms.
    terms: Vec<String>,
    /// Whether a reader has asked since the episode was last handed over.
    asked: AtomicBool,
    shown: Mutex<Shown>,
}

/// What readers see.
#[derive(Default)]
struct Shown {
    steps: u32,
    /// Of each control step.
    rewards: Vec<f64>,
    /// What each term added to the return.
    totals: Vec<f64>,
    /// Whether the episode has ended.
    over: bool,
    /// The episode up to a control step.
    recording: Option<(u32, Recording)>,
    handed: Option<Instant>,
    /// When the page of the whole episode was first fetched.
    fetched: Option<Instant>,
}

impl Live {
    /// Opens a server for an episode of a task, and prints its address.
    ///
    /// # Errors
    /// A port that is in use.
    pub fn open(trial: &Trial, caption: Caption, port: u16) -> Result<Self, Error> {
        let (task, server) = (&trial.task, Server::open(port)?);
        writeln!(terminal::notes(), "Open {} in a browser on this machine.", server.url())?;
        Ok(Self {
            server,
            caption,
            horizon: task.horizon,
            period: 1.0 / task.control_frequency,
            terms: task.terms.iter().map(|term| term.name.clone()).collect(),
            asked: AtomicBool::new(true),
            shown: Mutex::default(),
        })
    }

    /// Serves the page while `play` goes on, and after a success until a reader has the whole episode or `stop` holds.
    ///
    /// # Errors
    /// Those of `play`, or the operating system ends the listening.
    pub fn beside<T>(&self, stop: &AtomicBool, play: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        let over = AtomicBool::new(false);
        thread::scope(|scope| {
            let serving = scope.spawn(|| self.server.serve(&|| over.load(Ordering::Relaxed), &|path| self.answer(path)));
            let played = play();
            let announced = played.is_ok() && self.shown().over && !stop.load(Ordering::Relaxed);
            if announced {
                let _ = writeln!(terminal::notes(), "The page waits for a reader of the whole episode; Ctrl-C ends it.");
            }
            while announced && !stop.load(Ordering::Relaxed) && !serving.is_finished() && !self.is_done() {
                thread::sleep(TICK);
            }
            over.store(true, Ordering::Relaxed);
            let served = serving.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            let played = played?;
            served?;
            Ok(played)
        })
    }

    /// Looks at the episode after its reset and after each control step; `film` has looked at it, too.
    pub fn look(&self, episode: &Environment, film: &Film) {
        let mut shown = self.shown();
        if episode.steps() > shown.steps {
            shown.rewards.push(episode.report().reward);
        }
        shown.steps = episode.steps();
        shown.totals = episode.episode().totals().to_vec();
        if self.asked.load(Ordering::Relaxed) && shown.handed.is_none_or(|when| when.elapsed() >= OFTEN) {
            let total = Some(shown.totals.iter().sum());
            let caption = Caption { outcome: "still being played".into(), total, ..self.caption.clone() };
            // Before there is a frame there is nothing to hand over.
            shown.recording = film.so_far(caption).ok().flatten().map(|recording| (episode.steps(), recording));
            shown.handed = Some(Instant::now());
            self.asked.store(false, Ordering::Relaxed);
        }
    }

    /// The episode is whole: `caption` says how it ended.
    ///
    /// # Errors
    /// There is nothing to show.
    pub fn end(&self, film: &Film, caption: Caption) -> Result<(), Error> {
        let mut shown = self.shown();
        shown.recording = film.so_far(caption)?.map(|recording| (shown.steps, recording));
        shown.over = true;
        Ok(())
    }

    fn shown(&self) -> MutexGuard<'_, Shown> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a reader has the whole episode, and others have had the time to fetch it.
    fn is_done(&self) -> bool {
        self.shown().fetched.is_some_and(|when| when.elapsed() >= LINGER)
    }

    fn answer(&self, path: &str) -> Answer {
        match path {
            "" => Answer::of("text/html; charset=utf-8", PAGE.into()),
            "state.json" => {
                self.asked.store(true, Ordering::Relaxed);
                Answer::of("application/json", self.state().to_string().into_bytes())
            }
            // The number of steps in the address is for the reader: what has been handed over last is shown.
            _ if path.starts_with("episode/") => self.page(),
            _ => Answer::text("404 Not Found", "there is no such page\n"),
        }
    }

    fn state(&self) -> Value {
        let shown = self.shown();
        let stride = shown.rewards.len().div_ceil(MOST).max(1);
        let time = |step: usize| step as f64 * self.period;
        let curve = shown.rewards.iter().enumerate().step_by(stride);
        json!({
            "kind": "episode", "title": format!("{}, {}", self.caption.task, self.caption.policy), "over": shown.over,
            "step": shown.steps, "horizon": self.horizon, "time": time(shown.steps as usize),
            "return": shown.totals.iter().sum::<f64>(),
            "recorded": shown.recording.as_ref().map(|(steps, _)| steps),
            "curve": curve.map(|(index, reward)| json!({ "time": time(index + 1), "reward": reward })).collect::<Vec<_>>(),
            "terms": self.terms.iter().zip(&shown.totals).map(|(name, value)| json!({ "name": name, "value": value })).collect::<Vec<_>>(),
        })
    }

    fn page(&self) -> Answer {
        let (whole, made) = {
            let shown = self.shown();
            let Some((_, recording)) = &shown.recording else {
                return Answer::text("503 Service Unavailable", "the episode has not begun\n");
            };
            (shown.over, recording.clone())
        };
        // Compressed without the lock: the episode goes on meanwhile.
        match page(&format!("{}, {}", self.caption.task, self.caption.policy), &[made]) {
            Ok(page) => {
                if whole {
                    self.shown().fetched.get_or_insert_with(Instant::now);
                }
                Answer::of("text/html; charset=utf-8", page.into_bytes())
            }
            Err(error) => Answer::text("500 Internal Server Error", error.to_string()),
        }
    }
}
