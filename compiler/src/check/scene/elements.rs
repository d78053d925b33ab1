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
    /// What it says.
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

/// What every solid shape may say.
const SOLID: &[&str] = &["at", "orientation", "free", "mass", "density", "friction", "solid", "walkable"];
/// The same for shapes with an axis.
const LONG: &[&str] =
    &["length", "from", "along", "at", "orientation", "free", "mass", "density", "friction", "solid", "walkable"];
/// What terrain may say.
const TERRAIN: &[&str] = &["at", "orientation", "friction", "solid", "walkable"];
/// What joints may say.
const JOINT: &[&str] = &["at", "range", "damping", "stiffness", "friction"];

/// Elements.
#[rustfmt::skip]
pub const KINDS: &[Kind] = &[
    kind("ground", "the level ground z = 0, walkable; without it a scene has none", &[], &["friction"]),
    kind("plane", "an infinite plane, its normal along z before it is turned", &[], TERRAIN),
    kind("box", "a box: full extents, its centre at its place", &["size"], SOLID),
    kind("sphere", "a sphere, its centre at its place", &["radius"], SOLID),
    kind("capsule", "a cylinder with round ends; its length is that of the cylindrical part", &["radius"], LONG),
    kind("cylinder", "a cylinder, its axis along z before it is turned", &["radius"], LONG),
    kind("ellipsoid", "an ellipsoid: full extents, its centre at its place", &["size"], SOLID),
    kind("body", "a frame without a shape that carries its parts", &[], &["at", "orientation", "free"]),
    kind("point", "a place on what carries it: where hands weld, where eyes look", &[], &["at", "orientation"]),
    kind("stairs", "a flight of steps that goes up along x from its place; a negative rise goes down", &["count", "rise", "run", "width"], TERRAIN),
    kind("slope", "an inclined rectangle that rises along x from its place", &["length", "width", "angle"], TERRAIN),
    kind("heights", "a rectangle along x from its place, centred in y, with a height by formula", &["size", "samples", "height"], TERRAIN),
];

/// Joints, which stand inside the element that they let move.
#[rustfmt::skip]
pub const JOINTS: &[Kind] = &[
    kind("hinge", "turns about an axis", &["axis"], JOINT),
    kind("slide", "slides along an axis", &["axis"], JOINT),
    kind("ball", "turns about a point; it has no coordinate to be read", &[], &["at", "damping", "stiffness", "friction"]),
];

const fn field(name: &'static str, form: &'static str, description: &'static str) -> FieldRow {
    FieldRow { name, form, description }
}

/// Fields.
#[rustfmt::skip]
pub const FIELDS: &[FieldRow] = &[
    field("at", "at [x, y, z]", "place in the frame of what carries it: the world, the element around it, or the landmark after `on` (forward, left, up); of a joint, its anchor"),
    field("orientation", "orientation 30 deg, or orientation [roll, pitch, yaw]", "orientation: about the vertical, or yaw, then pitch (nose down positive), then roll"),
    field("size", "size [x, y, z]", "full extents; of `heights`, length and width"),
    field("radius", "radius 3 cm", "of spheres, capsules and cylinders"),
    field("length", "length 1.2 m", "along the axis; of a slope, its horizontal length"),
    field("along", "along [0, 1, 0]", "direction of the axis, z if nothing is said"),
    field("from", "from [x, y, z] to [x, y, z]", "both ends of the axis, instead of `at`, `along` and `length`"),
    field("width", "width 2 m", "across, centred"),
    field("count", "count 4", "number of steps"),
    field("rise", "rise 15 cm", "height of a step"),
    field("run", "run 50 cm", "depth of a step"),
    field("angle", "angle 5 deg", "inclination; negative goes down"),
    field("samples", "samples [101, 11]", "of `heights`: how many along x and y, at least 2 each"),
    field("height", "height FORMULA", "of `heights`: a length that may read `x` (from the near edge) and `y` (from the middle line)"),
    field("mass", "mass 20 kg", "of what moves; without it `density`"),
    field("density", "density 500 kg/m^3", "of what moves, instead of `mass`"),
    field("free", "free", "nothing holds it: six ways to move"),
    field("friction", "friction 1.5, or friction [1.5, 5 mm, 0.1 mm]", "of shapes: sliding, or sliding, torsional and rolling (1, 5 mm and 0.1 mm if nothing is said); of joints, the friction torque or force"),
    field("solid", "solid false", "whether it can be touched; true if nothing is said"),
    field("walkable", "walkable", "whether it counts as ground for `clearance`, `ground_height` and `touching(_, ground)`; stairs, slopes and heights are walkable unless they say `walkable false`"),
    field("axis", "axis [0, 0, 1]", "direction of a hinge or slide in the frame of what it moves"),
    field("range", "range 0 deg .. 90 deg", "limits of a hinge or slide"),
    field("damping", "damping 0.05 N*m*s/rad", "of a hinge or ball; of a slide in N*s/m"),
    field("stiffness", "stiffness 2 N*m/rad", "of a spring towards 0; of a slide in N/m"),
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
    let mut text = String::from("| element | what it is | fields; in brackets those that may be left out |\n|---|---|---|\n");
    for kind in KINDS.iter().chain(JOINTS) {
        let required = kind.required.iter().map(|field| format!("`{field}`"));
        let fields: Vec<String> = required.chain(kind.optional.iter().map(|field| format!("[`{field}`]"))).collect();
        text += &format!("| `{}` | {} | {} |\n", kind.name, kind.description, fields.join(" "));
    }
    text += "\n| field | written | what it says |\n|---|---|---|\n";
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
