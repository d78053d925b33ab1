//! Reading a reasoner's answer.

use super::{Request, Secrets};
use msk_compiler::diagnostics::nearest;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Weights that are proposed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Proposal {
    /// The terms that shall change, with their weights; others stay.
    pub weights: Vec<(String, f64)>,
    /// Why, in the reasoner's words; may be empty.
    pub reason: String,
    /// Who answered, if the reply names it: the model behind an endpoint.
    pub by: String,
}

/// Why an answer is no proposal.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReplyError {
    /// No object of JSON in it, or only half of one.
    #[error("expected one JSON object such as {{\"weights\": {{\"pose\": 11.5}}, \"reason\": \"...\"}}: {0}")]
    NoObject(String),
    /// Something else than a number.
    #[error("expected a finite number for `{term}`, found {found}")]
    NoNumber {
        /// The term.
        term: String,
        /// What is there.
        found: String,
    },
    /// A term that is not there.
    #[error("there is no term `{term}`{}", .nearest.as_ref().map_or(String::new(), |near| format!("; did you mean `{near}`?")))]
    UnknownTerm {
        /// As proposed.
        term: String,
        /// Which may have been meant.
        nearest: Option<String>,
    },
}

/// The proposal in an answer: the first JSON object in the text, either of weights, or with weights and a reason.
///
/// Nothing else of the text comes back than terms of the task, numbers, and words without the `secrets`.
///
/// # Errors
/// An answer without such an object, or one with other things in it than numbers for terms of the task.
pub fn read(text: &str, request: &Request, secrets: &Secrets) -> Result<Proposal, ReplyError> {
    let object = object(text)?;
    let (weights, reason) = match object.get("weights") {
        Some(Value::Object(weights)) => (weights, object.get("reason").and_then(Value::as_str).unwrap_or_default().to_owned()),
        _ => (&object, String::new()),
    };
    let names: Vec<&str> = request.statistics.terms.iter().map(|term| term.term.as_str()).collect();
    let mut proposed = Vec::new();
    for (term, value) in weights {
        if !names.contains(&term.as_str()) {
            let nearest = nearest(term, names.iter().copied()).first().map(|near| (*near).to_owned());
            return Err(ReplyError::UnknownTerm { term: secrets.shown(term), nearest });
        }
        let number = value.as_f64().filter(|number| number.is_finite());
        let number = number.ok_or_else(|| {
            let found = secrets.shown_body(&value.to_string());
            ReplyError::NoNumber { term: term.clone(), found }
        })?;
        proposed.push((term.clone(), number));
    }
    // In the task's order, whatever the order of the answer.
    proposed.sort_by_key(|(term, _)| names.iter().position(|name| name == term));
    Ok(Proposal { weights: proposed, reason: secrets.shown(&reason), by: String::new() })
}

/// The first whole JSON object in a text; models like to put words and fences around it.
fn object(text: &str) -> Result<Map<String, Value>, ReplyError> {
    let Some(begin) = text.find('{') else {
        return Err(ReplyError::NoObject("there is none".into()));
    };
    let mut values = serde_json::Deserializer::from_str(&text[begin..]).into_iter::<Map<String, Value>>();
    match values.next() {
        Some(Ok(object)) => Ok(object),
        Some(Err(error)) if error.is_eof() => Err(ReplyError::NoObject("it ends in the middle".into())),
        Some(Err(error)) => Err(ReplyError::NoObject(error.to_string())),
        None => Err(ReplyError::NoObject("there is none".into())),
    }
}
