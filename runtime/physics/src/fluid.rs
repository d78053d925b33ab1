//! The drag of a medium around the bodies (MuJoCo's manual, chapter Computation, "Fluid forces", the model based on inertia).
//!
//! Each body with a mass drags like a box that has its mass and its moments of inertia. With b the box's sides, v its velocity
//! through the medium and w its spin, both about the centre of mass in the box's own axes, along axis x
//!
//! ```text
//! force  = -(3 pi d viscosity           + density / 2 b_y b_z |v_x|) v_x
//! torque = -(  pi d^3 viscosity + density / 64 b_x (b_y^4 + b_z^4) |w_x|) w_x
//! ```
//!
//! with d the mean of the sides: a sphere in slow flow, a box in fast flow.

use super::{
    jacobian::last_dof,
    kinematics::Kinematics,
    rotation::MINIMUM,
    spatial::{Spatial, constant, cross, rotate, rotate_back, spatial_zero},
    velocities::Velocities,
};
use crate::{
    model::{Fluid, Model},
    scalar::Real,
};
use core::f64::consts::PI;
use nalgebra::Vector3;

/// A body's drag: first about, then along the axes of its box.
#[derive(Debug, Clone)]
struct Immersed {
    body: usize,
    /// Per velocity, N m s and N s/m.
    linear: [[f64; 3]; 2],
    /// Per velocity squared.
    quadratic: [[f64; 3]; 2],
}

/// The bodies that a medium drags; none in empty space.
#[derive(Debug, Clone, Default)]
pub(crate) struct Medium {
    bodies: Vec<Immersed>,
    wind: Vector3<f64>,
}

impl Medium {
    pub fn new(model: &Model) -> Self {
        let Fluid { density, viscosity, wind } = model.options.fluid;
        if density <= 0.0 && viscosity <= 0.0 {
            return Self::default();
        }
        let heavy = (1..model.bodies.parent.len()).filter(|&body| model.bodies.mass[body] >= MINIMUM);
        Self { bodies: heavy.map(|body| immersed(model, body, density, viscosity)).collect(), wind }
    }

    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Writes the drag on all bodies over `body_force`.
    pub fn drag<T: Real>(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        velocities: &Velocities<T>,
        body_force: &mut [Spatial<T>],
    ) {
        body_force.fill(spatial_zero());
        for immersed in &self.bodies {
            let motion = self.motion(model, kinematics, velocities, immersed.body);
            let [turn, push] = [0, 1].map(|part| {
                let local = Vector3::from_fn(|axis, _| {
                    let quadratic = T::splat(immersed.quadratic[part][axis]) * motion[part][axis].abs();
                    -(T::splat(immersed.linear[part][axis]) + quadratic) * motion[part][axis]
                });
                rotate(&kinematics.inertial_rotation[immersed.body], &local)
            });
            let arm = arm(model, kinematics, immersed.body);
            body_force[immersed.body] = [turn + cross(&arm, &push), push];
        }
    }

    /// Calls `add` with the direction of every drag and its slope over velocity, negative. `row` (`nv` entries) is scratch.
    pub fn each_slope<T: Real>(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        velocities: &Velocities<T>,
        row: &mut [T],
        mut add: impl FnMut(&[T], T),
    ) {
        for immersed in &self.bodies {
            let motion = self.motion(model, kinematics, velocities, immersed.body);
            let axes = &kinematics.inertial_rotation[immersed.body];
            let arm = arm(model, kinematics, immersed.body);
            for (part, axis) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)] {
                row.fill(T::splat(0.0));
                for dof in core::iter::successors(last_dof(model, immersed.body), |&dof| model.dofs.parent[dof]) {
                    let [angular, linear] = &kinematics.dof_axis[dof];
                    let moved = if part == 0 { *angular } else { linear + cross(angular, &arm) };
                    row[dof] = rotate_back(axes, &moved)[axis];
                }
                let quadratic = T::splat(2.0 * immersed.quadratic[part][axis]) * motion[part][axis].abs();
                add(row, -(T::splat(immersed.linear[part][axis]) + quadratic));
            }
        }
    }

    /// Spin and velocity through the medium of a body's centre of mass, in its principal axes.
    fn motion<T: Real>(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        velocities: &Velocities<T>,
        body: usize,
    ) -> [Vector3<T>; 2] {
        let [spin, velocity] = &velocities.body[body];
        let through = velocity + cross(spin, &arm(model, kinematics, body)) - constant::<T>(&self.wind);
        [spin, &through].map(|vector| rotate_back(&kinematics.inertial_rotation[body], vector))
    }
}

/// From where spatial vectors are taken to the body's centre of mass.
fn arm<T: Real>(model: &Model, kinematics: &Kinematics<T>, body: usize) -> Vector3<T> {
    kinematics.inertial_position[body] - kinematics.reference(model, body)
}

fn immersed(model: &Model, body: usize, density: f64, viscosity: f64) -> Immersed {
    let (mass, inertia) = (model.bodies.mass[body], model.bodies.inertia[body]);
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let square = inertia[(axis + 1) % 3] + inertia[(axis + 2) % 3] - inertia[axis];
        (6.0 * square.at_least(MINIMUM) / mass).sqrt()
    });
    let mean = (x + y + z) / 3.0;
    let spinning = |own: f64, a: f64, b: f64| density * own * (a.squared().squared() + b.squared().squared()) / 64.0;
    Immersed {
        body,
        linear: [[PI * (mean.squared() * mean) * viscosity; 3], [3.0 * PI * mean * viscosity; 3]],
        quadratic: [
            [spinning(x, y, z), spinning(y, z, x), spinning(z, x, y)],
            [0.5 * density * y * z, 0.5 * density * z * x, 0.5 * density * x * y],
        ],
    }
}
