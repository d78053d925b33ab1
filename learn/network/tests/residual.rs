//! Residual perceptrons against their formula, written out in double precision.

use super::{filled, numbers, tape};
use msk_network::{Activation, Parameters, Shape};

/// A tensor of a network, by the end of its name.
fn tensor(parameters: &Parameters, name: &str) -> Vec<f64> {
    let tensor = parameters.tensors().iter().find(|tensor| tensor.name == format!("critic.{name}")).unwrap();
    parameters.values()[tensor.range.clone()].iter().map(|value| f64::from(*value)).collect()
}

fn linear(parameters: &Parameters, layer: usize, x: &[f64]) -> Vec<f64> {
    let weight = tensor(parameters, &format!("{layer}.weight"));
    let bias = tensor(parameters, &format!("{layer}.bias"));
    weight.chunks(x.len()).zip(bias).map(|(row, bias)| bias + row.iter().zip(x).map(|(w, x)| w * x).sum::<f64>()).collect()
}

fn norm(parameters: &Parameters, index: usize, x: &[f64]) -> Vec<f64> {
    let [scale, shift] = ["scale", "shift"].map(|what| tensor(parameters, &format!("norm{index}.{what}")));
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let variance = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64;
    let unit = x.iter().map(|x| (x - mean) / (variance + 1e-5).sqrt());
    unit.zip(scale).zip(shift).map(|((unit, scale), shift)| unit * scale + shift).collect()
}

#[test]
fn blocks_add_what_two_layers_make_of_a_norm() {
    let mut parameters = Parameters::default();
    let shape =
        Shape { inputs: 3, hidden: vec![4, 4], outputs: 2, activation: Activation::Relu, layer_norm: false, residual: true };
    let network = filled("critic", &shape, 1, &mut parameters);
    let input = numbers(3, 50, 4.0);
    let mut x = linear(&parameters, 0, &input.iter().map(|x| f64::from(*x)).collect::<Vec<_>>());
    for block in 0..2 {
        let inner = linear(&parameters, 2 * block + 1, &norm(&parameters, block, &x));
        assert_eq!(inner.len(), 16, "four times as wide within");
        let inner: Vec<f64> = inner.into_iter().map(|x| x.max(0.0)).collect();
        let added = linear(&parameters, 2 * block + 2, &inner);
        x.iter_mut().zip(added).for_each(|(x, added)| *x += added);
    }
    let expected = linear(&parameters, 5, &norm(&parameters, 2, &x));
    let mut tape = tape(1);
    let seen = tape.constant(1, 3, input);
    let found = network.forward(&mut tape, &parameters, seen);
    for (found, expected) in tape.values(found).iter().zip(&expected) {
        assert!((f64::from(*found) - expected).abs() < 1e-5, "{found}, expected {expected}");
    }
    assert_eq!(network.layers().len(), 6);
}

#[test]
fn a_shape_knows_how_many_numbers_it_has() {
    for hidden in [vec![], vec![4], vec![4, 4, 4]] {
        for (layer_norm, residual) in [(false, false), (true, false), (false, true), (true, true)] {
            let shape =
                Shape { inputs: 3, hidden: hidden.clone(), outputs: 2, activation: Activation::Relu, layer_norm, residual };
            let mut parameters = Parameters::default();
            filled("critic", &shape, 1, &mut parameters);
            assert_eq!(shape.numbers(), parameters.len(), "{shape:?}");
        }
    }
    let hidden = vec![usize::MAX / 2; 2];
    let endless = Shape { inputs: 3, hidden, outputs: 2, activation: Activation::Relu, layer_norm: true, residual: false };
    assert_eq!(endless.numbers(), usize::MAX);
}
