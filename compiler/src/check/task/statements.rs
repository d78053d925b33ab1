//! The statements of a task: which there are, once each, and none missing.

use crate::check::context::{Checked, Checker, Reported};
use crate::check::init::Layer;
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::resolve::inherit::{Placed, WholeTask};
use crate::resolve::scope::Declared;
use crate::syntax::tree::{Act, BodyUse, Expr, TaskStatement};
use std::collections::BTreeMap;

/// Something of a task with the file in which it stands.
pub(super) type Located<T> = Option<(T, FileId)>;

/// The single statements of a task.
#[derive(Default)]
pub(super) struct Parts<'a> {
    pub family: Located<&'a str>,
    pub control: Located<&'a Expr>,
    pub horizon: Located<&'a Expr>,
    pub act: Located<&'a Act>,
    pub symmetric: bool,
    body: Located<&'a BodyUse>,
    /// Of each task of a line of extended ones, the oldest first.
    pub init: Vec<Layer<'a>>,
    /// The layer of the latest of them.
    begun: Option<usize>,
    pub success: Located<&'a Expr>,
}

impl<'a> Checker<'a> {
    /// A list is declared once in each task; what a task inherits comes row by row, from elsewhere.
    pub(super) fn lists_once(&mut self, task: &WholeTask) {
        use TaskStatement as S;
        let mut seen: Vec<&str> = Vec::new();
        for statement in &task.task.statements {
            let (word, span) = match statement {
                S::Params(block) => ("params", block.keyword),
                S::Observe(block) => ("observe", block.keyword),
                S::Critic(block) => ("critic", block.keyword),
                S::Metrics(block) => ("metrics", block.keyword),
                S::Reward(reward) if reward.per_second => ("reward per second", reward.span),
                S::Reward(reward) => ("reward", reward.span),
                _ => continue,
            };
            if seen.contains(&word) {
                self.given_twice(span, word);
            }
            seen.push(word);
        }
    }

    /// Sorts the statements; what comes twice is reported.
    pub(super) fn parts(&mut self) -> Parts<'a> {
        use TaskStatement as S;
        let statements = self.statements;
        let mut parts = Parts::default();
        for Placed { statement, file, layer, .. } in statements {
            match statement {
                S::Family(name) => self.only_one(&mut parts.family, (&name.text, *file), name.span, "family"),
                S::Control(expr) => self.only_one(&mut parts.control, (expr, *file), expr.span, "control"),
                S::Horizon(expr) => self.only_one(&mut parts.horizon, (expr, *file), expr.span, "horizon"),
                S::Act(act) => self.only_one(&mut parts.act, (act, *file), act.keyword, "act"),
                S::Symmetric(_) => parts.symmetric = true,
                S::Body(body) => self.only_one(&mut parts.body, (body, *file), body.span, "body"),
                S::Init(block) => {
                    if parts.begun.replace(*layer) == Some(*layer) {
                        self.given_twice(block.keyword, "init");
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
            self.given_twice(span, word);
        }
    }

    fn given_twice(&mut self, span: Span, word: &str) {
        let message = format!("`{word}` is given twice");
        self.error(codes::tasks::REPEATED, span, message);
    }

    pub(super) fn must_be_complete(&mut self, task: &WholeTask, parts: &Parts<'a>) -> Checked<()> {
        let has = |word: fn(&TaskStatement) -> bool| task.statements.iter().any(|placed| word(&placed.statement));
        let wanted = [
            ("body", parts.body.is_some()),
            ("control", parts.control.is_some()),
            ("horizon", parts.horizon.is_some()),
            ("init", !parts.init.is_empty()),
            ("observe", has(|statement| matches!(statement, TaskStatement::Observe(_)))),
            ("reward", has(|statement| matches!(statement, TaskStatement::Reward(_)))),
            ("success", parts.success.is_some()),
        ];
        let missing: Vec<String> = wanted.iter().filter(|(_, there)| !there).map(|(word, _)| format!("`{word}`")).collect();
        if missing.is_empty() { Ok(()) } else { Err(self.incomplete(task, &missing.join(", "))) }
    }

    pub(super) fn incomplete(&mut self, task: &WholeTask, missing: &str) -> Reported {
        let message = format!("the task `{}` does not declare {missing}", task.task.name.text);
        let diagnostic = self
            .diagnostic(codes::tasks::MISSING, task.task.name.span, message)
            .help("there are no silent defaults: a task declares its initial state, observation, reward and success");
        self.report(diagnostic)
    }

    /// A declaration that has the name of a signal or of a part of the body would hide it.
    pub(super) fn must_not_hide_signals(&mut self) {
        let names = self.names;
        // The few names that are taken are looked up among those in sight, which may be as many as a text holds.
        let find = |name| Some((name, names.find(self.task_place, name)?.0));
        let hidden: BTreeMap<&str, Declared<'_>> = self.taken().filter_map(find).collect();
        for (name, declared) in hidden {
            let message = format!("`{name}` is already defined: it is a part of the body, a signal or a function");
            let diagnostic = Diagnostic::new(codes::names::DECLARED_TWICE, declared.file, declared.definition.span(), message)
                .help("choose another name; `msk vocabulary` lists the names in use");
            self.report(diagnostic);
        }
    }
}

/// What a task file declares about its body, before anything else is checked.
pub(crate) fn body_of(statements: &[Placed]) -> Option<(&BodyUse, FileId)> {
    statements.iter().find_map(|placed| match &placed.statement {
        TaskStatement::Body(body) => Some((body, placed.file)),
        _ => None,
    })
}
