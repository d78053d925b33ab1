//! What success asks for: whether it is a failure, can never hold, or always holds.
//!
//! A condition is taken apart into alternatives, each a list of conditions that hold together. Comparisons of one quantity with
//! constants meet as limits of that quantity, so that `pelvis.height < 0.5 m` is seen to imply `pelvis.height < 0.6 m`.

use crate::check::context::{Checker, End};
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::syntax::tree::TaskStatement;
use std::collections::BTreeMap;

/// Alternatives beyond which a condition is left alone.
const MOST: usize = 32;

/// How deep a condition is taken apart, and how many of its parts are looked at: one that is read twice is looked at twice.
const DEEPEST: usize = 64;
const LONGEST: usize = 1024;

/// A condition, and whether it holds.
type Literal = (NodeId, bool);

/// Conditions that hold together.
type Alternative = Vec<Literal>;

/// Lints on the condition of success.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let graph = &task.graph;
    let Some(success) = alternatives(graph, task.success) else { return };
    if success.iter().any(Vec::is_empty) || success.is_empty() {
        // Always or never: `decided` warns of every such condition.
        return;
    }
    let (file, span) = task.success_at;
    let possible: Vec<&Alternative> = success.iter().filter(|alternative| !is_impossible(graph, alternative)).collect();
    if possible.is_empty() {
        if task.terminations.iter().any(|end| by_time(graph, end.node)) {
            // No episode comes to its horizon, and that termination has its own warning.
            return;
        }
        let diagnostic = match success.iter().find_map(|alternative| survived(task, alternative)) {
            Some(end) => {
                let message = format!("success can never hold: it requires the failure `{}` and no failure", end.name);
                Diagnostic::new(codes::incentive::CONTRADICTS, file, span, message).label(end.file, end.span, "ends the episode")
            }
            None => {
                let message = "success can never hold: its conditions exclude each other";
                Diagnostic::new(codes::incentive::CONTRADICTS, file, span, message)
            }
        };
        diagnostics.push(diagnostic.help("combine alternatives with `or`, or invert one of the comparisons"));
        return;
    }
    let ended = possible.iter().find_map(|alternative| implied(graph, alternative, &task.terminations));
    if let Some(end) = ended {
        let message = format!("success requires failing: it holds when `{}` terminates the episode", end.name);
        let diagnostic = Diagnostic::new(codes::incentive::FAILURE_SUCCEEDS, file, span, message)
            .label(end.file, end.span, "a failure")
            .help("move reasons that are not failures to `finish { ... }`, or negate the condition: `not ...`");
        diagnostics.push(diagnostic);
        return;
    }
    // The step at which a reason to finish holds is the last, and hardly ever that of the horizon.
    let waits = |alternative: &&&Alternative| alternative.iter().any(|literal| reaches(graph, *literal, task.timing.horizon));
    let finished = possible.iter().filter(waits).find_map(|alternative| implied(graph, alternative, &task.finishes));
    if let Some(end) = finished {
        let message = format!("success requires the horizon and `{}`, which ends the episode earlier", end.name);
        let diagnostic = Diagnostic::new(codes::incentive::CONTRADICTS, file, span, message)
            .label(end.file, end.span, "ends the episode as soon as it holds")
            .help(format!("require one of the two: `success ended by {}`", end.name));
        diagnostics.push(diagnostic);
        return;
    }
    // A block whose reasons could not be read has an error of its own.
    let unread = task.terminations.is_empty()
        && checker.statements.iter().any(|placed| matches!(placed.statement, TaskStatement::Terminate(_)));
    let comes = |alternative: &Alternative| alternative.iter().all(|literal| comes(graph, *literal, task.timing.horizon));
    if !unread && possible.iter().any(|alternative| comes(alternative)) {
        let message = "success does not depend on the policy";
        let message =
            if task.terminations.is_empty() { format!("{message}: nothing terminates the episode") } else { message.to_owned() };
        let diagnostic = Diagnostic::new(codes::incentive::CANNOT_FAIL, file, span, message).help(
            "declare failures, `terminate { fallen when pelvis.height < 0.6 m }`, or require more: `success survived and ...`",
        );
        diagnostics.push(diagnostic);
    }
}

