//! Which elements and attributes the reader takes, skips or refuses.
//!
//! Everything physical is either read or refused; what is skipped (appearance, bookkeeping) is
//! named here one by one. An attribute may also be *neutral*: read only in the sense that its one harmless value is
//! accepted and every other value is refused.

use super::document::Element;
use super::error::{ModelError, Unsupported};
use super::values::{WORD, shortened};

/// What is known of an element in its context.
struct Rule {
    /// Context and tag.
    element: &'static str,
    /// Attributes that the compiler reads.
    read: &'static str,
    /// Attributes that it reads of this element besides those of its kind.
    own: &'static str,
    /// Attributes without influence on the physics.
    skipped: &'static str,
    /// Attributes accepted only with one value (numbers: every one of them).
    neutral: &'static [(&'static str, &'static str)],
}

const fn rule(
    element: &'static str,
    read: &'static str,
    skipped: &'static str,
    neutral: &'static [(&'static str, &'static str)],
) -> Rule {
    Rule { element, read, own: "", skipped, neutral }
}

/// The rule of an actuator: what all of them have, and what this one has of its own.
const fn actuator(element: &'static str, own: &'static str) -> Rule {
    Rule { element, read: ACTUATOR, own, skipped: ACTUATOR_SKIPPED, neutral: ACTUATOR_NEUTRAL }
}

/// The rule of a sensor: what it is attached to. Its noise is a note to the reader; MuJoCo does not add it either.
const fn sensor(element: &'static str, own: &'static str) -> Rule {
    let neutral = &[("delay", "0"), ("interval", "0"), ("nsample", "0")];
    Rule { element, read: "name cutoff", own, skipped: "noise user interp", neutral }
}

/// Elements skipped with everything in them.
const SKIPPED: &[&str] = &[
    "mujoco/visual",
    "mujoco/statistic",
    "mujoco/custom",
    "mujoco/size",
    "asset/texture",
    "asset/material",
    "asset/skin",
    "body/camera",
    "body/light",
    "default/camera",
    "default/light",
    "default/material",
    "default/texture",
];

const GEOM: &str = "name class type contype conaffinity condim group priority size friction mass density solmix solref \
    solimp margin gap fromto pos quat axisangle xyaxes zaxis euler mesh hfield";
const GEOM_SKIPPED: &str = "material rgba castshadow user fitscale";
const GEOM_NEUTRAL: &[(&str, &str)] =
    &[("shellinertia", "false"), ("fluidshape", "none"), ("surfacevel", "0"), ("adhesion", "0")];
const JOINT: &str = "name class type pos axis limited range ref springref stiffness damping armature frictionloss margin \
    solreflimit solimplimit solreffriction solimpfriction springdamper actuatorfrclimited actuatorfrcrange actuatorgravcomp";
const JOINT_NEUTRAL: &[(&str, &str)] = &[("springyield", "0")];
const SITE: &str = "name class pos quat axisangle xyaxes zaxis euler fromto";
const TENDON: &str = "name class limited range margin stiffness damping springlength armature frictionloss solreflimit solimplimit \
    solreffriction solimpfriction";
const TENDON_SKIPPED: &str = "group width material rgba user";
const TENDON_NEUTRAL: &[(&str, &str)] = &[("springyield", "0"), ("actuatorfrclimited", "false"), ("actuatorfrcrange", "0")];
const ACTUATOR_NEUTRAL: &[(&str, &str)] = &[("delay", "0"), ("nsample", "0")];
const ACTUATOR_SKIPPED: &str = "group user interp input";
const ACTUATOR: &str = "name class joint jointinparent tendon site refsite body ctrllimited ctrlrange forcelimited forcerange \
    actlimited actrange lengthrange gear damping armature actearly actdim inheritrange";
