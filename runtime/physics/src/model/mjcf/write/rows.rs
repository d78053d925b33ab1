//! Elements as rows of attributes, those with MuJoCo's standard value left out.

use super::super::compile::GEOM_KINDS;
use super::{JointKind, Model, PathPoint};
use crate::model::{
    Attachment, AttachmentOrigin, Bias, Cone, Dynamics, Equality, Gain, GeomKind, HeightField, Integrator, Keyframe, Measure,
    Mesh, Options, Quaternion, SolverParameters, Transmission, rotation,
};
use nalgebra::Vector3;

/// An element's tag and attributes, as text.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub tag: &'static str,
    pub attributes: Vec<(&'static str, String)>,
}

impl Row {
    pub fn new(tag: &'static str) -> Self {
        Self { tag, attributes: Vec::new() }
    }

    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(own, _)| *own == name).map(|(_, value)| value.as_str())
    }

    /// Adds a name; nothing if it is empty.
    pub fn text(mut self, name: &'static str, value: &str) -> Self {
        if !value.is_empty() {
            self.attributes.push((name, value.to_owned()));
        }
        self
    }

    /// Adds a word whatever it is.
    pub fn word(mut self, name: &'static str, value: &str) -> Self {
        self.attributes.push((name, value.to_owned()));
        self
    }

    /// Adds numbers whatever they are.
    fn numbers(self, name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let text = spaced(values);
        self.word(name, &text)
    }

    /// Adds numbers unless they are the element's standard ones.
    pub fn unless_standard(self, kind: &str, name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let text = spaced(values);
        if text == standard(kind, name) { self } else { self.word(name, &text) }
    }

    /// Adds a whole number unless it is the element's standard one.
    fn integer(self, kind: &str, name: &'static str, value: impl ToString) -> Self {
        let text = value.to_string();
        if text == standard(kind, name) { self } else { self.word(name, &text) }
    }

    fn vector(self, name: &'static str, value: Vector3<f64>) -> Self {
        if value == Vector3::zeros() { self } else { self.numbers(name, value.iter().copied()) }
    }

    fn orientation(self, value: Quaternion) -> Self {
        if value == rotation::IDENTITY { self } else { self.numbers("quat", value) }
    }

    /// Adds a flag if it is set.
    fn flag(self, name: &'static str, value: bool) -> Self {
        if value { self.word(name, "true") } else { self }
    }

    fn range(self, name: &'static str, value: Option<[f64; 2]>) -> Self {
        match value {
            Some(range) => self.numbers(name, range),
            None => self,
        }
    }

    fn softness(self, kind: &str, names: [&'static str; 2], value: &SolverParameters) -> Self {
        self.unless_standard(kind, names[0], value.reference).unless_standard(kind, names[1], value.impedance)
    }
}

/// What MuJoCo takes for an attribute that is not given. Only attributes that the `default` section may set are listed.
pub(super) fn standard(kind: &str, name: &str) -> &'static str {
    match (kind, name) {
        ("geom", "type") => "sphere",
        ("geom", "friction") => "1 0.005 0.0001",
        ("pair", "friction") => "1 1 0.005 0.0001 0.0001",
        ("pair", "solreffriction") => "0 0",
        ("equality", "active") => "true",
        ("geom" | "pair", "condim") => "3",
        ("geom", "contype" | "conaffinity" | "solmix") | ("general", "gear") => "1",
        ("tendon", "springlength") => "-1 -1",
        ("general", "dyntype" | "biastype") => "none",
        ("general", "gaintype") => "fixed",
        ("general", "dynprm") => "1",
        ("general", "actearly") => "false",
        ("general", "ctrlrange" | "forcerange" | "actrange") => "0 0",
        (_, "solref" | "solreflimit" | "solreffriction") => "0.02 1",
        (_, "solimp" | "solimplimit" | "solimpfriction") => "0.9 0.95 0.001 0.5 2",
        _ => "0",
    }
}

/// Numbers with spaces between them.
fn spaced(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(shortest).collect::<Vec<_>>().join(" ")
}

/// The shortest decimal that reads back to the same number, with an exponent where zeros would fill the line.
fn shortest(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-4..1e16).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// Text as it may stand between double quotes.
pub(super) fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => result.push_str("&amp;"),
            '<' => result.push_str("&lt;"),
            '>' => result.push_str("&gt;"),
            '"' => result.push_str("&quot;"),
            '\t' | '\n' | '\r' => result.push_str(&format!("&#{};", character as u32)),
            other => result.push(other),
        }
    }
    result
}