/// Whether success holds wherever an end does.
pub(super) fn brings_success(task: &CheckedTask<'_>, end: &End) -> bool {
    let graph = &task.graph;
    let Some(success) = alternatives(graph, task.success) else { return false };
    let Some(ways) = alternatives(graph, end.node) else { return false };
    !ways.is_empty()
        && ways.iter().all(|way| {
            let limits = Limits::of(graph, way);
            let holds = |literal: &Literal| way.contains(literal) || limits.imply(graph, *literal);
            success.iter().any(|alternative| alternative.iter().all(holds))
        })
}

/// Whether two conditions may hold in the same step, as far as their comparisons tell.
pub(super) fn may_hold_together(graph: &Graph, one: NodeId, other: NodeId) -> bool {
    let (Some(ones), Some(others)) = (alternatives(graph, one), alternatives(graph, other)) else { return true };
    let together = |a: &Alternative, b: &Alternative| !is_impossible(graph, &[a.as_slice(), b.as_slice()].concat());
    ones.iter().any(|a| others.iter().any(|b| together(a, b)))
}

/// The termination whose condition an alternative asks for besides asking not to be terminated by it.
fn survived<'t>(task: &'t CheckedTask<'_>, alternative: &Alternative) -> Option<&'t End> {
    let asked = |end: &&End| {
        let Some(ways) = alternatives(&task.graph, end.node) else { return false };
        let denied = |literal: &&Literal| ways.iter().flatten().any(|way| way.0 == literal.0 && way.1 != literal.1);
        let rest: Alternative = alternative.iter().filter(|literal| !denied(literal)).copied().collect();
        rest.len() < alternative.len() && implied(&task.graph, &rest, std::slice::from_ref(*end)).is_some()
    };
    task.terminations.iter().find(asked)
}

/// The first end that holds wherever an alternative does; the grace before it is left out.
fn implied<'e>(graph: &Graph, alternative: &Alternative, ends: &'e [End]) -> Option<&'e End> {
    let limits = Limits::of(graph, alternative);
    let holds = |literal: &Literal| alternative.contains(literal) || limits.imply(graph, *literal);
    ends.iter().find(|end| {
        let ways = alternatives(graph, end.node).unwrap_or_default();
        ways.iter().any(|way| {
            let mut counted = way.iter().filter(|literal| !of_step(graph, literal.0)).peekable();
            counted.peek().is_some() && counted.all(holds)
        })
    })
}

/// The ways in which a condition holds; `None` where there are too many.
fn alternatives(graph: &Graph, node: NodeId) -> Option<Vec<Alternative>> {
    ways(graph, node, true, 0, &mut { LONGEST })
}

fn ways(graph: &Graph, node: NodeId, holds: bool, depth: usize, left: &mut usize) -> Option<Vec<Alternative>> {
    *left = left.checked_sub(1)?;
    let known = graph.node(node);
    let mut parts = |parts: &[NodeId], together: bool| {
        let ways = parts.iter().map(|&part| ways(graph, part, holds, depth + 1, left)).collect::<Option<Vec<_>>>()?;
        if together == holds { product(ways) } else { Some(ways.concat()).filter(|ways| ways.len() <= MOST) }
    };
    match known.operation {
        _ if depth > DEEPEST => Some(vec![vec![(node, holds)]]),
        Operation::Constant(_) => Some(if (graph.constant_value(node)? != 0.0) == holds { vec![Vec::new()] } else { Vec::new() }),
        Operation::Binary(function @ (Binary::And | Binary::Or)) => parts(&known.inputs, function == Binary::And),
        Operation::Unary(Unary::Not) => ways(graph, *known.inputs.first()?, !holds, depth + 1, left),
        Operation::Reduce(function @ (Reduction::Minimum | Reduction::Maximum), _) if known.width == 1 => {
            let joined = graph.node(*known.inputs.first()?);
            if joined.operation == Operation::Join && joined.inputs.len() == joined.width {
                parts(&joined.inputs, function == Reduction::Minimum)
            } else {
                Some(vec![vec![(node, holds)]])
            }
        }
        _ => Some(vec![vec![(node, holds)]]),
    }
}

