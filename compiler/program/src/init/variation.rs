//! What an episode has of its own of body and scene: strengths of muscles, masses, frictions, dampings, stiffnesses, shapes.

use crate::body::Property;
use crate::scene::Shape;

/// What differs from the model in one episode. Everything is drawn before the first snapshot and stays for the episode.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Variation {
    /// Factors of the active force of muscles.
    pub strengths: Vec<Scaling>,
    /// Factors of mass and inertia of segments of the body.
    pub segments: Vec<Scaling>,
    /// Factors of the damping of joints of the body.
    pub dampings: Vec<Scaling>,
    /// Factors of the stiffness of joints of the body.
    pub stiffnesses: Vec<Scaling>,
    /// Masses of objects that are drawn.
    pub masses: Vec<ObjectMass>,
    /// Sliding frictions that are drawn.
    pub frictions: Vec<Friction>,
    /// Dampings and stiffnesses of joints of objects that are drawn.
    pub joints: Vec<JointValue>,
    /// Shapes of objects of which numbers are drawn.
    pub shapes: Vec<ObjectShape>,
}

/// A factor of several things.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// Muscles, landmarks that segments carry, or joints, by their places in the vocabulary.
    pub members: Vec<usize>,
    /// The factor of all members, above 0.
    pub factor: f64,
    /// The factor of each member, drawn for each by itself, instead.
    pub each: Option<[f64; 2]>,
}

/// The mass of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectMass {
    /// Its place in the scene's list of objects.
    pub object: usize,
    /// kg, above 0.
    pub mass: f64,
}

/// The sliding friction of an object, or of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Its place in the scene's list of objects; none for the ground.
    pub object: Option<usize>,
    /// Coefficient, not negative.
    pub sliding: f64,
}

/// A parameter of a joint of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointValue {
    /// The object, by its place in the scene's list.
    pub object: usize,
    /// Its joint, by its place among those of the object.
    pub joint: usize,
    /// Damping or stiffness.
    pub property: Property,
    /// N m s/rad or N s/m, N m/rad or N/m; not negative.
    pub value: f64,
}

/// The shape of an object.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectShape {
    /// Its place in the scene's list of objects.
    pub object: usize,
    /// Of the kind that the object has in the scene; every length above 0.
    pub shape: Shape,
}
