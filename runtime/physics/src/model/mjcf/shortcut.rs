//! Actuator shortcuts: named parameters that stand for a `general` actuator's raw ones.
//!
//! A shortcut resets the raw parameters to its own table, also over a default, except for what a default written with
//! the same shortcut, or with a `general` of the shortcut's gain type, already gave it.

use super::document::Element;
use super::error::ModelError;
use crate::scalar::Real;

/// Activation and deactivation time constants, smoothing width: MuJoCo's defaults for a muscle.
const MUSCLE_DYNAMICS: [f64; 3] = [0.01, 0.04, 0.0];
/// Range (2), force, scale, lmin, lmax, vmax, fpmax, fvmax: MuJoCo's defaults for a muscle.
const MUSCLE_GAIN: [f64; 9] = [0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2];
/// The single-number parameters of a muscle and their places in `gainprm`.
const MUSCLE_NAMES: [(&str, usize); 7] =
    [("force", 2), ("scale", 3), ("lmin", 4), ("lmax", 5), ("vmax", 6), ("fpmax", 7), ("fvmax", 8)];

/// The attributes that a shortcut sets.
const RAW: [&str; 6] = ["dyntype", "gaintype", "biastype", "dynprm", "gainprm", "biasprm"];

/// A shortcut, the type of its gain, and the attributes of its own.
pub(super) struct Shortcut {
    pub tag: &'static str,
    pub gain: &'static str,
    named: &'static [&'static str],
}

/// All shortcuts.
pub(super) const SHORTCUTS: [Shortcut; 8] = [
    Shortcut { tag: "motor", gain: "fixed", named: &[] },
    Shortcut { tag: "position", gain: "fixed", named: &["kp", "kv", "dampratio", "timeconst"] },
    Shortcut { tag: "velocity", gain: "fixed", named: &["kv"] },
    Shortcut { tag: "intvelocity", gain: "fixed", named: &["kp", "kv", "dampratio"] },
    Shortcut { tag: "damper", gain: "affine", named: &["kv"] },
    Shortcut { tag: "cylinder", gain: "fixed", named: &["timeconst", "area", "diameter", "bias"] },
    Shortcut { tag: "adhesion", gain: "fixed", named: &["gain"] },
    Shortcut {
        tag: "muscle",
        gain: "muscle",
        named: &["timeconst", "tausmooth", "range", "force", "scale", "lmin", "lmax", "vmax", "fpmax", "fvmax"],
    },
];

/// The shortcut that a tag is.
pub(super) fn find(tag: &str) -> Option<&'static Shortcut> {
    SHORTCUTS.iter().find(|shortcut| shortcut.tag == tag)
}

/// Those of an actuator's attributes that shortcuts set.
pub(super) fn raw(attributes: &[(String, String)]) -> Vec<(String, String)> {
    attributes.iter().filter(|(name, _)| RAW.contains(&name.as_str())).cloned().collect()
}

