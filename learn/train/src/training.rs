//! A training in memory: rounds of playing and learning, whose state can be written and continued bit for bit.

use crate::agent::{Agent, body_hash};
use crate::dynsyn;
use crate::error::TrainError;
use crate::evaluate::{Evaluation, Evaluator};
use crate::head::Head;
use crate::imitation::{Imitation, ImitationState};
use crate::learner::Losses;
use crate::mpo::{Mpo, MpoState};
use crate::play::{Play, PlayState};
use crate::ppo::{Ppo, PpoState};
use crate::recorded;
use crate::replay::transition_bytes;
use crate::sac::{Sac, SacState};
use crate::settings::{Algorithm, Settings};
use crate::teaching::Lessons;
use msk_network::{Kernel, Processor, Shape, Tape};
use msk_runtime::episode::{Engine, EpisodeEnd};
use msk_settings::SettingsError;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What decides every number of a training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
    /// Name of the task.
    pub task: String,
    /// Its content hash.
    pub task_hash: String,
    /// Of names and masses of the body's parts.
    pub body_hash: String,
    /// Random seed.
    pub seed: u64,
    /// Control steps of the whole training.
    pub steps: u64,
    /// What it learns from beside the reward.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lessons: Vec<String>,
    /// Where it runs, as far as names and masses do not say it.
    #[serde(default)]
    pub provenance: Provenance,
    /// How it learns.
    pub settings: Settings,
}

/// What else decides the numbers of a training: its caller knows it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Provenance {
    /// Hash of the body's model, with its scene.
    pub model_hash: String,
    /// Condition of the muscles.
    pub condition: String,
    /// Hash of the sources of the program.
    pub build: String,
}

/// Bytes of the digest before a checkpoint.
const DIGEST: usize = 32;

fn digest(before: &[u8], body: &[u8]) -> [u8; DIGEST] {
    Sha256::new().chain_update(before).chain_update(body).finalize().into()
}

enum Learner {
    Ppo(Box<Ppo>),
    Sac(Box<Sac>),
    Mpo(Box<Mpo>),
    Imitation(Box<Imitation>),
}

#[derive(Serialize, Deserialize)]
enum LearnerState<'a> {
    Ppo(PpoState),
    Sac(Box<SacState<'a>>),
    Mpo(Box<MpoState<'a>>),
    Imitation(Box<ImitationState>),
}

/// The state of a training, as a checkpoint has it.
#[derive(Serialize, Deserialize)]
struct State<'a> {
    step: u64,
    play: PlayState,
    learner: LearnerState<'a>,
}

/// What a round came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Round {
    /// Control steps so far.
    pub step: u64,
    /// Parts of the loss, by name.
    pub losses: Losses,
    /// Episodes that ended.
    pub ends: Vec<EpisodeEnd>,
}

/// How much a training remembers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReplaySize {
    /// Most transitions that are kept.
    pub kept: usize,
    /// Those that the settings ask for.
    pub wanted: usize,
    /// Bytes of a transition.
    pub bytes: usize,
}

/// Settings with the networks of an agent, which the training begins as.
fn starting_as(agent: &Agent, engine: &Engine, settings: &Settings) -> Result<Settings, TrainError> {
    let algorithm = settings.algorithm;
    let refuse = |reason: String| TrainError::Start { algorithm: algorithm.name(), reason };
    if let Some(reason) = agent.unlike(engine.task(), engine.action_size()) {
        return Err(refuse(reason));
    }
    match (agent.output().synergies().is_some(), algorithm == Algorithm::Dynsyn) {
        (true, false) => return Err(refuse("it acts through groups of entries, as only `dynsyn` does".into())),
        (false, true) => return Err(refuse("it does not act through groups of entries; train it with `dynsyn`".into())),
        _ => {}
    }
    let squashes = match algorithm {
        Algorithm::Ppo => false,
        Algorithm::Sac | Algorithm::Simba | Algorithm::Dynsyn | Algorithm::Mpo => true,
        Algorithm::Clone => settings.clone.squash,
    };
    if squashes != agent.output().squashes() {
        let (has, needs) = if squashes { ("does not squash", "squash = true") } else { ("squashes", "squash = false") };
        return Err(refuse(format!("it {has} its actions; clone with `{needs}` in `[clone]`")));
    }
    let Shape { hidden, activation, layer_norm, residual, .. } = agent.shape().clone();
    let settings = Settings { hidden, activation, layer_norm, residual, ..settings.clone() };
    // Critics that were plain may not do as residual ones.
    settings.check("")?;
    Ok(settings)
}

