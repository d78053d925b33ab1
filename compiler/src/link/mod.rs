//! From checked tasks to a compiled one: layout, labels, debug information, hash. Several phases become one task.

mod definitions;

pub(crate) use definitions::definitions;

use crate::body::BodyDescription;
use crate::check::CheckedTests;
use crate::check::observe::ObservedChannel;
use crate::check::task::CheckedTask;
use crate::diagnostics::FileId;
use crate::frame::FrameLayout;
use crate::init::Start;
use crate::lint::gated;
use crate::notation::{indicator, names_in, notation};
use crate::resolve::inherit::{Placed, WholeTask};
use crate::resolve::summary;
use crate::resolve::{Texts, written};
use crate::syntax::tree::{Docs, Ends, Entry, Expr, Random, TaskStatement};
use crate::task::{Channel, CompiledTask, FollowedMotion, Phase, PhaseParts, RandomValue, TaskTests, Term};
use crate::testing::TaskTest;
use crate::vocabulary::Vocabulary;
use msk_program::debug::{ChannelDebug, ConditionDebug, DebugInfo, Definition, TermDebug};
use msk_program::lower::{DrawOutput, Outputs, layout};
use msk_program::source::Places;
use std::borrow::Cow;
use std::sync::Arc;

/// A checked task with what it was read from.
#[derive(Clone)]
pub(crate) struct CheckedPhase<'a> {
    pub source: &'a WholeTask,
    pub checked: CheckedTask<'a>,
    /// When the next begins.
    pub until: Option<(&'a Expr, FileId)>,
    /// What its formulas name.
    pub definitions: Vec<Definition>,
}

/// The header of a task by itself, or of a sequence as a whole.
#[derive(Clone)]
pub(crate) struct Heading<'a> {
    pub name: &'a str,
    pub docs: Option<&'a Docs>,
    pub family: String,
    pub body: Arc<BodyDescription>,
    pub body_digest: Cow<'a, str>,
    pub vocabulary: Arc<Vocabulary>,
    /// Success, where a sequence declares it.
    pub success: Option<(&'a Expr, FileId)>,
    /// Names of the randoms and of the parameters that all phases share.
    pub shared: Vec<String>,
}

/// Phases as their tests see them, with those tests: one for each phase, and the first of them knows of all expectations.
pub(crate) struct Tested<'a> {
    pub phases: Vec<CheckedPhase<'a>>,
    pub tests: Vec<CheckedTests>,
}

/// Lowers checked tasks: one for a task by itself, several for a sequence; with their tests. `None` if there is none.
pub(crate) fn finish(
    heading: Heading<'_>,
    phases: Vec<CheckedPhase<'_>>,
    tested: Option<Tested<'_>>,
    texts: &dyn Texts,
) -> CompiledTask {
    let probed = tested.map(|tested| with_probes(&heading, tested, texts));
    let body_digest = heading.body_digest.clone();
    let mut task = lower(heading, phases, texts);
    task.hash = task.content_hash(&body_digest);
    task.tests = probed.map(|(mut probed, first, tests)| {
        probed.hash.clone_from(&task.hash);
        Arc::new(TaskTests { task: Arc::new(probed), first, tests })
    });
    task
}

/// The task that tests run: each phase has all that they look at behind its metrics. Also where that begins, and the tests.
fn with_probes(heading: &Heading<'_>, tested: Tested<'_>, texts: &dyn Texts) -> (CompiledTask, Vec<usize>, Vec<TaskTest>) {
    let (mut phases, mut all, mut places, mut count) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for (mut phase, tests) in tested.phases.into_iter().zip(tested.tests) {
        let CheckedTests { graph, queries, initial_values, probes, tests, .. } = tests;
        places.push(count + phase.checked.metrics.len());
        phase.checked.metrics.extend(probes);
        count += phase.checked.metrics.len();
        let checked = CheckedTask { graph, queries, initial_values, ..phase.checked };
        phases.push(CheckedPhase { checked, ..phase });
        all.push(tests);
    }
    let task = lower(heading.clone(), phases, texts);
    let first = places.into_iter().map(|place| task.metrics.get(place).map_or(0, |probe| probe.offset)).collect();
    (task, first, all.into_iter().next().unwrap_or_default())
}

