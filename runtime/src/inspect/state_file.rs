//! A state as it stands in a file.

use msk_physics::State;
use msk_physics::model::Model;
use msk_physics::overrides::{Overrides, ShapeOverrides};
use msk_program::numbers::exact;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A state with MuJoCo's names. What is absent takes the value of the reference configuration at rest.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StateFile {
    /// Simulated time, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Generalised positions, `nq`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub qpos: Option<Vec<f64>>,
    /// Generalised velocities, `nv`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub qvel: Option<Vec<f64>>,
    /// Muscle activations, `na`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub act: Option<Vec<f64>>,
    /// Muscle excitations, `nu`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ctrl: Option<Vec<f64>>,
    /// For each equality whether it holds, `neq`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eq_active: Option<Vec<bool>>,
    /// Fibre lengths of muscles with elastic tendons, one per muscle, m; absent, they begin in balance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fibre_length: Option<Vec<f64>>,
    /// Their rates, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fibre_velocity: Option<Vec<f64>>,
    /// Generalised forces from outside, `nv`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub qfrc_applied: Option<Vec<f64>>,
    /// Force and torque on each body from outside, `nbody` times 6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub xfrc_applied: Option<Vec<f64>>,
    /// Positions of the bodies that are placed from outside, three numbers each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mocap_pos: Option<Vec<f64>>,
    /// Their orientations, four numbers each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mocap_quat: Option<Vec<f64>>,
    /// Their angular and linear velocities, six numbers each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mocap_vel: Option<Vec<f64>>,
    /// Factor of the active force of each muscle, `nu`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength: Option<Vec<f64>>,
    /// Factor of mass and inertia of each body, `nbody`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_scale: Option<Vec<f64>>,
    /// Sliding friction of each geom, `ngeom`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<Vec<f64>>,
    /// Damping of each dof, `nv`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping: Option<Vec<f64>>,
    /// Stiffness of the spring of each joint, `njnt`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<Vec<f64>>,
    /// Shapes that are not those of the model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shapes: Option<ShapeOverrides>,
    /// Acceleration that the solver starts from, `nv`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub qacc_warmstart: Option<Vec<f64>>,
}

/// Why a state does not belong to a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StateError {
    /// An array has the wrong length.
    #[error("`{name}` has {found} numbers; the model needs {expected}")]
    Length {
        /// The array.
        name: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A factor or coefficient that no body can have.
    #[error("`{name}` has {} at {index}: {wanted}", exact(*.value))]
    Value {
        /// The array.
        name: &'static str,
        /// What it has.
        value: f64,
        /// Where.
        index: usize,
        /// What it should be.
        wanted: &'static str,
    },
    /// Shapes of another model.
    #[error("`shapes` are not those of the model: each has a geom of a body that can move, of the same kind, and a finite size")]
    Shapes,
    /// Nothing turns this way: the quaternion of a free or ball joint is zero.
    #[error("the quaternion of joint `{joint}` in `qpos` is zero")]
    Quaternion {
        /// The joint.
        joint: String,
    },
}

impl StateFile {
    /// What has to be written of a state of a model to draw it or to look into it; outside forces are left out.
    pub fn of(model: &Model, state: &State<f64>) -> Self {
        let differ = |own: &[f64], usual: f64| own.iter().any(|value| *value != usual).then(|| own.to_vec());
        let rough = state.friction.iter().zip(&model.geoms.friction).any(|(own, usual)| *own != usual[0]);
        let placed = !state.mocap_position.is_empty();
        let unlike = |own: &Vec<f64>, usual: &Vec<f64>| (own != usual).then(|| own.clone());
        Self {
            time: Some(state.time),
            qpos: Some(state.position.clone()),
            qvel: Some(state.velocity.clone()),
            act: Some(state.activation.clone()),
            ctrl: Some(state.control.clone()),
            mocap_pos: placed.then(|| state.mocap_position.iter().flatten().copied().collect()),
            mocap_quat: placed.then(|| state.mocap_orientation.concat()),
            mocap_vel: placed.then(|| state.mocap_velocity.iter().flatten().flatten().copied().collect()),
            eq_active: Some(state.active.iter().map(|active| *active != 0.0).collect()),
            fibre_length: Some(state.fibre_length.clone()).filter(|fibres| !fibres.is_empty()),
            fibre_velocity: Some(state.fibre_velocity.clone()).filter(|fibres| !fibres.is_empty()),
            qacc_warmstart: Some(state.warm_start.clone()),
            strength: differ(&state.strength, 1.0),
            mass_scale: differ(&state.mass_scale, 1.0),
            friction: rough.then(|| state.friction.clone()),
            damping: unlike(&state.damping, &model.dofs.damping),
            stiffness: unlike(&state.stiffness, &model.joints.stiffness),
            shapes: state.overrides.lane(0).cloned(),
            ..Self::default()
        }
    }

