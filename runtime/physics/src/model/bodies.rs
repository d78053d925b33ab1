//! The kinematic tree: bodies, their joints and degrees of freedom.

use super::{Quaternion, SolverParameters};
use core::ops::Range;
use nalgebra::Vector3;

/// Rigid bodies, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bodies {
    /// Names; empty where the file gives none.
    pub name: Vec<String>,
    /// Parent body; the world's is itself.
    pub parent: Vec<usize>,
    /// Root of the kinematic tree, the child of the world that the body hangs on.
    pub root: Vec<usize>,
    /// Whether the body is placed from outside (MuJoCo's `mocap`): without joints, yet not welded to the world.
    pub mocap: Vec<bool>,
    /// Nearest ancestor (or itself) with joints or placed from outside, else the world: bodies welded together share it.
    pub weld: Vec<usize>,
    /// Position in the parent's frame, m.
    pub position: Vec<Vector3<f64>>,
    /// Orientation in the parent's frame.
    pub orientation: Vec<Quaternion>,
    /// Centre of mass in the body's frame, m.
    pub inertial_position: Vec<Vector3<f64>>,
    /// Principal axes in the body's frame.
    pub inertial_orientation: Vec<Quaternion>,
    /// Mass, kg.
    pub mass: Vec<f64>,
    /// Principal moments of inertia, kg m².
    pub inertia: Vec<Vector3<f64>>,
    /// Mass of the body and all its descendants, kg.
    pub subtree_mass: Vec<f64>,
    /// First joint and number of joints.
    pub joints: Vec<Range<usize>>,
    /// First dof and number of dofs.
    pub dofs: Vec<Range<usize>>,
    /// Geoms of the body.
    pub geoms: Vec<Range<usize>>,
    /// Share of the body's weight that is compensated at its centre of mass.
    pub gravity_compensation: Vec<f64>,
    /// Inverse weight at the reference configuration: translation (1/kg), rotation (1/(kg m²)).
    pub inverse_weight: Vec<[f64; 2]>,
}

/// Kind of joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Six degrees of freedom, seven coordinates.
    Free,
    /// Three degrees of freedom, a quaternion.
    Ball,
    /// One translation.
    Slide,
    /// One rotation.
    Hinge,
}

/// Joints, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Joints {
    /// Names.
    pub name: Vec<String>,
    /// Kind.
    pub kind: Vec<JointKind>,
    /// Body that the joint moves.
    pub body: Vec<usize>,
    /// First coordinate in the position vector.
    pub position_address: Vec<usize>,
    /// First degree of freedom.
    pub dof_address: Vec<usize>,
    /// Anchor in the body's frame, m.
    pub anchor: Vec<Vector3<f64>>,
    /// Unit axis in the body's frame.
    pub axis: Vec<Vector3<f64>>,
    /// Range, if limited (rad or m).
    pub range: Vec<Option<[f64; 2]>>,
    /// Distance to a limit at which its constraint appears.
    pub margin: Vec<f64>,
    /// SolverParameters of the limit.
    pub limit_softness: Vec<SolverParameters>,
    /// SolverParameters of the friction loss.
    pub friction_softness: Vec<SolverParameters>,
    /// Spring stiffness, N m/rad or N/m.
    pub stiffness: Vec<f64>,
    /// Spring reference coordinate.
    pub spring_reference: Vec<f64>,
    /// Range that the force of all actuators together is clamped to (hinges and slides), N m or N.
    pub actuator_force_range: Vec<Option<[f64; 2]>>,
    /// Whether gravity compensation of this joint counts as a force of its actuators.
    pub actuator_compensates: Vec<bool>,
}

/// Degrees of freedom, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Dofs {
    /// Body that the dof moves.
    pub body: Vec<usize>,
    /// Joint that the dof belongs to.
    pub joint: Vec<usize>,
    /// Previous dof on the path to the root, if any.
    pub parent: Vec<Option<usize>>,
    /// Rotor inertia, kg m² or kg.
    pub armature: Vec<f64>,
    /// Damping, N m s/rad or N s/m.
    pub damping: Vec<f64>,
    /// Friction loss, N m or N.
    pub friction_loss: Vec<f64>,
    /// Inverse weight at the reference configuration: diagonal of the inverse mass matrix (averaged over a free joint's triples).
    pub inverse_weight: Vec<f64>,
    /// Row of the mass matrix of each dof: the half-open range of its entries in the sparse lower triangle, columns
    /// ascending along the root path, the diagonal last.
    pub row: Vec<Range<usize>>,
    /// Column of each entry of the sparse lower triangle.
    pub column: Vec<usize>,
}
