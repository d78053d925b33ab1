//! The report of a task as plain data in SI units. Its JSON form is stable: fields are added, never changed.

use super::action::ActionReport;
use crate::numbers::for_people;
use crate::task::{Parameter, RandomValue};
use crate::weights::Schedule;
use serde::Serialize;

/// Number of the form of an [`TaskReport`] as JSON.
pub const FORM: u32 = 1;

/// A task explained.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TaskReport {
    /// Number of this form, [`FORM`].
    pub form: u32,
    /// Name of the task.
    pub name: String,
    /// Family it belongs to.
    pub family: String,
    /// First paragraph of its documentation.
    pub summary: String,
    /// Hash of its meaning.
    pub hash: String,
    /// The body.
    pub body: String,
    /// Control steps per second, Hz.
    pub control_frequency: f64,
    /// Length of an episode, control steps.
    pub horizon: u32,
    /// The same in seconds.
    pub duration: f64,
    /// Whether mirroring left and right must not change the reward.
    pub symmetric: bool,
    /// What a policy's action asks for.
    pub action: ActionReport,
    /// Numbers that may be set from outside.
    pub parameters: Vec<Parameter>,
    /// Motions that formulas follow.
    pub motions: Vec<MotionReport>,
    /// What chance decides.
    pub randoms: Vec<RandomValue>,
    /// What surrounds the body.
    pub scene: SceneReport,
    /// How an episode begins.
    pub initial_state: InitialStateReport,
    /// Forces from outside.
    pub disturbances: Vec<DisturbanceReport>,
    /// One for a task, several for a sequence.
    pub phases: Vec<PhaseReport>,
    /// What the policy sees.
    pub observation: ObservationReport,
    /// Sum of the reward in the first snapshot, where that is known.
    pub reward_at_reset: Option<f64>,
}

/// A formula in several notations.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FormulaReport {
    /// As written, blanks made even; empty where the text is not kept.
    pub source: String,
    /// As mathematics in plain characters.
    pub text: String,
    /// As LaTeX, for math mode.
    pub latex: String,
    /// As MathML, without the `math` element around it.
    pub mathml: String,
}

/// A motion that formulas follow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionReport {
    /// Name of the reference.
    pub name: String,
    /// Title of the motion.
    pub title: String,
    /// Identifies what it shows.
    pub digest: String,
    /// Whether it repeats.
    pub cycle: bool,
    /// Its length, or that of one turn, s.
    pub duration: f64,
    /// Joints that it moves.
    pub joints: usize,
    /// The phase at which an episode starts, 0 to 1; `null` if it is drawn.
    pub start: Option<f64>,
}

impl MotionReport {
    /// Everything but its name, on one line.
    pub(super) fn in_words(&self) -> String {
        let kind = if self.cycle { "a cycle" } else { "a motion" };
        let start =
            self.start.map_or("a phase drawn for each episode".to_owned(), |phase| format!("phase {}", for_people(phase)));
        format!("{}, {kind} of {} s, {} joints, from {start}", self.title, for_people(self.duration), self.joints)
    }
}

/// What surrounds the body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneReport {
    /// Whether there is level ground.
    pub ground: bool,
    /// Elements, parents before what they carry.
    pub objects: Vec<ObjectReport>,
    /// What is held to what.
    pub connections: Vec<ConnectionReport>,
    /// Named sets of elements.
    pub groups: Vec<(String, Vec<String>)>,
    /// Names of places that are shown and never touched.
    pub markers: Vec<String>,
}

/// An element of the scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObjectReport {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub description: String,
    /// `box`, `stairs`, `body`, ...
    pub kind: String,
    /// Its sizes in words: `0.34 × 0.34 × 0.04 m`.
    pub size: String,
    /// What carries it: `world`, another element or a landmark of the body.
    pub parent: String,
    /// Position in the parent's frame, m.
    pub position: [f64; 3],
    /// Orientation in the parent's frame, w x y z.
    pub orientation: [f64; 4],
    /// `fixed`, `free`, or its joints in words.
    pub motion: String,
    /// Mass, kg.
    pub mass: f64,
    /// Sliding friction.
    pub friction: f64,
    /// Whether it can be touched.
    pub solid: bool,
    /// Whether it counts as ground.
    pub walkable: bool,
}

