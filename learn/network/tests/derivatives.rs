//! Derivatives against finite differences, operation by operation, and their bits on any number of threads.

use super::{filled, number, numbers, perceptron, tape};
use msk_network::{Activation, Parameters, Shape, Tape, Variable};
use proptest::prelude::*;
use std::sync::Arc;

const ROWS: usize = 3;
const COLUMNS: usize = 4;

/// The derivative of a weighted sum of what `build` makes of two matrices, with respect to the first or the second, against a central
/// difference.
fn compare(name: &str, salt: usize, build: impl Fn(&mut Tape, Variable, Variable) -> Variable) {
    let mut tape = tape(1);
    let parameters = Parameters::default();
    let inputs = [numbers(ROWS * COLUMNS, salt, 3.0), numbers(ROWS * COLUMNS, salt + 1, 3.0)];
    let mut loss = |inputs: &[Vec<f32>; 2]| {
        tape.clear();
        let [a, b] = [0, 1].map(|side| tape.watched(ROWS, COLUMNS, inputs[side].iter().copied()));
        let y = build(&mut tape, a, b);
        let [rows, columns] = tape.size(y);
        let weights = tape.constant(rows, columns, numbers(rows * columns, salt + 2, 2.0));
        let weighted = tape.multiply(y, weights);
        let loss = tape.mean(weighted);
        tape.backward(loss, &parameters, &mut []);
        let slopes = [a, b].map(|side| tape.slopes(side).to_vec());
        (f64::from(tape.values(loss)[0]) * (rows * columns) as f64, slopes, (rows * columns) as f64)
    };
    let (_, slopes, count) = loss(&inputs);
    for side in 0..2 {
        for place in 0..ROWS * COLUMNS {
            let at = |step: f32, loss: &mut dyn FnMut(&[Vec<f32>; 2]) -> f64| {
                let mut moved = inputs.clone();
                moved[side][place] += step;
                loss(&moved)
            };
            let mut value = |inputs: &[Vec<f32>; 2]| loss(inputs).0;
            let step = 4e-3;
            let difference = (at(step, &mut value) - at(-step, &mut value)) / (2.0 * f64::from(step));
            let slope = f64::from(slopes[side][place]) * count;
            let tolerance = 2e-3 * (1.0 + difference.abs());
            assert!((slope - difference).abs() < tolerance, "{name}, {side}, {place}: {slope}, expected {difference}");
        }
    }
}

/// Numbers at which no operation has a kink within a step.
fn smooth(salt: usize) -> bool {
    let near = |index: usize, at: f64| [salt, salt + 1].iter().any(|salt| (3.0 * number(index, *salt) - at).abs() < 0.01);
    let equal = |index: usize| (number(index, salt) - number(index, salt + 1)).abs() < 0.01;
    (0..ROWS * COLUMNS).all(|index| ![0.0, -0.8, 0.7].iter().any(|at| near(index, *at)) && !equal(index))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn derivatives_are_limits_of_differences(salt in (0..9000_usize).prop_filter("kinks", |salt| smooth(*salt))) {
        for (name, activation) in Activation::NAMED {
            compare(name, salt, |tape, a, b| {
                let sum = tape.activate(a, activation);
                let other = tape.activate(b, activation);
                tape.add(sum, other)
            });
        }
        compare("add", salt, |tape, a, b| tape.add(a, b));
        compare("subtract", salt, |tape, a, b| tape.subtract(a, b));
        compare("multiply", salt, |tape, a, b| tape.multiply(a, b));
        compare("multiply by itself", salt, |tape, a, _| tape.multiply(a, a));
        compare("minimum", salt, |tape, a, b| tape.minimum(a, b));
        compare("affine", salt, |tape, a, _| tape.affine(a, -2.5, 1.0));
        compare("exp", salt, |tape, a, _| tape.exp(a));
        compare("softplus", salt, |tape, a, _| tape.softplus(a));
        compare("ln", salt, |tape, a, _| {
            let square = tape.square(a);
            let positive = tape.affine(square, 1.0, 0.5);
            tape.ln(positive)
        });
        compare("square", salt, |tape, a, _| tape.square(a));
        compare("clip", salt, |tape, a, _| tape.clip(a, -0.8, 0.7));
        compare("join", salt, |tape, a, b| tape.join(a, b));
        compare("columns", salt, |tape, a, _| tape.columns(a, 1..3));
        compare("gather", salt, |tape, a, _| tape.gather(a, &Arc::from([3, 0, 0, 1, 3])));
        compare("sum of columns", salt, |tape, a, b| {
            let product = tape.multiply(a, b);
            tape.sum_columns(product)
        });
        compare("mean", salt, |tape, a, b| {
            let product = tape.multiply(a, b);
            tape.mean(product)
        });
        compare("detached", salt, |tape, a, b| {
            let still = tape.constant(ROWS, COLUMNS, numbers(ROWS * COLUMNS, salt + 9, 1.0));
            let still = tape.detached(still);
            let product = tape.multiply(a, still);
            tape.add(product, b)
        });
    }
}

#[test]
fn derivatives_of_parameters_are_limits_of_differences() {
    for (hidden, layer_norm, residual) in [([7, 6], false, false), ([7, 6], true, false), ([4, 4], false, true)] {
        let mut parameters = Parameters::default();
        let activation = Activation::Tanh;
        let shape = Shape { inputs: 5, hidden: hidden.to_vec(), outputs: 3, activation, layer_norm, residual };
        let network = filled("policy", &shape, 4, &mut parameters);
        let mut tape = tape(1);
        let mut loss = |parameters: &Parameters, gradient: &mut [f32]| {
            tape.clear();
            let x = tape.watched(9, 5, numbers(45, 50, 4.0));
            let y = network.forward(&mut tape, parameters, x);
            let square = tape.square(y);
            let loss = tape.mean(square);
            tape.backward(loss, parameters, gradient);
            f64::from(tape.values(loss)[0])
        };
        let mut gradient = vec![0.0; parameters.len()];
        loss(&parameters, &mut gradient);
        let mut unused = vec![0.0; parameters.len()];
        for (place, slope) in gradient.iter().enumerate() {
            let mut at = |step: f32| {
                let mut moved = parameters.clone();
                moved.values_mut()[place] += step;
                loss(&moved, &mut unused)
            };
            let difference = (at(4e-3) - at(-4e-3)) / 8e-3;
            assert!((f64::from(*slope) - difference).abs() < 1e-3, "{place}: {slope}, expected {difference}");
        }
    }
}

#[test]
fn gradients_have_the_same_bits_on_any_number_of_threads() {
    let play = |threads: usize| -> Vec<u32> {
        let mut parameters = Parameters::default();
        let network = perceptron("policy", (40, &[130, 70], 11), (Activation::Silu, true), 4, &mut parameters);
        let mut tape = tape(threads);
        let x = tape.watched(300, 40, numbers(12_000, 50, 4.0));
        let y = network.forward(&mut tape, &parameters, x);
        let square = tape.square(y);
        let loss = tape.mean(square);
        let mut gradient = vec![0.0; parameters.len()];
        tape.backward(loss, &parameters, &mut gradient);
        gradient.iter().chain(tape.slopes(x)).map(|slope| slope.to_bits()).collect()
    };
    let one = play(1);
    assert!(one == play(2) && one == play(7));
}
