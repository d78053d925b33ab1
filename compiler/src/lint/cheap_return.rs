//! Velocities that are rewarded one way and charged less the other way: moving to and fro earns, and leads nowhere.

use super::rates;
use super::{at, summands};
use crate::check::context::Checker;
use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::interval::Bounds;
use crate::graph::operation::{Memory, Operation};
use crate::numbers::for_people;

/// Speeds that a body easily goes back with: m/s, and rad/s of a joint.
const BACK: f64 = 3.0;
const TURNING_BACK: f64 = 10.0;

/// Terms that earn by moving to and fro.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    diagnostics.extend(task.terms.iter().filter_map(|term| earns_to_and_fro(checker, task, bounds, term)));
}

fn earns_to_and_fro(
    checker: &Checker<'_>,
    task: &CheckedTask<'_>,
    bounds: &[Vec<Bounds>],
    term: &RewardTerm<'_>,
) -> Option<Diagnostic> {
    let rates = rates::below(&task.graph, checker.vocabulary, bounds, task.timing.interval, term.node);
    let summand = |found: &summands::Summand| {
        let rate = rates.get(&found.node).filter(|_| !found.bent && found.factor != 0.0)?;
        let [low, high] = rates::speeds(*rate, found.bounds);
        // Which way earns, and up to which speed moving back is charged.
        let (earned, charged) = if found.factor > 0.0 { (high, -low) } else { (-low, high) };
        let fast = if rate.turns { TURNING_BACK } else { BACK };
        (earned > 0.0 && (0.0..fast).contains(&charged)).then_some((*rate, charged, fast))
    };
    let (rate, charged, fast) = summands::of(task, term.node, term.weight).iter().find_map(summand)?;
    let unit = if rate.turns { "rad/s" } else { "m/s" };
    let shown = |speed: f64| format!("{} {unit}", for_people(speed));
    let cost = if charged == 0.0 { "nothing".to_owned() } else { format!("no more than at {}", shown(charged)) };
    let message = format!("the term `{}` rewards moving to and fro: moving back at {} costs {cost}", term.name, shown(fast));
    let help = "charge moving back without a cap, as in `clip(v, -10 m/s, 1 m/s)`, or reward progress, `rate(running_max(x))`";
    Some(at(codes::exploits::CHEAP_RETURN, term, message).help(help)).filter(|_| !keeps_progress(task, term))
}

/// Whether a term asks for more than has ever been reached, so that to and fro earns nothing.
fn keeps_progress(task: &CheckedTask<'_>, term: &RewardTerm<'_>) -> bool {
    let extreme = |operation: &Operation| matches!(operation, Operation::Memory(Memory::Highest | Memory::Lowest));
    task.graph.reachable([term.node]).iter().any(|id| extreme(&task.graph.node(*id).operation))
}
