//! Tests inside files: what they show, what they expect.
//!
//! 1. Statements are read in their order: those that set its initial state change a [`Scene`], each keyframe takes the one before
//!    it and changes it (`situation`);
//! 2. moments may show the initial state as the task draws it, once or many times (`reset`);
//! 3. expectations are checked once all moments are known (`expect`): every number that they look at is a node of the graph;
//! 4. the tests of a sequence are checked in each of its phases and put together (`phases`).
//!
//! All of it happens on a graph of its own, so that a task is the same with its tests and without.

mod expect;
mod phases;
mod play;
mod reset;
mod situation;

pub(crate) use reset::over_resets;

use super::context::{Checked, Checker, Failures, Local, ReadMode, Reported};
use super::dimension::Dimension;
use super::init::InitialState;
use super::observe::ObservedChannel;
use super::reward::RewardTerm;
use super::task::InSequence;
use super::types::ElementType;
use super::value::TypedValue;
use crate::diagnostics::{Diagnostic, FileId, Severity, Span, codes};
use crate::frame::Query;
use crate::graph::operation::{Binary, Memory};
use crate::graph::{Graph, NodeId};
use crate::numbers::for_people;
use crate::resolve::Texts;
use crate::spoken;
use crate::syntax::tree::{Expr, Ident, Test, TestStatement};
use crate::task::Spread;
use crate::testing::{Expectation, Keyframe, Run, Take, TaskTest};

/// The tests of a task, and what they need computed.
#[derive(Debug, Clone)]
pub(crate) struct CheckedTests {
    pub graph: Graph,
    pub queries: Vec<Query>,
    /// Numbers that initial states take from what is drawn: those of the task, and more.
    pub initial_values: Vec<NodeId>,
    /// What expectations look at.
    pub probes: Vec<ObservedChannel>,
    /// In a sequence without expectations until they are gathered.
    pub tests: Vec<TaskTest>,
    /// What a phase of a sequence knows of the expectations of each test.
    pub found: Vec<Vec<Found>>,
    /// What is wrong with the scripts of a sequence's tests.
    pub diagnostics: Vec<Diagnostic>,
    /// Whether something is.
    pub broken: Option<Reported>,
}

/// What an `expect` comes to in a phase of a sequence, or why it means nothing there.
pub(crate) type Found = Result<Vec<Expectation>, (Reported, Vec<Diagnostic>)>;

/// What names mean in tests only.
#[derive(Debug, Clone)]
pub(crate) struct InTests {
    /// The contribution of each term in a step, by name.
    contributions: Vec<(String, NodeId)>,
    /// The channels of the observation, by name.
    channels: Vec<(String, TypedValue)>,
    success: NodeId,
    /// The phases of the sequence, and which of them is being checked; empty for a task by itself.
    phases: Vec<String>,
    phase: usize,
    /// Control steps of the longest episode.
    horizon: u32,
}

/// What a script shows at a time.
#[derive(Debug, Clone)]
struct Scene {
    init: crate::task::Init,
    activation: f64,
    /// Which way the path of a motion goes that is played, rad.
    course: f64,
}

/// What a script shows from a step on.
#[derive(Debug, Clone)]
struct Key {
    step: u32,
    scene: Scene,
    /// Whether the motion that the scene follows goes on to the next.
    plays: bool,
}

impl Key {
    fn still(step: u32, scene: Scene) -> Self {
        Self { step, scene, plays: false }
    }
}

/// An episode of a test while its statements are read.
struct Draft {
    name: Option<String>,
    /// How it begins.
    begins: Scene,
    /// Whether the test sets the initial state.
    placed: bool,
    given: Vec<(usize, Vec<f64>)>,
    keys: Vec<Key>,
    /// Names of moments with their steps.
    labels: Vec<(String, u32)>,
    until: Option<u32>,
    run: Option<(String, Option<u32>)>,
    /// How many initial states it shows, if it is none that is played.
    resets: Option<u32>,
    /// A velocity that was given.
    velocity: Option<Span>,
}

/// An expectation with the loop variables where it stands.
struct Wanted<'a> {
    condition: &'a Expr,
    moment: Option<&'a Ident>,
    span: Span,
    locals: Vec<Local>,
}

/// What all statements of a test fill.
struct Reader<'a> {
    /// The test's own first, then its moments.
    drafts: Vec<Draft>,
    wanted: Vec<Wanted<'a>>,
}

