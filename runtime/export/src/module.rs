//! A module: names of the body, and a class with one method for every value, term, condition and channel.

use crate::anatomy::anatomy;
use crate::expression::{Expressions, is_condition};
use crate::readers::{self, Method};
use crate::sensors::Measured;
use crate::text::{documented, identifier, laid_out, number, quoted, tuple};
use msk_physics::model::Model;
use msk_program::graph::NodeId;
use msk_program::graph::operation::{Chance, Operation};
use msk_program::task::{CompiledTask, Phase};
use msk_runtime::body::Body;
use serde_json::{Map, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A column behind which nothing fits on the line.
const LONG: usize = 1000;

/// What methods may need of the support module.
const SUPPORT: &[&str] = &[
    "channel",
    "choose",
    "draw",
    "finish",
    "join",
    "metric",
    "number",
    "once",
    "quaternion",
    "redraw",
    "release",
    "state",
    "success",
    "term",
    "termination",
    "update",
    "wrap",
];

/// The text of a module while it is written.
pub(crate) struct Module<'a> {
    task: &'a CompiledTask,
    phase: &'a Phase,
    body: &'a Body,
    model: &'a Model,
    reasons: &'a mut Vec<String>,
}

/// The methods of a class while they are written.
struct Class<'a> {
    expressions: Expressions<'a>,
    text: String,
    names: BTreeSet<String>,
}

impl<'a> Module<'a> {
    pub fn new(task: &'a CompiledTask, phase: &'a Phase, body: &'a Body, model: &'a Model, reasons: &'a mut Vec<String>) -> Self {
        Self { task, phase, body, model, reasons }
    }

    /// The whole module.
    pub fn written(self) -> String {
        let Self { task, phase, body, model, reasons } = self;
        let (methods, tried) = (readers::methods(task, phase), readers::tried(&phase.graph));
        let measured = Measured::new(task, body, model);
        let expressions = Expressions { task, phase, methods: &methods, tried: &tried, measured, reasons: Vec::new() };
        let mut class = Class { expressions, text: String::new(), names: BTreeSet::new() };
        class.values(&methods);
        class.states();
        class.randoms();
        class.terms();
        class.ends();
        class.shown();
        reasons.append(&mut class.expressions.reasons);
        let Class { expressions, text, .. } = class;
        header(task, &expressions.measured, &text) + &text
    }
}

/// What stands before the methods.
fn header(task: &CompiledTask, measured: &Measured<'_>, methods: &str) -> String {
    let hash: String = task.hash.chars().take(16).collect();
    let mut text = format!(
        "\"\"\"{}\n\nThe task `{}` over MuJoCo's own model and data, written by `msk export --target python`; content hash {hash}.\n\n\
         task = {}()\n\
         step = task.reset(data)  # after mj_forward of an initial state\n\
         step = task.step(data, action)  # after the physics steps of a control step, and mj_forward\n\"\"\"\n\n",
        documented(&task.summary),
        task.name,
        class_name(&task.name)
    );
    text += "from pathlib import Path\n\nimport numpy as np\n";
    let used = |word: &&&str| methods.contains(&format!("{word}(")) || methods.contains(&format!("@{word}\n"));
    let words = ["Anatomy", "Landmark", "Task"].iter().chain(SUPPORT.iter().filter(used));
    let words: Vec<String> = words.map(|word| (*word).to_owned()).collect();
    let _ = write!(text, "from msk_mujoco import {}\n\n", tuple(&words, LONG, 0));
    for (name, list) in &measured.lists {
        let names: Vec<String> = list.iter().map(|name| quoted(name)).collect();
        let _ = writeln!(text, "{name} = {}", tuple(&names, name.len() + 3, 0));
    }
    let _ = write!(text, "\n\nclass {}(Task):\n    \"\"\"{}\"\"\"\n\n", class_name(&task.name), documented(&task.summary));
    let _ = writeln!(text, "    file = Path(__file__)\n    control_frequency = {}  # Hz", number(task.control_frequency));
    let _ = writeln!(text, "    horizon = {}  # control steps", task.horizon);
    let actions = task.action.size(task.vocabulary.muscles.len());
    let rest = number(task.action.rest());
    let _ = writeln!(text, "    actions = {actions}  # entries in -1..1\n    rest = {rest}  # the entry before the first step");
    let parameters: Vec<String> = task
        .parameters
        .iter()
        .filter(|parameter| parameter.per_episode)
        .map(|parameter| format!("{}: {}", quoted(&parameter.name), number(parameter.value)))
        .collect();
    if !parameters.is_empty() {
        let _ = writeln!(text, "    # Set for every episode, in SI units.\n    parameters = {{{}}}", parameters.join(", "));
    }
    text + &anatomy(measured)
}

