//! Lints on whole tasks: what compiles, but is probably not what was meant. They read the typed HIR, the graph and the bounds of
//! its nodes; type checking knows nothing of them.
//!
//! A lint pushes its warning wherever it finds it; whether an `allow` covers it is decided once all of a task are there
//! (`allows`).

mod amount;
mod channels;
mod cheap_return;
mod duration;
mod growth;
mod heights;
mod last_step;
mod linear;
mod muscles;
mod observed;
mod open_side;
mod outlook;
mod poles;
mod rates;
mod rewards;
mod sight;
mod signs;
mod slips;
mod success;
mod summands;
mod surrogate;
mod totals;
mod trend;
mod world_place;
mod wrong_bound;

use crate::check::context::{Checker, End};
use crate::check::ranges::{NeutralRange, OperatingRange, Shaken};
use crate::check::reward::RewardTerm;
use crate::check::task::{CheckedTask, InSequence, TaskDiagnostics};
use crate::diagnostics::{Code, Diagnostic, FileId, Span, codes};
use crate::frame::Sensor;
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::{Binary, Memory, Operation};
use crate::graph::{Graph, NodeId};
use crate::hir::{Hir, Resolution};
use crate::numbers::{exact, for_people};
use crate::resolve::scope::Definition;
use crate::syntax::tree::{BinaryOperator, Expr, ExprKind};
use crate::task::RootPlacement;
use std::collections::{BTreeMap, BTreeSet};

/// Finds what is to be warned of in a task without errors, and between which values its terms stay.
pub(crate) fn find(
    checker: &Checker<'_>,
    checked: &mut CheckedTask<'_>,
    sequence: InSequence<'_>,
    diagnostics: &mut TaskDiagnostics,
) {
    unused(checker, &mut diagnostics.whole);
    checked.term_bounds = task(checker, checked, &mut diagnostics.whole);
    last_step::last_step(checked, sequence, &mut diagnostics.whole);
    phase_end(checker, checked, sequence, &mut diagnostics.formulas);
}

/// Names that a task declares and nothing reads.
fn unused(checker: &Checker<'_>, diagnostics: &mut Vec<Diagnostic>) {
    checker.scene_lints(diagnostics);
    for (name, declared) in checker.names.of_task() {
        // States are looked at in the graph; a parameter that nothing reads is an error.
        let elsewhere = matches!(declared.definition, Definition::State(_) | Definition::Parameter(_));
        if !checker.used.contains(name) && !elsewhere {
            let span = declared.definition.span();
            let message = format!("unused `{name}`");
            diagnostics.push(Diagnostic::new(codes::lints::UNUSED, declared.file, span, message));
        }
    }
}

/// Lints on a task that compiles; the result is between which values each term stays.
fn task(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) -> Vec<Bounds> {
    let ranges = OperatingRange { vocabulary: checker.vocabulary, timing: task.timing, queries: &task.queries };
    let bounds = interval::analyse(&task.graph, &ranges);
    for term in &task.terms {
        let found = interval::of_scalar(&bounds, term.node);
        constant_term(term, found, diagnostics);
        doubled_sign(term, found, diagnostics);
        factor_in_term(term, diagnostics);
    }
    decided_ends(task, &bounds, diagnostics);
    duplicate_channel(task, diagnostics);
    channels::of(task, &bounds, diagnostics);
    states(checker, task, diagnostics);
    at_reset(checker, task, &bounds, diagnostics);
    let amounts = amount::of_terms(task, &bounds);
    rewards::of(task, &amounts, diagnostics);
    sight::constant_channels(checker, task, &bounds, diagnostics);
    sight::timed_failures(task, &bounds, diagnostics);
    sight::fleeting(checker, task, diagnostics);
    sight::unseen(checker, task, diagnostics);
    sight::one_side(checker, task, diagnostics);
    slips::duplicate_term(task, diagnostics);
    slips::counts_steps(task, diagnostics);
    signs::weightless(task, &amounts, diagnostics);
    muscles::of(checker, task, &bounds, &amounts, diagnostics);
    growth::of(checker, task, &bounds, diagnostics);
    wrong_bound::of(checker, task, diagnostics);
    totals::of(task, &bounds, diagnostics);
    cheap_return::of(checker, task, &bounds, diagnostics);
    poles::of(checker, task, &bounds, diagnostics);
    outlook::of(task, &bounds, &ranges, &amounts, diagnostics);
    success::of(checker, task, diagnostics);
    observed::of(checker, task, diagnostics);
    world_place::of(checker, task, diagnostics);
    open_side::of(checker, task, diagnostics);
    heights::of(checker, task, diagnostics);
    duration::long_horizon(checker, task, diagnostics);
    amounts.iter().map(|amount| amount.value).collect()
}