/// How the actor of an algorithm built on SAC acts: through the groups of the agent that it starts as, or through those that are found.
fn head(engine: &Engine, settings: &Settings, lessons: &Lessons, seed: u64) -> Result<Head, TrainError> {
    if settings.algorithm != Algorithm::Dynsyn {
        return Ok(Head::Entries(engine.action_size()));
    }
    let known = lessons.start.as_ref().and_then(|agent| agent.output().synergies().cloned());
    let synergies = match known {
        Some(synergies) => synergies,
        None => dynsyn::find(engine, &settings.dynsyn, seed).map_err(|reason| TrainError::Groups { reason })?,
    };
    Ok(Head::Synergies { synergies: synergies.at(&settings.dynsyn, 0.0), settings: settings.dynsyn.clone() })
}

/// How much a learner remembers.
fn replay_size(learner: &Learner, settings: &Settings, play: &Play) -> Option<ReplaySize> {
    let (replay, wanted) = match learner {
        Learner::Sac(sac) => (sac.replay(), settings.sac.replay),
        Learner::Mpo(mpo) => (mpo.replay(), settings.mpo.replay),
        Learner::Ppo(_) | Learner::Imitation(_) => return None,
    };
    let bytes = transition_bytes([play.widths()[0], play.entries(), play.terms()], settings.replay_precision);
    Some(ReplaySize { kept: replay.capacity(), wanted, bytes })
}

/// A training.
pub struct Training {
    engine: Engine,
    identity: Identity,
    play: Play,
    learner: Learner,
    evaluator: Evaluator,
    tape: Tape,
    step: u64,
}

impl Training {
    /// Begins one that learns from the reward of its task alone. Threads change no bit of it.
    ///
    /// # Errors
    /// A task without observation or action, or no threads.
    pub fn new(engine: &Engine, settings: &Settings, key: (u64, u64), threads: NonZeroUsize) -> Result<Self, TrainError> {
        Self::with(engine, settings, &Lessons::default(), key, threads)
    }

