//! Scene and initial state as text.

use super::super::report::*;
use super::{drawn, varies};
use crate::init::{Alignment, Moves, Variation};
use crate::numbers::for_people;
use crate::scene::{Motion, Object, ObjectJointKind, Parent, Shape, Terrain};
use crate::snapshot::names;
use crate::task::{CompiledTask, Disturbance, Init, Setting, Spread};
use crate::vocabulary::JointKind;

pub(super) fn scene(task: &CompiledTask, init: &Init) -> SceneReport {
    let scene = &task.scene;
    let name_of = |index: usize| scene.objects.get(index).map_or_else(|| index.to_string(), |object| object.name.clone());
    let objects = scene.objects.iter().enumerate().map(|(index, object)| {
        let (kind, size) = shape(object);
        // Where chance places an object, the scene has no place for it.
        let start = init.objects.iter().find(|start| start.object == index && task.init.objects != init.objects);
        ObjectReport {
            name: object.name.clone(),
            description: object.description.clone(),
            kind: kind.to_owned(),
            size,
            parent: match &object.parent {
                Parent::World => "world".to_owned(),
                Parent::Object(index) => name_of(*index),
                Parent::Landmark(name) => name.clone(),
            },
            position: start.map_or(object.position, |start| start.position),
            orientation: object.orientation,
            motion: motion(&object.motion),
            mass: object.mass,
            friction: object.surface.friction[0],
            solid: object.surface.solid,
            walkable: object.surface.walkable,
        }
    });
    let connections = scene.connections.iter().enumerate().map(|(index, held)| ConnectionReport {
        kind: if held.weld { "weld" } else { "connect" }.to_owned(),
        from: held.from.clone(),
        to: held.to.clone(),
        released: task.releases.contains(&index),
    });
    SceneReport {
        ground: scene.ground.is_some(),
        objects: objects.collect(),
        connections: connections.collect(),
        groups: scene
            .groups
            .iter()
            .map(|(name, members)| (name.clone(), members.iter().map(|&m| name_of(m)).collect()))
            .collect(),
        markers: task.markers.clone(),
    }
}

/// What an element is, and how large.
fn shape(object: &Object) -> (&'static str, String) {
    let extents = |lengths: &[f64]| {
        let lengths: Vec<String> = lengths.iter().map(|length| for_people(*length)).collect();
        format!("{} m", lengths.join(" \u{d7} "))
    };
    match &object.shape {
        None => ("body", String::new()),
        Some(Shape::Box(size)) => ("box", extents(size)),
        Some(Shape::Sphere(radius)) => ("sphere", format!("radius {} m", for_people(*radius))),
        Some(Shape::Capsule(radius, length)) => {
            ("capsule", format!("radius {} m, length {} m", for_people(*radius), for_people(*length)))
        }
        Some(Shape::Cylinder(radius, length)) => {
            ("cylinder", format!("radius {} m, length {} m", for_people(*radius), for_people(*length)))
        }
        Some(Shape::Ellipsoid(axes)) => ("ellipsoid", format!("semi-axes {}", extents(axes))),
        Some(Shape::Plane) => ("plane", String::new()),
        Some(Shape::Terrain(Terrain::Stairs { count, rise, run, width })) => (
            "stairs",
            format!("{count} steps of {} m over {} m, {} m wide", for_people(*rise), for_people(*run), for_people(*width)),
        ),
        Some(Shape::Terrain(Terrain::Heights { size, samples, .. })) => {
            ("heights", format!("{}, {} \u{d7} {} samples", extents(size), samples[0], samples[1]))
        }
        Some(Shape::Terrain(Terrain::Slope { length, width, angle })) => {
            ("slope", format!("{} m long, {} m wide, {} rad", for_people(*length), for_people(*width), for_people(*angle)))
        }
    }
}

