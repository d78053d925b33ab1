//! Operations on matrices, recorded as they are computed and differentiated in reverse order.
//!
//! A variable is a matrix with a row per sample of a batch. Memory stays with the tape when it is cleared: from the second batch on
//! nothing is allocated.

mod reverse;

use crate::functions::{self, Activation, Elu, Function, Relu, Silu, Tanh};
use crate::kernel::{Kernel, Matrix};
use crate::mlp::{Layer, LayerNorm};
use crate::parameters::Parameters;
use pulp::Arch;
use std::ops::Range;
use std::sync::Arc;

/// Added to the variance of a row before its root is taken, as PyTorch and Flax do.
const NORM_EPSILON: f32 = 1e-5;

/// A matrix on a tape; valid until the tape is cleared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variable(usize);

/// What a variable was computed from.
#[derive(Debug, Clone, PartialEq)]
enum Operation {
    Constant,
    /// One row of parameters from a place on, repeated.
    Parameter {
        begin: usize,
    },
    /// x W' + b.
    Linear {
        x: usize,
        layer: Layer,
        trains: bool,
    },
    Activate {
        x: usize,
        activation: Activation,
    },
    /// Rows with mean 0 and variance 1, scaled and shifted.
    LayerNorm {
        x: usize,
        norm: LayerNorm,
        trains: bool,
    },
    /// Columns of one variable beside those of another.
    Join {
        left: usize,
        right: usize,
    },
    /// Columns from a place on.
    Columns {
        x: usize,
        begin: usize,
    },
    /// Columns in another order, some several times or never.
    Gather {
        x: usize,
        from: Arc<[usize]>,
    },
    Add {
        left: usize,
        right: usize,
    },
    Subtract {
        left: usize,
        right: usize,
    },
    Multiply {
        left: usize,
        right: usize,
    },
    /// The lesser of two, the left one where they are equal.
    Minimum {
        left: usize,
        right: usize,
    },
    /// scale * x + shift.
    Affine {
        x: usize,
        scale: f32,
    },
    Exp {
        x: usize,
    },
    Softplus {
        x: usize,
    },
    Ln {
        x: usize,
    },
    Square {
        x: usize,
    },
    Clip {
        x: usize,
        low: f32,
        high: f32,
    },
    /// Per row.
    SumColumns {
        x: usize,
    },
    /// Of all elements.
    Mean {
        x: usize,
    },
}

#[derive(Debug, Clone)]
struct Node {
    operation: Operation,
    rows: usize,
    columns: usize,
    /// Where its values stand, and its derivatives.
    begin: usize,
    /// Whether it depends on what is trained or [watched](Tape::watched).
    depends: bool,
}

impl Node {
    fn range(&self) -> Range<usize> {
        self.begin..self.begin + self.rows * self.columns
    }
}

/// The record of a computation.
#[derive(Debug)]
pub struct Tape {
    kernel: Arc<dyn Kernel>,
    arch: Arch,
    nodes: Vec<Node>,
    /// Of all nodes, one after the other, and behind them room that an earlier batch had.
    values: Vec<f32>,
    /// Of the last [`backward`](Self::backward), in the places of the values.
    slopes: Vec<f32>,
    trains: bool,
}

impl Tape {
    /// An empty one.
    pub fn new(kernel: Arc<dyn Kernel>) -> Self {
        Self { kernel, arch: Arch::new(), nodes: Vec::new(), values: Vec::new(), slopes: Vec::new(), trains: true }
    }