/// A force law in the raw form.
struct Law {
    types: [&'static str; 3],
    dynamics: [f64; 10],
    gain: [f64; 10],
    bias: [f64; 10],
}

/// The attributes of a shortcut as those of a `general` actuator; `inherited` are the raw ones that a default gave it.
pub(super) fn expand(
    shortcut: &Shortcut,
    element: &Element,
    inherited: &[(String, String)],
) -> Result<Vec<(String, String)>, ModelError> {
    let below = Element { attributes: inherited.to_vec(), children: Vec::new(), ..element.clone() };
    let law = match shortcut.tag {
        "muscle" => muscle(element, &below, !inherited.is_empty())?,
        "position" | "intvelocity" => position(element, &below, shortcut.tag)?,
        "velocity" | "damper" => velocity(element, &below, shortcut.tag)?,
        "cylinder" => cylinder(element, &below)?,
        "adhesion" => adhesion(element, &below)?,
        _ => Law { types: ["none", "fixed", "none"], dynamics: leading([1.0]), gain: leading([1.0]), bias: [0.0; 10] },
    };
    let own = |name: &str| shortcut.named.contains(&name);
    let mut attributes: Vec<_> = element.attributes.iter().filter(|(name, _)| !own(name)).cloned().collect();
    if ["damper", "adhesion"].contains(&shortcut.tag) {
        attributes.push(("ctrllimited".to_owned(), "true".to_owned()));
    }
    let [dynamics, gain, bias] = law.types.map(str::to_owned);
    let values = [dynamics, gain, bias, spaced(&law.dynamics), spaced(&law.gain), spaced(&law.bias)];
    attributes.extend(RAW.map(str::to_owned).into_iter().zip(values));
    Ok(attributes)
}

/// A servo of position, whose set point may follow the control through a filter or integrate it.
fn position(element: &Element, below: &Element, tag: &str) -> Result<Law, ModelError> {
    let pull = figures(below, "gainprm", [1.0])?[0];
    let pull = element.size_or("kp", pull)?;
    let [_, _, mut damping, ..] = figures(below, "biasprm", [0.0])?;
    let own = [element.text("kv"), element.text("dampratio")];
    if own.iter().all(Option::is_some) {
        return Err(element.invalid("`kv` and `dampratio` exclude each other"));
    }
    // Negative is a damping, positive a damping ratio that becomes one once the model's inertia is known.
    if own[0].is_some() {
        damping = -element.size_or("kv", 0.0)?;
    }
    if own[1].is_some() {
        damping = element.size_or("dampratio", 0.0)?;
    }
    let (dynamics, time) = if tag == "intvelocity" {
        ("integrator", 1.0)
    } else {
        let filtered = below.text("dyntype").map(str::trim) == Some("filterexact");
        let inherited = if filtered { figures(below, "dynprm", [1.0])?[0] } else { 0.0 };
        let time = element.size_or("timeconst", inherited)?;
        if time > 0.0 { ("filterexact", time) } else { ("none", 1.0) }
    };
    Ok(Law {
        types: [dynamics, "fixed", "affine"],
        dynamics: leading([time]),
        gain: leading([pull]),
        bias: leading([0.0, -pull, damping]),
    })
}

/// A servo of velocity, or a damper whose strength is the control.
fn velocity(element: &Element, below: &Element, tag: &str) -> Result<Law, ModelError> {
    let dynamics = leading([1.0]);
    if tag == "velocity" {
        let damping = element.size_or("kv", figures(below, "gainprm", [1.0])?[0])?;
        let types = ["none", "fixed", "affine"];
        return Ok(Law { types, dynamics, gain: leading([damping]), bias: leading([0.0, 0.0, -damping]) });
    }
    let inherited = -figures(below, "gainprm", [0.0, 0.0, -1.0])?[2];
    let damping = element.size_or("kv", inherited)?;
    Ok(Law { types: ["none", "affine", "none"], dynamics, gain: leading([0.0, 0.0, -damping]), bias: [0.0; 10] })
}

/// A pneumatic or hydraulic cylinder: pressure follows the control through a filter and acts on an area.
fn cylinder(element: &Element, below: &Element) -> Result<Law, ModelError> {
    let time = element.size_or("timeconst", figures(below, "dynprm", [1.0])?[0])?;
    let mut area = element.size_or("area", figures(below, "gainprm", [1.0])?[0])?;
    if element.text("diameter").is_some() {
        area = core::f64::consts::FRAC_PI_4 * element.size_or("diameter", 0.0)?.squared();
    }
    let bias = element.numbers_over("bias", first::<3>(&figures(below, "biasprm", [0.0])?))?;
    Ok(Law { types: ["filter", "fixed", "affine"], dynamics: leading([time]), gain: leading([area]), bias: leading(bias) })
}

/// What holds a body to whatever touches it.
fn adhesion(element: &Element, below: &Element) -> Result<Law, ModelError> {
    let strength = element.size_or("gain", figures(below, "gainprm", [1.0])?[0])?;
    Ok(Law { types: ["none", "fixed", "none"], dynamics: leading([1.0]), gain: leading([strength]), bias: [0.0; 10] })
}

/// A muscle. The passive force takes the parameters of the active one.
fn muscle(element: &Element, below: &Element, inherits: bool) -> Result<Law, ModelError> {
    let (mut dynamics, mut gain) = (MUSCLE_DYNAMICS, MUSCLE_GAIN);
    if inherits {
        dynamics = first(&figures(below, "dynprm", [1.0])?);
        gain = first(&figures(below, "gainprm", [1.0])?);
    }
    overlay(&mut dynamics[0..2], element.numbers::<2>("timeconst")?.map(Vec::from));
    overlay(&mut dynamics[2..3], element.list("tausmooth", 1)?);
    overlay(&mut gain[0..2], element.numbers::<2>("range")?.map(Vec::from));
    for (name, place) in MUSCLE_NAMES {
        overlay(&mut gain[place..=place], element.list(name, 1)?);
    }
    Ok(Law { types: ["muscle"; 3], dynamics: leading(dynamics), gain: leading(gain), bias: leading(gain) })
}

/// The raw parameters that a default gives, over the first of the standard ones.
fn figures<const N: usize>(below: &Element, attribute: &str, standard: [f64; N]) -> Result<[f64; 10], ModelError> {
    below.numbers_over(attribute, leading(standard))
}

/// Ten parameters of which the first are given.
fn leading<const N: usize>(given: [f64; N]) -> [f64; 10] {
    core::array::from_fn(|index| given.get(index).copied().unwrap_or(0.0))
}

/// The first `N` of ten parameters.
fn first<const N: usize>(parameters: &[f64; 10]) -> [f64; N] {
    core::array::from_fn(|index| parameters[index])
}

/// Replaces the first numbers by those of the list.
fn overlay(numbers: &mut [f64], list: Option<Vec<f64>>) {
    numbers.iter_mut().zip(list.into_iter().flatten()).for_each(|(slot, number)| *slot = number);
}

fn spaced(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}
