//! A task: its statements in any order, from tree to [`CheckedTask`].

mod phase;
mod statements;
mod timing;
mod unread;

pub(crate) use phase::{InSequence, PhaseEnd};
pub(crate) use statements::body_of;

use super::action::Networks;
use super::context::{Cell, Checked, Checker, End, ReadMode, Reported, Timing};
use super::init::InitialState;
use super::observe::ObservedChannel;
use super::random::KnownRandom;
use super::reference::{KnownReference, Motions};
use super::reward::RewardTerm;
use super::scene::CheckedScene;
use super::tests::CheckedTests;
use crate::action::ActionSpace;
use crate::diagnostics::{Allowance, Diagnostic, FileId, Span};
use crate::frame::Query;
use crate::graph::interval::Bounds;
use crate::graph::{Graph, NodeId};
use crate::hir::Hir;
use crate::resolve::Texts;
use crate::resolve::inherit::WholeTask;
use crate::resolve::scope::{Names, Place};
use crate::scene::SceneDescription;
use crate::syntax::tree::TaskStatement;
use crate::task::{Disturbance, DisturbanceSetting, Init, Parameter};
use crate::vocabulary::Vocabulary;
use msk_program::debug::{Compared, NamedValue};
use std::sync::Arc;

/// A task whose every formula is checked and in the graph.
#[derive(Clone)]
pub(crate) struct CheckedTask<'a> {
    pub graph: Graph,
    /// Its formulas with their types.
    pub hir: Arc<Hir>,
    pub family: String,
    pub control_frequency: f64,
    pub timing: Timing,
    pub action: ActionSpace,
    pub symmetric: bool,
    pub scene: SceneDescription,
    pub init: Init,
    /// Numbers that the initial state takes from what is drawn.
    pub initial_values: Vec<NodeId>,
    pub disturbances: Vec<Disturbance>,
    /// Numbers of these that are drawn, with their places in `initial_values`.
    pub drawn_disturbances: Vec<(usize, DisturbanceSetting, usize)>,
    /// Connections of the scene with the conditions on which they let go.
    pub releases: Vec<(usize, NodeId)>,
    pub markers: Vec<(String, NodeId)>,
    /// Objects that formulas of time move, with what they do in a control step.
    pub drives: Vec<(usize, NodeId)>,
    pub queries: Vec<Query>,
    pub channels: Vec<ObservedChannel>,
    pub terms: Vec<RewardTerm<'a>>,
    pub metrics: Vec<ObservedChannel>,
    pub terminations: Vec<End>,
    pub finishes: Vec<End>,
    pub success: NodeId,
    /// Comparisons in formulas, in the order in which they were checked.
    pub comparisons: Vec<Compared>,
    /// What `let` names, in the order in which it was checked.
    pub lets: Vec<NamedValue>,
    /// Where the condition of success stands.
    pub success_at: (FileId, Span),
    /// Where the word `init` stands.
    pub init_at: (FileId, Span),
    /// What libraries allow in it.
    pub allowances: Vec<Allowance>,
    pub randoms: Vec<KnownRandom>,
    pub references: Vec<KnownReference>,
    pub parameters: Vec<Parameter>,
    pub phase: PhaseEnd,
    /// Between which values each term stays.
    pub term_bounds: Vec<Bounds>,
    /// New values of the declared states.
    pub updates: Vec<NodeId>,
    pub states: Vec<Cell>,
    /// Its tests, if it has any.
    pub tests: Option<CheckedTests>,
}

impl CheckedTask<'_> {
    /// What a policy sees: the channels but for those of a critic.
    pub fn observed(&self) -> impl Iterator<Item = &ObservedChannel> {
        self.channels.iter().filter(|channel| !channel.critic)
    }
}

/// What is known around a task when it is checked.
#[derive(Clone, Copy)]
pub(crate) struct Around<'a> {
    pub vocabulary: &'a Vocabulary,
    pub scene: &'a CheckedScene<'a>,
    pub texts: &'a dyn Texts,
    pub motions: Motions<'a>,
    pub networks: &'a Networks,
}

