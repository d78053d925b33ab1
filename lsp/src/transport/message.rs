//! From the body of a frame to a message of JSON-RPC, or to the error that answers it.

use super::surrogates;
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use serde::Deserialize;
use serde_json::{Map, Value};

/// Why a body is no message, with what its answer needs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Malformed {
    /// The identifier of the request; null if it cannot be known.
    pub(super) id: Value,
    /// The code of the error.
    pub(super) code: i32,
    /// What was expected and what was found.
    pub(super) reason: String,
}

impl Malformed {
    pub(super) fn new(id: Value, code: ErrorCode, reason: impl Into<String>) -> Self {
        Self { id, code: code as i32, reason: reason.into() }
    }
}

/// What a body holds. A notification whose only defect are lone surrogates is both: dropping a change of a text would leave the
/// server with another text than the editor has.
#[derive(Debug, Default)]
pub(super) struct Decoded {
    pub(super) message: Option<Message>,
    pub(super) malformed: Option<Malformed>,
}

/// What can be known of a body whose strings cannot all be decoded.
#[derive(Deserialize)]
struct Envelope {
    id: Option<Value>,
    method: Option<String>,
}

/// Decodes a body.
pub(super) fn decode(body: &[u8]) -> Decoded {
    let error = match std::str::from_utf8(body) {
        Ok(text) => match serde_json::from_str::<Value>(text) {
            Ok(value) => return Decoded::from(classify(value)),
            Err(error) => format!("expected JSON, found {error}"),
        },
        Err(error) => format!("expected UTF-8, found another byte at {}", error.valid_up_to()),
    };
    let envelope = serde_json::from_slice::<Envelope>(body).ok();
    let notifies = envelope.as_ref().is_some_and(|envelope| envelope.id.is_none() && envelope.method.is_some());
    let id = envelope.and_then(|envelope| envelope.id).map_or(Value::Null, echoed);
    let replaced = std::str::from_utf8(body).ok().filter(|_| notifies).map(surrogates::replace_lone);
    let message = replaced.and_then(|text| classify(serde_json::from_str(&text).ok()?).ok());
    let note = if message.is_some() { "; lone surrogates are read as U+FFFD" } else { "" };
    Decoded { message, malformed: Some(Malformed::new(id, ErrorCode::ParseError, error + note)) }
}

impl From<Result<Message, Malformed>> for Decoded {
    fn from(result: Result<Message, Malformed>) -> Self {
        match result {
            Ok(message) => Self { message: Some(message), malformed: None },
            Err(malformed) => Self { message: None, malformed: Some(malformed) },
        }
    }
}

fn classify(value: Value) -> Result<Message, Malformed> {
    let invalid = |id: Value, reason: &str| Err(Malformed::new(echoed(id), ErrorCode::InvalidRequest, reason));
    let mut fields = match value {
        Value::Object(fields) => fields,
        Value::Array(_) => return invalid(Value::Null, "expected one message, found a list: batches are not supported"),
        _ => return invalid(Value::Null, "expected a message: an object with `method`"),
    };
    let id = fields.remove("id");
    let params = fields.remove("params").unwrap_or_default();
    match (fields.remove("method"), id) {
        (Some(Value::String(method)), None) => Ok(Notification { method, params }.into()),
        (Some(Value::String(method)), Some(id)) => match request_id(&id) {
            Some(id) => Ok(Request { id, method, params }.into()),
            None => invalid(id, "expected an `id` that is a string or an integer of 32 bits"),
        },
        (Some(_), id) => invalid(id.unwrap_or_default(), "expected a `method` that is a string"),
        (None, id) => match (id.as_ref().and_then(request_id), answers(&fields)) {
            (Some(id), true) => Ok(Response { id, result: fields.remove("result"), error: None }.into()),
            _ => invalid(id.unwrap_or_default(), "expected a `method`"),
        },
    }
}

/// Whether a message without a method is the answer to one.
fn answers(fields: &Map<String, Value>) -> bool {
    fields.contains_key("result") || fields.contains_key("error")
}

fn request_id(id: &Value) -> Option<RequestId> {
    match id {
        Value::String(id) => Some(RequestId::from(id.clone())),
        Value::Number(id) => Some(RequestId::from(i32::try_from(id.as_i64()?).ok()?)),
        _ => None,
    }
}