/// What is held to what.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConnectionReport {
    /// `weld` holds place and orientation, `connect` the place.
    pub kind: String,
    /// First end.
    pub from: String,
    /// Second end.
    pub to: String,
    /// Whether it may let go.
    pub released: bool,
}

/// How an episode begins.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InitialStateReport {
    /// The root in words.
    pub root: String,
    /// Joints that are elsewhere than in the neutral pose.
    pub joints: Vec<JointReport>,
    /// Noise in words, a line each.
    pub noise: Vec<String>,
    /// Free elements that start with a velocity or elsewhere than in the scene, in words.
    pub objects: Vec<String>,
    /// Strengths and masses that differ from those of the body, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scaled: Vec<String>,
    /// What is drawn: `ball.position.y`.
    pub drawn: Vec<String>,
    /// Physics before the first snapshot, in words; empty if there is none.
    pub settle: String,
}

impl InitialStateReport {
    /// Joints that no coupling slaves, those of both sides that are alike under one name: `knee angle l,r`.
    pub(super) fn independent_joints(&self) -> Vec<(String, &JointReport)> {
        let mut rows: Vec<(String, &JointReport)> = Vec::new();
        for joint in self.joints.iter().filter(|joint| joint.independent) {
            let (base, side) = match joint.name.rsplit_once('_') {
                Some((base, side @ ("l" | "r"))) => (base, side),
                _ => (joint.name.as_str(), ""),
            };
            let twin = rows.iter_mut().find(|(_, known)| {
                let other = known.name.rsplit_once('_').filter(|(_, other)| !side.is_empty() && matches!(*other, "l" | "r"));
                other.is_some_and(|(known_base, other)| known_base == base && other != side) && known.value == joint.value
            });
            match twin {
                Some((name, _)) => *name = format!("{} l,r", base.replace('_', " ")),
                None => rows.push((joint.name.replace('_', " "), joint)),
            }
        }
        rows
    }
}

/// A joint away from the neutral pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointReport {
    /// Its name.
    pub name: String,
    /// Coordinate, rad or m.
    pub value: f64,
    /// In the neutral pose.
    pub neutral: f64,
    /// `rad` or `m`.
    pub unit: String,
    /// Whether no coupling slaves it.
    pub independent: bool,
}

impl JointReport {
    /// Its coordinate for people: angles in degrees.
    pub(super) fn angle(&self) -> String {
        match self.unit.as_str() {
            "rad" => format!("{:.1}\u{b0}", self.value.to_degrees()),
            unit => format!("{} {unit}", for_people(self.value)),
        }
    }
}

/// A force from outside.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DisturbanceReport {
    /// On which landmark.
    pub on: String,
    /// N.
    pub force: [f64; 3],
    /// N m.
    pub torque: [f64; 3],
    /// When it begins, s.
    pub start: f64,
    /// How long it lasts, s.
    pub duration: f64,
    /// After how long it begins anew, s; `None` if it comes once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every: Option<f64>,
    /// Its numbers that are drawn for each episode, such as `force.x`; the others are known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drawn: Vec<String>,
}

impl DisturbanceReport {
    /// How often it comes, and what of it is drawn, in words; empty if it comes once and all is known.
    pub(super) fn varies(&self) -> String {
        let every = self.every.map_or_else(String::new, |every| format!(", every {} s", for_people(every)));
        let drawn = if self.drawn.is_empty() { String::new() } else { format!(", drawn: {}", self.drawn.join(", ")) };
        every + &drawn
    }
}

