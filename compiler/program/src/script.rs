//! Scripts as data that can be played and written: the checker reads the same script back from the text, bit for bit.
//!
//! A [`WrittenScript`] holds its numbers in the units in which they are written (deg, m). [`WrittenScript::take`] is the episode that it
//! describes, [`WrittenScript::cheat`] the block of a task for it. It begins as the task does.

use crate::init::{Setting, Spread};
use crate::numbers::exact;
use crate::quantity::unit;
use crate::task::CompiledTask;
use crate::testing::{Keyframe, Take};
use crate::vocabulary::{JointKind, Vocabulary};

/// Columns of a written line.
const WIDTH: usize = 130;

/// A script of keyframes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WrittenScript {
    /// In the order of time.
    pub keys: Vec<WrittenKey>,
    /// What is repeated after the last key.
    pub cycle: Option<WrittenCycle>,
}

/// What changes until a time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WrittenKey {
    /// When the changes are complete, control steps since the beginning of the episode or of a turn of the cycle; never 0.
    pub step: u32,
    /// What changes; all else stays.
    pub changes: Vec<Change>,
}

/// Keys that are repeated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WrittenCycle {
    /// Keys of one turn; the last one ends it.
    pub keys: Vec<WrittenKey>,
    /// How often.
    pub count: u32,
    /// How far every turn displaces the root's places, m.
    pub advance: [f64; 2],
}

/// What a key changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// A joint, by its place in the vocabulary: deg, or m along a slide.
    Joint(usize),
    /// Horizontal place of the root: 2, m.
    RootPlace,
    /// Height of the root, m.
    RootHeight,
    /// How far the lowest point of the body is above the ground, m.
    RootLift,
    /// Deg.
    RootHeading,
    /// Deg.
    RootPitch,
    /// Deg.
    RootRoll,
    /// Place of a free object, by its place in [`Init::objects`](crate::init::Init::objects): 3, m.
    ObjectPlace(usize),
    /// Activation of all muscles, 0 to 1.
    Activation,
}

/// A change of one thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// What is changed.
    pub target: Target,
    /// To what, in the target's unit; numbers behind the target's own are without meaning.
    pub value: [f64; 3],
}

impl Target {
    /// SI value of the unit in which it is written.
    pub fn unit(self, vocabulary: &Vocabulary) -> f64 {
        self.unit_name(vocabulary).and_then(unit::find).map_or(1.0, |unit| unit.factor)
    }

    fn unit_name(self, vocabulary: &Vocabulary) -> Option<&'static str> {
        match self {
            Self::Joint(joint) => vocabulary.joints.get(joint).map(|joint| match joint.kind {
                JointKind::Hinge => "deg",
                JointKind::Slide => "m",
            }),
            Self::RootPlace | Self::RootHeight | Self::RootLift | Self::ObjectPlace(_) => Some("m"),
            Self::RootHeading | Self::RootPitch | Self::RootRoll => Some("deg"),
            Self::Activation => None,
        }
    }

    /// Whether a script can name it: joints and objects whose names the language writes without quotes.
    pub fn is_writable(self, task: &CompiledTask) -> bool {
        let plain = |name: &str| {
            let parts = name.split('.');
            parts.into_iter().all(|part| {
                let begins = part.starts_with(|first: char| first.is_ascii_lowercase());
                let fits = part.chars().all(|sign| sign.is_ascii_lowercase() || sign.is_ascii_digit() || sign == '_');
                begins && fits && !part.ends_with('_')
            })
        };
        match self {
            Self::Joint(joint) => task.vocabulary.joints.get(joint).is_some_and(|joint| plain(&joint.name)),
            Self::ObjectPlace(place) => object_name(task, place).is_some_and(plain),
            _ => true,
        }
    }
}

fn object_name(task: &CompiledTask, place: usize) -> Option<&str> {
    let start = task.init.objects.get(place)?;
    task.scene.objects.get(start.object).map(|object| object.name.as_str())
}

impl WrittenScript {
    /// The episode of a test that shows it.
    pub fn take(&self, task: &CompiledTask) -> Take {
        let mut init = task.init.clone();
        init.coordinate_noise.fill(Spread::None);
        init.velocity_noise.fill(Spread::None);
        let mut script = vec![Keyframe { step: 0, init, activation: 0.0, plays: false }];
        self.keys.iter().for_each(|key| push(&mut script, task, 0, key, [0.0; 2]));
        let begun = script.last().map_or(0, |key| key.step);
        if let Some(cycle) = &self.cycle {
            for turn in 0..cycle.count {
                let from = begun + turn * cycle.period();
                let moved = cycle.advance.map(|advance| f64::from(turn) * advance);
                cycle.keys.iter().for_each(|key| push(&mut script, task, from, key, moved));
            }
        }
        Take { moment: None, given: Vec::new(), script, until: None, run: None, resets: None }
    }

    /// The `cheat` block that shows it, indented as in a task.
    pub fn cheat(&self, title: &str, task: &CompiledTask) -> String {
        let mut text = format!("    cheat \"{}\" {{\n", title.replace(['"', '\n'], "'"));
        for key in &self.keys {
            text += &statement(8, &time(key.step, task), key, [0.0; 2], task);
        }
        let begun = self.keys.last().map_or(0, |key| key.step);
        match &self.cycle {
            Some(cycle) if cycle.count > 0 => {
                text += &format!("        repeat i in 0..{} {{\n", cycle.count);
                for key in &cycle.keys {
                    let at = format!("{} + i * {}", time(begun + key.step, task), time(cycle.period(), task));
                    text += &statement(12, &at, key, cycle.advance, task);
                }
                text += "        }\n";
            }
            // A cheat that shows nothing holds how the task begins.
            _ if self.keys.is_empty() => text += &format!("        until {}\n", time(task.horizon, task)),
            _ => {}
        }
        text + "    }\n"
    }
}

