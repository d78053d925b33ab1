//! What the words of formulas and statements mean.

use super::declare::{expanded, removed};
use super::{Index, Space};
use crate::diagnostics::Span;
use crate::syntax::tree::walk::{self, Visitor};
use crate::syntax::tree::{
    BodyStatement, ElementName, Expr, ExprKind, Function, Ident, InitStatement, Item, Name, NamePart, Played, PoseUse,
    SceneStatement, TaskStatement, TestStatement,
};

/// Finds what every word means.
pub(super) fn refer(index: &mut Index) {
    for file in 0..index.files.len() {
        // The walk reads the trees while it adds to the index beside them.
        let items = std::mem::take(&mut index.files[file].tree.items);
        for (place, item) in items.iter().enumerate() {
            let mut walker = Walker { index, file, task: Some(place), locals: Vec::new() };
            walker.item(item);
        }
        index.files[file].tree.items = items;
    }
}

struct Walker<'i> {
    index: &'i mut Index,
    file: usize,
    /// The item around, by its place in the file.
    task: Option<usize>,
    locals: Vec<(String, usize)>,
}

impl Walker<'_> {
    /// What a name means here, in the order in which the checker looks.
    fn meaning(&self, space: Space, name: &str) -> Option<usize> {
        if space == Space::Value
            && let Some((_, symbol)) = self.locals.iter().rev().find(|(local, _)| local == name)
        {
            return Some(*symbol);
        }
        let own = self.task.and_then(|task| self.index.tasks.get(&(self.file, task)));
        let own = own.and_then(|names| names.get(&(space, name.to_owned())).copied());
        own.or_else(|| self.index.top_level(self.file, space, name)).or_else(|| self.of_body(space, name))
    }

    /// Parts and poses stand in body files, which no task uses by name of the file.
    fn of_body(&self, space: Space, name: &str) -> Option<usize> {
        let space = if space == Space::Value { Space::Part } else { space };
        if !matches!(space, Space::Part | Space::Pose | Space::Body) {
            return None;
        }
        let key = (space, name.to_owned());
        self.index.top.iter().find_map(|names| names.get(&key).copied())
    }

    fn ident(&mut self, space: Space, ident: &Ident) {
        if let Some(symbol) = self.meaning(space, &ident.text) {
            self.index.occurs(self.file, ident.span, symbol, false, false);
        }
    }

    fn name(&mut self, space: Space, name: &Name) {
        let plain = matches!(name.parts.as_slice(), [NamePart::Literal(_)]);
        for text in expanded(name) {
            if let Some(symbol) = self.meaning(space, &text) {
                self.index.occurs(self.file, name.span, symbol, false, !plain);
            }
        }
        for part in &name.parts {
            if let NamePart::Variable(variable) = part
                && let Some(at) = name.text.find(&format!("{{{variable}}}"))
                && let Some(symbol) = self.meaning(Space::Value, variable)
            {
                let start = name.span.start as usize + at + 1;
                self.index.occurs(self.file, Span::new(start, start + variable.len()), symbol, false, false);
            }
        }
    }

    /// `door.leaf`: a part of an object, named by its last word.
    fn part(&mut self, base: &Expr, name: &Name) {
        let Some(object) = dotted(base) else { return };
        if let Some(symbol) = self.meaning(Space::Value, &format!("{object}.{}", name.text)) {
            self.index.occurs(self.file, name.span, symbol, false, false);
        }
    }

    /// A name that holds within `inside` only.
    fn with_local(&mut self, name: &Ident, what: &'static str, inside: impl FnOnce(&mut Self)) {
        let symbol = self.index.symbol(&name.text, Space::Value, what, None);
        self.index.occurs(self.file, name.span, symbol, true, false);
        self.locals.push((name.text.clone(), symbol));
        inside(self);
        self.locals.pop();
    }

    fn function(&mut self, function: &Function) {
        let locals = self.locals.len();
        for parameter in &function.parameters {
            let symbol = self.index.symbol(&parameter.name.text, Space::Value, "argument", None);
            self.index.occurs(self.file, parameter.name.span, symbol, true, false);
            self.locals.push((parameter.name.text.clone(), symbol));
        }
        self.expression(&function.body);
        self.locals.truncate(locals);
    }

    fn pose(&mut self, pose: &PoseUse) {
        self.ident(Space::Pose, &pose.name);
    }
}

/// `door.leaf` of a chain of plain names.
fn dotted(expr: &Expr) -> Option<String> {
    match &expr.kind {
        ExprKind::Name(name) => Some(name.text.clone()),
        ExprKind::Field { base, name } => Some(format!("{}.{}", dotted(base)?, name.text)),
        _ => None,
    }
}

