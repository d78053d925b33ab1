//! Weights over a compiled task: they stand beside its closures, so that nothing is compiled anew.

use super::{Bounds, Problem, Refused};
use crate::nearest::nearest;
use crate::task::{CompiledTask, Origin, Term};

impl CompiledTask {
    /// What a tuner may do with the weight of a term.
    pub fn weight_bounds(&self, term: usize) -> Bounds {
        let term = &self.terms[term];
        match term.weight_range {
            _ if term.fixed => Bounds::Fixed,
            Some([low, high]) => Bounds::Range(low, high),
            None => Bounds::Free,
        }
    }

    /// Which term has this name.
    ///
    /// # Errors
    /// None; with those that may have been meant.
    pub fn find_term(&self, name: &str) -> Result<usize, Problem> {
        self.terms.iter().position(|term| term.name == name).ok_or_else(|| {
            let near = nearest(name, self.terms.iter().map(|term| term.name.as_str()));
            Problem::Unknown { term: format!("{}.{name}", self.name), nearest: near.into_iter().map(str::to_owned).collect() }
        })
    }

    /// Between which values a term without its weight stays, as far as the compiler knows; infinite where it does not.
    pub fn term_range(&self, term: usize) -> [f64; 2] {
        let phase = self.phases.iter().find(|phase| phase.terms.contains(&term));
        let bounds = phase.and_then(|phase| phase.debug.term_bounds.get(term - phase.terms.start));
        bounds.map_or([f64::NEG_INFINITY, f64::INFINITY], |bounds| [bounds.low, bounds.high])
    }

    /// Whether a term is the price of an end: `-100 done = terminated` counts in one step and outweighs all that counts step
    /// by step, so that scopes without such terms are common.
    pub fn is_terminal(&self, term: usize) -> bool {
        matches!(self.terms[term].source.trim(), "terminated" | "terminated()")
    }

    /// Whether a weight may be what is wished, by the bounds of its author and the sign that it has in the source.
    ///
    /// # Errors
    /// What it may be instead.
    pub fn check_weight(&self, term: usize, wished: f64) -> Result<(), Problem> {
        let Some(known) = self.terms.get(term) else { return Ok(()) };
        let bounds = self.weight_bounds(term);
        Problem::of(&known.name, wished, (&self.name, &known.name), known.written, bounds).map_or(Ok(()), Err)
    }

    /// The weights of a moment of a training, one for each term: `progress` is the share of it that has passed, 0 to 1, and `last`
    /// are the weights of its end.
    pub fn scheduled_weights(&self, progress: f64, last: &[f64]) -> Vec<f64> {
        let at = |(term, last): (&Term, &f64)| term.schedule.map_or(*last, |schedule| schedule.at(progress, *last));
        self.terms.iter().zip(last).map(at).collect()
    }

    /// The same task with other weights: (term, weight). Its hash stays that of its source.
    ///
    /// # Errors
    /// Every weight that its author does not allow.
    pub fn reweighted(&self, weights: &[(usize, f64)], origin: &Origin) -> Result<Self, Refused> {
        let problems: Vec<Problem> = weights.iter().filter_map(|&(term, weight)| self.check_weight(term, weight).err()).collect();
        if !problems.is_empty() {
            return Err(Refused(problems));
        }
        let mut task = self.clone();
        for &(term, weight) in weights {
            if let Some(term) = task.terms.get_mut(term) {
                term.weight = weight;
                term.origin = origin.clone();
            }
        }
        Ok(task)
    }
}
