//! Neural networks for policies, in single precision and with the same bits everywhere.
//!
//! 1. a [`Kernel`] multiplies matrices; every element is a sum in the order of its index, so neither the number of threads nor the width
//!    of a register changes a bit;
//! 2. a [`Tape`] records some twenty operations as they are computed, and differentiates them in reverse;
//! 3. [`Parameters`] hold the numbers that are trained, one flat array with named tensors; [`Mlp`] is a perceptron of them,
//!    plain or residual;
//! 4. [`Adam`] changes them; [`heads`] are the distributions of actions;
//! 5. [`Normaliser`] scales what a network sees by its running mean and deviation;
//! 6. [`file`](mod@file) writes and reads safetensors.
//!
//! ```
//! use msk_network::{Activation, Adam, Mlp, Parameters, Processor, Shape, Tape};
//! use std::num::NonZeroUsize;
//! use std::sync::Arc;
//!
//! // A line through two points, found by gradient descent.
//! let mut parameters = Parameters::default();
//! let shape = Shape { inputs: 1, hidden: vec![], outputs: 1, activation: Activation::Tanh, layer_norm: false, residual: false };
//! let network = Mlp::new("line", &shape, &mut parameters);
//! let mut tape = Tape::new(Arc::new(Processor::new(NonZeroUsize::MIN)?));
//! let mut adam = Adam::new(parameters.len());
//! let mut gradient = vec![0.0; parameters.len()];
//! for _ in 0..2000 {
//!     tape.clear();
//!     let x = tape.constant(2, 1, [0.0, 1.0]);
//!     let wanted = tape.constant(2, 1, [1.0, 3.0]);
//!     let found = network.forward(&mut tape, &parameters, x);
//!     let error = tape.subtract(found, wanted);
//!     let squares = tape.square(error);
//!     let loss = tape.mean(squares);
//!     gradient.fill(0.0);
//!     tape.backward(loss, &parameters, &mut gradient);
//!     adam.step(0.01, parameters.values_mut(), &gradient);
//! }
//! assert!((parameters.values()[0] - 2.0).abs() < 1e-3 && (parameters.values()[1] - 1.0).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod adam;
pub mod file;
mod functions;
pub mod heads;
mod initial;
mod kernel;
mod mlp;
mod normaliser;
mod parameters;
mod tape;

pub use adam::{Adam, clip_norm};
pub use functions::Activation;
pub use initial::{orthogonal, uniform_fan_in};
pub use kernel::{Kernel, Matrix, Processor};
pub use mlp::{Layer, LayerNorm, Mlp, Shape, Step};
pub use normaliser::{Moments, Normaliser};
pub use parameters::{Parameters, Tensor};
pub use tape::{Tape, Variable};
