//! Episodes in lanes: the physics over a pair of numbers gives each lane the bits that it gives the episode alone.

use crate::support;

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};
use msk_physics::model::Model;
use msk_physics::scalar::Real;
use msk_physics::{self as physics, State, Workspace, spatial::Spatial};
use nalgebra::Vector3;
use num_traits::{Num, One, Zero};
use support::{SplitMix, draw, repository};

/// Two episodes in one number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pair([f64; 2]);

impl Pair {
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    fn both(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident $sign:tt),*) => {$(
        impl $operator for Pair {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.both(other, |a, b| a $sign b)
            }
        }
        impl $assign for Pair {
            fn $assign_method(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    )*};
}
arithmetic!(Add add AddAssign add_assign +, Sub sub SubAssign sub_assign -, Mul mul MulAssign mul_assign *,
            Div div DivAssign div_assign /, Rem rem RemAssign rem_assign %);

impl Neg for Pair {
    type Output = Self;
    fn neg(self) -> Self {
        self.each(|a| -a)
    }
}

impl Zero for Pair {
    fn zero() -> Self {
        Self([0.0; 2])
    }
    fn is_zero(&self) -> bool {
        self.0 == [0.0; 2]
    }
}

impl One for Pair {
    fn one() -> Self {
        Self([1.0; 2])
    }
}

impl Num for Pair {
    type FromStrRadixErr = num_traits::ParseFloatError;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::splat)
    }
}

impl Real for Pair {
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
        [self.0[0] < other.0[0], self.0[1] < other.0[1]]
    }
    fn is_at_most(self, other: Self) -> [bool; 2] {
        [self.0[0] <= other.0[0], self.0[1] <= other.0[1]]
    }
    fn mask(holds: impl Fn(usize) -> bool) -> [bool; 2] {
        [holds(0), holds(1)]
    }
    fn holds(mask: [bool; 2], index: usize) -> bool {
        mask[index]
    }
    fn select(mask: [bool; 2], a: Self, b: Self) -> Self {
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
        self.each(f64::sqrt)
    }
    fn abs(self) -> Self {
        self.each(f64::abs)
    }
    fn sin_cos(self) -> (Self, Self) {
        let [a, b] = self.0.map(Real::sin_cos);
        (Self([a.0, b.0]), Self([a.1, b.1]))
    }
    fn acos(self) -> Self {
        self.each(Real::acos)
    }
    fn asin(self) -> Self {
        self.each(Real::asin)
    }
    fn atan2(self, other: Self) -> Self {
        self.both(other, Real::atan2)
    }
    fn exp(self) -> Self {
        self.each(Real::exp)
    }
    fn powf(self, exponent: Self) -> Self {
        self.both(exponent, Real::powf)
    }
    fn is_finite(self) -> bool {
        self.0.iter().all(|value| value.is_finite())
    }
}

/// Two states of one model in lanes.
fn together(model: &Model, states: &[State<f64>; 2]) -> State<Pair> {
    let join = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| Pair([*a, *b])).collect::<Vec<_>>();
    let [a, b] = states;
    let mut paired = State::new(model);
    paired.position = join(&a.position, &b.position);
    paired.velocity = join(&a.velocity, &b.velocity);
    paired.activation = join(&a.activation, &b.activation);
    paired.control = join(&a.control, &b.control);
    paired.applied_force = join(&a.applied_force, &b.applied_force);
    for (body, target) in paired.body_force.iter_mut().enumerate() {
        for (part, target) in target.iter_mut().enumerate() {
            *target = Vector3::from_fn(|row, _| Pair([a.body_force[body][part][row], b.body_force[body][part][row]]));
        }
    }
    paired
}

/// Everything worth comparing, flat.
fn results<T: Real>(workspace: &Workspace<T>) -> Vec<T> {
    let spatial = |vectors: &[Spatial<T>]| vectors.iter().flatten().flatten().copied().collect::<Vec<T>>();
    [
        spatial(&workspace.kinematics.dof_axis),
        spatial(&workspace.velocities.body),
        workspace.inertia.matrix.clone(),
        workspace.tendons.length.clone(),
        workspace.tendons.velocity.clone(),
        workspace.actuation.activation_rate.clone(),
        workspace.actuation.force.clone(),
        workspace.forces.passive.clone(),
        workspace.forces.bias.clone(),
        workspace.forces.actuator.clone(),
        workspace.forces.smooth_acceleration.clone(),
    ]
    .concat()
}

#[test]
fn lanes_give_the_bits_of_single_episodes() {
    for name in ["joints", "muscles", "pulley", "tendon_springs", "wrap_cylinder", "wrap_inside", "wrap_sphere"] {
        let model = Model::from_file(repository("tests/oracle/models").join(format!("{name}.xml"))).expect("the model loads");
        let (mut alone, mut lanes) = (Workspace::<f64>::new(&model), Workspace::<Pair>::new(&model));
        let mut random = SplitMix(17);
        for _ in 0..40 {
            let states = [draw(&model, &mut random), draw(&model, &mut random)];
            physics::smooth::smooth(&model, &together(&model, &states), &mut lanes);
            let paired = results(&lanes);
            for (lane, state) in states.iter().enumerate() {
                physics::smooth(&model, state, &mut alone);
                for (index, (single, pair)) in results(&alone).iter().zip(&paired).enumerate() {
                    assert_eq!(single.to_bits(), pair.lane(lane).to_bits(), "{name}: entry {index} of lane {lane}");
                }
            }
        }
    }
}