/// A warning about a term, at its formula.
fn at(code: &'static Code, term: &RewardTerm<'_>, message: String) -> Diagnostic {
    Diagnostic::new(code, term.file, term.formula.span, message)
}

/// Offers another weight; one that stands in another file than the formula is pointed at.
fn suggest_weight(diagnostic: Diagnostic, term: &RewardTerm<'_>, weight: f64) -> Diagnostic {
    let (written, (file, span)) = (exact(weight), term.weight_at);
    let diagnostic = if file == term.file { diagnostic } else { diagnostic.label(file, span, "the weight") };
    if term.schedule.is_some() {
        // Both ends have the sign, and one is not changed without the other.
        return diagnostic;
    }
    diagnostic.suggest_at(format!("write the weight `{written}`"), term.weight_at, written)
}

/// Where a term names what is looked for: in its formula, or behind names and functions, each place once.
fn named_in(hir: &Hir, term: &RewardTerm<'_>, wanted: impl Fn(Resolution) -> bool) -> Vec<(FileId, Span)> {
    let exprs = hir.read_by(term.expr).into_iter().map(|id| hir.expr(id));
    let mut found: Vec<(FileId, Span)> = Vec::new();
    for (file, span) in exprs.filter_map(|expr| expr.name.filter(|(_, to)| wanted(*to)).map(|(span, _)| (expr.file, span))) {
        // A function is inlined at each call.
        if !found.contains(&(file, span)) {
            found.push((file, span));
        }
    }
    found
}

/// A term that is the same at every step rewards nothing.
fn constant_term(term: &RewardTerm<'_>, bounds: Bounds, diagnostics: &mut Vec<Diagnostic>) {
    let Some(value) = bounds.single() else { return };
    if !value.is_finite() {
        let message = format!("the term `{}` is {} in every state", term.name, for_people(value));
        let diagnostic = at(codes::tasks::NOT_FINITE, term, message);
        diagnostics.push(diagnostic.help("every episode would end in a fault at its first step"));
        return;
    }
    let code = if value == 0.0 { codes::lints::DEAD_TERM } else { codes::lints::CONSTANT_TERM };
    let message = format!("the term `{}` is {} in every state", term.name, for_people(value));
    let diagnostic = at(code, term, message).help("its inputs cannot change it: look for a swapped side or a saturated bound");
    diagnostics.push(diagnostic);
}

/// A negative weight on a term that is never positive rewards what was to be a cost.
fn doubled_sign(term: &RewardTerm<'_>, bounds: Bounds, diagnostics: &mut Vec<Diagnostic>) {
    if term.weight < 0.0 && bounds.high <= 0.0 && bounds.low < 0.0 {
        let message = format!("the term `{}` is never positive and its weight is negative: the cost becomes a reward", term.name);
        let diagnostic = at(codes::lints::DOUBLED_SIGN, term, message).help("keep one of the two signs");
        diagnostics.push(diagnostic);
    }
    if term.weight > 0.0 && bounds.high <= 0.0 && bounds.low < 0.0 {
        let message = format!("the term `{}` is never positive; its sign is hidden in the formula", term.name);
        let help = "make the formula positive and the weight negative, so that the sign of the weight shows the cost";
        diagnostics.push(at(codes::lints::HIDDEN_SIGN, term, message).help(help));
    }
}

/// `10 x = 0.5 * f`: the factor belongs in the weight.
fn factor_in_term(term: &RewardTerm<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let mut expr: &Expr = term.formula;
    loop {
        match &expr.kind {
            ExprKind::Paren(inner) => expr = inner,
            ExprKind::Binary { operator: BinaryOperator::Multiply, right, .. } if is_plain_number(right) => {
                expr = right;
                break;
            }
            ExprKind::Binary { operator: BinaryOperator::Multiply | BinaryOperator::Divide, left, .. } => expr = left,
            ExprKind::Number(number) if number.unit.is_none() && !std::ptr::eq(expr, term.formula) => break,
            _ => return,
        }
    }
    let message = format!("the term `{}` has a constant factor", term.name);
    let diagnostic = Diagnostic::new(codes::lints::FACTOR_IN_TERM, term.file, expr.span, message)
        .help("it belongs in the weight, where people and tuners expect it");
    diagnostics.push(diagnostic);
}

