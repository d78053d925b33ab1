//! Plain data as text for snapshots and hashes, word by word: no name in it is that of a Rust type, field or variant, so that
//! renaming one changes no hash. Every field is taken apart by name: one that is added must be written here, or left out on
//! purpose.
//!
//! A change of what is written (a word, an order, a field, which rewrites the graph's folding makes) raises [`VERSION`].
//! `docs/content-hash.md` describes the whole.

use crate::body::{Axis, BodyDescription, Change, ExcitationMap, LandmarkDescription, Property, TendonKind};
use crate::scene::{Motion, ObjectJoint, ObjectJointKind, Shape, Surface, Terrain};

/// First line of what a hash is taken of: the encoding's name and number.
pub(super) const VERSION: &str = "msk content 3";

/// How a surface meets others.
pub(super) fn surface(surface: &Surface) -> String {
    let Surface { friction, decides, solid, walkable } = surface;
    let friction = ("friction", numbers(friction));
    let rest = [("solid", solid.to_string()), ("walkable", walkable.to_string())];
    // What most surfaces do not do is not written, so that tasks from before it was known keep their hashes.
    let decides = decides.then(|| ("decides", decides.to_string()));
    record(&[friction].into_iter().chain(decides).chain(rest).collect::<Vec<_>>())
}

/// A shape.
pub(super) fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Box(size) => record(&[("Box", numbers(size))]),
        Shape::Sphere(radius) => record(&[("Sphere", number(*radius))]),
        Shape::Capsule(radius, length) => record(&[("Capsule", numbers(&[*radius, *length]))]),
        Shape::Cylinder(radius, length) => record(&[("Cylinder", numbers(&[*radius, *length]))]),
        Shape::Ellipsoid(half) => record(&[("Ellipsoid", numbers(half))]),
        Shape::Plane => text("Plane"),
        Shape::Terrain(terrain) => record(&[("Terrain", self::terrain(terrain))]),
    }
}

fn terrain(terrain: &Terrain) -> String {
    match terrain {
        Terrain::Stairs { count, rise, run, width } => {
            let fields =
                [("count", count.to_string()), ("rise", number(*rise)), ("run", number(*run)), ("width", number(*width))];
            record(&[("Stairs", record(&fields))])
        }
        Terrain::Heights { size, samples, heights } => {
            let samples = list(samples.iter().map(ToString::to_string));
            record(&[("Heights", record(&[("size", numbers(size)), ("samples", samples), ("heights", numbers(heights))]))])
        }
        Terrain::Slope { length, width, angle } => {
            let fields = [("length", number(*length)), ("width", number(*width)), ("angle", number(*angle))];
            record(&[("Slope", record(&fields))])
        }
    }
}

/// How an object moves.
pub(super) fn motion(motion: &Motion) -> String {
    match motion {
        Motion::Fixed => text("Fixed"),
        Motion::Placed => text("Placed"),
        Motion::Driven => text("Driven"),
        Motion::Free => text("Free"),
        Motion::Joints(joints) => record(&[("Joints", list(joints.iter().map(joint)))]),
    }
}

fn joint(joint: &ObjectJoint) -> String {
    let ObjectJoint { name, kind, axis, anchor, range, damping, stiffness, friction_loss } = joint;
    let kind = match kind {
        ObjectJointKind::Hinge => "hinge",
        ObjectJointKind::Slide => "slide",
        ObjectJointKind::Ball => "ball",
    };
    record(&[
        ("name", text(name)),
        ("kind", text(kind)),
        ("axis", numbers(axis)),
        ("anchor", numbers(anchor)),
        ("range", range.map_or("null".to_owned(), |range| numbers(&range))),
        ("damping", number(*damping)),
        ("stiffness", number(*stiffness)),
        ("friction_loss", number(*friction_loss)),
    ])
}

