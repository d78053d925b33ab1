//! How many operations a step takes, by stage: for the roofline in docs/performance.md.
//!
//! `cargo run --release -p msk-physics --example operations -- [model.xml] [falling|standing|crawling] [steps]`
//!
//! The physics is written over a scalar, so a scalar that counts is all it takes. It carries two episodes, as lanes do, so that the
//! solver is the one of lanes; an operation on both counts once. Contacts that are found lane by lane in
//! plain numbers are not counted.

mod protocol;

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{STAGES, State, Workspace, stepping};
use num_traits::{Num, One, Zero};
use protocol::{Protocol, Random, initial_state};
use std::sync::atomic::{AtomicU64, Ordering};

/// Kinds of operations.
const KINDS: [&str; 5] = ["add", "multiply", "divide", "select", "function"];
const ADD: usize = 0;
const MULTIPLY: usize = 1;
const DIVIDE: usize = 2;
const SELECT: usize = 3;
const FUNCTION: usize = 4;

static COUNTS: [AtomicU64; KINDS.len()] = [const { AtomicU64::new(0) }; KINDS.len()];

fn counts() -> [u64; KINDS.len()] {
    COUNTS.each_ref().map(|count| count.load(Ordering::Relaxed))
}

/// Two numbers that count what is done with them.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Counted([f64; 2]);

impl Counted {
    fn each(self, kind: usize, f: impl Fn(f64) -> f64) -> Self {
        COUNTS[kind].fetch_add(1, Ordering::Relaxed);
        Self(self.0.map(f))
    }

    fn both(self, kind: usize, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        COUNTS[kind].fetch_add(1, Ordering::Relaxed);
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident $sign:tt $kind:ident),*) => {$(
        impl $operator for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.both($kind, other, |a, b| a $sign b)
            }
        }
        impl $assign for Counted {
            fn $assign_method(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    )*};
}
arithmetic!(Add add AddAssign add_assign + ADD, Sub sub SubAssign sub_assign - ADD, Mul mul MulAssign mul_assign * MULTIPLY,
            Div div DivAssign div_assign / DIVIDE, Rem rem RemAssign rem_assign % DIVIDE);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        self.each(SELECT, |a| -a)
    }
}

impl Zero for Counted {
    fn zero() -> Self {
        Self([0.0; 2])
    }
    fn is_zero(&self) -> bool {
        self.0 == [0.0; 2]
    }
}

impl One for Counted {
    fn one() -> Self {
        Self([1.0; 2])
    }
}

impl Num for Counted {
    type FromStrRadixErr = num_traits::ParseFloatError;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::splat)
    }
}

impl Real for Counted {
    type Mask = [bool; 2];
    const LANES: usize = 2;

