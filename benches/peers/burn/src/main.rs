//! Time of a training step of a perceptron in burn, beside that of `learn/network/benches/training_step.rs`: the same sizes.
//!
//! Forward, derivatives of a mean of squares, and a step of Adam, in single precision on burn's own backend for processors. Prints the least
//! time of a step: other programs only add to it.

use burn::module::Module;
use burn::nn::{Linear, LinearConfig};
use burn::optim::{AdamConfig, GradientsParams};
use burn::tensor::{Device, Distribution, Tensor};
use std::time::Instant;

const SIZES: [(&[usize], usize); 3] =
    [(&[17, 64, 64, 6], 64), (&[17, 256, 256, 6], 256), (&[700, 512, 512, 512, 416], 256)];

#[derive(Module, Debug)]
struct Perceptron {
    layers: Vec<Linear>,
}

impl Perceptron {
    fn new(sizes: &[usize], device: &Device) -> Self {
        Self { layers: sizes.windows(2).map(|pair| LinearConfig::new(pair[0], pair[1]).init(device)).collect() }
    }

    fn forward(&self, mut rows: Tensor<2>) -> Tensor<2> {
        for (index, layer) in self.layers.iter().enumerate() {
            rows = layer.forward(if index == 0 { rows } else { rows.tanh() });
        }
        rows
    }
}

fn main() {
    for (sizes, batch) in SIZES {
        let device = Device::flex().autodiff();
        let (mut network, mut optimizer) = (Perceptron::new(sizes, &device), AdamConfig::new().init());
        let data = Tensor::<2>::random([batch, sizes[0]], Distribution::Default, &device);
        let mut least = f64::INFINITY;
        for _ in 0..(65_536 / batch) {
            let begin = Instant::now();
            let loss = network.forward(data.clone()).square().mean();
            let gradient = GradientsParams::from_grads(loss.backward(), &network);
            network = optimizer.step(1e-4, network, gradient);
            least = least.min(begin.elapsed().as_secs_f64());
        }
        println!("{sizes:?}, batch {batch}: burn {:.3} ms", 1e3 * least);
    }
}
