//! Actuators: lengths, activations, forces.
//!
//! 1. `muscle`: activation dynamics and the force-length-velocity curves;
//! 2. `law`: gains, biases and dynamics of motors and servos;
//! 3. `transmission`: joints, sites and bodies in contact as targets;
//! 4. here: what is planned once per model, and one step of all actuators.
//!
//! Plain muscles (muscular in all three parts, on a tendon, nothing clamped but the control) have a loop of their own: a
//! body has hundreds of them, and they need no Jacobian. All others go through the general law, in MuJoCo's order: control
//! clamped, activation rate, gain and bias, force clamped, joint force with gravity compensation, joint force clamped.

mod law;
mod muscle;
mod transmission;

use super::{
    constrained::ConstraintState,
    elastic::{self, Fibres, Paths},
    integrator::keep_where,
    kinematics::Kinematics,
    spatial::{Spatial, spatial_zero},
    state::State,
    tendons::{self, TendonPaths},
};
use crate::{
    batch::one_lane,
    model::{Model, Transmission},
    scalar::Real,
};
use core::ops::Range;
use law::Law;
pub(super) use muscle::Curve;
pub use muscle::activation_rate;
use std::sync::Arc;
use transmission::Moments;

/// One entry per actuator, in the model's order, but for the rates.
#[derive(Debug, Clone)]
pub struct Actuation<T: Real> {
    /// Length times gear, m or rad (`actuator_length`).
    pub length: Vec<T>,
    /// Its rate, m/s or rad/s (`actuator_velocity`).
    pub velocity: Vec<T>,
    /// Rate of each activation, 1/s (`act_dot`).
    pub activation_rate: Vec<T>,
    /// What the drive is multiplied with: for a muscle the active force at full activation, N; negative pulls.
    pub gain: Vec<T>,
    /// What is added: for a muscle the passive force, N; negative pulls.
    pub bias: Vec<T>,
    /// Force, N or N m (`actuator_force`); negative pulls.
    pub force: Vec<T>,
    /// Fibres of the muscles, where tendons are elastic.
    pub fibres: Option<Fibres<T>>,
    moments: Moments<T>,
    plan: Arc<Plan>,
}

one_lane!(Actuation {
    length, velocity, activation_rate, gain, bias, force, fibres, moments; but plan
});

/// What follows from the model alone.
#[derive(Debug)]
pub(crate) struct Plan {
    muscles: Vec<PlainMuscle>,
    /// For each actuator its place among these, if it is one.
    place: Vec<Option<usize>>,
    others: Vec<Other>,
    /// Whether some other is on a tendon.
    pulls: bool,
    /// Dofs whose actuator force is clamped, or takes gravity compensation.
    clamped: Vec<(usize, [f64; 2])>,
    compensated: Vec<usize>,
    /// Dofs and sides of the moments of all others.
    sides: Arc<[(usize, f64)]>,
    /// The fibres of plain muscles, where tendons are elastic.
    fibres: Option<Arc<[elastic::Unit]>>,
}

#[derive(Debug)]
struct PlainMuscle {
    actuator: usize,
    activation: usize,
    tendon: usize,
    gear: f64,
    control_range: Option<[f64; 2]>,
    time_constants: [f64; 3],
    active: Curve,
    passive: Curve,
}

#[derive(Debug)]
struct Other {
    actuator: usize,
    activation: Option<usize>,
    tendon: Option<usize>,
    /// The only dof that it moves, if there is one.
    dof: Option<usize>,
    gear: f64,
    control_range: Option<[f64; 2]>,
    force_range: Option<[f64; 2]>,
    actearly: bool,
    law: Law,
    /// Its entries among the moments.
    moment: Range<usize>,
}

