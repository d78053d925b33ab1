//! Where actions to be imitated come from: a teacher says what to do in states that the learner has come to.

use crate::agent::{Actor, Agent};
use crate::error::TrainError;
use crate::recorded::DataSet;
use msk_network::{Processor, Tape};
use msk_program::action::ActionTarget;
use msk_runtime::action::{ActionBuffer, ControlMemory};
use msk_runtime::episode::{Engine, Environment, EpisodeEnd, EpisodeError, EpisodeKey, Stream, single_precision};
use msk_runtime::policy::{ActsOn, Policy, PolicyError, PolicySource};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A teacher is asked to the end of a round: what was asked for is learned from or played anew.
static NEVER: AtomicBool = AtomicBool::new(false);

/// What an agent learns from beside the reward of its task.
#[derive(Debug, Clone, Default)]
pub struct Lessons {
    /// Episodes to imitate, or to learn from beside its own.
    pub data: Vec<DataSet>,
    /// Who knows what to do.
    pub teacher: Option<PolicySource>,
    /// The agent that it begins as.
    pub start: Option<Arc<Agent>>,
}

impl Lessons {
    /// What tells them from others, one by one.
    pub fn names(&self) -> Vec<String> {
        let data = self.data.iter().map(|set| format!("data {}", set.name));
        let teacher = self.teacher.iter().map(|teacher| format!("teacher {}", teacher.name()));
        let start = self.start.iter().map(|start| format!("start {}", start.digest()));
        data.chain(teacher).chain(start).collect()
    }
}

/// Actions of a teacher as entries of the task's action space.
pub(crate) struct Labels {
    engine: Engine,
}

impl Labels {
    /// # Errors
    /// Actions on muscles where the space of the task has other entries, in words that continue `the teacher`.
    pub fn of(engine: &Engine, acts_on: ActsOn) -> Result<Self, String> {
        let space = &engine.task().action;
        let muscles = matches!(space.target, ActionTarget::AllMuscles | ActionTarget::Muscles(_) | ActionTarget::Synergies(_));
        if acts_on == ActsOn::Muscles && (!muscles || space.residual.is_some()) {
            let what = if space.residual.is_some() { "what is added to a controller" } else { space.word() };
            return Err(format!(
                "acts on muscles, and actions of the task are {what}: choose one that acts in the space of the task"
            ));
        }
        Ok(Self { engine: engine.clone() })
    }

    /// Whether the space asks for activations, so that excitations alone do not say what its entries are.
    pub fn need_activations(&self, acts_on: ActsOn) -> bool {
        acts_on == ActsOn::Muscles && self.engine.task().action.activations
    }

    /// Entries for an action: muscles of a synergy, which share one, ask for their mean. What the space delays or filters is not undone.
    pub fn write(&self, acts_on: ActsOn, action: &[f64], out: &mut Vec<f32>) {
        let space = &self.engine.task().action;
        let entry = |action: f64| single_precision(bounded(bounded(action) / space.scale));
        let of = |muscle: usize| action.get(muscle).copied().unwrap_or_default();
        match (acts_on, &space.target) {
            (ActsOn::Muscles, ActionTarget::Muscles(chosen)) => out.extend(chosen.iter().map(|muscle| entry(of(*muscle)))),
            (ActsOn::Muscles, ActionTarget::Synergies(synergies)) => out.extend(synergies.iter().map(|synergy| {
                let sum: f64 = synergy.muscles.iter().map(|muscle| of(*muscle)).sum();
                entry(sum / synergy.muscles.len().max(1) as f64)
            })),
            (ActsOn::Muscles, _) => out.extend(action.iter().map(|action| entry(*action))),
            (ActsOn::Task, _) => out.extend(action.iter().map(|action| single_precision(bounded(*action)))),
        }
    }
}

/// An entry of an action as episodes take it.
fn bounded(entry: f64) -> f64 {
    let low = if entry < -1.0 { -1.0 } else { entry };
    if low > 1.0 { 1.0 } else { low }
}

/// What an episode of a learner came to.
pub(crate) struct Lesson {
    /// Rows of observations as measured.
    pub rows: Vec<f32>,
    /// What the teacher would have done there, as entries of the action space.
    pub labels: Vec<f32>,
    /// The episode as reports of trainings have it.
    pub end: Option<EpisodeEnd>,
}

