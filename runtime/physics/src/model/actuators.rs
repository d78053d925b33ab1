//! Actuators: what they act on, and the three parts of their force law.
//!
//! force = gain(length, velocity) times drive + bias(length, velocity), where the drive is the control, or the activation
//! where the actuator has one (MuJoCo's manual, "Actuation model"). A muscle is an actuator of which all three parts are
//! muscular and which pulls a tendon; [`Actuators::muscle`] tells them apart.

/// What an actuator acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transmission {
    /// A joint; the rotation axis of a ball or free joint is given in the frame of the body it moves.
    Joint(usize),
    /// A joint; the rotation axis of a ball or free joint is given in the frame of its parent.
    JointInParent(usize),
    /// A tendon.
    Tendon(usize),
    /// A site, in its own axes, or its pose relative to another site, in the axes of that one.
    Site {
        /// The site.
        site: usize,
        /// What its pose is measured from.
        reference: Option<usize>,
    },
    /// A body, which is drawn to all that it touches or nearly touches: the force is shared by its contacts and acts along
    /// their normals.
    Body(usize),
}

/// How the activation follows the control u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dynamics {
    /// There is no activation.
    None,
    /// The rate is u.
    Integrator,
    /// The rate is (u - activation) / time constant (s).
    Filter(f64),
    /// The same, integrated exactly over a step.
    ExactFilter(f64),
    /// A muscle's: activation and deactivation times (s), width of the smooth transition between them.
    Muscle([f64; 3]),
}

/// What the drive is multiplied with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gain {
    /// A constant.
    Fixed(f64),
    /// a + b length + c velocity.
    Affine([f64; 3]),
    /// A muscle's active force: range0, range1, force, scale, lmin, lmax, vmax, fpmax, fvmax (MuJoCo `gainprm`).
    Muscle([f64; 9]),
}

/// What is added to the drive's force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bias {
    /// Nothing.
    None,
    /// a + b length + c velocity.
    Affine([f64; 3]),
    /// A muscle's passive force, figures as for [`Gain::Muscle`].
    Muscle([f64; 9]),
}

/// Actuators, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Actuators {
    /// Names.
    pub name: Vec<String>,
    /// What it acts on.
    pub transmission: Vec<Transmission>,
    /// Gear: the ratio first; for sites, ball and free joints the axes of force and torque.
    pub gear: Vec<[f64; 6]>,
    /// Activation dynamics.
    pub dynamics: Vec<Dynamics>,
    /// Gain.
    pub gain: Vec<Gain>,
    /// Bias.
    pub bias: Vec<Bias>,
    /// Where its activation stands in the activation vector.
    pub activation: Vec<Option<usize>>,
    /// Whether the force already sees the activation at the end of the step.
    pub actearly: Vec<bool>,
    /// Range that the control is clamped to.
    pub control_range: Vec<Option<[f64; 2]>>,
    /// Range that the force is clamped to, N or N m.
    pub force_range: Vec<Option<[f64; 2]>>,
    /// Range that the activation is clamped to.
    pub activation_range: Vec<Option<[f64; 2]>>,
    /// Operating range of the length, m: muscles need it.
    pub length_range: Vec<[f64; 2]>,
    /// Norm of the actuator's joint-space acceleration per unit force at the reference configuration.
    pub acceleration_scale: Vec<f64>,
}

/// A muscle's figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Muscle {
    /// Tendon that it pulls.
    pub tendon: usize,
    /// Gear ratio.
    pub gear: f64,
    /// Where its activation stands in the activation vector.
    pub activation: usize,
    /// Activation dynamics: activation time, deactivation time (s), smoothing width.
    pub time_constants: [f64; 3],
    /// Active force: range0, range1, force, scale, lmin, lmax, vmax, fpmax, fvmax.
    pub active: [f64; 9],
    /// Passive force, the same layout.
    pub passive: [f64; 9],
}

impl Actuators {
    /// The figures of an actuator that is a muscle pulling a tendon.
    pub fn muscle(&self, actuator: usize) -> Option<Muscle> {
        match (self.transmission[actuator], self.dynamics[actuator], self.gain[actuator], self.bias[actuator]) {
            (Transmission::Tendon(tendon), Dynamics::Muscle(time_constants), Gain::Muscle(active), Bias::Muscle(passive)) => {
                let [gear, ..] = self.gear[actuator];
                let activation = self.activation[actuator]?;
                Some(Muscle { tendon, gear, activation, time_constants, active, passive })
            }
            _ => None,
        }
    }

    /// Whether every force follows an activation as it stands when the step begins. A new control then changes nothing but the rates
    /// of activations.
    pub fn act_by_activation(&self) -> bool {
        self.activation.iter().all(Option::is_some) && !self.actearly.contains(&true)
    }

    /// Scales the active force of a muscle; its passive force stays. Other actuators have no muscles to be weak.
    pub fn scale_strength(&mut self, actuator: usize, factor: f64) {
        if let Gain::Muscle([_, _, force, scale, ..]) = &mut self.gain[actuator] {
            // A negative peak force stands for one that follows from the scale.
            *(if *force < 0.0 { scale } else { force }) *= factor;
        }
    }

    /// All muscles with their indices among the actuators.
    pub fn muscles(&self) -> impl Iterator<Item = (usize, Muscle)> + '_ {
        (0..self.name.len()).filter_map(|actuator| Some((actuator, self.muscle(actuator)?)))
    }
}
