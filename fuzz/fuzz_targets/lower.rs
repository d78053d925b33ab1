//! A program that compiles computes, step by step and bit by bit, what the plain interpreter of its graph does.

#![no_main]

mod language;

use libfuzzer_sys::fuzz_target;
use msk_compiler::task::{CompiledTask, StepReport, TaskState};
use msk_compiler::{Middle, PlainTask, Snapshot, inspect};
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    // The first bytes are what is measured, the others what is written.
    let (numbers, seed) = bytes.split_at(bytes.len().min(16));
    let text = language::generate::program(seed);
    let whole = inspect(Path::new(language::ENTRY), &language::Texts(&text), &language::Human);
    for task in &whole.tasks {
        compare(task, numbers, &text);
    }
});

fn compare(task: &CompiledTask, numbers: &[u8], text: &str) {
    let Some(mut plain) = PlainTask::of(task) else { return };
    let (mut state, mut report) = (TaskState::default(), StepReport::default());
    let mut observation = vec![0.0; task.observation_size()];
    for step in 0..12_usize {
        let measured = |lane: usize| match numbers.get((lane + 5 * step) % 16) {
            Some(byte) => (f64::from(*byte) - 120.0) / 64.0 + lane as f64 * 1e-3,
            None => 0.5 + lane as f64 * 1e-3,
        };
        let frame: Vec<f64> = (0..task.frame.size()).map(measured).collect();
        if step == 0 {
            task.reset(&frame, &mut Middle, &mut state).expect("nothing is drawn");
            task.report(&frame, &task.weights(), &state, &mut report);
        } else {
            // A term that is no number is reported, and computed all the same.
            let _ = task.step(&frame, &task.weights(), &mut Middle, &mut state, &mut report);
        }
        task.observe(&frame, &state, &mut observation);
        let found = Snapshot {
            terms: report.terms.clone(),
            ends: [report.terminations.clone(), report.finishes.clone()].concat(),
            success: report.success,
            metrics: report.metrics.clone(),
            channels: observation.clone(),
        };
        let expected = plain.next(&frame);
        assert!(same(&found, &expected), "step {step} of\n{text}\nfound {found:?}\nexpected {expected:?}");
    }
}

/// The same bits; two values that are no numbers are the same.
fn same(a: &Snapshot, b: &Snapshot) -> bool {
    let equal = |a: &[f64], b: &[f64]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
    };
    let numbers = equal(&a.terms, &b.terms) && equal(&a.metrics, &b.metrics) && equal(&a.channels, &b.channels);
    numbers && a.ends == b.ends && a.success == b.success
}
