//! Programs grown from bytes: most compile, all are answered, and formatting keeps their content.

#[path = "support/generate.rs"]
mod generate;
#[allow(dead_code, reason = "the pages have their own tests")]
use crate::support;

use msk_compiler::check::functions::signature::Shapes;
use msk_compiler::check::functions::{Checks, FUNCTIONS, OPERATORS};
use msk_compiler::diagnostics::FileId;
use msk_compiler::format::format;
use proptest::prelude::*;
use std::cell::Cell;
use support::compiling::compile_text;

#[test]
fn programs_grown_from_bytes_are_answered_and_laid_out() {
    let (compiled, all) = (Cell::new(0), Cell::new(0));
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) };
    proptest!(config, |(bytes in prop::collection::vec(any::<u8>(), 20..300))| {
        let text = generate::program(&bytes);
        let tidy = format(FileId::default(), &text).unwrap_or_else(|error| panic!("{error:?} in\n{text}"));
        let again = format(FileId::default(), &tidy).unwrap();
        prop_assert_eq!(&again, &tidy);
        all.set(all.get() + 1);
        match compile_text(&tidy, &[]) {
            Ok(_) => compiled.set(compiled.get() + 1),
            Err(report) => prop_assert!(report.has_errors()),
        }
    });
    // A generator whose programs were refused would test nothing behind the checker.
    assert!(compiled.get() * 10 > all.get(), "{} of {}", compiled.get(), all.get());
}

/// The grower writes every function with one value and with a list.
#[test]
fn every_function_is_grown_in_every_shape() {
    let mut calls = String::new();
    for seed in 0..40_000_u32 {
        let bytes: Vec<u8> = (0..12).map(|place| (seed.wrapping_mul(2_654_435_761).rotate_left(place * 5) >> 8) as u8).collect();
        calls += &generate::any_call(&mut generate::Choices::new(&bytes), 0);
        calls.push('\n');
    }
    for function in FUNCTIONS.iter().chain(OPERATORS) {
        let Checks::Signatures(signatures) = &function.checks else { continue };
        let written = |start: String, list: bool| {
            calls.lines().filter_map(|call| call.strip_prefix(start.as_str())).any(|rest| rest.starts_with('[') == list)
        };
        let start = format!("{}(", function.name);
        assert!(written(start.clone(), true), "no list in `{}`", function.name);
        let only_lists = signatures.iter().all(|signature| signature.parameters[0].shapes == Shapes::List);
        assert!(only_lists || written(start, false), "nothing but lists in `{}`", function.name);
    }
}

#[test]
fn the_shortest_program_compiles() {
    let text = generate::program(&[]);
    assert!(compile_text(&text, &[]).is_ok(), "{}\n{text}", compile_text(&text, &[]).err().unwrap());
}
