//! Everything that one forward computation finds.

use msk_physics::constraint::{Constraints, RowKind};
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace, actuation, sensors};
use nalgebra::{Matrix3, Vector3};
use serde_json::{Map, Value, json};

/// Large quantities that are only listed on request.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Extra {
    /// `actuator_moment`: how each actuator's length changes with each dof, `nu` times `nv`.
    pub moment_arms: bool,
    /// `efc_J`: the constraint rows, `nefc` times `nv`.
    pub constraint_jacobian: bool,
}

/// All quantities of `workspace` after [`forward`](msk_physics::forward) on `state`, by MuJoCo's names.
pub fn forward_report(model: &Model, state: &State<f64>, workspace: &Workspace<f64>, extra: Extra) -> Value {
    let mut report = Map::new();
    let mut put = |name: &str, value: Value| drop(report.insert(name.to_owned(), value));
    put("model", sizes(model));
    put("names", names(model));
    put("time", json!(state.time));
    put("qpos", json!(state.position));
    put("qvel", json!(state.velocity));
    put("act", json!(state.activation));
    put("ctrl", json!(state.control));
    put("eq_active", json!(state.active.iter().map(|active| *active != 0.0).collect::<Vec<bool>>()));
    // A step with constraint rows leaves the acceleration without them out.
    let mut workspace = workspace.clone();
    physics::unconstrained(model, state, &mut workspace);
    let workspace = &workspace;
    let kinematics = &workspace.kinematics;
    put("xpos", vectors(&kinematics.body_position));
    put("xquat", json!(kinematics.body_orientation.concat()));
    put("xmat", matrices(&kinematics.body_rotation));
    put("xipos", vectors(&kinematics.inertial_position));
    put("ximat", matrices(&kinematics.inertial_rotation));
    put("xanchor", vectors(&kinematics.joint_anchor));
    put("xaxis", vectors(&kinematics.joint_axis));
    put("geom_xpos", vectors(&kinematics.geom_position));
    put("geom_xmat", matrices(&kinematics.geom_rotation));
    put("subtree_com", vectors(&kinematics.subtree_com));
    put("ten_length", json!(workspace.tendons.length));
    put("ten_velocity", json!(workspace.tendons.velocity));
    put("actuator_length", json!(workspace.actuation.length));
    put("actuator_velocity", json!(workspace.actuation.velocity));
    put("actuator_force", json!(workspace.actuation.force));
    put("act_dot", json!(workspace.actuation.activation_rate));
    if let Some(fibres) = &workspace.actuation.fibres {
        let tendons: Vec<f64> = (0..fibres.length.len()).map(|muscle| workspace.actuation.tendon_length(muscle)).collect();
        put("fibre_length", json!(fibres.length));
        put("fibre_velocity", json!(fibres.velocity));
        put("tendon_length", json!(tendons));
    }
    if extra.moment_arms {
        put("actuator_moment", json!(actuator_moment(model, state, workspace)));
    }
    put("M", json!(mass_matrix(model, workspace)));
    put("qfrc_bias", json!(workspace.forces.bias));
    put("qfrc_passive", json!(workspace.forces.passive));
    put("qfrc_actuator", json!(workspace.forces.actuator));
    put("qfrc_applied", json!(state.applied_force));
    put("qfrc_smooth", json!(workspace.forces.smooth));
    put("qacc_smooth", json!(workspace.forces.smooth_acceleration));
    for episode in workspace.lanes.iter().take(1) {
        let constraints = &episode.constraints;
        put("contact", contacts(model, constraints));
        for (name, values) in rows(constraints) {
            put(name, values);
        }
        if extra.constraint_jacobian {
            let jacobian: Vec<f64> = (0..constraints.rows.len()).flat_map(|row| constraints.jacobian_row(model, row)).collect();
            put("efc_J", json!(jacobian));
        }
    }
    if !model.sensors.name.is_empty() {
        put("sensordata", json!(sensors::readings(model, state, workspace)));
    }
    put("qfrc_constraint", json!(workspace.constraint_force));
    put("qacc", json!(workspace.acceleration));
    Value::Object(report)
}

