//! A node of the graph as an expression of Python, with no more brackets than needed.

use crate::readers::{Method, operator};
use crate::sensors::Measured;
use crate::text::{identifier, number, quoted};
use msk_program::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use msk_program::graph::{Graph, Node, NodeId};
use msk_program::task::{CompiledTask, Phase};
use std::collections::BTreeMap;

/// How tightly the outermost operation of an expression binds, as in Python.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binds {
    Comparison,
    Sum,
    Product,
    Sign,
    Power,
    Atom,
}

/// An expression.
struct Text {
    text: String,
    binds: Binds,
    /// Whether it is a condition of Python, `True` or `False`, and no number.
    condition: bool,
}

impl Text {
    fn atom(text: String) -> Self {
        Self { text, binds: Binds::Atom, condition: false }
    }

    /// In brackets unless it binds at least as tightly.
    fn within(self, binds: Binds) -> String {
        if self.binds >= binds { self.text } else { format!("({})", self.text) }
    }

    /// As a number: conditions are 0 or 1.
    fn number(self) -> Self {
        if self.condition { Self::atom(format!("number({})", self.text)) } else { self }
    }

    fn is_condition(&self) -> bool {
        self.condition
    }
}

/// Writes expressions of one phase.
pub(crate) struct Expressions<'a> {
    pub task: &'a CompiledTask,
    pub phase: &'a Phase,
    pub methods: &'a BTreeMap<NodeId, Method>,
    pub tried: &'a [bool],
    pub measured: Measured<'a>,
    /// What cannot be expressed.
    pub reasons: Vec<String>,
}

