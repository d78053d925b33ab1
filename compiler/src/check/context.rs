//! What the checker knows while it walks through one task.

use super::action::Networks;
use super::functions;
use super::random::KnownRandom;
use super::ranges::OperatingRange;
use super::reference::{KnownReference, Motions};
use super::scene::CheckedScene;
use super::scene::geometry::Known;
use super::value::Value;
use crate::action::ActionSpace;
use crate::diagnostics::{Allowance, Code, Diagnostic, FileId, Span, codes};
use crate::frame::Query;
use crate::graph::interval::{self, Bounds};
use crate::graph::{Graph, NodeId};
use crate::hir::{DefinitionId, ExprId, Hir, Resolution, TypedFormulas};
use crate::resolve::inherit::Placed;
use crate::resolve::scope::{Declared, Names, Place};
use crate::vocabulary::Vocabulary;
use msk_program::debug::{Compared, NamedValue};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

pub(crate) use crate::diagnostics::{Checked, Failures, Reported};

/// Expressions and lanes that one task may take: enough for any real task, little enough to stay far below a second.
const BUDGET: usize = 100_000;

/// Numbers that the graph of one task may hold, those kept by delays with them: eight megabytes at run time.
const LANES: usize = 1_000_000;

/// Brackets, calls and names nested in each other; each level costs native stack.
const DEEPEST: usize = 160;

/// An argument of the function being inlined, or a loop variable.
#[derive(Debug, Clone)]
pub(crate) struct Local {
    pub name: String,
    pub value: Value,
    /// Where it is declared; nothing for what a scene repeats.
    pub definition: Option<DefinitionId>,
}

/// A function call or a name on the way to where the checker stands.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub name: String,
    pub file: FileId,
    pub span: Span,
    /// A call is named in errors; a name only draws cycles.
    pub call: bool,
}

/// Control timing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Timing {
    /// Length of a control step, s.
    pub interval: f64,
    /// Control steps of the task, or of the phase that it is in a sequence.
    pub horizon: u32,
    /// Control steps that the phases before may take.
    pub before: u32,
}

impl Timing {
    /// Between which times the task runs, s since the episode began.
    pub(crate) fn episode(self) -> Bounds {
        let steps = f64::from(self.before) + f64::from(self.horizon);
        // The clock adds up physics steps, each with its rounding.
        Bounds::new(0.0, steps * self.interval * (1.0 + 1e-9))
    }
}

/// What is known where the checker stands, of what formulas may read as constants.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Settled {
    /// Which body it is; not while its own file is read.
    pub body: bool,
    /// How long a control step is.
    pub interval: bool,
    /// How many of them an episode has.
    pub horizon: bool,
}

/// A reason for which an episode ends.
#[derive(Debug, Clone)]
pub(crate) struct End {
    pub name: String,
    pub node: NodeId,
    /// Whether a learner values what would have followed.
    pub bootstraps: bool,
    /// Where its condition stands.
    pub file: FileId,
    pub span: Span,
}

/// The conditions that end an episode, once they are known.
#[derive(Debug, Clone, Default)]
pub(crate) enum Ends {
    #[default]
    Unknown,
    Busy,
    Known(Vec<End>),
    Broken(Reported),
}

/// A declared state or clock of the task.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cell {
    pub name: String,
    pub kind: super::types::Type,
    pub initial: NodeId,
}

/// How names are read where the checker stands.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct ReadMode {
    /// Whether declared states and randoms are read after their update, as observations do.
    pub after: bool,
    /// Whether an initial state is checked, which may repeat values of the scene.
    pub initial: bool,
}