/// `WalkTurn` for `walk_turn`.
fn class_name(task: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
    };
    identifier(task).split('_').map(capital).collect()
}

impl Class<'_> {
    fn heading(&mut self, text: &str) {
        let _ = write!(self.text, "\n    # {text}\n");
    }

    /// A method `PREFIX_NAME` that returns an expression.
    fn method(&mut self, decorator: &str, [prefix, name]: [&str; 2], arguments: &str, docs: &str, value: &str) {
        let wanted = format!("{prefix}_{}", identifier(name));
        let numbered = (2..).map(|number| format!("{wanted}_{number}"));
        let mut candidates = std::iter::once(wanted.clone()).chain(numbered);
        // There are always more numbers than names.
        let name = candidates.find(|name| !self.names.contains(name)).unwrap_or_default();
        let _ = write!(self.text, "\n    @{decorator}\n    def {name}(self{arguments}):\n");
        if !docs.is_empty() {
            let _ = writeln!(self.text, "        \"\"\"{}\"\"\"", documented(docs));
        }
        let _ = writeln!(self.text, "        return {}", laid_out(value, 15, 8));
        self.names.insert(name);
    }

    fn values(&mut self, methods: &BTreeMap<NodeId, Method>) {
        self.heading("Values that several others read, or that the task names");
        for (&id, method) in methods.iter().filter(|(_, method)| !method.output) {
            let value = self.expressions.definition(id);
            let unit = match (&method.unit, is_condition(&self.expressions.phase.graph, id)) {
                (_, true) | (None, _) => String::new(),
                (Some(unit), _) if unit.is_empty() => "  # dimensionless".to_owned(),
                (Some(unit), _) => format!("  # {unit}"),
            };
            let _ = write!(
                self.text,
                "\n    @once\n    def {}(self):{unit}\n        return {}\n",
                method.name,
                laid_out(&value, 15, 8)
            );
            self.names.insert(method.name.clone());
        }
    }

    fn states(&mut self) {
        let phase = self.expressions.phase;
        let initial: BTreeMap<u32, NodeId> = phase
            .graph
            .reachable(phase.outputs.roots())
            .into_iter()
            .filter_map(|id| match phase.graph.node(id).operation {
                Operation::StateBefore(index) | Operation::StateAfter(index) => Some((index, phase.graph.node(id).inputs[0])),
                _ => None,
            })
            .collect();
        if !initial.is_empty() {
            self.heading("States: their values at reset, and how they change at the end of a step");
        }
        for (index, first) in initial {
            let name = self.expressions.state(index);
            let value = self.expressions.value(first);
            self.method(&format!("state({})", quoted(&name)), ["state", &name], "", "", &value);
            if let Some(&node) = phase.outputs.updates.get(index as usize) {
                let value = self.expressions.value(node);
                self.method(&format!("update({})", quoted(&name)), ["update", &name], "", "", &value);
            }
        }
    }

    fn randoms(&mut self) {
        let (task, phase) = (self.expressions.task, self.expressions.phase);
        for (index, drawn) in phase.outputs.draws.iter().enumerate() {
            let Some(random) = phase.streams.get(index).and_then(|&stream| task.randoms.get(stream)) else { continue };
            // A caller sets it.
            if random.parameter.is_some() {
                continue;
            }
            if index == 0 {
                self.heading("Randoms: a candidate from the numbers of chance, and whether it is taken");
            }
            let name = &random.name;
            let inputs = &phase.graph.node(drawn.value).inputs;
            let noise =
                phase.graph.reachable(inputs.iter().copied()).into_iter().find_map(|id| match phase.graph.node(id).operation {
                    Operation::Noise(known, chance, lanes) if known as usize == index => Some((chance, lanes)),
                    _ => None,
                });
            let chance = match noise {
                Some((Chance::Uniform, lanes)) => format!(", uniform={lanes}"),
                Some((Chance::Normal, lanes)) => format!(", normal={lanes}"),
                None => String::new(),
            };
            let candidate = inputs.first().map_or_else(String::new, |&candidate| self.expressions.value(candidate));
            let taken = inputs.get(1).map_or_else(|| "True".to_owned(), |&accept| self.expressions.condition(accept));
            let clauses = [(&random.source, ""), (&random.accept, " where "), (&random.redraw, " redraw when ")];
            let docs: String =
                clauses.iter().filter(|(text, _)| !text.is_empty()).map(|(text, word)| format!("{word}{text}")).collect();
            let decorator = format!("draw({}{chance})", quoted(name));
            self.method(&decorator, ["draw", name], ", noise", &docs, &format!("({candidate}, {taken})"));
            if let Some(redraw) = drawn.redraw {
                let value = self.expressions.condition(redraw);
                self.method(&format!("redraw({})", quoted(name)), ["redraw", name], "", "", &value);
            }
        }
    }

    fn terms(&mut self) {
        let (task, phase) = (self.expressions.task, self.expressions.phase);
        self.heading("Terms of the reward, without their weights");
        for (term, &node) in task.terms.iter().zip(&phase.outputs.terms) {
            let value = self.expressions.output(node, Expressions::value);
            let decorator = format!("term({}, weight={})", quoted(&term.name), number(term.weight));
            self.method(&decorator, ["term", &term.name], "", &term.source, &value);
        }
    }

    fn ends(&mut self) {
        let (task, phase) = (self.expressions.task, self.expressions.phase);
        self.heading("Ends of the episode, and success");
        let kinds = [
            ("termination", &task.terminations, &phase.outputs.terminations, &phase.debug.terminations),
            ("finish", &task.finishes, &phase.outputs.finishes, &phase.debug.finishes),
        ];
        for (kind, names, nodes, debug) in kinds {
            for (index, (name, &node)) in names.iter().zip(nodes).enumerate() {
                let value = self.expressions.output(node, Expressions::condition);
                let docs = debug.get(index).map_or("", |debug| debug.source.as_str());
                self.method(&format!("{kind}({})", quoted(name)), [kind, name], "", docs, &value);
            }
        }
        for (&place, &node) in task.releases.iter().zip(&phase.outputs.releases) {
            let name = task.scene.connections.get(place).map_or_else(String::new, |held| format!("{} to {}", held.from, held.to));
            let value = self.expressions.condition(node);
            self.method(&format!("release({})", quoted(&name)), ["release", &name], "", "", &value);
        }
        if let Some(node) = phase.outputs.success {
            let value = self.expressions.condition(node);
            let docs = phase.debug.success.as_ref().map_or("", |debug| debug.source.as_str());
            self.method("success", ["is", "success"], "", docs, &value);
        }
    }

    fn shown(&mut self) {
        let (task, phase) = (self.expressions.task, self.expressions.phase);
        self.heading("Channels of the observation, and metrics");
        let observed = task.channels.iter().map(|channel| (channel, ""));
        let critic = task.critic.iter().map(|channel| (channel, ", critic=True"));
        for (place, (channel, kind)) in observed.chain(critic).enumerate() {
            let own = phase.channels.get(place).copied().flatten();
            let Some(&node) = own.and_then(|own| phase.outputs.channels.get(own)) else { continue };
            let value = self.expressions.value(node);
            let decorator = format!("channel({}, unit={}{kind})", quoted(&channel.name), quoted(&channel.unit));
            self.method(&decorator, ["observe", &channel.name], "", "", &value);
        }
        for (metric, &node) in task.metrics.iter().zip(&phase.outputs.metrics) {
            let value = self.expressions.value(node);
            let decorator = format!("metric({}, unit={})", quoted(&metric.name), quoted(&metric.unit));
            self.method(&decorator, ["metric", &metric.name], "", "", &value);
        }
    }
}

