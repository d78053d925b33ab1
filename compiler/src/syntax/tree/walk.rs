//! A walk over a tree: every statement and every expression, in the order of the text.
//!
//! A [`Visitor`] overrides what it is interested in and calls the `walk_` function of the same name to go on inside.

use super::*;

/// Sees the nodes of a tree.
pub trait Visitor<'a> {
    /// A declaration.
    fn item(&mut self, item: &'a Item) {
        walk_item(self, item);
    }
    /// A statement of a task or a sequence.
    fn task_statement(&mut self, statement: &'a TaskStatement) {
        walk_task_statement(self, statement);
    }
    /// A line of an observation or of metrics.
    fn channel(&mut self, channel: &'a Channel) {
        self.expression(&channel.value);
        channel.settings.iter().for_each(|setting| self.expression(&setting.value));
    }
    /// A reward term.
    fn term(&mut self, term: &'a Term) {
        let schedule = term.weight.iter().flat_map(|weight| &weight.schedule);
        schedule.flat_map(|schedule| schedule.begin.iter().chain([&schedule.end])).for_each(|share| self.expression(share));
        term.formula.iter().for_each(|formula| self.expression(formula));
    }
    /// A reason of an end.
    fn reason(&mut self, reason: &'a Reason) {
        self.expression(&reason.condition);
    }
    /// A parameter of a task.
    fn task_parameter(&mut self, parameter: &'a TaskParameter) {
        self.expression(&parameter.value);
        parameter.range.iter().for_each(|range| self.expression(range));
    }
    /// A statement of a scene.
    fn scene_statement(&mut self, statement: &'a SceneStatement) {
        walk_scene_statement(self, statement);
    }
    /// A statement of `init`.
    fn init_statement(&mut self, statement: &'a InitStatement) {
        walk_init_statement(self, statement);
    }
    /// A statement of a test.
    fn test_statement(&mut self, statement: &'a TestStatement) {
        walk_test_statement(self, statement);
    }
    /// A statement of a body.
    fn body_statement(&mut self, statement: &'a BodyStatement) {
        walk_body_statement(self, statement);
    }
    /// An element with its fields and parts.
    fn element(&mut self, element: &'a Element) {
        walk_element(self, element);
    }
    /// A field of an element or a placement.
    fn field(&mut self, field: &'a Field) {
        walk_field(self, field);
    }
    /// An assignment in a pose.
    fn assignment(&mut self, assignment: &'a Assignment) {
        self.expression(&assignment.target);
        self.expression(&assignment.value);
    }
    /// An expression.
    fn expression(&mut self, expression: &'a Expr) {
        walk_expression(self, expression);
    }
}

/// Goes through all declarations of a file.
pub fn walk_file<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, file: &'a File) {
    file.items.iter().for_each(|item| visitor.item(item));
}

/// Goes on inside a declaration.
pub fn walk_item<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, item: &'a Item) {
    match item {
        Item::Use(_) => {}
        Item::Task(task) => task.statements.iter().for_each(|statement| visitor.task_statement(statement)),
        Item::Sequence(sequence) => sequence.statements.iter().for_each(|statement| visitor.task_statement(statement)),
        Item::Suite(suite) => suite.protocols.iter().for_each(|protocol| visitor.element(&protocol.settings)),
        Item::Body(body) => body.statements.iter().for_each(|statement| visitor.body_statement(statement)),
        Item::Observation(observation) => items(&observation.channels).for_each(|channel| visitor.channel(channel)),
        Item::Const(binding) => visitor.expression(&binding.value),
        Item::Function(function) => visitor.expression(&function.body),
    }
}

/// The lines of a list that are neither `remove` nor `allow`.
pub fn items<T>(entries: &[Entry<T>]) -> impl Iterator<Item = &T> {
    entries.iter().filter_map(|entry| if let Entry::Item(item) = entry { Some(item) } else { None })
}

