//! The fall gate: what lies on the ground does not go on, whatever its task says.

use msk_runtime::episode::Environment;

/// A root below this height has fallen, m.
pub const FALLEN_HEIGHT: f64 = 0.6;
/// One that leans further has fallen, rad: 70 degrees.
pub const FALLEN_TILT: f64 = 70.0 * core::f64::consts::PI / 180.0;

/// Whether the root is too low, or its own up axis leans too far; never of a body that is fixed to the world.
pub fn fallen(environment: &Environment) -> bool {
    let context = environment.context();
    let root = &context.body.root;
    if root.free.is_none() {
        return false;
    }
    let kinematics = &context.workspace.kinematics;
    let up = kinematics.body_rotation[root.body] * root.axes.column(2);
    kinematics.body_position[root.body].z < FALLEN_HEIGHT || up.z < libm::cos(FALLEN_TILT)
}
