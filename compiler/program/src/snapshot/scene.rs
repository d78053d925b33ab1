//! Scene and initial state in a snapshot.

use super::names;
use super::{Section, encoding};
use crate::action::{ActionSpace, ActionTarget, Along, BaseController, distinct};
use crate::digest::sha256;
use crate::graph::text::values;
use crate::init::{Moves, Scaling, Variation};
use crate::numbers::exact;
use crate::scene::{Object, Parent};
use crate::task::{CompiledTask, Setting, Spread};

/// Longest list of numbers that is written out.
const LONGEST: usize = 300;

impl CompiledTask {
    pub(super) fn scene_sections(&self, sections: &mut Vec<Section>) {
        let scene = &self.scene;
        let ground = scene.ground.map_or_else(|| "none".to_owned(), |surface| plain(encoding::surface(&surface)));
        sections.push(Section::new("ground", "").field("surface", ground));
        for object in &scene.objects {
            sections.push(self.object_section(object));
        }
        for (index, connection) in scene.connections.iter().enumerate() {
            let kind = if connection.weld { "weld" } else { "connect" };
            sections.push(
                Section::new("connection", &self.connection_name(index)).field("kind", kind).field("here", connection.here),
            );
        }
        for (name, members) in &scene.groups {
            let members: Vec<&str> =
                members.iter().filter_map(|&member| scene.objects.get(member)).map(|object| object.name.as_str()).collect();
            sections.push(Section::new("group", name).field("members", members.join(", ")));
        }
        for (index, disturbance) in self.disturbances.iter().enumerate() {
            let section = Section::new("disturbance", &(index + 1).to_string())
                .field("on", names::landmark(&self.vocabulary, disturbance.landmark))
                .field("force", format!("{:?} N", disturbance.force))
                .field("torque", format!("{:?} N m", disturbance.torque))
                .field("at", format!("{} steps", disturbance.start))
                .field("for", format!("{} steps", disturbance.steps));
            sections.push(match disturbance.every {
                0 => section,
                every => section.field("every", format!("{every} steps")),
            });
        }
    }

