//! The table of signals: the one place from which names are resolved, `msk vocabulary` prints and the reference is made.

use serde::Serialize;

/// On what a signal is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Owner {
    /// `pelvis.height`
    Landmark,
    /// `seat.top`: constants of objects, beside all that landmarks have
    Object,
    /// `knee_angle_r.q`
    Joint,
    /// `soleus_r.force`
    Muscle,
    /// `com.speed`
    CentreOfMass,
    /// By itself: `spine`, `body_mass`
    WholeBody,
    /// As a function: `touching(sole_l, ground)`
    Contact,
    /// As a function: `ground_height(xy)`
    Ground,
    /// By itself: `t`, `survived`
    Time,
    /// `gait.phase`, of a `reference`
    Reference,
}

impl Owner {
    /// Heading in the printed table, with an example.
    pub fn heading(self) -> &'static str {
        match self {
            Self::Landmark => "Landmark or object (`pelvis.height`)",
            Self::Object => "Object of the scene (`seat.top`), in addition to the signals of landmarks",
            Self::Joint => "Joint (`knee_angle_r.q`)",
            Self::Muscle => "Muscle (`soleus_r.force`)",
            Self::CentreOfMass => "Centre of mass of the body (`com.speed`)",
            Self::WholeBody => "Whole body",
            Self::Contact => "Contact (`touching(sole_l, ground)`)",
            Self::Ground => "Ground",
            Self::Time => "Time",
            Self::Reference => "Motion of a `reference` (`gait.q(knee_angle_r)`)",
        }
    }
}

/// What is read; `NotYet` is in the language, but this version does not measure it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
pub enum Read {
    NotYet,
    Position,
    Velocity,
    Acceleration,
    Speed,
    Height,
    Clearance,
    Orientation,
    AngularVelocity,
    Forward,
    Left,
    Up,
    Pitch,
    Roll,
    Yaw,
    Mass,
    Coordinate,
    CoordinateVelocity,
    CoordinateAcceleration,
    Torque,
    Power,
    Neutral,
    Lower,
    Upper,
    Length,
    Force,
    Tension,
    Activation,
    Excitation,
    PeakForce,
    FibreLength,
    Strength,
    MetabolicPower,
    TendonLength,
    MomentArm,
    BodyWeight,
    CentreOfPressure,
    SupportMargin,
    AngularMomentum,
    BodyMass,
    Spine,
    Action,
    Touching,
    ContactForce,
    ReactionForce,
    ReactionTorque,
    ContactCount,
    SurfaceDistance,
    Slip,
    Query,
    Robot,
    Extent,
    Top,
    Bottom,
    Time,
    Interval,
    Step,
    Horizon,
    Terminated,
    Finished,
    Truncated,
    Ended,
    Survived,
    Pi,
    Followed,
}

/// A row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Signal {
    /// On what it is read.
    pub owner: Owner,
    /// Its name; functions with their parameters.
    pub name: &'static str,
    /// What it reads.
    #[serde(skip)]
    pub read: Read,
    /// Its type and unit, as printed.
    pub kind: &'static str,
    /// One sentence.
    pub description: &'static str,
    /// Whether this version measures it.
    pub supported: bool,
}

const fn row(owner: Owner, name: &'static str, read: Read, kind: &'static str, description: &'static str) -> Signal {
    Signal { owner, name, read, kind, description, supported: !matches!(read, Read::NotYet) }
}

use Owner::{CentreOfMass, Contact, Ground, Joint, Landmark, Muscle, Object, Reference, Time, WholeBody};