    /// Begins one with a seed and a number of control steps. One that starts as an agent has networks of its sizes.
    ///
    /// # Errors
    /// A task without observation or action, lessons that do not fit it or the algorithm, or no threads.
    pub fn with(
        engine: &Engine,
        settings: &Settings,
        lessons: &Lessons,
        (seed, steps): (u64, u64),
        threads: NonZeroUsize,
    ) -> Result<Self, TrainError> {
        let task = engine.task();
        let lacks = [(task.observation_size(), "no observation"), (engine.action_size(), "no entries of an action")];
        if let Some((_, what)) = lacks.into_iter().find(|(size, _)| *size == 0) {
            return Err(TrainError::Nothing { task: task.name.clone(), what });
        }
        let settings = match &lessons.start {
            Some(agent) => starting_as(agent, engine, settings)?,
            None => settings.clone(),
        };
        let algorithm = settings.algorithm;
        match algorithm {
            Algorithm::Clone => {}
            _ if lessons.teacher.is_some() => return Err(TrainError::NoTeaching(algorithm.name())),
            Algorithm::Ppo | Algorithm::Mpo if !lessons.data.is_empty() => return Err(TrainError::NoData(algorithm.name())),
            Algorithm::Ppo | Algorithm::Mpo | Algorithm::Sac | Algorithm::Simba | Algorithm::Dynsyn => {}
        }
        let kernel: Arc<dyn Kernel> = Arc::new(Processor::new(threads)?);
        let mut play = Play::new(engine, &settings, seed, threads)?;
        let mut learner = match algorithm {
            Algorithm::Ppo => Learner::Ppo(Box::new(Ppo::new(&settings, &play, seed, kernel.clone()))),
            Algorithm::Sac | Algorithm::Simba | Algorithm::Dynsyn => {
                let head = head(engine, &settings, lessons, seed)?;
                let mut sac = Sac::new(&settings, &play, head, seed, kernel.clone());
                sac.remember_recorded(recorded::transitions(&lessons.data, engine, &mut play, &settings)?);
                Learner::Sac(Box::new(sac))
            }
            Algorithm::Mpo => Learner::Mpo(Box::new(Mpo::new(engine, &settings, &play, seed, kernel.clone())?)),
            Algorithm::Clone => {
                let tools = (kernel.clone(), threads);
                Learner::Imitation(Box::new(Imitation::new(engine, &settings, lessons, &mut play, seed, tools)?))
            }
        };
        if let Some(agent) = &lessons.start {
            play.begin_as(agent.actor(), agent.description.steps.max(1) as f64);
            match &mut learner {
                Learner::Ppo(ppo) => ppo.begin_as(agent.actor(), settings.critics_first),
                Learner::Sac(sac) => sac.begin_as(agent.actor(), settings.critics_first),
                Learner::Mpo(mpo) => mpo.begin_as(agent.actor(), settings.critics_first),
                Learner::Imitation(imitation) => imitation.begin_as(agent.actor()),
            }
        }
        let remembers = replay_size(&learner, &settings, &play);
        if let Some(size) = remembers.filter(|size| size.kept == 0) {
            let expected = format!("at least {} for a transition of `{}`", size.bytes as f64 / f64::from(1_u32 << 30), task.name);
            let found = settings.replay_memory.to_string();
            return Err(SettingsError::Range { line: 0, key: "replay_memory", found, expected }.into());
        }
        let identity = Identity {
            task: task.name.clone(),
            task_hash: task.hash.clone(),
            body_hash: body_hash(engine),
            provenance: Provenance::default(),
            seed,
            steps,
            lessons: lessons.names(),
            settings: settings.clone(),
        };
        let evaluator = Evaluator::new(engine, seed, settings.evaluation_episodes, threads)?;
        Ok(Self { engine: engine.clone(), identity, play, learner, evaluator, tape: Tape::new(kernel), step: 0 })
    }

    /// The same with what its caller knows of where it runs: a training that is resumed elsewhere is refused.
    #[must_use]
    pub fn with_provenance(mut self, provenance: Provenance) -> Self {
        self.identity.provenance = provenance;
        self
    }

    /// What decides every number of it.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// How much it remembers, if it learns from what it remembers.
    pub fn replay(&self) -> Option<ReplaySize> {
        replay_size(&self.learner, &self.identity.settings, &self.play)
    }

    /// The task and its body.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// Control steps so far, in all episodes together.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Whether all steps have been taken.
    pub fn is_over(&self) -> bool {
        self.step >= self.identity.steps
    }