pub(super) fn options(options: &Options) -> Row {
    let standard = Options::default();
    let mut row = Row::new("option").numbers("timestep", [options.timestep]);
    if options.gravity != standard.gravity {
        row = row.numbers("gravity", options.gravity.iter().copied());
    }
    if options.fluid.wind != standard.fluid.wind {
        row = row.numbers("wind", options.fluid.wind.iter().copied());
    }
    match options.integrator {
        Integrator::Euler => {}
        Integrator::Implicit => row = row.word("integrator", "implicitfast"),
        Integrator::RungeKutta => row = row.word("integrator", "RK4"),
    }
    let numbers = [
        ("density", options.fluid.density, standard.fluid.density),
        ("viscosity", options.fluid.viscosity, standard.fluid.viscosity),
        ("tolerance", options.tolerance, standard.tolerance),
        ("ls_tolerance", options.line_search_tolerance, standard.line_search_tolerance),
        ("noslip_tolerance", options.no_slip_tolerance, standard.no_slip_tolerance),
        ("impratio", options.impedance_ratio, standard.impedance_ratio),
    ];
    for (name, value, _) in numbers.into_iter().filter(|(_, value, standard)| value != standard) {
        row = row.numbers(name, [value]);
    }
    let counts = [
        ("iterations", options.iterations, standard.iterations),
        ("ls_iterations", options.line_search_iterations, standard.line_search_iterations),
        ("noslip_iterations", options.no_slip_iterations, standard.no_slip_iterations),
    ];
    for (name, count, _) in counts.into_iter().filter(|(_, count, standard)| count != standard) {
        row = row.word(name, &count.to_string());
    }
    if options.cone == Cone::Elliptic {
        row = row.word("cone", "elliptic");
    }
    row
}

/// What is switched off, if anything.
pub(super) fn flags(options: &Options) -> Option<Row> {
    let switches = &options.switches;
    let named = [
        ("equality", switches.equality),
        ("frictionloss", switches.friction_loss),
        ("limit", switches.limit),
        ("contact", switches.contact),
        ("refsafe", switches.safe_reference),
        ("eulerdamp", options.euler_damping),
    ];
    let row = named.into_iter().filter(|(_, on)| !on).fold(Row::new("flag"), |row, (name, _)| row.word(name, "disable"));
    (!row.attributes.is_empty()).then_some(row)
}

pub(super) fn body(model: &Model, body: usize) -> Row {
    let bodies = &model.bodies;
    Row::new("body")
        .text("name", &bodies.name[body])
        .vector("pos", bodies.position[body])
        .orientation(bodies.orientation[body])
        .flag("mocap", bodies.mocap[body])
        .unless_standard("body", "gravcomp", [bodies.gravity_compensation[body]])
}

pub(super) fn inertial(model: &Model, body: usize) -> Row {
    let bodies = &model.bodies;
    Row::new("inertial")
        .numbers("pos", bodies.inertial_position[body].iter().copied())
        .orientation(bodies.inertial_orientation[body])
        .numbers("mass", [bodies.mass[body]])
        .numbers("diaginertia", bodies.inertia[body].iter().copied())
}

/// A joint; the free joint without armature, damping and the like is the element that takes no defaults.
pub(super) fn joint(model: &Model, joint: usize) -> Row {
    let (joints, dofs) = (&model.joints, &model.dofs);
    let (kind, dof) = (joints.kind[joint], joints.dof_address[joint]);
    let directed = matches!(kind, JointKind::Slide | JointKind::Hinge);
    let tag = match kind {
        JointKind::Free => "free",
        JointKind::Ball => "ball",
        JointKind::Slide => "slide",
        JointKind::Hinge => "hinge",
    };
    let mut row = Row::new("joint").text("name", &joints.name[joint]);
    if kind != JointKind::Hinge {
        row = row.word("type", tag);
    }
    row = row.vector("pos", joints.anchor[joint]);
    if directed && joints.axis[joint] != Vector3::z() {
        row = row.numbers("axis", joints.axis[joint].iter().copied());
    }
    if directed {
        let reference = model.reference_position[joints.position_address[joint]];
        row = row.unless_standard("joint", "ref", [reference]);
        row = row.unless_standard("joint", "springref", [joints.spring_reference[joint]]);
    }
    row = row
        .range("range", joints.range[joint])
        .unless_standard("joint", "armature", [dofs.armature[dof]])
        .unless_standard("joint", "damping", [dofs.damping[dof]])
        .unless_standard("joint", "frictionloss", [dofs.friction_loss[dof]])
        .unless_standard("joint", "stiffness", [joints.stiffness[joint]])
        .unless_standard("joint", "margin", [joints.margin[joint]])
        .softness("joint", ["solreflimit", "solimplimit"], &joints.limit_softness[joint])
        .softness("joint", ["solreffriction", "solimpfriction"], &joints.friction_softness[joint])
        .range("actuatorfrcrange", joints.actuator_force_range[joint]);
    if joints.actuator_compensates[joint] {
        row = row.word("actuatorgravcomp", "true");
    }
    let plain = row.attributes.iter().all(|(name, _)| matches!(*name, "name" | "type"));
    if kind == JointKind::Free && plain {
        row = Row::new("freejoint").text("name", &joints.name[joint]);
    }
    row
}

