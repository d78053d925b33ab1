//! The compiler's tests use a fixture in place of the body: it must equal the vocabulary of the body.
//!
//! Written by `cargo run -- vocabulary --json | jq -c .body > compiler/tests/fixtures/human_vocabulary.json`.

use msk::compiler::compile;
use msk::compiler::files::BodySource;
use msk::runtime::library::{BodyLibrary, FileLoader};
use serde_json::Value;
use std::path::Path;

/// Whether two values are the same but for roundings in numbers.
fn same(left: &Value, right: &Value) -> bool {
    match (left, right) {
        (Value::Number(a), Value::Number(b)) => match (a.as_f64(), b.as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * (1.0 + a.abs()),
            _ => false,
        },
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| same(a, b)))
        }
        _ => left == right,
    }
}

#[test]
fn the_fixture_of_the_compiler_is_the_vocabulary_of_the_body() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = BodyLibrary::default();
    let compilation = compile(&root.join("bodies/human.msk"), &FileLoader, &library).unwrap_or_else(|report| panic!("{report}"));
    let found = serde_json::to_value(library.vocabulary(&compilation.bodies[0]).unwrap()).unwrap();
    let fixture = std::fs::read_to_string(root.join("compiler/tests/fixtures/human_vocabulary.json")).unwrap();
    assert!(same(&found, &serde_json::from_str(&fixture).unwrap()), "the fixture is out of date");
}