impl<'a> Checker<'a> {
    /// Checks all tests; nothing of it stays in the task.
    pub(crate) fn tests(
        &mut self,
        tests: &[(&'a Test, FileId)],
        init: &InitialState,
        (terms, channels): (&[RewardTerm<'_>], &[ObservedChannel]),
        success: NodeId,
        texts: &dyn Texts,
        sequence: InSequence<'a>,
    ) -> Checked<Option<CheckedTests>> {
        if tests.is_empty() {
            return Ok(None);
        }
        let errors = self.diagnostics.len();
        let before = (self.graph.clone(), self.queries.clone(), self.used.clone(), self.memo.clone());
        let formulas = self.formulas.clone();
        let mode = ReadMode { initial: true, ..self.mode };
        let mode = std::mem::replace(&mut self.mode, mode);
        let contributions = terms.iter().map(|term| {
            let weight = self.graph.constant(term.weight);
            (term.name.clone(), self.graph.binary(Binary::Multiply, weight, term.node))
        });
        let (contributions, phases): (_, Vec<String>) = (contributions.collect(), sequence.phases.to_vec());
        let horizon = if phases.is_empty() { self.timing.horizon } else { sequence.horizon };
        let channels = channels.iter().map(|channel| (channel.name.clone(), channel.data.clone())).collect();
        self.in_tests = Some(InTests { contributions, channels, success, phases, phase: sequence.index, horizon });
        let (mut probes, mut drawn) = (Vec::new(), init.drawn.clone());
        let (mut compiled, mut all_found) = (Vec::new(), Vec::new());
        let mut failures = Failures::default();
        for &(test, file) in tests {
            match self.in_file(file, |checker| checker.test(test, init, &mut drawn, &mut probes, texts)) {
                Ok((test, found)) => {
                    compiled.push(test);
                    all_found.push(found);
                }
                Err(reported) => {
                    // The tests of a sequence keep their places in all phases.
                    all_found.push(Vec::new());
                    failures.add(reported);
                }
            }
        }
        self.mode = mode;
        self.in_tests = None;
        let graph = std::mem::replace(&mut self.graph, before.0);
        let queries = std::mem::replace(&mut self.queries, before.1);
        (self.used, self.memo, self.formulas) = (before.2, before.3, formulas);
        // What is wrong in a script is so in every phase; it is reported once, when the tests are gathered.
        let mut diagnostics = if sequence.phases.is_empty() { Vec::new() } else { self.diagnostics.split_off(errors) };
        diagnostics.retain(|diagnostic| diagnostic.severity == Severity::Error);
        let broken = failures.or(()).err();
        if let (Some(reported), true) = (broken, sequence.phases.is_empty()) {
            return Err(reported);
        }
        Ok(Some(CheckedTests {
            graph,
            queries,
            initial_values: drawn,
            probes,
            tests: compiled,
            found: all_found,
            diagnostics,
            broken,
        }))
    }

    fn test(
        &mut self,
        test: &'a Test,
        init: &InitialState,
        drawn: &mut Vec<NodeId>,
        probes: &mut Vec<ObservedChannel>,
        texts: &dyn Texts,
    ) -> Checked<(TaskTest, Vec<Found>)> {
        let mut begins = init.init.clone();
        let exact = |spreads: &mut Vec<Spread>| spreads.fill(Spread::None);
        exact(&mut begins.coordinate_noise);
        exact(&mut begins.velocity_noise);
        // A motion on which the task begins goes along the x axis of the world.
        let course = if init.motion.is_some() { 0.0 } else { begins.root.heading };
        let own = Draft::starting_from(Scene { init: begins, activation: 0.0, course });
        let mut reader = Reader { drafts: vec![own], wanted: Vec::new() };
        let mut failures = Failures::default();
        failures.catch(self.test_statements(&test.statements, test.cheat, 0, &mut reader, drawn));
        if reader.wanted.is_empty() && !test.cheat && !failures.any() {
            let message = format!("the test \"{}\" has no expectation", test.title.value);
            let diagnostic = self
                .diagnostic(codes::tests::EXPECTS_NOTHING, test.title.span, message)
                .help("add one: `expect success`, `expect ended by fallen`, `expect reward.pose at a < reward.pose at b`");
            return Err(self.report(diagnostic));
        }
        for draft in &reader.drafts {
            failures.catch(self.must_move_by_script(draft));
        }
        let expectations = self.expectations(test, &reader, probes, texts);
        failures.or(())?;
        let mut found = expectations?;
        // The test's own episode comes last, if anything looks at it.
        let count = reader.drafts.len();
        let renumbered = |take: usize| if take == 0 { count - 1 } else { take - 1 };
        found.iter_mut().flatten().for_each(|expectations| expect::renumber(expectations, renumbered));
        let mut takes: Vec<Take> = reader.drafts.into_iter().map(Draft::finish).collect();
        takes.rotate_left(1);
        let (title, at) = (test.title.value.clone(), (self.place.file, test.title.span));
        let mut test = TaskTest { title, cheat: test.cheat, at, takes, expectations: Vec::new() };
        if self.in_sequence() {
            return Ok((test, found));
        }
        test.expectations = found.into_iter().flatten().flatten().collect();
        test.expectations.iter_mut().for_each(Expectation::settle);
        test.drop_unread();
        Ok((test, Vec::new()))
    }

    /// Whether the tests being checked are those of a sequence.
    fn in_sequence(&self) -> bool {
        self.in_tests.as_ref().is_some_and(|in_tests| !in_tests.phases.is_empty())
    }

    fn test_statements(
        &mut self,
        statements: &'a [TestStatement],
        cheat: bool,
        take: usize,
        reader: &mut Reader<'a>,
        drawn: &mut Vec<NodeId>,
    ) -> Checked<()> {
        let mut failures = Failures::default();
        for statement in statements {
            if failures.catch(self.test_statement(statement, cheat, take, reader, drawn)).is_none() {
                // An expectation at that moment must not report that there is none.
                let label = match statement {
                    TestStatement::Keyframe { label, .. } => label.as_ref(),
                    TestStatement::Play(playing) => playing.label.as_ref(),
                    _ => None,
                };
                reader.drafts[take].labels.extend(label.map(|label| (label.text.clone(), 0)));
            }
        }
        failures.or(())
    }

    fn test_statement(
        &mut self,
        statement: &'a TestStatement,
        cheat: bool,
        take: usize,
        reader: &mut Reader<'a>,
        drawn: &mut Vec<NodeId>,
    ) -> Checked<()> {
        let draft = &mut reader.drafts[take];
        match statement {
            TestStatement::Pose(situation) => {
                self.must_begin(draft, situation.span)?;
                draft.placed = true;
                self.situation(situation, &mut draft.begins).map(|_| ())
            }
            TestStatement::Object(placement) => {
                self.must_begin(draft, placement.span)?;
                draft.placed = true;
                let moving = |field: &&crate::syntax::tree::Field| ["velocity", "spin"].contains(&field.name.text.as_str());
                draft.velocity = draft.velocity.or(placement.fields.iter().find(moving).map(|field| field.span));
                let mut initial = InitialState { init: draft.begins.init.clone(), drawn: std::mem::take(drawn), motion: None };
                let placed = match placement.object.text.as_str() {
                    "root" => self.root(placement, &mut initial),
                    _ => self.placement(placement, &mut initial),
                };
                (draft.begins.init, *drawn) = (initial.init, initial.drawn);
                if placement.object.text == "root" {
                    placement.fields.iter().for_each(|field| situation::unfollow_field(&mut draft.begins, &field.name.text));
                }
                placed
            }
            TestStatement::Keyframe { time, situation, label, span } => {
                let step = self.next_step(time, draft)?;
                let mut scene = draft.latest().clone();
                self.situation(situation, &mut scene)?;
                if draft.keys.is_empty() && step > 0 {
                    draft.keys.push(Key::still(0, draft.begins.clone()));
                }
                draft.keys.push(Key::still(step, scene));
                if let Some(label) = label {
                    self.must_be_fresh(label, *span, reader)?;
                    reader.drafts[take].labels.push((label.text.clone(), step));
                }
                Ok(())
            }
            TestStatement::Repeat { variable, range, statements, .. } => {
                for value in self.loop_values(range)? {
                    self.locals.push(self.local(variable, value));
                    let read = self.test_statements(statements, cheat, take, reader, drawn);
                    self.locals.pop();
                    read?;
                }
                Ok(())
            }
            TestStatement::Play(playing) => {
                let end = self.play(playing, draft, drawn)?;
                if let Some(label) = &playing.label {
                    self.must_be_fresh(label, playing.span, reader)?;
                    reader.drafts[take].labels.push((label.text.clone(), end));
                }
                Ok(())
            }
            // What is given is drawn where the episode begins: in the first phase of a sequence.
            TestStatement::Given { .. } if self.in_tests.as_ref().is_some_and(|in_tests| in_tests.phase > 0) => Ok(()),
            TestStatement::Given { name, value, .. } => {
                let given = self.given(name, value)?;
                draft.given.retain(|known| known.0 != given.0);
                draft.given.push(given);
                Ok(())
            }
            TestStatement::Until { time, span } => {
                self.must_not_reset(draft, *span)?;
                let step = self.script_step(time)?;
                self.must_be_seen(step, time.span)?;
                if draft.until.replace(step).is_some() || draft.run.is_some() || step == 0 {
                    let message = "`until` appears at most once, after every `at`, and not together with `run`";
                    return Err(self.error(codes::tests::TEST_ORDER, *span, message));
                }
                Ok(())
            }
            TestStatement::Run { policy, duration, span } => {
                self.must_not_reset(draft, *span)?;
                if cheat && policy.text == Run::GIVEN {
                    let message = "a cheat shows an exploit by itself and cannot run the policy that is tested";
                    let diagnostic = self.diagnostic(codes::tests::TEST_PLACE, policy.span, message);
                    return Err(self.report(diagnostic.help("name a policy, `run random`, or move it into a `test`")));
                }
                let steps = duration.as_ref().map(|duration| self.script_step(duration)).transpose()?;
                let draft = &mut reader.drafts[take];
                let from = draft.keys.last().map_or(0, |key| key.step);
                self.must_be_seen(from.saturating_add(steps.unwrap_or(0)), *span)?;
                if draft.run.replace((policy.text.clone(), steps)).is_some() || draft.until.is_some() || steps == Some(0) {
                    let message = "`run` appears at most once, with a duration, and not together with `until`";
                    return Err(self.error(codes::tests::TEST_ORDER, *span, message));
                }
                Ok(())
            }
            TestStatement::Reset { times, span } => self.reset(times.as_ref(), *span, cheat, &mut reader.drafts[take]),
            TestStatement::Moment { name, statements, span } => {
                if take != 0 {
                    return Err(self.error(codes::tests::TEST_PLACE, *span, "a moment cannot contain moments"));
                }
                self.must_be_fresh(name, *span, reader)?;
                let own = &reader.drafts[0];
                let draft = Draft {
                    name: Some(name.text.clone()),
                    placed: own.placed,
                    given: own.given.clone(),
                    velocity: own.velocity,
                    ..Draft::starting_from(own.begins.clone())
                };
                reader.drafts.push(draft);
                let take = reader.drafts.len() - 1;
                self.test_statements(statements, cheat, take, reader, drawn)
            }
            TestStatement::Expect { condition, moment, span } => {
                if take != 0 {
                    let message = "a moment contains no expectations; write them after it: `expect ... at NAME`";
                    return Err(self.error(codes::tests::TEST_PLACE, *span, message));
                }
                let locals = self.locals.clone();
                reader.wanted.push(Wanted { condition, moment: moment.as_ref(), span: *span, locals });
                Ok(())
            }
        }
    }

    /// Its initial state is set before it moves.
    fn must_begin(&mut self, draft: &Draft, span: Span) -> Checked<()> {
        self.must_not_reset(draft, span)?;
        if draft.keys.is_empty() && draft.is_open() {
            return Ok(());
        }
        let diagnostic = self
            .diagnostic(codes::tests::TEST_PLACE, span, "the initial state of a test comes before its keyframes")
            .help("later changes need a time: `at 2 s pose squatting { root.at = [1 m, 0 m] }`");
        Err(self.report(diagnostic))
    }

    fn must_be_fresh(&mut self, name: &Ident, span: Span, reader: &Reader<'_>) -> Checked<()> {
        let names = reader.drafts.iter().flat_map(|draft| draft.name.iter().chain(draft.labels.iter().map(|(name, _)| name)));
        if names.into_iter().any(|known| *known == name.text) {
            let message = format!("the moment `{}` is declared twice", name.text);
            return Err(self.error(codes::tasks::LABEL_TWICE, span, message));
        }
        Ok(())
    }

    /// What is played moves as scripted; only physics takes up a velocity.
    fn must_move_by_script(&mut self, draft: &Draft) -> Checked<()> {
        let (Some(span), true) = (draft.velocity, draft.run.is_none() || !draft.keys.is_empty()) else { return Ok(()) };
        let diagnostic = self
            .diagnostic(codes::tests::TEST_PLACE, span, "velocities of a script follow from its motion")
            .help("move it with keyframes: `at 0.1 s pose neutral { root.at = [5 cm, 0 m] }`");
        Err(self.report(diagnostic))
    }

    /// The time of what a script shows next, control steps.
    fn next_step(&mut self, time: &'a Expr, draft: &Draft) -> Checked<u32> {
        self.must_not_reset(draft, time.span)?;
        let step = self.script_step(time)?;
        self.must_be_seen(step, time.span)?;
        if draft.is_open() && draft.keys.last().is_none_or(|last| last.step < step) {
            return Ok(step);
        }
        Err(self.error(codes::tests::TEST_ORDER, time.span, "this time is not after the previous one"))
    }

    /// A time of a script, control steps.
    fn script_step(&mut self, time: &'a Expr) -> Checked<u32> {
        let steps = self.steps(time)?;
        if steps > 1e7 {
            return Err(self.error(codes::tests::TEST_ORDER, time.span, "the test is too long"));
        }
        Ok(steps as u32)
    }

    /// What a script shows at that step comes before the episode is over.
    fn must_be_seen(&mut self, step: u32, span: Span) -> Checked<()> {
        let horizon = self.in_tests.as_ref().map_or(u32::MAX, |in_tests| in_tests.horizon);
        if step <= horizon {
            return Ok(());
        }
        let interval = self.timing.interval;
        let in_words = |steps: u32| format!("{steps} steps ({} s)", for_people(f64::from(steps) * interval));
        let diagnostic = self
            .diagnostic(codes::tests::TEST_LONG, span, "this is after the end of the episode")
            .expected(format!("at most {}, the task's horizon", in_words(horizon)))
            .found(in_words(step))
            .help("use an earlier time, or a longer `horizon` of the task");
        Err(self.report(diagnostic))
    }

    /// `given target = [0.5 m, 0, 1 m]`
    fn given(&mut self, name: &'a Ident, value: &'a Expr) -> Checked<(usize, Vec<f64>)> {
        let Some(index) = self.randoms.iter().position(|random| random.name == name.text) else {
            let message = format!("undefined random or parameter per episode `{}`", name.text);
            let mut diagnostic = self.diagnostic(codes::tests::NOT_GIVEN, name.span, message);
            let names: Vec<String> = self.randoms.iter().map(|random| random.name.clone()).collect();
            for near in crate::diagnostics::nearest(&name.text, names.iter().map(String::as_str)) {
                diagnostic = diagnostic.suggest(format!("did you mean `{near}`?"), name.span, near);
            }
            return Err(self.report(diagnostic));
        };
        let wanted = self.randoms[index].data.clone();
        let data = self.data(value)?;
        let width = self.graph.width(wanted.node);
        let same = data.kind.dimension() == wanted.kind.dimension() && self.graph.width(data.node) == width;
        match self.graph.constant_lanes(data.node) {
            Some(lanes) if same || data.is_zero() && lanes.len() == width => {
                let Some([low, high]) = self.randoms[index].parameter else { return Ok((index, lanes)) };
                if lanes.iter().all(|value| (low..=high).contains(value)) {
                    return Ok((index, lanes));
                }
                let (range, found) = spoken::written(wanted.kind.dimension().unwrap_or(Dimension::NONE), [value])
                    .tell_beside([low, high], lanes.first().copied().unwrap_or_default());
                let message = format!("the parameter `{}` is out of range", name.text);
                let diagnostic = self.diagnostic(codes::tests::NOT_GIVEN, value.span, message).expected(range).found(found);
                Err(self.report(diagnostic))
            }
            lanes => {
                let what = if lanes.is_none() { "a constant" } else { "a value of its type" };
                let (expected, found) = (wanted.kind.described(self.vocabulary), data.kind.described(self.vocabulary));
                let diagnostic = self
                    .diagnostic(codes::tests::NOT_GIVEN, value.span, format!("`{}` takes {what}", name.text))
                    .expected(expected)
                    .found(found);
                Err(self.report(diagnostic))
            }
        }
    }

    /// Names that only tests have: `success`, `reward`, `return`.
    pub(crate) fn test_name(&mut self, name: &str) -> Option<TypedValue> {
        let in_tests = self.in_tests.as_ref()?;
        match name {
            "success" => Some(TypedValue::new(in_tests.success, ElementType::Bool)),
            "reward" | "return" => {
                let contributions: Vec<NodeId> = in_tests.contributions.iter().map(|(_, node)| *node).collect();
                let sum = if contributions.is_empty() {
                    self.graph.constant(0.0)
                } else {
                    let joined = self.graph.join(&contributions);
                    self.graph.reduce(crate::graph::operation::Reduction::Sum, contributions.len(), joined)
                };
                Some(TypedValue::new(self.reward_or_return(name, sum), ElementType::PLAIN))
            }
            _ => None,
        }
    }

    /// `reward.pose`: the contribution of a term in a step; `return.pose`: the sum of its contributions so far. `walk.present`:
    /// whether that phase of a sequence is the current one.
    pub(crate) fn test_field(&mut self, base: &Expr, name: &crate::syntax::tree::Name) -> Option<Checked<TypedValue>> {
        let in_tests = self.in_tests.as_ref()?;
        let crate::syntax::tree::ExprKind::Name(word) = &base.kind else { return None };
        if let ("present", Some(phase)) = (name.text.as_str(), in_tests.phases.iter().position(|known| *known == word.text)) {
            let present = if phase == in_tests.phase { 1.0 } else { 0.0 };
            return Some(Ok(TypedValue::new(self.graph.constant(present), ElementType::Bool)));
        }
        if word.text == "observation" {
            let channel = in_tests.channels.iter().find(|(known, _)| *known == name.text).map(|(_, data)| data.clone());
            return Some(channel.ok_or_else(|| self.unknown_channel(name)));
        }
        if !["reward", "return"].contains(&word.text.as_str()) {
            return None;
        }
        let found = in_tests.contributions.iter().find(|(known, _)| *known == name.text).map(|(_, node)| *node);
        Some(match found {
            Some(node) => Ok(TypedValue::new(self.reward_or_return(&word.text, node), ElementType::PLAIN)),
            None => {
                let names = in_tests.contributions.iter().map(|(name, _)| name.clone()).collect();
                Err(self.unknown_name(&name.text, name.span, names))
            }
        })
    }

    fn reward_or_return(&mut self, word: &str, reward: NodeId) -> NodeId {
        if word == "return" { self.graph.memory(Memory::Accumulate, &[reward]) } else { reward }
    }
}

impl Draft {
    fn starting_from(begins: Scene) -> Self {
        Self {
            name: None,
            begins,
            placed: false,
            given: Vec::new(),
            keys: Vec::new(),
            labels: Vec::new(),
            until: None,
            run: None,
            resets: None,
            velocity: None,
        }
    }

    /// What is shown last.
    fn latest(&self) -> &Scene {
        self.keys.last().map_or(&self.begins, |key| &key.scene)
    }

    /// Whether more may be shown.
    fn is_open(&self) -> bool {
        self.until.is_none() && self.run.is_none() && self.resets.is_none()
    }

    fn finish(self) -> Take {
        let last = self.keys.last().map_or(0, |key| key.step);
        let frame = |Key { step, scene, plays }: Key| Keyframe { step, init: scene.init, activation: scene.activation, plays };
        let runs = self.run.is_some();
        // Physics without a script begins as the task does, noise included, unless the test sets the initial state.
        let script: Vec<Keyframe> = match (self.keys.is_empty(), self.resets.is_some() || runs && !self.placed) {
            (true, true) => Vec::new(),
            (true, false) => vec![frame(Key::still(0, self.begins))],
            (false, _) => self.keys.into_iter().map(frame).collect(),
        };
        let until = match (&self.run, self.name.is_some()) {
            _ if self.resets.is_some() => None,
            (Some((_, Some(steps))), _) => Some(last + steps),
            (Some(_), _) => None,
            // A moment is over with its script.
            (None, true) => self.until.or(Some(last.max(1))),
            (None, false) => self.until,
        };
        let run = self.run.map(|(policy, _)| Run { policy, from: last });
        Take { moment: self.name, given: self.given, script, until, run, resets: self.resets }
    }
}
