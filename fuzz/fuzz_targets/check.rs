//! Any text is compiled or refused; a text that begins with a zero byte is a program grown from the bytes behind it.

#![no_main]

#[path = "../../compiler/tests/support/generate.rs"]
mod generate;
mod language;

use libfuzzer_sys::fuzz_target;
use msk_compiler::inspect;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let text = match bytes.split_first() {
        Some((0, seed)) => generate::program(seed),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => return,
        },
    };
    let whole = inspect(Path::new(language::ENTRY), &language::Texts(&text), &language::Human);
    language::must_be_sound(&whole.report);
    for scope in &whole.scopes {
        let sources = &whole.report.sources;
        assert!(scope.notes.iter().all(|note| sources.text(note.file).get(note.span.range()).is_some()));
    }
});
