//! A task: its statements in any order, from tree to [`CheckedTask`].

use super::context::{Cell, Checked, Checker, End, Failures, ReadMode, Reported, Timing};
use super::dimension::Dimension;
use super::init::{Beginning, Layer};
use super::observe::ObservedChannel;
use super::random::KnownRandom;
use super::reference::{KnownReference, Motions};
use super::reward::PaidTerm;
use super::scene::Surroundings;
use super::tests::CheckedTests;
use super::types::{ElementType, Type};
use super::value::{TypedValue, Value};
use crate::diagnostics::{Allowance, Diagnostic, FileId, Span, codes};
use crate::frame::Query;
use crate::graph::interval::Bounds;
use crate::graph::{Graph, NodeId};
use crate::hir::Hir;
use crate::numbers::for_people;
use crate::resolve::Texts;
use crate::resolve::inherit::{Placed, WholeTask};
use crate::resolve::scope::{Declared, Definition, Names, Place};
use crate::scene::SceneDescription;
use crate::syntax::tree::{BodyUse, Expr, StateDeclaration, TaskStatement, Test};
use crate::task::{Disturbance, Init, Parameter};
use crate::vocabulary::Vocabulary;
use msk_program::debug::Compared;
use std::sync::Arc;

/// A task whose every formula is checked and in the graph.
#[derive(Clone)]
pub(crate) struct CheckedTask<'a> {
    pub graph: Graph,
    /// Its formulas with their types.
    pub hir: Arc<Hir>,
    pub family: String,
    pub control_frequency: f64,
    pub timing: Timing,
    pub symmetric: bool,
    pub scene: SceneDescription,
    pub init: Init,
    /// Numbers that the beginning takes from what is drawn.
    pub beginning: Vec<NodeId>,
    pub disturbances: Vec<Disturbance>,
    /// Connections of the scene with the conditions on which they let go.
    pub releases: Vec<(usize, NodeId)>,
    pub markers: Vec<(String, NodeId)>,
    pub queries: Vec<Query>,
    pub channels: Vec<ObservedChannel>,
    pub terms: Vec<PaidTerm<'a>>,
    pub metrics: Vec<ObservedChannel>,
    pub terminations: Vec<End>,
    pub finishes: Vec<End>,
    pub success: NodeId,
    /// Comparisons in formulas, in the order in which they were checked.
    pub comparisons: Vec<Compared>,
    /// Where the condition of success stands.
    pub success_at: (FileId, Span),
    /// Where the word `init` stands.
    pub init_at: (FileId, Span),
    /// What libraries allow in it.
    pub allowances: Vec<Allowance>,
    pub randoms: Vec<KnownRandom>,
    pub references: Vec<KnownReference>,
    pub parameters: Vec<Parameter>,
    pub phase: PhaseEnd,
    /// Between which values each term stays.
    pub term_bounds: Vec<Bounds>,
    /// New values of the declared states.
    pub updates: Vec<NodeId>,
    pub states: Vec<Cell>,
    /// Its tests, if it has any.
    pub tests: Option<CheckedTests>,
}

/// How a phase of a sequence gives way to the next.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PhaseEnd {
    /// When the next phase begins.
    pub until: Option<NodeId>,
    /// Whether the phase itself has succeeded.
    pub succeeded: Option<NodeId>,
}

/// What is asked of a task as a phase of a sequence.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct InSequence<'a> {
    /// Names of all phases; empty for a task by itself.
    pub phases: &'a [String],
    /// Which of them this is.
    pub index: usize,
    /// When the next begins, with the file in which that stands.
    pub until: Option<(&'a Expr, FileId)>,
    /// What the sequence calls success, if it says so.
    pub success: Option<(&'a Expr, FileId)>,
    /// Whether a task by itself is a phase of a sequence somewhere.
    pub is_phase: bool,
    /// Whether its tests are checked as well.
    pub tests: bool,
    /// Control steps of all its phases, as far as tests are concerned.
    pub horizon: u32,
    /// Control steps that the phases before this one may take.
    pub before: u32,
}

/// Something of a task with the file in which it stands.
type Located<T> = Option<(T, FileId)>;

/// The single statements of a task.
#[derive(Default)]
struct Parts<'a> {
    family: Located<&'a str>,
    control: Located<&'a Expr>,
    horizon: Located<&'a Expr>,
    symmetric: bool,
    body: Located<&'a BodyUse>,
    /// Of each task of a line of extended ones, the oldest first.
    init: Vec<Layer<'a>>,
    /// Which of them said it last.
    begun: Option<usize>,
    success: Located<&'a Expr>,
}

