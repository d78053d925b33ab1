//! `msk view RUN`: a run in a browser on this machine, while it goes on.

pub mod live;
mod playback;
mod results;
mod server;

use crate::error::Error;
use crate::interrupt::Interrupt;
use crate::policies::Limits;
use crate::terminal;
use playback::{NoPage, Playback};
use results::Results;
use server::{Answer, Server};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

const PAGE: &str = include_str!("live.html");
/// A state is read anew from the folder after this time.
const FRESH: Duration = Duration::from_millis(500);
/// How often the folder is looked at without a reader.
const LOOK: Duration = Duration::from_secs(2);
/// How long the last state can still be fetched after the run has ended.
const LINGER: Duration = Duration::from_secs(6);

/// Show a run in a browser on this machine, while it goes on or afterwards
///
/// RUN is the folder that `msk eval`, `msk collect` or `msk train` writes: `msk view` reads it, and neither changes the run nor slows it
/// but for the time that it takes itself. The page has the episodes so far with their returns, a table of the tasks, the reward terms, of a
/// training the learning curve, and the last episode as `msk run --html` shows it, played again from its record. It is served on the loopback
/// interface alone, at an address with a secret in it, and ends with the run, or with Ctrl-C. `msk run --live` shows a single episode so.
///
/// Exit code 0 when the run has ended, 1 for a folder without a run, 2 for an invalid command line; 130, 143 or 129 after SIGINT, SIGTERM or
/// SIGHUP.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of the run
    run: PathBuf,
    /// File with the tasks of the run, from which episodes are played again
    #[arg(long, value_name = "FILE", default_value = "tasks.msk")]
    tasks: PathBuf,
    /// Port of this machine; 0 for any that is free
    #[arg(long, default_value_t = 0)]
    port: u16,
    #[command(flatten)]
    limits: Limits,
}

/// Serves the page.
///
/// # Errors
/// A folder without a run, or a port that is in use.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let results = Results::find(&args.run)?;
    let (over, _) = results.state()?;
    let interrupt = Interrupt::listen()?;
    let server = Server::open(args.port)?;
    let mut out = terminal::out();
    writeln!(out, "{}", server.url())?;
    out.flush()?;
    drop(out);
    writeln!(terminal::notes(), "Open this address in a browser on this machine; Ctrl-C ends it.")?;
    let ended = AtomicBool::new(false);
    let playback = Playback { tasks: args.tasks, limits: &args.limits, stop: interrupt.stop(), last: Mutex::new(None) };
    let live =
        Live { results, shown: Mutex::new(None), end: Mutex::new(End { awaited: !over, looked: Instant::now(), came: None }) };
    let stop = || {
        let whole = live.has_ended();
        ended.store(whole, Ordering::Relaxed);
        whole || interrupt.stop().load(Ordering::Relaxed)
    };
    server.serve(&stop, &|path| live.answer(path, &playback))?;
    Ok(if ended.load(Ordering::Relaxed) { ExitCode::SUCCESS } else { interrupt.code() })
}

/// A run that is shown.
struct Live {
    results: Results,
    /// The last state as JSON, and when it was read.
    shown: Mutex<Option<(Instant, Vec<u8>)>>,
    end: Mutex<End>,
}

/// When the run ends, if that is still to come.
struct End {
    awaited: bool,
    looked: Instant,
    came: Option<Instant>,
}

impl Live {
    fn answer(&self, path: &str, playback: &Playback<'_>) -> Answer {
        match path {
            "" => Answer::of("text/html; charset=utf-8", PAGE.into()),
            "state.json" => self.state(),
            _ => match path.strip_prefix("episode/") {
                Some(which) => match playback.page(&self.results, which) {
                    Ok(page) => Answer::of("text/html; charset=utf-8", page),
                    Err(NoPage::Busy) => Answer::text("503 Service Unavailable", "another episode is being played\n"),
                    Err(NoPage::Unknown) => Answer::text("404 Not Found", "there is no such episode\n"),
                    Err(NoPage::Failed(why)) => Answer::text("422 Unprocessable Content", why),
                },
                None => Answer::text("404 Not Found", "there is no such page\n"),
            },
        }
    }

    /// The present state; many readers read the folder once.
    fn state(&self) -> Answer {
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, text)) = shown.as_ref().filter(|(when, _)| when.elapsed() < FRESH) {
            return Answer::of("application/json", text.clone());
        }
        match self.results.state() {
            Ok((_, state)) => {
                let text = state.to_string().into_bytes();
                *shown = Some((Instant::now(), text.clone()));
                Answer::of("application/json", text)
            }
            Err(error) => Answer::text("503 Service Unavailable", error.to_string()),
        }
    }

    /// Whether the run has ended since the server began, some time ago.
    fn has_ended(&self) -> bool {
        let mut end = self.end.lock().unwrap_or_else(PoisonError::into_inner);
        if !end.awaited {
            return false;
        }
        if end.came.is_none() && end.looked.elapsed() >= LOOK {
            end.looked = Instant::now();
            // A folder that cannot be read just now is looked at again.
            end.came = self.results.state().is_ok_and(|(over, _)| over).then(Instant::now);
        }
        end.came.is_some_and(|came| came.elapsed() >= LINGER)
    }
}
