//! Reasoners: who looks at statistics and proposes other weights.
//!
//! A proposal is data and nothing else: a number for a name. It is read strictly, and what the rules of change make of it is
//! not the reasoner's business.

mod http;
mod process;
mod prompt;
mod reply;
mod rules;
mod secrets;
mod settings;

pub use http::Http;
pub use process::Process;
pub use prompt::prompt;
pub use reply::{Proposal, ReplyError, read};
pub use rules::RuleBook;
pub use secrets::{Secret, Secrets};
pub use settings::{SettingsError, from_file};

use crate::statistics::Statistics;
use serde::Serialize;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How often an answer that is waited for and the interrupt are looked at.
const GLANCE: Duration = Duration::from_millis(10);

/// What a reasoner is asked.
#[derive(Debug, Clone, Serialize)]
pub struct Request {
    /// The task.
    pub task: String,
    /// What the task is, in a sentence.
    pub summary: String,
    /// Control steps of a whole episode.
    pub horizon: u32,
    /// The formula of each term, as written.
    pub formulas: Vec<(String, String)>,
    /// Which round of the session this is, from 1.
    pub round: u64,
    /// What counts, in words.
    pub objective: String,
    /// Largest relative change of a weight: 0.2 is 20 %.
    pub step: f64,
    /// The sum of sizes that the weights in scope must keep, if they must.
    pub norm: Option<f64>,
    /// The statistics of the episodes of this round.
    pub statistics: Statistics,
    /// The last rounds, the oldest first.
    pub history: Vec<Past>,
}

/// A round that is over.
#[derive(Debug, Clone, Serialize)]
pub struct Past {
    /// Which.
    pub round: u64,
    /// What it came to; larger is better.
    pub score: f64,
    /// The weights that it had.
    pub weights: Vec<(String, f64)>,
}

/// Why there is no proposal.
#[derive(Debug, thiserror::Error)]
pub enum ReasonerError {
    /// It could not be reached or did not answer in time.
    #[error("the reasoner gave no answer after {attempts} attempt(s): {reason}")]
    Silent {
        /// How often it was asked.
        attempts: u32,
        /// What happened the last time.
        reason: String,
    },
    /// It will not answer, however often it is asked.
    #[error("the reasoner rejects the request: {0}")]
    Refuses(String),
    /// Its answer is no proposal.
    #[error("the reasoner's answer is not a proposal: {source}")]
    Reply {
        /// What is wrong with it.
        source: ReplyError,
        /// Its answer, without secrets and cut to a length that fits a log.
        reply: String,
    },
    /// The run was interrupted while it was asked.
    #[error("interrupted during a request to the reasoner")]
    Interrupted,
}

/// Somebody who proposes weights.
pub trait Reasoner {
    /// What it is called in logs.
    fn name(&self) -> String;

    /// Proposes weights. `stop` becomes true when the answer is not needed any more.
    ///
    /// # Errors
    /// No answer, or one that is no proposal.
    fn propose(&self, request: &Request, stop: &AtomicBool) -> Result<Proposal, ReasonerError>;
}