/// Goes on inside a statement of a task.
pub fn walk_task_statement<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, statement: &'a TaskStatement) {
    use TaskStatement as S;
    match statement {
        S::Family(_) | S::Symmetric(_) | S::Allow(_) => {}
        S::Body(body) => body.edits.iter().for_each(|edit| {
            visitor.expression(&edit.target);
            visitor.expression(&edit.value);
        }),
        S::Control(value) | S::Horizon(value) | S::Success(value) => visitor.expression(value),
        S::Params(block) => items(&block.entries).for_each(|parameter| visitor.task_parameter(parameter)),
        S::Scene(block) => block.entries.iter().for_each(|statement| visitor.scene_statement(statement)),
        S::Init(block) => block.entries.iter().for_each(|statement| visitor.init_statement(statement)),
        S::Observe(block) | S::Critic(block) | S::Metrics(block) => {
            items(&block.entries).for_each(|channel| visitor.channel(channel))
        }
        S::Reward(reward) => items(&reward.terms).for_each(|term| visitor.term(term)),
        S::Terminate(ends) | S::Finish(ends) => {
            ends.after.iter().for_each(|after| visitor.expression(after));
            items(&ends.reasons).for_each(|reason| visitor.reason(reason));
        }
        S::Let(binding) => visitor.expression(&binding.value),
        S::State(state) => {
            visitor.expression(&state.initial);
            for update in &state.updates {
                visitor.expression(&update.value);
                update.condition.iter().for_each(|condition| visitor.expression(condition));
            }
        }
        S::Clock(clock) => visitor.expression(&clock.frequency),
        S::Random(random) => {
            visitor.expression(&random.distribution);
            random.accept.iter().chain(&random.redraw).for_each(|condition| visitor.expression(condition));
        }
        S::Reference(reference) => reference.start.iter().for_each(|start| visitor.expression(start)),
        S::Act(act) => act.fields.iter().for_each(|field| visitor.field(field)),
        S::Disturb(element) => visitor.element(element),
        S::Phase(phase) => phase.until.iter().for_each(|until| visitor.expression(until)),
        S::Test(test) => test.statements.iter().for_each(|statement| visitor.test_statement(statement)),
    }
}

/// Goes on inside a statement of a scene.
pub fn walk_scene_statement<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, statement: &'a SceneStatement) {
    match statement {
        SceneStatement::Element(element) => visitor.element(element),
        SceneStatement::Connection(connection) => {
            visitor.expression(&connection.from);
            visitor.expression(&connection.to);
            connection.release.iter().for_each(|release| visitor.expression(release));
        }
        SceneStatement::Group(group) => visitor.expression(&group.members),
        SceneStatement::Marker(marker) => visitor.expression(&marker.at),
        SceneStatement::Repeat(repeat) => {
            visitor.expression(&repeat.range);
            repeat.statements.iter().for_each(|statement| visitor.scene_statement(statement));
        }
        SceneStatement::Remove(_) | SceneStatement::Allow(_) => {}
    }
}

/// Goes on inside a statement of `init`.
pub fn walk_init_statement<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, statement: &'a InitStatement) {
    match statement {
        InitStatement::Pose(pose) => pose.adjustments.iter().for_each(|adjustment| visitor.assignment(adjustment)),
        InitStatement::Object(placement) => placement.fields.iter().for_each(|field| visitor.field(field)),
        InitStatement::Noise(noise) => {
            visitor.expression(&noise.target);
            visitor.expression(&noise.distribution);
        }
        InitStatement::Scaling(scaling) => {
            visitor.expression(&scaling.target);
            visitor.expression(&scaling.factor);
        }
        InitStatement::Settle(settle) => {
            visitor.expression(&settle.duration);
            settle.activation.iter().for_each(|activation| visitor.expression(activation));
        }
        InitStatement::Remove(_) | InitStatement::Allow(_) => {}
    }
}