pub(super) fn geom(model: &Model, geom: usize) -> Row {
    let geoms = &model.geoms;
    let kind = geoms.kind[geom];
    let word = GEOM_KINDS.iter().find(|(_, known)| *known == kind).map_or("sphere", |(word, _)| word);
    let mut row = Row::new("geom").text("name", &geoms.name[geom]);
    if kind != GeomKind::Sphere {
        row = row.word("type", word);
    }
    let row = match (kind, geoms.asset[geom]) {
        (GeomKind::Mesh, Some(asset)) => row.text("mesh", &model.meshes[asset].name),
        (GeomKind::HeightField, Some(asset)) => row.text("hfield", &model.height_fields[asset].name),
        _ => row.numbers("size", geoms.size[geom].iter().copied()),
    };
    let row = if geoms.visible[geom] { row } else { row.numbers("rgba", [0.0; 4]) };
    row.vector("pos", geoms.position[geom])
        .orientation(geoms.orientation[geom])
        .integer("geom", "contype", geoms.contact_type[geom])
        .integer("geom", "conaffinity", geoms.contact_affinity[geom])
        .integer("geom", "condim", geoms.contact_dimension[geom])
        .integer("geom", "group", geoms.group[geom])
        .integer("geom", "priority", geoms.priority[geom])
        .unless_standard("geom", "friction", geoms.friction[geom])
        .unless_standard("geom", "solmix", [geoms.softness_mix[geom]])
        .softness("geom", ["solref", "solimp"], &geoms.softness[geom])
        .unless_standard("geom", "margin", [geoms.margin[geom]])
        .unless_standard("geom", "gap", [geoms.gap[geom]])
}

/// A mesh in its own frame, to which reading it back adds no more than the rounding of its corners.
pub(super) fn mesh(mesh: &Mesh) -> Row {
    let vertices = mesh.vertices.iter().flat_map(|vertex| vertex.iter().copied());
    let corners = mesh.triangles.iter().flatten().map(|&corner| corner as f64);
    Row::new("mesh").text("name", &mesh.name).numbers("vertex", vertices).numbers("face", corners)
}

/// A height field; the rows of its text stand from large to small y.
pub(super) fn height_field(field: &HeightField) -> Row {
    let rows = field.samples.chunks(field.columns).rev().flatten().copied();
    let [x, y] = field.radius;
    Row::new("hfield")
        .text("name", &field.name)
        .word("nrow", &field.rows.to_string())
        .word("ncol", &field.columns.to_string())
        .numbers("size", [x, y, field.elevation, field.base])
        .numbers("elevation", rows)
}

/// A site; its volume is only given where a sensor uses it.
pub(super) fn site(model: &Model, site: usize) -> Row {
    let sites = &model.sites;
    let zones = model.sensors.measure.iter().find_map(|measure| match *measure {
        Measure::Touch { site: own, shape, size } if own == site => Some((shape, size)),
        _ => None,
    });
    let mut row =
        Row::new("site").text("name", &sites.name[site]).vector("pos", sites.position[site]).orientation(sites.orientation[site]);
    if let Some((shape, size)) = zones {
        let word = GEOM_KINDS.iter().find(|(_, known)| *known == shape).map_or("sphere", |(word, _)| word);
        row = row.word("type", word).numbers("size", size.iter().copied());
    }
    row
}

