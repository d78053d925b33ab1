//! Printing a model as flat MJCF: one file, no includes, no classes, meshes as lists of corners, every inertia explicit.
//!
//! 1. [`rows`] turns each element into its attributes, those left out that have MuJoCo's standard value;
//! 2. for each kind of element, the value that most of its elements share goes into the one `default` section;
//! 3. the tree and the lists are printed, each element with what differs from that.
//!
//! Numbers are the shortest decimals that read back to the same bits, angles are radians, orientations quaternions: so
//! reading the text gives an equal model, and MuJoCo reads the same.

mod rows;
mod sensors;

use super::super::{JointKind, Model, PathPoint};
use rows::{Row, escaped};

/// The model as MJCF text.
pub(super) fn write(model: &Model) -> String {
    let shared = Shared::of(model);
    let children = children(model);
    let mut printer = Printer { text: String::new(), depth: 0 };
    printer.open(&Row::new("mujoco").text("model", &model.name));
    printer.empty(&Row::new("compiler").word("angle", "radian"));
    let options = rows::options(&model.options);
    match rows::flags(&model.options) {
        Some(flags) => {
            printer.open(&options);
            printer.empty(&flags);
            printer.close("option");
        }
        None => printer.empty(&options),
    }
    shared.print(&mut printer);
    let assets = model.meshes.iter().map(rows::mesh).chain(model.height_fields.iter().map(rows::height_field));
    printer.section("asset", assets);
    printer.open(&Row::new("worldbody"));
    print_contents(model, 0, &shared, &mut printer);
    for root in &children[0] {
        print_body(model, *root, &children, &shared, &mut printer);
    }
    printer.close("worldbody");
    print_contacts(model, &shared, &mut printer);
    let equalities = (0..model.equalities.name.len()).map(|equality| rows::equality(model, equality));
    printer.section("equality", equalities.map(|row| shared.lean(row, "equality")));
    print_tendons(model, &shared, &mut printer);
    let actuators = (0..model.actuators.name.len()).map(|actuator| rows::actuator(model, actuator));
    printer.section("actuator", actuators.map(|row| shared.lean(row, "general")));
    printer.section("sensor", (0..model.sensors.name.len()).map(|sensor| sensors::sensor(model, sensor)));
    printer.section("keyframe", model.keyframes.iter().map(|frame| rows::keyframe(model, frame)));
    printer.close("mujoco");
    printer.text
}

/// Writes text with one element a line.
struct Printer {
    text: String,
    depth: usize,
}

impl Printer {
    fn start(&mut self, row: &Row) {
        self.text.push_str(&"  ".repeat(self.depth));
        self.text.push('<');
        self.text.push_str(row.tag);
        for (name, value) in &row.attributes {
            self.text.push_str(&format!(" {name}=\"{}\"", escaped(value)));
        }
    }

    fn empty(&mut self, row: &Row) {
        self.start(row);
        self.text.push_str("/>\n");
    }

    fn open(&mut self, row: &Row) {
        self.start(row);
        self.text.push_str(">\n");
        self.depth += 1;
    }

    fn close(&mut self, tag: &str) {
        self.depth -= 1;
        self.text.push_str(&format!("{}</{tag}>\n", "  ".repeat(self.depth)));
    }

    /// A section with empty elements; nothing if there are none.
    fn section(&mut self, tag: &'static str, rows: impl Iterator<Item = Row>) {
        let mut rows = rows.peekable();
        if rows.peek().is_some() {
            self.open(&Row::new(tag));
            rows.for_each(|row| self.empty(&row));
            self.close(tag);
        }
    }
}

/// The attributes that go into the `default` section.
struct Shared {
    rows: Vec<Row>,
}

/// Attributes that may be shared, per element of the `default` section. Others (names, places, ranges) belong to each.
const SHAREABLE: [(&str, &str); 6] = [
    ("joint", "armature damping frictionloss stiffness margin solreflimit solimplimit solreffriction solimpfriction"),
    ("geom", "type contype conaffinity condim group priority friction solmix solref solimp margin gap"),
    (
        "tendon",
        "stiffness damping margin solreflimit solimplimit springlength armature frictionloss solreffriction solimpfriction",
    ),
    ("general", "dyntype gaintype biastype dynprm ctrlrange gear"),
    ("equality", "solref solimp"),
    ("pair", "condim friction solref solreffriction solimp margin gap"),
];

