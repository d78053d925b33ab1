//! The messages that a policy process reads and writes: objects, as lines of JSON or in MessagePack. `docs/policies.md` describes them
//! for authors.

use crate::policy::PolicyContext;
use serde::{Deserialize, Serialize};
use std::io::{ErrorKind, Read};

/// Version of the protocol. It changes when a program written for the former one would no longer work.
const VERSION: u32 = 1;

/// How messages are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// One object per line.
    Json,
    /// One object after the other.
    MessagePack,
}

/// What is sent.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Request<'a> {
    /// Before the first episode of a task.
    Task(TaskDescription<'a>),
    /// At every control step.
    Act {
        seed: u64,
        episode: u64,
        /// 0 right after a reset.
        step: u32,
        observation: &'a [f64],
    },
}

/// What there is to observe and to move.
#[derive(Serialize)]
pub(super) struct TaskDescription<'a> {
    protocol: u32,
    name: &'a str,
    hash: &'a str,
    body: &'a str,
    /// s.
    control_period: f64,
    /// Control steps.
    horizon: u32,
    observation: Vec<Channel<'a>>,
    /// Names of the entries of an action.
    action: Vec<String>,
}

#[derive(Serialize)]
struct Channel<'a> {
    name: &'a str,
    size: usize,
    unit: &'a str,
}

/// A reply; exactly one of its members stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Reply {
    /// To a task: the process can act on it.
    pub ready: Option<bool>,
    /// To an observation.
    pub action: Option<Vec<f64>>,
    /// To anything: why the process cannot.
    pub error: Option<String>,
}

impl<'a> TaskDescription<'a> {
    pub fn of(context: &PolicyContext<'a>) -> Self {
        let task = context.task;
        let channel =
            |channel: &'a msk_program::task::Channel| Channel { name: &channel.name, size: channel.size, unit: &channel.unit };
        Self {
            protocol: VERSION,
            name: &task.name,
            hash: &task.hash,
            body: &task.body.name,
            control_period: 1.0 / task.control_frequency,
            horizon: task.horizon,
            observation: task.channels.iter().map(channel).collect(),
            action: task.action.names(&task.vocabulary),
        }
    }
}

impl<'a> Request<'a> {
    pub fn act(context: &PolicyContext<'a>) -> Self {
        Self::Act { seed: context.key.seed, episode: context.key.episode, step: context.step, observation: context.observation }
    }

    /// As bytes.
    ///
    /// # Errors
    /// Why it cannot be written, in words.
    pub fn encoded(&self, encoding: Encoding) -> Result<Vec<u8>, String> {
        match encoding {
            Encoding::Json => {
                serde_json::to_string(self).map(|text| (text + "\n").into_bytes()).map_err(|error| error.to_string())
            }
            Encoding::MessagePack => rmp_serde::to_vec_named(self).map_err(|error| error.to_string()),
        }
    }
}

impl Reply {
    /// The next object of MessagePack.
    ///
    /// # Errors
    /// What is wrong with it, in words; nothing if it has no end.
    pub fn of_message_pack(bytes: impl Read) -> Result<Self, Option<String>> {
        use rmp_serde::decode::Error;
        let reply: Self = rmp_serde::from_read(bytes).map_err(|error| match &error {
            Error::InvalidMarkerRead(ends) | Error::InvalidDataRead(ends) if ends.kind() == ErrorKind::UnexpectedEof => None,
            _ => Some(format!("its reply does not follow the protocol: {}", shortened(&error.to_string()))),
        })?;
        let word = |value: &f64| if value.is_nan() { "NaN" } else { "Infinity" };
        match reply.action.iter().flatten().find(|value| !value.is_finite()) {
            Some(value) => Err(Some(not_a_number(word(value)))),
            None => Ok(reply),
        }
    }

    /// From a line of JSON.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn of_json(line: &[u8]) -> Result<Self, String> {
        serde_json::from_slice(line).map_err(|error| {
            let text = String::from_utf8_lossy(line);
            let no_number = ["NaN", "Infinity"].into_iter().find(|word| text.contains(word) && text.contains("\"action\""));
            match no_number {
                Some(word) => not_a_number(word),
                None => format!("its reply does not follow the protocol: `{}` ({error})", shortened(text.trim())),
            }
        })
    }
}

fn not_a_number(word: &str) -> String {
    format!("its action contains {word}, which is not a number")
}

/// The beginning of what somebody else wrote.
pub(super) fn shortened(text: &str) -> String {
    const LONGEST: usize = 200;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replies_are_one_of_three_objects() {
        assert_eq!(Reply::of_json(br#"{"ready": true}"#).map(|reply| reply.ready), Ok(Some(true)));
        assert_eq!(Reply::of_json(br#"{"action": [0, -1, 0.5]}"#).map(|reply| reply.action), Ok(Some(vec![0.0, -1.0, 0.5])));
        assert_eq!(Reply::of_json(br#"{"error": "no"}"#).map(|reply| reply.error), Ok(Some("no".to_owned())));
    }

    #[test]
    fn what_is_no_reply_is_shown() {
        let wrong = |line: &str| Reply::of_json(line.as_bytes()).err().unwrap_or_default();
        assert_eq!(wrong(r#"{"action": [NaN]}"#), "its action contains NaN, which is not a number");
        assert_eq!(wrong(r#"{"action": [-Infinity]}"#), "its action contains Infinity, which is not a number");
        assert!(wrong("loading weights").starts_with("its reply does not follow the protocol: `loading weights` ("));
        assert!(wrong(r#"{"actions": [0]}"#).contains("unknown field `actions`"));
        assert!(wrong(r#"{"action": [1e999]}"#).contains("number out of range"));
        assert!(wrong(&"é".repeat(1000)).chars().count() < 400);
    }
}
