//! A task: its statements in any order, from tree to [`CheckedTask`].

use super::context::{Cell, Checked, Checker, Reported, Timing};
use super::dimension::Dimension;
use super::lints;
use super::observe::{ObservedChannel, Texts};
use super::reward::PaidTerm;
use super::scene::Surroundings;
use super::scope::{Names, Place};
use super::value::Data;
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::frame::Query;
use crate::graph::interval::Bounds;
use crate::graph::{Graph, NodeId};
use crate::scene::SceneDescription;
use crate::syntax::tree::{StateDeclaration, Task, TaskStatement};
use crate::task::{Disturbance, Init};
use crate::vocabulary::Vocabulary;

/// A task whose every formula is checked and in the graph.
pub(crate) struct CheckedTask<'a> {
    pub graph: Graph,
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
    pub terminations: Vec<(String, NodeId)>,
    pub success: NodeId,
    /// Between which values each term stays.
    pub term_bounds: Vec<Bounds>,
    /// New values of the declared states.
    pub updates: Vec<NodeId>,
    pub states: Vec<Cell>,
}

/// The single statements of a task.
#[derive(Default)]
struct Parts<'a> {
    family: Option<&'a str>,
    control: Option<&'a crate::syntax::tree::Expr>,
    horizon: Option<&'a crate::syntax::tree::Expr>,
    symmetric: bool,
    init: Option<&'a crate::syntax::tree::Block<crate::syntax::tree::InitStatement>>,
    observe: Option<&'a crate::syntax::tree::Block<crate::syntax::tree::Entry<crate::syntax::tree::Channel>>>,
    reward: Option<&'a crate::syntax::tree::Reward>,
    success: Option<&'a crate::syntax::tree::Expr>,
}

/// Checks a task against the vocabulary of its body. Errors and warnings come with it; the task only if there is no error.
pub(crate) fn check<'a>(
    task: &'a Task,
    file: FileId,
    names: &'a Names<'a>,
    vocabulary: &'a Vocabulary,
    surroundings: &'a Surroundings<'a>,
    texts: &dyn Texts,
) -> (Option<CheckedTask<'a>>, Vec<Diagnostic>) {
    let mut checker = Checker::new(vocabulary, names, Place::of_task(file), &task.statements);
    checker.known = surroundings.known.clone();
    checker.surroundings = Some(surroundings);
    let checked = checker.task(task, texts).ok();
    let broken = checker.diagnostics.iter().any(|diagnostic| diagnostic.severity == crate::diagnostics::Severity::Error);
    let mut diagnostics = std::mem::take(&mut checker.diagnostics);
    let mut checked = checked.filter(|_| !broken);
    if let Some(checked) = &mut checked {
        lints::unused(&checker, &mut diagnostics);
        checked.term_bounds = lints::task(&checker, checked, &mut diagnostics);
    }
    (checked, diagnostics)
}