const MUSCLE: &str = "timeconst tausmooth range force scale lmin lmax vmax fpmax fvmax";
const GENERAL: &str = "dyntype gaintype biastype dynprm gainprm biasprm";
const POSITION: &str = "kp kv dampratio timeconst";
const CYLINDER: &str = "timeconst area diameter bias";
const PAIR: &str = "name class geom1 geom2 condim friction solref solreffriction solimp gap margin";
const BODY: &str = "name childclass pos quat axisangle xyaxes zaxis euler mocap gravcomp";
const FRAME: &str = "name childclass pos quat axisangle xyaxes zaxis euler";
const FRAME_NEUTRAL: &[(&str, &str)] = &[("scale", "1"), ("massscale", "0"), ("scaling", "similar")];
const OPTION_NEUTRAL: &[(&str, &str)] = &[("actuatorgroupdisable", "")];

/// Attributes whose value is one of several words, and the words that the simulator knows.
const CHOICES: [(&str, &str); 4] = [
    ("integrator", "Euler implicitfast RK4"),
    ("dyntype", "none integrator filter filterexact muscle"),
    ("gaintype", "fixed affine muscle"),
    ("biastype", "none affine muscle"),
];

#[rustfmt::skip]
const RULES: &[Rule] = &[
    rule("mujoco", "model", "", &[]),
    rule("mujoco/compiler", "angle autolimits eulerseq meshdir assetdir strippath inertiafromgeom inertiagrouprange boundmass boundinertia balanceinertia settotalmass alignfree",
        "texturedir usethread discardvisual saveinertial savecompiled savecanonical conflict passthrough fitaabb",
        &[("coordinate", "local"), ("fusestatic", "false")]),
    rule("compiler/lengthrange", "mode useexisting uselimit accel maxforce timeconst timestep inttotal interval tolrange", "", &[]),
    rule("mujoco/option", "timestep integrator gravity iterations ls_iterations tolerance ls_tolerance impratio cone solver density viscosity wind \
         noslip_iterations noslip_tolerance",
        "magnetic jacobian ccd_iterations ccd_tolerance sdf_iterations sdf_initpoints sleep_tolerance \
         o_margin o_solref o_solimp o_friction", OPTION_NEUTRAL),
    rule("option/flag", "constraint equality frictionloss limit contact refsafe eulerdamp gravity", "sensor midphase autoreset nativeccd multiccd island energy fwdinv warmstart", &[
        ("spring", "enable"), ("damper", "enable"), ("clampctrl", "enable"),
        ("filterparent", "enable"), ("actuation", "enable"),
        ("override", "disable"), ("invdiscrete", "disable"), ("sleep", "disable"), ("diagexact", "disable"),
        ("ipc", "disable"), ("speculative", "disable")]),
    rule("mujoco/asset", "", "", &[]),
    rule("asset/mesh", "name class file scale inertia vertex face refpos refquat", "smoothnormal content_type material normal texcoord", &[("maxhullvert", "-1")]),
    rule("asset/hfield", "name file nrow ncol elevation size", "content_type", &[]),
    rule("mujoco/default", "class", "", &[]),
    rule("default/default", "class", "", &[]),
    rule("default/mesh", "scale inertia", "maxhullvert", &[]),
    rule("default/geom", GEOM, GEOM_SKIPPED, GEOM_NEUTRAL),
    rule("default/joint", JOINT, "group user", JOINT_NEUTRAL),
    rule("default/site", SITE, "type group material mesh size rgba user", &[]),
    rule("default/tendon", TENDON, TENDON_SKIPPED, TENDON_NEUTRAL),
    rule("default/pair", PAIR, "", &[("adhesion", "0")]),
    rule("default/equality", "active solref solimp", "", &[]),
    actuator("default/general", GENERAL),
    actuator("default/motor", ""),
    actuator("default/position", POSITION),
    actuator("default/velocity", "kv"),
    actuator("default/intvelocity", "kp kv dampratio"),
    actuator("default/damper", "kv"),
    actuator("default/cylinder", CYLINDER),
    actuator("default/muscle", MUSCLE),
    actuator("default/adhesion", "gain"),
    rule("mujoco/worldbody", "", "name", &[]),
    rule("body/body", BODY, "user fuse",
        &[("sleep", "auto"), ("simple", "auto")]),
    rule("body/frame", FRAME, "", FRAME_NEUTRAL),
    rule("body/replicate", "count sep offset euler", "", &[]),
    rule("body/inertial", "pos quat axisangle xyaxes zaxis euler mass diaginertia fullinertia", "", &[]),
    rule("body/joint", JOINT, "group user", JOINT_NEUTRAL),
    rule("body/freejoint", "name align", "group", &[]),
    rule("body/geom", GEOM, GEOM_SKIPPED, GEOM_NEUTRAL),
    rule("body/site", SITE, "type group material mesh size rgba user", &[]),
    rule("mujoco/contact", "", "", &[]),
    rule("contact/pair", PAIR, "", &[("adhesion", "0")]),
    rule("contact/exclude", "name body1 body2", "", &[]),
    rule("mujoco/equality", "", "", &[]),
    rule("equality/joint", "name class active joint1 joint2 polycoef solref solimp", "", &[]),
    rule("equality/tendon", "name class active tendon1 tendon2 polycoef solref solimp", "", &[]),
    rule("equality/connect", "name class active body1 body2 anchor site1 site2 solref solimp", "", &[]),
    rule("equality/weld", "name class active body1 body2 anchor relpose torquescale site1 site2 solref solimp", "", &[]),
    rule("mujoco/tendon", "", "", &[]),
    rule("tendon/spatial", TENDON, TENDON_SKIPPED, TENDON_NEUTRAL),
    rule("spatial/site", "site", "", &[]),
    rule("spatial/geom", "geom sidesite", "", &[]),
    rule("spatial/pulley", "divisor", "", &[]),
    rule("tendon/fixed", TENDON, "group user", TENDON_NEUTRAL),
    rule("fixed/joint", "joint coef", "", &[]),
    rule("mujoco/actuator", "", "", &[]),
    actuator("actuator/general", GENERAL),
    actuator("actuator/motor", ""),
    actuator("actuator/position", POSITION),
    actuator("actuator/velocity", "kv"),
    actuator("actuator/intvelocity", "kp kv dampratio"),
    actuator("actuator/damper", "kv"),
    actuator("actuator/cylinder", CYLINDER),
    actuator("actuator/muscle", MUSCLE),
    actuator("actuator/adhesion", "gain"),
    rule("mujoco/sensor", "", "", &[]),
    sensor("sensor/touch", "site"),
    sensor("sensor/accelerometer", "site"),
    sensor("sensor/velocimeter", "site"),
    sensor("sensor/gyro", "site"),
    sensor("sensor/force", "site"),
    sensor("sensor/torque", "site"),
    sensor("sensor/jointpos", "joint"),
    sensor("sensor/jointvel", "joint"),
    sensor("sensor/jointactuatorfrc", "joint"),
    sensor("sensor/ballquat", "joint"),
    sensor("sensor/ballangvel", "joint"),
    sensor("sensor/tendonpos", "tendon"),
    sensor("sensor/tendonvel", "tendon"),
    sensor("sensor/actuatorpos", "actuator"),
    sensor("sensor/actuatorvel", "actuator"),
    sensor("sensor/actuatorfrc", "actuator"),
    sensor("sensor/tendonactuatorfrc", "tendon"),
    sensor("sensor/jointlimitpos", "joint"),
    sensor("sensor/jointlimitvel", "joint"),
    sensor("sensor/jointlimitfrc", "joint"),
    sensor("sensor/tendonlimitpos", "tendon"),
    sensor("sensor/tendonlimitvel", "tendon"),
    sensor("sensor/tendonlimitfrc", "tendon"),
    Rule { element: "sensor/rangefinder", read: "name cutoff", own: "site", skipped: "noise user interp",
        neutral: &[("data", "dist"), ("delay", "0"), ("interval", "0"), ("nsample", "0")] },
    sensor("sensor/distance", "geom1 body1 geom2 body2"),
    sensor("sensor/normal", "geom1 body1 geom2 body2"),
    sensor("sensor/fromto", "geom1 body1 geom2 body2"),
    sensor("sensor/framepos", "objtype objname reftype refname"),
    sensor("sensor/framequat", "objtype objname reftype refname"),
    sensor("sensor/framexaxis", "objtype objname reftype refname"),
    sensor("sensor/frameyaxis", "objtype objname reftype refname"),
    sensor("sensor/framezaxis", "objtype objname reftype refname"),
    sensor("sensor/framelinvel", "objtype objname reftype refname"),
    sensor("sensor/frameangvel", "objtype objname reftype refname"),
    sensor("sensor/framelinacc", "objtype objname"),
    sensor("sensor/frameangacc", "objtype objname"),
    sensor("sensor/subtreecom", "body"),
    sensor("sensor/subtreelinvel", "body"),
    sensor("sensor/subtreeangmom", "body"),
    sensor("sensor/clock", ""),
    rule("mujoco/keyframe", "", "", &[]),
    rule("keyframe/key", "name time qpos qvel act ctrl mpos mquat", "", &[("plastic", "0")]),
];