/// Everything in a body file; of the model only its name, not where it lies.
pub(super) fn body(body: &BodyDescription) -> String {
    let BodyDescription {
        name,
        model,
        root,
        root_forward,
        root_up,
        excitation,
        tendons,
        landmarks,
        joint_aliases,
        joint_groups,
        muscle_groups,
        landmark_groups,
        families,
        poses,
        changes,
    } = body;
    let model = std::path::Path::new(model).file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let excitation = match excitation {
        ExcitationMap::Linear => "linear",
        ExcitationMap::Sigmoid => "sigmoid",
    };
    let tendons = match tendons {
        TendonKind::Rigid => "rigid",
        TendonKind::Elastic => "elastic",
    };
    let pose = |(name, joints): &(String, Vec<(String, f64)>)| {
        let joints = joints.iter().map(|(joint, value)| list([text(joint), number(*value)].into_iter()));
        list([text(name), list(joints)].into_iter())
    };
    record(&[
        ("name", text(name)),
        ("model", text(&model)),
        ("root", text(root)),
        ("root forward", text(axis(*root_forward))),
        ("root up", text(axis(*root_up))),
        ("excitation", text(excitation)),
        ("tendons", text(tendons)),
        ("landmarks", list(landmarks.iter().map(landmark))),
        ("joint aliases", list(joint_aliases.iter().map(|(alias, joint)| list([text(alias), text(joint)].into_iter())))),
        ("joint groups", groups(joint_groups)),
        ("muscle groups", groups(muscle_groups)),
        ("landmark groups", groups(landmark_groups)),
        ("families", groups(families)),
        ("poses", list(poses.iter().map(pose))),
        ("changes", list(changes.iter().map(change))),
    ])
}

fn landmark(landmark: &LandmarkDescription) -> String {
    let LandmarkDescription { name, description, body, point, forward, up, segment } = landmark;
    record(&[
        ("name", text(name)),
        ("description", text(description)),
        ("body", text(body)),
        ("point", numbers(point)),
        ("forward", text(axis(*forward))),
        ("up", text(axis(*up))),
        ("segment", list(segment.iter().map(|shape| text(shape)))),
    ])
}

fn change(change: &Change) -> String {
    let Change { part, property, value, scales } = change;
    let property = match property {
        Property::PeakForce => "peak_force",
        Property::Damping => "damping",
        Property::Stiffness => "stiffness",
    };
    record(&[("part", text(part)), ("property", text(property)), ("value", number(*value)), ("scales", scales.to_string())])
}

fn axis(axis: Axis) -> &'static str {
    match axis {
        Axis::PlusX => "x",
        Axis::MinusX => "-x",
        Axis::PlusY => "y",
        Axis::MinusY => "-y",
        Axis::PlusZ => "z",
        Axis::MinusZ => "-z",
    }
}

fn groups(groups: &[(String, Vec<String>)]) -> String {
    list(groups.iter().map(|(name, members)| list([text(name), list(members.iter().map(|member| text(member)))].into_iter())))
}

/// `{"size":[1.0,2.0],"solid":true}`
fn record(fields: &[(&str, String)]) -> String {
    let fields: Vec<String> = fields.iter().map(|(name, value)| format!("\"{name}\":{value}")).collect();
    format!("{{{}}}", fields.join(","))
}

fn list(elements: impl Iterator<Item = String>) -> String {
    format!("[{}]", elements.collect::<Vec<_>>().join(","))
}

fn numbers(values: &[f64]) -> String {
    list(values.iter().copied().map(number))
}

/// The shortest digits that bring every bit back.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// In quotes; a quote or a backslash within is escaped, so that no two lists of texts are written alike.
fn text(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_and_bodies_are_written_with_words_of_their_own() {
        let stairs = Shape::Terrain(Terrain::Stairs { count: 3, rise: 0.15, run: 0.3, width: 1.0 });
        assert_eq!(shape(&stairs), r#"{"Terrain":{"Stairs":{"count":3,"rise":0.15,"run":0.3,"width":1.0}}}"#);
        assert_eq!(surface(&Surface::default()), r#"{"friction":[1.0,0.005,0.0001],"solid":true,"walkable":false}"#);
        let puppet = BodyDescription { name: "a \"b\"".to_owned(), model: "x/y.xml".to_owned(), ..BodyDescription::default() };
        assert!(body(&puppet).starts_with(r#"{"name":"a \"b\"","model":"y.xml","root":"","root forward":"x","#));
    }
}
