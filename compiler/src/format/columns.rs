//! Where the columns of statements begin, and other places that only the tree knows.

use crate::diagnostics::Span;
use crate::syntax::tree::walk::{self, Visitor};
use crate::syntax::tree::{
    Assignment, BinaryOperator, Binding, BodyStatement, Bounds, Channel, Element, Expr, ExprKind, Field, FieldValue, File,
    InitStatement, Item, Reason, SceneStatement, TaskParameter, TaskStatement, Term,
};
use std::collections::{BTreeMap, BTreeSet};

/// Statements whose columns are aligned with each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Group {
    /// All lines of the block that begins at this byte.
    Block(u32),
    /// Neighbouring statements of one sort.
    Run(Sort),
}

/// Sorts of statements that are aligned with their neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sort {
    /// A word and its value: `family stabilization`.
    Setting,
    /// `let`, `const`.
    Binding,
    /// `noise joints normal(...)`.
    Noise,
    /// Families of a suite.
    Family,
    /// Assignments of a pose.
    Assignment,
    /// Labelled channels.
    Channel,
    /// Named sets of a body.
    Set,
}

/// A column of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Column {
    /// With which statements.
    pub(super) group: Group,
    /// Its place among the columns.
    pub(super) number: usize,
    /// Whether it is a number, aligned at its point.
    pub(super) decimal: bool,
}

/// Places of a text that only its tree knows, by byte.
#[derive(Debug, Default)]
pub(super) struct Marks {
    columns: BTreeMap<usize, Column>,
    /// Names whose following mark (`=`, `{`) begins a column.
    after: BTreeMap<usize, Column>,
    binary: BTreeSet<usize>,
    /// Where the values of fields begin.
    values: BTreeSet<usize>,
    units: Vec<Span>,
    block: u32,
}

impl Marks {
    pub(super) fn of(tree: &File) -> Self {
        let mut marks = Self::default();
        walk::walk_file(&mut marks, tree);
        marks.units.sort_by_key(|unit| unit.start);
        marks
    }

    /// Whether an operator at `byte` stands between two operands.
    pub(super) fn is_binary(&self, byte: usize) -> bool {
        self.binary.contains(&byte)
    }

    /// Whether the value of a field begins at `byte`.
    pub(super) fn is_value(&self, byte: usize) -> bool {
        self.values.contains(&byte)
    }

    /// Whether two tokens belong to the same unit.
    pub(super) fn in_unit(&self, first: usize, second: usize) -> bool {
        let next = self.units.partition_point(|unit| unit.start as usize <= first);
        let unit = next.checked_sub(1).map(|index| self.units[index]);
        unit.is_some_and(|unit| second < unit.end as usize)
    }

    /// The column that begins with the token at `byte`.
    pub(super) fn column(&self, byte: usize) -> Option<Column> {
        self.columns.get(&byte).copied()
    }

    /// The column that begins behind the token at `byte`, if a mark follows.
    pub(super) fn column_after(&self, byte: usize) -> Option<Column> {
        self.after.get(&byte).copied()
    }

    fn begin(&mut self, at: Span, group: Group, number: usize) {
        self.columns.insert(at.start as usize, Column { group, number, decimal: false });
    }

    fn begin_after(&mut self, name: Span, group: Group, number: usize) {
        self.after.insert(name.start as usize, Column { group, number, decimal: false });
    }

    /// A word that begins a statement, and its value.
    fn setting(&mut self, statement: u32, value: Span) {
        let group = Group::Run(Sort::Setting);
        self.begin(Span::at(statement as usize), group, 0);
        self.begin(value, group, 1);
    }

    /// A value whose statement begins with the word before it: the column of the word is found on its line.
    fn setting_before(&mut self, value: Span) {
        self.begin(value, Group::Run(Sort::Setting), 1);
    }

    fn binding(&mut self, binding: &Binding) {
        let group = Group::Run(Sort::Binding);
        self.begin(binding.span, group, 0);
        self.begin_after(binding.annotation.as_ref().unwrap_or(&binding.name).span, group, 1);
    }

    /// Visits what is in a block, whose lines form one group.
    fn inside(&mut self, block: Span, visit: impl FnOnce(&mut Self)) {
        let outer = std::mem::replace(&mut self.block, block.start);
        visit(self);
        self.block = outer;
    }
}

impl<'a> Visitor<'a> for Marks {
    fn item(&mut self, item: &'a Item) {
        match item {
            Item::Const(binding) => self.binding(binding),
            Item::Suite(suite) => {
                for family in &suite.families {
                    self.begin(family.span, Group::Run(Sort::Family), 0);
                    self.begin_after(family.name.span, Group::Run(Sort::Family), 1);
                }
            }
            _ => {}
        }
        walk::walk_item(self, item);
    }

    fn task_statement(&mut self, statement: &'a TaskStatement) {
        use TaskStatement as S;
        match statement {
            S::Family(name) => self.setting_before(name.span),
            S::Body(body) => self.setting(body.span.start, body.name.span),
            S::Control(value) | S::Horizon(value) | S::Success(value) => self.setting_before(value.span),
            S::Symmetric(span) => self.begin(*span, Group::Run(Sort::Setting), 0),
            S::Let(binding) => self.binding(binding),
            S::Params(block) => return self.inside(block.span, |marks| walk::walk_task_statement(marks, statement)),
            S::Reward(reward) => return self.inside(reward.span, |marks| walk::walk_task_statement(marks, statement)),
            S::Terminate(ends) | S::Finish(ends) => {
                return self.inside(ends.span, |marks| walk::walk_task_statement(marks, statement));
            }
            S::Scene(block) => return self.inside(block.span, |marks| walk::walk_task_statement(marks, statement)),
            _ => {}
        }
        walk::walk_task_statement(self, statement);
    }

