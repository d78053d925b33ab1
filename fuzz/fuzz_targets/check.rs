//! Any text is compiled or refused; a text that begins with a zero byte is a program grown from the bytes behind it.

#![no_main]

mod language;

use libfuzzer_sys::fuzz_target;
use msk_compiler::inspect;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let Some(text) = language::text(bytes) else { return };
    let whole = inspect(Path::new(language::ENTRY), &language::Texts(&text), &language::Human);
    language::must_be_sound(&whole.report);
    for scope in &whole.scopes {
        let sources = &whole.report.sources;
        let exprs = scope.typed.iter().flat_map(|typed| typed.hir().exprs());
        let mut places = exprs.map(|expr| (expr.file, expr.span));
        assert!(places.all(|(file, span)| sources.text(file).get(span.range()).is_some()));
    }
});