/// Lowers checked tasks, of which there is at least one.
fn lower(heading: Heading<'_>, phases: Vec<CheckedPhase<'_>>, texts: &dyn Texts) -> CompiledTask {
    let all_outputs: Vec<Outputs> = phases.iter().map(|phase| outputs(&phase.checked)).collect();
    let queries = phases.last().map(|phase| phase.checked.queries.clone()).unwrap_or_default();
    let frame = layout(phases.iter().map(|phase| &phase.checked.graph).zip(&all_outputs), &queries);
    let several = phases.len() > 1;
    let mut whole = Whole { several, ..Whole::default() };
    // A task is one phase; the checker refuses sequences of fewer than two.
    let mut compiled = begun(&heading, &phases[0].checked, &frame);
    let mut made = Vec::new();
    for (phase, outputs) in phases.into_iter().zip(all_outputs) {
        let CheckedPhase { source, checked, until, definitions } = phase;
        let name = source.task.name.text.clone();
        whole.parameters(&name, &heading.shared, &checked);
        let streams = whole.randoms(&name, &heading.shared, source, &checked, texts);
        let channels = whole.channels(&name, &checked);
        let own = |list: &mut Vec<String>, names: Vec<String>| {
            let first = list.len();
            list.extend(names.iter().map(|own| labelled(several, &name, own)));
            first..list.len()
        };
        let terminations = own(&mut whole.terminations, checked.terminations.iter().map(|end| end.name.clone()).collect());
        whole.bootstraps.extend(checked.finishes.iter().map(|end| end.bootstraps));
        let finishes = own(&mut whole.finishes, checked.finishes.iter().map(|end| end.name.clone()).collect());
        let terms = whole.terms(&name, &checked, texts);
        let metrics = whole.metrics(&name, &checked);
        for reference in &checked.references {
            let (name, motion) = (labelled(several, &name, &reference.name), reference.motion.clone());
            let drawn = || checked.initial_values.iter().position(|node| *node == reference.start);
            let start = match checked.graph.constant_value(reference.start) {
                Some(phase) => Start::Phase(phase),
                None => Start::Drawn(drawn().unwrap_or(usize::MAX)),
            };
            whole.motions.push(FollowedMotion { name, motion, start, phase: made.len() });
        }
        add_places(&mut compiled.places, &checked);
        whole.horizon = whole.horizon.saturating_add(checked.timing.horizon);
        let horizon = checked.timing.horizon;
        let outer = FromSequence { until, success: heading.success, definitions };
        let debug = debug_info(source, &checked, &outputs, outer, texts);
        let graph = checked.graph;
        made.push(PhaseParts { name, horizon, graph, outputs, terms, terminations, finishes, metrics, channels, streams, debug });
    }
    let critic = whole.split_groups(&mut made);
    let phases = made.into_iter().map(|parts| Phase::new(parts, &frame, [&whole.channels, &critic], &whole.metrics));
    compiled.phases = phases.collect();
    compiled.horizon = whole.horizon;
    (compiled.channels, compiled.terms, compiled.metrics) = (whole.channels, whole.terms, whole.metrics);
    compiled.critic = critic;
    (compiled.terminations, compiled.finishes, compiled.bootstraps) = (whole.terminations, whole.finishes, whole.bootstraps);
    (compiled.randoms, compiled.parameters) = (whole.randoms, whole.parameters);
    compiled.motions = whole.motions;
    compiled
}

