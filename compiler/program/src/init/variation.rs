//! What an episode has of its own of body and scene: strengths of muscles, masses, frictions.

/// What differs from the model in one episode. Everything is drawn before the first snapshot and stays for the episode.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Variation {
    /// Factors of the active force of muscles.
    pub strengths: Vec<Scaling>,
    /// Factors of mass and inertia of segments of the body.
    pub segments: Vec<Scaling>,
    /// Masses of objects that are drawn.
    pub masses: Vec<ObjectMass>,
    /// Sliding frictions that are drawn.
    pub frictions: Vec<Friction>,
}

/// A factor of several things.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// Muscles, or landmarks that segments carry, by their places in the vocabulary.
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