impl<'t> Visitor<'t> for Walker<'_> {
    fn item(&mut self, item: &'t Item) {
        match item {
            Item::Function(function) => self.function(function),
            Item::Task(task) => {
                if let Some(parent) = &task.extends {
                    self.ident(Space::Task, parent);
                }
                walk::walk_item(self, item);
            }
            Item::Suite(suite) => {
                suite.families.iter().flat_map(|family| &family.tasks).for_each(|task| self.ident(Space::Task, task));
            }
            // What stands in a body file are names of the model.
            Item::Body(body) => body.statements.iter().for_each(|statement| self.body_statement(statement)),
            _ => walk::walk_item(self, item),
        }
    }

    fn body_statement(&mut self, _: &'t BodyStatement) {}

    fn task_statement(&mut self, statement: &'t TaskStatement) {
        use TaskStatement as S;
        match statement {
            S::Body(body) => self.ident(Space::Body, &body.name),
            S::Phase(phase) => self.ident(Space::Task, &phase.task),
            S::Reward(reward) => removed(&reward.terms).for_each(|name| self.name(Space::Term, name)),
            S::Terminate(ends) | S::Finish(ends) => removed(&ends.reasons).for_each(|name| self.name(Space::Reason, name)),
            S::Observe(block) | S::Critic(block) | S::Metrics(block) => {
                removed(&block.entries).for_each(|name| self.name(Space::Label, name))
            }
            S::Params(block) => removed(&block.entries).for_each(|name| self.name(Space::Value, name)),
            S::Disturb(element) => {
                if let Some(ElementName::Name(name)) = &element.name {
                    self.name(Space::Value, name);
                }
            }
            _ => {}
        }
        walk::walk_task_statement(self, statement);
    }

    fn scene_statement(&mut self, statement: &'t SceneStatement) {
        match statement {
            SceneStatement::Repeat(repeat) => {
                self.expression(&repeat.range);
                let statements = &repeat.statements;
                self.with_local(&repeat.variable, "loop variable", |walker| {
                    statements.iter().for_each(|statement| walker.scene_statement(statement));
                });
            }
            SceneStatement::Remove(remove) => self.name(Space::Value, &remove.name),
            SceneStatement::Element(element) => {
                // The name itself may hold the variable of a loop.
                if let Some(ElementName::Name(name)) = &element.name {
                    self.name(Space::Value, name);
                }
                walk::walk_scene_statement(self, statement);
            }
            _ => walk::walk_scene_statement(self, statement),
        }
    }

    fn init_statement(&mut self, statement: &'t InitStatement) {
        match statement {
            InitStatement::Pose(pose) => self.pose(pose),
            InitStatement::Object(placement) => self.name(Space::Value, &placement.object),
            _ => {}
        }
        walk::walk_init_statement(self, statement);
    }

    fn test_statement(&mut self, statement: &'t TestStatement) {
        match statement {
            TestStatement::Pose(situation) | TestStatement::Keyframe { situation, .. } => {
                situation.pose.iter().for_each(|pose| self.ident(Space::Pose, pose));
            }
            TestStatement::Object(placement) => self.name(Space::Value, &placement.object),
            TestStatement::Given { name, .. } => self.ident(Space::Value, name),
            TestStatement::Play(playing) => {
                if let Played::Reference(name) = &playing.motion {
                    self.ident(Space::Value, name);
                }
            }
            TestStatement::Repeat { variable, range, statements, .. } => {
                self.expression(range);
                self.with_local(variable, "loop variable", |walker| {
                    statements.iter().for_each(|statement| walker.test_statement(statement));
                });
                return;
            }
            _ => {}
        }
        walk::walk_test_statement(self, statement);
    }

    fn expression(&mut self, expression: &'t Expr) {
        match &expression.kind {
            ExprKind::Name(name) => self.name(Space::Value, name),
            ExprKind::EndedBy(reason) => self.ident(Space::Reason, reason),
            ExprKind::InFrame { frame, .. } => self.name(Space::Value, &frame.name),
            ExprKind::Field { base, name } => {
                self.part(base, name);
                match &base.kind {
                    // `expect reward.pose at neutral`
                    ExprKind::Name(word) if word.text == "reward" => self.name(Space::Term, name),
                    ExprKind::Name(word) if word.text == "metrics" => self.name(Space::Label, name),
                    // `walk.success` of a phase
                    ExprKind::Name(word) if name.text == "success" => self.name(Space::Task, word),
                    _ => {}
                }
            }
            ExprKind::At { pose, .. } => self.ident(Space::Pose, pose),
            ExprKind::Comprehension { element, variable, source } => {
                self.expression(source);
                self.with_local(variable, "loop variable", |walker| walker.expression(element));
                return;
            }
            _ => {}
        }
        walk::walk_expression(self, expression);
    }
}
