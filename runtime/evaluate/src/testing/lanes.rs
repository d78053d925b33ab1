//! Tests of several tasks at once: their scripts are shown together, in the lanes of the simulator.
//!
//! Most of a test is its script, every step of which takes a forward pass; those of up to eight series of tests on one model are made at
//! once. Physics under a policy, of which tests have little, stays one by one.

use super::series::{Item, Series, length};
use msk_program::task::TaskTests;
use msk_runtime::episode::{Engine, Environment, PassGroup};
use std::ops::Deref;

/// Series of tests that waits for its turn.
pub(super) struct Line<'a, Tests> {
    series: Series<'a, Tests>,
    episode: Environment,
}

impl<'a, Tests: Deref<Target = TaskTests>> Line<'a, Tests> {
    /// With an environment of its own.
    pub(super) fn new(series: Series<'a, Tests>, engine: Engine) -> Self {
        Self { series, episode: Environment::of(engine) }
    }

    /// What it is played with.
    pub(super) fn engine(&self) -> &Engine {
        self.episode.engine()
    }

    /// Plays it without company.
    pub(super) fn play_alone(mut self) -> Series<'a, Tests> {
        while self.advance() {}
        self.series
    }

    fn advance(&mut self) -> bool {
        self.series.advance(&mut self.episode)
    }
}

/// Gives the next series, which plays on the model of the engine, if there is one.
type Claim<'c, 'a, Tests, Name> = dyn FnMut(Option<&Engine>) -> Option<(Name, Line<'a, Tests>)> + 'c;

/// Plays series of tests, up to `width` at once. `claim` gives the next one, which plays on the model of those that are being played, if
/// there are any; `done` gets each that is over.
pub(super) fn play<'a, Tests: Deref<Target = TaskTests>, Name>(
    width: usize,
    claim: &mut Claim<'_, 'a, Tests, Name>,
    done: &mut dyn FnMut(Name, Series<'a, Tests>),
) {
    let mut lines: Vec<(Name, Line<'a, Tests>)> = Vec::new();
    let mut group: Option<PassGroup> = None;
    loop {
        while lines.len() < width {
            let Some((name, mut line)) = claim(lines.first().map(|(_, line)| line.engine())) else { break };
            if line.advance() { lines.push((name, line)) } else { done(name, line.series) }
        }
        let Some((_, first)) = lines.first() else { return };
        let engine = first.engine();
        let known = group.take().filter(|group| group.serves(engine));
        group.insert(known.unwrap_or_else(|| engine.pass_group())).pass(lines.iter_mut().map(|(_, line)| &mut line.episode));
        let mut lane = 0;
        while let Some((_, line)) = lines.get_mut(lane) {
            if line.advance() {
                lane += 1;
            } else {
                let (name, line) = lines.swap_remove(lane);
                done(name, line.series);
            }
        }
    }
}

/// Something that waits for a worker.
pub(super) struct Waiting<'a> {
    /// Of which task of those that are tested.
    pub(super) group: usize,
    pub(super) tests: &'a TaskTests,
    pub(super) engine: Engine,
    pub(super) item: Item,
}

impl Waiting<'_> {
    /// How long it takes, about, in control steps.
    fn length(&self) -> u32 {
        match self.item {
            Item::Test(place) => length(&self.tests.tests[place]),
            Item::Demonstration => {
                let shown = self.tests.demonstrations().next();
                shown.map_or(0, |(test, _)| length(test))
            }
        }
    }
}

/// All that waits, by model: lanes that are full take less time.
#[derive(Default)]
pub(super) struct Queue<'a> {
    models: Vec<Vec<Waiting<'a>>>,
}

impl<'a> Queue<'a> {
    /// Among those of its model, where the longest is last.
    pub(super) fn add(&mut self, waiting: Waiting<'a>) {
        let same = |model: &&mut Vec<Waiting<'_>>| model.iter().any(|other| other.engine.goes_with(&waiting.engine));
        match self.models.iter_mut().find(same) {
            Some(model) => {
                let place = model.partition_point(|other| other.length() < waiting.length());
                model.insert(place, waiting);
            }
            None => self.models.push(vec![waiting]),
        }
    }

    /// How many wait.
    pub(super) fn len(&self) -> usize {
        self.models.iter().map(Vec::len).sum()
    }

    /// The longest that plays on the model of those that are being played; if there are none, of the model for which most waits, so that
    /// workers seldom share one.
    pub(super) fn claim(&mut self, present: Option<&Engine>) -> Option<Waiting<'a>> {
        let waits = self.models.iter_mut().filter(|model| !model.is_empty());
        let model = match present {
            Some(present) => {
                let mut waits = waits;
                waits.find(|model| model.iter().any(|waiting| waiting.engine.goes_with(present)))
            }
            None => waits.max_by_key(|model| model.iter().map(|waiting| u64::from(waiting.length())).sum::<u64>()),
        };
        model?.pop()
    }
}
