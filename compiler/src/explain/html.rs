//! A page for browsers: one file with everything in it, formulas as MathML, readable offline, by day and by night.

use super::report::*;
use crate::extremes::maximum;
use crate::numbers::for_people;
use askama::Template;

/// The page, as `page.html` lays it out.
#[derive(Template)]
#[template(path = "page.html")]
struct Page<'a> {
    title: &'a str,
    tasks: &'a [TaskReport],
}

/// Tasks as one self-contained page under a title.
pub fn html(title: &str, tasks: &[TaskReport]) -> String {
    // The template has no part that fails, and writing to a string cannot fail.
    Page { title, tasks }.render().unwrap_or_default()
}

mod filters {
    use super::{FormulaReport, for_people};
    use askama::filters::Safe;
    use askama::{Result, Values};

    /// A number for people.
    #[askama::filter_fn]
    pub fn number(value: &f64, _: &dyn Values) -> Result<String> {
        Ok(for_people(*value))
    }

    /// The components of a vector.
    #[askama::filter_fn]
    pub fn vector(value: &[f64; 3], _: &dyn Values) -> Result<String> {
        Ok(value.map(for_people).join(", "))
    }

    /// A formula as MathML.
    #[askama::filter_fn]
    pub fn math(formula: &FormulaReport, _: &dyn Values) -> Result<Safe<String>> {
        Ok(Safe(format!("<math>{}</math>", formula.mathml)))
    }
}

impl PhaseReport {
    /// The weight of a term as a part of the largest, in percent.
    fn share(&self, term: &TermReport) -> String {
        let largest = self.terms.iter().map(|term| term.weight.abs()).fold(0.0, maximum);
        format!("{:.1}", if largest > 0.0 { 100.0 * term.weight.abs() / largest } else { 0.0 })
    }

    /// All conditions that end it or make a success, each with its kind.
    fn ends(&self) -> impl Iterator<Item = (&'static str, &EndReport)> {
        let failures = self.terminations.iter().map(|end| ("failure", end));
        failures.chain(self.finishes.iter().map(|end| ("finish", end))).chain(self.success.iter().map(|end| ("success", end)))
    }
}

/// What stands below the elements of a scene.
fn scene(task: &TaskReport) -> Vec<String> {
    let connections = task.scene.connections.iter().map(|held| {
        let release = if held.released { ", can be released" } else { "" };
        format!("{} {} to {}{release}", held.kind, held.from, held.to)
    });
    let groups = task.scene.groups.iter().map(|(name, members)| format!("group {name}: {}", members.join(", ")));
    let markers = task.scene.markers.iter().map(|marker| format!("marked: {marker}"));
    let pushes = task.disturbances.iter().map(|push| {
        let (force, start, duration) = (push.force.map(for_people).join(", "), for_people(push.start), for_people(push.duration));
        format!("a force of [{force}] N on {} at {start} s for {duration} s{}", push.on, push.varies())
    });
    connections.chain(groups).chain(markers).chain(pushes).collect()
}

/// The channels of the observation, and those that only a critic sees.
fn observed(task: &TaskReport) -> impl Iterator<Item = (&ChannelReport, bool)> {
    let critic = task.observation.critic.iter().map(|channel| (channel, true));
    task.observation.channels.iter().map(|channel| (channel, false)).chain(critic)
}

fn initial_state(task: &TaskReport) -> Vec<String> {
    let initial_state = &task.initial_state;
    let mut lines = vec![initial_state.root.clone()];
    let joints = initial_state.independent_joints();
    let joints: Vec<String> = joints.iter().map(|(name, joint)| format!("{name} {}", joint.angle())).collect();
    lines.extend((!joints.is_empty()).then(|| format!("changes of the neutral pose: {}", joints.join(", "))));
    lines.extend(initial_state.noise.iter().map(|noise| format!("noise on {noise}")));
    lines.extend(initial_state.objects.iter().chain(&initial_state.scaled).cloned());
    lines
        .extend((!initial_state.drawn.is_empty()).then(|| format!("drawn for each episode: {}", initial_state.drawn.join(", "))));
    lines.extend((!initial_state.settle.is_empty()).then(|| format!("settles for {}", initial_state.settle)));
    lines
}

/// Parameters, motions and randoms.
fn settings(task: &TaskReport) -> Vec<String> {
    let parameters = task.parameters.iter().map(|parameter| {
        let range =
            parameter.range.map_or_else(String::new, |[low, high]| format!(", {} .. {}", for_people(low), for_people(high)));
        let per_episode = if parameter.per_episode { ", per episode" } else { "" };
        format!("{} = {} {}{range}{per_episode}", parameter.name, for_people(parameter.value), parameter.unit)
    });
    let motions = task.motions.iter().map(|motion| format!("{} follows {}", motion.name, motion.in_words()));
    let randoms = task.randoms.iter().map(|random| {
        let clause = |word: &str, clause: &str| if clause.is_empty() { String::new() } else { format!(" {word} {clause}") };
        let clauses = clause("where", &random.accept) + &clause("redraw when", &random.redraw);
        format!("{} is drawn from {}{clauses}", random.name, random.source)
    });
    parameters.chain(motions).chain(randoms).collect()
}