fn is_plain_number(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Paren(inner) => is_plain_number(inner),
        ExprKind::Number(number) => number.unit.is_none(),
        _ => false,
    }
}

/// Every condition that ends an episode or tells its success: in words, its node, its place.
fn conditions(task: &CheckedTask<'_>) -> Vec<(String, NodeId, FileId, Span)> {
    let described = |what: &str, end: &End| (format!("the {what} `{}`", end.name), end.node, end.file, end.span);
    let mut conditions: Vec<_> = task.terminations.iter().map(|end| described("termination", end)).collect();
    conditions.extend(task.finishes.iter().map(|end| described("reason to finish", end)));
    conditions.push(("success".to_owned(), task.success, task.success_at.0, task.success_at.1));
    conditions
}

/// Ends and success that can never hold or never fail.
fn decided_ends(task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    for (what, node, file, span) in conditions(task) {
        if let Some(value) = interval::of_scalar(bounds, node).single() {
            let verdict = if value == 0.0 { "can never hold" } else { "always holds" };
            let diagnostic = Diagnostic::new(codes::lints::DECIDED, file, span, format!("{what} {verdict}"));
            let diagnostic = match (sides_in_words(task, node, bounds), held_too_long(task, node, bounds)) {
                (_, Some(long)) => diagnostic.help(long),
                (Some(sides), _) if only_time(&task.graph, node) => {
                    diagnostic.found(sides).help("an episode ends at its `horizon` anyway")
                }
                (Some(sides), _) => diagnostic.found(sides),
                (None, _) => diagnostic.help("the ranges of its inputs decide it; see `msk explain`"),
            };
            diagnostics.push(diagnostic);
        }
    }
}

/// Whether a condition reads nothing but the time.
fn only_time(graph: &Graph, node: NodeId) -> bool {
    let operations = || graph.reachable([node]).into_iter().map(|id| &graph.node(id).operation);
    operations().any(|operation| *operation == Operation::Step)
        && operations().all(|operation| match operation {
            Operation::Sensors(sensors) => sensors.iter().all(|sensor| *sensor == Sensor::Time),
            operation => !operation.remembers(),
        })
}

/// A condition within one that would have to be held for longer than the episode lasts, in words.
fn held_too_long(task: &CheckedTask<'_>, node: NodeId, bounds: &[Vec<Bounds>]) -> Option<String> {
    let graph = &task.graph;
    graph.reachable([node]).into_iter().find_map(|id| {
        let known = graph.node(id);
        let (Operation::Binary(Binary::LessEqual), [steps, streak]) = (&known.operation, known.inputs.as_slice()) else {
            return None;
        };
        let steps = graph.constant_value(*steps)?;
        let most = interval::of_scalar(bounds, *streak).high;
        let held = graph.node(*streak).operation == Operation::Memory(Memory::Streak) && steps > most;
        let time = |steps: f64| for_people(steps * task.timing.interval);
        held.then(|| {
            let episode = time(f64::from(task.timing.before) + f64::from(task.timing.horizon));
            format!("a condition cannot hold for {} s in an episode of {episode} s", time(steps))
        })
    })
}

/// Between which values both sides of a comparison stay, if a condition is one.
fn sides_in_words(task: &CheckedTask<'_>, node: NodeId, bounds: &[Vec<Bounds>]) -> Option<String> {
    let compared = task.comparisons.iter().find(|compared| compared.node == node)?;
    let in_words = |side: NodeId| {
        let (found, unit) = (interval::of_scalar(bounds, side), &compared.unit);
        let amount = |value: f64| for_people(unit.amount(value));
        match (found.single(), found.low.is_finite(), found.high.is_finite()) {
            (Some(value), ..) => unit.tell(value),
            (None, true, true) => unit.with_unit(&format!("{} .. {}", amount(found.low), amount(found.high))),
            (None, true, false) => format!("at least {}", unit.tell(found.low)),
            (None, false, true) => format!("at most {}", unit.tell(found.high)),
            (None, false, false) => "any number".to_owned(),
        }
    };
    Some(format!("{} on the left, {} on the right", in_words(compared.sides[0]), in_words(compared.sides[1])))
}

