//! Operating ranges of actuators that the file does not give: measured by simulation, as MuJoCo's manual describes it
//! ("Length range").
//!
//! The model is stripped of gravity, contacts, springs, dampers, friction and actuation, so that only joint and tendon
//! limits, couplings and geometry hold it. From the reference configuration the actuator's own direction is pushed, first
//! backwards, then forwards, with a force that causes a given joint-space acceleration, while velocities decay. The lengths
//! seen near the end are the range.

use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{Actuators, Bias, ContactPairs, Dynamics, Gain, Integrator, JointKind, Model, Transmission};
use crate::scalar::Real;
use crate::{State, Workspace, actuation, inertia, smooth};
use nalgebra::Vector3;
use rayon::prelude::*;

/// All measurements together may take this many elementary operations, roughly: a few minutes.
const MOST_WORK: f64 = 2e10;

/// Which actuators are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    None,
    Muscles,
    All,
}

/// The `lengthrange` element.
#[derive(Debug, Clone)]
pub(in crate::model::mjcf) struct LengthRanges {
    mode: Mode,
    use_existing: bool,
    use_limit: bool,
    /// Norm of the joint-space acceleration that the push causes.
    acceleration: f64,
    /// Largest norm of the push, if any.
    most_force: Option<f64>,
    /// Time in which velocities decay, s.
    time_constant: f64,
    /// Time step, s; `None` takes the model's.
    timestep: Option<f64>,
    /// Duration of one push, s.
    total: f64,
    /// The part at its end in which lengths count, s.
    interval: f64,
    /// How far lengths may still change in that part, relative to the range.
    tolerance: f64,
}

impl Default for LengthRanges {
    fn default() -> Self {
        Self {
            mode: Mode::Muscles,
            use_existing: true,
            use_limit: false,
            acceleration: 20.0,
            most_force: None,
            time_constant: 1.0,
            timestep: Some(0.01),
            total: 10.0,
            interval: 2.0,
            tolerance: 0.05,
        }
    }
}

impl LengthRanges {
    /// Applies a `lengthrange` element.
    pub(super) fn update(&mut self, element: &Element) -> Result<(), ModelError> {
        self.mode = match element.keyword("mode", &["none", "muscle", "muscleuser", "all"])? {
            Some(0) => Mode::None,
            // There are no actuators with a `user` law: those are refused.
            Some(1 | 2) => Mode::Muscles,
            Some(_) => Mode::All,
            None => self.mode,
        };
        self.use_existing = element.flag("useexisting")?.unwrap_or(self.use_existing);
        self.use_limit = element.flag("uselimit")?.unwrap_or(self.use_limit);
        self.acceleration = element.size_or("accel", self.acceleration)?;
        self.most_force = Some(element.size_or("maxforce", self.most_force.unwrap_or(0.0))?).filter(|force| *force > 0.0);
        self.time_constant = element.size_or("timeconst", self.time_constant)?;
        self.timestep = Some(element.size_or("timestep", self.timestep.unwrap_or(0.0))?).filter(|step| *step > 0.0);
        self.total = element.size_or("inttotal", self.total)?;
        self.interval = element.size_or("interval", self.interval)?;
        self.tolerance = element.size_or("tolrange", self.tolerance)?;
        Ok(())
    }

    /// Fills in the ranges that are missing. `actuators` are their elements, for messages.
    pub(super) fn complete(&self, model: &mut Model, actuators: &[&Element]) -> Result<(), ModelError> {
        let mut measured = Vec::new();
        for (actuator, element) in actuators.iter().enumerate() {
            let muscular = is_muscular(model, actuator);
            let wanted = self.mode == Mode::All || self.mode == Mode::Muscles && muscular;
            let given = ascending(model.actuators.length_range[actuator]);
            if !wanted || given && self.use_existing {
                if muscular && !given {
                    return Err(element.invalid(
                        "a muscle needs a `lengthrange` of two lengths in ascending order; with `lengthrange` `mode` none it \
                         is not computed",
                    ));
                }
            } else if let Some(limits) = self.limits(model, actuator) {
                model.actuators.length_range[actuator] = limits;
            } else {
                measured.push(actuator);
            }
        }
        let (Some(first), false) = (measured.first(), measured.is_empty()) else { return Ok(()) };
        let stripped = self.stripped(model);
        let steps = 2.0 * (self.total / stripped.options.timestep) * measured.len() as f64;
        let size = stripped.dofs.column.len() + stripped.tendons.path_points.len() + 10 * stripped.bodies.name.len();
        if steps * size as f64 > MOST_WORK {
            return Err(actuators[*first].invalid(format!(
                "computing the length ranges of {} actuators needs too many steps: write `lengthrange` into the file, or give \
                 the compiler's `lengthrange` a smaller `inttotal` or a larger `timestep`",
                measured.len()
            )));
        }
        let measure = |&actuator: &usize| {
            let mut alone = stripped.clone();
            alone.actuators = silent(&model.actuators, actuator);
            self.measure(&alone).map_err(|reason| {
                actuators[actuator].invalid(format!(
                    "the length range of the actuator `{}` cannot be computed: {reason}; write `lengthrange` into the file, or \
                     limit the joints that it crosses",
                    model.actuators.name[actuator]
                ))
            })
        };
        let ranges: Vec<_> = measured.par_iter().map(measure).collect();
        for (actuator, range) in measured.into_iter().zip(ranges) {
            model.actuators.length_range[actuator] = range?;
        }
        Ok(())
    }

