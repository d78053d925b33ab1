//! The operations of the graph and what each computes on numbers: the one place that folding, the closures and the interpreter
//! of the tests share.

use super::track::Track;
use crate::extremes::{between, maximum, minimum};
use crate::frame::Sensor;
use serde::{Deserialize, Serialize};

/// A number that is equal to another exactly if their bits are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Bits(u64);

impl Bits {
    /// The bits of `value`.
    pub fn of(value: f64) -> Self {
        Self(value.to_bits())
    }

    /// The number.
    pub fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// What a node computes. Conditions are 0 or 1; vectors and lists are lanes side by side.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Operation {
    /// Fixed lanes.
    Constant(Vec<Bits>),
    /// Sensor blocks side by side.
    Sensors(Vec<Sensor>),
    /// Control steps since reset.
    Step,
    /// Lane by lane.
    Unary(Unary),
    /// Lane by lane; an input of one lane meets every lane of the other.
    Binary(Binary),
    /// Input 1 where input 0 holds, else input 2; inputs of one lane meet every lane.
    Choose,
    /// Lanes of the input, in any order, repeated at will.
    Select(Vec<u32>),
    /// Inputs side by side.
    Join,
    /// Each group of so many consecutive lanes becomes one.
    Reduce(Reduction, u32),
    /// Nine lanes of axes (forward, left, up) as the unit quaternion w x y z with w >= 0.
    Quaternion,
    /// A cell that remembers; advances once per control step.
    Memory(Memory),
    /// A declared state before this step's update; its input is the value at reset.
    StateBefore(u32),
    /// The same state after this step's update.
    StateAfter(u32),
    /// Numbers that chance gives a random at each try: which random, from what, how many.
    Noise(u32, Chance, u32),
    /// A random before this step's redraw; input 0 is what a try gives, input 1, if there is one, whether it is taken.
    Drawn(u32),
    /// The same random after this step's redraw.
    DrawnAfter(u32),
    /// Element number input 1 of the list in input 0, so many lanes each. The index is whole and within the list.
    Pick(u32),
    /// Whether an earlier phase of the sequence had succeeded when it ended.
    PhaseSuccess(u32),
    /// What a motion shows at the time in input 0, s.
    Follow(Track),
}

impl Operation {
    /// Whether it gives what a declared state or a random holds, before or after this step.
    pub fn is_held(&self) -> bool {
        matches!(self, Self::StateBefore(_) | Self::StateAfter(_) | Self::Drawn(_) | Self::DrawnAfter(_))
    }

    /// Whether its value is not settled by its inputs in this step alone: a memory, or what is held.
    pub fn remembers(&self) -> bool {
        matches!(self, Self::Memory(_)) || self.is_held()
    }
}

/// From what chance draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Chance {
    /// Uniform on [0, 1).
    Uniform,
    /// Standard normal.
    Normal,
}

/// Functions of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Unary {
    Negate,
    Absolute,
    SquareRoot,
    Exponential,
    Logarithm,
    HyperbolicTangent,
    Sine,
    Cosine,
    Tangent,
    ArcSine,
    ArcCosine,
    Floor,
    Sign,
    Not,
    /// An angle brought into (-pi, pi].
    Wrap,
}

/// Functions of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Minimum,
    Maximum,
    ArcTangent2,
    Hypotenuse,
    Modulo,
    Less,
    LessEqual,
    Equal,
    And,
    Or,
}

/// Functions of a group of lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Reduction {
    Sum,
    Product,
    Minimum,
    Maximum,
    /// Root of the sum of squares.
    Norm,
    /// Place of the first lowest lane.
    ArgMinimum,
    /// Place of the first highest lane.
    ArgMaximum,
}

