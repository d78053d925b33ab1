//! Frames and the motion subspace.

use crate::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// Outputs of position kinematics, MuJoCo's names in words. World frame, metres.
#[derive(Debug, Clone)]
pub struct Kinematics<T: Real> {
    /// Body frame origins (`xpos`).
    pub body_position: Vec<Vector3<T>>,
    /// Body orientations w x y z (`xquat`).
    pub body_orientation: Vec<[T; 4]>,
    /// Body rotation matrices (`xmat`).
    pub body_rotation: Vec<Matrix3<T>>,
    /// Centres of mass of the bodies (`xipos`).
    pub inertial_position: Vec<Vector3<T>>,
    /// Principal axes of the bodies (`ximat`).
    pub inertial_rotation: Vec<Matrix3<T>>,
    /// Joint anchors (`xanchor`).
    pub joint_anchor: Vec<Vector3<T>>,
    /// Joint axes (`xaxis`).
    pub joint_axis: Vec<Vector3<T>>,
    /// Geom centres (`geom_xpos`).
    pub geom_position: Vec<Vector3<T>>,
    /// Geom rotation matrices (`geom_xmat`).
    pub geom_rotation: Vec<Matrix3<T>>,
    /// Site positions (`site_xpos`).
    pub site_position: Vec<Vector3<T>>,
    /// Centre of mass of each body's subtree (`subtree_com`).
    pub subtree_com: Vec<Vector3<T>>,
    /// Motion axis of every dof, angular then linear, about the centre of mass of its kinematic tree (`cdof`).
    pub dof_axis: Vec<[Vector3<T>; 2]>,
}