/// A phase of a sequence that can never give way: its `until` needs more time than the phase has, for example.
fn phase_end(checker: &Checker<'_>, task: &CheckedTask<'_>, sequence: InSequence<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let (Some(node), Some((expr, file)), Some(phase)) = (task.phase.until, sequence.until, sequence.phases.get(sequence.index))
    else {
        return;
    };
    let ranges = OperatingRange { vocabulary: checker.vocabulary, timing: task.timing, queries: &task.queries };
    let bounds = interval::analyse_for(&task.graph, node, &ranges);
    if bounds.iter().all(|lane| lane.single() == Some(0.0)) {
        let length = for_people(f64::from(task.timing.horizon) * task.timing.interval);
        let message = format!("the phase `{phase}` never ends: this can never hold");
        let diagnostic = Diagnostic::new(codes::lints::DECIDED, file, expr.span, message)
            .help(format!("within a phase `t` starts at 0, and its task ends it at its horizon, after {length} s"));
        diagnostics.push(diagnostic);
    }
}

/// A rewarding term is dead if it begins below this part of its highest contribution.
pub const DEAD: f64 = 0.05;

/// What holds in the very first snapshot, where the task begins in the standing pose, however noise shakes it: ends that hold
/// there, and rewarding terms that contribute less than a twentieth of what they can.
fn at_reset(checker: &Checker<'_>, task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    let standing = checker.vocabulary.joints.iter().filter(|joint| !joint.of_scene).map(|joint| joint.neutral);
    let own =
        task.init.coordinates.iter().copied().take(checker.vocabulary.joints.iter().filter(|joint| !joint.of_scene).count());
    let level = task.scene.ground.is_some() && !task.scene.objects.iter().any(|object| object.surface.walkable);
    let init = &task.init;
    if !own.eq(standing) || init.root != RootPlacement::default() || init.settle.is_some() || !level {
        return;
    }
    let shaken = Shaken::by(init);
    let reset = interval::analyse(&task.graph, &NeutralRange { vocabulary: checker.vocabulary, reset: true, shaken });
    for (what, node, file, span) in conditions(task) {
        let decided = interval::of_scalar(bounds, node).single().is_some();
        if interval::of_scalar(&reset, node).single() == Some(1.0) && !decided {
            let message = format!("{what} holds in the initial state");
            let diagnostic = Diagnostic::new(codes::lints::HOLDS_AT_RESET, file, span, message);
            let diagnostic = match sides_in_words(task, node, &reset) {
                Some(sides) => diagnostic.found(sides).help("is the comparison inverted, or its number in another unit?"),
                None => diagnostic,
            };
            diagnostics.push(diagnostic);
        }
    }
    for term in &task.terms {
        let (range, start) = (interval::of_scalar(bounds, term.node), interval::of_scalar(&reset, term.node));
        if term.weight <= 0.0 || range.single().is_some() || range.low < 0.0 || !range.high.is_finite() {
            continue;
        }
        if start.high < DEAD * range.high && !gated(term.formula, &task.graph, term.node) {
            let most = if start.single().is_some() { "" } else { "at most " };
            let message = format!("the term `{}` is almost zero in the initial state", term.name);
            let diagnostic = at(codes::lints::DEAD_AT_RESET, term, message)
                .expected(format!("more than a twentieth of its highest value, {}", for_people(range.high)))
                .found(format!("{most}{}", for_people(start.high)))
                .help("look for a wrong axis, side or sign; if the term becomes relevant later, write `allow dead_at_reset \"...\"`");
            diagnostics.push(diagnostic);
        }
    }
}

/// Whether a formula shows by itself that it does not always contribute: as it is written, or as what it computes
/// behind functions and names.
pub(crate) fn gated(formula: &Expr, graph: &Graph, node: NodeId) -> bool {
    match &formula.kind {
        ExprKind::When { .. } | ExprKind::If { .. } | ExprKind::Compare { .. } | ExprKind::EndedBy(_) => true,
        ExprKind::Paren(inner) => gated(inner, graph, node),
        _ => crate::graph::events::is_gated(graph, node),
    }
}

