//! From the second batch on nothing is allocated.

use super::{numbers, perceptron, tape};
use allocation_counter::measure;
use msk_network::{Activation, Adam, Parameters, clip_norm};

#[test]
fn a_training_step_asks_for_no_memory_after_the_first() {
    let mut parameters = Parameters::default();
    let network = perceptron("policy", (20, &[32, 32], 6), (Activation::Tanh, false), 1, &mut parameters);
    let (mut tape, mut adam) = (tape(1), Adam::new(parameters.len()));
    let mut gradient = vec![0.0; parameters.len()];
    let data = numbers(64 * 20, 5, 1.0);
    let mut step = || {
        tape.clear();
        let x = tape.constant(64, 20, data.iter().copied());
        let y = network.forward(&mut tape, &parameters, x);
        let squares = tape.square(y);
        let loss = tape.mean(squares);
        gradient.fill(0.0);
        tape.backward(loss, &parameters, &mut gradient);
        clip_norm(&mut gradient, 0.5);
        adam.step(1e-3, parameters.values_mut(), &gradient);
    };
    step();
    assert_eq!(measure(step).count_total, 0);
}
