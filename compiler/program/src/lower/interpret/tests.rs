//! The program computes the same as the graph.

use super::{Interpreter, Moment};
use crate::frame::Sensor;
use crate::graph::fold::evaluate;
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::lower::{Outputs, View, assemble, layout};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// One node more: which operation, and which of the nodes so far it reads.
type Choice = (u8, prop::sample::Index, prop::sample::Index, prop::sample::Index);

fn grow(graph: &mut Graph, nodes: &mut Vec<NodeId>, (operation, a, b, c): Choice) {
    let [a, b, c] = [a, b, c].map(|index| *index.get(nodes));
    let widths = [a, b, c].map(|id| graph.width(id));
    let fits = |x: usize, y: usize| x == y || x == 1 || y == 1;
    let node = match operation % 26 {
        0 => graph.unary(Unary::HyperbolicTangent, a),
        1 => graph.unary(Unary::Absolute, a),
        2 if fits(widths[0], widths[1]) => graph.binary(Binary::Add, a, b),
        3 if fits(widths[0], widths[1]) => graph.binary(Binary::Multiply, a, b),
        4 if fits(widths[0], widths[1]) => graph.binary(Binary::Less, a, b),
        5 if fits(widths[0], widths[1]) => graph.binary(Binary::Maximum, a, b),
        6 if widths[0] == 1 && fits(widths[1], widths[2]) => graph.add(Operation::Choose, &[a, b, c]),
        7 => graph.select((0..widths[0]).rev(), a),
        8 => graph.select(widths[0] / 2..widths[0], a),
        9 if widths[0] + widths[1] <= 24 => graph.join(&[a, b]),
        10 => graph.reduce(Reduction::Sum, widths[0], a),
        11 => graph.reduce(Reduction::Norm, widths[0], a),
        12 => graph.memory(Memory::Delay(3), &[a]),
        13 => graph.memory(Memory::Accumulate, &[a]),
        14 if fits(widths[0], widths[1]) => graph.memory(Memory::Sampled, &[a, b]),
        15 => graph.memory(Memory::Highest, &[a]),
        16 if fits(widths[0], widths[1]) => graph.binary(Binary::Subtract, a, b),
        17 if fits(widths[0], widths[1]) => graph.binary(Binary::Minimum, a, b),
        // Sums over pairs, groups of vectors, and what chance of the choices would seldom put together.
        18 if fits(widths[0], widths[1]) => {
            let products = graph.binary(Binary::Multiply, a, b);
            graph.reduce(Reduction::Sum, graph.width(products), products)
        }
        19 if fits(widths[0], widths[1]) => {
            let apart = graph.binary(Binary::Subtract, a, b);
            let group = if graph.width(apart).is_multiple_of(3) { 3 } else { 1 };
            graph.reduce(Reduction::Norm, group, apart)
        }
        20 => {
            let (low, high) = (graph.constant(-0.25), graph.constant(0.5));
            let above = graph.binary(Binary::Maximum, a, low);
            graph.binary(Binary::Minimum, above, high)
        }
        21 if widths[0] >= 3 => {
            let axes = graph.select((0..9).map(|lane| lane % widths[0]), a);
            graph.add(Operation::Quaternion, &[axes])
        }
        22 if widths[0] % 2 == 0 && widths[1] == 1 => graph.add(Operation::Pick(widths[0] as u32 / 2), &[a, b]),
        23 if widths[0] <= 8 => graph.join(&[a, a, a]),
        24 if fits(widths[0], widths[1]) => graph.memory(Memory::SmoothAngle, &[a, b]),
        25 if fits(widths[0], widths[1]) => graph.memory(Memory::Hysteresis, &[a, b, b]),
        _ => graph.unary(Unary::Negate, a),
    };
    nodes.push(node);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_program_computes_what_the_graph_says(
        choices in prop::collection::vec(any::<Choice>(), 1..40),
        roots in prop::collection::vec(any::<prop::sample::Index>(), 1..6),
        numbers in prop::collection::vec(-2.0_f64..2.0, 64),
    ) {
        let mut graph = Graph::default();
        let sensors = vec![Sensor::ComVelocity, Sensor::JointPosition(3), Sensor::JointPosition(1), Sensor::JointPosition(2)];
        let first = graph.constant(0.5);
        let mut nodes = vec![graph.sensors(sensors), graph.sensors(vec![Sensor::Time]), graph.add(Operation::Step, &[])];
        nodes.push(graph.add(Operation::StateBefore(0), &[first]));
        nodes.push(graph.add(Operation::StateAfter(0), &[first]));
        choices.into_iter().for_each(|choice| grow(&mut graph, &mut nodes, choice));
        // The new value of a state reads nothing that comes after its update.
        let scalar = graph.reduce(Reduction::Norm, 3, nodes[0]);
        let update = graph.select([0], scalar);
        let channels = roots.iter().map(|root| *root.get(&nodes)).collect();
        let outputs = Outputs { channels, updates: vec![update], ..Outputs::default() };
        let layout = layout(std::iter::once((&graph, &outputs)), &[]);
        let program = assemble(&graph, &outputs, &layout);

        let mut plain = Interpreter { graph: &graph, memories: BTreeMap::new(), states: vec![vec![0.5]] };
        let mut record = Vec::new();
        for step in 0..6_u32 {
            let frame: Vec<f64> = (0..layout.size()).map(|lane| numbers[(lane + 7 * step as usize) % numbers.len()]).collect();
            if step == 0 {
                program.prepare(&[], &mut record);
                program.reset(&frame, &mut record, &|_| false, &mut |_, _| 0.5).unwrap();
            } else {
                program.step(step, &frame, &mut record, &mut |_, _| 0.5).unwrap();
            }
            let before = plain.states.clone();
            let mut moment = Moment { step, layout: &layout, frame: &frame, values: BTreeMap::new(), before };
            let updated = plain.value(update, &mut moment);
            if step > 0 {
                plain.states = vec![updated];
            }
            for (&node, plan) in outputs.channels.iter().zip(&program.channels) {
                let expected: Vec<u64> = plain.value(node, &mut moment).into_iter().map(f64::to_bits).collect();
                let mut found = vec![0.0; plan.width()];
                plan.write(&View { frame: &frame, record: &record }, &mut found);
                let found: Vec<u64> = found.into_iter().map(f64::to_bits).collect();
                prop_assert_eq!(found, expected, "step {}, node {:?}", step, node);
            }
        }
    }
}