/// One alternative of each, in every combination.
fn product(ways: Vec<Vec<Alternative>>) -> Option<Vec<Alternative>> {
    ways.into_iter().try_fold(vec![Vec::new()], |known, ways| {
        let joined = known.iter().flat_map(|known| ways.iter().map(move |way| [known.as_slice(), way].concat()));
        let joined: Vec<Alternative> = joined.take(MOST + 1).collect();
        (joined.len() <= MOST).then_some(joined)
    })
}

/// Whether conditions that should hold together exclude each other.
fn is_impossible(graph: &Graph, alternative: &Alternative) -> bool {
    alternative.iter().any(|(node, holds)| alternative.contains(&(*node, !holds))) || Limits::of(graph, alternative).are_empty()
}

/// A comparison of something with a constant, as it holds or fails: below or above it, and whether the constant itself counts.
struct Limit {
    of: NodeId,
    below: bool,
    value: f64,
    included: bool,
}

fn limit(graph: &Graph, (node, holds): Literal) -> Option<Limit> {
    let known = graph.node(node);
    let included = match known.operation {
        Operation::Binary(Binary::Less) => !holds,
        Operation::Binary(Binary::LessEqual) => holds,
        _ => return None,
    };
    let (left, right) = (known.inputs[0], known.inputs[1]);
    match (graph.constant_value(left), graph.constant_value(right)) {
        (None, Some(value)) => Some(Limit { of: left, below: holds, value, included }),
        (Some(value), None) => Some(Limit { of: right, below: !holds, value, included }),
        _ => None,
    }
}

fn of_step(graph: &Graph, node: NodeId) -> bool {
    let time = |id: NodeId| graph.node(id).operation == Operation::Step;
    limit(graph, (node, true)).is_some_and(|limit| time(limit.of))
}

/// Whether the step alone decides a condition.
fn by_time(graph: &Graph, node: NodeId) -> bool {
    let ways = alternatives(graph, node).unwrap_or_default();
    ways.iter().any(|way| way.iter().all(|literal| of_step(graph, literal.0)))
}

/// Whether a condition holds at the last step of an episode that nothing ends.
fn comes(graph: &Graph, literal: Literal, horizon: u32) -> bool {
    let horizon = f64::from(horizon);
    limit(graph, literal).is_some_and(|limit| {
        graph.node(limit.of).operation == Operation::Step
            && !limit.below
            && (limit.value < horizon || limit.included && limit.value == horizon)
    })
}

/// Whether a condition holds at the last step only.
fn reaches(graph: &Graph, literal: Literal, horizon: u32) -> bool {
    comes(graph, literal, horizon) && limit(graph, literal).is_some_and(|limit| limit.value + 1.0 > f64::from(horizon))
}

/// The limits of each quantity in conditions that hold together.
struct Limits(BTreeMap<NodeId, [Option<(f64, bool)>; 2]>);

impl Limits {
    fn of(graph: &Graph, alternative: &Alternative) -> Self {
        let mut known: BTreeMap<NodeId, [Option<(f64, bool)>; 2]> = BTreeMap::new();
        for limit in alternative.iter().filter_map(|literal| limit(graph, *literal)) {
            let slot = &mut known.entry(limit.of).or_default()[usize::from(limit.below)];
            let tighter = slot.is_none_or(|(value, included)| {
                let sign = if limit.below { -1.0 } else { 1.0 };
                sign * limit.value > sign * value || limit.value == value && included && !limit.included
            });
            if tighter {
                *slot = Some((limit.value, limit.included));
            }
        }
        Self(known)
    }

    fn are_empty(&self) -> bool {
        self.0.values().any(|[low, high]| match (low, high) {
            (Some((low, from)), Some((high, to))) => low > high || low == high && !(*from && *to),
            _ => false,
        })
    }

    /// Whether a comparison follows from them.
    fn imply(&self, graph: &Graph, literal: Literal) -> bool {
        let Some(limit) = limit(graph, literal) else { return false };
        let known = self.0.get(&limit.of).and_then(|limits| limits[usize::from(limit.below)]);
        known.is_some_and(|(value, included)| {
            let sign = if limit.below { -1.0 } else { 1.0 };
            sign * value > sign * limit.value || value == limit.value && (limit.included || !included)
        })
    }
}
