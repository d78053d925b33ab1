//! `--sweep`: evaluations along axes of perturbations.

use super::Evaluation;
use crate::error::{Context, Error};
use msk::evaluate::sweep::{Axis, EPISODES, NORMALIZING, Sweep, markdown, normalization, perturbed};
use msk::evaluate::{Plan, Protocol, Summary};
use msk::runtime::perturbation::Normalization;
use msk_storage::Folder;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// What grows in a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Along {
    /// Noise on every entry of the action
    Action,
    /// Noise on every entry of the normalised observation
    Observation,
    /// Factors of muscle forces, drawn per episode
    Gain,
    /// Pushes against the root
    Push,
    /// Friction of the ground, drawn per episode
    Friction,
    /// Masses of segments, drawn per episode
    Mass,
    /// Actions that take effect late
    Latency,
    /// action, observation and gain: those of the paper
    All,
}

impl Along {
    fn axes(self) -> Vec<Axis> {
        match self {
            Self::Action => vec![Axis::Action],
            Self::Observation => vec![Axis::Observation],
            Self::Gain => vec![Axis::Gain],
            Self::Push => vec![Axis::Push],
            Self::Friction => vec![Axis::Friction],
            Self::Mass => vec![Axis::Mass],
            Self::Latency => vec![Axis::Latency],
            Self::All => Axis::PAPER.to_vec(),
        }
    }
}

/// Largest file of a normalisation that is read, bytes.
const LARGEST: u64 = 64 << 20;
/// The folder of the episodes at scale 0.
const UNPERTURBED: &str = "unperturbed";

impl Evaluation<'_> {
    /// Evaluates the policy at every scale of the axes, each in a folder of its own, and sums up.
    ///
    /// # Errors
    /// Those of an evaluation.
    pub fn sweep(&self, plan: &Plan, folder: &Path) -> Result<ExitCode, Error> {
        let mut axes: Vec<Axis> = self.args.sweep.iter().flat_map(|along| along.axes()).collect();
        axes.sort();
        axes.dedup();
        let protocol = Protocol { episodes: self.args.episodes.unwrap_or(EPISODES), ..plan.protocol };
        let plan = Plan { protocol, ..plan.clone() };
        writeln!(io::stderr(), "\nunperturbed, {} episodes of each task", protocol.episodes)?;
        let (unperturbed, interrupted) = self.one(&plan, &folder.join(UNPERTURBED))?;
        let all = plan.episodes() * (1 + 4 * axes.len() as u64);
        if interrupted {
            return Ok(self.leave(&[unperturbed], all, folder));
        }
        let normalizations = match axes.contains(&Axis::Observation) {
            true => self.normalizations(&plan, &unperturbed, &folder.join(UNPERTURBED))?,
            false => Some(Vec::new()),
        };
        let Some(normalizations) = normalizations else { return Ok(self.leave(&[unperturbed], all, folder)) };
        let mut points: Vec<(Axis, Vec<(f64, Summary)>)> = Vec::new();
        for axis in axes {
            let mut scales = vec![(0.0, unperturbed.clone())];
            for scale in axis.grid().into_iter().filter(|scale| *scale > 0.0) {
                writeln!(io::stderr(), "\n{} {scale}", axis.name())?;
                let trials = perturbed(&plan.trials, axis, scale, &normalizations);
                let point = Plan { trials, ..plan.clone() };
                let (summary, interrupted) = self.one(&point, &folder.join(format!("{}-{scale}", axis.name())))?;
                scales.push((scale, summary));
                if interrupted {
                    let done = points.iter().flat_map(|(_, scales)| scales).chain(&scales);
                    let done: Vec<Summary> = done.map(|(_, summary)| summary.clone()).collect();
                    return Ok(self.leave(&done, all, folder));
                }
            }
            points.push((axis, scales));
        }
        let Some(sweep) = Sweep::of(&points) else { return Ok(ExitCode::SUCCESS) };
        let (report, kept) = (
            markdown(&sweep),
            Folder::create(folder).and_then(|kept| {
                kept.replace(Path::new("sweep.json"), sweep.json().as_bytes())?;
                kept.replace(Path::new("sweep.md"), markdown(&sweep).as_bytes())
            }),
        );
        kept.context(|| format!("cannot keep results in `{}`", folder.display()))?;
        super::print(&report, folder, "sweep.json, sweep.md, and a folder for each scale")?;
        super::acted(&[unperturbed])
    }

    /// The normalisation of every task's observations, as it is kept beside the unperturbed episodes, or made anew. `None` after an
    /// interruption.
    fn normalizations(&self, plan: &Plan, summary: &Summary, folder: &Path) -> Result<Option<Vec<Arc<Normalization>>>, Error> {
        let cannot = || format!("cannot keep results in `{}`", folder.display());
        let kept = Folder::create(folder).context(cannot)?;
        let mut all = Vec::new();
        for (trial, task) in plan.trials.iter().zip(&summary.tasks) {
            let name = format!("normalization-{}.json", trial.task.name);
            let found = kept.read_text(Path::new(&name), LARGEST).context(cannot)?;
            let known: Option<Normalization> = found.and_then(|text| serde_json::from_str(&text).ok());
            let made = match known {
                _ if task.skipped.is_some() => Normalization::default(),
                Some(known) => known,
                None => {
                    writeln!(io::stderr(), "{}: deviations of observations over {NORMALIZING} episodes", trial.task.name)?;
                    let counted = (plan.protocol.seed, plan.protocol.episodes);
                    let made = normalization(trial, &plan.policy, counted, self.interrupt.stop())?;
                    let Some(made) = made else { return Ok(None) };
                    kept.replace(Path::new(&name), serde_json::to_string(&made)?.as_bytes()).context(cannot)?;
                    made
                }
            };
            all.push(Arc::new(made));
        }
        Ok(Some(all))
    }
}
