//! What is measured, as calls of the support module.

use crate::readers::Method;
use crate::text::{number, quoted};
use msk_physics::model::{GeomKind, Model};
use msk_program::frame::{Origin, Query, Sensor, Subject};
use msk_program::graph::NodeId;
use msk_program::graph::operation::Operation;
use msk_program::scene::Part;
use msk_program::task::{CompiledTask, Phase};
use msk_program::vocabulary::GroupKind;
use msk_runtime::body::Body;
use std::collections::{BTreeMap, BTreeSet};
use std::mem::discriminant;

/// Longest list of names that stands where it is used.
const SHORT: usize = 4;

/// Writes what is measured, and keeps the names that this takes.
pub(crate) struct Measured<'a> {
    pub task: &'a CompiledTask,
    pub body: &'a Body,
    pub model: &'a Model,
    /// Landmarks that are read.
    pub landmarks: BTreeSet<usize>,
    /// Groups of landmarks that are read.
    pub groups: BTreeSet<usize>,
    /// Joints that are read.
    pub joints: BTreeSet<usize>,
    /// Lists of names, by constant.
    pub lists: BTreeMap<String, Vec<String>>,
}

impl<'a> Measured<'a> {
    pub fn new(task: &'a CompiledTask, body: &'a Body, model: &'a Model) -> Self {
        let (landmarks, groups, joints, lists) = Default::default();
        Self { task, body, model, landmarks, groups, joints, lists }
    }

    /// Sensors side by side.
    pub fn list(&mut self, sensors: &[Sensor], reasons: &mut Vec<String>) -> String {
        let mut parts = Vec::new();
        for alike in sensors.chunk_by(|a, b| discriminant(a) == discriminant(b)) {
            match of_list(alike[0]) {
                Some(signal) => {
                    if matches!(alike[0], Sensor::Action(_)) && !self.task.action.is_default() {
                        reasons.push("the action that reaches a muscle, where the task has an `act` block".to_owned());
                    }
                    let names: Vec<String> = alike.iter().map(|sensor| self.name(sensor.subject())).collect();
                    let place = if sensors.len() == 1 { "[0]" } else { "" };
                    parts.push(format!("self.now.{signal}({}){place}", self.names(alike[0], names)));
                }
                None if matches!(alike[0], Sensor::ActionEntry(_)) => parts.push(entries(alike)),
                None => parts.extend(alike.iter().map(|&sensor| self.single(sensor, reasons))),
            }
        }
        match parts.as_slice() {
            [only] => only.clone(),
            several => format!("join({})", several.join(", ")),
        }
    }

    /// Components of the axes of a landmark: `up("torso")[2]`.
    pub fn component(
        &mut self,
        phase: &Phase,
        lanes: &[u32],
        input: NodeId,
        methods: &BTreeMap<NodeId, Method>,
    ) -> Option<String> {
        let Operation::Sensors(sensors) = &phase.graph.node(input).operation else { return None };
        let [Sensor::LandmarkAxes(landmark)] = **sensors else { return None };
        let axis = *lanes.first()? / 3;
        if methods.contains_key(&input) || lanes.iter().any(|lane| lane / 3 != axis) {
            return None;
        }
        let name = quoted(&self.name(Subject::Landmark(landmark)));
        let word = ["forward", "left", "up"].get(axis as usize)?;
        let places: Vec<u32> = lanes.iter().map(|lane| lane % 3).collect();
        let whole = format!("self.now.{word}({name})");
        Some(match places.as_slice() {
            [0, 1, 2] => whole,
            [only] => format!("{whole}[{only}]"),
            several => format!("{whole}[{several:?}]"),
        })
    }

    /// The name of what a sensor measures; it is kept.
    fn name(&mut self, subject: Subject) -> String {
        let vocabulary = &self.task.vocabulary;
        match subject {
            Subject::Landmark(index) => {
                self.landmarks.insert(index);
                vocabulary.landmarks.get(index).map_or_else(String::new, |landmark| landmark.name.clone())
            }
            Subject::Joint(index) => {
                self.joints.insert(index);
                vocabulary.joints.get(index).map_or_else(String::new, |joint| joint.name.clone())
            }
            Subject::Muscle(index) | Subject::MuscleAbout(index, _) => {
                vocabulary.muscles.get(index).map_or_else(String::new, |muscle| muscle.name.clone())
            }
            Subject::Whole | Subject::Parts(..) | Subject::Query(_) => String::new(),
        }
    }

