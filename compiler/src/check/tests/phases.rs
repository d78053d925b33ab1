//! The tests of a sequence: every phase checks them by its own names, here they become one.
//!
//! Scripts mean the same in every phase, since scene and initial state are shared: they are the first's. An expectation is read
//! in the phase that is present at its moment, so each phase reports which number that is, if it has any; one that no phase has
//! is an error.

use super::{CheckedTests, Found};
use crate::diagnostics::{Checked, Diagnostic, Failures};
use crate::testing::{Check, Expectation, Probe};

impl CheckedTests {
    /// Puts what all phases know of the tests into those of the first phase.
    ///
    /// # Errors
    /// What no phase of the sequence can read, as the first phase reports it.
    pub(crate) fn gather(phases: &mut [&mut Self], diagnostics: &mut Vec<Diagnostic>) -> Checked<()> {
        let known: Vec<Vec<Vec<Found>>> = phases.iter_mut().map(|phase| std::mem::take(&mut phase.found)).collect();
        let Some(first) = phases.first_mut() else { return Ok(()) };
        diagnostics.append(&mut first.diagnostics);
        let mut failures = Failures::default();
        if let Some(reported) = first.broken {
            failures.add(reported);
        }
        for (place, test) in first.tests.iter_mut().enumerate() {
            for row in 0..known[0].get(place).map_or(0, Vec::len) {
                let of_row = |phase: &Vec<Vec<Found>>| phase.get(place)?.get(row).cloned();
                match together(known.iter().map(of_row).collect()) {
                    Some(Ok(expectations)) => test.expectations.extend(expectations),
                    Some(Err((reported, why))) => {
                        failures.add(reported);
                        diagnostics.extend(why);
                    }
                    // No phase has looked at it: its test is broken, and reported.
                    None => {}
                }
            }
            test.drop_unread();
        }
        failures.or(())
    }
}

/// What the phases know of one `expect`.
fn together(found: Vec<Option<Found>>) -> Option<Found> {
    let phases = found.len();
    let mut whole: Option<Vec<Expectation>> = None;
    let mut why = None;
    for (phase, found) in found.into_iter().enumerate() {
        match found {
            Some(Ok(parts)) => {
                let whole = whole.get_or_insert_with(|| parts.iter().map(|part| of_none(part.clone(), phases)).collect());
                for (whole, part) in whole.iter_mut().zip(&parts) {
                    learn(whole, part, phase);
                }
            }
            Some(Err(error)) => {
                why.get_or_insert(error);
            }
            None => {}
        }
    }
    let Some(mut whole) = whole else { return why.map(Err) };
    whole.iter_mut().for_each(Expectation::settle);
    Some(Ok(whole))
}

/// The same, read in no phase yet.
fn of_none(mut expectation: Expectation, phases: usize) -> Expectation {
    let none = |probe: &mut Probe| *probe = vec![None; phases];
    match &mut expectation.check {
        Check::Holds { probe, .. } => none(probe),
        Check::Order { sides, .. } => sides.iter_mut().for_each(|side| none(&mut side.probe)),
    }
    expectation
}

/// Takes from a phase what it reads there, if the expectation has the same form in it.
fn learn(whole: &mut Expectation, of_phase: &Expectation, phase: usize) {
    let copy = |mine: &mut Probe, theirs: &Probe| {
        if let Some(slot) = mine.get_mut(phase) {
            *slot = theirs.first().copied().flatten();
        }
    };
    match (&mut whole.check, &of_phase.check) {
        (Check::Holds { probe, .. }, Check::Holds { probe: theirs, .. }) => copy(probe, theirs),
        (Check::Order { sides, .. }, Check::Order { sides: theirs, .. }) if sides.len() == theirs.len() => {
            for (mine, theirs) in sides.iter_mut().zip(theirs) {
                copy(&mut mine.probe, &theirs.probe);
                // What differs from phase to phase is worth telling.
                mine.constant &= theirs.constant;
            }
        }
        _ => {}
    }
}