/// What is known around a task when it is checked.
#[derive(Clone, Copy)]
pub(crate) struct Around<'a> {
    pub vocabulary: &'a Vocabulary,
    pub surroundings: &'a Surroundings<'a>,
    pub texts: &'a dyn Texts,
    pub motions: Motions<'a>,
}

/// What is found of a task.
#[derive(Default)]
pub(crate) struct Told {
    /// Errors, and warnings about single formulas.
    pub formulas: Vec<Diagnostic>,
    /// Warnings about the task as a whole.
    pub whole: Vec<Diagnostic>,
}

/// Checks a task against the vocabulary of its body. Errors and warnings come with it; the task only if there is no error. Lints
/// ask the checker for what it has learnt.
pub(crate) fn check<'a>(
    task: &'a WholeTask,
    names: &'a Names<'a>,
    around: Around<'a>,
    sequence: InSequence<'a>,
    queries: Vec<Query>,
) -> (Checker<'a>, Checked<CheckedTask<'a>>, Told) {
    let Around { vocabulary, surroundings, texts, motions } = around;
    let mut checker = Checker::new(vocabulary, names, Place::of_task(task.file), &task.statements);
    checker.known = surroundings.known.clone();
    checker.used = surroundings.used.clone();
    checker.surroundings = Some(surroundings);
    checker.motions = Some(motions);
    // Phases of a sequence share one frame, and so the numbers of the queries.
    checker.queries = queries;
    checker.timing.before = sequence.before;
    checker.phases = sequence.phases.iter().take(sequence.index).cloned().collect();
    checker.later_phases = sequence.phases.iter().skip(sequence.index + 1).cloned().collect();
    let mut checked = checker.task(task, texts, sequence);
    let finding = |checked: &mut CheckedTask<'_>| checked.graph.take_finding().or_else(|| checked.hir.verify(&checked.graph));
    if let Some(finding) = checked.as_mut().ok().and_then(finding) {
        checked = Err(checker.internal_error(finding, task.task.name.span));
    }
    let broken = Reported::among(&checker.diagnostics);
    let told = Told { formulas: std::mem::take(&mut checker.diagnostics), whole: Vec::new() };
    let graph = std::mem::take(&mut checker.graph);
    let hir = checked.as_ref().map_or_else(|_| Arc::new(std::mem::take(&mut checker.hir)), |checked| checked.hir.clone());
    checker.keep_for_editors(hir, checked.as_ref().map_or(&graph, |checked| &checked.graph));
    let checked = checked.and_then(|checked| broken.map_or(Ok(checked), Err));
    (checker, checked, told)
}