    /// Arguments: the names, or a constant that lists them.
    fn names(&mut self, sensor: Sensor, names: Vec<String>) -> String {
        if names.len() <= SHORT {
            return names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", ");
        }
        if let Some((known, _)) = self.lists.iter().find(|(_, list)| **list == names) {
            return format!("*{known}");
        }
        let vocabulary = &self.task.vocabulary;
        let kind = if matches!(sensor.subject(), Subject::Joint(_)) { GroupKind::Joints } else { GroupKind::Muscles };
        let part = |index: usize| match kind {
            GroupKind::Joints => vocabulary.joints.get(index).map(|joint| &joint.name),
            _ => vocabulary.muscles.get(index).map(|muscle| &muscle.name),
        };
        let same = |members: &mut dyn Iterator<Item = usize>| members.filter_map(part).eq(names.iter());
        let group = vocabulary.groups.iter().find(|group| group.kind == kind && same(&mut group.members.iter().copied()));
        let own = || vocabulary.joints.iter().enumerate().filter(|(_, joint)| !joint.of_scene);
        let all = match kind {
            GroupKind::Joints if same(&mut own().map(|(index, _)| index)) => Some("joints"),
            GroupKind::Joints if same(&mut own().filter(|(_, joint)| joint.independent).map(|(index, _)| index)) => {
                Some("independent")
            }
            GroupKind::Muscles if same(&mut (0..vocabulary.muscles.len())) => Some("muscles"),
            _ => None,
        };
        let wanted = group.map_or(all.unwrap_or("names"), |group| group.name.as_str()).to_ascii_uppercase();
        let mut name = wanted.clone();
        for number in 2.. {
            if !self.lists.contains_key(&name) {
                break;
            }
            name = format!("{wanted}_{number}");
        }
        self.lists.insert(name.clone(), names);
        format!("*{name}")
    }

    /// A sensor by itself.
    fn single(&mut self, sensor: Sensor, reasons: &mut Vec<String>) -> String {
        use Sensor as S;
        if let Some(signal) = of_landmark(sensor) {
            if matches!(sensor, S::LandmarkClearance(_)) {
                self.must_be_level(reasons);
            }
            return format!("self.now.{signal}({})", quoted(&self.name(sensor.subject())));
        }
        let between = |measured: &mut Self, signal: &str, first: Part, second: Part| {
            let (first, second) = (measured.part(first), measured.part(second));
            format!("self.now.{signal}({first}, {second})")
        };
        match sensor {
            S::ComPosition => "self.now.com_position()".to_owned(),
            S::ComVelocity => "self.now.com_velocity()".to_owned(),
            S::ComAcceleration => "self.now.com_acceleration()".to_owned(),
            S::AngularMomentum => "self.now.angular_momentum()".to_owned(),
            S::Time => "self.now.time".to_owned(),
            S::RootPosition => "self.now.position(\"the root\")".to_owned(),
            S::RootAxes => "self.now.axes(\"the root\")".to_owned(),
            S::RootVelocity => "self.now.velocity(\"the root\")".to_owned(),
            S::RootAngularVelocity => "self.now.angular_velocity(\"the root\")".to_owned(),
            S::GroundContact(landmark) => between(self, "touching", Part::Landmark(landmark), Part::Ground),
            S::GroundForce(landmark) => between(self, "contact_force", Part::Landmark(landmark), Part::Ground),
            S::Touching(first, second) => between(self, "touching", first, second),
            S::ContactForce(first, second) => between(self, "contact_force", first, second),
            S::ContactCount(first, second) => between(self, "contact_count", first, second),
            S::Slip(first, second) => between(self, "slip", first, second),
            S::Query(index, _) => self.query(index, reasons),
            other => {
                reasons.push(format!("{}: MuJoCo's data do not have it", described(other)));
                "np.nan".to_owned()
            }
        }
    }

    fn part(&mut self, part: Part) -> String {
        quoted(&match part {
            Part::Ground => "ground".to_owned(),
            Part::Robot => "robot".to_owned(),
            Part::Landmark(index) => self.name(Subject::Landmark(index)),
            Part::Group(index) => format!("group {}", self.group(index)),
        })
    }

    fn group(&mut self, index: usize) -> String {
        let Some(group) = self.task.vocabulary.groups.get(index) else { return String::new() };
        self.groups.insert(index);
        self.landmarks.extend(&group.members);
        group.name.clone()
    }

    fn query(&mut self, index: usize, reasons: &mut Vec<String>) -> String {
        match self.task.frame.queries().get(index).cloned() {
            Some(Query::GroundHeight(_) | Query::GroundNormal(_)) if self.has_mesh_ground() => {
                refused("`ground_height` of a mesh", reasons);
                "np.nan".to_owned()
            }
            Some(Query::GroundHeight(origin)) => format!("self.now.ground_height({})", self.origin(&origin)),
            Some(Query::Radar { from, group, sectors, over, range }) => {
                self.must_be_discs(group, reasons);
                let (from, group) = (quoted(&self.name(Subject::Landmark(from))), quoted(&self.group(group)));
                let (over, range) = (number(over), number(range));
                format!("self.now.radar({from}, {group}, sectors={sectors}, over={over}, span={range})")
            }
            Some(Query::GroundNormal(origin)) => format!("self.now.ground_normal({})", self.origin(&origin)),
            Some(Query::Ray { .. }) | None => {
                refused("`ray`", reasons);
                "np.nan".to_owned()
            }
        }
    }

    fn origin(&mut self, origin: &Origin) -> String {
        let list = |place: &[f64; 3]| place.map(number).join(", ");
        match origin {
            Origin::World(place) => format!("np.array([{}])", list(place)),
            Origin::Landmark(landmark, offset) => {
                let name = quoted(&self.name(Subject::Landmark(*landmark)));
                if *offset == [0.0; 3] {
                    format!("self.now.position({name})")
                } else {
                    format!("self.now.place({name}, [{}])", list(offset))
                }
            }
        }
    }

    fn must_be_level(&self, reasons: &mut Vec<String>) {
        let uneven = self.body.ground.iter().any(|&geom| self.model.geoms.kind[geom] != GeomKind::Plane);
        let reason = "`clearance` above ground that is not level: only planes are supported";
        if uneven && !reasons.iter().any(|known| known == reason) {
            reasons.push(reason.to_owned());
        }
    }

    fn has_mesh_ground(&self) -> bool {
        self.body.ground.iter().any(|&geom| self.model.geoms.kind[geom] == GeomKind::Mesh)
    }

    /// Radar sees discs: spheres, and cylinders that stand fixed and upright.
    fn must_be_discs(&self, group: usize, reasons: &mut Vec<String>) {
        let (geoms, bodies) = (&self.model.geoms, &self.model.bodies);
        let members = self.body.groups.get(group).map(|group| group.members.as_slice()).unwrap_or_default();
        let mut shapes = members.iter().flat_map(|&member| &self.body.landmarks[member].segment);
        let is_disc = |&geom: &usize| match geoms.kind[geom] {
            GeomKind::Sphere => true,
            GeomKind::Cylinder => bodies.weld[geoms.body[geom]] == 0,
            _ => false,
        };
        if !shapes.all(is_disc) {
            reasons.push("`radar` of shapes that are neither spheres nor fixed cylinders".to_owned());
        }
    }
}