/// A task of a sequence, or the task itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseReport {
    /// The task's name.
    pub name: String,
    /// Its length, control steps.
    pub horizon: u32,
    /// When the next phase begins, where a condition is declared.
    pub until: Option<FormulaReport>,
    /// The terms of the reward.
    pub terms: Vec<TermReport>,
    /// Ends that are failures.
    pub terminations: Vec<EndReport>,
    /// Ends that are none.
    pub finishes: Vec<EndReport>,
    /// What succeeds at the last step.
    pub success: Option<EndReport>,
    /// What is logged and never rewarded.
    pub metrics: Vec<MetricReport>,
    /// What formulas name; what is read stands before its readers.
    pub definitions: Vec<DefinitionReport>,
}

/// A reward term.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TermReport {
    /// Its name.
    pub name: String,
    /// Its weight: multiplied by its value it contributes to the reward of every control step.
    pub weight: f64,
    /// How the weight changes during a training, whose last weight is `weight`; `null` if it does not.
    pub schedule: Option<Schedule>,
    /// Its weight in the source.
    pub weight_in_source: f64,
    /// Where the weight comes from: `the source`, a weights file, or `the command line`.
    pub weight_from: String,
    /// What a tuner may choose.
    pub weight_range: Option<[f64; 2]>,
    /// Whether the weight is fixed.
    pub fixed: bool,
    /// Its formula.
    pub formula: FormulaReport,
    /// Its documentation.
    pub docs: String,
    /// Whether it counts per second, so that its value is multiplied by the control step.
    pub per_second: bool,
    /// Whether it is a condition, counted 0 or 1.
    pub condition: bool,
    /// Between which values it stays; `null` where unbounded.
    pub bounds: [Option<f64>; 2],
    /// Signals and declared names in it.
    pub reads: Vec<String>,
    /// What it remembers from step to step, in words.
    pub remembers: Vec<String>,
    /// Its value in the first snapshot, where that is known.
    pub at_reset: Option<f64>,
}

/// A condition that ends, or makes a success.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EndReport {
    /// Name of the reason; empty for success.
    pub name: String,
    /// When it holds.
    pub condition: FormulaReport,
    /// The time from reset before which it does not count, as written; empty if it always does.
    pub after: String,
    /// Its documentation.
    pub docs: String,
    /// Whether it holds in the first snapshot, where that is known.
    pub holds_at_reset: Option<bool>,
    /// Whether a learner values what would have followed; of success always no.
    pub bootstrap: bool,
}

/// What is logged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MetricReport {
    /// Its name.
    pub name: String,
    /// Number of values.
    pub size: usize,
    /// Unit, empty for plain numbers.
    pub unit: String,
    /// What it is.
    pub formula: FormulaReport,
}

/// A declaration that formulas name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DefinitionReport {
    /// `let`, `const`, `fn`, `state`, `clock`, `random`, `params`.
    pub kind: String,
    /// Its name.
    pub name: String,
    /// Of a function.
    pub parameters: Vec<String>,
    /// Its formula, or several with a word before each: `becomes`, `when`, `where`.
    pub parts: Vec<(String, FormulaReport)>,
    /// Its documentation.
    pub docs: String,
}

/// What the policy sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObservationReport {
    /// Number of values.
    pub size: usize,
    /// Its parts, in order.
    pub channels: Vec<ChannelReport>,
    /// What only a critic sees beside it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub critic: Vec<ChannelReport>,
}

/// A part of the observation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelReport {
    /// Its label.
    pub name: String,
    /// First index.
    pub offset: usize,
    /// Number of values.
    pub size: usize,
    /// Unit, empty for plain numbers.
    pub unit: String,
    /// The block of a library that it comes from, such as `proprioception`; empty if it is the task's own.
    pub block: String,
    /// What it is; of a sequence, in the first phase that has it.
    pub formula: FormulaReport,
    /// What lies between the formula and the policy: noise, delays and the like, as they are written.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub settings: String,
    /// Its documentation.
    pub docs: String,
}
