//! Elements of scenes and their fields: one table, from which they are read, `msk vocabulary` prints and the reference is made.

use serde::Serialize;

/// A kind of element.
#[derive(Debug, Serialize)]
pub struct Kind {
    /// The word with which it begins.
    pub name: &'static str,
    /// What it is.
    pub description: &'static str,
    /// Fields it must have.
    pub required: &'static [&'static str],
    /// Fields it may have.
    pub optional: &'static [&'static str],
}

/// A field of elements.
#[derive(Debug, Serialize)]
pub struct FieldRow {
    /// Its word.
    pub name: &'static str,
    /// How it is written.
    pub form: &'static str,
    /// Its text.
    pub description: &'static str,
}

const fn kind(
    name: &'static str,
    description: &'static str,
    required: &'static [&'static str],
    optional: &'static [&'static str],
) -> Kind {
    Kind { name, description, required, optional }
}

/// Fields of every solid shape.
const SOLID: &[&str] = &["at", "orientation", "free", "mass", "density", "friction", "solid", "walkable", "moves", "turns"];
/// The same for shapes with an axis.
const LONG: &[&str] = &[
    "length",
    "from",
    "along",
    "at",
    "orientation",
    "free",
    "mass",
    "density",
    "friction",
    "solid",
    "walkable",
    "moves",
    "turns",
];
/// Fields of terrain.
const TERRAIN: &[&str] = &["at", "orientation", "friction", "solid", "walkable", "moves", "turns"];
/// Fields of joints.
const JOINT: &[&str] = &["at", "range", "damping", "stiffness", "friction"];

/// Elements.
#[rustfmt::skip]
pub const KINDS: &[Kind] = &[
    kind("ground", "the level ground z = 0, walkable; without it a scene has none", &[], &["friction"]),
    kind("plane", "an infinite plane, its normal along z before rotation", &[], TERRAIN),
    kind("box", "a box: full extents, its centre at its place", &["size"], SOLID),
    kind("sphere", "a sphere, its centre at its place", &["radius"], SOLID),
    kind("capsule", "a cylinder with hemispherical ends; the length is that of the cylindrical part", &["radius"], LONG),
    kind("cylinder", "a cylinder, its axis along z before rotation", &["radius"], LONG),
    kind("ellipsoid", "an ellipsoid: full extents, its centre at its place", &["size"], SOLID),
    kind("body", "a frame without a shape, with parts", &[], &["at", "orientation", "free", "moves", "turns"]),
    kind("point", "a named place on its parent, for welds, aligned hands or targets", &[], &["at", "orientation"]),
    kind("stairs", "a flight of steps that ascends along x from its place; with a negative rise it descends", &["count", "rise", "run", "width"], TERRAIN),
    kind("slope", "an inclined rectangle that rises along x from its place", &["length", "width", "angle"], TERRAIN),
    kind("heights", "a rectangle along x from its place, centred in y, with its height given by a formula", &["size", "samples", "height"], TERRAIN),
];

/// Joints, which stand inside the element that they let move.
#[rustfmt::skip]
pub const JOINTS: &[Kind] = &[
    kind("hinge", "rotates about an axis", &["axis"], JOINT),
    kind("slide", "slides along an axis", &["axis"], JOINT),
    kind("ball", "rotates about a point; it has no readable coordinate", &[], &["at", "damping", "stiffness", "friction"]),
];

const fn field(name: &'static str, form: &'static str, description: &'static str) -> FieldRow {
    FieldRow { name, form, description }
}