/// The checker of one task.
pub(crate) struct Checker<'a> {
    pub vocabulary: &'a Vocabulary,
    pub names: &'a Names<'a>,
    pub graph: Graph,
    pub diagnostics: Vec<Diagnostic>,
    pub timing: Timing,
    /// What is known by now.
    pub settled: Settled,
    /// What `action` is, once `act` has been checked.
    pub action: ActionSpace,
    /// Where the task itself stands.
    pub task_place: Place,
    /// The statements of the task.
    pub statements: &'a [Placed],
    /// Where names are looked up now.
    pub place: Place,
    /// Arguments of the function being inlined and loop variables, innermost last.
    pub locals: Vec<Local>,
    /// How the checker came here.
    pub path: Vec<Step>,
    /// How names are read now.
    pub mode: ReadMode,
    /// Values of names already checked.
    pub memo: BTreeMap<(Place, bool, String), Checked<Value>>,
    /// Formulas of names already checked, beside their values.
    pub formulas: BTreeMap<(Place, bool, String), ExprId>,
    /// Names of the task that something reads.
    pub used: BTreeSet<String>,
    pub cells: Vec<Cell>,
    /// States whose declarations are broken.
    pub broken_states: BTreeMap<String, Reported>,
    /// Reasons of `terminate`.
    pub ends: Ends,
    /// Reasons of `finish`.
    pub finishes: Ends,
    /// Randoms, in the order in which they are drawn.
    pub randoms: Vec<KnownRandom>,
    /// Motions that texts name; only where a task is checked.
    pub motions: Option<Motions<'a>>,
    /// Networks that texts name; only where a task is checked.
    pub networks: Option<&'a Networks>,
    /// References, in the order of the text.
    pub references: Vec<KnownReference>,
    /// References whose motion or start is broken.
    pub broken_references: BTreeMap<String, Reported>,
    /// Names of the phases of the sequence before the present one.
    pub phases: Vec<String>,
    /// Names of those after the present one.
    pub later_phases: Vec<String>,
    /// The present phase and whether it has succeeded, once that is known.
    pub own_success: Option<(String, NodeId)>,
    /// What libraries allow in the task.
    pub allowances: Vec<Allowance>,
    /// The scene around the body; not yet while the scene itself is checked.
    pub scene: Option<&'a CheckedScene<'a>>,
    /// Constants of objects by `NAME.SIGNAL`.
    pub known: BTreeMap<String, Known>,
    /// Lengths in formulas that repeat the scene, and where it does.
    pub repeated: Vec<(FileId, Span, String)>,
    /// What names mean in tests, while those are checked.
    pub in_tests: Option<super::tests::InTests>,
    /// Comparisons in the task's formulas, those of its tests left out.
    pub comparisons: Vec<Compared>,
    /// What `let` names.
    pub lets: Vec<NamedValue>,
    /// Queries of the terrain, to which sensors refer.
    pub queries: Vec<Query>,
    /// Every formula checked so far.
    pub hir: Hir,
    depth: usize,
    budget: usize,
    /// That nothing is left of the budget, once that is reported.
    spent: Option<Reported>,
}

impl<'a> Checker<'a> {
    pub(crate) fn new(vocabulary: &'a Vocabulary, names: &'a Names<'a>, place: Place, statements: &'a [Placed]) -> Self {
        Self {
            vocabulary,
            names,
            graph: Graph::default(),
            diagnostics: Vec::new(),
            timing: Timing { interval: 0.01, horizon: 1, before: 0 },
            settled: Settled { body: true, ..Settled::default() },
            action: ActionSpace::default(),
            task_place: place,
            statements,
            place,
            locals: Vec::new(),
            path: Vec::new(),
            mode: ReadMode::default(),
            memo: BTreeMap::new(),
            formulas: BTreeMap::new(),
            used: BTreeSet::new(),
            cells: Vec::new(),
            broken_states: BTreeMap::new(),
            ends: Ends::Unknown,
            finishes: Ends::Unknown,
            randoms: Vec::new(),
            motions: None,
            networks: None,
            references: Vec::new(),
            broken_references: BTreeMap::new(),
            phases: Vec::new(),
            later_phases: Vec::new(),
            own_success: None,
            allowances: Vec::new(),
            scene: None,
            known: BTreeMap::new(),
            repeated: Vec::new(),
            in_tests: None,
            comparisons: Vec::new(),
            lets: Vec::new(),
            queries: Vec::new(),
            hir: Hir::default(),
            depth: 0,
            budget: BUDGET,
            spent: None,
        }
    }

    /// A diagnostic at `span` of the present file; the chain of calls that led here is reported with it.
    pub(crate) fn diagnostic(&self, code: &'static Code, span: Span, message: impl Into<String>) -> Diagnostic {
        let mut diagnostic = Diagnostic::new(code, self.place.file, span, message);
        for step in self.path.iter().rev().filter(|step| step.call) {
            diagnostic = diagnostic.label(step.file, step.span, format!("in this call of `{}`", step.name));
        }
        diagnostic
    }