/// Refuses a model that uses anything physical that the simulator does not have, naming every instance.
pub(super) fn check(root: &Element) -> Result<(), ModelError> {
    if root.tag != "mujoco" {
        return Err(root.invalid(format!("a model's top-level element is `mujoco`, found `{}`", root.tag)));
    }
    let mut refused = Vec::new();
    visit(root, "", &mut refused);
    if refused.is_empty() { Ok(()) } else { Err(ModelError::Unsupported(refused)) }
}

fn visit(element: &Element, context: &str, refused: &mut Vec<Unsupported>) {
    let mut refuse = |what: String| refused.push(Unsupported { place: element.place.clone(), what: shortened(&what, 5 * WORD) });
    let path = if context.is_empty() { element.tag.clone() } else { format!("{context}/{}", element.tag) };
    if SKIPPED.contains(&path.as_str()) {
        return;
    }
    let Some(rule) = RULES.iter().find(|rule| rule.element == path) else {
        return refuse(format!("element `{}` in `{context}`", element.tag));
    };
    for (name, value) in &element.attributes {
        let listed = |names: &str| names.split_whitespace().any(|known| known == name);
        if let Some((_, known)) = CHOICES.iter().find(|(attribute, _)| attribute == name)
            && !known.split_whitespace().any(|word| word == value.trim())
        {
            refuse(format!("attribute `{name}` of `{}` with the value `{value}`", element.tag));
            continue;
        }
        if listed(rule.read) || listed(rule.own) || listed(rule.skipped) {
            continue;
        }
        match rule.neutral.iter().find(|(neutral, _)| neutral == name) {
            Some((_, harmless)) if is_neutral(value, harmless) => {}
            Some(_) => refuse(format!("attribute `{name}` of `{}` with the value `{}`", element.tag, shortened(value, WORD))),
            None => refuse(format!("attribute `{name}` of `{}`{}", element.tag, likely(rule, name))),
        }
    }
    let inner = context_of(&element.tag);
    for child in &element.children {
        visit(child, inner, refused);
    }
}