/// Every signal of the language.
#[rustfmt::skip]
pub const SIGNALS: &[Signal] = &[
    row(Landmark, "position", Read::Position, "place, m", "position of the point"),
    row(Landmark, "velocity", Read::Velocity, "vec3, m/s", "velocity of the point, expressed in the world frame"),
    row(Landmark, "acceleration", Read::Acceleration, "vec3, m/s^2", "mean acceleration over the control step, expressed in the world frame"),
    row(Landmark, "speed", Read::Speed, "number, m/s", "length of the velocity"),
    row(Landmark, "height", Read::Height, "number, m", "z of the position"),
    row(Landmark, "clearance", Read::Clearance, "number, m", "lowest point of the landmark's segment above walkable ground"),
    row(Landmark, "orientation", Read::Orientation, "rotation", "anatomical axes; observed as unit quaternion w x y z, w >= 0"),
    row(Landmark, "angular_velocity", Read::AngularVelocity, "vec3, rad/s", "angular velocity, expressed in the world frame"),
    row(Landmark, "forward", Read::Forward, "vec3", "unit vector anatomically forward, expressed in the world frame"),
    row(Landmark, "left", Read::Left, "vec3", "unit vector anatomically left, expressed in the world frame"),
    row(Landmark, "up", Read::Up, "vec3", "unit vector anatomically up, expressed in the world frame"),
    row(Landmark, "pitch", Read::Pitch, "number, rad", "nose down positive, after yaw"),
    row(Landmark, "roll", Read::Roll, "number, rad", "right side down positive, after yaw and pitch"),
    row(Landmark, "yaw", Read::Yaw, "number, rad", "rotation about the vertical, left positive"),
    row(Landmark, "mass", Read::Mass, "number, kg", "mass of the body part of the landmark; of an object with all parts that are attached without a joint"),
    row(Object, "size", Read::Extent, "vec3, m", "full extents of a box or ellipsoid, in its own frame"),
    row(Object, "radius", Read::Extent, "number, m", "radius of a sphere, capsule or cylinder"),
    row(Object, "length", Read::Extent, "number, m", "length of a capsule, cylinder or terrain"),
    row(Object, "width", Read::Extent, "number, m", "of terrain"),
    row(Object, "rise", Read::Extent, "number, m", "height of one step of stairs"),
    row(Object, "run", Read::Extent, "number, m", "depth of one step of stairs"),
    row(Object, "count", Read::Extent, "int", "number of steps of stairs"),
    row(Object, "angle", Read::Extent, "number, rad", "inclination of a slope"),
    row(Object, "friction", Read::Extent, "number", "sliding friction of a shape"),
    row(Object, "top", Read::Top, "number, m", "z of the highest point of a fixed object"),
    row(Object, "bottom", Read::Bottom, "number, m", "z of the lowest point of a fixed object"),
    row(Joint, "q", Read::Coordinate, "number, rad or m", "coordinate: rad for hinges, m for slides"),
    row(Joint, "qd", Read::CoordinateVelocity, "number, rad/s or m/s", "its rate"),
    row(Joint, "qdd", Read::CoordinateAcceleration, "number, rad/s^2 or m/s^2", "its acceleration"),
    row(Joint, "torque", Read::Torque, "number, N*m or N", "generalised force of all muscles on the joint"),
    row(Joint, "reaction_force", Read::ReactionForce, "vec3, N", "force of the parent segment on that of the joint, what bones bear beside the muscles, expressed in the world frame"),
    row(Joint, "reaction_torque", Read::ReactionTorque, "vec3, N*m", "torque of the parent segment on that of the joint about the joint, expressed in the world frame"),
    row(Joint, "power", Read::Power, "number, W", "power of the muscles on the joint"),
    row(Joint, "neutral", Read::Neutral, "number, rad or m", "coordinate in the standing pose"),
    row(Joint, "lower", Read::Lower, "number, rad or m", "lower end of its range"),
    row(Joint, "upper", Read::Upper, "number, rad or m", "upper end of its range"),
    row(Muscle, "length", Read::Length, "number, m", "length of the muscle-tendon unit"),
    row(Muscle, "velocity", Read::Velocity, "number, m/s", "its rate, lengthening positive"),
    row(Muscle, "force", Read::Force, "number, N", "actuator force, negative in tension"),
    row(Muscle, "tension", Read::Tension, "number, N", "tension on the bones, never negative"),
    row(Muscle, "activation", Read::Activation, "number", "activation, 0..1"),
    row(Muscle, "excitation", Read::Excitation, "number", "excitation, 0..1: the input of the activation dynamics"),
    row(Muscle, "action", Read::Action, "number", "action that reaches the muscle, -1..1, before the excitation map"),
    row(Muscle, "peak_force", Read::PeakForce, "number, N", "peak isometric force"),
    row(Muscle, "power", Read::Power, "number, W", "power delivered to the bones: force times velocity"),
    row(Muscle, "metabolic_power", Read::MetabolicPower, "number, W", "heat and work of the muscle, never negative (Bhargava et al. 2004), without the basal rate"),
    row(Muscle, "strength", Read::Strength, "number", "factor of its active force in this episode: the rows `strength` of `init`"),
    row(Muscle, "fibre_length", Read::FibreLength, "number, m", "length of the contractile part"),
    row(Muscle, "tendon_length", Read::TendonLength, "number, m", "length of the tendon; constant where tendons are rigid"),
    row(Muscle, "moment_arm(muscle, joint)", Read::MomentArm, "number, m", "moment arm about a hinge, positive if tension increases the coordinate; dimensionless for a slide"),
    row(CentreOfMass, "position", Read::Position, "place, m", "centre of mass of the body alone, without objects"),
    row(CentreOfMass, "velocity", Read::Velocity, "vec3, m/s", "its velocity, all three components"),
    row(CentreOfMass, "speed", Read::Speed, "number, m/s", "length of its velocity"),
    row(CentreOfMass, "height", Read::Height, "number, m", "z of its position"),
    row(CentreOfMass, "acceleration", Read::Acceleration, "vec3, m/s^2", "mean acceleration over the control step"),
    row(WholeBody, "angular_momentum", Read::AngularMomentum, "vec3, kg*m^2/s", "about the centre of mass, expressed in the world frame"),
    row(WholeBody, "body_mass", Read::BodyMass, "number, kg", "mass of the body alone"),
    row(WholeBody, "spine", Read::Spine, "vec3", "unit vector from the pelvis to the head, expressed in the world frame"),
    row(WholeBody, "action", Read::Action, "list", "action of the policy, entries in -1..1: one per muscle, or as the task's `act` has them"),
    row(WholeBody, "excitation", Read::Excitation, "list", "excitations of all muscles"),
    row(WholeBody, "activation", Read::Activation, "list", "activations of all muscles"),
    row(WholeBody, "body_weight", Read::BodyWeight, "number, N", "weight of the body alone"),
    row(WholeBody, "centre_of_pressure", Read::CentreOfPressure, "place, m", "mean of the contact points with the ground, weighted by the vertical force; without contact the point at z = 0 below `com`"),
    row(WholeBody, "support_margin", Read::SupportMargin, "number, m", "horizontal distance from `com` to the edge of the hull of all ground contacts, positive inside; without contact minus the height of `com`"),
    row(WholeBody, "robot", Read::Robot, "group", "all shapes of the body, as one side of a contact"),
    row(Contact, "touching(a, b)", Read::Touching, "condition", "whether two entities are in contact: landmarks (their segments), objects with their parts, groups, `robot`, `ground`"),
    row(Contact, "contact_force(a, b)", Read::ContactForce, "vec3, N", "force on a by b, expressed in the world frame"),
    row(Contact, "contact_count(a, b)", Read::ContactCount, "int", "number of contact points"),
    row(Contact, "surface_distance(a, b)", Read::SurfaceDistance, "number, m", "distance of the nearest surfaces, negative if they overlap"),
    row(Contact, "slip(a, b)", Read::Slip, "number, m/s", "sliding speed of a on b, weighted by the contact pressure; 0 without contact"),
    row(Ground, "ground_height(place)", Read::Query, "number, m", "height of walkable ground under a landmark or a constant place"),
    row(Ground, "ground_height(landmark, [forward, left, up])", Read::Query, "number, m", "the same at a constant offset along its heading"),
    row(Ground, "ground_normal(place)", Read::Query, "vec3", "upward unit normal of the ground there, expressed in the world frame"),
    row(Ground, "scan(heading(landmark), offsets)", Read::Query, "list, m", "heights of the ground at constant offsets [forward, left]"),
    row(Ground, "radar(from, group, sectors, over, range)", Read::Query, "list", "nearness 0..1 of the nearest member per sector, left to right"),
    row(Ground, "ray(from, direction, range)", Read::Query, "number, m", "distance to the first surface of the scene, at most the range"),
    row(Time, "t", Read::Time, "number, s", "time since reset"),
    row(Time, "dt", Read::Interval, "number, s", "length of a control step"),
    row(Time, "step", Read::Step, "int", "control steps since reset"),
    row(Time, "horizon", Read::Horizon, "int", "control steps of a full episode"),
    row(Time, "terminated", Read::Terminated, "condition", "a reason of `terminate` holds now"),
    row(Time, "truncated", Read::Truncated, "condition", "the horizon is reached and nothing else ends the episode"),
    row(Time, "ended", Read::Ended, "condition", "the episode ends with this step, for any reason"),
    row(Time, "survived", Read::Survived, "condition", "the horizon is reached without a termination"),
    row(Time, "finished", Read::Finished, "condition", "a reason of `finish` holds now"),
    row(Time, "pi", Read::Pi, "number", "the number 3.14159..., dimensionless"),
    row(Reference, "phase", Read::Followed, "number", "elapsed fraction of the motion: from 0 to below 1 in a cycle, else up to 1"),
    row(Reference, "joints", Read::Followed, "joints", "the joints with a column in its table"),
    row(Reference, "q(joint)", Read::Followed, "number, rad or m", "reference coordinate of a joint, or of each of a list; `gait.q` by itself for all joints with a column"),
    row(Reference, "qd(joint)", Read::Followed, "number, rad/s or m/s", "reference velocity of a joint"),
    row(Reference, "root", Read::Followed, "place, m", "reference position of the root: the initial position plus the displacement of the motion, at the motion's height"),
    row(Reference, "velocity", Read::Followed, "vec3, m/s", "reference velocity of the root, expressed in the world frame"),
    row(Reference, "heading", Read::Followed, "number, rad", "reference heading of the root, left positive"),
    row(Reference, "pitch", Read::Followed, "number, rad", "reference pitch of the root, nose down positive"),
    row(Reference, "roll", Read::Followed, "number, rad", "reference roll of the root, right side down positive"),
    row(Reference, "site(landmark)", Read::Followed, "place, m", "reference position of a landmark, or of each of a list"),
];

