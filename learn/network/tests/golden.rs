//! Losses, gradients and parameters after five steps of Adam, against PyTorch in double precision.

use super::{numbers, perceptron, tape};
use msk_network::heads::{gaussian_entropy, gaussian_log_density, squashed_gaussian};
use msk_network::{Activation, Adam, Parameters, Tape, Variable, clip_norm};
use serde_json::Value;

fn golden(name: &str) -> Value {
    let all: Value = serde_json::from_str(include_str!("golden/torch.json")).unwrap();
    all[name].clone()
}

fn list(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// All numbers within a part of the largest.
fn agree(what: &str, found: &[f32], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(0.0_f64, |most, number| most.max(number.abs()));
    for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((f64::from(*found) - expected).abs() < 1e-5 * largest, "{what}, {place}: {found}, expected {expected}");
    }
}

/// The first `trained` parameters are those of the golden numbers.
fn train(
    name: &str,
    parameters: &mut Parameters,
    trained: usize,
    epsilon: f32,
    loss: impl Fn(&mut Tape, &Parameters) -> Variable,
) {
    let golden = golden(name);
    let (mut tape, mut adam) = (tape(2), Adam::new(trained).with_epsilon(epsilon));
    for (step, expected) in list(&golden["losses"]).into_iter().enumerate() {
        tape.clear();
        let value = loss(&mut tape, parameters);
        agree(&format!("{name}: loss {step}"), tape.values(value), &[expected]);
        let mut gradient = vec![0.0; parameters.len()];
        tape.backward(value, parameters, &mut gradient);
        assert!(gradient[trained..].iter().all(|slope| *slope == 0.0), "what is not trained has no derivative");
        if step == 0 {
            agree(&format!("{name}: gradient"), &gradient[..trained], &list(&golden["gradient"]));
        }
        let norm = clip_norm(&mut gradient[..trained], 0.5);
        if step == 0 {
            agree(&format!("{name}: norm"), &[norm], &[golden["norm"].as_f64().unwrap()]);
        }
        adam.step(1e-2, &mut parameters.values_mut()[..trained], &gradient[..trained]);
    }
    agree(&format!("{name}: parameters"), &parameters.values()[..trained], &list(&golden["parameters"]));
}

fn regression(name: &str, activation: Activation, layer_norm: bool) {
    let mut parameters = Parameters::default();
    let network = perceptron("policy", (5, &[7, 6], 3), (activation, layer_norm), 1, &mut parameters);
    let trained = parameters.len();
    train(name, &mut parameters, trained, 1e-8, |tape, parameters| {
        let (x, y) = (tape.constant(9, 5, numbers(45, 50, 4.0)), tape.constant(9, 3, numbers(27, 51, 4.0)));
        let found = network.forward(tape, parameters, x);
        let error = tape.subtract(found, y);
        let squares = tape.square(error);
        tape.mean(squares)
    });
}

#[test]
fn perceptrons_learn_as_in_pytorch() {
    for (name, activation) in Activation::NAMED {
        regression(name, activation, false);
    }
    regression("layer_norm", Activation::Silu, true);
}

#[test]
fn the_clipped_objective_of_ppo_is_that_of_pytorch() {
    let mut parameters = Parameters::default();
    let policy = perceptron("policy", (5, &[7], 3), (Activation::Tanh, false), 1, &mut parameters);
    let value = perceptron("value", (5, &[6], 1), (Activation::Tanh, false), 11, &mut parameters);
    let log_std = parameters.add("log_std", &[3]);
    parameters.values_mut()[log_std.clone()].copy_from_slice(&numbers(3, 21, 1.0));
    let trained = parameters.len();
    train("proximal", &mut parameters, trained, 1e-5, |tape, parameters| {
        let (x, actions) = (tape.constant(9, 5, numbers(45, 50, 4.0)), tape.constant(9, 3, numbers(27, 51, 4.0)));
        let column = |tape: &mut Tape, salt: usize, scale: f64, shift: f32| {
            tape.constant(9, 1, numbers(9, salt, scale).into_iter().map(|number| number + shift))
        };
        let (advantages, before) = (column(tape, 52, 4.0, 0.0), column(tape, 53, 1.0, -5.0));
        let (returns, old) = (column(tape, 54, 4.0, 0.0), column(tape, 55, 1.0, 0.0));
        let mean = policy.forward(tape, parameters, x);
        let log_std = tape.parameter(9, log_std.clone(), parameters);
        let density = gaussian_log_density(tape, mean, log_std, actions);
        let logarithm = tape.subtract(density, before);
        let ratio = tape.exp(logarithm);
        let plain = tape.multiply(ratio, advantages);
        let clipped = tape.clip(ratio, 0.8, 1.2);
        let clipped = tape.multiply(clipped, advantages);
        let surrogate = tape.minimum(plain, clipped);
        let surrogate = tape.mean(surrogate);
        let found = value.forward(tape, parameters, x);
        let change = tape.subtract(found, old);
        let change = tape.clip(change, -0.2, 0.2);
        let near = tape.add(old, change);
        let squares = [found, near].map(|found| {
            let error = tape.subtract(found, returns);
            let square = tape.square(error);
            tape.affine(square, -0.5, 0.0)
        });
        let error = tape.minimum(squares[0], squares[1]);
        let error = tape.mean(error);
        let entropy = gaussian_entropy(tape, log_std);
        let entropy = tape.mean(entropy);
        let (error, entropy) = (tape.affine(error, -0.5, 0.0), tape.affine(entropy, 0.01, 0.0));
        let loss = tape.subtract(error, surrogate);
        tape.subtract(loss, entropy)
    });
}

#[test]
fn the_objective_of_the_actor_of_sac_is_that_of_pytorch() {
    let mut parameters = Parameters::default();
    let actor = perceptron("actor", (5, &[7], 6), (Activation::Relu, false), 1, &mut parameters);
    let trained = parameters.len();
    let critic = perceptron("critic", (8, &[6], 1), (Activation::Relu, false), 11, &mut parameters);
    train("soft", &mut parameters, trained, 1e-8, |tape, parameters| {
        let (x, noise) = (tape.constant(9, 5, numbers(45, 50, 4.0)), tape.constant(9, 3, numbers(27, 51, 6.0)));
        let head = actor.forward(tape, parameters, x);
        let (mean, raw) = (tape.columns(head, 0..3), tape.columns(head, 3..6));
        let log_std = tape.clip(raw, -20.0, 2.0);
        let [action, density] = squashed_gaussian(tape, mean, log_std, noise);
        let seen = tape.join(x, action);
        tape.set_training(false);
        let value = critic.forward(tape, parameters, seen);
        let entropy = tape.affine(density, 0.2, 0.0);
        let loss = tape.subtract(entropy, value);
        tape.mean(loss)
    });
}