/// Cells that remember. Step 0 is the reset snapshot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Memory {
    /// The value at step 0.
    Initial,
    /// The highest value so far, step 0 included.
    Highest,
    /// The lowest value so far, step 0 included.
    Lowest,
    /// The sum of values since step 0, which is not counted.
    Accumulate,
    /// For how many steps without a break the condition has held, step 0 not counted.
    Streak,
    /// How many steps ago the condition last held, infinite before.
    StepsSince,
    /// Becomes 1 above input 2, 0 below input 1, else stays; at step 0 it is 1 from input 2 upwards.
    Hysteresis,
    /// Moves by the fraction in input 1 towards input 0; starts there.
    Smooth,
    /// The same of an angle, which moves the short way round and stays in (-pi, pi].
    SmoothAngle,
    /// Input 0 at the last step at which input 1 held; at step 0 its value there.
    Sampled,
    /// The value so many steps ago; before that, the value at step 0.
    Delay(u32),
}

impl Unary {
    /// The value at `x`.
    #[inline]
    pub fn apply(self, x: f64) -> f64 {
        match self {
            Self::Negate => -x,
            Self::Absolute => x.abs(),
            Self::SquareRoot => x.sqrt(),
            Self::Exponential => libm::exp(x),
            Self::Logarithm => libm::log(x),
            Self::HyperbolicTangent => libm::tanh(x),
            Self::Sine => libm::sin(x),
            Self::Cosine => libm::cos(x),
            Self::Tangent => libm::tan(x),
            // Products of unit vectors overshoot 1 by a rounding error; that is no reason for a non-finite reward.
            Self::ArcSine => libm::asin(between(x, -1.0, 1.0)),
            Self::ArcCosine => libm::acos(between(x, -1.0, 1.0)),
            Self::Floor => x.floor(),
            Self::Sign => f64::from(u8::from(x > 0.0)) - f64::from(u8::from(x < 0.0)),
            Self::Not => f64::from(u8::from(x == 0.0)),
            Self::Wrap => wrap(x),
        }
    }
}

/// The equal angle in (-pi, pi].
fn wrap(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let remainder = angle - TAU * (angle / TAU).round();
    // Of large angles rounding leaves more than half a turn; the exact remainder takes longer.
    let remainder = if remainder.abs() <= PI { remainder } else { libm::remainder(angle, TAU) };
    if remainder <= -PI { remainder + TAU } else { remainder }
}

impl Binary {
    /// The value at `a` and `b`.
    #[inline]
    pub fn apply(self, a: f64, b: f64) -> f64 {
        let truth = |condition: bool| f64::from(u8::from(condition));
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => libm::pow(a, b),
            // What is no number must come through and be reported, never be swallowed.
            Self::Minimum => minimum(a, b),
            Self::Maximum => maximum(a, b),
            Self::ArcTangent2 => libm::atan2(a, b),
            Self::Hypotenuse => libm::hypot(a, b),
            Self::Modulo => modulo(a, b),
            Self::Less => truth(a < b),
            Self::LessEqual => truth(a <= b),
            Self::Equal => truth(a == b),
            Self::And => truth(a != 0.0 && b != 0.0),
            Self::Or => truth(a != 0.0 || b != 0.0),
        }
    }
}

/// a - b floor(a / b). A quotient too small for a number is zero whatever its sign: below zero, its floor is -1 nevertheless.
fn modulo(a: f64, b: f64) -> f64 {
    let quotient = a / b;
    let lost = quotient == 0.0 && a != 0.0 && (a < 0.0) != (b < 0.0);
    if lost { a + b } else { a - b * quotient.floor() }
}

impl Reduction {
    /// The value of one group of lanes, which is never empty.
    #[inline]
    pub fn apply(self, lanes: &[f64]) -> f64 {
        match self {
            Self::Sum => sum(lanes.len(), |index| lanes[index]),
            Self::Product => lanes.iter().product(),
            Self::Minimum => lanes.iter().copied().fold(f64::INFINITY, |a, b| Binary::Minimum.apply(a, b)),
            Self::Maximum => lanes.iter().copied().fold(f64::NEG_INFINITY, |a, b| Binary::Maximum.apply(a, b)),
            // Of one number the root of the square, without its loss of digits beyond 1e-154 and 1e154.
            Self::Norm if lanes.len() == 1 => lanes[0].abs(),
            Self::Norm => sum(lanes.len(), |index| lanes[index] * lanes[index]).sqrt(),
            Self::ArgMinimum => place(lanes, |candidate, best| candidate < best),
            Self::ArgMaximum => place(lanes, |candidate, best| candidate > best),
        }
    }
}

