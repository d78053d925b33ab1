//! How our tasks begin beside the published code's figures, which stand for what the paper abbreviates.

use msk::compiler::snapshot::{Section, Snapshot};
use msk::compiler::vocabulary::Vocabulary;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display};

/// Typed figures are rounded to so much, in SI units.
const ROUNDED: f64 = 1e-4;

/// How the paper and its code let a task begin.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InitialState {
    /// The paper's words.
    pub paper: String,
    /// How the reason begins that the task gives for what differs.
    #[serde(default)]
    pub differs: String,
    /// What is the same, by name, in rad, m, m/s: joints (`{l,r}` for both sides), `x`, `y`, `pitch`, `velocity.x`, `noise.joints`,
    /// `noise.velocities`, `settle.activation`, `height`. What neither lists must be nothing.
    #[serde(default)]
    figures: BTreeMap<String, f64>,
    #[serde(default)]
    instead: Vec<Instead>,
    /// Randoms, evenly drawn between two figures.
    #[serde(default)]
    drawn: BTreeMap<String, [f64; 2]>,
}

/// A figure that differs.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Instead {
    what: String,
    published: f64,
    ours: Value,
    because: String,
}

/// A number, or words that begin the text of the task.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
enum Value {
    Number(f64),
    Words(String),
}

impl Value {
    /// Whether it is what was typed.
    fn is(&self, typed: &Self) -> bool {
        match (self, typed) {
            (Self::Number(ours), Self::Number(typed)) => (ours - typed).abs() < ROUNDED,
            (Self::Words(ours), Self::Words(typed)) => ours.starts_with(typed.as_str()),
            _ => false,
        }
    }
}

impl Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(out),
            Self::Words(words) => words.fmt(out),
        }
    }
}

/// Problems, and what differs as rows: what, published, ours with its reason.
pub fn compare(initial: &InitialState, snapshot: &Snapshot, vocabulary: &Vocabulary) -> (Vec<String>, Vec<[String; 3]>) {
    let ours = ours(snapshot, vocabulary);
    let found = |name: &str| ours.get(name).cloned().unwrap_or(Value::Number(0.0));
    let (mut problems, mut rows, mut listed) = (Vec::new(), Vec::new(), BTreeSet::new());
    let same = initial.figures.iter().map(|(what, figure)| (what, Value::Number(*figure)));
    let other = initial.instead.iter().map(|instead| (&instead.what, instead.ours.clone()));
    for (what, typed) in same.chain(other) {
        for name in both_sides(what) {
            if !found(&name).is(&typed) {
                problems.push(format!("initial state: `{name}` is {} in ours, the table has {typed}", found(&name)));
            }
            if !listed.insert(name.clone()) {
                problems.push(format!("initial state: `{name}` occurs twice in the table"));
            }
        }
    }
    for instead in &initial.instead {
        let ours = format!("{}: {}", instead.ours, instead.because);
        rows.push([format!("initial state, `{}`", instead.what), instead.published.to_string(), ours]);
        if Value::Number(instead.published).is(&instead.ours) {
            problems.push(format!("initial state: `{}` does not differ", instead.what));
        }
    }
    for (name, typed) in &initial.drawn {
        let found = bounds(snapshot, name);
        if found.is_none_or(|found| found.iter().zip(typed).any(|(ours, typed)| (ours - typed).abs() >= ROUNDED)) {
            problems.push(format!("initial state: the random `{name}` lies in {found:?}, the table has {typed:?}"));
        }
    }
    let unlisted =
        ours.iter().filter(|(name, value)| !listed.contains(*name) && matches!(value, Value::Number(x) if x.abs() >= ROUNDED));
    problems.extend(
        unlisted.map(|(name, value)| format!("initial state: `{name}` is {value} in ours, and the table has no value for it")),
    );
    (problems, rows)
}

/// `hip_{l,r}` is both.
fn both_sides(what: &str) -> Vec<String> {
    match what.strip_suffix("{l,r}") {
        Some(stem) => ["l", "r"].map(|side| format!("{stem}{side}")).to_vec(),
        None => vec![what.to_owned()],
    }
}

/// The values of our initial state; those of a reference motion are the motion's.
fn ours(snapshot: &Snapshot, vocabulary: &Vocabulary) -> BTreeMap<String, Value> {
    let section = |kind: &str, name: &str| snapshot.sections.iter().find(|section| section.kind == kind && section.name == name);
    let mut ours = BTreeMap::new();
    let mut number = |name: &str, value: f64| ours.insert(name.to_owned(), Value::Number(value));
    for (kind, name) in [("coordinates", "noise.joints"), ("velocities", "noise.velocities")] {
        if let Some(noise) = section("noise", kind) {
            number(name, noise.fields[0].0.strip_prefix("normal ").unwrap().parse().unwrap());
        }
    }
    if let Some(settle) = section("settle", "") {
        number("settle.activation", settle.get("activation").unwrap().parse().unwrap());
    }
    let root = section("root", "").unwrap();
    let height = root.fields.iter().find(|(name, _)| name.starts_with("align ")).map(|(name, _)| name.clone());
    let height = height.unwrap_or_else(|| root.get("height").unwrap().to_owned());
    if section("follows", "").is_none() {
        for (field, names) in [("position", ["x", "y", ""]), ("velocity", ["velocity.x", "velocity.y", "velocity.z"])] {
            for (name, value) in names.iter().zip(numbers(root, field)) {
                number(name, value);
            }
        }
        for (name, value) in ["heading", "pitch", "roll"].iter().zip(numbers(root, "orientation")) {
            number(name, value);
        }
        let independent = |name: &str| vocabulary.joints.iter().any(|joint| joint.name == name && joint.independent);
        for (name, value) in section("pose", "").iter().flat_map(|pose| &pose.fields).filter(|(name, _)| independent(name)) {
            number(name, value.parse().unwrap());
        }
    }
    ours.insert("height".to_owned(), Value::Words(height));
    ours
}

/// Between what a random of one number is drawn: its lower bound and its width are the first constants of its formula.
fn bounds(snapshot: &Snapshot, name: &str) -> Option<[f64; 2]> {
    let random = snapshot.sections.iter().find(|section| section.kind == "random" && section.name == name)?;
    let mut constants = random.graph.iter().filter_map(|line| line.split_once("constant ")?.1.parse::<f64>().ok());
    let (low, width) = (constants.next()?, constants.next()?);
    Some([low, low + width])
}

/// The numbers in a field, in their order.
fn numbers(section: &Section, field: &str) -> Vec<f64> {
    let text = section.get(field).unwrap_or_default();
    text.split(|sign: char| " ,[]".contains(sign)).filter_map(|word| word.parse().ok()).collect()
}