impl<'a> Checker<'a> {
    fn task(&mut self, task: &'a Task, texts: &dyn Texts) -> Checked<CheckedTask<'a>> {
        if let Some(parent) = &task.extends {
            self.not_yet(parent.span, "extends");
        }
        let parts = self.parts(task);
        self.must_not_hide_signals();
        let frequency = parts.control.map(|control| self.control(control)).transpose();
        let horizon = match (&frequency, parts.horizon) {
            (Ok(_), Some(horizon)) => self.horizon(horizon).map(Some),
            _ => Ok(None),
        };
        self.states();
        self.beginning = true;
        let init = parts.init.map(|block| self.init(&block.entries, block.keyword)).transpose();
        let staged = self.staged();
        self.beginning = false;
        let terminations = self.terminations();
        let mut terms = Vec::new();
        let reward = parts.reward.map(|reward| self.reward(reward, &mut terms)).transpose();
        let success = parts.success.map(|success| self.single_condition(success)).transpose();
        let updates = self.updates();
        let mut channels = Vec::new();
        self.after = true;
        let observe = parts.observe.map(|block| self.channels(&block.entries, texts, None, &mut channels)).transpose();
        self.after = false;
        self.must_be_complete(task, &parts);
        let (control_frequency, _) = (frequency?, (horizon?, reward?, observe?));
        let staged = staged?;
        let (Some(control_frequency), Some(init), Some(success)) = (control_frequency, init?, success?) else {
            return Err(Reported);
        };
        Ok(CheckedTask {
            graph: std::mem::take(&mut self.graph),
            family: parts.family.unwrap_or_default().to_owned(),
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
            channels,
            terms,
            terminations: terminations?,
            success: success.node,
            term_bounds: Vec::new(),
            updates: updates?,
            states: std::mem::take(&mut self.cells),
        })
    }

    /// Sorts the statements; what comes twice or is not supported yet is reported.
    fn parts(&mut self, task: &'a Task) -> Parts<'a> {
        use TaskStatement as S;
        let mut parts = Parts::default();
        for statement in &task.statements {
            match statement {
                S::Family(name) => self.only_one(&mut parts.family, &name.text, name.span, "family"),
                S::Control(expr) => self.only_one(&mut parts.control, expr, expr.span, "control"),
                S::Horizon(expr) => self.only_one(&mut parts.horizon, expr, expr.span, "horizon"),
                S::Symmetric(_) => parts.symmetric = true,
                S::Init(block) => self.only_one(&mut parts.init, block, block.keyword, "init"),
                S::Observe(block) => self.only_one(&mut parts.observe, block, block.keyword, "observe"),
                S::Reward(reward) => self.only_one(&mut parts.reward, reward, reward.span, "reward"),
                S::Success(expr) => self.only_one(&mut parts.success, expr, expr.span, "success"),
                S::Allow(allow) => self.allow(allow),
                S::Body(body) if !body.edits.is_empty() => {
                    self.not_yet(body.span, "body ... with");
                }
                S::Scene(block) => self.allow_in_scene(&block.entries),
                S::Disturb(_) | S::Body(_) | S::Terminate(_) | S::Let(_) | S::State(_) | S::Clock(_) => {}
                other => {
                    if let Some((span, word)) = unsupported(other) {
                        self.not_yet(span, word);
                    }
                }
            }
        }
        parts
    }

    fn only_one<T>(&mut self, slot: &mut Option<T>, value: T, span: Span, word: &str) {
        if slot.replace(value).is_some() {
            let message = format!("`{word}` is said twice");
            self.error(codes::tasks::REPEATED, span, message);
        }
    }

    fn must_be_complete(&mut self, task: &Task, parts: &Parts<'a>) {
        let has_body = task.statements.iter().any(|statement| matches!(statement, TaskStatement::Body(_)));
        let wanted = [
            ("body", has_body),
            ("control", parts.control.is_some()),
            ("horizon", parts.horizon.is_some()),
            ("init", parts.init.is_some()),
            ("observe", parts.observe.is_some()),
            ("reward", parts.reward.is_some()),
            ("success", parts.success.is_some()),
        ];
        let missing: Vec<String> = wanted.iter().filter(|(_, there)| !there).map(|(word, _)| format!("`{word}`")).collect();
        if !missing.is_empty() {
            let message = format!("the task `{}` does not say {}", task.name.text, missing.join(", "));
            let diagnostic = self.diagnostic(codes::tasks::MISSING, task.name.span, message).help(
                "nothing has a silent default: an episode must say how it begins, what is seen, what pays and what succeeds",
            );
            self.report(diagnostic);
        }
    }

    /// A declaration that has the name of a signal or of a part of the body would hide it.
    fn must_not_hide_signals(&mut self) {
        let names = self.names;
        for name in names.in_sight(self.task_place) {
            if self.means_something(name)
                && let Some((declared, _)) = names.find(self.task_place, name)
            {
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
                .found(format!("{frequency} Hz"));
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

    fn declared_states(&self) -> Vec<&'a StateDeclaration> {
        let states = self.statements.iter();
        states.filter_map(|statement| if let TaskStatement::State(state) = statement { Some(state) } else { None }).collect()
    }

    /// First values of the declared states, in the order of the text: one may read those above it.
    fn states(&mut self) {
        for state in self.declared_states() {
            let Ok(initial) = self.data(&state.initial) else { continue };
            let checked = self.check_annotation(state.annotation.as_ref(), &super::value::Value::Data(initial.clone()));
            if checked.is_ok() {
                self.cells.push(Cell { name: state.name.text.clone(), kind: initial.kind, initial: initial.node });
            }
        }
    }

    /// New values of the declared states: the first `becomes` whose condition holds, else what it was.
    fn updates(&mut self) -> Checked<Vec<NodeId>> {
        let mut nodes = Vec::new();
        for state in self.declared_states() {
            let Ok(super::value::Value::Data(present)) = self.state(&state.name.text, state.name.span) else { continue };
            let mut next = present.clone();
            for update in state.updates.iter().rev() {
                next = self.update(update, &present, next)?;
            }
            nodes.push(next.node);
        }
        if nodes.len() == self.declared_states().len() { Ok(nodes) } else { Err(Reported) }
    }

    fn update(&mut self, update: &'a crate::syntax::tree::Update, present: &Data, otherwise: Data) -> Checked<Data> {
        let value = self.data(&update.value);
        let condition = update.condition.as_ref().map(|condition| self.single_condition(condition)).transpose();
        let (value, condition) = (value?, condition?);
        let fits = value.kind == present.kind || value.is_zero() && present.kind.dimension().is_some();
        if !fits {
            let (expected, found) = (present.kind.described(self.vocabulary), value.kind.described(self.vocabulary));
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, update.value.span, "a state keeps its type")
                .expected(expected)
                .found(found);
            return Err(self.report(diagnostic));
        }
        let node = match condition {
            None => value.node,
            Some(condition) => {
                let inputs = [condition.node, value.node, otherwise.node];
                self.graph.add(crate::graph::operation::Operation::Choose, &inputs)
            }
        };
        Ok(Data::new(node, present.kind.clone()))
    }
}

/// Statements of the language that this version does not run, with the word that names them.
fn unsupported(statement: &TaskStatement) -> Option<(Span, &'static str)> {
    use TaskStatement as S;
    Some(match statement {
        S::Params(block) => (block.keyword, "params"),
        S::Metrics(block) => (block.keyword, "metrics"),
        S::Finish(ends) => (ends.span, "finish"),
        S::Random(random) => (random.span, "random"),
        S::Reference(reference) => (reference.span, "reference"),
        S::Phase(phase) => (phase.span, "phase"),
        S::Test(test) => (test.span, if test.cheat { "cheat" } else { "test" }),
        _ => return None,
    })
}

/// What a task file says about its body, before anything else is checked.
pub(crate) fn body_name(task: &Task) -> Option<&crate::syntax::tree::Ident> {
    task.statements.iter().find_map(|statement| match statement {
        TaskStatement::Body(body) => Some(&body.name),
        _ => None,
    })
}

/// The first sentence group of a documentation comment.
pub(crate) fn summary(task: &Task) -> String {
    let text = task.docs.as_ref().map_or("", |docs| docs.text.as_str());
    let paragraph: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    paragraph.join(" ")
}