pub(super) fn pair(model: &Model, pair: usize) -> Row {
    let pairs = &model.pairs;
    let [first, second] = pairs.geoms[pair];
    Row::new("pair")
        .text("geom1", &model.geoms.name[first])
        .text("geom2", &model.geoms.name[second])
        .integer("pair", "condim", pairs.dimension[pair])
        .unless_standard("pair", "friction", pairs.friction[pair])
        .softness("pair", ["solref", "solimp"], &pairs.softness[pair])
        .unless_standard("pair", "solreffriction", pairs.friction_reference[pair])
        .unless_standard("pair", "margin", [pairs.margin[pair]])
        .unless_standard("pair", "gap", [pairs.gap[pair]])
}

pub(super) fn equality(model: &Model, equality: usize) -> Row {
    let equalities = &model.equalities;
    let (joint, tendon) = (|joint: usize| &model.joints.name[joint], |tendon: usize| &model.tendons.name[tendon]);
    let named = |tag| Row::new(tag).text("name", &equalities.name[equality]);
    let mut row = match &equalities.kind[equality] {
        Equality::Joint(coupling) => {
            let couplings = &model.couplings;
            named("joint")
                .text("joint1", joint(couplings.joint[*coupling]))
                .text("joint2", couplings.leader[*coupling].map_or("", |leader| joint(leader)))
                .numbers("polycoef", couplings.polynomial[*coupling])
        }
        Equality::Tendon(coupling) => named("tendon")
            .text("tendon1", tendon(coupling.tendon))
            .text("tendon2", coupling.leader.map_or("", |leader| tendon(leader)))
            .numbers("polycoef", coupling.polynomial),
        Equality::Connect(attachment) => {
            let row = attached(model, named("connect"), attachment);
            if matches!(attachment.origin, AttachmentOrigin::Sites(_)) {
                row
            } else {
                row.numbers("anchor", attachment.position[0].iter().copied())
            }
        }
        Equality::Weld { attachment, torque_scale } => {
            let mut row = attached(model, named("weld"), attachment);
            if attachment.origin == AttachmentOrigin::Given {
                let position = attachment.position[0].iter().copied();
                row = row.numbers("relpose", position.chain(attachment.orientation[0]));
            }
            if !matches!(attachment.origin, AttachmentOrigin::Sites(_)) {
                row = row.vector("anchor", attachment.position[1]);
            }
            if *torque_scale == 1.0 { row } else { row.numbers("torquescale", [*torque_scale]) }
        }
    };
    if !equalities.active[equality] {
        row = row.word("active", "false");
    }
    row.softness("equality", ["solref", "solimp"], &equalities.softness[equality])
}

/// The two sites or bodies of an attachment; a second body that is not given is the world.
fn attached(model: &Model, row: Row, attachment: &Attachment) -> Row {
    let [first, second] = attachment.bodies;
    match attachment.origin {
        AttachmentOrigin::Sites([first, second]) => {
            row.text("site1", &model.sites.name[first]).text("site2", &model.sites.name[second])
        }
        _ if second == 0 => row.text("body1", &model.bodies.name[first]),
        _ => row.text("body1", &model.bodies.name[first]).text("body2", &model.bodies.name[second]),
    }
}

pub(super) fn tendon(model: &Model, tendon: usize) -> Row {
    let tendons = &model.tendons;
    let fixed = matches!(tendons.path_points.get(tendons.path[tendon].start), Some(PathPoint::Joint { .. }));
    Row::new(if fixed { "fixed" } else { "spatial" })
        .text("name", &tendons.name[tendon])
        .range("range", tendons.range[tendon])
        .unless_standard("tendon", "stiffness", [tendons.stiffness[tendon]])
        .unless_standard("tendon", "damping", [tendons.damping[tendon]])
        .range("springlength", tendons.spring_length[tendon])
        .unless_standard("tendon", "margin", [tendons.margin[tendon]])
        .softness("tendon", ["solreflimit", "solimplimit"], &tendons.limit_softness[tendon])
        .unless_standard("tendon", "armature", [tendons.armature[tendon]])
        .unless_standard("tendon", "frictionloss", [tendons.friction_loss[tendon]])
        .softness("tendon", ["solreffriction", "solimpfriction"], &tendons.friction_softness[tendon])
}