/// What a task takes from its first phase; what its phases share is still empty.
fn begun(heading: &Heading<'_>, first: &CheckedTask<'_>, frame: &FrameLayout) -> CompiledTask {
    CompiledTask {
        name: heading.name.to_owned(),
        family: heading.family.clone(),
        summary: summary(heading.docs),
        body: heading.body.clone(),
        vocabulary: heading.vocabulary.clone(),
        control_frequency: first.control_frequency,
        horizon: 0,
        action: first.action.clone(),
        symmetric: first.symmetric,
        scene: first.scene.clone(),
        init: first.init.clone(),
        disturbances: first.disturbances.clone(),
        drawn_disturbances: first.drawn_disturbances.clone(),
        releases: first.releases.iter().map(|(connection, _)| *connection).collect(),
        markers: first.markers.iter().map(|(name, _)| name.clone()).collect(),
        driven: first.drives.iter().map(|(object, _)| *object).collect(),
        channels: Vec::new(),
        critic: Vec::new(),
        terms: Vec::new(),
        terminations: Vec::new(),
        finishes: Vec::new(),
        bootstraps: Vec::new(),
        metrics: Vec::new(),
        randoms: Vec::new(),
        parameters: Vec::new(),
        motions: Vec::new(),
        frame: frame.clone(),
        hash: String::new(),
        tests: None,
        places: Places { init: first.init_at, ..Places::default() },
        phases: [].into(),
    }
}

/// Adds where a phase stands; success is that of the last.
fn add_places(places: &mut Places, checked: &CheckedTask<'_>) {
    places.success = checked.success_at;
    places.terminations.extend(checked.terminations.iter().map(|end| (end.file, end.span)));
    places.finishes.extend(checked.finishes.iter().map(|end| (end.file, end.span)));
    places.terms.extend(checked.terms.iter().map(|term| (term.file, term.formula.span)));
}

fn labelled(several: bool, phase: &str, name: &str) -> String {
    if several { format!("{phase}.{name}") } else { name.to_owned() }
}

/// What all phases report together.
#[derive(Default)]
struct Whole {
    several: bool,
    horizon: u32,
    channels: Vec<Channel>,
    /// The formula of each channel as written, and whether only a critic sees it.
    sources: Vec<(String, bool)>,
    terms: Vec<Term>,
    metrics: Vec<Channel>,
    terminations: Vec<String>,
    finishes: Vec<String>,
    bootstraps: Vec<bool>,
    randoms: Vec<RandomValue>,
    parameters: Vec<crate::task::Parameter>,
    motions: Vec<FollowedMotion>,
}

impl Whole {
    /// Adds the channels of a phase; those that an earlier one has just so are shared. Gives, for each channel so far, its
    /// place among the phase's own.
    fn channels(&mut self, phase: &str, checked: &CheckedTask<'_>) -> Vec<Option<usize>> {
        let mut places = vec![None; self.channels.len()];
        for (own, channel) in checked.channels.iter().enumerate() {
            let size = checked.graph.width(channel.node);
            let same = self.channels.iter().zip(&self.sources).position(|(known, source)| {
                known.size == size
                    && known.unit == channel.unit
                    && known.name == channel.name
                    && *source == (channel.source.clone(), channel.critic)
            });
            match same {
                Some(place) => places[place] = Some(own),
                None => {
                    let taken = self.channels.iter().any(|known| known.name == channel.name);
                    let name = if taken { format!("{phase}.{}", channel.name) } else { channel.name.clone() };
                    let offset = self.channels.last().map_or(0, |last| last.offset + last.size);
                    self.channels.push(Channel { name, offset, size, unit: channel.unit.clone() });
                    self.sources.push((channel.source.clone(), channel.critic));
                    places.push(Some(own));
                }
            }
        }
        places
    }

    /// Puts the channels of the observation first, with that which tells phases apart, and takes those of a critic out. The places of
    /// the phases' own follow that order.
    fn split_groups(&mut self, made: &mut [PhaseParts]) -> Vec<Channel> {
        let (critic, observed): (Vec<usize>, Vec<usize>) = (0..self.sources.len()).partition(|&place| self.sources[place].1);
        let orders = [observed, critic];
        let [mut observed, critic] = orders.each_ref().map(|order| {
            let mut offset = 0;
            let channels = order.iter().map(|&place| {
                let channel = Channel { offset, ..self.channels[place].clone() };
                offset += channel.size;
                channel
            });
            channels.collect::<Vec<Channel>>()
        });
        let phase = self.several.then(|| {
            let offset = observed.last().map_or(0, |channel| channel.offset + channel.size);
            observed.push(Channel { name: "phase".to_owned(), offset, size: made.len(), unit: String::new() });
        });
        for parts in made {
            let own = |place: &usize| parts.channels.get(*place).copied().flatten();
            let [first, second] = orders.each_ref().map(|order| order.iter().map(own).collect::<Vec<Option<usize>>>());
            parts.channels = first.into_iter().chain(phase.map(|()| None)).chain(second).collect();
        }
        self.channels = observed;
        critic
    }