    fn channel(&mut self, channel: &'a Channel) {
        if let Some(label) = &channel.label {
            self.begin(channel.span, Group::Run(Sort::Channel), 0);
            self.begin_after(label.span, Group::Run(Sort::Channel), 1);
        }
        self.expression(&channel.value);
        channel.settings.iter().for_each(|setting| self.expression(&setting.value));
    }

    fn term(&mut self, term: &'a Term) {
        let group = Group::Block(self.block);
        if let Some(weight) = &term.weight {
            let first = weight.schedule.as_ref().map_or(weight.span, |schedule| schedule.from_span);
            self.columns.insert(first.start as usize, Column { group, number: 0, decimal: true });
            if let Some(schedule) = &weight.schedule {
                self.begin(schedule.span, group, 1);
                schedule.begin.iter().chain([&schedule.end]).for_each(|share| self.expression(share));
            }
            if let Bounds::Fixed(span) | Bounds::Range { span, .. } = weight.bounds {
                self.begin(span, group, 2);
            }
        }
        self.begin(term.name.span, group, 3);
        self.begin_after(term.name.span, group, 4);
        term.formula.iter().for_each(|formula| self.expression(formula));
    }

    fn reason(&mut self, reason: &'a Reason) {
        self.begin(reason.span, Group::Block(self.block), 0);
        self.begin_after(reason.bootstrap.unwrap_or(reason.name.span), Group::Block(self.block), 1);
        self.expression(&reason.condition);
    }

    fn task_parameter(&mut self, parameter: &'a TaskParameter) {
        self.begin(parameter.span, Group::Block(self.block), 0);
        let last = parameter.annotation.as_ref().unwrap_or(&parameter.name);
        self.begin_after(last.span, Group::Block(self.block), 1);
        self.expression(&parameter.value);
        parameter.range.iter().for_each(|range| self.expression(range));
    }

    fn scene_statement(&mut self, statement: &'a SceneStatement) {
        let group = Group::Block(self.block);
        match statement {
            SceneStatement::Connection(connection) => {
                self.begin(connection.span, group, 0);
                self.begin(connection.from.span, group, 1);
            }
            SceneStatement::Group(set) => {
                self.begin(set.span, group, 0);
                self.begin(set.name.span, group, 1);
            }
            SceneStatement::Marker(marker) => {
                self.begin(marker.span, group, 0);
                self.begin(marker.name.span, group, 1);
            }
            SceneStatement::Repeat(repeat) => {
                return self.inside(repeat.span, |marks| walk::walk_scene_statement(marks, statement));
            }
            _ => {}
        }
        walk::walk_scene_statement(self, statement);
    }

    fn init_statement(&mut self, statement: &'a InitStatement) {
        if let InitStatement::Noise(noise) = statement {
            let group = Group::Run(Sort::Noise);
            self.begin(noise.span, group, 0);
            self.begin(noise.target.span, group, 1);
            self.begin(noise.distribution.span, group, 2);
        }
        if let InitStatement::Scaling(scaling) = statement {
            let group = Group::Run(Sort::Noise);
            self.begin(scaling.span, group, 0);
            self.begin(scaling.target.span, group, 1);
            self.begin(scaling.factor.span, group, 2);
        }
        walk::walk_init_statement(self, statement);
    }

    fn body_statement(&mut self, statement: &'a BodyStatement) {
        match statement {
            BodyStatement::Model(text) => self.setting_before(text.span),
            BodyStatement::Setting { name, value } => self.setting(name.span.start, value.span),
            BodyStatement::Group(set) => {
                let last = set.title.as_ref().map_or(set.name.span, |title| title.span);
                self.begin(set.span, Group::Run(Sort::Set), 0);
                self.begin_after(last, Group::Run(Sort::Set), 1);
            }
            BodyStatement::Element(element) if element.kind.text == "root" => {
                if let Some(name) = &element.name {
                    self.setting(element.kind.span.start, name.span());
                }
            }
            _ => {}
        }
        walk::walk_body_statement(self, statement);
    }

    fn element(&mut self, element: &'a Element) {
        if let Some(name) = &element.name
            && !matches!(element.kind.text.as_str(), "root" | "landmark" | "disturb" | "protocol" | "sweep")
        {
            let group = Group::Block(self.block);
            self.begin(element.kind.span, group, 0);
            self.begin(name.span(), group, 1);
            self.begin_after(name.span(), group, 2);
        }
        if matches!(element.kind.text.as_str(), "protocol" | "sweep") {
            for field in &element.fields {
                if let FieldValue::Value(value) = &field.value {
                    self.setting(field.span.start, value.span);
                }
            }
        }
        self.inside(element.span, |marks| walk::walk_element(marks, element));
    }

    fn field(&mut self, field: &'a Field) {
        if let FieldValue::Value(value) = &field.value {
            self.values.insert(value.span.start as usize);
        }
        walk::walk_field(self, field);
    }

    fn assignment(&mut self, assignment: &'a Assignment) {
        self.begin(assignment.span, Group::Run(Sort::Assignment), 0);
        self.begin_after(assignment.target.span, Group::Run(Sort::Assignment), 1);
        self.expression(&assignment.target);
        self.expression(&assignment.value);
    }

    fn expression(&mut self, expression: &'a Expr) {
        match &expression.kind {
            ExprKind::Number(quantity) => self.units.extend(quantity.unit.as_ref().map(|unit| unit.span)),
            ExprKind::Binary { operator, operator_span, .. } if *operator != BinaryOperator::Power => {
                self.binary.insert(operator_span.start as usize);
            }
            _ => {}
        }
        walk::walk_expression(self, expression);
    }
}