    /// Reports and gives what a failed check returns.
    pub(crate) fn report(&mut self, diagnostic: Diagnostic) -> Reported {
        diagnostic.report(&mut self.diagnostics)
    }

    /// Reports a plain error.
    pub(crate) fn error(&mut self, code: &'static Code, span: Span, message: impl Into<String>) -> Reported {
        let diagnostic = self.diagnostic(code, span, message);
        self.report(diagnostic)
    }

    /// Runs `check` one level deeper.
    ///
    /// # Errors
    /// What `check` reports, or that the task nests too deeply or grows too large.
    pub(crate) fn deeper<T>(&mut self, span: Span, check: impl FnOnce(&mut Self) -> Checked<T>) -> Checked<T> {
        self.spend(1, span)?;
        if self.depth >= DEEPEST {
            let message = format!("this is nested more than {DEEPEST} levels deep");
            return Err(self.error(codes::tasks::TOO_LARGE, span, message));
        }
        self.depth += 1;
        let result = check(self);
        self.depth -= 1;
        result
    }

    /// Takes `amount` from what a task may cost.
    ///
    /// # Errors
    /// The task has become too large; reported once.
    pub(crate) fn spend(&mut self, amount: usize, span: Span) -> Checked<()> {
        if self.budget >= amount && self.graph.lanes() <= LANES {
            self.budget -= amount;
            return Ok(());
        }
        if let Some(reported) = self.spent {
            return Err(reported);
        }
        let message = "the task becomes too large here: functions and lists are unrolled at compile time";
        let reported = self.error(codes::tasks::TOO_LARGE, span, message);
        self.spent = Some(reported);
        Err(reported)
    }

    /// Asks for room for `amount` numbers that an operator keeps from step to step.
    ///
    /// # Errors
    /// The task would hold too many.
    pub(crate) fn hold(&mut self, amount: usize, span: Span) -> Checked<()> {
        if self.graph.lanes().saturating_add(amount) <= LANES {
            return Ok(());
        }
        let message = format!("the task would need more than {LANES} numbers with the {amount} of this operator");
        let diagnostic = self.diagnostic(codes::tasks::TOO_LARGE, span, message);
        Err(self.report(diagnostic.help("delay fewer numbers, or by a shorter time")))
    }

    /// Records what a name at `span` of the present file stands for.
    pub(crate) fn resolved(&mut self, span: Span, resolution: Resolution) {
        self.hir.resolved(self.place.file, span, resolution);
    }

    /// Records that a name at `span` of the present file stands for a declaration.
    pub(crate) fn resolved_to(&mut self, span: Span, declared: Declared<'a>) {
        let definition = declared.id();
        self.resolved(span, Resolution::Definition(definition));
        self.hir.documented(definition, declared.definition.docs());
    }

    /// Keeps the typed HIR for the language server, where it asks for it.
    pub(crate) fn keep_for_editors(&self, hir: Arc<Hir>, graph: &Graph) {
        let Some(kept) = &self.names.typed else { return };
        let ranges = OperatingRange { vocabulary: self.vocabulary, queries: &self.queries, timing: self.timing };
        let bounds = interval::analyse(graph, &ranges);
        let constants = self.known.keys().cloned().collect();
        let function = |name: &str| functions::find(name).map(|function| (function.signature, function.description));
        kept.borrow_mut().push(TypedFormulas { hir, bounds, constants, function });
    }

    /// Runs `check` with names read so, and comes back.
    pub(crate) fn in_mode<T>(&mut self, mode: ReadMode, check: impl FnOnce(&mut Self) -> T) -> T {
        let outside = std::mem::replace(&mut self.mode, mode);
        let result = check(self);
        self.mode = outside;
        result
    }

    /// Runs `check` where a statement of the task stands, which may be another file than the task's.
    pub(crate) fn in_file<T>(&mut self, file: FileId, check: impl FnOnce(&mut Self) -> T) -> T {
        self.elsewhere(Place { file, in_task: true }, check)
    }

    /// Runs `check` where `place` is, with no locals, and comes back.
    pub(crate) fn elsewhere<T>(&mut self, place: Place, check: impl FnOnce(&mut Self) -> T) -> T {
        let place = std::mem::replace(&mut self.place, place);
        let locals = std::mem::take(&mut self.locals);
        let result = check(self);
        (self.place, self.locals) = (place, locals);
        result
    }
}