    fn terms(&mut self, phase: &str, checked: &CheckedTask<'_>, texts: &dyn Texts) -> std::ops::Range<usize> {
        let first = self.terms.len();
        for term in &checked.terms {
            let source = written(term.formula, term.file, texts);
            self.terms.push(Term {
                name: labelled(self.several, phase, &term.name),
                weight: term.weight,
                schedule: term.schedule,
                written: term.weight,
                origin: crate::task::Origin::Source,
                weight_range: term.range,
                fixed: term.fixed,
                source: if term.per_second { format!("({source}) * dt") } else { source },
            });
        }
        first..self.terms.len()
    }

    fn metrics(&mut self, phase: &str, checked: &CheckedTask<'_>) -> std::ops::Range<usize> {
        let first = self.metrics.len();
        for metric in &checked.metrics {
            let offset = self.metrics.last().map_or(0, |last| last.offset + last.size);
            let (size, unit) = (checked.graph.width(metric.node), metric.unit.clone());
            self.metrics.push(Channel { name: labelled(self.several, phase, &metric.name), offset, size, unit });
        }
        first..self.metrics.len()
    }

    /// Adds the parameters of a phase, but for those per episode that all phases share.
    fn parameters(&mut self, phase: &str, shared: &[String], checked: &CheckedTask<'_>) {
        for parameter in &checked.parameters {
            let is_shared = parameter.per_episode && shared.contains(&parameter.name);
            let name = if is_shared { parameter.name.clone() } else { labelled(self.several, phase, &parameter.name) };
            if !is_shared || self.parameters.iter().all(|known| known.name != name) {
                self.parameters.push(crate::task::Parameter { name, ..parameter.clone() });
            }
        }
    }

    /// Adds the randoms of a phase, but for those that all phases share; gives their places.
    fn randoms(
        &mut self,
        phase: &str,
        shared: &[String],
        source: &WholeTask,
        checked: &CheckedTask<'_>,
        texts: &dyn Texts,
    ) -> Vec<usize> {
        let mut streams = Vec::new();
        for random in &checked.randoms {
            let is_shared = shared.contains(&random.name);
            let name = if is_shared { random.name.clone() } else { labelled(self.several, phase, &random.name) };
            let place = self.randoms.iter().position(|known| known.name == name).unwrap_or_else(|| {
                let declared = source.statements.iter().find_map(|placed| match &placed.statement {
                    TaskStatement::Random(declared) if declared.name.text == random.name => Some((declared, placed.file)),
                    _ => None,
                });
                let of_caller = random.parameter.and_then(|_| self.parameters.iter().position(|known| known.name == name));
                let drawn = RandomValue { parameter: of_caller, ..random_value(name, declared, texts) };
                // The start of a reference and the noise of a channel are drawn without a statement of their own.
                self.randoms.push(match &random.written {
                    Some([source, redraw]) => RandomValue { source: source.clone(), redraw: redraw.clone(), ..drawn },
                    None => drawn,
                });
                self.randoms.len() - 1
            });
            streams.push(place);
        }
        streams
    }
}

fn random_value(name: String, declared: Option<(&Random, FileId)>, texts: &dyn Texts) -> RandomValue {
    let Some((random, file)) = declared else {
        return RandomValue { name, source: String::new(), accept: String::new(), redraw: String::new(), parameter: None };
    };
    let clause = |expr: &Option<Expr>| expr.as_ref().map_or_else(String::new, |expr| written(expr, file, texts));
    RandomValue {
        name,
        source: written(&random.distribution, file, texts),
        accept: clause(&random.accept),
        redraw: clause(&random.redraw),
        parameter: None,
    }
}