impl WrittenCycle {
    /// Length of a turn, control steps.
    pub fn period(&self) -> u32 {
        self.keys.last().map_or(0, |key| key.step)
    }
}

/// Adds a keyframe that changes the one before it.
fn push(script: &mut Vec<Keyframe>, task: &CompiledTask, from: u32, key: &WrittenKey, moved: [f64; 2]) {
    let Some(last) = script.last() else { return };
    let mut next = Keyframe { step: from + key.step, ..last.clone() };
    for change in &key.changes {
        let factor = change.target.unit(&task.vocabulary);
        let [first, second, third] = change.value;
        let (init, value) = (&mut next.init, first * factor);
        match change.target {
            Target::Joint(joint) => init.decide(Setting::Coordinate(joint), value),
            Target::RootPlace => {
                init.root.meets.clear();
                for (axis, place) in [first, second].into_iter().enumerate() {
                    init.decide(Setting::RootPosition(axis), place + moved[axis]);
                }
            }
            Target::RootHeight => {
                init.root.meets.clear();
                init.decide(Setting::RootHeight, value);
            }
            Target::RootLift => init.root.lift = value,
            Target::RootHeading => init.decide(Setting::RootHeading, value),
            Target::RootPitch => init.decide(Setting::RootPitch, value),
            Target::RootRoll => init.decide(Setting::RootRoll, value),
            Target::ObjectPlace(object) => {
                let place = [first, second, third].into_iter().enumerate();
                place.for_each(|(axis, place)| init.decide(Setting::ObjectPosition(object, axis), place));
            }
            Target::Activation => next.activation = value,
        }
    }
    script.push(next);
}

/// `0.35 s`, or steps where their length is no short decimal.
fn time(step: u32, task: &CompiledTask) -> String {
    let milliseconds = f64::from(step) * 1e3 / task.control_frequency;
    let whole = milliseconds.round();
    if (milliseconds - whole).abs() < 1e-9 { format!("{} s", exact(whole / 1e3)) } else { format!("{step} steps") }
}

/// `at 0.5 s { knee_angle_{l,r} = 40 deg }`
fn statement(indent: usize, time: &str, key: &WrittenKey, advance: [f64; 2], task: &CompiledTask) -> String {
    let (blank, changes) = (" ".repeat(indent), changes(&key.changes, advance, task));
    if changes.is_empty() {
        return format!("{blank}at {time}\n");
    }
    let line = format!("{blank}at {time} {{ {} }}\n", changes.join(", "));
    if line.len() <= WIDTH {
        return line;
    }
    let mut text = format!("{blank}at {time} {{\n");
    let mut line = String::new();
    for change in changes {
        if !line.is_empty() && indent + 4 + line.len() + change.len() + 2 > WIDTH {
            text += &format!("{blank}    {}\n", std::mem::take(&mut line));
        }
        line = if line.is_empty() { change } else { format!("{line}, {change}") };
    }
    text + &format!("{blank}    {line}\n{blank}}}\n")
}

/// Every change as text; one of both sides for a pair that changes alike.
fn changes(changes: &[Change], advance: [f64; 2], task: &CompiledTask) -> Vec<String> {
    let name = |change: &Change| match change.target {
        Target::Joint(joint) => task.vocabulary.joints.get(joint).map_or(String::new(), |joint| joint.name.clone()),
        Target::RootPlace => "root.at".to_owned(),
        Target::RootHeight => "root.height".to_owned(),
        Target::RootLift => "root.lift".to_owned(),
        Target::RootHeading => "root.heading".to_owned(),
        Target::RootPitch => "root.pitch".to_owned(),
        Target::RootRoll => "root.roll".to_owned(),
        Target::ObjectPlace(place) => format!("{}.at", object_name(task, place).unwrap_or_default()),
        Target::Activation => "activation".to_owned(),
    };
    let named: Vec<(String, &Change)> = changes.iter().map(|change| (name(change), change)).collect();
    // The left one of a pair speaks for both.
    let other = |name: &str, [own, its]: [&str; 2], change: &Change| {
        let stem = name.strip_suffix(own)?;
        let pair = named.iter().find(|(known, _)| known.strip_suffix(its) == Some(stem))?;
        (pair.1.value == change.value && matches!(change.target, Target::Joint(_))).then(|| stem.to_owned())
    };
    let mut texts = Vec::new();
    for (name, change) in &named {
        let value = value(change, advance, &task.vocabulary);
        match (other(name, ["_l", "_r"], change), other(name, ["_r", "_l"], change)) {
            (Some(stem), _) => texts.push(format!("{stem}_{{l,r}} = {value}")),
            (None, Some(_)) => {}
            (None, None) => texts.push(format!("{name} = {value}")),
        }
    }
    texts
}

fn value(change: &Change, advance: [f64; 2], vocabulary: &Vocabulary) -> String {
    let number = |value: f64| match change.target.unit_name(vocabulary) {
        Some(unit) => format!("{} {unit}", exact(value)),
        None => exact(value),
    };
    let [first, second, third] = change.value;
    match change.target {
        Target::RootPlace => {
            let axis = |value: f64, advance: f64| match advance {
                0.0 => number(value),
                _ => format!("{} + i * {}", number(value), number(advance)),
            };
            format!("[{}, {}]", axis(first, advance[0]), axis(second, advance[1]))
        }
        Target::ObjectPlace(_) => format!("[{}, {}, {}]", number(first), number(second), number(third)),
        _ => number(first),
    }
}