/// The motions of a task: rows, values and slopes, of which cubics follow.
pub(crate) fn motions(task: &CompiledTask) -> Option<String> {
    let mut all = Map::new();
    for followed in &task.motions {
        let motion = &followed.motion;
        let mut columns = Map::new();
        for (index, column) in motion.columns.iter().enumerate() {
            let last = motion.times.len().saturating_sub(1);
            // The last row of a cycle is the first of the next turn.
            let at =
                |row: usize, read: &dyn Fn(f64) -> f64| read(if row == last && motion.cycle { 0.0 } else { motion.times[row] });
            let values: Vec<f64> = (0..=last)
                .map(|row| {
                    let advance = if row == last { motion.advance(index) } else { 0.0 };
                    at(row, &|time| motion.value(index, time)) + advance
                })
                .collect();
            let slopes: Vec<f64> = (0..=last).map(|row| at(row, &|time| motion.rate(index, time))).collect();
            let column_of = json!({ "values": values, "slopes": slopes, "advance": motion.advance(index) });
            columns.insert(column.target.name().into_owned(), column_of);
        }
        let table = json!({ "times": motion.times, "duration": motion.duration, "cycle": motion.cycle, "columns": columns });
        all.insert(followed.name.clone(), table);
    }
    (!all.is_empty()).then(|| serde_json::Value::Object(all).to_string() + "\n")
}
