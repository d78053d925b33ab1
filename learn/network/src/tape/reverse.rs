//! Derivatives in reverse order: the chain rule, operation by operation.

use super::{Node, Operation, Tape, Variable, moments};
use crate::functions::{Activation, Elu, Function, Relu, Silu, Tanh, softplus_slope};
use crate::kernel::Matrix;
use crate::parameters::Parameters;
use pulp::Arch;
use std::ops::Range;

impl Tape {
    /// Adds the derivatives of `loss`, a variable with one element, with respect to the parameters that were used while training was
    /// set to `gradient`, one number per parameter. [`slopes`](Self::slopes) holds those with respect to variables.
    ///
    /// # Panics
    /// If the loss has more than one element, or the gradient another length than the parameters.
    pub fn backward(&mut self, loss: Variable, parameters: &Parameters, gradient: &mut [f32]) {
        assert_eq!(self.size(loss), [1, 1], "a loss is one number");
        assert_eq!(gradient.len(), parameters.len(), "one derivative per parameter");
        if self.slopes.len() < self.values.len() {
            self.slopes.resize(self.values.len(), 0.0);
        }
        for node in self.nodes.iter().filter(|node| node.depends) {
            self.slopes[node.range()].fill(0.0);
        }
        self.slopes[self.nodes[loss.0].begin] = 1.0;
        for index in (0..=loss.0).rev().filter(|index| self.nodes[*index].depends) {
            let node = &self.nodes[index];
            let (before, own) = self.slopes.split_at_mut(node.begin);
            let step = Step {
                arch: self.arch,
                nodes: &self.nodes,
                values: &self.values,
                before,
                own: &own[..node.rows * node.columns],
                node,
            };
            match &node.operation {
                Operation::Linear { x, layer, trains } => {
                    let (rows, own) = (node.rows, step.own);
                    let slope = Matrix::new(own, rows, layer.outputs);
                    if *trains {
                        let input = Matrix::new(&self.values[self.nodes[*x].range()], rows, layer.inputs);
                        self.kernel.add_product(slope.transposed(), input, &mut gradient[layer.weight.clone()]);
                        add_rows(&mut gradient[layer.bias.clone()], own);
                    }
                    if self.nodes[*x].depends {
                        let weight = Matrix::new(&parameters.values()[layer.weight.clone()], layer.outputs, layer.inputs);
                        self.kernel.add_product(slope, weight, &mut step.before[self.nodes[*x].range()]);
                    }
                }
                Operation::Parameter { begin } => {
                    add_rows(&mut gradient[*begin..begin + node.columns], step.own);
                }
                Operation::LayerNorm { x, norm, trains } => {
                    step.layer_norm(*x, &parameters.values()[norm.scale.clone()], |scales, shifts| {
                        if *trains {
                            gradient[norm.scale.clone()].iter_mut().zip(scales).for_each(|(sum, slope)| *sum += slope);
                            gradient[norm.shift.clone()].iter_mut().zip(shifts).for_each(|(sum, slope)| *sum += slope);
                        }
                    });
                }
                operation => step.elementwise(operation),
            }
        }
    }
}

/// Adds each row to a sum.
fn add_rows(sums: &mut [f32], rows: &[f32]) {
    for row in rows.chunks_exact(sums.len().max(1)) {
        sums.iter_mut().zip(row).for_each(|(sum, slope)| *sum += slope);
    }
}

/// One operation in reverse.
struct Step<'a> {
    arch: Arch,
    nodes: &'a [Node],
    values: &'a [f32],
    /// Derivatives of all variables before the operation's own.
    before: &'a mut [f32],
    /// Derivatives of what it gave.
    own: &'a [f32],
    node: &'a Node,
}

