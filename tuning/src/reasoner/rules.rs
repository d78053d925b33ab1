//! The reasoner that is built in: a few rules of thumb, the same answer to the same question every time.
//!
//! The published examples (too slow: reward the wanted speed more; hunched: reward being upright more) are one rule:
//! what is deficient is emphasised. The others keep a reward from being ruled by what teaches nothing.

use super::{Proposal, Reasoner, ReasonerError, Request};
use crate::statistics::{Allowed, TermStatistics};
use msk_physics::scalar::Real;
use std::sync::atomic::AtomicBool;

/// Part of the steps beyond which a term counts as always saturated, or always dead.
const ALWAYS: f64 = 0.95;
/// Correlation beyond which a term has something to do with success.
const RELATED: f64 = 0.3;
/// Share of all contributions beyond which a term outweighs the others together.
const DOMINANT: f64 = 0.6;
/// Share of all contributions beyond which a cost outweighs the reward.
const DEAR: f64 = 0.5;

/// The rules.
#[derive(Debug, Clone, Copy, Default)]
pub struct RuleBook;

impl Reasoner for RuleBook {
    fn name(&self) -> String {
        "rules".into()
    }

    fn propose(&self, request: &Request, _: &AtomicBool) -> Result<Proposal, ReasonerError> {
        let mut weights = Vec::new();
        let mut reasons = Vec::new();
        for term in request.statistics.terms.iter().filter(|term| term.in_scope && term.bounds != Allowed::Fixed) {
            let found = judge(term);
            let change: f64 = found.iter().map(|(change, _)| change).sum::<f64>().clip(-1.0, 1.0);
            if change == 0.0 || term.weight == 0.0 {
                continue;
            }
            weights.push((term.term.clone(), term.weight * (1.0 + request.step * change)));
            let why: Vec<&str> = found.iter().map(|(_, why)| *why).collect();
            reasons.push(format!("{} {}: {}", term.term, if change > 0.0 { "up" } else { "down" }, why.join(", ")));
        }
        let reason = if reasons.is_empty() { "no term is unusual".into() } else { reasons.join("; ") };
        Ok(Proposal { weights, reason, by: String::new() })
    }
}

/// The verdict of the rules on a term: by which parts of a step its size shall change, and why.
fn judge(term: &TermStatistics) -> Vec<(f64, &'static str)> {
    let mut found = Vec::new();
    let always = |part: Option<f64>| part.is_some_and(|part| part >= ALWAYS);
    if always(term.dead) {
        // No weight makes anything of nothing; it is for people to see why the term never contributes.
        return found;
    }
    let rewarded = term.weight > 0.0;
    let top = term.range[1].filter(|top| *top > 0.0);
    if always(term.saturated) && rewarded {
        found.push((-0.5, "it is always saturated and gives no signal"));
    } else if let (true, Some(mean), Some(top)) = (rewarded, term.mean, top)
        && mean < 0.5 * top
    {
        found.push((1.0 - (mean / top).at_least(0.0), "it has low values"));
    }
    let related = term.with_success.or(term.with_survival).unwrap_or(0.0);
    if related > RELATED && rewarded {
        found.push((0.5 * related, "episodes that have it succeed"));
    }
    if related < -RELATED && rewarded {
        found.push((0.5 * related, "episodes that have it fail"));
    }
    let share = term.share.unwrap_or(0.0);
    if rewarded && share > DOMINANT {
        found.push((-0.5, "it outweighs all others"));
    }
    if !rewarded && share < -DEAR {
        found.push((-1.0, "the cost outweighs the reward"));
    }
    found
}