/// What the support module cannot measure, named once.
fn refused(what: &str, reasons: &mut Vec<String>) {
    let reason = format!("{what} is not supported");
    if !reasons.contains(&reason) {
        reasons.push(reason);
    }
}

/// Signals that are read of several joints or muscles at once.
fn of_list(sensor: Sensor) -> Option<&'static str> {
    use Sensor as S;
    Some(match sensor {
        S::JointPosition(_) => "q",
        S::JointVelocity(_) => "qd",
        S::JointAcceleration(_) => "qdd",
        S::JointTorque(_) => "torque",
        S::MuscleLength(_) => "muscle_length",
        S::MuscleVelocity(_) => "muscle_velocity",
        S::MuscleForce(_) => "muscle_force",
        S::MuscleActivation(_) => "activation",
        S::MuscleExcitation(_) => "excitation",
        S::Action(_) => "muscle_action",
        _ => return None,
    })
}

fn of_landmark(sensor: Sensor) -> Option<&'static str> {
    use Sensor as S;
    Some(match sensor {
        S::LandmarkPosition(_) => "position",
        S::LandmarkVelocity(_) => "velocity",
        S::LandmarkAcceleration(_) => "acceleration",
        S::LandmarkAxes(_) => "axes",
        S::LandmarkAngularVelocity(_) => "angular_velocity",
        S::LandmarkClearance(_) => "clearance",
        _ => return None,
    })
}

/// Entries of the policy's action.
fn entries(sensors: &[Sensor]) -> String {
    let places: Vec<usize> =
        sensors.iter().filter_map(|sensor| if let Sensor::ActionEntry(entry) = sensor { Some(*entry) } else { None }).collect();
    match places.as_slice() {
        [only] => format!("self.now.action[{only}]"),
        [0, .., last] if *last + 1 == places.len() => format!("self.now.action[:{}]", places.len()),
        several => format!("self.now.action[{several:?}]"),
    }
}

fn described(sensor: Sensor) -> String {
    use Sensor as S;
    let signal = match sensor {
        S::JointReactionForce(_) => "`reaction_force`",
        S::JointReactionTorque(_) => "`reaction_torque`",
        S::MuscleFibreLength(_) => "`fibre_length`",
        S::MuscleFibreVelocity(_) => "the velocity of a fibre",
        S::MuscleTendonLength(_) => "`tendon_length`",
        S::MuscleStrength(_) => "`strength`",
        S::MuscleMetabolicPower(_) => "`metabolic_power`",
        S::MomentArm(..) => "`moment_arm`",
        S::CentreOfPressure => "`centre_of_pressure`",
        S::SupportMargin => "`support_margin`",
        S::SurfaceDistance(..) => "`surface_distance`",
        other => return other.word().to_owned(),
    };
    signal.to_owned()
}
