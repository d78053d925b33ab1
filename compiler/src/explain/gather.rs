//! Builds the report of a compiled task.

use super::report::*;
use crate::graph::NodeId;
use crate::graph::operation::{Memory, Operation};
use crate::notation::{latex, mathml};
use crate::snapshot::names;
use crate::task::{CompiledTask, Phase, StepReport, TaskState};
use msk_program::debug::{ConditionDebug, Definition};
use msk_program::evaluation::{Draws, Middle};
use msk_program::formula::Notation;
use std::borrow::Cow;
use std::collections::BTreeSet;

mod scene;

/// What an explanation may tell besides the source.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options<'a> {
    /// The frame of the reset snapshot, `task.frame.size()` values: adds the value of every term at reset.
    pub reset: Option<&'a [f64]>,
}

/// The report of a task.
pub fn task_report(task: &CompiledTask, options: &Options<'_>) -> TaskReport {
    let at_reset = options.reset.filter(|frame| frame.len() == task.frame.size()).and_then(|frame| {
        let (mut state, mut report) = (TaskState::default(), StepReport::default());
        // A random without a middle that fulfils its condition leaves nothing to show.
        task.reset(frame, &mut Middle, &mut state).ok()?;
        task.report(frame, &task.weights(), &state, &mut report);
        Some(report)
    });
    let at_reset = at_reset.as_ref();
    // Random values are reported by the middle of their range.
    let mut drawn = TaskState::default();
    let mut disturbances = task.disturbances.clone();
    let init = match task.begin(&mut Middle, &mut drawn) {
        Ok(()) => {
            task.begin_disturbances(&drawn, &mut disturbances);
            task.initial_state(&drawn)
        }
        Err(_) => Cow::Borrowed(&task.init),
    };
    let phases = task.phases.iter().enumerate().map(|(index, phase)| {
        // Only the first phase has the reset as its first snapshot.
        phase_report(task, phase, at_reset.filter(|_| index == 0))
    });
    TaskReport {
        form: FORM,
        name: task.name.clone(),
        family: task.family.clone(),
        summary: task.summary.clone(),
        hash: task.hash.clone(),
        body: task.body.name.clone(),
        control_frequency: task.control_frequency,
        horizon: task.horizon,
        duration: f64::from(task.horizon) / task.control_frequency,
        symmetric: task.symmetric,
        action: super::action::action(task),
        parameters: task.parameters.clone(),
        motions: motions(task),
        randoms: task.randoms.iter().filter(|random| random.parameter.is_none()).cloned().collect(),
        scene: scene::scene(task, &init),
        initial_state: scene::initial_state(task, &init),
        disturbances: scene::disturbances(task, &disturbances),
        phases: phases.collect(),
        observation: observation(task),
        reward_at_reset: at_reset.map(|report| report.reward),
    }
}

fn motions(task: &CompiledTask) -> Vec<MotionReport> {
    let reports = task.motions.iter().map(|followed| MotionReport {
        name: followed.name.clone(),
        title: followed.motion.name.clone(),
        digest: followed.motion.digest().to_owned(),
        cycle: followed.motion.cycle,
        duration: followed.motion.duration,
        joints: followed.motion.joints().count(),
        start: followed.start.fixed(),
    });
    reports.collect()
}

/// A formula in all notations.
fn formula_report(formula: &Notation, source: &str) -> FormulaReport {
    let Notation { plain, tree } = formula;
    FormulaReport { source: source.to_owned(), text: plain.clone(), latex: latex(tree), mathml: mathml(tree) }
}

fn phase_report(task: &CompiledTask, phase: &Phase, at_reset: Option<&StepReport>) -> PhaseReport {
    let meaning = &phase.debug;
    let terms = phase.terms.clone().zip(&meaning.terms).enumerate().map(|(own, (index, debug))| {
        let term = &task.terms[index];
        let bounds =
            meaning.term_bounds.get(own).map(|bounds| [bounds.low, bounds.high]).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        TermReport {
            name: term.name.clone(),
            weight: term.weight,
            schedule: term.schedule,
            weight_in_source: term.written,
            weight_from: term.origin.to_string(),
            weight_range: term.weight_range,
            fixed: term.fixed,
            formula: formula_report(&debug.formula, &term.source),
            docs: debug.docs.clone(),
            per_second: debug.per_second,
            condition: debug.condition,
            bounds: bounds.map(|bound| bound.is_finite().then_some(bound)),
            reads: debug.reads.clone(),
            remembers: phase.outputs.terms.get(own).map_or_else(Vec::new, |&node| memories(task, phase, node)),
            at_reset: at_reset.and_then(|report| report.terms.get(index).copied()),
        }
    });
    let ends = |names: &[String], conditions: &[ConditionDebug], holds: &[bool], bootstraps: &[bool]| -> Vec<EndReport> {
        let pairs = names.iter().zip(conditions).enumerate();
        let reported = pairs.map(|(index, (name, debug))| EndReport {
            bootstrap: bootstraps.get(index) == Some(&true),
            ..end(name, debug, holds.get(index).copied())
        });
        reported.collect()
    };
    let held = |report: fn(&StepReport) -> &[bool], range: std::ops::Range<usize>| {
        at_reset.and_then(|found| report(found).get(range)).unwrap_or_default()
    };
    let metrics = task.metrics[phase.metrics.clone()].iter().zip(&meaning.metrics).map(|(metric, debug)| MetricReport {
        name: metric.name.clone(),
        size: metric.size,
        unit: metric.unit.clone(),
        formula: formula_report(&debug.formula, ""),
    });
    PhaseReport {
        name: phase.name.clone(),
        horizon: phase.horizon,
        until: meaning.until.as_ref().map(|until| formula_report(&until.formula, &until.source)),
        terms: terms.collect(),
        terminations: ends(
            &task.terminations[phase.terminations.clone()],
            &meaning.terminations,
            held(|report| &report.terminations, phase.terminations.clone()),
            &[],
        ),
        finishes: ends(
            &task.finishes[phase.finishes.clone()],
            &meaning.finishes,
            held(|report| &report.finishes, phase.finishes.clone()),
            &task.bootstraps[phase.finishes.clone()],
        ),
        success: meaning.success.as_ref().map(|success| end("", success, at_reset.map(|report| report.success))),
        metrics: metrics.collect(),
        definitions: meaning.definitions.iter().map(definition).collect(),
    }
}