impl Step<'_> {
    fn range(&self, index: usize) -> Range<usize> {
        self.nodes[index].range()
    }

    /// Passes derivatives of an elementwise operation, or of one that moves elements, to its operands.
    fn elementwise(mut self, operation: &Operation) {
        match *operation {
            Operation::Activate { x, activation } => match activation {
                Activation::Tanh => self.one(x, Tanh::slope),
                Activation::Relu => self.one(x, Relu::slope),
                Activation::Elu => self.one(x, Elu::slope),
                Activation::Silu => self.one(x, Silu::slope),
            },
            Operation::Affine { x, scale } => self.one(x, move |_, _| scale),
            Operation::Exp { x } => self.one(x, |_, y| y),
            Operation::Softplus { x } => self.one(x, |x, _| softplus_slope(x)),
            Operation::Ln { x } => self.one(x, |x, _| 1.0 / x),
            Operation::Square { x } => self.one(x, |x, _| 2.0 * x),
            Operation::Clip { x, low, high } => self.one(x, move |x, _| if x < low || x > high { 0.0 } else { 1.0 }),
            Operation::Add { left, right } => {
                self.two(left, [left, right], |_, _| 1.0);
                self.two(right, [left, right], |_, _| 1.0);
            }
            Operation::Subtract { left, right } => {
                self.two(left, [left, right], |_, _| 1.0);
                self.two(right, [left, right], |_, _| -1.0);
            }
            Operation::Multiply { left, right } => {
                self.two(left, [left, right], |_, b| b);
                self.two(right, [left, right], |a, _| a);
            }
            Operation::Minimum { left, right } => {
                self.two(left, [left, right], |a, b| if b < a { 0.0 } else { 1.0 });
                self.two(right, [left, right], |a, b| if b < a { 1.0 } else { 0.0 });
            }
            Operation::Join { left, right } => {
                let width = self.nodes[left].columns;
                self.move_columns(left, 0..width, 0);
                self.move_columns(right, 0..self.nodes[right].columns, width);
            }
            Operation::Columns { x, begin } => self.move_columns(x, begin..begin + self.node.columns, 0),
            Operation::Gather { x, ref from } => self.scatter(x, from),
            Operation::SumColumns { x } => {
                let (range, width) = (self.range(x), self.nodes[x].columns.max(1));
                for (row, slope) in self.before[range].chunks_exact_mut(width).zip(self.own) {
                    row.iter_mut().for_each(|sum| *sum += slope);
                }
            }
            Operation::Mean { x } => {
                let range = self.range(x);
                let share = self.own[0] / range.len().max(1) as f32;
                self.before[range].iter_mut().for_each(|sum| *sum += share);
            }
            // Those that hold parameters are passed by their caller; a constant has no operand.
            Operation::Constant | Operation::Parameter { .. } | Operation::Linear { .. } | Operation::LayerNorm { .. } => {}
        }
    }

    /// Adds own derivatives, times the slope at argument and value, to those of the operand.
    fn one(&mut self, x: usize, slope: impl Fn(f32, f32) -> f32) {
        if !self.nodes[x].depends {
            return;
        }
        let (range, arch) = (self.range(x), self.arch);
        let (arguments, results) = (&self.values[range.clone()], &self.values[self.node.range()]);
        let (sums, own) = (&mut self.before[range], self.own);
        arch.dispatch(
            #[inline(always)]
            || {
                for (((sum, own), x), y) in sums.iter_mut().zip(own).zip(arguments).zip(results) {
                    *sum += own * slope(*x, *y);
                }
            },
        );
    }

    /// The same for one of two operands, with the slope at both arguments.
    fn two(&mut self, to: usize, [left, right]: [usize; 2], slope: impl Fn(f32, f32) -> f32) {
        if !self.nodes[to].depends {
            return;
        }
        let (range, arch) = (self.range(to), self.arch);
        let [left, right] = [left, right].map(|side| &self.values[self.range(side)]);
        let (sums, own) = (&mut self.before[range], self.own);
        arch.dispatch(
            #[inline(always)]
            || {
                for (((sum, own), a), b) in sums.iter_mut().zip(own).zip(left).zip(right) {
                    *sum += own * slope(*a, *b);
                }
            },
        );
    }

    /// Adds own derivatives of columns from `from` on to those of columns `to` of the operand.
    fn move_columns(&mut self, x: usize, to: Range<usize>, from: usize) {
        if !self.nodes[x].depends {
            return;
        }
        let (range, width, own_width) = (self.range(x), self.nodes[x].columns, self.node.columns);
        let rows = self.before[range].chunks_exact_mut(width.max(1)).zip(self.own.chunks_exact(own_width.max(1)));
        for (sums, own) in rows {
            sums[to.clone()].iter_mut().zip(&own[from..]).for_each(|(sum, slope)| *sum += slope);
        }
    }

    /// Adds own derivatives of each column to those of the operand's column that it was taken from.
    fn scatter(&mut self, x: usize, from: &[usize]) {
        if !self.nodes[x].depends {
            return;
        }
        let (range, width) = (self.range(x), self.nodes[x].columns);
        let rows = self.before[range].chunks_exact_mut(width.max(1)).zip(self.own.chunks_exact(from.len().max(1)));
        for (sums, own) in rows {
            from.iter().zip(own).for_each(|(column, slope)| sums[*column] += slope);
        }
    }

    /// Passes derivatives through a layer norm: row by row to the operand, and those of scale and shift of that row to `parameters`.
    fn layer_norm(self, x: usize, scale: &[f32], mut parameters: impl FnMut(&[f32], &[f32])) {
        let width = self.node.columns.max(1);
        let (range, depends) = (self.range(x), self.nodes[x].depends);
        let arguments = &self.values[range.clone()];
        let sums = &mut self.before[range];
        let (mut units, mut scales) = (vec![0.0; width], vec![0.0; width]);
        let rows = sums.chunks_exact_mut(width).zip(arguments.chunks_exact(width)).zip(self.own.chunks_exact(width));
        for ((sums, x), own) in rows {
            let [mean, inverse] = moments(x);
            for ((unit, scales), (x, own)) in units.iter_mut().zip(&mut scales).zip(x.iter().zip(own)) {
                *unit = (x - mean) * inverse;
                *scales = own * *unit;
            }
            parameters(&scales, own);
            if depends {
                let scaled = || own.iter().zip(scale).map(|(own, scale)| own * scale);
                let count = width as f32;
                let plain = scaled().sum::<f32>() / count;
                let along = scaled().zip(&units).map(|(slope, unit)| slope * unit).sum::<f32>() / count;
                for ((sum, slope), unit) in sums.iter_mut().zip(scaled()).zip(&units) {
                    *sum += inverse * (slope - plain - unit * along);
                }
            }
        }
    }
}