/// Goes on inside a statement of a test.
pub fn walk_test_statement<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, statement: &'a TestStatement) {
    match statement {
        TestStatement::Pose(situation) => walk_situation(visitor, situation),
        TestStatement::Keyframe { time, situation, .. } => {
            visitor.expression(time);
            walk_situation(visitor, situation);
        }
        TestStatement::Object(placement) => placement.fields.iter().for_each(|field| visitor.field(field)),
        TestStatement::Repeat { range, statements, .. } => {
            visitor.expression(range);
            statements.iter().for_each(|statement| visitor.test_statement(statement));
        }
        TestStatement::Moment { statements, .. } => statements.iter().for_each(|statement| visitor.test_statement(statement)),
        TestStatement::Play(playing) => {
            let times = [&playing.time, &playing.start, &playing.duration];
            times.into_iter().flatten().for_each(|time| visitor.expression(time));
            walk_situation(visitor, &playing.situation);
        }
        TestStatement::Given { value, .. } => visitor.expression(value),
        TestStatement::Until { time, .. } => visitor.expression(time),
        TestStatement::Run { duration, .. } => duration.iter().for_each(|duration| visitor.expression(duration)),
        TestStatement::Reset { times, .. } => times.iter().for_each(|times| visitor.expression(times)),
        TestStatement::Expect { condition, .. } => visitor.expression(condition),
    }
}

fn walk_situation<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, situation: &'a Situation) {
    for change in &situation.changes {
        match change {
            Change::Assign(assignment) => visitor.assignment(assignment),
            Change::Align(align) => walk_align(visitor, align),
        }
    }
}

/// Goes on inside a statement of a body.
pub fn walk_body_statement<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, statement: &'a BodyStatement) {
    match statement {
        BodyStatement::Model(_) | BodyStatement::Setting { .. } => {}
        BodyStatement::Element(element) => visitor.element(element),
        BodyStatement::Group(group) => visitor.expression(&group.members),
        BodyStatement::Pose(pose) => pose.joints.iter().for_each(|assignment| visitor.assignment(assignment)),
    }
}

/// Goes on inside an element. Fields and parts are kept apart in the tree, here they come as in the text.
pub fn walk_element<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, element: &'a Element) {
    element.on.iter().for_each(|on| visitor.expression(on));
    let mut parts = element.parts.iter().peekable();
    for field in &element.fields {
        while let Some(part) = parts.next_if(|part| part.span.start < field.span.start) {
            visitor.element(part);
        }
        visitor.field(field);
    }
    parts.for_each(|part| visitor.element(part));
}

/// Goes on inside a field.
pub fn walk_field<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, field: &'a Field) {
    match &field.value {
        FieldValue::Flag => {}
        FieldValue::Value(value) | FieldValue::On(value) => visitor.expression(value),
        FieldValue::Align(align) => walk_align(visitor, align),
        FieldValue::FromTo { from, to } => {
            visitor.expression(from);
            visitor.expression(to);
        }
    }
}

fn walk_align<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, align: &'a Align) {
    visitor.expression(&align.place);
    visitor.expression(&align.target);
    align.joints.iter().for_each(|joints| visitor.expression(joints));
}

/// Goes on inside an expression.
pub fn walk_expression<'a, V: Visitor<'a> + ?Sized>(visitor: &mut V, expression: &'a Expr) {
    use ExprKind as K;
    match &expression.kind {
        K::Number(_) | K::Bool(_) | K::Text(_) | K::Name(_) | K::Selector { .. } | K::EndedBy(_) | K::Error(_) => {}
        K::Field { base: inner, .. }
        | K::Paren(inner)
        | K::Unary { operand: inner, .. }
        | K::InFrame { value: inner, .. }
        | K::At { value: inner, .. } => visitor.expression(inner),
        K::Call { function, arguments } => {
            visitor.expression(function);
            arguments.iter().for_each(|argument| visitor.expression(&argument.value));
        }
        K::List(elements) => elements.iter().for_each(|element| visitor.expression(element)),
        K::Compare { operands, .. } => operands.iter().for_each(|operand| visitor.expression(operand)),
        K::Index { base: first, index: second }
        | K::Comprehension { element: first, source: second, .. }
        | K::Range { low: first, high: second }
        | K::Binary { left: first, right: second, .. }
        | K::When { value: first, condition: second } => {
            visitor.expression(first);
            visitor.expression(second);
        }
        K::If { branches, otherwise } => {
            for (condition, value) in branches {
                visitor.expression(condition);
                visitor.expression(value);
            }
            visitor.expression(otherwise);
        }
    }
}