fn end(name: &str, debug: &ConditionDebug, holds_at_reset: Option<bool>) -> EndReport {
    EndReport {
        name: name.to_owned(),
        condition: formula_report(&debug.formula, &debug.source),
        after: debug.after.clone(),
        docs: debug.docs.clone(),
        holds_at_reset,
        bootstrap: false,
    }
}

fn definition(definition: &Definition) -> DefinitionReport {
    let part = |(word, formula): &(&'static str, Notation)| ((*word).to_owned(), formula_report(formula, ""));
    DefinitionReport {
        kind: definition.kind.to_owned(),
        name: definition.name.clone(),
        parameters: definition.parameters.clone(),
        parts: definition.parts.iter().map(part).collect(),
        docs: definition.docs.clone(),
    }
}

fn observation(task: &CompiledTask) -> ObservationReport {
    let report = |(place, channel): (usize, &crate::task::Channel)| {
        let debug = task.phases.iter().find_map(|phase| {
            let own = phase.channels.get(place).copied().flatten()?;
            phase.debug.channels.get(own)
        });
        ChannelReport {
            name: channel.name.clone(),
            offset: channel.offset,
            size: channel.size,
            unit: channel.unit.clone(),
            block: debug.map(|debug| debug.block.clone()).unwrap_or_default(),
            formula: debug.map(|debug| formula_report(&debug.formula, "")).unwrap_or_default(),
            settings: debug.map(|debug| debug.settings.clone()).unwrap_or_default(),
            docs: debug.map(|debug| debug.docs.clone()).unwrap_or_default(),
        }
    };
    let mut all = task.channels.iter().chain(&task.critic).enumerate().map(report);
    let channels = all.by_ref().take(task.channels.len()).collect();
    ObservationReport { size: task.observation_size(), channels, critic: all.collect() }
}

/// The memories that a node depends on, in words.
fn memories(task: &CompiledTask, phase: &Phase, node: NodeId) -> Vec<String> {
    let graph = &phase.graph;
    let mut seen = BTreeSet::new();
    let texts = graph.reachable([node]).into_iter().filter_map(|id| {
        let node = graph.node(id);
        let values = |width: usize| if width == 1 { "1 value".to_owned() } else { format!("{width} values") };
        let text = match &node.operation {
            Operation::Memory(Memory::Delay(1)) => format!("{}, a step ago", values(node.width)),
            Operation::Memory(Memory::Delay(steps)) => format!("{}, {steps} steps ago", values(node.width)),
            Operation::Memory(memory) => format!("{}, {}", values(node.width), memory_in_words(*memory)),
            Operation::StateBefore(index) | Operation::StateAfter(index) => {
                let name = phase.debug.states.get(*index as usize);
                format!("the state {}", name.map_or_else(|| index.to_string(), Clone::clone))
            }
            Operation::Drawn(index) | Operation::DrawnAfter(index) => {
                let random = &task.randoms[phase.streams[*index as usize]];
                let kind = if random.parameter.is_some() { "parameter" } else { "random" };
                format!("the {kind} {}", random.name)
            }
            _ => return None,
        };
        // What comes twice is counted by its width already or is the same thing.
        seen.insert((id, text.clone())).then_some(text)
    });
    let mut texts: Vec<String> = texts.collect();
    texts.dedup();
    texts
}

fn memory_in_words(memory: Memory) -> &'static str {
    match memory {
        Memory::Initial => "as at reset",
        Memory::Highest => "running maximum",
        Memory::Lowest => "running minimum",
        Memory::Accumulate => "sum over the steps",
        Memory::Streak => "steps in a row",
        Memory::StepsSince => "steps since it held",
        Memory::Hysteresis => "with hysteresis",
        Memory::Smooth | Memory::SmoothAngle => "smoothed",
        Memory::Sampled => "last sampled value",
        Memory::Delay(_) => "from before",
    }
}

/// The random values of the initial state, by name.
fn drawn(task: &CompiledTask) -> Vec<String> {
    let varies = varies(task);
    let drawn = task.init.drawn.iter().filter(|(_, index)| varies(*index));
    let mut names: Vec<String> = drawn.map(|&(setting, _)| names::setting(task, setting)).collect();
    // The samples of a height field are one field of the scene.
    names.dedup();
    names
}

/// Whether the number at a place of [`CompiledTask::drawn`] varies. A place with one random component is evaluated as a whole: a value
/// that is the same for two different draws does not.
fn varies(task: &CompiledTask) -> impl Fn(usize) -> bool + '_ {
    let begun = |share: f64| {
        let mut state = TaskState::default();
        task.begin(&mut Share(share), &mut state).ok().map(|()| state)
    };
    let (low, high) = (begun(0.25), begun(0.75));
    move |index: usize| match (&low, &high) {
        (Some(low), Some(high)) => task.drawn(index, low) != task.drawn(index, high),
        _ => true,
    }
}

/// Always the same share of every distribution.
struct Share(f64);

impl Draws for Share {
    fn uniform(&mut self, _: usize) -> f64 {
        self.0
    }

    fn normal(&mut self, _: usize) -> f64 {
        self.0 - 0.5
    }
}
