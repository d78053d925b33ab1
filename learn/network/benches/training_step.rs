//! Time of a training step of a perceptron 700-512-512-512-416 with tanh: forward, derivatives, Adam.
//! `cargo bench -p msk-network --bench training_step -- THREADS`.

use msk_network::{Activation, Adam, Kernel, Matrix, Mlp, Parameters, Processor, Shape, Tape};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let threads = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(NonZeroUsize::MIN);
    let kernel = Arc::new(Processor::new(threads)?);
    product(kernel.as_ref());
    for (hidden, batch) in
        [(vec![512; 3], 256), (vec![512; 3], 1024), (vec![512; 3], 4096), (vec![64; 2], 64), (vec![256; 2], 256)]
    {
        let [inputs, outputs] = if hidden.len() == 3 { [700, 416] } else { [17, 6] };
        let shape =
            Shape { inputs, hidden: hidden.clone(), outputs, activation: Activation::Tanh, layer_norm: false, residual: false };
        let mut parameters = Parameters::default();
        let network = Mlp::new("policy", &shape, &mut parameters);
        let number = |index: usize| (index.wrapping_mul(2_654_435_761) % 1000) as f32 / 1000.0 - 0.5;
        parameters.values_mut().iter_mut().enumerate().for_each(|(index, value)| *value = 0.1 * number(index));
        let data: Vec<f32> = (0..batch * inputs).map(number).collect();
        let mut tape = Tape::new(kernel.clone());
        let mut adam = Adam::new(parameters.len());
        let mut gradient = vec![0.0; parameters.len()];
        let mut step = || {
            tape.clear();
            let x = tape.constant(batch, inputs, data.iter().copied());
            let y = network.forward(&mut tape, &parameters, x);
            let squares = tape.square(y);
            let loss = tape.mean(squares);
            gradient.fill(0.0);
            tape.backward(loss, &parameters, &mut gradient);
            adam.step(1e-4, parameters.values_mut(), &gradient);
        };
        (0..3).for_each(|_| step());
        let count = (65_536 / batch).clamp(16, 800);
        let best = (0..count)
            .map(|_| {
                let begin = Instant::now();
                step();
                begin.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min);
        println!("{hidden:?}, batch {batch}, {threads} threads: {:.3} ms", 1e3 * best);
    }
    Ok(())
}

/// The product alone, beside that of the library `matrixmultiply`, which fuses and selects by processor.
fn product(kernel: &dyn Kernel) {
    let size = 512;
    let numbers: Vec<f32> = (0..size * size).map(|index| (index % 13) as f32 - 6.0).collect();
    let mut out = vec![0.0; size * size];
    let time = |work: &mut dyn FnMut()| {
        work();
        (0..200)
            .map(|_| {
                let begin = Instant::now();
                work();
                begin.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min)
    };
    let flops = 2.0 * (size as f64).powi(3) * 1e-9;
    let a = Matrix::new(&numbers, size, size);
    for (name, a, b) in [("a b", a, a), ("a b'", a, a.transposed()), ("a' b", a.transposed(), a)] {
        let seconds = time(&mut || kernel.add_product(a, b, &mut out));
        println!("product {name} of {size}: {:.1} GFlop/s", flops / seconds);
    }
    let matrix = nalgebra::DMatrix::from_column_slice(size, size, &numbers);
    let mut product = matrix.clone();
    let seconds = time(&mut || product.gemm(1.0, &matrix, &matrix, 1.0));
    println!("nalgebra: {:.1} GFlop/s", flops / seconds);
}