    /// Forgets all variables, and keeps their memory. Parameters are trained again.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.trains = true;
    }

    /// Whether parameters that are used from now on get a derivative; what they are multiplied with gets one either way.
    pub fn set_training(&mut self, trains: bool) {
        self.trains = trains;
    }

    /// The elements of a variable, row by row.
    pub fn values(&self, variable: Variable) -> &[f32] {
        &self.values[self.nodes[variable.0].range()]
    }

    /// The derivatives of the last [`backward`](Self::backward) with respect to the elements of a variable, which stood on the tape then.
    ///
    /// # Panics
    /// If it does not depend on parameters that are trained, and is not [watched](Self::watched).
    pub fn slopes(&self, variable: Variable) -> &[f32] {
        let node = &self.nodes[variable.0];
        assert!(node.depends, "a variable that is differentiated");
        &self.slopes[node.range()]
    }

    /// Rows and columns of a variable.
    pub fn size(&self, variable: Variable) -> [usize; 2] {
        let Node { rows, columns, .. } = self.nodes[variable.0];
        [rows, columns]
    }

    /// A variable whose values are still those of an earlier batch.
    fn push(&mut self, operation: Operation, [rows, columns]: [usize; 2], depends: bool) -> Variable {
        let begin = self.nodes.last().map_or(0, |last| last.range().end);
        let end = begin + rows * columns;
        if self.values.len() < end {
            self.values.resize(end, 0.0);
        }
        self.nodes.push(Node { operation, rows, columns, begin, depends });
        Variable(self.nodes.len() - 1)
    }

    /// A matrix of numbers, row by row.
    ///
    /// # Panics
    /// If there are not rows times columns of them.
    pub fn constant(&mut self, rows: usize, columns: usize, values: impl IntoIterator<Item = f32>) -> Variable {
        let variable = self.push(Operation::Constant, [rows, columns], false);
        let range = self.nodes[variable.0].range();
        let mut values = values.into_iter();
        let mut filled = 0;
        for (place, value) in self.values[range].iter_mut().zip(&mut values) {
            *place = value;
            filled += 1;
        }
        assert!(filled == rows * columns && values.next().is_none(), "a matrix of {rows} x {columns}");
        variable
    }

    /// The same, with derivatives.
    ///
    /// # Panics
    /// If there are not rows times columns of them.
    pub fn watched(&mut self, rows: usize, columns: usize, values: impl IntoIterator<Item = f32>) -> Variable {
        let variable = self.constant(rows, columns, values);
        self.nodes[variable.0].depends = true;
        variable
    }

    /// The values of a variable without what they were computed from.
    pub fn detached(&mut self, x: Variable) -> Variable {
        let variable = self.push(Operation::Constant, self.size(x), false);
        let (input, out) = self.unary(x, variable);
        out.copy_from_slice(input);
        variable
    }

    /// Parameters as a row, repeated for each of `rows` samples.
    pub fn parameter(&mut self, rows: usize, range: Range<usize>, parameters: &Parameters) -> Variable {
        let operation = Operation::Parameter { begin: range.start };
        let variable = self.push(operation, [rows, range.len()], self.trains);
        let own = self.nodes[variable.0].range();
        for row in self.values[own].chunks_exact_mut(range.len().max(1)) {
            row.copy_from_slice(&parameters.values()[range.clone()]);
        }
        variable
    }

    /// `x W' + b` for each row.
    ///
    /// # Panics
    /// If the layer takes another number of columns.
    pub fn linear(&mut self, x: Variable, layer: &Layer, parameters: &Parameters) -> Variable {
        let Node { rows, depends, .. } = self.nodes[x.0];
        let operation = Operation::Linear { x: x.0, layer: layer.clone(), trains: self.trains };
        let variable = self.push(operation, [rows, layer.outputs], self.trains || depends);
        // Another count of the same kernel, beside the borrow of the values.
        let kernel = self.kernel.clone();
        let (input, out) = self.unary(x, variable);
        for row in out.chunks_exact_mut(layer.outputs.max(1)) {
            row.copy_from_slice(&parameters.values()[layer.bias.clone()]);
        }
        let weight = Matrix::new(&parameters.values()[layer.weight.clone()], layer.outputs, layer.inputs);
        let input = Matrix::new(input, rows, layer.inputs);
        kernel.add_product(input, weight.transposed(), out);
        variable
    }

    /// The activation of each element.
    pub fn activate(&mut self, x: Variable, activation: Activation) -> Variable {
        let operation = Operation::Activate { x: x.0, activation };
        match activation {
            Activation::Tanh => self.map(x, operation, Tanh::value),
            Activation::Relu => self.map(x, operation, Relu::value),
            Activation::Elu => self.map(x, operation, Elu::value),
            Activation::Silu => self.map(x, operation, Silu::value),
        }
    }

    /// Each row with mean 0 and variance 1, then scaled and shifted (Ba et al. 2016).
    pub fn layer_norm(&mut self, x: Variable, norm: &LayerNorm, parameters: &Parameters) -> Variable {
        let [rows, columns] = self.size(x);
        let depends = self.trains || self.nodes[x.0].depends;
        let operation = Operation::LayerNorm { x: x.0, norm: norm.clone(), trains: self.trains };
        let variable = self.push(operation, [rows, columns], depends);
        let (scale, shift) = (&parameters.values()[norm.scale.clone()], &parameters.values()[norm.shift.clone()]);
        let (input, out) = self.unary(x, variable);
        for (input, out) in input.chunks_exact(columns.max(1)).zip(out.chunks_exact_mut(columns.max(1))) {
            let [mean, inverse] = moments(input);
            for (((out, x), scale), shift) in out.iter_mut().zip(input).zip(scale).zip(shift) {
                *out = (x - mean) * inverse * scale + shift;
            }
        }
        variable
    }

    /// The columns of `left`, then those of `right`.
    ///
    /// # Panics
    /// If they have different numbers of rows.
    pub fn join(&mut self, left: Variable, right: Variable) -> Variable {
        let ([rows, a], [others, b]) = (self.size(left), self.size(right));
        assert_eq!(rows, others, "rows of both");
        let depends = self.nodes[left.0].depends || self.nodes[right.0].depends;
        let variable = self.push(Operation::Join { left: left.0, right: right.0 }, [rows, a + b], depends);
        let ranges = [left, right].map(|side| self.nodes[side.0].range());
        let begin = self.nodes[variable.0].begin;
        let (before, out) = self.values.split_at_mut(begin);
        for row in 0..rows {
            let out = &mut out[row * (a + b)..][..a + b];
            out[..a].copy_from_slice(&before[ranges[0].clone()][row * a..][..a]);
            out[a..].copy_from_slice(&before[ranges[1].clone()][row * b..][..b]);
        }
        variable
    }

    /// Some of the columns.
    pub fn columns(&mut self, x: Variable, columns: Range<usize>) -> Variable {
        let [rows, width] = self.size(x);
        let depends = self.nodes[x.0].depends;
        let variable = self.push(Operation::Columns { x: x.0, begin: columns.start }, [rows, columns.len()], depends);
        let (input, out) = self.unary(x, variable);
        for (input, out) in input.chunks_exact(width.max(1)).zip(out.chunks_exact_mut(columns.len().max(1))) {
            out.copy_from_slice(&input[columns.clone()]);
        }
        variable
    }

    /// The columns `from`, in that order.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn gather(&mut self, x: Variable, from: &Arc<[usize]>) -> Variable {
        let [rows, width] = self.size(x);
        let depends = self.nodes[x.0].depends;
        let variable = self.push(Operation::Gather { x: x.0, from: from.clone() }, [rows, from.len()], depends);
        let (input, out) = self.unary(x, variable);
        for (input, out) in input.chunks_exact(width.max(1)).zip(out.chunks_exact_mut(from.len().max(1))) {
            out.iter_mut().zip(from.iter()).for_each(|(out, column)| *out = input[*column]);
        }
        variable
    }

    /// Element by element.
    pub fn add(&mut self, left: Variable, right: Variable) -> Variable {
        self.zip(left, right, Operation::Add { left: left.0, right: right.0 }, |a, b| a + b)
    }

    /// Element by element.
    pub fn subtract(&mut self, left: Variable, right: Variable) -> Variable {
        self.zip(left, right, Operation::Subtract { left: left.0, right: right.0 }, |a, b| a - b)
    }

    /// Element by element.
    pub fn multiply(&mut self, left: Variable, right: Variable) -> Variable {
        self.zip(left, right, Operation::Multiply { left: left.0, right: right.0 }, |a, b| a * b)
    }

    /// The lesser of two elements. Where they are equal the derivative goes to the left one.
    pub fn minimum(&mut self, left: Variable, right: Variable) -> Variable {
        let lesser = |a: f32, b: f32| if b < a { b } else { a };
        self.zip(left, right, Operation::Minimum { left: left.0, right: right.0 }, lesser)
    }

    /// `scale * x + shift` for each element.
    pub fn affine(&mut self, x: Variable, scale: f32, shift: f32) -> Variable {
        self.map(x, Operation::Affine { x: x.0, scale }, move |x| scale * x + shift)
    }

    /// e to the power of each element, which counts as 88 at most.
    pub fn exp(&mut self, x: Variable) -> Variable {
        self.map(x, Operation::Exp { x: x.0 }, functions::exp)
    }

    /// `ln(1 + e^x)` for each element.
    pub fn softplus(&mut self, x: Variable) -> Variable {
        self.map(x, Operation::Softplus { x: x.0 }, functions::softplus)
    }

    /// The natural logarithm of each element, all of which are greater than 0.
    pub fn ln(&mut self, x: Variable) -> Variable {
        self.map(x, Operation::Ln { x: x.0 }, libm::logf)
    }

    /// The hyperbolic tangent of each element.
    pub fn tanh(&mut self, x: Variable) -> Variable {
        self.activate(x, Activation::Tanh)
    }

    /// The square of each element.
    pub fn square(&mut self, x: Variable) -> Variable {
        self.map(x, Operation::Square { x: x.0 }, |x| x * x)
    }

    /// Each element within bounds; beyond them the derivative is 0.
    pub fn clip(&mut self, x: Variable, low: f32, high: f32) -> Variable {
        self.map(x, Operation::Clip { x: x.0, low, high }, move |x| functions::clip(x, low, high))
    }

    /// The sum of each row.
    pub fn sum_columns(&mut self, x: Variable) -> Variable {
        let [rows, columns] = self.size(x);
        let depends = self.nodes[x.0].depends;
        let variable = self.push(Operation::SumColumns { x: x.0 }, [rows, 1], depends);
        let (input, out) = self.unary(x, variable);
        for (input, out) in input.chunks_exact(columns.max(1)).zip(out) {
            *out = input.iter().sum();
        }
        variable
    }

    /// The mean of all elements.
    pub fn mean(&mut self, x: Variable) -> Variable {
        let [rows, columns] = self.size(x);
        let depends = self.nodes[x.0].depends;
        let variable = self.push(Operation::Mean { x: x.0 }, [1, 1], depends);
        let (input, out) = self.unary(x, variable);
        // In double precision: batches may have many rows.
        let sum: f64 = input.iter().map(|x| f64::from(*x)).sum();
        out[0] = (sum / (rows * columns).max(1) as f64) as f32;
        variable
    }

    /// The values of an earlier variable, and room for those of the last one.
    fn unary(&mut self, x: Variable, out: Variable) -> (&[f32], &mut [f32]) {
        let (from, out) = (self.nodes[x.0].range(), self.nodes[out.0].range());
        let (before, rest) = self.values.split_at_mut(out.start);
        (&before[from], &mut rest[..out.len()])
    }

    fn map(&mut self, x: Variable, operation: Operation, function: impl Fn(f32) -> f32) -> Variable {
        let (size, depends, arch) = (self.size(x), self.nodes[x.0].depends, self.arch);
        let variable = self.push(operation, size, depends);
        let (input, out) = self.unary(x, variable);
        arch.dispatch(
            #[inline(always)]
            || out.iter_mut().zip(input).for_each(|(out, x)| *out = function(*x)),
        );
        variable
    }

    fn zip(&mut self, left: Variable, right: Variable, operation: Operation, function: impl Fn(f32, f32) -> f32) -> Variable {
        let size = self.size(left);
        assert_eq!(size, self.size(right), "two variables of one size");
        let (depends, arch) = (self.nodes[left.0].depends || self.nodes[right.0].depends, self.arch);
        let variable = self.push(operation, size, depends);
        let ranges = [left, right].map(|side| self.nodes[side.0].range());
        let out = self.nodes[variable.0].range();
        let (before, rest) = self.values.split_at_mut(out.start);
        let [left, right] = ranges.map(|range| &before[range]);
        let out = &mut rest[..out.len()];
        arch.dispatch(
            #[inline(always)]
            || out.iter_mut().zip(left).zip(right).for_each(|((out, a), b)| *out = function(*a, *b)),
        );
        variable
    }
}

/// Mean and inverse deviation of a row.
fn moments(row: &[f32]) -> [f32; 2] {
    let count = row.len() as f32;
    let mean = row.iter().sum::<f32>() / count;
    let variance = row.iter().map(|x| (x - mean) * (x - mean)).sum::<f32>() / count;
    [mean, 1.0 / (variance + NORM_EPSILON).sqrt()]
}