    fn splat(value: f64) -> Self {
        Self([value; 2])
    }
    fn lane(&self, index: usize) -> f64 {
        self.0[index]
    }
    fn set_lane(&mut self, index: usize, value: f64) {
        self.0[index] = value;
    }
    fn less(self, other: Self) -> [bool; 2] {
        COUNTS[SELECT].fetch_add(1, Ordering::Relaxed);
        [self.0[0] < other.0[0], self.0[1] < other.0[1]]
    }
    fn is_at_most(self, other: Self) -> [bool; 2] {
        COUNTS[SELECT].fetch_add(1, Ordering::Relaxed);
        [self.0[0] <= other.0[0], self.0[1] <= other.0[1]]
    }
    fn mask(holds: impl Fn(usize) -> bool) -> [bool; 2] {
        [holds(0), holds(1)]
    }
    fn holds(mask: [bool; 2], index: usize) -> bool {
        mask[index]
    }
    fn select(mask: [bool; 2], a: Self, b: Self) -> Self {
        COUNTS[SELECT].fetch_add(1, Ordering::Relaxed);
        Self([0, 1].map(|lane| if mask[lane] { a.0[lane] } else { b.0[lane] }))
    }
    fn and(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
        [a[0] & b[0], a[1] & b[1]]
    }
    fn or(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
        [a[0] | b[0], a[1] | b[1]]
    }
    fn not(mask: [bool; 2]) -> [bool; 2] {
        mask.map(|lane| !lane)
    }
    fn any(mask: [bool; 2]) -> bool {
        mask[0] | mask[1]
    }
    fn all(mask: [bool; 2]) -> bool {
        mask[0] & mask[1]
    }
    fn sqrt(self) -> Self {
        self.each(DIVIDE, f64::sqrt)
    }
    fn abs(self) -> Self {
        self.each(SELECT, f64::abs)
    }
    fn sin_cos(self) -> (Self, Self) {
        COUNTS[FUNCTION].fetch_add(1, Ordering::Relaxed);
        let [a, b] = self.0.map(Real::sin_cos);
        (Self([a.0, b.0]), Self([a.1, b.1]))
    }
    fn acos(self) -> Self {
        self.each(FUNCTION, Real::acos)
    }
    fn asin(self) -> Self {
        self.each(FUNCTION, Real::asin)
    }
    fn atan2(self, other: Self) -> Self {
        self.both(FUNCTION, other, Real::atan2)
    }
    fn exp(self) -> Self {
        self.each(FUNCTION, Real::exp)
    }
    fn powf(self, exponent: Self) -> Self {
        self.both(FUNCTION, exponent, Real::powf)
    }
    fn is_finite(self) -> bool {
        self.0.iter().all(|value| value.is_finite())
    }
}

/// Both episodes in the state of one.
fn doubled(model: &Model, one: &State<f64>) -> State<Counted> {
    let mut state = State::new(model);
    let pairs = [(&mut state.position, &one.position), (&mut state.activation, &one.activation)];
    for (to, from) in pairs {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = Counted::splat(*from));
    }
    state
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| arguments.get(index).cloned().unwrap_or_else(|| default.into());
    let model = Model::from_file(argument(0, "bodies/models/human416.xml"))?;
    let protocol = Protocol::named(&argument(1, "falling"));
    let wanted: u64 = argument(2, "1500").parse()?;
    let origin = doubled(&model, &initial_state(&model, protocol)?);
    let mut workspace = Workspace::<Counted>::new(&model);
    let (mut state, mut random) = (origin.clone(), Random(1));
    let mut stages = [[0; KINDS.len()]; STAGES.len()];
    for step in 0..wanted {
        if state.time.lane(0) >= protocol.duration() {
            state.clone_from(&origin);
        }
        if step % 10 == 0 {
            state.control.fill_with(|| Counted([random.unit(), random.unit()]));
        }
        let (mut before, mut stage) = (counts(), 0);
        let mut lap = || {
            let now = counts();
            for (kind, total) in stages[stage].iter_mut().enumerate() {
                *total += now[kind] - before[kind];
            }
            (before, stage) = (now, stage + 1);
        };
        stepping::forward_by_stage(&model, &state, &mut workspace, &mut lap)?;
        stepping::integrate(&model, &mut state, &mut workspace)?;
        lap();
    }
    println!("| operations per step | {} |", KINDS.join(" | "));
    println!("|---|{}", "--:|".repeat(KINDS.len()));
    let mut sums = [0.0; KINDS.len()];
    for (name, totals) in STAGES.iter().zip(stages) {
        let each = totals.map(|total| total as f64 / wanted as f64);
        sums.iter_mut().zip(each).for_each(|(sum, value)| *sum += value);
        println!("| {name} | {} |", each.map(|value| format!("{value:.0}")).join(" | "));
    }
    println!("| all | {} |", sums.map(|value| format!("{value:.0}")).join(" | "));
    let entries = model.dofs.row.last().map_or(0, |row| row.end);
    println!("\n{} dofs, {entries} entries of the mass matrix.", model.nv);
    Ok(())
}