impl<T: Real> Actuation<T> {
    /// Memory for `model`, and constants that follow from it.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Arc::new(Plan::new(model)))
    }

    pub(crate) fn of(model: &Model, plan: &Arc<Plan>) -> Self {
        let zeros = vec![T::splat(0.0); model.actuators.name.len()];
        Self {
            length: zeros.clone(),
            velocity: zeros.clone(),
            activation_rate: vec![T::splat(0.0); model.na],
            gain: zeros.clone(),
            bias: zeros.clone(),
            force: zeros,
            fibres: plan.fibres.as_ref().map(|units| Fibres::of(model.actuators.name.len(), units)),
            moments: Moments::of(&plan.sides),
            plan: Arc::clone(plan),
        }
    }

    /// How much the pull of the muscle `actuator` at full activation weakens per velocity of shortening, N s/m: the slope of
    /// its force-velocity curve at the present length and velocity, never negative; zero for what is no muscle. On request.
    #[inline(always)]
    pub fn active_damping(&self, state: &State<T>, actuator: usize) -> T {
        let (length, velocity) = (self.length[actuator], self.velocity[actuator]);
        self.curve(actuator).map_or(T::splat(0.0), |active| state.strength[actuator] * active.damping(length, velocity))
    }

    /// Whether all actuators are muscles without bounds of their own: nothing but their activations outlives a step.
    pub(super) fn are_muscles(&self) -> bool {
        self.plan.others.is_empty()
    }

    #[inline(always)]
    fn curve(&self, actuator: usize) -> Option<&Curve> {
        Some(&self.plan.muscles[self.plan.place[actuator]?].active)
    }

    /// Peak isometric force of the muscle `actuator`, N; zero for what is no muscle.
    pub fn peak_force(&self, actuator: usize) -> f64 {
        self.curve(actuator).map_or(0.0, Curve::peak)
    }

    /// Active force at full activation of the muscle `actuator` if its fibre kept its present length, N, never negative; zero for what is
    /// no muscle. On request.
    #[inline(always)]
    pub fn isometric_force(&self, state: &State<T>, actuator: usize) -> T {
        let path = self.fibre_length(actuator) + T::splat(self.lengths(actuator).1);
        let force = |active: &Curve| active.gain(path, T::splat(0.0)) * state.strength[actuator];
        self.curve(actuator).map_or(T::splat(0.0), force)
    }

    /// Optimal fibre length and tendon slack length of the muscle `actuator`, m, as its operating range has them; zero for
    /// what is no muscle.
    pub fn lengths(&self, actuator: usize) -> (f64, f64) {
        self.curve(actuator).map_or((0.0, 0.0), Curve::lengths)
    }

    /// Length of the fibre of a muscle, m: the state of an elastic muscle, the path less the tendon's length in a rigid one.
    #[inline(always)]
    pub fn fibre_length(&self, actuator: usize) -> T {
        match &self.fibres {
            Some(fibres) => fibres.length[actuator],
            None => self.length[actuator] - T::splat(self.lengths(actuator).1),
        }
    }

    /// Rate at which the fibre of a muscle lengthens, m/s.
    pub fn fibre_velocity(&self, actuator: usize) -> T {
        self.fibres.as_ref().map_or(self.velocity[actuator], |fibres| fibres.velocity[actuator])
    }

    /// Length of the tendon of a muscle, m: the path less the fibre along it. It is constant in a rigid muscle, and negative
    /// where the operating range of a path puts the tendon's length below zero.
    pub fn tendon_length(&self, actuator: usize) -> T {
        match &self.fibres {
            Some(fibres) => self.length[actuator] - fibres.along_path[actuator],
            None => T::splat(self.lengths(actuator).1),
        }
    }

    /// Writes the row of `actuator_moment` of an actuator on a body, as the last update found its contacts; whether it is one.
    pub fn contact_moment(&self, model: &Model, actuator: usize, row: &mut [T]) -> bool {
        let on_body = matches!(model.actuators.transmission[actuator], Transmission::Body(_));
        for other in self.plan.others.iter().filter(|other| on_body && other.actuator == actuator) {
            self.moments.entries(other.moment.clone()).for_each(|(dof, entry)| row[dof] = entry);
        }
        on_body
    }

    /// Hands the fibres of the present positions to `state`, which is to move on from these by `step` seconds.
    #[inline(always)]
    pub(super) fn keep_fibres(&self, state: &mut State<T>, step: f64, lives: T::Mask) {
        if let Some(fibres) = &self.fibres {
            keep_where(lives, &mut state.fibre_length, &fibres.length);
            keep_where(lives, &mut state.fibre_velocity, &fibres.velocity);
            state.fibre_step = T::select(lives, T::splat(step), state.fibre_step);
        }
    }
}

