//! The action space of a task, for its report.

use crate::action::{ActionSpace, ActionTarget, Along, BaseController, distinct};
use crate::numbers::for_people;
use crate::task::CompiledTask;
use serde::Serialize;

/// What a policy's action asks for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ActionReport {
    /// The word of the language: `muscles`, `synergies`, `torque` or `cmc`.
    pub space: &'static str,
    /// Number of entries, each in -1..1.
    pub size: usize,
    /// Their names, in order; empty where there is one for each muscle of the body.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub entries: Vec<String>,
    /// Whether entries ask for activations in place of excitations.
    #[serde(skip_serializing_if = "core::ops::Not::not")]
    pub activations: bool,
    /// The entry that asks for nothing.
    pub rest: f64,
    /// What an entry of 1 asks for, as far as it is more than the action of a muscle: `0.5 rad`, `60 N m`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ranges: Vec<String>,
    /// Factor of every entry.
    pub scale: f64,
    /// Time constant of the low-pass filter, s; 0 for none.
    pub filter: f64,
    /// Control steps until an action takes effect.
    pub latency: u32,
    /// The controller to whose actions those of the policy are added.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual: Option<String>,
    /// What has the targets that the entries move, where that is neither a reference nor the initial pose: `demonstration` or `gait`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<&'static str>,
    /// How fast that gait walks forward where entries are 0, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<f64>,
    /// The time of the demonstration from which its last entry goes on with it, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub changes_over_to: Option<f64>,
}

/// The action space of a task.
pub(super) fn action(task: &CompiledTask) -> ActionReport {
    let space = &task.action;
    let names = space.names(&task.vocabulary);
    let size = names.len();
    let Targets { along, speed, changes_over_to } = targets(space);
    ActionReport {
        space: space.word(),
        size,
        entries: if space.target == ActionTarget::AllMuscles { Vec::new() } else { names },
        activations: space.activations,
        rest: space.rest(),
        ranges: ranges(space),
        scale: space.scale,
        filter: space.filter,
        latency: space.latency,
        residual: space.residual.as_ref().map(|base| match base {
            BaseController::Network(network) => format!("network {}", network.path),
            named => named.name().to_owned(),
        }),
        along,
        speed,
        changes_over_to,
    }
}

/// What has the targets of computed muscle control, how fast a gait goes that does not begin standing, and where it leads.
#[derive(Default)]
struct Targets {
    along: Option<&'static str>,
    speed: Option<f64>,
    changes_over_to: Option<f64>,
}

fn targets(space: &ActionSpace) -> Targets {
    let ActionTarget::MuscleControl(offsets) = &space.target else { return Targets::default() };
    match offsets.along {
        Along::Reference => Targets::default(),
        Along::Demonstration => Targets { along: Some("demonstration"), ..Targets::default() },
        Along::Gait { speed, then, .. } => {
            Targets { along: Some("gait"), speed: Some(speed).filter(|speed| *speed != 0.0), changes_over_to: then }
        }
    }
}

fn ranges(space: &ActionSpace) -> Vec<String> {
    match &space.target {
        ActionTarget::AllMuscles | ActionTarget::Muscles(_) | ActionTarget::Synergies(_) => Vec::new(),
        ActionTarget::Torque { ranges, .. } => {
            let each: Vec<String> = distinct(ranges).iter().map(|&range| for_people(range)).collect();
            vec![format!("{} N m", each.join(", "))]
        }
        ActionTarget::MuscleControl(offsets) => {
            let [forward, left, turn] = offsets.pace();
            let of = [
                ("joints", offsets.range, "rad"),
                ("com", offsets.center_of_mass, "m"),
                ("root", offsets.root, "rad"),
                ("hands", offsets.reach, "m"),
                ("forward", forward, "m/s"),
                ("left", left, "m/s"),
                ("turn", turn, "rad/s"),
            ];
            let moved = of.into_iter().filter(|(_, range, _)| *range > 0.0);
            moved.map(|(what, range, unit)| format!("{what} {} {unit}", for_people(range))).collect()
        }
    }
}

impl ActionReport {
    /// Everything but the names of the entries, on one line.
    pub(super) fn in_words(&self) -> String {
        let of_each = match (self.space, self.entries.is_empty()) {
            ("muscles", true) => "one per muscle",
            ("muscles", false) => "one per muscle that is controlled",
            ("synergies", _) => "one per synergy",
            ("torque", _) => "torques on joints",
            _ => "offsets of targets that computed muscle control tracks",
        };
        let mut parts = vec![format!("{}, {of_each}", counted(self.size, ["entry", "entries"]))];
        parts.extend(self.activations.then(|| "activations at the end of the control step".to_owned()));
        parts.extend(self.along.map(|along| format!("along the {along}")));
        parts.extend(self.speed.map(|speed| format!("at {} m/s", for_people(speed))));
        parts.extend(self.changes_over_to.map(|start| format!("then along the demonstration from {} s", for_people(start))));
        parts.extend(self.ranges.iter().map(|range| format!("up to {range}")));
        parts.extend((self.scale < 1.0).then(|| format!("scaled by {}", for_people(self.scale))));
        parts.extend((self.filter > 0.0).then(|| format!("filtered with {} s", for_people(self.filter))));
        parts.extend((self.latency > 0).then(|| format!("{} late", counted(self.latency as usize, ["step", "steps"]))));
        parts.extend(self.residual.as_ref().map(|base| format!("added to the action of `{base}`")));
        parts.join("; ")
    }
}

fn counted(count: usize, [one, several]: [&str; 2]) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}
