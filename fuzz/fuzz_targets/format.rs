//! The layout of a text that can be read can be read, is its own layout, and means the same.

#![no_main]

mod language;

use libfuzzer_sys::fuzz_target;
use msk_compiler::diagnostics::FileId;
use msk_compiler::format::{FormatError, format};

fuzz_target!(|bytes: &[u8]| {
    let Some(text) = language::text(bytes) else { return };
    match format(FileId::default(), &text) {
        Ok(tidy) => assert_eq!(format(FileId::default(), &tidy).as_deref(), Ok(tidy.as_str()), "{text:?}"),
        Err(FormatError::Changed) => panic!("the layout of {text:?} would say something else"),
        Err(FormatError::Unreadable(diagnostics)) => assert!(!diagnostics.is_empty()),
    }
});