impl Plan {
    pub fn new(model: &Model) -> Self {
        let actuators = &model.actuators;
        let mut sides: Vec<(usize, f64)> = Vec::new();
        let mut plan = Self {
            muscles: Vec::new(),
            place: vec![None; actuators.name.len()],
            others: Vec::new(),
            pulls: false,
            clamped: Vec::new(),
            compensated: Vec::new(),
            sides: Arc::new([]),
            fibres: None,
        };
        for actuator in 0..actuators.name.len() {
            let (length_range, scale) = (actuators.length_range[actuator], actuators.acceleration_scale[actuator]);
            let unclamped = actuators.force_range[actuator].is_none() && actuators.activation_range[actuator].is_none();
            if let Some(muscle) = actuators.muscle(actuator).filter(|_| unclamped && !actuators.actearly[actuator]) {
                plan.place[actuator] = Some(plan.muscles.len());
                plan.muscles.push(PlainMuscle {
                    actuator,
                    activation: muscle.activation,
                    tendon: muscle.tendon,
                    gear: muscle.gear,
                    control_range: actuators.control_range[actuator],
                    time_constants: muscle.time_constants,
                    active: Curve::new(&muscle.active, length_range, scale),
                    passive: Curve::new(&muscle.passive, length_range, scale),
                });
                continue;
            }
            let tendon = match actuators.transmission[actuator] {
                Transmission::Tendon(tendon) => Some(tendon),
                _ => None,
            };
            plan.pulls |= tendon.is_some();
            let moved = transmission::entries(model, actuators.transmission[actuator]);
            let dof = match moved[..] {
                [(dof, _)] => Some(dof),
                _ => None,
            };
            plan.others.push(Other {
                actuator,
                activation: actuators.activation[actuator],
                tendon,
                dof,
                gear: actuators.gear[actuator][0],
                control_range: actuators.control_range[actuator],
                force_range: actuators.force_range[actuator],
                actearly: actuators.actearly[actuator],
                law: Law::new(model, actuator),
                moment: sides.len()..sides.len() + moved.len(),
            });
            sides.extend(moved);
        }
        for (joint, range) in model.joints.actuator_force_range.iter().enumerate() {
            plan.clamped.extend(range.map(|range| (model.joints.dof_address[joint], range)));
        }
        plan.sides = sides.into();
        plan.fibres = plan.fibres(model);
        plan.compensated = (0..model.nv).filter(|&dof| model.joints.actuator_compensates[model.dofs.joint[dof]]).collect();
        plan
    }

    /// The fibres of plain muscles; `None` where tendons are rigid.
    fn fibres(&self, model: &Model) -> Option<Arc<[elastic::Unit]>> {
        let settings = model.elastic_tendons.as_ref()?;
        let muscles = self.muscles.iter();
        let muscles = muscles.map(|muscle| ([muscle.actuator, muscle.activation], [&muscle.active, &muscle.passive]));
        Some(elastic::units(model, settings, muscles))
    }
}

/// Fills lengths, velocities, activation rates and forces.
#[inline(always)]
pub fn update<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    tendons: &TendonPaths<T>,
    lanes: &[ConstraintState],
    out: &mut Actuation<T>,
) {
    let plan = Arc::clone(&out.plan);
    // The force of a fibre with an elastic tendon comes from the tendon, below.
    let rigid = out.fibres.is_none();
    for muscle in &plan.muscles {
        let gear = T::splat(muscle.gear);
        let (length, velocity) = (tendons.length[muscle.tendon] * gear, tendons.velocity[muscle.tendon] * gear);
        let activation = state.activation[muscle.activation];
        let excitation = clamped(state.control[muscle.actuator], muscle.control_range);
        out.length[muscle.actuator] = length;
        out.velocity[muscle.actuator] = velocity;
        out.activation_rate[muscle.activation] = activation_rate(excitation, activation, &muscle.time_constants);
        if rigid {
            let gain = -muscle.active.gain(length, velocity) * state.strength[muscle.actuator];
            let bias = -muscle.passive.passive(length);
            out.gain[muscle.actuator] = gain;
            out.bias[muscle.actuator] = bias;
            out.force[muscle.actuator] = gain * activation + bias;
        }
    }
    for other in &plan.others {
        let [length, velocity] = match other.tendon {
            Some(tendon) => [tendons.length[tendon], tendons.velocity[tendon]].map(|value| value * T::splat(other.gear)),
            None => out.moments.update(model, state, kinematics, lanes, other.actuator, other.moment.clone()),
        };
        let [gain, bias, force] = other.forces(model, state, length, velocity, &mut out.activation_rate);
        out.length[other.actuator] = length;
        out.velocity[other.actuator] = velocity;
        out.gain[other.actuator] = gain;
        out.bias[other.actuator] = bias;
        out.force[other.actuator] = clamped(force, other.force_range);
    }
    let Actuation { length, velocity, gain, bias, force, fibres, .. } = out;
    if let Some(fibres) = fibres {
        fibres.update(state, Paths { length, velocity, gain, bias, force });
    }
}