/// Fields.
#[rustfmt::skip]
pub const FIELDS: &[FieldRow] = &[
    field("at", "at [x, y, z]", "place in the frame of its parent: the world, the enclosing element, or the landmark after `on` (forward, left, up); for a joint, its anchor"),
    field("orientation", "orientation 30 deg, or orientation [roll, pitch, yaw]", "rotation about the vertical, or roll, pitch and yaw: yaw is applied first, then pitch (nose down positive), then roll"),
    field("size", "size [x, y, z]", "full extents; for `heights`, length and width"),
    field("radius", "radius 3 cm", "radius of spheres, capsules and cylinders"),
    field("length", "length 1.2 m", "length along the axis; for a slope, its horizontal length"),
    field("along", "along [0, 1, 0]", "direction of the axis, z by default"),
    field("from", "from [x, y, z] to [x, y, z]", "both ends of the axis, instead of `at`, `along` and `length`"),
    field("width", "width 2 m", "across, centred"),
    field("count", "count 4", "number of steps"),
    field("rise", "rise 15 cm", "height of a step"),
    field("run", "run 50 cm", "depth of a step"),
    field("angle", "angle 5 deg", "inclination; negative descends"),
    field("samples", "samples [101, 11]", "for `heights`: number of samples along x and y, at least 2 each"),
    field("height", "height FORMULA", "for `heights`: a length that may read `x` (from the near edge) and `y` (from the middle line)"),
    field("mass", "mass 20 kg", "mass of a moving object; otherwise `density`"),
    field("density", "density 500 kg/m^3", "density of a moving object, instead of `mass`"),
    field("free", "free", "six degrees of freedom"),
    field("friction", "friction 1.5, or friction [1.5, 5 mm, 0.1 mm]", "for shapes: sliding, or sliding, torsional and rolling (default 1, 5 mm and 0.1 mm); for joints, the friction torque or force"),
    field("solid", "solid false", "whether it has contacts; true by default"),
    field("walkable", "walkable", "whether it is ground for `clearance`, `ground_height` and `touching(_, ground)`; stairs, slopes and heights are walkable unless `walkable false`"),
    field("moves", "moves [0.1 m * sin(90 deg/s * t), 0, 0]", "of what is fixed to the world: a formula of time by which it moves away from `at`, along the axes of the world; it carries by friction what touches it"),
    field("turns", "turns 10 deg/s * t", "the same about the vertical"),
    field("axis", "axis [0, 0, 1]", "direction of a hinge or slide in the frame of the element that it moves"),
    field("range", "range 0 deg .. 90 deg", "limits of a hinge or slide"),
    field("damping", "damping 0.05 N*m*s/rad", "for a hinge or ball; for a slide in N*s/m"),
    field("stiffness", "stiffness 2 N*m/rad", "stiffness of a spring towards 0; for a slide in N/m"),
];

/// The kind called `name`, joints included.
pub(crate) fn find(name: &str) -> Option<&'static Kind> {
    KINDS.iter().chain(JOINTS).find(|kind| kind.name == name)
}

impl Kind {
    /// Every field it knows.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.required.iter().chain(self.optional).copied()
    }
}

/// Whether `name` is the kind of a joint.
pub(crate) fn is_joint(name: &str) -> bool {
    JOINTS.iter().any(|kind| kind.name == name)
}

/// The tables for people.
pub fn table() -> String {
    let mut text = String::from("Elements of a scene\n");
    for kind in KINDS.iter().chain(JOINTS) {
        text += &format!("    {:<10} {}\n               ", kind.name, kind.description);
        let optional = kind.optional.iter().map(|field| format!("[{field}]"));
        let fields: Vec<String> = kind.required.iter().map(|field| (*field).to_owned()).chain(optional).collect();
        text += &format!("{}\n", fields.join(" "));
    }
    text += "\nFields of elements\n";
    for field in FIELDS {
        text += &format!("    {:<10} {:<48} {}\n", field.name, field.form, field.description);
    }
    text
}

/// The tables as they stand in the reference.
pub fn markdown() -> String {
    let mut text = String::from("| element | description | fields (optional ones in brackets) |\n|---|---|---|\n");
    for kind in KINDS.iter().chain(JOINTS) {
        let required = kind.required.iter().map(|field| format!("`{field}`"));
        let fields: Vec<String> = required.chain(kind.optional.iter().map(|field| format!("[`{field}`]"))).collect();
        text += &format!("| `{}` | {} | {} |\n", kind.name, kind.description, fields.join(" "));
    }
    text += "\n| field | syntax | description |\n|---|---|---|\n";
    for field in FIELDS {
        text += &format!("| `{}` | `{}` | {} |\n", field.name, field.form.replace(", or ", "` or `"), field.description);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_of_an_element_is_described() {
        for kind in KINDS.iter().chain(JOINTS) {
            for name in kind.fields() {
                assert!(FIELDS.iter().any(|field| field.name == name), "{} of {}", name, kind.name);
            }
        }
    }
}
