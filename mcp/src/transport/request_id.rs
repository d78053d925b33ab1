//! The id of a request that is not parsed.
//!
//! A line that is too long, or that the JSON parser refuses for a detail deep inside, may still be a request whose sender waits for an
//! answer. The answer needs the request's id. Clients write it before or after the parameters, so the whole line is scanned, piece by
//! piece, in constant memory.

use serde_json::Value;

/// Longest name and longest id that are kept, bytes.
const LONGEST: usize = 256;

/// Reads a JSON object in pieces and keeps its member `id`.
#[derive(Debug, Default)]
pub struct RequestIdScanner {
    depth: usize,
    in_string: bool,
    escaped: bool,
    /// Whether the value of a member is being read, and not its name.
    in_value: bool,
    name: Vec<u8>,
    value: Vec<u8>,
    id: Option<Value>,
    /// The object has been closed.
    closed: bool,
    /// The text is no object, whatever follows.
    broken: bool,
}

impl RequestIdScanner {
    /// Reads the next piece.
    pub fn read(&mut self, piece: &[u8]) {
        piece.iter().for_each(|byte| self.byte(*byte));
    }

    /// The id, if the text was one whole object with an id: a string or an integer.
    pub fn id(self) -> Option<Value> {
        self.id.filter(|_| self.closed && !self.broken)
    }

    fn byte(&mut self, byte: u8) {
        if self.in_string {
            self.keep(byte);
            match (self.escaped, byte) {
                (false, b'\\') => self.escaped = true,
                (false, b'"') => self.in_string = false,
                _ => self.escaped = false,
            }
            return;
        }
        match byte {
            b' ' | b'\t' | b'\r' | b'\n' => {}
            b'{' if self.depth == 0 && !self.closed => self.depth = 1,
            _ if self.depth == 0 => self.broken = true,
            b':' if self.depth == 1 => self.in_value = true,
            b',' if self.depth == 1 => self.end_member(),
            b'{' | b'[' => {
                // Kept, so that a value with parts never looks like an id.
                self.keep(byte);
                self.depth += 1;
            }
            b'}' | b']' => {
                self.depth -= 1;
                if self.depth == 0 {
                    self.end_member();
                    self.closed = true;
                }
            }
            _ => {
                self.in_string = byte == b'"';
                self.keep(byte);
            }
        }
    }

    fn keep(&mut self, byte: u8) {
        let text = if self.in_value { &mut self.value } else { &mut self.name };
        // One byte more than an id may have, so that a longer one is not taken for its beginning.
        if self.depth == 1 && text.len() <= LONGEST {
            text.push(byte);
        }
    }

    fn end_member(&mut self) {
        if self.name == b"\"id\"" && self.value.len() <= LONGEST {
            self.id = serde_json::from_slice(&self.value).ok().filter(is_id);
        }
        self.name.clear();
        self.value.clear();
        self.in_value = false;
    }
}

/// Whether a value may be the id of a request: a string or an integer.
pub fn is_id(value: &Value) -> bool {
    value.is_string() || value.is_i64() || value.is_u64()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn scanned(text: &str) -> Option<Value> {
        let mut scanner = RequestIdScanner::default();
        scanner.read(text.as_bytes());
        scanner.id()
    }

    #[test]
    fn only_the_id_of_the_outermost_object_counts() {
        assert_eq!(scanned(r#"{"jsonrpc":"2.0","id":7,"method":"x"}"#), Some(json!(7)));
        assert_eq!(
            scanned(r#" { "params" : { "id" : 1, "a": ["id", {"id": 2}] } , "id" : "se\"ven" } "#),
            Some(json!("se\"ven"))
        );
        assert_eq!(scanned(r#"{"params":{"text":"{\"id\":3,\ud800"},"id":-4}"#), Some(json!(-4)));
        for none in ["", "7", "{}", r#"{"id":null}"#, r#"{"id":1.5}"#, r#"{"id":[1]}"#, r#"{"id":{}1}"#, r#"{"a":{"id":1}}"#] {
            assert_eq!(scanned(none), None, "{none}");
        }
        for broken in [r#"{"id":1"#, r#"{"id":1}}"#, r#"x{"id":1}"#, r#"[{"id":1}]"#, r#"{"id":1} {"id":2}"#] {
            assert_eq!(scanned(broken), None, "{broken}");
        }
        assert_eq!(scanned(&format!(r#"{{"id":"{}"}}"#, "a".repeat(LONGEST))), None);
        assert_eq!(scanned(&format!(r#"{{"id":1{}}}"#, "0".repeat(2 * LONGEST))), None);
    }

    fn json() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::from),
            any::<i64>().prop_map(Value::from),
            ".*".prop_map(Value::from)
        ];
        leaf.prop_recursive(4, 32, 4, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
                prop::collection::btree_map("id|[a-z\"\\\\{}:,]*", inner, 0..4).prop_map(Value::from_iter),
            ]
        })
    }

    proptest! {
        #[test]
        fn the_scanner_finds_what_the_parser_finds(value in json()) {
            let expected = value.get("id").filter(|id| is_id(id) && id.to_string().len() <= LONGEST);
            prop_assert_eq!(scanned(&value.to_string()), expected.cloned());
        }

        #[test]
        fn any_text_is_scanned_to_its_end(text in ".*") {
            scanned(&text);
        }
    }
}
