//! What the stages need that follows from the model alone.

use crate::{
    actuation, collision, constraint, fluid,
    inertia::tendon_armature,
    integrator::{implicit::floating_bodies, runge_kutta::turning_dofs},
    kinematics,
    model::Model,
    solver::coupled_dofs,
    tendons,
};
use std::sync::Arc;

/// Everything that is decided once per model: which segments of tendons join two bodies, which shapes can meet, which dofs a
/// constraint couples. Immutable; a clone shares it.
///
/// ```
/// use msk_physics::{Plan, Workspace, model::Model};
///
/// let model = Model::from_mjcf(r#"<mujoco><worldbody><body><joint/><geom size="0.1"/></body></worldbody></mujoco>"#)?;
/// let plan = Plan::new(&model);
/// let workers: Vec<Workspace<f64>> = (0..4).map(|_| Workspace::of(&model, &plan)).collect();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Plan {
    pub(crate) kinematics: Arc<kinematics::Plan>,
    pub(crate) armature: Arc<[(usize, f64)]>,
    pub(crate) tendons: Arc<tendons::Plan>,
    pub(crate) actuation: Arc<actuation::Plan>,
    pub(crate) medium: Arc<fluid::Medium>,
    pub(crate) pairs: Arc<collision::Plan>,
    pub(crate) rows: Arc<constraint::RowPlan>,
    pub(crate) coupled: Arc<[[usize; 2]]>,
    pub(crate) floating: Arc<[usize]>,
    pub(crate) turning: Arc<[usize]>,
}

impl Plan {
    /// Decides for `model`.
    pub fn new(model: &Model) -> Self {
        Self {
            kinematics: Arc::new(kinematics::Plan::new(model)),
            armature: tendon_armature(model),
            tendons: Arc::new(tendons::Plan::new(model)),
            actuation: Arc::new(actuation::Plan::new(model)),
            medium: Arc::new(fluid::Medium::new(model)),
            pairs: Arc::new(collision::Plan::new(model)),
            rows: Arc::new(constraint::RowPlan::new(model)),
            coupled: coupled_dofs(model),
            floating: floating_bodies(model),
            turning: turning_dofs(model),
        }
    }
}