/// Fills the activation rates alone: all that a new control changes where [`Actuators::act_by_activation`] holds.
///
/// [`Actuators::act_by_activation`]: crate::model::Actuators::act_by_activation
#[inline(always)]
pub(super) fn update_rates<T: Real>(state: &State<T>, out: &mut Actuation<T>) {
    for muscle in &out.plan.muscles {
        let excitation = clamped(state.control[muscle.actuator], muscle.control_range);
        let activation = state.activation[muscle.activation];
        out.activation_rate[muscle.activation] = activation_rate(excitation, activation, &muscle.time_constants);
    }
    for other in &out.plan.others {
        other.excite(state, &mut out.activation_rate);
    }
}

impl Other {
    /// Gain, bias and the force before it is clamped; sets the rate of the activation, if there is one.
    fn forces<T: Real>(&self, model: &Model, state: &State<T>, length: T, velocity: T, rates: &mut [T]) -> [T; 3] {
        self.excite(state, rates);
        let drive = self.present_drive(model, state, rates, length);
        self.law.force(drive, state.strength[self.actuator], length, velocity)
    }

    /// Sets the rate of the activation, if there is one.
    fn excite<T: Real>(&self, state: &State<T>, rates: &mut [T]) {
        if let Some(slot) = self.activation {
            let control = clamped(state.control[self.actuator], self.control_range);
            rates[slot] = self.law.rate(control, state.activation[slot]);
        }
    }

    /// The control, or the activation, early or not, under rates that are known.
    fn present_drive<T: Real>(&self, model: &Model, state: &State<T>, rates: &[T], length: T) -> T {
        let Some(slot) = self.activation else { return clamped(state.control[self.actuator], self.control_range) };
        let activation = state.activation[slot];
        if self.actearly { self.law.next(activation, rates[slot], length, model.options.timestep) } else { activation }
    }
}

/// Generalised force of all actuators (`qfrc_actuator`): pulls at bodies gathered and swept up the tree, pushes at joints.
/// `compensation` is the generalised force that balances gravity, for the joints whose actuators provide it.
#[inline(always)]
pub fn generalised_force<T: Real>(
    model: &Model,
    kinematics: &Kinematics<T>,
    tendons: &TendonPaths<T>,
    actuation: &Actuation<T>,
    compensation: &[T],
    body_force: &mut [Spatial<T>],
    out: &mut [T],
) {
    let plan = &actuation.plan;
    if plan.muscles.is_empty() && !plan.pulls {
        out.fill(T::splat(0.0));
    } else {
        body_force.fill(spatial_zero());
        for muscle in &plan.muscles {
            tendons.pull(muscle.tendon, actuation.force[muscle.actuator] * T::splat(muscle.gear), body_force);
        }
        for other in &plan.others {
            if let Some(tendon) = other.tendon {
                tendons.pull(tendon, actuation.force[other.actuator] * T::splat(other.gear), body_force);
            }
        }
        super::forces::gather(model, kinematics, body_force, out);
        if tendons.any_fixed() {
            let muscles = plan.muscles.iter().map(|muscle| (muscle.actuator, muscle.tendon, muscle.gear));
            let others = plan.others.iter().filter_map(|other| Some((other.actuator, other.tendon?, other.gear)));
            for (actuator, tendon, gear) in muscles.chain(others) {
                tendons.pull_joints(tendon, actuation.force[actuator] * T::splat(gear), out);
            }
        }
    }
    for other in &plan.others {
        for (dof, moment) in actuation.moments.entries(other.moment.clone()) {
            out[dof] += moment * actuation.force[other.actuator];
        }
    }
    for &dof in &plan.compensated {
        out[dof] += compensation[dof];
    }
    for &(dof, range) in &plan.clamped {
        out[dof] = clamped(out[dof], Some(range));
    }
}

/// Advances the activations of the lanes of the mask by `step` seconds at the given rates, clamped to their ranges.
#[inline(always)]
pub fn advance<T: Real>(actuation: &Actuation<T>, rates: &[T], step: f64, lives: T::Mask, activations: &mut [T]) {
    for muscle in &actuation.plan.muscles {
        let slot = muscle.activation;
        activations[slot] = T::select(lives, muscle.advanced(rates, step, activations), activations[slot]);
    }
    for other in &actuation.plan.others {
        if let Some(slot) = other.activation {
            let after = other.advanced(slot, actuation, rates, step, activations);
            activations[slot] = T::select(lives, after, activations[slot]);
        }
    }
}