/// What is found of a task.
#[derive(Default)]
pub(crate) struct TaskDiagnostics {
    /// Errors, and warnings about single formulas.
    pub formulas: Vec<Diagnostic>,
    /// Warnings about the task as a whole.
    pub whole: Vec<Diagnostic>,
}

/// Checks a task against the vocabulary of its body. Errors and warnings come with it; the task only if there is no error. Lints
/// ask the checker for what it has learnt.
pub(crate) fn check<'a>(
    task: &'a WholeTask,
    names: &'a Names<'a>,
    around: Around<'a>,
    sequence: InSequence<'a>,
    queries: Vec<Query>,
) -> (Checker<'a>, Checked<CheckedTask<'a>>, TaskDiagnostics) {
    let Around { vocabulary, scene, texts, motions, networks } = around;
    let mut checker = Checker::new(vocabulary, names, Place::of_task(task.file), &task.statements);
    checker.known = scene.known.clone();
    checker.used = scene.used.clone();
    checker.scene = Some(scene);
    checker.motions = Some(motions);
    checker.networks = Some(networks);
    // Phases of a sequence share one frame, and so the numbers of the queries.
    checker.queries = queries;
    checker.timing.before = sequence.before;
    checker.phases = sequence.phases.iter().take(sequence.index).cloned().collect();
    checker.later_phases = sequence.phases.iter().skip(sequence.index + 1).cloned().collect();
    let mut checked = checker.task(task, texts, sequence);
    let finding = |checked: &mut CheckedTask<'_>| checked.graph.take_finding().or_else(|| checked.hir.verify(&checked.graph));
    if let Some(finding) = checked.as_mut().ok().and_then(finding) {
        checked = Err(checker.internal_error(finding, task.task.name.span));
    }
    let broken = Reported::among(&checker.diagnostics);
    let diagnostics = TaskDiagnostics { formulas: std::mem::take(&mut checker.diagnostics), whole: Vec::new() };
    let graph = std::mem::take(&mut checker.graph);
    let hir = checked.as_ref().map_or_else(|_| Arc::new(std::mem::take(&mut checker.hir)), |checked| checked.hir.clone());
    checker.keep_for_editors(hir, checked.as_ref().map_or(&graph, |checked| &checked.graph));
    let checked = checked.and_then(|checked| broken.map_or(Ok(checked), Err));
    (checker, checked, diagnostics)
}