/// How many columns a long sum has.
const COLUMNS: usize = 8;

/// The sum of so many numbers: of up to sixteen from the first to the last, of more in eight columns, one number to each in turn,
/// which are added up at the end. Columns do not wait for each other, and less is lost to rounding than in one long chain
/// (Higham, Accuracy and Stability of Numerical Algorithms, 4.2). Everything that sums takes this order, so that bits agree.
#[inline(always)]
pub fn sum(count: usize, number: impl Fn(usize) -> f64) -> f64 {
    if count <= 2 * COLUMNS {
        return chain((0..count).map(number));
    }
    let (mut columns, whole) = ([0.0; COLUMNS], count - count % COLUMNS);
    for row in (0..whole).step_by(COLUMNS) {
        for (place, column) in columns.iter_mut().enumerate() {
            *column += number(row + place);
        }
    }
    for (column, index) in columns.iter_mut().zip(whole..count) {
        *column += number(index);
    }
    chain(columns.into_iter())
}

/// Numbers added from the first to the last. The sum of none is minus zero, to which every number can be added unchanged.
#[inline(always)]
fn chain(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(-0.0, |sum, number| sum + number)
}

fn place(lanes: &[f64], better: impl Fn(f64, f64) -> bool) -> f64 {
    let best = (0..lanes.len()).reduce(|best, next| if better(lanes[next], lanes[best]) { next } else { best });
    best.unwrap_or(0) as f64
}

/// The quaternion w x y z, w >= 0, of the rotation whose columns are `axes` (forward, left, up).
///
/// Shepperd's method: divide by the largest of the four candidates, so that no digit is lost near a half turn.
pub fn quaternion(axes: [f64; 9]) -> [f64; 4] {
    let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = axes;
    let trace = xx + yy + zz;
    let raw = if trace > xx && trace > yy && trace > zz {
        [1.0 + trace, yz - zy, zx - xz, xy - yx]
    } else if xx > yy && xx > zz {
        [yz - zy, 1.0 + xx - yy - zz, xy + yx, zx + xz]
    } else if yy > zz {
        [zx - xz, xy + yx, 1.0 + yy - xx - zz, yz + zy]
    } else {
        [xy - yx, zx + xz, yz + zy, 1.0 + zz - xx - yy]
    };
    let norm = chain(raw.iter().map(|x| x * x)).sqrt() * if raw[0] < 0.0 { -1.0 } else { 1.0 };
    raw.map(|x| x / norm)
}

impl Memory {
    /// Number of cells per lane.
    pub fn cells(self) -> usize {
        match self {
            Self::Delay(steps) => steps as usize,
            _ => 1,
        }
    }

    /// Starts the cells of one lane from the reset snapshot; the result is the value at step 0.
    #[inline]
    pub fn start(self, cells: &mut [f64], inputs: [f64; 3]) -> f64 {
        let [x, second, third] = inputs;
        let _ = second;
        let first = match self {
            Self::Initial | Self::Highest | Self::Lowest | Self::Smooth | Self::Sampled | Self::Delay(_) => x,
            Self::SmoothAngle => wrap(x),
            Self::Accumulate | Self::Streak => 0.0,
            Self::StepsSince => {
                if x != 0.0 {
                    0.0
                } else {
                    f64::INFINITY
                }
            }
            Self::Hysteresis => f64::from(u8::from(x >= third)),
        };
        cells.fill(first);
        first
    }