/// Actuators with the activations that [`advance`] would give them.
#[inline(always)]
pub(super) fn advanced<'a, T: Real>(
    actuation: &'a Actuation<T>,
    rates: &'a [T],
    step: f64,
    activations: &'a [T],
) -> impl Iterator<Item = (usize, T)> + Clone + 'a {
    let muscles = actuation.plan.muscles.iter();
    let muscles = muscles.map(move |muscle| (muscle.actuator, muscle.advanced(rates, step, activations)));
    let others =
        actuation.plan.others.iter().filter_map(move |other| {
            Some((other.actuator, other.advanced(other.activation?, actuation, rates, step, activations)))
        });
    muscles.chain(others)
}

impl PlainMuscle {
    #[inline(always)]
    fn advanced<T: Real>(&self, rates: &[T], step: f64, activations: &[T]) -> T {
        activations[self.activation] + T::splat(step) * rates[self.activation]
    }
}

impl Other {
    #[inline(always)]
    fn advanced<T: Real>(&self, slot: usize, actuation: &Actuation<T>, rates: &[T], step: f64, activations: &[T]) -> T {
        self.law.next(activations[slot], rates[slot], actuation.length[self.actuator], step)
    }
}

/// Calls `add` with the moment and the slope of the force over velocity (N s/m) of every actuator that has one. An actuator
/// whose force, or the force of whose joint, is clamped has none. `row` (`nv` entries) is scratch.
pub(super) fn each_slope<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    tendons: &TendonPaths<T>,
    actuation: &Actuation<T>,
    joint_force: &[T],
    row: &mut [T],
    mut add: impl FnMut(&[T], T),
) {
    let zero = T::splat(0.0);
    let plan = &actuation.plan;
    let inside = |value: T, [low, high]: [f64; 2]| T::and(T::splat(low).less(value), value.less(T::splat(high)));
    // The pull of a fibre with an elastic tendon follows from positions alone.
    for muscle in plan.muscles.iter().filter(|_| actuation.fibres.is_none()) {
        let (length, velocity) = (actuation.length[muscle.actuator], actuation.velocity[muscle.actuator]);
        let drive = state.activation[muscle.activation] * state.strength[muscle.actuator];
        let slope = -drive * muscle.active.damping(length, velocity);
        if slope != zero {
            moment(model, state, kinematics, tendons, muscle.actuator, row);
            add(row, slope);
        }
    }
    for other in &plan.others {
        let (length, velocity) = (actuation.length[other.actuator], actuation.velocity[other.actuator]);
        let drive = other.present_drive(model, state, &actuation.activation_rate, length);
        let mut slope = other.law.damping(drive, state.strength[other.actuator], length, velocity);
        if let Some(range) = other.force_range {
            slope = T::select(inside(actuation.force[other.actuator], range), slope, zero);
        }
        for &(dof, range) in plan.clamped.iter().filter(|(dof, _)| other.dof == Some(*dof)) {
            slope = T::select(inside(joint_force[dof], range), slope, zero);
        }
        if slope == zero {
            continue;
        }
        if other.tendon.is_some() {
            moment(model, state, kinematics, tendons, other.actuator, row);
        } else {
            row.fill(zero);
            actuation.moments.entries(other.moment.clone()).for_each(|(dof, entry)| row[dof] = entry);
        }
        add(row, slope);
    }
}

/// Writes into `row` (`nv` entries) how the length of `actuator` changes with every dof: its row of `actuator_moment`. On
/// request only. Without contacts, which an actuator on a body acts on: [`Actuation::contact_moment`] has these.
pub fn moment<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    tendons: &TendonPaths<T>,
    actuator: usize,
    row: &mut [T],
) {
    if let Transmission::Tendon(tendon) = model.actuators.transmission[actuator] {
        tendons::moment_arms(model, kinematics, tendons, tendon, row);
        let gear = T::splat(model.actuators.gear[actuator][0]);
        row.iter_mut().for_each(|arm| *arm *= gear);
        return;
    }
    row.fill(T::splat(0.0));
    let sides = transmission::entries(model, model.actuators.transmission[actuator]);
    let mut values = vec![T::splat(0.0); sides.len()];
    transmission::measure(model, state, kinematics, &[], actuator, &sides, &mut values);
    for (&(dof, _), value) in sides.iter().zip(values) {
        row[dof] = value;
    }
}

#[inline(always)]
fn clamped<T: Real>(value: T, range: Option<[f64; 2]>) -> T {
    match range {
        Some([low, high]) => value.at_least(T::splat(low)).at_most(T::splat(high)),
        None => value,
    }
}