/// Episodes side by side, each with a teacher of its own.
pub(crate) struct School {
    source: PolicySource,
    pupils: Vec<Pupil>,
    pool: ThreadPool,
    seed: u64,
}

struct Pupil {
    environment: Environment,
    teacher: Box<dyn Policy>,
    tape: Tape,
    memory: ControlMemory,
}

impl School {
    /// # Errors
    /// A teacher that cannot be opened, or no threads.
    pub fn new(
        engine: &Engine,
        source: &PolicySource,
        (seed, slots): (u64, usize),
        threads: NonZeroUsize,
    ) -> Result<Self, TrainError> {
        let kernel = Arc::new(Processor::new(NonZeroUsize::MIN)?);
        let pupil = || -> Result<Pupil, TrainError> {
            let environment = Environment::of(engine.clone());
            Ok(Pupil {
                environment,
                teacher: source.open(&NEVER)?,
                tape: Tape::new(kernel.clone()),
                memory: ControlMemory::default(),
            })
        };
        let pupils = (0..slots).map(|_| pupil()).collect::<Result<_, _>>()?;
        let pool = ThreadPoolBuilder::new().num_threads(threads.get()).build()?;
        Ok(Self { source: source.clone(), pupils, pool, seed })
    }

    /// Plays an episode in every slot, from `first` on: with `actor`, but in a share `guided` of the steps with the teacher; scheduled
    /// weights are those at `progress`.
    ///
    /// # Errors
    /// A teacher that cannot act on the task.
    pub fn play(&mut self, first: u64, actor: &Actor, guided: f64, progress: f64) -> Result<Vec<Lesson>, TrainError> {
        let (seed, source) = (self.seed, self.source.name());
        let pupils = self.pupils.par_iter_mut().enumerate();
        self.pool.install(|| {
            pupils
                .map(|(slot, pupil)| {
                    pupil.environment.set_progress(progress)?;
                    let key = EpisodeKey { seed, episode: first + slot as u64 };
                    pupil.play(slot, key, actor, guided).map_err(|error| match error {
                        Refusal::Policy(error) => TrainError::Policy(error),
                        Refusal::Space(reason) => TrainError::Teacher { teacher: source.to_owned(), reason },
                        Refusal::Episode(error) => TrainError::Episode(error),
                    })
                })
                .collect()
        })
    }
}

/// Why an episode cannot be played.
enum Refusal {
    Policy(PolicyError),
    Space(String),
    Episode(EpisodeError),
}

impl Pupil {
    fn play(&mut self, slot: usize, key: EpisodeKey, actor: &Actor, guided: f64) -> Result<Lesson, Refusal> {
        let Self { environment, teacher, tape, memory } = self;
        environment.reset(key);
        let mut lesson = Lesson { rows: Vec::new(), labels: Vec::new(), end: None };
        teacher.reset(&environment.context()).map_err(Refusal::Policy)?;
        let labels = Labels::of(environment.engine(), teacher.acts_on()).map_err(Refusal::Space)?;
        let engine = environment.engine().clone();
        let mut taught = ActionBuffer::new(teacher.acts_on(), engine.task(), engine.body());
        let mut own = ActionBuffer::new(ActsOn::Task, engine.task(), engine.body());
        let predicts = labels.need_activations(teacher.acts_on());
        let mut asked = Vec::new();
        let mut chance = Stream::new(key, "train/guided");
        while environment.ending().is_none() {
            teacher.act(&environment.context(), &mut taught.entries).map_err(Refusal::Policy)?;
            lesson.rows.extend(environment.observation().iter().copied().map(single_precision));
            asked.clone_from(&taught.entries);
            if predicts {
                memory.predict(&environment.context(), &mut asked);
            }
            labels.write(teacher.acts_on(), &asked, &mut lesson.labels);
            actor.act(tape, environment.observation(), &mut own.entries);
            let acting = if chance.uniform() < guided { &taught } else { &own };
            environment.step(acting).map_err(Refusal::Episode)?;
        }
        lesson.end = EpisodeEnd::of(slot, environment.episode());
        Ok(lesson)
    }
}