/// An identifier as an answer repeats it: strings and numbers, else null.
fn echoed(id: Value) -> Value {
    if id.is_string() || id.is_number() { id } else { Value::Null }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    const PARSE: i32 = ErrorCode::ParseError as i32;
    const INVALID: i32 = ErrorCode::InvalidRequest as i32;

    #[test]
    fn requests_notifications_and_answers_are_distinguished() {
        let message = |text: &str| decode(text.as_bytes()).message.unwrap();
        assert!(matches!(message(r#"{"id":1,"method":"a"}"#), Message::Request(request) if request.id == 1.into()));
        assert!(
            matches!(message(r#"{"id":"1","method":"a"}"#), Message::Request(request) if request.id == "1".to_owned().into())
        );
        assert!(
            matches!(message(r#"{"method":"a","params":[1]}"#), Message::Notification(notification) if notification.params == json!([1]))
        );
        assert!(matches!(message(r#"{"id":1,"result":null}"#), Message::Response(_)));
        assert!(matches!(message(r#"{"id":1,"error":{}}"#), Message::Response(_)));
    }

    #[test]
    fn what_is_no_message_is_answered_under_its_identifier() {
        let cases = [
            ("", PARSE, Value::Null),
            ("{", PARSE, Value::Null),
            ("nonsense", PARSE, Value::Null),
            (r#"{"id":5,"method":"a""#, PARSE, Value::Null),
            (r#"{"id":5,"method":"a","params":"\ud800"}"#, PARSE, json!(5)),
            (r#"{"params":["\udc00\ud800\ud800"],"method":"a","id":"x"}"#, PARSE, json!("x")),
            (r#"{"id":5,"method":"\ud800"}"#, PARSE, Value::Null),
            (r#"{"id":5,"method":"a","params":1e999}"#, PARSE, json!(5)),
            ("[]", INVALID, Value::Null),
            (r#"[{"id":1,"method":"a"}]"#, INVALID, Value::Null),
            ("7", INVALID, Value::Null),
            ("{}", INVALID, Value::Null),
            (r#"{"id":7}"#, INVALID, json!(7)),
            (r#"{"id":7,"method":3}"#, INVALID, json!(7)),
            (r#"{"id":null,"method":"a"}"#, INVALID, Value::Null),
            (r#"{"id":1.5,"method":"a"}"#, INVALID, json!(1.5)),
            (r#"{"id":4000000000,"method":"a"}"#, INVALID, json!(4_000_000_000_u64)),
            (r#"{"id":[1],"method":"a"}"#, INVALID, Value::Null),
        ];
        for (text, code, id) in cases {
            let Decoded { message, malformed } = decode(text.as_bytes());
            assert!(message.is_none(), "{text}");
            let malformed = malformed.unwrap();
            assert_eq!((malformed.code, malformed.id), (code, id), "{text}: {}", malformed.reason);
        }
        let deep = "[".repeat(100_000);
        assert_eq!(decode(deep.as_bytes()).malformed.unwrap().code, PARSE);
        let Decoded { message, malformed } = decode(b"{\"id\":9,\"method\":\"a\",\"params\":\"\xff\"}");
        assert!(message.is_none());
        assert_eq!(malformed.unwrap().id, json!(9));
    }

    #[test]
    fn a_change_of_a_text_with_a_lone_surrogate_is_reported_and_kept() {
        let Decoded { message, malformed } = decode(br#"{"method":"a","params":["x\ud800y","\ud834\udd1e"]}"#);
        assert!(
            matches!(message, Some(Message::Notification(notification)) if notification.params == json!(["x\u{fffd}y", "\u{1d11e}"]))
        );
        assert_eq!(malformed.unwrap().code, PARSE);
    }

    proptest! {
        #[test]
        fn every_body_is_a_message_or_an_error(body in proptest::collection::vec(any::<u8>(), 0..200)) {
            let Decoded { message, malformed } = decode(&body);
            prop_assert!(message.is_some() || malformed.is_some());
        }

        #[test]
        fn every_json_is_a_message_or_an_error(text in r#"\{("(id|method|params|result)":("a"|1|null|\{\}|"\\ud800"),?){0,4}\}"#) {
            let Decoded { message, malformed } = decode(text.as_bytes());
            prop_assert!(message.is_some() || malformed.is_some());
        }
    }
}
