//! The symbols of signals: `com.velocity.z` is v with z and CoM below.

use super::{Fence, Formula, Letter};

/// The symbol of a property of something: of a place, a joint, a muscle.
fn property(name: &str) -> Option<Letter> {
    let letter = |symbol, bold, dots| Some(Letter { symbol, bold, dots, ..Letter::default() });
    let marked = |symbol, word: &str| Some(Letter { symbol, below: vec![word.to_owned()], ..Letter::default() });
    match name {
        "position" => letter("p", true, 0),
        "velocity" => letter("v", true, 0),
        "acceleration" => letter("v", true, 1),
        "angular_velocity" => letter("omega", true, 0),
        "orientation" => letter("R", true, 0),
        "up" => letter("u", true, 0),
        "forward" => letter("f", true, 0),
        "left" => letter("l", true, 0),
        "height" => letter("z", false, 0),
        "clearance" => letter("h", false, 0),
        "pitch" => letter("theta", false, 0),
        "roll" => letter("phi", false, 0),
        "yaw" => letter("psi", false, 0),
        "mass" => letter("m", false, 0),
        "q" => letter("q", false, 0),
        "qd" => letter("q", false, 1),
        "qdd" => letter("q", false, 2),
        "neutral" => marked("q", "0"),
        "lower" => marked("q", "min"),
        "upper" => marked("q", "max"),
        "torque" => letter("tau", false, 0),
        "power" => letter("P", false, 0),
        "length" => letter("ell", false, 0),
        "force" => letter("F", false, 0),
        "peak_force" => marked("F", "max"),
        "activation" => letter("a", false, 0),
        "excitation" => letter("e", false, 0),
        _ => None,
    }
}

/// A path such as `com.velocity.z`; `None` if nothing stands for it.
pub(super) fn signal(path: &[&str]) -> Option<Formula> {
    let (&last, owners) = path.split_last()?;
    if owners.is_empty() {
        return None;
    }
    if last == "speed" {
        let velocity = Letter { symbol: "v", bold: true, below: below(owners), ..Letter::default() };
        return Some(Formula::Fence(Fence::Norm, Box::new(Formula::Letter(velocity))));
    }
    if let Some(letter) = property(last) {
        return Some(Formula::Letter(with_owner(letter, owners)));
    }
    let (&vector, owners) = owners.split_last()?;
    let letter = property(vector).filter(|letter| letter.bold && !owners.is_empty())?;
    let component = match (last, vector) {
        // A place along an axis has the name of the axis.
        ("x", "position") => Letter { symbol: "x", ..Letter::default() },
        ("y", "position") => Letter { symbol: "y", ..Letter::default() },
        ("z", "position") => Letter { symbol: "z", ..Letter::default() },
        ("xy", _) => Letter { above: "xy", ..letter },
        ("x" | "y" | "z" | "forward" | "left" | "up", _) => Letter { bold: false, below: vec![last.to_owned()], ..letter },
        _ => return None,
    };
    Some(Formula::Letter(with_owner(component, owners)))
}

fn with_owner(mut letter: Letter, owners: &[&str]) -> Letter {
    letter.below.extend(below(owners));
    letter
}

/// Whose it is; what belongs to all needs no name.
fn below(owners: &[&str]) -> Vec<String> {
    match owners {
        ["muscles"] => Vec::new(),
        _ => owners.iter().map(|owner| readable(owner)).collect(),
    }
}

/// A name in words: `knee_angle_{l,r}` is knee angle l,r; the centre of mass has its short form.
pub(super) fn readable(name: &str) -> String {
    match name {
        "com" => "CoM".to_owned(),
        _ => name.replace("_{", " ").replace(['{', '}'], "").replace('_', " "),
    }
}

/// A declared name apart from its side or number: `foot_lead`, `gap_{l,r}`, `pole_3`.
pub(super) fn declared(name: &str) -> Formula {
    let (base, side) = match name.split_once("_{") {
        Some((base, pattern)) => (base, pattern.trim_end_matches('}')),
        None => match name.rsplit_once('_') {
            Some((base, side)) if side.len() == 1 && !base.is_empty() => (base, side),
            _ => (name, ""),
        },
    };
    Formula::Name(base.replace('_', " "), side.to_owned())
}