    /// None where an action is one entry per muscle, as it is without `act`.
    pub(super) fn action_section(&self) -> Option<Section> {
        let ActionSpace { target, activations, scale, filter, latency, residual } = &self.action;
        if self.action.is_default() {
            return None;
        }
        let section = Section::new("act", self.action.word());
        let muscles = |chosen: &[usize]| {
            let names = chosen.iter().filter_map(|&muscle| self.vocabulary.muscles.get(muscle));
            names.map(|muscle| muscle.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let joints = |chosen: &[usize]| {
            let names = chosen.iter().filter_map(|&joint| self.vocabulary.joints.get(joint));
            names.map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let section = match target {
            ActionTarget::AllMuscles => section,
            ActionTarget::Muscles(chosen) => section.field("of", muscles(chosen)),
            ActionTarget::Synergies(synergies) => {
                synergies.iter().fold(section, |section, synergy| section.field(&synergy.name, muscles(&synergy.muscles)))
            }
            ActionTarget::Torque { joints: chosen, ranges } => {
                let each: Vec<String> = distinct(ranges).iter().map(|&range| exact(range)).collect();
                section.field("joints", joints(chosen)).field("range", format!("{} N m", each.join(", ")))
            }
            ActionTarget::MuscleControl(offsets) => {
                let ranges = [
                    ("range", offsets.range, "rad"),
                    ("com", offsets.center_of_mass, "m"),
                    ("root", offsets.root, "rad"),
                    ("reach", offsets.reach, "m"),
                ];
                let moved = ranges.into_iter().filter(|(_, range, _)| *range > 0.0);
                let section = section.field("joints", joints(&offsets.joints));
                let moved =
                    moved.fold(section, |section, (name, range, unit)| section.field(name, format!("{} {unit}", exact(range))));
                match offsets.along {
                    Along::Reference => moved,
                    Along::Demonstration => moved.field("along", "demonstration"),
                    Along::Gait { speed, pace, then } => {
                        let [forward, left, turn] = pace.map(exact);
                        let moved = moved.field("pace", format!("{forward} m/s, {left} m/s, {turn} rad/s"));
                        let moved = moved.field("speed", format!("{} m/s", exact(speed)));
                        then.iter()
                            .fold(moved, |moved, start| moved.field("along", format!("demonstration from {} s", exact(*start))))
                    }
                }
            }
        };
        let section = if *activations { section.field("entries", "activations") } else { section };
        let section = section.field("scale", exact(*scale)).field("filter", format!("{} s", exact(*filter)));
        let section = section.field("latency", format!("{latency} steps"));
        Some(residual.iter().fold(section, |section, base| match base {
            BaseController::Network(network) => section.field("residual", format!("network {}", network.digest)),
            named => section.field("residual", named.name()),
        }))
    }

    fn object_section(&self, object: &Object) -> Section {
        let parent = match &object.parent {
            Parent::World => "world".to_owned(),
            Parent::Object(index) => {
                self.scene.objects.get(*index).map_or_else(|| index.to_string(), |parent| parent.name.clone())
            }
            Parent::Landmark(name) => format!("the body's {name}"),
        };
        Section::new("object", &object.name)
            .field("on", parent)
            .field("shape", object.shape.as_ref().map_or_else(|| "none".to_owned(), |shape| plain(encoding::shape(shape))))
            .field("position", format!("{:?} m", object.position))
            .field("orientation", format!("{:?}", object.orientation))
            .field("motion", plain(encoding::motion(&object.motion)))
            .field("mass", format!("{:?} kg", object.mass))
            .field("surface", plain(encoding::surface(&object.surface)))
    }

    /// A connection under the names of its ends.
    pub(super) fn connection_name(&self, index: usize) -> String {
        let known = self.scene.connections.get(index);
        known.map_or_else(|| index.to_string(), |held| format!("{} to {}", held.from, held.to))
    }

    pub(super) fn initial_state_sections(&self, sections: &mut Vec<Section>) {
        let root = &self.init.root;
        let mut section = Section::new("root", "")
            .field("height", root.height.map_or_else(|| "on ground".to_owned(), |height| format!("{height:?} m")))
            .field("position", format!("{:?} m", root.position))
            .field("orientation", format!("heading {:?} rad, pitch {:?} rad, roll {:?} rad", root.heading, root.pitch, root.roll))
            .field("velocity", format!("{:?} m/s", root.velocity));
        for (landmark, place) in &root.meets {
            let meets = names::origin(&self.vocabulary, place);
            section = section.field(&format!("align {}", names::landmark(&self.vocabulary, *landmark)), format!("to {meets}"));
        }
        if root.lift != 0.0 {
            section = section.field("lift", format!("{:?} m", root.lift));
        }
        if root.spin != [0.0; 3] {
            section = section.field("spin", format!("{:?} rad/s", root.spin));
        }
        sections.push(section);
        if let Some(following) = &self.init.follows {
            let joints: Vec<usize> = following.parts.joints.iter().map(|(joint, _)| *joint).collect();
            sections.push(
                Section::new("follows", "")
                    .field("motion", following.motion.digest())
                    .field("joints", self.joint_runs(&joints))
                    .field(
                        "root",
                        format!("[{}]", following.parts.root.iter().map(|part| part.heading()).collect::<Vec<_>>().join(", ")),
                    )
                    .field("velocity", following.parts.velocity),
            );
        }
        let mut velocities = Section::new("velocities", "");
        for (joint, &velocity) in
            self.vocabulary.joints.iter().zip(&self.init.velocities).filter(|(_, velocity)| **velocity != 0.0)
        {
            velocities = velocities.field(&joint.name, format!("{velocity:?}"));
        }
        sections.extend((!velocities.fields.is_empty()).then_some(velocities));
        let mut pose = Section::new("pose", "");
        for (joint, &coordinate) in self.vocabulary.joints.iter().zip(&self.init.coordinates) {
            if coordinate.to_bits() != joint.neutral.to_bits() {
                pose = pose.field(&joint.name, format!("{coordinate:?}"));
            }
        }
        sections.push(pose);
        for (name, spreads) in [("coordinates", &self.init.coordinate_noise), ("velocities", &self.init.velocity_noise)] {
            let mut section = Section::new("noise", name);
            for (spread, joints) in by_spread(spreads) {
                section = section.field(&spread_text(spread), self.joint_runs(&joints));
            }
            if !section.fields.is_empty() {
                sections.push(section);
            }
        }
        sections.extend(self.variation_section());
        for start in &self.init.objects {
            let name =
                self.scene.objects.get(start.object).map_or_else(|| start.object.to_string(), |object| object.name.clone());
            sections.push(
                Section::new("start", &name)
                    .field("position", format!("{:?} m", start.position))
                    .field("orientation", format!("{:?}", start.orientation))
                    .field("velocity", format!("{:?} m/s", start.velocity))
                    .field("spin", format!("{:?} rad/s", start.spin)),
            );
        }
        for alignment in &self.init.alignments {
            let moved = match &alignment.moves {
                Moves::Joints(joints) => self.joint_runs(joints),
                Moves::Object(object) => {
                    self.scene.objects.get(*object).map_or_else(|| object.to_string(), |object| object.name.clone())
                }
            };
            sections.push(
                Section::new("align", &names::landmark(&self.vocabulary, alignment.landmark))
                    .field("to", names::origin(&self.vocabulary, &alignment.target))
                    .field("moves", moved),
            );
        }
        if let Some(settle) = &self.init.settle {
            sections.push(
                Section::new("settle", "")
                    .field("steps", settle.steps)
                    .field("activation", settle.activation)
                    .field("at rest", settle.at_rest),
            );
        }
    }

    /// What episodes have of their own; none where they have the body and the scene of the model.
    fn variation_section(&self) -> Option<Section> {
        let Variation { strengths, segments, dampings, stiffnesses, masses, frictions, joints, shapes } = &self.init.variation;
        let mut section = Section::new("variation", "");
        let scale = |scaling: &Scaling| match scaling.each {
            None => exact(scaling.factor),
            Some([low, high]) => format!("each uniform {low:?}..{high:?}"),
        };
        let strengths = strengths.iter().enumerate().map(|(row, scaling)| (Setting::Strength(row), scale(scaling)));
        let segments = segments.iter().enumerate().map(|(row, scaling)| (Setting::SegmentMass(row), scale(scaling)));
        let dampings = dampings.iter().enumerate().map(|(row, scaling)| (Setting::Damping(row), scale(scaling)));
        let stiffnesses = stiffnesses.iter().enumerate().map(|(row, scaling)| (Setting::Stiffness(row), scale(scaling)));
        let masses = masses.iter().enumerate().map(|(row, known)| (Setting::ObjectMass(row), format!("{:?} kg", known.mass)));
        let frictions = frictions.iter().enumerate().map(|(row, known)| (Setting::Friction(row), exact(known.sliding)));
        let joints = joints.iter().enumerate().map(|(row, known)| (Setting::ObjectJoint(row), exact(known.value)));
        let factors = strengths.chain(segments).chain(dampings).chain(stiffnesses);
        for (setting, value) in factors.chain(masses).chain(frictions).chain(joints) {
            section = section.field(&names::setting(self, setting), value);
        }
        for known in shapes {
            let name = self.scene.objects.get(known.object).map_or("?", |object| &object.name);
            section = section.field(&format!("{name}.shape"), plain(format!("{:?}", known.shape)));
        }
        (!section.fields.is_empty()).then_some(section)
    }

    /// Names of joints, neighbours in the list joined.
    fn joint_runs(&self, joints: &[usize]) -> String {
        names::runs(joints, |index| names::joint(&self.vocabulary, index))
    }
}

fn spread_text(spread: Spread) -> String {
    match spread {
        Spread::None => "none".to_owned(),
        Spread::Normal(deviation) => format!("normal {deviation:?}"),
        Spread::Uniform(low, high) => format!("uniform {low:?}..{high:?}"),
    }
}

/// Joints that scatter alike, by the first of each.
pub fn by_spread(spreads: &[Spread]) -> Vec<(Spread, Vec<usize>)> {
    let mut sorted: Vec<(Spread, Vec<usize>)> = Vec::new();
    for (joint, &spread) in spreads.iter().enumerate().filter(|(_, spread)| **spread != Spread::None) {
        match sorted.iter_mut().find(|(known, _)| *known == spread) {
            Some((_, joints)) => joints.push(joint),
            None => sorted.push((spread, vec![joint])),
        }
    }
    sorted
}

/// Plain data on one line; long lists, such as the heights of a terrain, as their hash.
fn plain(text: String) -> String {
    if text.len() <= LONGEST { text } else { format!("{} characters, sha256 {}", text.len(), sha256(text.as_bytes())) }
}

/// The numbers of a pose that the hash covers whether or not they are those of the neutral one.
pub(super) fn coordinates(task: &CompiledTask) -> String {
    values(task.init.coordinates.iter().copied())
}
