//! Any text given as a weights file, and any wish of a reasoner: read or refused, laid over a task or refused, and what is written reads
//! back.

#![no_main]

mod language;

use libfuzzer_sys::fuzz_target;
use msk_compiler::compile;
use msk_compiler::diagnostics::{Report, SourceMap};
use msk_compiler::task::{CompiledTask, Origin};
use msk_tuning::overlay::Overlay;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Two tasks, one of them bounded and with a fixed weight.
const TASKS: &str = include_str!("../seeds/weights.msk");

fn tasks() -> &'static [Arc<CompiledTask>] {
    static COMPILED: OnceLock<Vec<Arc<CompiledTask>>> = OnceLock::new();
    COMPILED.get_or_init(|| {
        let compiled = compile(Path::new(language::ENTRY), &language::Texts(TASKS), &language::Human);
        compiled.unwrap_or_else(|report| panic!("{}", report.to_json())).tasks
    })
}

fuzz_target!(|text: &str| {
    let mut sources = SourceMap::default();
    let overlay = match Overlay::read("weights.toml", text, &mut sources) {
        Ok(overlay) => overlay,
        Err(diagnostics) => {
            assert!(!diagnostics.is_empty(), "refused without a word: {text:?}");
            return language::must_be_sound(&Report::new(sources, diagnostics));
        }
    };
    assert!(overlay.lines().iter().all(|line| line.weight.is_finite()));
    match overlay.apply(tasks(), &Origin::CommandLine) {
        Err(diagnostics) => {
            assert!(!diagnostics.is_empty(), "refused without a word: {text:?}");
            language::must_be_sound(&Report::new(sources, diagnostics));
        }
        Ok(laid) => {
            for (task, before) in laid.iter().zip(tasks()) {
                assert!(task.weights().iter().all(|weight| weight.is_finite()), "{text:?}");
                // What the author fixed stays.
                assert_eq!(task.weights().len(), before.weights().len());
            }
        }
    }
});