    /// Advances the cells of one lane by one control step, which is number `step`; the result includes this step.
    #[inline]
    pub fn advance(self, cells: &mut [f64], step: u32, inputs: [f64; 3]) -> f64 {
        let [x, second, third] = inputs;
        if let Self::Delay(steps) = self {
            // A ring: the cell written `steps` steps ago is the one to overwrite now.
            let cell = &mut cells[(step % steps) as usize];
            return std::mem::replace(cell, x);
        }
        let cell = &mut cells[0];
        *cell = match self {
            Self::Initial | Self::Delay(_) => *cell,
            Self::Highest => Binary::Maximum.apply(*cell, x),
            Self::Lowest => Binary::Minimum.apply(*cell, x),
            Self::Accumulate => *cell + x,
            Self::Streak => {
                if x != 0.0 {
                    *cell + 1.0
                } else {
                    0.0
                }
            }
            Self::StepsSince => {
                if x != 0.0 {
                    0.0
                } else {
                    *cell + 1.0
                }
            }
            Self::Hysteresis => {
                if x > third {
                    1.0
                } else if x < second {
                    0.0
                } else {
                    *cell
                }
            }
            Self::Smooth => *cell + second * (x - *cell),
            Self::SmoothAngle => wrap(*cell + second * wrap(x - *cell)),
            Self::Sampled => {
                if second != 0.0 {
                    x
                } else {
                    *cell
                }
            }
        };
        *cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remainder_is_never_below_zero_however_small_the_quotient() {
        assert_eq!(Binary::Modulo.apply(-7.9e-297, 2.2e66), 2.2e66);
        assert_eq!(Binary::Modulo.apply(7.9e-297, 2.2e66), 7.9e-297);
        assert_eq!(Binary::Modulo.apply(-1.0, 4.0), 3.0);
        assert_eq!(Binary::Modulo.apply(0.0, 4.0), 0.0);
    }

    #[test]
    fn a_minimum_lets_a_nan_through_from_either_side() {
        assert!(Binary::Minimum.apply(f64::NAN, 1.0).is_nan());
        assert!(Binary::Minimum.apply(1.0, f64::NAN).is_nan());
        assert!(Binary::Maximum.apply(1.0, f64::NAN).is_nan());
        assert!(Reduction::Maximum.apply(&[0.0, f64::NAN, 2.0]).is_nan());
    }

    #[test]
    fn angles_wrap_into_the_half_open_turn() {
        use std::f64::consts::PI;
        assert_eq!(Unary::Wrap.apply(PI), PI);
        assert!((Unary::Wrap.apply(-PI) - PI).abs() < 1e-15);
        assert!((Unary::Wrap.apply(7.0) - (7.0 - 2.0 * PI)).abs() < 1e-15);
    }

    #[test]
    fn quaternions_of_quarter_and_half_turns() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let turned_left = quaternion([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        for (found, expected) in turned_left.iter().zip([half, 0.0, 0.0, half]) {
            assert!((found - expected).abs() < 1e-15);
        }
        let about_x = quaternion([1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0]);
        assert_eq!(about_x.map(f64::abs), [0.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_smoothed_angle_goes_the_short_way_round() {
        let mut cell = [0.0];
        assert_eq!(Memory::SmoothAngle.start(&mut cell, [3.0, 0.5, 0.0]), 3.0);
        // From 3.0 to -3.0 the short way is 0.283 across the half turn, not 6 through zero.
        let next = Memory::SmoothAngle.advance(&mut cell, 1, [-3.0, 0.5, 0.0]);
        assert!((next.abs() - std::f64::consts::PI).abs() < 1e-12, "{next}");
    }

    #[test]
    fn a_delay_gives_the_value_of_so_many_steps_ago() {
        let mut cells = [0.0; 2];
        let delay = Memory::Delay(2);
        assert_eq!(delay.start(&mut cells, [10.0, 0.0, 0.0]), 10.0);
        let seen: Vec<f64> = (1..=4).map(|step| delay.advance(&mut cells, step, [f64::from(step), 0.0, 0.0])).collect();
        assert_eq!(seen, [10.0, 10.0, 1.0, 2.0]);
    }
}
