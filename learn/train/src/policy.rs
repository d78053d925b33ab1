//! Agents as policies: `agent FOLDER` for one, `agents [FOLDER]` for the best of each task.

use crate::agent::{Agent, Unfit};
use crate::agents::Agents;
use msk_network::{Kernel, Processor, Tape};
use msk_program::task::CompiledTask;
use msk_runtime::episode::Engine;
use msk_runtime::policy::{Policy, PolicyContext, PolicyError, PolicyMaker, PolicySource};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Which agent acts on a task.
#[derive(Debug, Clone)]
enum Choice {
    /// This one; on tasks that only mean something else, too, if so asked.
    One { agent: Arc<Agent>, any_task: bool },
    /// The best that was trained on the task.
    Best(Agents),
}

impl Choice {
    /// # Errors
    /// There is none, in words that say why.
    fn for_task(&self, engine: &Engine) -> Result<Arc<Agent>, String> {
        match self {
            Self::One { agent, any_task } => match agent.unfit(engine) {
                Some(Unfit::Numbers(reason)) => Err(reason),
                Some(Unfit::Meaning(reason)) if !any_task => {
                    Err(format!("{reason}; `agent --any-task FOLDER` uses it nevertheless"))
                }
                _ => Ok(agent.clone()),
            },
            Self::Best(agents) => agents.best(engine),
        }
    }
}

/// An agent that acts in episodes.
struct AgentPolicy {
    name: String,
    choice: Choice,
    tape: Tape,
    /// What was chosen last, and for which task.
    chosen: Option<(Arc<CompiledTask>, Arc<Agent>)>,
    /// Its last action in the episode; empty before the first.
    last: Vec<f64>,
}

impl Policy for AgentPolicy {
    fn name(&self) -> &str {
        &self.name
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        self.last.clear();
        let task = context.engine.task();
        if self.chosen.as_ref().is_some_and(|(known, _)| Arc::ptr_eq(known, task)) {
            return Ok(());
        }
        let unable = |reason| PolicyError::Unable { policy: self.name.clone(), reason };
        self.chosen = Some((task.clone(), self.choice.for_task(context.engine).map_err(unable)?));
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let early = || PolicyError::Failed { policy: self.name.clone(), reason: "it has not been reset".into() };
        let (_, agent) = self.chosen.as_ref().ok_or_else(early)?;
        if self.last.is_empty() || agent.acts_at(context.step) {
            agent.actor().act(&mut self.tape, context.observation, action);
            self.last.clear();
            self.last.extend_from_slice(action);
        }
        action.copy_from_slice(&self.last);
        Ok(())
    }
}

/// Agents, to be opened by workers.
#[derive(Debug)]
struct Maker {
    name: String,
    choice: Choice,
    kernel: Arc<dyn Kernel>,
}

impl PolicyMaker for Maker {
    fn open<'a>(&self, _: &'a AtomicBool) -> Result<Box<dyn Policy + 'a>, PolicyError> {
        let tape = Tape::new(self.kernel.clone());
        Ok(Box::new(AgentPolicy { name: self.name.clone(), choice: self.choice.clone(), tape, chosen: None, last: Vec::new() }))
    }
}

/// What `text` names: `agent FOLDER`, `agent --any-task FOLDER`, `agents` or `agents FOLDER`; `None` if it names none of these. Files are
/// read here, so that all episodes see the same; results tell two agents of one name apart.
///
/// # Errors
/// A folder that holds no agent.
pub fn source(text: &str) -> Option<Result<PolicySource, PolicyError>> {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    match word {
        "agent" => Some(one(rest.trim())),
        "agents" => Some(best(rest.trim())),
        _ => None,
    }
}

/// An agent as it is now, under a name.
///
/// # Errors
/// The operating system gives no threads.
pub fn source_of(agent: Agent, name: String) -> Result<PolicySource, PolicyError> {
    made(name, Choice::One { agent: Arc::new(agent), any_task: false })
}

fn one(rest: &str) -> Result<PolicySource, PolicyError> {
    let (any_task, path) = match rest.strip_prefix("--any-task") {
        Some(path) => (true, path.trim()),
        None => (false, rest),
    };
    if path.is_empty() {
        return Err(PolicyError::Incomplete { policy: "agent", example: "agent results/walk" });
    }
    let agent = Agent::read(Path::new(path)).map_err(|error| unreadable(path, &error))?;
    made(format!("agent {path} ({})", agent.digest()), Choice::One { agent: Arc::new(agent), any_task })
}

fn best(path: &str) -> Result<PolicySource, PolicyError> {
    let agents = if path.is_empty() { Agents::built_in() } else { Agents::read(Path::new(path)) };
    let agents = agents.map_err(|error| unreadable(if path.is_empty() { "agents" } else { path }, &error))?;
    let space = if path.is_empty() { "" } else { " " };
    made(format!("agents{space}{path} ({})", agents.digest()), Choice::Best(agents))
}

fn made(name: String, choice: Choice) -> Result<PolicySource, PolicyError> {
    let kernel = Processor::new(NonZeroUsize::MIN).map_err(|error| unreadable(&name, &error))?;
    Ok(PolicySource::made(name.clone(), Arc::new(Maker { name, choice, kernel: Arc::new(kernel) })))
}

fn unreadable(path: &str, error: &dyn std::error::Error) -> PolicyError {
    PolicyError::Unreadable { path: path.to_owned(), reason: error.to_string() }
}
