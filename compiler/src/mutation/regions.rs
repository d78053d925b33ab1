//! The text that may be mutated: formulas and weights, by the part of the task in which they stand.

use super::Part;
use crate::diagnostics::Span;
use crate::syntax::tree::{
    Align, Block, Channel, Element, Entry, Field, FieldValue, File, InitStatement, Item, SceneStatement, TaskStatement,
};

/// A stretch of the text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub part: Part,
    /// A weight; else a formula.
    pub weight: bool,
    pub span: Span,
}

/// All of the task of a file; none where there is no such task.
pub(super) fn regions(tree: &File, name: &str) -> Vec<Region> {
    let mut found = Found(Vec::new());
    let task = tree.items.iter().find_map(|item| match item {
        Item::Task(task) if task.name.text == name => Some(task),
        _ => None,
    });
    for statement in task.into_iter().flat_map(|task| &task.statements) {
        found.statement(statement);
    }
    found.0
}

struct Found(Vec<Region>);

impl Found {
    fn formula(&mut self, part: Part, span: Span) {
        self.0.push(Region { part, weight: false, span });
    }

    fn statement(&mut self, statement: &TaskStatement) {
        match statement {
            TaskStatement::Reward(reward) => {
                let terms = reward.terms.iter().filter_map(|entry| if let Entry::Item(term) = entry { Some(term) } else { None });
                for term in terms {
                    self.0.extend(term.weight.as_ref().map(|weight| Region {
                        part: Part::Meaning,
                        weight: true,
                        span: weight.span,
                    }));
                    term.formula.iter().for_each(|formula| self.formula(Part::Meaning, formula.span));
                }
            }
            TaskStatement::Terminate(ends) | TaskStatement::Finish(ends) => {
                ends.after.iter().for_each(|after| self.formula(Part::Meaning, after.span));
                for reason in &ends.reasons {
                    if let Entry::Item(reason) = reason {
                        self.formula(Part::Meaning, reason.condition.span);
                    }
                }
            }
            TaskStatement::Success(expr) => self.formula(Part::Meaning, expr.span),
            TaskStatement::Let(binding) => self.formula(Part::Meaning, binding.value.span),
            TaskStatement::Clock(clock) => self.formula(Part::Meaning, clock.frequency.span),
            TaskStatement::Control(frequency) => self.formula(Part::Meaning, frequency.span),
            TaskStatement::Horizon(duration) => self.formula(Part::Meaning, duration.span),
            TaskStatement::Params(block) => {
                let parameters =
                    block.entries.iter().filter_map(|entry| if let Entry::Item(item) = entry { Some(item) } else { None });
                parameters.for_each(|parameter| self.formula(Part::Meaning, parameter.value.span));
            }
            TaskStatement::Random(random) => {
                self.formula(Part::InitialState, random.distribution.span);
                random.accept.iter().for_each(|accept| self.formula(Part::InitialState, accept.span));
                random.redraw.iter().for_each(|redraw| self.formula(Part::Meaning, redraw.span));
            }
            TaskStatement::Reference(reference) => {
                reference.start.iter().for_each(|start| self.formula(Part::InitialState, start.span));
            }
            TaskStatement::Act(act) => self.fields(Part::Action, &act.fields),
            TaskStatement::Disturb(element) => self.element(element),
            TaskStatement::State(state) => {
                self.formula(Part::Meaning, state.initial.span);
                state.updates.iter().for_each(|update| self.formula(Part::Meaning, update.span));
            }
            TaskStatement::Scene(block) => block.entries.iter().for_each(|statement| self.scene(statement)),
            TaskStatement::Init(block) => block.entries.iter().for_each(|statement| self.initial_state(statement)),
            TaskStatement::Observe(block) => self.observation(block),
            _ => {}
        }
    }

    fn observation(&mut self, block: &Block<Entry<Channel>>) {
        for entry in &block.entries {
            if let Entry::Item(channel) = entry {
                self.formula(Part::Observation, channel.value.span);
                channel.settings.iter().for_each(|setting| self.formula(Part::Observation, setting.value.span));
            }
        }
    }

    fn scene(&mut self, statement: &SceneStatement) {
        match statement {
            SceneStatement::Element(element) => self.element(element),
            SceneStatement::Connection(connection) => self.formula(Part::Scene, connection.span),
            SceneStatement::Group(group) => self.formula(Part::Scene, group.members.span),
            SceneStatement::Repeat(repeat) => {
                self.formula(Part::Scene, repeat.range.span);
                repeat.statements.iter().for_each(|statement| self.scene(statement));
            }
            // A marker is only drawn.
            SceneStatement::Marker(_) | SceneStatement::Remove(_) | SceneStatement::Allow(_) => {}
        }
    }

    fn element(&mut self, element: &Element) {
        self.fields(Part::Scene, &element.fields);
        element.parts.iter().for_each(|part| self.element(part));
    }

    fn fields(&mut self, part: Part, fields: &[Field]) {
        for field in fields {
            match &field.value {
                FieldValue::Flag => {}
                FieldValue::Value(expr) | FieldValue::On(expr) => self.formula(part, expr.span),
                FieldValue::Align(Align { place: first, target: second, .. })
                | FieldValue::FromTo { from: first, to: second } => {
                    self.formula(part, first.span);
                    self.formula(part, second.span);
                }
            }
        }
    }

    fn initial_state(&mut self, statement: &InitStatement) {
        let part = Part::InitialState;
        match statement {
            InitStatement::Pose(pose) => {
                pose.adjustments.iter().for_each(|adjustment| self.formula(part, adjustment.span));
            }
            InitStatement::Object(placement) => self.fields(part, &placement.fields),
            InitStatement::Noise(noise) => self.formula(part, noise.distribution.span),
            InitStatement::Scaling(scaling) => self.formula(part, scaling.factor.span),
            InitStatement::Settle(settle) => {
                self.formula(part, settle.duration.span);
                settle.activation.iter().for_each(|activation| self.formula(part, activation.span));
            }
            InitStatement::Remove(_) | InitStatement::Allow(_) => {}
        }
    }
}