    /// The setting or weight that changes with the share of the steps that has passed, if there is one: with more steps, all that was learned would
    /// be otherwise.
    pub(crate) fn depends_on_steps(&self) -> Option<&'static str> {
        let settings = &self.identity.settings;
        let of_algorithm = match settings.algorithm {
            Algorithm::Ppo => settings.ppo.anneal.then_some("`anneal` of `[ppo]`"),
            Algorithm::Sac | Algorithm::Simba => (settings.sac.anneal < 1.0).then_some("`anneal` of `[sac]`"),
            Algorithm::Dynsyn => Some("`release` of `[dynsyn]`"),
            Algorithm::Clone => settings.clone.anneal.then_some("`anneal` of `[clone]`"),
            Algorithm::Mpo => None,
        };
        let scheduled = self.engine.task().terms.iter().any(|term| term.schedule.is_some());
        of_algorithm.or(scheduled.then_some("a weight that changes over the training"))
    }

    /// Plays for a while and learns from it.
    ///
    /// # Errors
    /// Numbers that are not finite, with step, part of the loss and layer.
    pub fn round(&mut self) -> Result<Round, TrainError> {
        // The last round may go beyond the steps.
        let share = self.step as f64 / self.identity.steps as f64;
        let progress = if share < 1.0 { share } else { 1.0 };
        self.play.set_progress(progress)?;
        let (losses, steps) = match &mut self.learner {
            Learner::Ppo(ppo) => (ppo.round(&mut self.play, progress, self.step)?, ppo.round_steps(&self.play)),
            Learner::Sac(sac) => (sac.round(&mut self.play, progress, self.step)?, sac.round_steps(&self.play)),
            Learner::Mpo(mpo) => {
                let losses = mpo.round(&mut self.play, &self.identity.settings, self.step)?;
                (losses, mpo.round_steps(&self.play))
            }
            Learner::Imitation(imitation) => imitation.round(&mut self.play, progress, self.step)?,
        };
        self.step += steps;
        Ok(Round { step: self.step, losses, ends: std::mem::take(&mut self.play.ends) })
    }

    /// Rewards by these last weights, one for each term, from the next step on. Evaluations go on with those of the task.
    pub fn set_weights(&mut self, weights: &[f64]) {
        self.play.set_weights(weights);
    }

    /// The agent as it is now.
    pub fn agent(&self) -> Agent {
        let actor = match &self.learner {
            Learner::Ppo(ppo) => ppo.actor(&self.play),
            Learner::Sac(sac) => sac.actor(&self.play),
            Learner::Mpo(mpo) => mpo.actor(&self.play),
            Learner::Imitation(imitation) => imitation.actor(&self.play),
        };
        Agent::new(&self.engine, actor, &self.identity, self.step)
    }

    /// Plays the episodes of an evaluation; `None` if `stop` became true meanwhile.
    ///
    /// # Errors
    /// None that can be known.
    pub fn evaluate(&mut self, agent: &Agent, stop: &AtomicBool) -> Result<Option<Evaluation>, TrainError> {
        self.evaluator.play(agent, &mut self.tape, stop)
    }

    /// Whether it can be continued from any round. Where it cannot (a controller stands between policy and body), episodes begin anew
    /// at each [checkpoint](Self::checkpoint), so there may be no more of them than those that an undisturbed training has.
    pub fn continues_anywhere(&self) -> bool {
        self.play.continues()
    }

    /// Appends the state between two rounds, behind a digest of all bytes that it is appended to and its own. A replay buffer is copied here
    /// alone.
    pub fn checkpoint(&mut self, bytes: &mut Vec<u8>) {
        if self.play.at_checkpoint()
            && let Learner::Mpo(mpo) = &mut self.learner
        {
            mpo.forget_pending();
        }
        let learner = match &self.learner {
            Learner::Ppo(ppo) => LearnerState::Ppo(ppo.state()),
            Learner::Sac(sac) => LearnerState::Sac(Box::new(sac.state())),
            Learner::Mpo(mpo) => LearnerState::Mpo(Box::new(mpo.state())),
            Learner::Imitation(imitation) => LearnerState::Imitation(Box::new(imitation.state())),
        };
        let state = State { step: self.step, play: self.play.state(), learner };
        let begin = bytes.len();
        bytes.extend([0; DIGEST]);
        // Plain data always has a MessagePack form, and memory takes all bytes.
        let _ = rmp_serde::encode::write(bytes, &state);
        let digest = digest(&bytes[..begin], &bytes[begin + DIGEST..]);
        bytes[begin..begin + DIGEST].copy_from_slice(&digest);
    }

    /// Goes on from a checkpoint of a training of the same identity, bit for bit; it was appended to the bytes `before`.
    ///
    /// # Errors
    /// Damaged bytes, or those of another training, in words that follow a colon.
    pub fn restore(&mut self, before: &[u8], bytes: &[u8]) -> Result<(), String> {
        let (recorded, body) = bytes.split_at_checked(DIGEST).ok_or("it is too short")?;
        if digest(before, body) != recorded {
            return Err("it is damaged".into());
        }
        let state: State<'_> = rmp_serde::from_slice(body).map_err(|error| format!("it was made by another version: {error}"))?;
        self.play.restore(state.play)?;
        match (&mut self.learner, state.learner) {
            (Learner::Ppo(ppo), LearnerState::Ppo(state)) => ppo.restore(state)?,
            (Learner::Sac(sac), LearnerState::Sac(state)) => sac.restore(*state)?,
            (Learner::Mpo(mpo), LearnerState::Mpo(state)) => mpo.restore(*state)?,
            (Learner::Imitation(imitation), LearnerState::Imitation(state)) => imitation.restore(*state)?,
            _ => return Err("it is of another algorithm".into()),
        }
        self.step = state.step;
        Ok(())
    }
}
