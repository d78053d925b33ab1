//! Long lists, computed as a whole.

use super::formula::View;
use super::lane::{Code, Run};
use crate::graph::operation::{Binary, Unary, quaternion};

/// Reads inputs, writes `width` numbers from `at` on. Inputs in the record stand below `at`.
pub(crate) struct Block {
    pub(super) code: Code,
    pub(super) inputs: Vec<Run>,
    pub(super) at: usize,
    pub(super) width: usize,
}

impl Block {
    /// Computes it.
    pub(super) fn execute(&self, frame: &[f64], record: &mut [f64]) {
        let (below, above) = record.split_at_mut(self.at);
        let out = &mut above[..self.width];
        let view = View { frame, record: below };
        let input = |place: usize| view.run(self.inputs[place]);
        match self.code {
            Code::Unary(function) => map(function, input(0), out),
            Code::Binary(function) => zip(function, input(0), input(1), out),
            Code::Choose => choose(input(0), input(1), input(2), out),
            Code::Reduce(reduction, group) => {
                for (value, lanes) in out.iter_mut().zip(input(0).chunks_exact(group)) {
                    *value = reduction.apply(lanes);
                }
            }
            Code::Quaternion => {
                if let Ok(axes) = <[f64; 9]>::try_from(input(0)) {
                    out.copy_from_slice(&quaternion(axes));
                }
            }
        }
    }
}

// The frequent functions are chosen once per list, not once per lane, so that the loops vectorise.

fn map(function: Unary, input: &[f64], out: &mut [f64]) {
    let pairs = out.iter_mut().zip(input);
    match function {
        Unary::Negate => pairs.for_each(|(value, &x)| *value = -x),
        Unary::Absolute => pairs.for_each(|(value, &x)| *value = x.abs()),
        other => pairs.for_each(|(value, &x)| *value = other.apply(x)),
    }
}

fn zip(function: Binary, left: &[f64], right: &[f64], out: &mut [f64]) {
    match function {
        Binary::Add => zip_with(left, right, out, |a, b| a + b),
        Binary::Subtract => zip_with(left, right, out, |a, b| a - b),
        Binary::Multiply => zip_with(left, right, out, |a, b| a * b),
        Binary::Divide => zip_with(left, right, out, |a, b| a / b),
        other => zip_with(left, right, out, |a, b| other.apply(a, b)),
    }
}

fn zip_with(left: &[f64], right: &[f64], out: &mut [f64], f: impl Fn(f64, f64) -> f64) {
    match (left, right) {
        ([a], [b]) => out.fill(f(*a, *b)),
        ([a], _) => out.iter_mut().zip(right).for_each(|(value, &b)| *value = f(*a, b)),
        (_, [b]) => out.iter_mut().zip(left).for_each(|(value, &a)| *value = f(a, *b)),
        _ => out.iter_mut().zip(left.iter().zip(right)).for_each(|(value, (&a, &b))| *value = f(a, b)),
    }
}

fn choose(condition: &[f64], yes: &[f64], no: &[f64], out: &mut [f64]) {
    let lane = |lanes: &[f64], index: usize| if let [only] = lanes { *only } else { lanes[index] };
    for (index, value) in out.iter_mut().enumerate() {
        *value = if lane(condition, index) != 0.0 { lane(yes, index) } else { lane(no, index) };
    }
}