/// Two channels that carry the same numbers.
fn duplicate_channel(task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let mut first: BTreeMap<NodeId, &str> = BTreeMap::new();
    for channel in &task.channels {
        if let Some(known) = first.insert(channel.node, &channel.name) {
            let message = format!("the channels `{known}` and `{}` have the same values", channel.name);
            let diagnostic = Diagnostic::new(codes::lints::DUPLICATE_CHANNEL, channel.file, channel.span, message);
            diagnostics.push(diagnostic);
        }
    }
}

/// States that nothing reads, and states that the reward depends on and the policy cannot see.
fn states(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let terms = || task.terms.iter().map(|term| term.node);
    let channels = || task.channels.iter().map(|channel| channel.node);
    let reasons = || task.terminations.iter().chain(&task.finishes).map(|end| end.node);
    let ends = reasons().chain([task.success]);
    let ends = ends.chain(task.metrics.iter().map(|metric| metric.node)).chain(task.phase.until);
    let (rewarded, ended) = (hidden_behind(task, terms()), hidden_behind(task, reasons()));
    let seen = hidden_behind(task, task.observed().map(|channel| channel.node));
    let read = hidden_behind(task, terms().chain(channels()).chain(ends));
    let place = |name: &str| {
        // The start of a reference stands where the reference does.
        let name = name.strip_suffix(".start").unwrap_or(name);
        let declared = checker.names.of_task().find(|(known, _)| *known == name).map(|(_, declared)| declared);
        declared.map_or((checker.task_place.file, Span::default()), |declared| (declared.file, declared.definition.span()))
    };
    let states = task.states.iter().enumerate().map(|(index, state)| (Hidden::State(index), "state", state.name.as_str()));
    let randoms = task.randoms.iter().enumerate();
    let randoms = randoms.map(|(index, random)| {
        let kind = if random.parameter.is_some() { "parameter" } else { "random" };
        (Hidden::Random(index), kind, random.name.as_str())
    });
    for (hidden, kind, name) in states.chain(randoms) {
        let (file, span) = place(name);
        if !read.contains(&hidden) && kind == "state" {
            let message = format!("unused `{name}`");
            diagnostics.push(Diagnostic::new(codes::lints::UNUSED, file, span, message));
        } else if (rewarded.contains(&hidden) || ended.contains(&hidden)) && !seen.contains(&hidden) {
            let (what, answered) =
                if rewarded.contains(&hidden) { ("the reward", "rewards") } else { ("the termination", "terminations") };
            let message = format!("{what} depends on the {kind} `{name}`, which is not observed");
            let diagnostic = Diagnostic::new(codes::lints::UNOBSERVED, file, span, message)
                .help(format!("add it to `observe`: otherwise the same observation can have different {answered}"));
            let diagnostic = match name.strip_suffix(".start") {
                Some(reference) => diagnostic.help(format!("`{reference}.phase` determines it")),
                None => diagnostic,
            };
            diagnostics.push(diagnostic);
        }
    }
}

/// What decides the reward and is no signal of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Hidden {
    State(usize),
    Random(usize),
}

/// The states and randoms that nodes read, directly or through the updates of states.
fn hidden_behind(task: &CheckedTask<'_>, roots: impl Iterator<Item = NodeId>) -> BTreeSet<Hidden> {
    let mut found = BTreeSet::new();
    let mut pending = hidden_in(&task.graph, roots);
    while let Some(hidden) = pending.pop() {
        if found.insert(hidden)
            && let Hidden::State(index) = hidden
        {
            pending.extend(hidden_in(&task.graph, task.updates.get(index).copied().into_iter()));
        }
    }
    found
}

fn hidden_in(graph: &Graph, roots: impl Iterator<Item = NodeId>) -> Vec<Hidden> {
    let nodes = graph.reachable(roots);
    let hidden = nodes.iter().filter_map(|id| match graph.node(*id).operation {
        Operation::StateBefore(index) | Operation::StateAfter(index) => Some(Hidden::State(index as usize)),
        Operation::Drawn(index) | Operation::DrawnAfter(index) => Some(Hidden::Random(index as usize)),
        _ => None,
    });
    hidden.collect()
}