impl<'a> Checker<'a> {
    fn task(&mut self, task: &'a WholeTask, texts: &dyn Texts, sequence: InSequence<'a>) -> Checked<CheckedTask<'a>> {
        self.lists_once(task);
        let parts = self.parts();
        self.must_not_hide_signals();
        let parameters = self.parameters();
        let frequency = parts.control.map(|(control, file)| self.in_file(file, |checker| checker.control(control))).transpose();
        let horizon = match (&frequency, parts.horizon) {
            (Ok(_), Some((horizon, file))) => self.in_file(file, |checker| checker.horizon(horizon)).map(Some),
            _ => Ok(None),
        };
        self.states();
        self.references();
        self.randoms();
        let (init, staged) = self.in_mode(ReadMode { initial: true, ..self.mode }, |checker| {
            let init = checker.init(&parts.init);
            (init.map(|init| init.map(|init| checker.with_starts(init))), checker.staged())
        });
        let (terminations, finishes) = (self.terminations(), self.finishes());
        if let (Ok(terminations), Ok(finishes)) = (&terminations, &finishes) {
            self.must_not_share_reasons(terminations, finishes);
        }
        let terms = self.rewards();
        let metrics = self.metrics(texts);
        let own = parts.success.map(|(success, file)| self.in_file(file, |c| c.single_condition(success))).transpose();
        let succeeded = own.as_ref().ok().and_then(Option::as_ref).map(|own| own.node);
        if let (Some(name), Some(node)) = (sequence.phases.get(sequence.index), succeeded) {
            self.own_success = Some((name.clone(), node));
        }
        let phase = self.phase_end(sequence, succeeded);
        let success = match sequence.success.filter(|_| sequence.index + 1 == sequence.phases.len()) {
            Some((success, file)) => self.in_file(file, |checker| checker.single_condition(success)).map(Some),
            None => own,
        };
        let (updates, redraws) = (self.updates(), self.redraws());
        let channels = self.observations(texts);
        let shown = task.statements.iter().rev().find_map(|placed| match &placed.statement {
            TaskStatement::Observe(block) => Some((placed.file, block.keyword)),
            _ => None,
        });
        if let (Ok([]), Some(place)) = (channels.as_deref(), shown) {
            self.observes_nothing(place);
        }
        self.parameters_in_use();
        self.unread();
        let complete = self.must_be_complete(task, &parts);
        let (control_frequency, _) = (frequency?, (horizon?, redraws?));
        let (staged, init, success) = (staged?, init?, success?);
        complete?;
        let (Some(control_frequency), Some(init), Some(success)) = (control_frequency, init, success) else {
            return Err(self.incomplete(task, "`control`, `init` or `success`"));
        };
        let tests = match (&terms, &channels, &terminations, &finishes) {
            (Ok(terms), Ok(channels), Ok(_), Ok(_)) => self.own_tests(sequence, &init, (terms, channels), success.node, texts)?,
            _ => None,
        };
        let begun_at = parts.init.last().map(|(block, file)| (*file, block.keyword));
        let success_at = sequence.success.or(parts.success).map(|(expr, file)| (file, expr.span));
        Ok(CheckedTask {
            family: parts.family.map(|(family, _)| family).unwrap_or_default().to_owned(),
            control_frequency,
            timing: self.timing,
            symmetric: parts.symmetric,
            scene: staged.scene,
            init: init.init,
            beginning: init.drawn,
            disturbances: staged.disturbances,
            releases: staged.releases,
            markers: staged.markers,
            queries: std::mem::take(&mut self.queries),
            channels: channels?,
            terms: terms?,
            metrics: metrics?,
            terminations: terminations?,
            finishes: finishes?,
            success: success.node,
            success_at: success_at.unwrap_or((self.task_place.file, task.task.name.span)),
            init_at: begun_at.unwrap_or((self.task_place.file, task.task.name.span)),
            comparisons: std::mem::take(&mut self.comparisons),
            allowances: std::mem::take(&mut self.allowances),
            randoms: std::mem::take(&mut self.randoms),
            references: self.references.clone(),
            parameters: parameters?,
            phase: phase?,
            term_bounds: Vec::new(),
            updates: updates?,
            states: std::mem::take(&mut self.cells),
            tests,
            // Last: what is taken here is lost where a part above is wrong.
            graph: std::mem::take(&mut self.graph),
            hir: Arc::new(std::mem::take(&mut self.hir)),
        })
    }

    /// Where references start is known wherever it is drawn, also if the beginning does not need it.
    fn with_starts(&self, mut init: Beginning) -> Beginning {
        let starts = self.references.iter().map(|known| known.start);
        for start in starts.filter(|start| self.graph.constant_value(*start).is_none()) {
            if !init.drawn.contains(&start) {
                init.drawn.push(start);
            }
        }
        init
    }

    /// Reports a policy that would be shown nothing at all.
    fn observes_nothing(&mut self, (file, span): (FileId, Span)) {
        let diagnostic = Diagnostic::new(codes::tasks::MISSING, file, span, "the policy is shown nothing");
        self.report(
            diagnostic.help("name what it sees: `observe { pelvis.height }`, or a block of channels such as `proprioception`"),
        );
    }

    /// Checks the values that nothing reads, so that their mistakes are told; of what is computed for them nothing stays.
    fn unread(&mut self) {
        let names = self.names;
        let value = |declared: &Declared<'a>| matches!(declared.definition, Definition::Let(_) | Definition::Clock(_));
        let unread: Vec<_> = names.of_task().filter(|(name, declared)| value(declared) && !self.used.contains(*name)).collect();
        if unread.is_empty() {
            return;
        }
        let (graph, memo, used) = (self.graph.clone(), self.memo.clone(), self.used.clone());
        let (compared, queries, repeated) = (self.comparisons.len(), self.queries.len(), self.repeated.len());
        let (mark, formulas) = (self.hir.mark(), self.formulas.clone());
        for (name, declared) in unread {
            // An error is reported where it stands.
            let _ = self.in_file(declared.file, |checker| checker.plain_name(name, declared.definition.span()));
        }
        (self.graph, self.memo, self.used, self.formulas) = (graph, memo, used, formulas);
        self.hir.rewind(mark);
        self.comparisons.truncate(compared);
        self.queries.truncate(queries);
        self.repeated.truncate(repeated);
    }

    /// The tests of a task, or of the sequence whose phase it is.
    fn own_tests(
        &mut self,
        sequence: InSequence<'a>,
        init: &Beginning,
        seen: (&[PaidTerm<'a>], &[ObservedChannel]),
        success: NodeId,
        texts: &dyn Texts,
    ) -> Checked<Option<CheckedTests>> {
        let statements = self.statements;
        let tests: Vec<(&Test, FileId)> = statements
            .iter()
            .filter_map(|placed| if let TaskStatement::Test(test) = &placed.statement { Some((test, placed.file)) } else { None })
            .collect();
        if !sequence.tests {
            return Ok(None);
        }
        // A sequence has succeeded in its last phase, or not yet.
        let last = sequence.index + 1 >= sequence.phases.len();
        let success = if last { success } else { self.graph.constant(0.0) };
        self.tests(&tests, init, seen, success, texts, sequence)
    }

    /// When a phase gives way, and whether it has then succeeded.
    fn phase_end(&mut self, sequence: InSequence<'a>, succeeded: Option<NodeId>) -> Checked<PhaseEnd> {
        if sequence.phases.is_empty() {
            return Ok(PhaseEnd::default());
        }
        let until = sequence.until.map(|(expr, file)| self.in_file(file, |checker| checker.single_condition(expr))).transpose();
        Ok(PhaseEnd { until: until?.map(|condition| condition.node), succeeded })
    }

    /// All `observe` blocks, in order. States and randoms are read after their update there.
    fn observations(&mut self, texts: &dyn Texts) -> Checked<Vec<ObservedChannel>> {
        let statements = self.statements;
        let mut channels = Vec::new();
        let mut failures = Failures::default();
        self.in_mode(ReadMode { after: true, ..self.mode }, |checker| {
            for placed in statements {
                if let TaskStatement::Observe(block) = &placed.statement {
                    let found =
                        checker.in_file(placed.file, |checker| checker.channels(&block.entries, texts, None, &mut channels));
                    failures.catch(found);
                }
            }
        });
        failures.or(channels)
    }

    /// All `metrics` blocks, in order: logged, never paid.
    fn metrics(&mut self, texts: &dyn Texts) -> Checked<Vec<ObservedChannel>> {
        let statements = self.statements;
        let mut metrics = Vec::new();
        let mut failures = Failures::default();
        for placed in statements {
            if let TaskStatement::Metrics(block) = &placed.statement {
                let found = self.in_file(placed.file, |checker| checker.channels(&block.entries, texts, None, &mut metrics));
                failures.catch(found);
            }
        }
        failures.or(metrics)
    }

    /// All `reward` blocks, in order.
    fn rewards(&mut self) -> Checked<Vec<PaidTerm<'a>>> {
        let statements = self.statements;
        let mut terms = Vec::new();
        let mut failures = Failures::default();
        for placed in statements {
            if let TaskStatement::Reward(reward) = &placed.statement {
                failures.catch(self.in_file(placed.file, |checker| checker.reward(reward, &mut terms)));
            }
        }
        failures.or(terms)
    }

    /// A list is said once in each task; what a task inherits comes row by row, from elsewhere.
    fn lists_once(&mut self, task: &WholeTask) {
        use TaskStatement as S;
        let mut said: Vec<&str> = Vec::new();
        for statement in &task.task.statements {
            let (word, span) = match statement {
                S::Params(block) => ("params", block.keyword),
                S::Observe(block) => ("observe", block.keyword),
                S::Metrics(block) => ("metrics", block.keyword),
                S::Reward(reward) if reward.per_second => ("reward per second", reward.span),
                S::Reward(reward) => ("reward", reward.span),
                _ => continue,
            };
            if said.contains(&word) {
                self.said_twice(span, word);
            }
            said.push(word);
        }
    }

    /// Sorts the statements; what comes twice is reported.
    fn parts(&mut self) -> Parts<'a> {
        use TaskStatement as S;
        let statements = self.statements;
        let mut parts = Parts::default();
        for Placed { statement, file, layer, .. } in statements {
            match statement {
                S::Family(name) => self.only_one(&mut parts.family, (&name.text, *file), name.span, "family"),
                S::Control(expr) => self.only_one(&mut parts.control, (expr, *file), expr.span, "control"),
                S::Horizon(expr) => self.only_one(&mut parts.horizon, (expr, *file), expr.span, "horizon"),
                S::Symmetric(_) => parts.symmetric = true,
                S::Body(body) => self.only_one(&mut parts.body, (body, *file), body.span, "body"),
                S::Init(block) => {
                    if parts.begun.replace(*layer) == Some(*layer) {
                        self.said_twice(block.keyword, "init");
                    }
                    parts.init.push((block, *file));
                }
                S::Success(expr) => self.only_one(&mut parts.success, (expr, *file), expr.span, "success"),
                _ => {}
            }
        }
        parts
    }

    fn only_one<T>(&mut self, slot: &mut Option<T>, value: T, span: Span, word: &str) {
        if slot.replace(value).is_some() {
            self.said_twice(span, word);
        }
    }

    fn said_twice(&mut self, span: Span, word: &str) {
        let message = format!("`{word}` is said twice");
        self.error(codes::tasks::REPEATED, span, message);
    }

    fn must_be_complete(&mut self, task: &WholeTask, parts: &Parts<'a>) -> Checked<()> {
        let says = |word: fn(&TaskStatement) -> bool| task.statements.iter().any(|placed| word(&placed.statement));
        let wanted = [
            ("body", parts.body.is_some()),
            ("control", parts.control.is_some()),
            ("horizon", parts.horizon.is_some()),
            ("init", !parts.init.is_empty()),
            ("observe", says(|statement| matches!(statement, TaskStatement::Observe(_)))),
            ("reward", says(|statement| matches!(statement, TaskStatement::Reward(_)))),
            ("success", parts.success.is_some()),
        ];
        let missing: Vec<String> = wanted.iter().filter(|(_, there)| !there).map(|(word, _)| format!("`{word}`")).collect();
        if missing.is_empty() { Ok(()) } else { Err(self.incomplete(task, &missing.join(", "))) }
    }

    fn incomplete(&mut self, task: &WholeTask, missing: &str) -> Reported {
        let message = format!("the task `{}` does not say {missing}", task.task.name.text);
        let diagnostic = self
            .diagnostic(codes::tasks::MISSING, task.task.name.span, message)
            .help("nothing has a silent default: an episode must say how it begins, what is seen, what pays and what succeeds");
        self.report(diagnostic)
    }

    /// A declaration that has the name of a signal or of a part of the body would hide it.
    fn must_not_hide_signals(&mut self) {
        let names = self.names;
        // The few names that are taken are looked up among those in sight, which may be as many as a text holds.
        for name in self.taken_names() {
            if let Some((declared, _)) = names.find(self.task_place, name) {
                let message = format!("`{name}` already means something: it is a part of the body, a signal or a function");
                let diagnostic =
                    Diagnostic::new(codes::names::DECLARED_TWICE, declared.file, declared.definition.span(), message)
                        .help("choose another name; `msk vocabulary` lists those taken");
                self.report(diagnostic);
            }
        }
    }

    fn control(&mut self, expr: &'a crate::syntax::tree::Expr) -> Checked<f64> {
        let frequency = self.number_of(expr, Dimension::FREQUENCY, "`control`")?;
        let Some(frequency) = self.graph.constant_value(frequency.node).filter(|f| *f > 0.0 && f.is_finite()) else {
            return Err(self.error(
                codes::types::NOT_CONSTANT,
                expr.span,
                "`control` is a positive frequency known while compiling",
            ));
        };
        let steps = 1.0 / (frequency * self.vocabulary.physics_step);
        if (steps - steps.round()).abs() > 1e-6 || steps.round() < 1.0 {
            let physics = super::ends::tidy(1.0 / self.vocabulary.physics_step);
            let diagnostic = self
                .diagnostic(codes::tasks::TIMING, expr.span, "a control step must be a whole number of physics steps")
                .expected(format!("{physics} Hz divided by a whole number"))
                .found(format!("{} Hz", for_people(frequency)));
            return Err(self.report(diagnostic));
        }
        self.timing.interval = steps.round() * self.vocabulary.physics_step;
        Ok(frequency)
    }

    fn horizon(&mut self, expr: &'a crate::syntax::tree::Expr) -> Checked<()> {
        let steps = self.steps(expr)?;
        if !(1.0..=1e8).contains(&steps) {
            return Err(self.error(codes::tasks::TIMING, expr.span, "an episode takes between one step and a hundred million"));
        }
        self.timing.horizon = steps as u32;
        Ok(())
    }

    fn declared_states(&self) -> Vec<(&'a StateDeclaration, FileId)> {
        let states = self.statements.iter().filter_map(|placed| match &placed.statement {
            TaskStatement::State(state) => Some((state, placed.file)),
            _ => None,
        });
        states.collect()
    }

    /// First values of the declared states, in the order of the text: one may read those above it.
    fn states(&mut self) {
        for (state, file) in self.declared_states() {
            let initial: Checked<TypedValue> = self.in_file(file, |checker| {
                let initial = checker.data(&state.initial)?;
                checker.check_annotation(state.annotation.as_ref(), &Value::Typed(initial.clone()))?;
                Ok(initial)
            });
            let name = state.name.text.clone();
            match initial {
                Ok(initial) => self.cells.push(Cell { name, kind: initial.kind, initial: initial.node }),
                Err(reported) => {
                    self.broken_states.insert(name, reported);
                }
            }
        }
    }

    /// New values of the declared states: the first `becomes` whose condition holds, else what it was.
    fn updates(&mut self) -> Checked<Vec<NodeId>> {
        let mut nodes = Vec::new();
        let mut failures = Failures::default();
        for (state, file) in self.declared_states() {
            let present = match self.state(&state.name.text, state.name.span) {
                Ok(Value::Typed(present)) => present,
                Ok(other) => {
                    failures.add(self.not_numbers(&other, state.name.span));
                    continue;
                }
                Err(reported) => {
                    failures.add(reported);
                    continue;
                }
            };
            let mut next = present.clone();
            for update in state.updates.iter().rev() {
                next = self.in_file(file, |checker| checker.update(update, &present, next))?;
            }
            nodes.push(next.node);
        }
        failures.or(nodes)
    }

    fn update(
        &mut self,
        update: &'a crate::syntax::tree::Update,
        present: &TypedValue,
        otherwise: TypedValue,
    ) -> Checked<TypedValue> {
        let value = self.data(&update.value);
        let condition = update.condition.as_ref().map(|condition| self.single_condition(condition)).transpose();
        let (value, condition) = (value?, condition?);
        let Some(node) = value.kept_as(&mut self.graph, &present.kind) else {
            let (expected, found) = (present.kind.described(self.vocabulary), value.kind.described(self.vocabulary));
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, update.value.span, "a state keeps its type")
                .expected(expected)
                .found(found);
            let wraps = |kind: &Type| kind.met() == Some(ElementType::WrappingAngle);
            let diagnostic = if wraps(&value.kind) && !wraps(&present.kind) && present.kind.dimension() == value.kind.dimension()
            {
                diagnostic.help("this angle wraps, the first value of the state does not: begin it with one that wraps, such as `angle_difference(0 rad, 20 deg)`")
            } else {
                diagnostic
            };
            return Err(self.report(diagnostic));
        };
        let node = match condition {
            None => node,
            Some(condition) => {
                let inputs = [condition.node, node, otherwise.node];
                self.graph.add(crate::graph::operation::Operation::Choose, &inputs)
            }
        };
        Ok(TypedValue::new(node, present.kind.clone()))
    }
}

/// What a task file says about its body, before anything else is checked.
pub(crate) fn body_of(statements: &[Placed]) -> Option<(&BodyUse, FileId)> {
    statements.iter().find_map(|placed| match &placed.statement {
        TaskStatement::Body(body) => Some((body, placed.file)),
        _ => None,
    })
}