pub(super) fn path_point(model: &Model, point: &PathPoint) -> Row {
    match point {
        PathPoint::Site(site) => Row::new("site").text("site", &model.sites.name[*site]),
        PathPoint::Wrap { geom, side } => Row::new("geom")
            .text("geom", &model.geoms.name[*geom])
            .text("sidesite", side.map_or("", |site| &model.sites.name[site])),
        PathPoint::Pulley(divisor) => Row::new("pulley").numbers("divisor", [*divisor]),
        PathPoint::Joint { joint, coefficient } => {
            Row::new("joint").text("joint", &model.joints.name[*joint]).numbers("coef", [*coefficient])
        }
    }
}

pub(super) fn keyframe(model: &Model, frame: &Keyframe) -> Row {
    let standard = Keyframe::of_reference(model);
    let mut row = Row::new("key").text("name", &frame.name).unless_standard("key", "time", [frame.time]);
    let arrays = [
        ("qpos", &frame.position, &standard.position),
        ("qvel", &frame.velocity, &standard.velocity),
        ("act", &frame.activation, &standard.activation),
        ("ctrl", &frame.control, &standard.control),
    ];
    for (name, values, _) in arrays.into_iter().filter(|(_, values, standard)| values != standard) {
        row = row.numbers(name, values.iter().copied());
    }
    if frame.mocap_position != standard.mocap_position {
        row = row.numbers("mpos", frame.mocap_position.iter().flatten().copied());
    }
    if frame.mocap_orientation != standard.mocap_orientation {
        row = row.numbers("mquat", frame.mocap_orientation.iter().flatten().copied());
    }
    row
}

pub(super) fn actuator(model: &Model, actuator: usize) -> Row {
    let actuators = &model.actuators;
    let mut row = Row::new("general").text("name", &actuators.name[actuator]);
    row = match actuators.transmission[actuator] {
        Transmission::Joint(joint) => row.text("joint", &model.joints.name[joint]),
        Transmission::JointInParent(joint) => row.text("jointinparent", &model.joints.name[joint]),
        Transmission::Tendon(tendon) => row.text("tendon", &model.tendons.name[tendon]),
        Transmission::Body(body) => row.text("body", &model.bodies.name[body]),
        Transmission::Site { site, reference } => {
            row.text("site", &model.sites.name[site]).text("refsite", reference.map_or("", |site| &model.sites.name[site]))
        }
    };
    let (dynamics, constants) = match actuators.dynamics[actuator] {
        Dynamics::None => ("none", Vec::new()),
        Dynamics::Integrator => ("integrator", Vec::new()),
        Dynamics::Filter(time) => ("filter", vec![time]),
        Dynamics::ExactFilter(time) => ("filterexact", vec![time]),
        Dynamics::Muscle(constants) => ("muscle", constants.to_vec()),
    };
    let (gain, gain_figures) = match actuators.gain[actuator] {
        Gain::Fixed(gain) => ("fixed", vec![gain]),
        Gain::Affine(figures) => ("affine", figures.to_vec()),
        Gain::Muscle(figures) => ("muscle", figures.to_vec()),
    };
    let (bias, bias_figures) = match actuators.bias[actuator] {
        Bias::None => ("none", Vec::new()),
        Bias::Affine(figures) => ("affine", figures.to_vec()),
        Bias::Muscle(figures) => ("muscle", figures.to_vec()),
    };
    let words = [("dyntype", dynamics), ("gaintype", gain), ("biastype", bias)];
    for (name, word) in words.into_iter().filter(|(name, word)| standard("general", name) != *word) {
        row = row.word(name, word);
    }
    if actuators.actearly[actuator] {
        row = row.word("actearly", "true");
    }
    row = row
        .range("ctrlrange", actuators.control_range[actuator])
        .range("forcerange", actuators.force_range[actuator])
        .range("actrange", actuators.activation_range[actuator]);
    if actuators.length_range[actuator] != [0.0; 2] {
        row = row.numbers("lengthrange", actuators.length_range[actuator]);
    }
    // A default gear reaches through where an element gives fewer numbers: all write all, or all write one.
    let ratios = actuators.gear.iter().all(|[_, axes @ ..]| *axes == [0.0; 5]);
    let gear = actuators.gear[actuator];
    row = if ratios { row.unless_standard("general", "gear", [gear[0]]) } else { row.numbers("gear", gear) };
    for (name, figures) in [("dynprm", constants), ("gainprm", gain_figures), ("biasprm", bias_figures)] {
        if !figures.is_empty() {
            row = row.numbers(name, figures);
        }
    }
    row
}
