//! Multilayer perceptrons in single precision. Sums keep one order and functions are `libm`'s, so that all machines compute the same
//! bits.

/// Columns in which a sum is accumulated: their additions do not wait for each other.
const COLUMNS: usize = 8;

/// What follows a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Activation {
    Identity,
    Tanh,
    Relu,
    Elu,
    Silu,
    Gelu,
}

impl Activation {
    /// Those of hidden layers, as files name them.
    pub const NAMED: [(&str, Self); 5] =
        [("tanh", Self::Tanh), ("relu", Self::Relu), ("elu", Self::Elu), ("silu", Self::Silu), ("gelu", Self::Gelu)];

    fn of(self, x: f32) -> f32 {
        match self {
            Self::Identity => x,
            Self::Tanh => libm::tanhf(x),
            Self::Relu if x > 0.0 => x,
            Self::Relu => 0.0,
            Self::Elu if x > 0.0 => x,
            Self::Elu => libm::expm1f(x),
            Self::Silu => x / (1.0 + libm::expf(-x)),
            Self::Gelu => 0.5 * x * (1.0 + libm::erff(x * core::f32::consts::FRAC_1_SQRT_2)),
        }
    }
}

/// `activation(weight * input + bias)`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layer {
    /// Row by row, as many rows as outputs.
    pub weight: Vec<f32>,
    /// One per output; never none.
    pub bias: Vec<f32>,
    /// Length of a row; never 0.
    pub inputs: usize,
    pub activation: Activation,
}

impl Layer {
    fn apply(&self, input: &[f32], output: &mut Vec<f32>) {
        output.clear();
        let rows = self.weight.chunks_exact(self.inputs).zip(&self.bias);
        output.extend(rows.map(|(row, bias)| self.activation.of(dot(row, input) + bias)));
    }
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut columns = [0.0_f32; COLUMNS];
    let (wide_a, rest_a) = a.as_chunks::<COLUMNS>();
    let (wide_b, rest_b) = b.as_chunks::<COLUMNS>();
    for (a, b) in wide_a.iter().zip(wide_b) {
        for column in 0..COLUMNS {
            columns[column] += a[column] * b[column];
        }
    }
    let rest: f32 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    columns.iter().sum::<f32>() + rest
}

/// Layers, each of which takes what the one before gives; never none.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mlp {
    pub layers: Vec<Layer>,
}

impl Mlp {
    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, |layer| layer.inputs)
    }

    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, |layer| layer.bias.len())
    }

    /// Replaces the numbers of `values` by what the network makes of them; `spare` is memory.
    pub fn forward(&self, values: &mut Vec<f32>, spare: &mut Vec<f32>) {
        for layer in &self.layers {
            layer.apply(values, spare);
            core::mem::swap(values, spare);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definitions, in double precision.
    fn expected(activation: Activation, x: f64) -> f64 {
        match activation {
            Activation::Identity => x,
            Activation::Tanh => libm::tanh(x),
            Activation::Relu => (x + x.abs()) / 2.0,
            Activation::Elu => {
                if x > 0.0 {
                    x
                } else {
                    libm::exp(x) - 1.0
                }
            }
            Activation::Silu => x / (1.0 + libm::exp(-x)),
            Activation::Gelu => x * 0.5 * libm::erfc(-x / core::f64::consts::SQRT_2),
        }
    }

    #[test]
    fn a_network_is_what_its_definition_says() {
        // Numbers without a pattern that a mistake in an index could hide behind.
        let number = |index: usize| ((index * 2_654_435_761) % 1000) as f64 / 1000.0 - 0.5;
        for (_, activation) in Activation::NAMED {
            let sizes = [19, 11, 5];
            let activations = [activation, Activation::Identity];
            let layers: Vec<Layer> = (0..2)
                .map(|layer| Layer {
                    weight: (0..sizes[layer] * sizes[layer + 1]).map(|index| number(index + layer) as f32).collect(),
                    bias: (0..sizes[layer + 1]).map(|index| number(7 * index) as f32).collect(),
                    inputs: sizes[layer],
                    activation: activations[layer],
                })
                .collect();
            let mut exact: Vec<f64> = (0..19).map(|index| 4.0 * number(3 * index)).collect();
            let mut values: Vec<f32> = exact.iter().map(|value| *value as f32).collect();
            for (layer, activation) in layers.iter().zip(activations) {
                let row = |output: usize| {
                    let products =
                        (0..layer.inputs).map(|input| f64::from(layer.weight[output * layer.inputs + input]) * exact[input]);
                    expected(activation, products.sum::<f64>() + f64::from(layer.bias[output]))
                };
                exact = (0..layer.bias.len()).map(row).collect();
            }
            let network = Mlp { layers };
            assert_eq!((network.inputs(), network.outputs()), (19, 5));
            network.forward(&mut values, &mut Vec::new());
            for (value, exact) in values.iter().zip(&exact) {
                assert!((f64::from(*value) - exact).abs() < 1e-5, "{activation:?}: {value} {exact}");
            }
        }
    }
}
