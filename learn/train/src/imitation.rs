//! Imitation of a teacher: behaviour cloning of recorded episodes (Pomerleau 1989), and DAgger (Ross, Gordon and Bagnell, AISTATS 2011,
//! arXiv 1011.0686), which plays with what was learned so far, has the teacher tell what to do in the states that this leads to, and learns from all of it.

use crate::agent::{Actor, Output};
use crate::error::TrainError;
use crate::learner::{Losses, Means, Networks, Optimizer};
use crate::numbers::Numbers;
use crate::play::Play;
use crate::settings::{CloneSettings, Settings};
use crate::teaching::{Lesson, Lessons, School};
use msk_network::{Kernel, Mlp};
use msk_runtime::episode::{Engine, EpisodeKey, Stream};
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Control steps for which a round without a teacher counts.
const ROUND: u64 = 1024;

/// The learner.
pub(crate) struct Imitation {
    settings: CloneSettings,
    networks: Networks,
    policy: Mlp,
    optimizer: Optimizer,
    chance: Stream,
    memory: Memory,
    school: Option<School>,
    /// Episodes that were played, rounds, and gradient steps that are due.
    episodes: u64,
    rounds: u64,
    due: f64,
    means: Means,
}

/// What of it a checkpoint keeps. Data sets are read anew.
#[derive(Serialize, Deserialize)]
pub(crate) struct ImitationState {
    parameters: Numbers,
    optimizer: Optimizer,
    chance: Stream,
    played: Numbers,
    next: usize,
    episodes: u64,
    rounds: u64,
    due: f64,
}

/// Rows with labels: those of data sets for good, and the latest that were played, as many as fit.
struct Memory {
    /// Numbers of a row, and of a row with its label.
    widths: [usize; 2],
    recorded: Vec<f32>,
    played: Vec<f32>,
    capacity: usize,
    next: usize,
}

impl Memory {
    fn rows(&self) -> usize {
        (self.recorded.len() + self.played.len()) / self.widths[1]
    }

    fn row(&self, index: usize) -> (&[f32], &[f32]) {
        let [width, length] = self.widths;
        let recorded = self.recorded.len() / length;
        let (numbers, place) = if index < recorded { (&self.recorded, index) } else { (&self.played, index - recorded) };
        numbers[place * length..(place + 1) * length].split_at(width)
    }

    fn push(&mut self, row: &[f32], label: &[f32]) {
        let length = self.widths[1];
        if self.played.len() < self.capacity * length {
            self.played.extend(row.iter().chain(label));
            return;
        }
        let begin = self.next * length;
        self.played[begin..].iter_mut().zip(row.iter().chain(label)).for_each(|(old, new)| *old = *new);
        self.next = (self.next + 1) % self.capacity;
    }
}

impl Imitation {
    /// # Errors
    /// Nothing to imitate, data of another shape, or a teacher that cannot be opened.
    pub fn new(
        engine: &Engine,
        settings: &Settings,
        lessons: &Lessons,
        play: &mut Play,
        seed: u64,
        (kernel, threads): (Arc<dyn Kernel>, NonZeroUsize),
    ) -> Result<Self, TrainError> {
        let ([_, width], entries) = (play.widths(), play.entries());
        if lessons.data.is_empty() && lessons.teacher.is_none() {
            return Err(TrainError::NoTeacher);
        }
        let own = &settings.clone;
        let mut memory =
            Memory { widths: [width, width + entries], recorded: Vec::new(), played: Vec::new(), capacity: own.memory, next: 0 };
        for set in &lessons.data {
            let (labels, size) = (set.labels(engine)?, set.acts_on.size(engine.task(), engine.body()));
            for episode in &set.episodes {
                // The last row is what came of the last action.
                for (row, action) in set.steps(episode, [width, size])? {
                    memory.recorded.extend_from_slice(row);
                    labels.write(set.acts_on, action, &mut memory.recorded);
                    play.saw_first(row);
                }
            }
        }
        let school = lessons.teacher.as_ref().map(|teacher| School::new(engine, teacher, (seed, settings.episodes), threads));
        let mut networks = Networks::new(kernel);
        let mut draw = Stream::new(EpisodeKey { seed, episode: 0 }, "train/initial");
        let policy = networks.orthogonal("policy", &settings.shape(width, entries), 0.01, &mut draw);
        let optimizer = Optimizer::new(policy.range(), f32::INFINITY, 1e-8);
        Ok(Self {
            networks,
            policy,
            optimizer,
            chance: Stream::new(EpisodeKey { seed, episode: 0 }, "train/chance"),
            memory,
            school: school.transpose()?,
            episodes: 0,
            rounds: 0,
            due: 0.0,
            means: Means::default(),
            settings: own.clone(),
        })
    }

    /// Begins as an agent.
    pub fn begin_as(&mut self, actor: &Actor) {
        actor.copy_to(&self.policy, &mut self.networks.parameters);
    }