fn motion(motion: &Motion) -> String {
    match motion {
        Motion::Fixed => "fixed".to_owned(),
        Motion::Placed => "placed for every episode".to_owned(),
        Motion::Driven => "moved by a formula of time".to_owned(),
        Motion::Free => "free".to_owned(),
        Motion::Joints(joints) => {
            let words = joints.iter().map(|joint| {
                let (kind, unit) = match joint.kind {
                    ObjectJointKind::Hinge => ("hinge", "rad"),
                    ObjectJointKind::Slide => ("slide", "m"),
                    ObjectJointKind::Ball => ("ball", "rad"),
                };
                let range = joint
                    .range
                    .map_or_else(String::new, |[low, high]| format!(" {} to {} {unit}", for_people(low), for_people(high)));
                format!("{kind} {}{range}", joint.name)
            });
            words.collect::<Vec<_>>().join(", ")
        }
    }
}

/// `begun` with the middle of what is drawn.
pub(super) fn disturbances(task: &CompiledTask, begun: &[Disturbance]) -> Vec<DisturbanceReport> {
    let varies = varies(task);
    let seconds = |steps: u32| f64::from(steps) / task.control_frequency;
    let own = |disturbance: usize| {
        let drawn = task.drawn_disturbances.iter();
        drawn.filter(move |(of, ..)| *of == disturbance).filter(|(.., index)| varies(*index))
    };
    let reports = begun.iter().enumerate().map(|(index, disturbance)| DisturbanceReport {
        on: names::landmark(&task.vocabulary, disturbance.landmark),
        force: disturbance.force,
        torque: disturbance.torque,
        start: seconds(disturbance.start),
        duration: seconds(disturbance.steps),
        every: (disturbance.every > 0).then(|| seconds(disturbance.every)),
        drawn: own(index).map(|&(_, setting, _)| names::disturbance_setting(setting)).collect(),
    });
    reports.collect()
}

pub(super) fn initial_state(task: &CompiledTask, init: &Init) -> InitialStateReport {
    let joints = task.vocabulary.joints.iter().zip(&init.coordinates);
    let joints = joints.filter(|(joint, value)| **value != joint.neutral).map(|(joint, &value)| JointReport {
        name: joint.name.clone(),
        value,
        neutral: joint.neutral,
        unit: if joint.kind == JointKind::Hinge { "rad" } else { "m" }.to_owned(),
        independent: joint.independent,
    });
    let mut noise = Vec::new();
    for (what, per, spreads) in [("joints", "", &init.coordinate_noise), ("velocities", "/s", &init.velocity_noise)] {
        for (spread, joints) in crate::snapshot::by_spread(spreads) {
            let all = spreads.iter().filter(|spread| **spread != Spread::None).count() == joints.len();
            let whom = match joints.as_slice() {
                _ if all && joints.len() > 3 => format!("all {} independent", joints.len()),
                few if few.len() <= 4 => {
                    few.iter().map(|&joint| names::joint(&task.vocabulary, joint)).collect::<Vec<_>>().join(", ")
                }
                many => format!("{} joints", many.len()),
            };
            noise.push(format!("{what}: {} on {whom}", spread_in_words(spread, per)));
        }
    }
    InitialStateReport {
        root: root(task, init),
        joints: joints.collect(),
        noise,
        objects: objects(task, init),
        scaled: scaled(task),
        drawn: drawn(task),
        settle: init.settle.as_ref().map_or_else(String::new, |settle| {
            let rest = if settle.at_rest { ", then at rest" } else { "" };
            format!("{} physics steps with activation {}{rest}", settle.steps, for_people(settle.activation))
        }),
    }
}