    /// The state for a model.
    ///
    /// # Errors
    ///
    /// An array of the wrong length, a quaternion without direction, a mass that is not positive, a negative strength or friction.
    pub fn state(&self, model: &Model) -> Result<State<f64>, StateError> {
        let mut state = State::new(model);
        state.time = self.time.unwrap_or(state.time);
        take("qpos", &self.qpos, &mut state.position)?;
        take("qvel", &self.qvel, &mut state.velocity)?;
        take("act", &self.act, &mut state.activation)?;
        take("ctrl", &self.ctrl, &mut state.control)?;
        let active = self.eq_active.as_ref().map(|active| active.iter().map(|&active| f64::from(u8::from(active))).collect());
        take("eq_active", &active, &mut state.active)?;
        take("fibre_length", &self.fibre_length, &mut state.fibre_length)?;
        take("fibre_velocity", &self.fibre_velocity, &mut state.fibre_velocity)?;
        take("qfrc_applied", &self.qfrc_applied, &mut state.applied_force)?;
        take("qacc_warmstart", &self.qacc_warmstart, &mut state.warm_start)?;
        take("strength", &self.strength, &mut state.strength)?;
        take("mass_scale", &self.mass_scale, &mut state.mass_scale)?;
        take("friction", &self.friction, &mut state.friction)?;
        take("damping", &self.damping, &mut state.damping)?;
        take("stiffness", &self.stiffness, &mut state.stiffness)?;
        check("damping", &state.damping, "expected 0 or more", |value| value >= 0.0)?;
        check("stiffness", &state.stiffness, "expected 0 or more", |value| value >= 0.0)?;
        if let Some(shapes) = &self.shapes {
            state.overrides = Overrides::of(shapes.clone());
            if !state.fits(model) {
                return Err(StateError::Shapes);
            }
        }
        check("strength", &state.strength, "expected 0 or more", |value| value >= 0.0)?;
        check("mass_scale", &state.mass_scale, "expected more than 0", |value| value > 0.0)?;
        check("friction", &state.friction, "expected 0 or more", |value| value >= 0.0)?;
        let mut places: Vec<f64> = state.mocap_position.iter().flatten().copied().collect();
        take("mocap_pos", &self.mocap_pos, &mut places)?;
        state.mocap_position = places.chunks_exact(3).map(Vector3::from_column_slice).collect();
        let mut turns = state.mocap_orientation.concat();
        take("mocap_quat", &self.mocap_quat, &mut turns)?;
        state.mocap_orientation = turns.chunks_exact(4).map(|q| [q[0], q[1], q[2], q[3]]).collect();
        let mut speeds: Vec<f64> = state.mocap_velocity.iter().flatten().flatten().copied().collect();
        take("mocap_vel", &self.mocap_vel, &mut speeds)?;
        for (speed, slot) in speeds.chunks_exact(6).zip(&mut state.mocap_velocity) {
            *slot = [Vector3::from_column_slice(&speed[..3]), Vector3::from_column_slice(&speed[3..])];
        }
        let mut wrenches = vec![0.0; 6 * state.body_force.len()];
        take("xfrc_applied", &self.xfrc_applied, &mut wrenches)?;
        for (wrench, slot) in wrenches.chunks_exact(6).zip(&mut state.body_force) {
            *slot = [Vector3::from_column_slice(&wrench[..3]), Vector3::from_column_slice(&wrench[3..])];
        }
        check_quaternions(model, &state)?;
        Ok(state)
    }
}

/// Replaces an array by the given one, if there is one and it has the right length.
fn take(name: &'static str, given: &Option<Vec<f64>>, slot: &mut Vec<f64>) -> Result<(), StateError> {
    let Some(given) = given else { return Ok(()) };
    if given.len() != slot.len() {
        return Err(StateError::Length { name, found: given.len(), expected: slot.len() });
    }
    slot.clone_from(given);
    Ok(())
}

fn check(name: &'static str, values: &[f64], wanted: &'static str, holds: impl Fn(f64) -> bool) -> Result<(), StateError> {
    match values.iter().position(|value| !(value.is_finite() && holds(*value))) {
        Some(index) => Err(StateError::Value { name, value: values[index], index, wanted }),
        None => Ok(()),
    }
}

fn check_quaternions(model: &Model, state: &State<f64>) -> Result<(), StateError> {
    use msk_physics::model::JointKind::{Ball, Free, Hinge, Slide};
    for (joint, kind) in model.joints.kind.iter().enumerate() {
        let start = model.joints.position_address[joint]
            + match kind {
                Free => 3,
                Ball => 0,
                Hinge | Slide => continue,
            };
        if state.position[start..start + 4].iter().all(|part| *part == 0.0) {
            return Err(StateError::Quaternion { joint: model.joints.name[joint].clone() });
        }
    }
    Ok(())
}