fn outputs(checked: &CheckedTask<'_>) -> Outputs {
    Outputs {
        terms: checked.terms.iter().map(|term| term.node).collect(),
        terminations: checked.terminations.iter().map(|end| end.node).collect(),
        finishes: checked.finishes.iter().map(|end| end.node).collect(),
        metrics: checked.metrics.iter().map(|metric| metric.node).collect(),
        success: Some(checked.success),
        channels: checked.channels.iter().map(|channel| channel.node).collect(),
        updates: checked.updates.clone(),
        draws: checked.randoms.iter().map(|random| DrawOutput { value: random.data.node, redraw: random.redraw }).collect(),
        initial_values: checked.initial_values.clone(),
        releases: checked.releases.iter().map(|(_, node)| *node).collect(),
        markers: checked.markers.iter().map(|(_, node)| *node).collect(),
        drives: checked.drives.iter().map(|(_, node)| *node).collect(),
        until: checked.phase.until,
        succeeded: checked.phase.succeeded,
    }
}

/// What a sequence adds to a phase, and the definitions that explain it.
struct FromSequence<'a> {
    until: Option<(&'a Expr, FileId)>,
    success: Option<(&'a Expr, FileId)>,
    definitions: Vec<Definition>,
}

fn debug_info(
    source: &WholeTask,
    checked: &CheckedTask<'_>,
    outputs: &Outputs,
    outer: FromSequence<'_>,
    texts: &dyn Texts,
) -> DebugInfo {
    let own = source.statements.iter().find_map(|placed| match &placed.statement {
        TaskStatement::Success(expr) => Some((expr, placed.file)),
        _ => None,
    });
    let condition = |(formula, file): (&Expr, FileId)| ConditionDebug {
        source: written(formula, file, texts),
        formula: notation(formula),
        docs: String::new(),
        after: String::new(),
    };
    let terms = checked.terms.iter().zip(&outputs.terms).map(|(term, &node)| TermDebug {
        formula: if term.condition { indicator(term.formula) } else { notation(term.formula) },
        docs: summary(term.docs),
        reads: names_in(term.formula),
        condition: term.condition,
        gated: term.condition || gated(term.formula, &checked.graph, node),
        per_second: term.per_second,
    });
    let channels = |channels: &[ObservedChannel]| {
        let debug = channels.iter().map(|channel| ChannelDebug {
            formula: notation(&channel.formula),
            docs: channel.docs.clone(),
            block: channel.block.clone(),
            settings: channel.settings.clone(),
        });
        debug.collect()
    };
    DebugInfo {
        terms: terms.collect(),
        terminations: conditions(&source.statements, texts, |statement| match statement {
            TaskStatement::Terminate(ends) => Some(ends),
            _ => None,
        }),
        finishes: conditions(&source.statements, texts, |statement| match statement {
            TaskStatement::Finish(ends) => Some(ends),
            _ => None,
        }),
        channels: channels(&checked.channels),
        metrics: channels(&checked.metrics),
        success: outer.success.or(own).map(condition),
        until: outer.until.map(condition),
        comparisons: checked.comparisons.clone(),
        lets: checked.lets.clone(),
        states: checked.states.iter().map(|state| state.name.clone()).collect(),
        definitions: outer.definitions,
        term_bounds: checked.term_bounds.clone(),
    }
}

/// The conditions of all reasons of a kind.
fn conditions(statements: &[Placed], texts: &dyn Texts, kind: fn(&TaskStatement) -> Option<&Ends>) -> Vec<ConditionDebug> {
    let mut conditions = Vec::new();
    for placed in statements {
        let Some(ends) = kind(&placed.statement) else { continue };
        let after = ends.after.as_ref().map_or_else(String::new, |after| written(after, placed.file, texts));
        for entry in &ends.reasons {
            let Entry::Item(reason) = entry else { continue };
            conditions.push(ConditionDebug {
                source: written(&reason.condition, placed.file, texts),
                formula: notation(&reason.condition),
                docs: summary(reason.docs.as_ref()),
                after: after.clone(),
            });
        }
    }
    conditions
}
