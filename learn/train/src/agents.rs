//! Agents of several tasks: those in a folder, or those that come with the program.

use crate::agent::{Agent, AgentError, Unfit};
use msk_program::digest::hexadecimal;
use msk_runtime::episode::Engine;
use msk_storage::{Folder, Kind};
use sha2::{Digest, Sha256};
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// What comes with the program: name, description, network; sorted by name.
macro_rules! built_in {
    ($($name:literal),*) => {
        [$((
            $name,
            include_str!(concat!("../../../agents/", $name, "/agent.toml")),
            include_bytes!(concat!("../../../agents/", $name, "/policy.safetensors")).as_slice(),
        )),*]
    };
}
const BUILT_IN: [(&str, &str, &[u8]); 14] = built_in![
    "paced_open_door",
    "paced_pole_walk",
    "paced_run",
    "paced_slide",
    "paced_walk",
    "paced_walk_and_sit",
    "paced_walk_turn",
    "poised_powerlift",
    "poised_reach",
    "poised_single_leg_stand",
    "poised_squat",
    "sit",
    "squat",
    "stand"
];

/// Agents, the best first.
#[derive(Debug, Clone)]
pub struct Agents {
    agents: Vec<Arc<Agent>>,
}

impl Agents {
    /// Those that come with the program, the folders of `agents/`.
    ///
    /// # Errors
    /// None but in a program that was built with damaged files.
    pub fn built_in() -> Result<Self, AgentError> {
        let read = |(name, description, network)| Agent::of(&format!("agents/{name}"), description, network);
        Ok(Self::of(BUILT_IN.into_iter().map(read).collect::<Result<_, _>>()?))
    }

    /// Those in the folders within a folder; of a training, the one that succeeded most. Folders without an agent are left out.
    ///
    /// # Errors
    /// A folder that cannot be read, one without agents, or a damaged agent.
    pub fn read(path: &Path) -> Result<Self, AgentError> {
        let folder = Folder::open(path)?;
        let mut agents = Vec::new();
        for entry in folder.entries(Path::new(""))?.into_iter().filter(|entry| entry.kind == Kind::Folder) {
            match Agent::read(&path.join(entry.name)) {
                Ok(agent) => agents.push(agent),
                Err(AgentError::Missing { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        match agents.is_empty() {
            true => Err(AgentError::NoAgents { folder: path.display().to_string() }),
            false => Ok(Self::of(agents)),
        }
    }

    /// Sorted by success and return when they were last evaluated; those that were not come last, and equal ones stay in their order.
    fn of(mut agents: Vec<Agent>) -> Self {
        agents.sort_by(|one, other| {
            let [one, other] = [one, other].map(|agent| agent.description.evaluation.map(|found| [found.success, found.total]));
            other.partial_cmp(&one).unwrap_or(Ordering::Equal)
        });
        Self { agents: agents.into_iter().map(Arc::new).collect() }
    }

    /// The best that was trained on the task of an engine.
    ///
    /// # Errors
    /// There is none, in words that say why.
    pub fn best(&self, engine: &Engine) -> Result<Arc<Agent>, String> {
        let name = &engine.task().name;
        let mut nearest = None;
        for agent in &self.agents {
            match agent.unfit(engine) {
                None => return Ok(agent.clone()),
                Some(Unfit::Numbers(reason) | Unfit::Meaning(reason)) if agent.description.task == *name => {
                    nearest = nearest.or(Some(reason));
                }
                Some(_) => {}
            }
        }
        Err(nearest.unwrap_or_else(|| {
            let tasks: BTreeSet<String> = self.agents.iter().map(|agent| format!("`{}`", agent.description.task)).collect();
            format!("no agent was trained on `{name}`, only on {}", Vec::from_iter(tasks).join(", "))
        }))
    }

    /// The agents, the best first.
    pub fn agents(&self) -> &[Arc<Agent>] {
        &self.agents
    }

    /// What tells them from others: a hash of their networks.
    pub fn digest(&self) -> String {
        let mut hasher = Sha256::new();
        self.agents.iter().for_each(|agent| hasher.update(agent.digest()));
        hexadecimal(&hasher.finalize()[..4])
    }
}
