//! Soft constraints: their parameters, joint couplings and explicit contact pairs.

/// Parameters of a soft constraint: MuJoCo's `solref` and `solimp`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softness {
    /// Time constant and damping ratio, or negative stiffness and damping.
    pub reference: [f64; 2],
    /// Impedance: d0, dmax, width, midpoint, power.
    pub impedance: [f64; 5],
}

impl Default for Softness {
    fn default() -> Self {
        Self { reference: [0.02, 1.0], impedance: [0.9, 0.95, 0.001, 0.5, 2.0] }
    }
}

/// Polynomial couplings q1 - q1₀ = p(q2 - q2₀), one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Couplings {
    /// Names; empty where the file gives none.
    pub name: Vec<String>,
    /// The slaved joint.
    pub joint: Vec<usize>,
    /// The joint that leads; `None` fixes the slaved joint at the constant coefficient.
    pub leader: Vec<Option<usize>>,
    /// Coefficients of degree 0 to 4.
    pub polynomial: Vec<[f64; 5]>,
    /// Softness.
    pub softness: Vec<Softness>,
}

/// Explicit contact pairs, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactPairs {
    /// The two geoms.
    pub geoms: Vec<[usize; 2]>,
    /// Contact dimension.
    pub dimension: Vec<u8>,
    /// Softness.
    pub softness: Vec<Softness>,
    /// Softness reference of the friction directions; both zero takes `softness`.
    pub friction_reference: Vec<[f64; 2]>,
    /// Friction: two sliding, torsional, two rolling.
    pub friction: Vec<[f64; 5]>,
    /// Detection distance, m.
    pub margin: Vec<f64>,
    /// Inactive part of the margin, m.
    pub gap: Vec<f64>,
}
