//! Policies as a command line names them: built in, or from outside.

use super::outside::{Encoding, Network, Process, Replay, Weights};
use super::{Policy, PolicyError, create, present_name};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How long a policy from outside may take for a reply, unless it is set.
pub const TIMEOUT: Duration = Duration::from_secs(30);

/// What acts: the name of a built-in policy, `process COMMAND`, `process --messagepack COMMAND`, `network FILE` or `replay FILE`.
///
/// The text of tasks, journals and requests of other programs name built-in policies only ([`create`]): a source with a command is
/// made from what the user of a command line wrote.
#[derive(Debug, Clone)]
pub struct PolicySource {
    name: String,
    kind: Kind,
    timeout: Duration,
}

/// Opens policies that this crate does not know, one for each worker.
pub trait PolicyMaker: core::fmt::Debug + Send + Sync {
    /// Episodes that one worker should play at once.
    fn most_at_once(&self) -> usize {
        usize::MAX
    }

    /// Whether what it does depends on the weights of the task.
    fn reacts_to_weights(&self) -> bool {
        false
    }

    /// A policy of its own for one episode at a time. One that takes long gives up when `stop` becomes true.
    ///
    /// # Errors
    /// What keeps it from being opened.
    fn open<'a>(&self, stop: &'a AtomicBool) -> Result<Box<dyn Policy + 'a>, PolicyError>;
}

#[derive(Debug, Clone)]
enum Kind {
    BuiltIn,
    Made(Arc<dyn PolicyMaker>),
    Process(Vec<String>, Encoding),
    Network(Weights),
    Replay { path: String, bytes: Arc<[u8]> },
}

impl PolicySource {
    /// A built-in policy.
    ///
    /// # Errors
    /// An unknown name.
    pub fn built_in(name: &str) -> Result<Self, PolicyError> {
        create(name)?;
        Ok(Self { name: present_name(name).to_owned(), kind: Kind::BuiltIn, timeout: TIMEOUT })
    }

    /// A policy that `maker` opens; `name` contains everything that decides what it does.
    pub fn made(name: String, maker: Arc<dyn PolicyMaker>) -> Self {
        Self { name, kind: Kind::Made(maker), timeout: TIMEOUT }
    }

    /// What a command line names. Files are read here, so that all episodes see the same.
    ///
    /// # Errors
    /// An unknown name, `process` without a command, or a file that cannot be read or is no network.
    pub fn parse(text: &str) -> Result<Self, PolicyError> {
        let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        let (name, kind) = match word {
            "process" => {
                let mut command: Vec<String> = rest.split_whitespace().map(str::to_owned).collect();
                let encoding = match command.first().map(String::as_str) {
                    Some("--messagepack") => Encoding::MessagePack,
                    Some(option) if option.starts_with("--") => return Err(PolicyError::ProcessOption(option.to_owned())),
                    _ => Encoding::Json,
                };
                let name = format!("process {}", command.join(" "));
                command.drain(..usize::from(encoding == Encoding::MessagePack));
                if command.is_empty() {
                    return Err(PolicyError::Incomplete { policy: "process", example: "process python3 policy.py" });
                }
                (name, Kind::Process(command, encoding))
            }
            "network" if rest.is_empty() => {
                return Err(PolicyError::Incomplete { policy: "network", example: "network agent.safetensors" });
            }
            "replay" if rest.is_empty() => {
                return Err(PolicyError::Incomplete { policy: "replay", example: "replay actions.npy" });
            }
            // Results tell two files of one name apart.
            "network" => {
                let (weights, digest) = Weights::read(rest)?;
                (format!("network {rest} ({digest})"), Kind::Network(weights))
            }
            "replay" => {
                let (bytes, digest) = Replay::read(rest)?;
                (format!("replay {rest} ({digest})"), Kind::Replay { path: rest.to_owned(), bytes })
            }
            _ => {
                return Self::built_in(text).map_err(|error| match error {
                    PolicyError::Unknown(text) => PolicyError::UnknownSource(text),
                    error => error,
                });
            }
        };
        Ok(Self { name, kind, timeout: TIMEOUT })
    }

    /// The same with another limit for each reply of a process.
    #[must_use]
    pub fn with_timeout(self, timeout: Duration) -> Self {
        Self { timeout, ..self }
    }

    /// Its name in results.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Episodes that one worker should play at once: a process answers one after the other, and one for each worker is enough.
    pub fn most_at_once(&self) -> usize {
        match &self.kind {
            Kind::Process(..) => 1,
            Kind::Made(maker) => maker.most_at_once(),
            Kind::BuiltIn | Kind::Network(_) | Kind::Replay { .. } => usize::MAX,
        }
    }

    /// Whether what it does depends on the weights of the task: of the others, edited weights change what is counted and not what is done.
    pub fn reacts_to_weights(&self) -> bool {
        matches!(&self.kind, Kind::Made(maker) if maker.reacts_to_weights())
    }

    /// A policy of its own for one episode at a time. One that waits for a process gives up when `stop` becomes true.
    ///
    /// # Errors
    /// A process that cannot be started.
    pub fn open<'a>(&self, stop: &'a AtomicBool) -> Result<Box<dyn Policy + 'a>, PolicyError> {
        match &self.kind {
            Kind::BuiltIn => create(&self.name).map(|policy| policy as Box<dyn Policy>),
            Kind::Made(maker) => maker.open(stop),
            Kind::Process(command, encoding) => {
                Ok(Box::new(Process::start(&self.name, (command, *encoding), self.timeout, stop)?))
            }
            Kind::Network(weights) => Ok(Box::new(Network::new(&self.name, weights))),
            Kind::Replay { path, bytes } => Ok(Box::new(Replay::new(&self.name, path, bytes.clone()))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_named_as_results_name_them() {
        let name = |text: &str| PolicySource::parse(text).map(|source| source.name().to_owned());
        assert_eq!(name("cmc"), Ok("cmc".to_owned()));
        assert_eq!(name("posture"), Ok("cmc".to_owned()));
        assert_eq!(name("process  python3   p.py"), Ok("process python3 p.py".to_owned()));
        assert_eq!(name("process  --messagepack  ./agent x"), Ok("process --messagepack ./agent x".to_owned()));
        assert!(matches!(name("processes"), Err(PolicyError::UnknownSource(_))));
        let message = |text: &str| name(text).err().map(|error| error.to_string()).unwrap_or_default();
        assert_eq!(message("process "), "`process` needs a command: write `process python3 policy.py`");
        assert_eq!(message("process --messagepack"), "`process` needs a command: write `process python3 policy.py`");
        assert_eq!(
            message("process --cbor ./agent"),
            "`process` has no option `--cbor`: write `process COMMAND` for lines of JSON or `process --messagepack COMMAND`"
        );
        assert_eq!(message("network"), "`network` needs a file: write `network agent.safetensors`");
        assert_eq!(message("replay"), "`replay` needs a file: write `replay actions.npy`");
        assert!(message("replay nothing.npy").starts_with("cannot read `nothing.npy`"), "{}", message("replay nothing.npy"));
    }
}