fn sizes(model: &Model) -> Value {
    json!({
        "name": model.name,
        "nq": model.nq,
        "nv": model.nv,
        "nu": model.actuators.name.len(),
        "na": model.na,
        "nbody": model.bodies.name.len(),
        "njnt": model.joints.name.len(),
        "ngeom": model.geoms.name.len(),
        "ntendon": model.tendons.name.len(),
        "timestep": model.options.timestep,
    })
}

/// Names in the order of the arrays; with each joint the addresses of its entries in `qpos` and `qvel`.
fn names(model: &Model) -> Value {
    json!({
        "body": model.bodies.name,
        "joint": model.joints.name,
        "geom": model.geoms.name,
        "tendon": model.tendons.name,
        "actuator": model.actuators.name,
        "equality": model.equalities.name,
        "sensor": model.sensors.name,
        "jnt_qposadr": model.joints.position_address,
        "jnt_dofadr": model.joints.dof_address,
    })
}

fn vectors(vectors: &[Vector3<f64>]) -> Value {
    json!(vectors.iter().flatten().copied().collect::<Vec<f64>>())
}

fn matrices(matrices: &[Matrix3<f64>]) -> Value {
    json!(matrices.iter().flat_map(row_major).collect::<Vec<f64>>())
}

fn row_major(matrix: &Matrix3<f64>) -> [f64; 9] {
    core::array::from_fn(|index| matrix[(index / 3, index % 3)])
}

fn actuator_moment(model: &Model, state: &State<f64>, workspace: &Workspace<f64>) -> Vec<f64> {
    let mut moment = vec![0.0; model.actuators.name.len() * model.nv];
    // No dofs, no columns: `chunks` needs a size of at least one.
    for (actuator, row) in moment.chunks_mut(model.nv.max(1)).enumerate() {
        if !workspace.actuation.contact_moment(model, actuator, row) {
            actuation::moment(model, state, &workspace.kinematics, &workspace.tendons, actuator, row);
        }
    }
    moment
}

/// The whole symmetric matrix, `nv` times `nv`.
fn mass_matrix(model: &Model, workspace: &Workspace<f64>) -> Vec<f64> {
    let mut dense = vec![0.0; model.nv * model.nv];
    for (row, range) in model.dofs.row.iter().enumerate() {
        for (column, value) in model.dofs.column[range.clone()].iter().zip(&workspace.inertia.matrix[range.clone()]) {
            dense[row * model.nv + column] = *value;
            dense[column * model.nv + row] = *value;
        }
    }
    dense
}

fn contacts(model: &Model, constraints: &Constraints) -> Value {
    let describe = |contact: &msk_physics::collision::Contact| {
        json!({
            "geom": contact.geoms,
            "geom_names": contact.geoms.map(|geom| &model.geoms.name[geom]),
            "pos": contact.position.as_slice(),
            "frame": row_major(&contact.frame),
            "dist": contact.distance,
            "dim": constraints.plan.candidates[contact.candidate].dimension,
            "force": contact.force,
        })
    };
    json!(constraints.contacts.iter().map(describe).collect::<Vec<_>>())
}

/// The constraint rows, one array per quantity.
fn rows(constraints: &Constraints) -> [(&'static str, Value); 11] {
    let rows = &constraints.rows;
    let friction = |kind: &RowKind| matches!(kind, RowKind::DofFriction(_) | RowKind::TendonFriction(_));
    let loss = |row: usize| if friction(&rows.kind[row]) { rows.upper[row] } else { 0.0 };
    [
        ("efc_type", json!((0..rows.len()).map(|row| constraints.row_type(row)).collect::<Vec<_>>())),
        ("efc_id", json!(rows.kind.iter().map(RowKind::element).collect::<Vec<_>>())),
        ("efc_frictionloss", json!((0..rows.len()).map(loss).collect::<Vec<_>>())),
        ("efc_pos", json!(rows.position)),
        ("efc_margin", json!(rows.margin)),
        ("efc_vel", json!(rows.velocity)),
        ("efc_diagA", json!(rows.diagonal)),
        ("efc_R", json!(rows.regularization)),
        ("efc_D", json!(rows.weight)),
        ("efc_aref", json!(rows.reference)),
        ("efc_force", json!(rows.force)),
    ]
}