/// Factors of strengths and masses but for those that a `random` decides, which are listed as drawn.
fn scaled(task: &CompiledTask) -> Vec<String> {
    let Variation { strengths, segments, dampings, stiffnesses, .. } = &task.init.variation;
    let is_drawn = |setting: Setting| task.init.drawn.iter().any(|(known, _)| *known == setting);
    let strengths = strengths.iter().enumerate().map(|(row, scaling)| (Setting::Strength(row), scaling));
    let segments = segments.iter().enumerate().map(|(row, scaling)| (Setting::SegmentMass(row), scaling));
    let dampings = dampings.iter().enumerate().map(|(row, scaling)| (Setting::Damping(row), scaling));
    let stiffnesses = stiffnesses.iter().enumerate().map(|(row, scaling)| (Setting::Stiffness(row), scaling));
    let known = strengths.chain(segments).chain(dampings).chain(stiffnesses).filter(|(setting, _)| !is_drawn(*setting));
    let words = known.map(|(setting, scaling)| {
        let what = names::setting(task, setting);
        match scaling.each {
            None => format!("{what} times {}", for_people(scaling.factor)),
            Some([low, high]) => format!("{what}, each times a draw from {} to {}", for_people(low), for_people(high)),
        }
    });
    words.collect()
}

fn spread_in_words(spread: Spread, per: &str) -> String {
    match spread {
        Spread::None => "none".to_owned(),
        Spread::Normal(deviation) => format!("normal, standard deviation {} rad{per}", for_people(deviation)),
        Spread::Uniform(low, high) => format!("uniform, {} to {} rad{per}", for_people(low), for_people(high)),
    }
}

fn root(task: &CompiledTask, init: &Init) -> String {
    let root = &init.root;
    let mut parts = Vec::new();
    if root.meets.is_empty() {
        parts.push(
            root.height.map_or_else(|| "on the ground".to_owned(), |height| format!("at a height of {} m", for_people(height))),
        );
        if root.position != [0.0; 2] {
            parts.push(format!("at x {} m, y {} m", for_people(root.position[0]), for_people(root.position[1])));
        }
    }
    if root.lift != 0.0 {
        parts.push(format!("lifted by {} m", for_people(root.lift)));
    }
    for (landmark, place) in &root.meets {
        parts.push(format!("{} at {}", names::landmark(&task.vocabulary, *landmark), names::origin(&task.vocabulary, place)));
    }
    for (word, angle) in [("heading", root.heading), ("pitched", root.pitch), ("rolled", root.roll)] {
        if angle != 0.0 {
            parts.push(format!("{word} {}\u{b0}", for_people(angle.to_degrees())));
        }
    }
    if init.follows.is_some() {
        parts.push("on its reference motion".to_owned());
    }
    if root.velocity != [0.0; 3] {
        parts.push(format!("moving at {} m/s", vector(root.velocity)));
    }
    if root.spin != [0.0; 3] {
        parts.push(format!("turning at {} rad/s", vector(root.spin)));
    }
    parts.join(", ")
}

fn vector(vector: [f64; 3]) -> String {
    format!("[{}]", vector.map(for_people).join(", "))
}

/// Free elements that move, or start elsewhere than they stand in the scene.
fn objects(task: &CompiledTask, init: &Init) -> Vec<String> {
    let texts = init.objects.iter().filter_map(|start| {
        let object = task.scene.objects.get(start.object)?;
        let mut parts = Vec::new();
        let aligned = init.alignments.iter().filter(|alignment| alignment.moves == Moves::Object(start.object));
        for Alignment { landmark, target, .. } in aligned {
            let place = match names::landmark(&task.vocabulary, *landmark) {
                place if place == object.name => String::new(),
                place => format!("with {place} "),
            };
            parts.push(format!("{place}at {}", names::origin(&task.vocabulary, target)));
        }
        if start.position != object.position {
            parts.push(format!("at {} m", vector(start.position)));
        }
        if start.velocity != [0.0; 3] {
            parts.push(format!("moving at {} m/s", vector(start.velocity)));
        }
        if start.spin != [0.0; 3] {
            parts.push(format!("turning at {} rad/s", vector(start.spin)));
        }
        (!parts.is_empty()).then(|| format!("{} {}", object.name, parts.join(", ")))
    });
    texts.collect()
}
