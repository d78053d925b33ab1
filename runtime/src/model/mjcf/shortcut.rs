//! The `muscle` shortcut: named parameters that stand for a `general` actuator's raw ones.

use super::document::Element;
use super::error::ModelError;

/// Activation and deactivation time constants, smoothing width: MuJoCo's defaults for a muscle.
const DYNAMICS: [f64; 3] = [0.01, 0.04, 0.0];
/// Range (2), force, scale, lmin, lmax, vmax, fpmax, fvmax: MuJoCo's defaults for a muscle.
const GAIN: [f64; 9] = [0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2];
/// The single-number parameters and their places in `gainprm`.
const GAIN_NAMES: [(&str, usize); 7] =
    [("force", 2), ("scale", 3), ("lmin", 4), ("lmax", 5), ("vmax", 6), ("fpmax", 7), ("fvmax", 8)];

/// The attributes of a `muscle` as those of a `general` actuator.
///
/// Parameters that the element does not give come from the inherited default if that is a muscle too, else from MuJoCo's
/// own for muscles. The passive force takes the parameters of the active one.
pub(super) fn muscle(element: &Element, inherited: &[(String, String)]) -> Result<Vec<(String, String)>, ModelError> {
    let from_muscle = inherited.iter().any(|(name, value)| name == "gaintype" && value.trim() == "muscle");
    let below = Element { attributes: inherited.to_vec(), children: Vec::new(), ..element.clone() };
    let (mut dynamics, mut gain) = (DYNAMICS, GAIN);
    if from_muscle {
        dynamics = padded(below.list("dynprm", 10)?);
        gain = padded(below.list("gainprm", 10)?);
    }
    overlay(&mut dynamics[0..2], element.numbers::<2>("timeconst")?.map(Vec::from));
    overlay(&mut dynamics[2..3], element.list("tausmooth", 1)?);
    overlay(&mut gain[0..2], element.numbers::<2>("range")?.map(Vec::from));
    for (name, place) in GAIN_NAMES {
        overlay(&mut gain[place..=place], element.list(name, 1)?);
    }
    let named = |name: &str| {
        matches!(name, "timeconst" | "tausmooth" | "range") || GAIN_NAMES.iter().any(|(parameter, _)| *parameter == name)
    };
    let mut raw: Vec<_> = element.attributes.iter().filter(|(name, _)| !named(name)).cloned().collect();
    for kind in ["dyntype", "gaintype", "biastype"] {
        raw.push((kind.to_owned(), "muscle".to_owned()));
    }
    raw.push(("dynprm".to_owned(), spaced(&dynamics)));
    raw.push(("gainprm".to_owned(), spaced(&gain)));
    raw.push(("biasprm".to_owned(), spaced(&gain)));
    Ok(raw)
}

/// The first numbers of a raw parameter list; what it leaves open is one and then zeros.
fn padded<const N: usize>(list: Option<Vec<f64>>) -> [f64; N] {
    let mut result = [0.0; N];
    result[0] = 1.0;
    overlay(&mut result, list);
    result
}

/// Replaces the first numbers by those of the list.
fn overlay(numbers: &mut [f64], list: Option<Vec<f64>>) {
    numbers.iter_mut().zip(list.into_iter().flatten()).for_each(|(slot, number)| *slot = number);
}

fn spaced(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}