/// The signals of an owner.
pub fn of(owner: Owner) -> impl Iterator<Item = &'static Signal> {
    SIGNALS.iter().filter(move |signal| signal.owner == owner)
}

/// The signal called `name` on `owner`; functions without their parameters.
pub fn find(owner: Owner, name: &str) -> Option<&'static Signal> {
    of(owner).find(|signal| signal.name.split('(').next() == Some(name))
}

/// The table for people.
pub fn table() -> String {
    let owners = [Landmark, Object, Joint, Muscle, CentreOfMass, WholeBody, Contact, Ground, Time, Reference];
    let mut text = String::new();
    for owner in owners {
        text += &format!("{}\n", owner.heading());
        for signal in of(owner) {
            let later = if signal.supported { "" } else { " (not measured yet)" };
            text += &format!("    {:<26} {:<24} {}{later}\n", signal.name, signal.kind, signal.description);
        }
    }
    text
}

/// The table as it stands in the reference.
pub fn markdown() -> String {
    let owners = [Landmark, Object, Joint, Muscle, CentreOfMass, WholeBody, Contact, Ground, Time, Reference];
    let mut text = String::new();
    for owner in owners {
        text += &format!("### {}\n\n| signal | type, unit | description |\n|---|---|---|\n", owner.heading());
        for signal in of(owner) {
            let later = if signal.supported { "" } else { " *(not measured yet)*" };
            text += &format!("| `{}` | {} | {}{later} |\n", signal.name, signal.kind, signal.description);
        }
        text.push('\n');
    }
    text
}