impl<'a> Checker<'a> {
    fn task(&mut self, task: &'a WholeTask, texts: &dyn Texts, sequence: InSequence<'a>) -> Checked<CheckedTask<'a>> {
        self.lists_once(task);
        let parts = self.parts();
        self.must_not_hide_signals();
        // Both may read parameters, and parameters what follows from them.
        let frequency = parts.control.map(|(control, file)| self.in_file(file, |checker| checker.control(control))).transpose();
        self.settled.interval = true;
        let horizon = match (&frequency, parts.horizon) {
            (Ok(_), Some((horizon, file))) => self.in_file(file, |checker| checker.horizon(horizon)).map(Some),
            _ => Ok(None),
        };
        self.settled.horizon = true;
        let parameters = self.parameters();
        let action = parts.act.map(|(act, file)| self.in_file(file, |checker| checker.action_space(act))).transpose();
        self.states();
        self.references();
        self.randoms();
        let (init, staged) = self.in_mode(ReadMode { initial: true, ..self.mode }, |checker| {
            let init = checker.init(&parts.init);
            (init.map(|init| init.map(|init| checker.with_starts(init))), checker.staged())
        });
        let (terminations, finishes) = (self.terminations(), self.finishes());
        if let (Ok(terminations), Ok(finishes)) = (&terminations, &finishes) {
            self.must_not_share_reasons(terminations, finishes);
        }
        let terms = self.rewards();
        let metrics = self.metrics(texts);
        let own = parts.success.map(|(success, file)| self.in_file(file, |c| c.single_condition(success))).transpose();
        let succeeded = own.as_ref().ok().and_then(Option::as_ref).map(|own| own.node);
        if let (Some(name), Some(node)) = (sequence.phases.get(sequence.index), succeeded) {
            self.own_success = Some((name.clone(), node));
        }
        let phase = self.phase_end(sequence, succeeded);
        let success = match sequence.success.filter(|_| sequence.index + 1 == sequence.phases.len()) {
            Some((success, file)) => self.in_file(file, |checker| checker.single_condition(success)).map(Some),
            None => own,
        };
        let (updates, redraws) = (self.updates(), self.redraws());
        let channels = self.observations(texts);
        let shown = task.statements.iter().rev().find_map(|placed| match &placed.statement {
            TaskStatement::Observe(block) => Some((placed.file, block.keyword)),
            _ => None,
        });
        if let (Ok(channels), Some(place)) = (&channels, shown)
            && channels.iter().all(|channel| channel.critic)
        {
            self.observes_nothing(place);
        }
        self.parameters_in_use();
        self.unread();
        let complete = self.must_be_complete(task, &parts);
        let (control_frequency, _) = (frequency?, (horizon?, redraws?));
        let (staged, init, success) = (staged?, init?, success?);
        action?;
        complete?;
        let (Some(control_frequency), Some(mut init), Some(success)) = (control_frequency, init, success) else {
            return Err(self.incomplete(task, "`control`, `init` or `success`"));
        };
        let mut drawn_disturbances = Vec::new();
        for &(disturbance, setting, node) in &staged.drawn {
            drawn_disturbances.push((disturbance, setting, init.drawn.len()));
            init.drawn.push(node);
        }
        // What tests name stands in a graph of their own.
        let lets = std::mem::take(&mut self.lets);
        let tests = match (&terms, &channels, &terminations, &finishes) {
            (Ok(terms), Ok(channels), Ok(_), Ok(_)) => self.own_tests(sequence, &init, (terms, channels), success.node, texts)?,
            _ => None,
        };
        let begun_at = parts.init.last().map(|(block, file)| (*file, block.keyword));
        let success_at = sequence.success.or(parts.success).map(|(expr, file)| (file, expr.span));
        Ok(CheckedTask {
            family: parts.family.map(|(family, _)| family).unwrap_or_default().to_owned(),
            control_frequency,
            timing: self.timing,
            action: std::mem::take(&mut self.action),
            symmetric: parts.symmetric,
            scene: staged.scene,
            init: init.init,
            initial_values: init.drawn,
            disturbances: staged.disturbances,
            drawn_disturbances,
            releases: staged.releases,
            markers: staged.markers,
            drives: staged.drives,
            queries: std::mem::take(&mut self.queries),
            channels: channels?,
            terms: terms?,
            metrics: metrics?,
            terminations: terminations?,
            finishes: finishes?,
            success: success.node,
            success_at: success_at.unwrap_or((self.task_place.file, task.task.name.span)),
            init_at: begun_at.unwrap_or((self.task_place.file, task.task.name.span)),
            comparisons: std::mem::take(&mut self.comparisons),
            lets,
            allowances: std::mem::take(&mut self.allowances),
            randoms: std::mem::take(&mut self.randoms),
            references: self.references.clone(),
            parameters: parameters?,
            phase: phase?,
            term_bounds: Vec::new(),
            updates: updates?,
            states: std::mem::take(&mut self.cells),
            tests,
            // Last: what is taken here is lost where a part above is wrong.
            graph: std::mem::take(&mut self.graph),
            hir: Arc::new(std::mem::take(&mut self.hir)),
        })
    }

    /// Where references start is known wherever it is drawn, also if the initial state does not need it.
    fn with_starts(&self, mut init: InitialState) -> InitialState {
        let starts = self.references.iter().map(|known| known.start);
        for start in starts.filter(|start| self.graph.constant_value(*start).is_none()) {
            if !init.drawn.contains(&start) {
                init.drawn.push(start);
            }
        }
        init
    }
}