/// Numbers at which rewrites go wrong: zeros, infinities, no number, what a square loses.
const CRITICAL: [f64; 18] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    -2.0,
    3.0,
    0.1,
    1e-200,
    -1e-200,
    1e200,
    5e-324,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    f64::MAX,
];

/// A number and whether it is known while compiling.
type Given = (f64, bool);

fn given() -> impl Strategy<Value = Given> {
    (prop_oneof![prop::sample::select(CRITICAL.to_vec()), -4.0_f64..4.0, any::<f64>()], any::<bool>())
}

/// What the program gives for an operation on lists of numbers, each read from a sensor or known while compiling.
fn computed(operation: &Operation, inputs: &[&[Given]]) -> Vec<f64> {
    let mut graph = Graph::default();
    let mut values = Vec::new();
    let mut lane = |graph: &mut Graph, (value, known): Given| {
        if known {
            return graph.constant(value);
        }
        values.push(value);
        graph.sensors(vec![Sensor::JointPosition(values.len() - 1)])
    };
    let lists: Vec<NodeId> = inputs
        .iter()
        .map(|list| {
            let lanes: Vec<NodeId> = list.iter().map(|given| lane(&mut graph, *given)).collect();
            graph.join(&lanes)
        })
        .collect();
    let node = graph.add(operation.clone(), &lists);
    let outputs = Outputs { channels: vec![node], ..Outputs::default() };
    let layout = layout(std::iter::once((&graph, &outputs)), &[]);
    let program = assemble(&graph, &outputs, &layout);
    let mut frame = vec![0.0; layout.size()];
    for (sensor, offset) in layout.entries() {
        if let Sensor::JointPosition(index) = sensor {
            frame[*offset] = values[*index];
        }
    }
    let mut record = Vec::new();
    program.prepare(&[], &mut record);
    program.reset(&frame, &mut record, &|_| false, &mut |_, _| 0.5).unwrap();
    let mut found = vec![0.0; program.channels[0].width()];
    program.channels[0].write(&View { frame: &frame, record: &record }, &mut found);
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn folding_is_never_noticed(a in prop::collection::vec(given(), 20), b in prop::collection::vec(given(), 20), width in 1_usize..20) {
        let agree = |operation: Operation, inputs: &[&[Given]], width: usize| {
            let values: Vec<Vec<f64>> = inputs.iter().map(|list| list.iter().map(|given| given.0).collect()).collect();
            let mut expected = vec![0.0; width];
            evaluate(&operation, &values.iter().map(Vec::as_slice).collect::<Vec<_>>(), &mut expected);
            let found = computed(&operation, inputs);
            let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
            prop_assert!(
                found.len() == expected.len() && found.iter().zip(&expected).all(same),
                "{operation:?} of {inputs:?}: {found:?}, not {expected:?}"
            );
            Ok(())
        };
        let (a, b) = (&a[..], &b[..]);
        for &function in Unary::ALL {
            agree(Operation::Unary(function), &[&a[..width]], width)?;
        }
        for &function in Binary::ALL {
            agree(Operation::Binary(function), &[&a[..width], &b[..width]], width)?;
            agree(Operation::Binary(function), &[&a[..width], &b[..1]], width)?;
            agree(Operation::Binary(function), &[&a[..1], &b[..width]], width)?;
            // Of the exponents and factors that are rewritten every one meets every base.
            for factor in [1.0, -1.0, 2.0, 0.5, 0.0, -0.0] {
                agree(Operation::Binary(function), &[&a[..width], &[(factor, true)]], width)?;
                agree(Operation::Binary(function), &[&[(factor, true)], &a[..width]], width)?;
            }
        }
        for &reduction in Reduction::ALL {
            agree(Operation::Reduce(reduction, width as u32), &[&a[..width]], 1)?;
            agree(Operation::Reduce(reduction, 1), &[&a[..width]], width)?;
        }
        agree(Operation::Choose, &[&b[..1], &a[..width], &b[..width]], width)?;
        agree(Operation::Select((0..width as u32).rev().collect()), &[&a[..width]], width)?;
        agree(Operation::Join, &[&a[..width], &b[..width]], 2 * width)?;
        agree(Operation::Quaternion, &[&a[..9]], 4)?;
    }
}
