//! What a folder of results comes to, as its journal has it.

use super::{Summarizer, Summary};
use crate::RunSettings;
use crate::journal::{JournalError, Reader, SUMMARY};
use msk_storage::Folder;
use std::path::Path;

/// Most bytes that are read of a summary.
pub(crate) const LARGEST: u64 = 256 << 20;

/// What summaries have and journals do not.
pub(crate) struct BesideJournal {
    /// Tasks that the policy cannot act on, by their places in the plan, with the reasons.
    pub skipped: Vec<(usize, String)>,
    /// Units of the metrics of each task.
    pub units: Vec<Vec<String>>,
}

impl BesideJournal {
    /// Of summaries that a run has written. What they have of tasks other than the run's is left out.
    pub fn of(summaries: &[Summary], settings: &RunSettings) -> Self {
        let of_task = |place: usize| {
            let name = settings.tasks.get(place).map(|task| &task.name);
            let tasks = summaries.iter().filter_map(move |summary| summary.tasks.get(place));
            tasks.filter(move |task| Some(&task.task) == name)
        };
        let places = 0..settings.tasks.len();
        let skipped = |place: usize| Some((place, of_task(place).find_map(|task| task.skipped.clone())?));
        let units = |place: usize| -> Vec<String> {
            let known = of_task(place).find(|task| !task.metrics.is_empty());
            known.into_iter().flat_map(|task| &task.metrics).map(|metric| metric.unit.clone()).collect()
        };
        Self { skipped: places.clone().filter_map(skipped).collect(), units: places.map(units).collect() }
    }
}

impl Summary {
    /// Of the episodes in the journal of a folder whose run has been summed up; `None` if it has not. Of `summary.json` only what journals
    /// do not have is taken, so that neither a summary of another run nor an edited one is believed.
    ///
    /// # Errors
    /// A folder that holds no journal, or a damaged one, or a damaged summary.
    pub fn of_folder(folder: &Folder) -> Result<Option<Self>, JournalError> {
        let unusable = |source| JournalError::Unusable { folder: folder.path().into(), source };
        let Some(text) = folder.read_text(Path::new(SUMMARY), LARGEST).map_err(unusable)? else { return Ok(None) };
        let kept: Self = serde_json::from_str(&text).map_err(|error| JournalError::Damaged {
            path: folder.path().join(SUMMARY),
            line: error.line(),
            reason: error.to_string(),
        })?;
        let reader = Reader::in_folder(folder)?;
        let beside = BesideJournal::of(&[kept], reader.settings());
        let mut summarizer = Summarizer::of(reader.settings().clone(), beside.units);
        for episode in reader {
            summarizer.add(&episode?.1);
        }
        let summary = summarizer.summary();
        // A task that has episodes was not skipped.
        let without = |(place, _): &(usize, String)| summary.tasks.get(*place).is_some_and(|task| task.episodes == 0);
        let skipped: Vec<(usize, String)> = beside.skipped.into_iter().filter(without).collect();
        Ok(Some(summary.with_skipped(&skipped)))
    }
}
