//! The shards of a data set as one.

use super::{LAYOUT, Totals, archive_name};
use crate::journal::Journal;
use crate::merge::{InOrder, MergeError, must_be_whole, settings};
use crate::{EpisodeSet, JournalError};
use msk_storage::Folder;
use std::path::{Path, PathBuf};

/// Most bytes of a description of columns.
const LARGEST_LAYOUT: u64 = 64 << 20;

/// Whether a folder holds a data set, or a shard of one, and not an evaluation.
pub fn is_data(folder: &Path) -> bool {
    folder.join(LAYOUT).is_file()
}

/// Writes the data set whose shards are in folders into a new folder `out`, with the bytes that one machine would have written, wall times
/// aside, which are taken over. Shards may overlap. Nothing is written unless every episode is there.
///
/// # Errors
/// Folders that are not the shards of one data set, are incomplete or damaged, or a folder that cannot be written.
pub fn merge_data(shards: &[PathBuf], out: &Path) -> Result<Totals, MergeError> {
    let settings = settings(shards)?;
    let (mut done, mut totals) = (EpisodeSet::default(), Totals::default());
    for episode in InOrder::open(shards)? {
        let (job, record) = episode?;
        done.insert(job);
        totals.add(&record);
    }
    must_be_whole(&settings, &done, &[])?;
    // A shard without an episode does not know its columns.
    let columns = columns(shards)?;

    Folder::create_new(out).map_err(|source| MergeError::Folder { folder: out.into(), source })?;
    let (journal, _) = Journal::open(out, &settings)?;
    if let Some(columns) = columns {
        journal.write(LAYOUT, columns)?;
    }
    let mut episodes = InOrder::open(shards)?;
    while let Some(episode) = episodes.next() {
        let (job, record) = episode?;
        // Of shards that overlap, any has the same bytes.
        journal.adopt_file(episodes.last_folder(), &archive_name(job.1))?;
        journal.adopt(&[record])?;
    }
    for shard in shards {
        journal.adopt_rest(shard)?;
    }
    Ok(totals)
}

/// What all shards that have episodes say of their columns.
fn columns(shards: &[PathBuf]) -> Result<Option<Vec<u8>>, MergeError> {
    let mut known: Option<(Vec<u8>, &Path)> = None;
    for shard in shards {
        let unusable = |source| JournalError::Unusable { folder: shard.clone(), source };
        let own = Folder::open(shard).and_then(|folder| folder.read(Path::new(LAYOUT), LARGEST_LAYOUT)).map_err(unusable)?;
        match (&known, own) {
            (_, None) => {}
            (None, Some(own)) => known = Some((own, shard)),
            (Some((columns, _)), Some(own)) if *columns == own => {}
            (Some((_, first)), Some(_)) => {
                let difference = format!("its `{LAYOUT}` differs");
                return Err(MergeError::OtherRun { first: first.to_path_buf(), folder: shard.clone(), difference });
            }
        }
    }
    Ok(known.map(|(columns, _)| columns))
}