/// The known attribute that an unknown one may be a misspelling of, as a question.
fn likely(rule: &Rule, name: &str) -> String {
    let neutral = rule.neutral.iter().map(|(known, _)| *known);
    // Longer than any attribute: not worth comparing.
    if name.len() > 32 {
        return String::new();
    }
    let known = rule.read.split_whitespace().chain(rule.skipped.split_whitespace()).chain(neutral);
    let near = known.map(|known| (strsim::damerau_levenshtein(known, name), known)).min();
    let near = near.filter(|(distance, known)| *distance <= 1.max(known.len() / 4));
    near.map(|(_, known)| format!(" (is it `{known}`?)")).unwrap_or_default()
}

/// What surrounds the children of an element: bodies, frames and the world hold the same things.
fn context_of(tag: &str) -> &str {
    match tag {
        "worldbody" | "body" | "frame" | "replicate" => "body",
        other => other,
    }
}

/// Whether a value means the same as its absence: the same word, or numbers that are all the harmless ones.
fn is_neutral(value: &str, harmless: &str) -> bool {
    if value.trim() == harmless || value.trim() == "auto" {
        return true;
    }
    let expected: Vec<f64> = harmless.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let Some(last) = expected.last() else { return false };
    let expected_at = |index: usize| expected.get(index).unwrap_or(last);
    value.split_whitespace().enumerate().all(|(index, word)| word.parse::<f64>().ok().as_ref() == Some(expected_at(index)))
}
