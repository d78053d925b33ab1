//! MJCF's own sensors: what they are attached to, and where their numbers stand.

use super::GeomKind;
use nalgebra::Vector3;

/// Something with a frame of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framed {
    /// A body's inertial frame (`body`).
    InertialBody(usize),
    /// A body's own frame (`xbody`).
    Body(usize),
    /// A geom.
    Geom(usize),
    /// A site.
    Site(usize),
}

/// What a limit belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limited {
    /// A joint.
    Joint(usize),
    /// A tendon.
    Tendon(usize),
}

/// What is measured of a limit; zero where it is not reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitQuantity {
    /// Distance to the limit less its margin, m or rad: negative where it is violated (`jointlimitpos`).
    Distance,
    /// Rate of the distance (`jointlimitvel`).
    Velocity,
    /// Force or torque of the limit (`jointlimitfrc`).
    Force,
}

/// Shapes whose distance is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// A geom.
    Geom(usize),
    /// All geoms of a body.
    Body(usize),
}

/// What is measured of the nearest pair of two surfaces, out to the sensor's cutoff.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GapQuantity {
    /// Distance, negative where they overlap, m.
    Distance,
    /// Unit vector from the nearest point of the first to that of the second.
    Normal,
    /// Both points.
    Segment,
}

/// What a sensor measures. SI units, world axes unless noted otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// Sum of the normal forces of contacts of the site's body in the site's volume, or whose normals meet it, N.
    Touch {
        /// The site.
        site: usize,
        /// The volume's shape.
        shape: GeomKind,
        /// Its size, m.
        size: Vector3<f64>,
    },
    /// Proper acceleration of a site in its axes, m/s².
    Accelerometer(usize),
    /// Velocity of a site in its axes, m/s.
    Velocimeter(usize),
    /// Angular velocity of a site in its axes, rad/s.
    Gyro(usize),
    /// Force between the site's body and its parent, in the site's axes, N.
    Force(usize),
    /// Torque between the site's body and its parent about the site, in its axes, N m.
    Torque(usize),
    /// Coordinate of a hinge or slide.
    JointPosition(usize),
    /// Velocity of a hinge or slide.
    JointVelocity(usize),
    /// Force of all actuators on a hinge or slide.
    JointActuatorForce(usize),
    /// Quaternion of a ball.
    BallOrientation(usize),
    /// Angular velocity of a ball in the axes of the body it moves.
    BallVelocity(usize),
    /// Length of a tendon.
    TendonPosition(usize),
    /// Its rate.
    TendonVelocity(usize),
    /// Length of an actuator, gear included.
    ActuatorPosition(usize),
    /// Its rate.
    ActuatorVelocity(usize),
    /// Force of an actuator.
    ActuatorForce(usize),
    /// Position, relative to a frame and in its axes if there is one.
    FramePosition(Framed, Option<Framed>),
    /// Orientation, relative to a frame if there is one.
    FrameOrientation(Framed, Option<Framed>),
    /// One of the axes (0, 1, 2), in the axes of a frame if there is one.
    FrameAxis(Framed, Option<Framed>, usize),
    /// Velocity, as seen from a frame if there is one.
    FrameVelocity(Framed, Option<Framed>),
    /// Angular velocity, as seen from a frame if there is one.
    FrameAngularVelocity(Framed, Option<Framed>),
    /// Proper acceleration.
    FrameAcceleration(Framed),
    /// Angular acceleration.
    FrameAngularAcceleration(Framed),
    /// Centre of mass of a body and all that hangs on it.
    SubtreeCenter(usize),
    /// Its velocity.
    SubtreeVelocity(usize),
    /// Angular momentum about it, kg m²/s.
    SubtreeAngularMomentum(usize),
    /// Sum of the forces of the actuators that pull a tendon.
    TendonActuatorForce(usize),
    /// A limit of a joint or tendon.
    Limit(Limited, LimitQuantity),
    /// Distance along a site's z axis to the first visible shape of another body, -1 where there is none, m (`rangefinder`).
    Range(usize),
    /// The gap between two surfaces.
    Gap([Surface; 2], GapQuantity),
    /// Time, s.
    Clock,
}

impl Measure {
    /// Whether it is a unit vector or quaternion, of which no number can be cut off.
    pub fn is_direction(&self) -> bool {
        matches!(self, Self::FrameAxis(..) | Self::FrameOrientation(..) | Self::BallOrientation(_))
    }

    /// Whether the sensor's cutoff clamps it. Of a gap's direction and points it only bounds the search.
    pub fn is_cut_off(&self) -> bool {
        !matches!(self, Self::Gap(_, GapQuantity::Normal | GapQuantity::Segment))
    }

    /// How many numbers it is.
    pub fn size(&self) -> usize {
        match self {
            Self::BallOrientation(_) | Self::FrameOrientation(..) => 4,
            Self::Accelerometer(_) | Self::Velocimeter(_) | Self::Gyro(_) | Self::Force(_) | Self::Torque(_) => 3,
            Self::BallVelocity(_) | Self::FramePosition(..) | Self::FrameAxis(..) | Self::FrameVelocity(..) => 3,
            Self::FrameAngularVelocity(..) | Self::FrameAcceleration(_) | Self::FrameAngularAcceleration(_) => 3,
            Self::Gap(_, GapQuantity::Segment) => 6,
            Self::Gap(_, GapQuantity::Normal) => 3,
            Self::SubtreeCenter(_) | Self::SubtreeVelocity(_) | Self::SubtreeAngularMomentum(_) => 3,
            _ => 1,
        }
    }
}

/// Sensors, one entry each per array, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sensors {
    /// Names.
    pub name: Vec<String>,
    /// What it measures.
    pub measure: Vec<Measure>,
    /// Readings are clamped to plus or minus this (a touch from above); zero leaves them.
    pub cutoff: Vec<f64>,
}

impl Sensors {
    /// How many numbers all of them give (`nsensordata`).
    pub fn size(&self) -> usize {
        self.measure.iter().map(Measure::size).sum()
    }
}
