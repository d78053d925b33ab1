//! Any text is read: no panic, no hang, every place within the text.

#![no_main]

mod language;

use libfuzzer_sys::fuzz_target;
use msk_compiler::diagnostics::{Report, SourceMap};
use msk_compiler::syntax::parse;

fuzz_target!(|text: &str| {
    let mut sources = SourceMap::default();
    let file = sources.add(language::ENTRY, text);
    let parsed = parse(file, text);
    for comment in &parsed.comments {
        assert!(text.get(comment.span.range()).is_some_and(|comment| comment.starts_with("//")));
    }
    language::must_be_sound(&Report::new(sources, parsed.diagnostics));
});