impl Shared {
    fn of(model: &Model) -> Self {
        let pick = |(kind, names): (&'static str, &'static str)| {
            let rows: Vec<Row> = match kind {
                "joint" => (0..model.joints.name.len()).map(|joint| rows::joint(model, joint)).collect(),
                "geom" => (0..model.geoms.name.len()).map(|geom| rows::geom(model, geom)).collect(),
                "tendon" => (0..model.tendons.name.len()).map(|tendon| rows::tendon(model, tendon)).collect(),
                "general" => (0..model.actuators.name.len()).map(|actuator| rows::actuator(model, actuator)).collect(),
                "equality" => (0..model.equalities.name.len()).map(|equality| rows::equality(model, equality)).collect(),
                _ => (0..model.pairs.geoms.len()).map(|pair| rows::pair(model, pair)).collect(),
            };
            let rows: Vec<Row> = rows.into_iter().filter(|row| row.tag != "freejoint").collect();
            let mut shared = Row::new(kind);
            for name in names.split_whitespace() {
                shared.attributes.extend(majority(&rows, name));
            }
            shared
        };
        Self { rows: SHAREABLE.map(pick).into() }
    }

    fn row(&self, kind: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.tag == kind)
    }

    /// The row without what it shares, and with the standard value where it differs from what is shared by having none.
    fn lean(&self, mut row: Row, kind: &str) -> Row {
        let Some(shared) = self.row(kind) else { return row };
        for (name, value) in &shared.attributes {
            match row.attributes.iter().position(|(own, _)| own == name) {
                Some(index) if row.attributes[index].1 == *value => drop(row.attributes.remove(index)),
                Some(_) => {}
                None => row.attributes.push((name, rows::standard(kind, name).to_owned())),
            }
        }
        row
    }

    fn print(&self, printer: &mut Printer) {
        printer.section("default", self.rows.iter().filter(|row| !row.attributes.is_empty()).cloned());
    }
}

/// The value of an attribute that more than half of the rows give, if there is one.
fn majority(rows: &[Row], name: &'static str) -> Option<(&'static str, String)> {
    let values = || rows.iter().filter_map(|row| row.get(name));
    // Boyer and Moore's vote leaves the only value that can have a majority; a second pass counts it.
    let (mut candidate, mut votes) = (None, 0_usize);
    for value in rows.iter().map(|row| row.get(name)) {
        if votes == 0 {
            candidate = value;
        }
        votes = if candidate == value { votes + 1 } else { votes - 1 };
    }
    let candidate = candidate?;
    let count = values().filter(|value| *value == candidate).count();
    (2 * count > rows.len()).then(|| (name, candidate.to_owned()))
}

/// The children of each body, in order.
fn children(model: &Model) -> Vec<Vec<usize>> {
    let mut children = vec![Vec::new(); model.bodies.parent.len().max(1)];
    for (body, parent) in model.bodies.parent.iter().enumerate().skip(1) {
        children[*parent].push(body);
    }
    children
}

/// Prints a body's joints, geoms and sites.
fn print_contents(model: &Model, body: usize, shared: &Shared, printer: &mut Printer) {
    for joint in model.bodies.joints[body].clone() {
        let row = rows::joint(model, joint);
        let free = row.tag == "freejoint";
        printer.empty(&if free { row } else { shared.lean(row, "joint") });
    }
    for geom in model.bodies.geoms[body].clone() {
        printer.empty(&shared.lean(rows::geom(model, geom), "geom"));
    }
    // Sites are stored in the order of their bodies.
    let first = model.sites.body.partition_point(|owner| *owner < body);
    let count = model.sites.body[first..].partition_point(|owner| *owner == body);
    for site in first..first + count {
        printer.empty(&rows::site(model, site));
    }
}

/// Prints a body with all below it.
fn print_body(model: &Model, body: usize, children: &[Vec<usize>], shared: &Shared, printer: &mut Printer) {
    printer.open(&rows::body(model, body));
    printer.empty(&rows::inertial(model, body));
    print_contents(model, body, shared, printer);
    for child in &children[body] {
        print_body(model, *child, children, shared, printer);
    }
    printer.close("body");
}

fn print_contacts(model: &Model, shared: &Shared, printer: &mut Printer) {
    let pairs = (0..model.pairs.geoms.len()).map(|pair| shared.lean(rows::pair(model, pair), "pair"));
    let name = |body: usize| &model.bodies.name[body];
    let exclusions = model.exclusions.iter();
    let exclusions =
        exclusions.map(|(first, second)| Row::new("exclude").text("body1", name(*first)).text("body2", name(*second)));
    printer.section("contact", pairs.chain(exclusions));
}

fn print_tendons(model: &Model, shared: &Shared, printer: &mut Printer) {
    if model.tendons.name.is_empty() {
        return;
    }
    printer.open(&Row::new("tendon"));
    for tendon in 0..model.tendons.name.len() {
        let row = shared.lean(rows::tendon(model, tendon), "tendon");
        printer.open(&row);
        for point in &model.tendons.path_points[model.tendons.path[tendon].clone()] {
            printer.empty(&rows::path_point(model, point));
        }
        printer.close(row.tag);
    }
    printer.close("tendon");
}