    /// Plays an episode in every slot, if there is a teacher, and learns from all that was ever recorded or played. Gives the control
    /// steps, too.
    pub fn round(&mut self, play: &mut Play, progress: f64, step: u64) -> Result<(Losses, u64), TrainError> {
        let mut steps = ROUND;
        if self.school.is_some() {
            let lessons = self.play(play, progress)?;
            steps = lessons.iter().map(|lesson| (lesson.rows.len() / self.memory.widths[0]) as u64).sum();
            for lesson in lessons {
                let [width, length] = self.memory.widths;
                let rows = lesson.rows.chunks_exact(width).zip(lesson.labels.chunks_exact(length - width));
                rows.for_each(|(row, label)| self.memory.push(row, label));
                play.ends.extend(lesson.end);
            }
        }
        self.rounds += 1;
        self.due += self.settings.updates * steps as f64;
        while self.due >= 1.0 {
            self.due -= 1.0;
            let share = if self.settings.anneal { 1.0 - progress } else { 1.0 };
            self.update(play, self.settings.learning_rate * share, step)?;
        }
        Ok((self.means.take(), steps.max(1)))
    }

    /// Algorithm 3.1: the policy of iteration i plays with beta_i of the teacher, beta_i = p^(i-1); without data the first plays are the
    /// teacher's.
    fn play(&mut self, play: &mut Play, progress: f64) -> Result<Vec<Lesson>, TrainError> {
        let guided = match (self.rounds, self.memory.recorded.is_empty()) {
            (0, true) => 1.0,
            (rounds, _) => libm::pow(self.settings.guided, rounds as f64),
        };
        let actor = self.actor(play);
        let Some(school) = &mut self.school else { return Ok(Vec::new()) };
        let lessons = school.play(self.episodes, &actor, guided, progress)?;
        self.episodes += lessons.len() as u64;
        // How far the learner is from the teacher in states that it has not learned from.
        let (mut sum, mut count) = (0.0, 0_u64);
        let mut found = Vec::new();
        let tape = &mut self.networks.tape;
        for lesson in &lessons {
            let rows: Vec<f64> = lesson.rows.iter().map(|value| f64::from(*value)).collect();
            found.resize(lesson.labels.len(), 0.0);
            actor.act(tape, &rows, &mut found);
            let errors = found.iter().zip(&lesson.labels).map(|(found, label)| found - f64::from(*label));
            sum += errors.map(|error| error * error).sum::<f64>();
            count += lesson.labels.len() as u64;
        }
        for row in lessons.iter().flat_map(|lesson| lesson.rows.chunks_exact(self.memory.widths[0])) {
            play.saw_first(row);
        }
        self.means.add("disagreement", sum / count.max(1) as f64);
        self.means.add("guided", guided);
        Ok(lessons)
    }

    /// A gradient step: the mean squared distance of the entries of an action.
    fn update(&mut self, play: &Play, rate: f64, step: u64) -> Result<(), TrainError> {
        let ([_, width], entries, rows) = (play.widths(), play.entries(), self.settings.batch);
        let (mut seen, mut labels) = (Vec::with_capacity(rows * width), Vec::with_capacity(rows * entries));
        let count = self.memory.rows();
        if count == 0 {
            return Ok(());
        }
        for _ in 0..rows {
            let index = ((self.chance.uniform() * count as f64) as usize).min(count - 1);
            let (row, label) = self.memory.row(index);
            seen.extend(row.iter().map(|value| f64::from(*value)));
            labels.extend_from_slice(label);
        }
        let mut normal = vec![0.0; rows * width];
        play.normalize_seen(&seen, &mut normal);
        let tape = &mut self.networks.tape;
        tape.clear();
        let seen = tape.constant(rows, width, normal);
        let wanted = tape.constant(rows, entries, labels);
        let mut found = self.policy.forward(tape, &self.networks.parameters, seen);
        if self.settings.squash {
            found = tape.tanh(found);
        }
        let error = tape.subtract(found, wanted);
        let square = tape.square(error);
        let loss = tape.mean(square);
        let value = self.networks.descend(loss, ("the error of the clone", step), rate, &mut self.optimizer)?;
        self.means.add("error", value);
        Ok(())
    }

    /// What acts.
    pub fn actor(&self, play: &Play) -> Actor {
        let output = if self.settings.squash { Output::Squashed } else { Output::Clipped };
        Actor::new(&self.policy, &self.networks.parameters, play, output)
    }

    pub fn state(&self) -> ImitationState {
        ImitationState {
            parameters: self.networks.state(),
            optimizer: self.optimizer.clone(),
            chance: self.chance.clone(),
            played: Numbers(self.memory.played.clone()),
            next: self.memory.next,
            episodes: self.episodes,
            rounds: self.rounds,
            due: self.due,
        }
    }

    /// # Errors
    /// Other sizes.
    pub fn restore(&mut self, state: ImitationState) -> Result<(), String> {
        self.networks.restore(&state.parameters)?;
        let (played, memory) = (state.played.0, &mut self.memory);
        let fits = played.len().is_multiple_of(memory.widths[1]) && played.len() / memory.widths[1] <= memory.capacity;
        if !fits || state.next >= memory.capacity {
            return Err("its played rows have another size".into());
        }
        (memory.played, memory.next) = (played, state.next);
        (self.optimizer, self.chance) = (state.optimizer, state.chance);
        (self.episodes, self.rounds, self.due) = (state.episodes, state.rounds, state.due);
        Ok(())
    }
}
