//! `--sweep`: evaluations along axes of perturbations.

use super::Evaluation;
use crate::error::{Context, Error};
use crate::output;
use crate::terminal;
use clap::builder::PossibleValue;
use msk::evaluate::sweep::{Axis, NORMALIZING, Sweep, SweepProtocol, markdown, normalization, perturbed};
use msk::evaluate::{Plan, Protocol, Summary};
use msk::runtime::perturbation::Normalization;
use msk_storage::Folder;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// What grows in a sweep: an axis, or all that the protocol has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Along {
    /// This one.
    Axis(Axis),
    /// Those of the protocol.
    All,
}

impl clap::ValueEnum for Along {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [Along; Axis::ALL.len() + 1] = {
            let mut all = [Along::All; Axis::ALL.len() + 1];
            let mut place = 0;
            while place < Axis::ALL.len() {
                all[place] = Along::Axis(Axis::ALL[place]);
                place += 1;
            }
            all
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Self::Axis(axis) => PossibleValue::new(axis.name()).help(axis.scale()),
            Self::All => PossibleValue::new("all").help("those of the protocol; without any, action, observation and gain"),
        })
    }
}

impl Along {
    fn axes(self, protocol: &SweepProtocol) -> Vec<Axis> {
        match self {
            Self::Axis(axis) => vec![axis],
            Self::All => protocol.axes.iter().map(|(axis, _)| *axis).collect(),
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
    pub fn sweep(&self, plan: &Plan, protocol: &SweepProtocol, folder: &Path) -> Result<ExitCode, Error> {
        let mut axes: Vec<Axis> = self.args.sweep.iter().flat_map(|along| along.axes(protocol)).collect();
        axes.sort();
        axes.dedup();
        let episodes = self.args.episodes.unwrap_or(protocol.episodes.into());
        let plan = Plan { protocol: Protocol { episodes, ..plan.protocol }, ..plan.clone() };
        writeln!(terminal::notes(), "\nunperturbed, {episodes} episodes of each task")?;
        let (unperturbed, interrupted) = self.one(&plan, &output::subfolder(folder, UNPERTURBED)?)?;
        let grown: usize = axes.iter().map(|axis| protocol.scales(*axis).len() - 1).sum();
        let all = plan.episodes() * (1 + grown as u64);
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
            for scale in protocol.scales(axis).into_iter().filter(|scale| *scale > 0.0) {
                writeln!(terminal::notes(), "\n{} {scale}", axis.name())?;
                let trials = perturbed(&plan.trials, axis, scale, &normalizations);
                let point = Plan { trials, ..plan.clone() };
                let (summary, interrupted) =
                    self.one(&point, &output::subfolder(folder, &format!("{}-{scale}", axis.name()))?)?;
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
                    writeln!(terminal::notes(), "{}: deviations of observations over {NORMALIZING} episodes", trial.task.name)?;
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