    /// The limits of what the actuator acts on, if they are to be used.
    fn limits(&self, model: &Model, actuator: usize) -> Option<[f64; 2]> {
        let limits = match model.actuators.transmission[actuator] {
            Transmission::Joint(joint) | Transmission::JointInParent(joint) => {
                let scalar = matches!(model.joints.kind[joint], JointKind::Hinge | JointKind::Slide);
                model.joints.range[joint].filter(|_| scalar)
            }
            Transmission::Tendon(tendon) => model.tendons.range[tendon],
            Transmission::Site { .. } | Transmission::Body(_) => None,
        };
        limits.filter(|_| self.use_limit)
    }

    /// The model without what does not limit lengths, and without actuators.
    fn stripped(&self, model: &Model) -> Model {
        let mut stripped = Model { actuators: Actuators::default(), na: 0, pairs: ContactPairs::default(), ..model.clone() };
        let options = &mut stripped.options;
        options.gravity = Vector3::zeros();
        options.timestep = self.timestep.unwrap_or(options.timestep);
        if options.integrator == Integrator::RungeKutta {
            options.integrator = Integrator::Euler;
        }
        for bits in [&mut stripped.geoms.contact_type, &mut stripped.geoms.contact_affinity] {
            bits.fill(0);
        }
        let zeroed = [
            &mut stripped.joints.stiffness,
            &mut stripped.dofs.damping,
            &mut stripped.dofs.friction_loss,
            &mut stripped.tendons.stiffness,
            &mut stripped.tendons.damping,
            &mut stripped.tendons.friction_loss,
        ];
        zeroed.into_iter().for_each(|values| values.fill(0.0));
        stripped
    }

    /// The range of the only actuator of a stripped model; else why it has none.
    fn measure(&self, model: &Model) -> Result<[f64; 2], String> {
        let low = self.push(model, -1.0)?;
        let high = self.push(model, 1.0)?;
        let range = [low[0], high[1]];
        if !ascending(range) {
            return Err(format!("its length goes from {} to {}", range[0], range[1]));
        }
        let unsettled = [low, high].iter().map(|[least, most]| most - least).fold(0.0, Real::at_least);
        if unsettled > self.tolerance * (range[1] - range[0]) {
            return Err(format!("its length still changes by {unsettled} after {} s", self.total));
        }
        Ok(range)
    }

    /// Least and greatest length at the end of a push in one direction.
    fn push(&self, model: &Model, sign: f64) -> Result<[f64; 2], String> {
        const LEAST: f64 = 1e-15;
        let mut state = State::<f64>::new(model);
        let mut workspace = Workspace::new(model);
        let mut row = vec![0.0; model.nv];
        let mut lengths = None::<[f64; 2]>;
        // A shorter time constant would stop the motion at once.
        let decay = libm::exp(-model.options.timestep / self.time_constant.at_least(0.01));
        while state.time < self.total {
            state.velocity.iter_mut().for_each(|velocity| *velocity *= decay);
            smooth::forward_position(model, &state, &mut workspace);
            actuation::moment(model, &state, &workspace.kinematics, &workspace.tendons, 0, &mut row);
            state.applied_force.copy_from_slice(&row);
            inertia::factorize(model, &mut workspace.inertia);
            inertia::solve(model, &workspace.inertia.factor, &mut row);
            let scale = sign * self.acceleration / norm(&row).at_least(LEAST);
            state.applied_force.iter_mut().for_each(|force| *force *= scale);
            let force = norm(&state.applied_force);
            if let Some(most) = self.most_force.filter(|most| force > *most) {
                state.applied_force.iter_mut().for_each(|entry| *entry *= most / force);
            }
            crate::step(model, &mut state, &mut workspace).map_err(|fault| fault.to_string())?;
            if state.time > self.total - self.interval {
                let length = workspace.actuation.length[0];
                let [least, most] = lengths.unwrap_or([length; 2]);
                lengths = Some([least.at_most(length), most.at_least(length)]);
            }
        }
        lengths.ok_or_else(|| "`inttotal` and `interval` leave no time to measure".to_owned())
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

fn ascending([low, high]: [f64; 2]) -> bool {
    low < high
}

/// Whether the actuator's force depends on its length range.
fn is_muscular(model: &Model, actuator: usize) -> bool {
    let actuators = &model.actuators;
    matches!(actuators.gain[actuator], Gain::Muscle(_)) || matches!(actuators.bias[actuator], Bias::Muscle(_))
}

/// One of the actuators alone, and without force.
fn silent(all: &Actuators, actuator: usize) -> Actuators {
    Actuators {
        name: vec![all.name[actuator].clone()],
        transmission: vec![all.transmission[actuator]],
        gear: vec![all.gear[actuator]],
        dynamics: vec![Dynamics::None],
        gain: vec![Gain::Fixed(0.0)],
        bias: vec![Bias::None],
        activation: vec![None],
        actearly: vec![false],
        control_range: vec![None],
        force_range: vec![None],
        activation_range: vec![None],
        length_range: vec![[0.0; 2]],
        acceleration_scale: vec![0.0],
    }
}