impl Expressions<'_> {
    fn graph(&self) -> &Graph {
        &self.phase.graph
    }

    /// The value of a node where it is read, as a number.
    pub fn value(&mut self, id: NodeId) -> String {
        self.read(id).number().text
    }

    /// The value of a node where it is read, as a condition.
    pub fn condition(&mut self, id: NodeId) -> String {
        let text = self.read(id);
        if text.is_condition() { text.text } else { format!("{} != 0.0", text.within(Binds::Sum)) }
    }

    /// How a node itself is computed: the body of its method.
    pub fn definition(&mut self, id: NodeId) -> String {
        self.computed(id).text
    }

    /// What the method of a term or of an end returns: what it computes, or what another method does.
    pub fn output(&mut self, id: NodeId, read: fn(&mut Self, NodeId) -> String) -> String {
        if self.methods.get(&id).is_some_and(|method| method.output) { self.definition(id) } else { read(self, id) }
    }

    fn read(&mut self, id: NodeId) -> Text {
        match self.methods.get(&id) {
            Some(method) => {
                let condition = is_condition(self.graph(), id);
                Text { text: format!("self.{}()", method.name), binds: Binds::Atom, condition }
            }
            None => self.computed(id),
        }
    }

    fn computed(&mut self, id: NodeId) -> Text {
        let node = self.graph().node(id).clone();
        let scalar = node.width == 1;
        match &node.operation {
            Operation::Constant(lanes) => match lanes.as_slice() {
                [only] => literal(only.value()),
                several => {
                    let lanes: Vec<String> = several.iter().map(|lane| number(lane.value())).collect();
                    Text::atom(format!("np.array([{}])", lanes.join(", ")))
                }
            },
            Operation::Sensors(sensors) => Text::atom(self.measured.list(sensors, &mut self.reasons)),
            Operation::Step => Text::atom("self.memory.step".to_owned()),
            Operation::Unary(function) => self.unary(*function, node.inputs[0]),
            Operation::Binary(function) => self.binary(*function, node.inputs[0], node.inputs[1]),
            Operation::Choose => {
                let [condition, yes, no] = [node.inputs[0], node.inputs[1], node.inputs[2]];
                let parts = [self.condition(condition), self.value(yes), self.value(no)];
                Text::atom(format!("choose({})", parts.join(", ")))
            }
            Operation::Select(lanes) => self.select(lanes, node.inputs[0]),
            Operation::Join => Text::atom(format!("join({})", self.values(&node.inputs))),
            Operation::Reduce(reduction, group) => self.reduce(*reduction, *group as usize, &node),
            Operation::Quaternion => Text::atom(format!("quaternion({})", self.values(&node.inputs))),
            Operation::Memory(memory) => self.memory(id, *memory, &node),
            Operation::StateBefore(index) => Text::atom(format!("self.state_{}()", identifier(&self.state(*index)))),
            Operation::StateAfter(index) => Text::atom(format!("self.states[{}]", quoted(&self.state(*index)))),
            Operation::Noise(..) => Text::atom(if scalar { "noise[0]" } else { "noise" }.to_owned()),
            Operation::Drawn(index) => Text::atom(format!("self.random({})", quoted(&self.random(*index)))),
            Operation::DrawnAfter(index) => Text::atom(format!("self.randoms[{}]", quoted(&self.random(*index)))),
            Operation::Pick(lanes) => {
                let (list, place) = (self.read(node.inputs[0]).number().within(Binds::Atom), self.value(node.inputs[1]));
                Text::atom(match lanes {
                    1 => format!("{list}[int({place})]"),
                    lanes => format!("{list}.reshape(-1, {lanes})[int({place})]"),
                })
            }
            Operation::PhaseSuccess(_) => {
                self.reasons.push("it reads whether an earlier phase has succeeded".to_owned());
                literal(0.0)
            }
            Operation::Follow(track) => {
                let columns = &track.motion.columns;
                let names = track.columns.iter().filter_map(|&column| columns.get(column));
                let names: Vec<String> = names.map(|column| quoted(&column.target.name())).collect();
                let motion = self.task.motions.iter().find(|known| known.motion.digest() == track.motion.digest());
                let motion = quoted(motion.map_or("", |known| &known.name));
                let (what, time) = (if track.rates { "rates" } else { "values" }, self.value(node.inputs[0]));
                let place = if scalar { "[0]" } else { "" };
                Text::atom(format!("self.motions[{motion}].{what}({time}, {}){place}", names.join(", ")))
            }
        }
    }

    fn values(&mut self, inputs: &[NodeId]) -> String {
        inputs.iter().map(|&input| self.value(input)).collect::<Vec<_>>().join(", ")
    }

    /// Name of a declared state, by its number.
    pub fn state(&self, index: u32) -> String {
        self.phase.debug.states.get(index as usize).cloned().unwrap_or_else(|| index.to_string())
    }

    /// Name of a random of the phase, by its number.
    pub fn random(&self, index: u32) -> String {
        let stream = self.phase.streams.get(index as usize).and_then(|&stream| self.task.randoms.get(stream));
        stream.map_or_else(|| index.to_string(), |random| random.name.clone())
    }

    fn unary(&mut self, function: Unary, input: NodeId) -> Text {
        if function == Unary::Not {
            let condition = self.condition(input);
            return Text { text: format!("np.logical_not({condition})"), binds: Binds::Atom, condition: true };
        }
        if function == Unary::Negate {
            let operand = self.read(input).number().within(Binds::Power);
            return Text { text: format!("-{operand}"), binds: Binds::Sign, condition: false };
        }
        let operand = self.value(input);
        Text::atom(match function {
            Unary::ArcSine => format!("np.arcsin(np.clip({operand}, -1.0, 1.0))"),
            Unary::ArcCosine => format!("np.arccos(np.clip({operand}, -1.0, 1.0))"),
            Unary::Absolute => format!("np.abs({operand})"),
            Unary::SquareRoot => format!("np.sqrt({operand})"),
            Unary::Exponential => format!("np.exp({operand})"),
            Unary::Logarithm => format!("np.log({operand})"),
            Unary::HyperbolicTangent => format!("np.tanh({operand})"),
            Unary::Sine => format!("np.sin({operand})"),
            Unary::Cosine => format!("np.cos({operand})"),
            Unary::Tangent => format!("np.tan({operand})"),
            Unary::Floor => format!("np.floor({operand})"),
            Unary::Sign => format!("np.sign({operand})"),
            Unary::Wrap | Unary::Negate | Unary::Not => format!("wrap({operand})"),
        })
    }

    fn binary(&mut self, function: Binary, left: NodeId, right: NodeId) -> Text {
        use Binary as B;
        if let B::And | B::Or = function {
            let (one, other) = (self.condition(left), self.condition(right));
            let word = if function == B::And { "and" } else { "or" };
            return Text { text: format!("np.logical_{word}({one}, {other})"), binds: Binds::Atom, condition: true };
        }
        let (one, other) = (self.read(left).number(), self.read(right).number());
        let infix = |word: &str, binds: Binds, first: Binds, second: Binds, condition: bool| {
            (word.to_owned(), binds, first, second, condition)
        };
        let (word, binds, first, second, condition) = match function {
            B::Add => infix("+", Binds::Sum, Binds::Sum, Binds::Sum, false),
            B::Subtract => infix("-", Binds::Sum, Binds::Sum, Binds::Product, false),
            // The graph says in which order factors are multiplied.
            B::Multiply => infix("*", Binds::Product, Binds::Product, Binds::Sign, false),
            B::Divide => infix("/", Binds::Product, Binds::Product, Binds::Sign, false),
            B::Power => infix("**", Binds::Power, Binds::Atom, Binds::Sign, false),
            B::Less => infix("<", Binds::Comparison, Binds::Sum, Binds::Sum, true),
            B::LessEqual => infix("<=", Binds::Comparison, Binds::Sum, Binds::Sum, true),
            B::Equal => infix("==", Binds::Comparison, Binds::Sum, Binds::Sum, true),
            B::Minimum | B::Maximum | B::ArcTangent2 | B::Hypotenuse | B::Modulo | B::And | B::Or => {
                let name = match function {
                    B::Minimum => "minimum",
                    B::Maximum => "maximum",
                    B::ArcTangent2 => "arctan2",
                    B::Hypotenuse => "hypot",
                    _ => "mod",
                };
                return Text::atom(format!("np.{name}({}, {})", one.text, other.text));
            }
        };
        Text { text: format!("{} {word} {}", one.within(first), other.within(second)), binds, condition }
    }

    fn select(&mut self, lanes: &[u32], input: NodeId) -> Text {
        if let Some(text) = self.measured.component(self.phase, lanes, input, self.methods) {
            return Text::atom(text);
        }
        let width = self.graph().width(input);
        let list = self.read(input).number().within(Binds::Atom);
        Text::atom(match lanes {
            _ if width == 1 => format!("np.full({}, {list})", lanes.len()),
            [only] => format!("{list}[{only}]"),
            [first, .., last] if lanes.windows(2).all(|pair| pair[1] == pair[0].wrapping_add(1)) => {
                format!("{list}[{first}:{}]", u64::from(*last) + 1)
            }
            several => format!("{list}[{several:?}]"),
        })
    }

    fn reduce(&mut self, reduction: Reduction, group: usize, node: &Node) -> Text {
        let input = node.inputs[0];
        let width = self.graph().width(input);
        let list = self.read(input).number();
        if width == 1 {
            return match reduction {
                Reduction::Norm => Text::atom(format!("np.abs({})", list.text)),
                Reduction::ArgMinimum | Reduction::ArgMaximum => literal(0.0),
                _ => list,
            };
        }
        let name = match reduction {
            Reduction::Sum => "np.sum",
            Reduction::Product => "np.prod",
            Reduction::Minimum => "np.min",
            Reduction::Maximum => "np.max",
            Reduction::Norm => "np.linalg.norm",
            Reduction::ArgMinimum => "np.argmin",
            Reduction::ArgMaximum => "np.argmax",
        };
        Text::atom(match node.width {
            1 => format!("{name}({})", list.text),
            _ => format!("{name}({}.reshape(-1, {group}), axis=1)", list.within(Binds::Atom)),
        })
    }

    fn memory(&mut self, id: NodeId, memory: Memory, node: &Node) -> Text {
        if self.tried[id.index()] {
            self.reasons.push("an operator with memory reads what is tried when a random is drawn".to_owned());
        }
        let key = self.methods.get(&id).map_or("", |method| &method.name);
        let mut parts = vec![quoted(key), self.values(&node.inputs)];
        if let Memory::Delay(steps) = memory {
            parts.push(steps.to_string());
        }
        Text::atom(format!("self.memory.{}({})", operator(memory), parts.join(", ")))
    }
}

/// A number as it stands: one below zero binds as its sign does.
fn literal(value: f64) -> Text {
    let binds = if value < 0.0 { Binds::Sign } else { Binds::Atom };
    Text { text: number(value), binds, condition: false }
}

/// Whether the value of a node is a condition of Python.
pub(crate) fn is_condition(graph: &Graph, id: NodeId) -> bool {
    use Binary as B;
    matches!(
        graph.node(id).operation,
        Operation::Binary(B::Less | B::LessEqual | B::Equal | B::And | B::Or) | Operation::Unary(Unary::Not)
    )
}
