//! The tables of the paper in its layouts, as LaTeX, Markdown and comma-separated values: all that the given folders fill.

mod recruitment;
mod residual;
mod sessions;
mod settings;
mod suite;
mod table;

pub use suite::steps;
pub use table::{PaperTable, csv, latex, markdown};

use super::episodes::Compared;
use super::read::Source;
use msk::evaluate::sweep::Sweep;
use msk::evaluate::{Summary, TaskSummary};

/// A policy: its evaluation and its sweep.
pub struct Column<'a> {
    pub name: &'a str,
    pub summary: Option<&'a Summary>,
    pub sweep: Option<&'a Sweep>,
}

/// All tables that the folders fill, with the episodes that were compared with recordings of people.
pub fn tables(columns: &[Column<'_>], sources: &[Source], compared: &[Compared]) -> Vec<PaperTable> {
    let mut tables = suite::tables(columns, sources);
    tables.extend(sources.iter().filter_map(|source| recruitment::table(source.summary.as_ref()?)));
    tables.extend(settings::tables(sources));
    tables.extend(sessions::table(sources));
    tables.extend(residual::table(columns, compared));
    tables.into_iter().map(PaperTable::in_lines).collect()
}

/// Evaluations and sweeps of one policy belong together.
pub fn columns(sources: &[Source]) -> Vec<Column<'_>> {
    let mut columns: Vec<Column<'_>> = Vec::new();
    for source in sources {
        let named = source.summary.as_ref().map(|summary| summary.policy.as_str());
        let Some(name) = named.or_else(|| source.sweep.as_ref().map(|sweep| sweep.policy.as_str())) else { continue };
        let place = columns.iter().position(|column| column.name == name).unwrap_or_else(|| {
            columns.push(Column { name, summary: None, sweep: None });
            columns.len() - 1
        });
        let column = &mut columns[place];
        // The episodes of an evaluation are more than the unperturbed ones of a sweep.
        if let Some(summary) = source.summary.as_ref().filter(|_| column.summary.is_none() || source.sweep.is_none()) {
            column.summary = Some(summary);
        }
        column.sweep = column.sweep.or(source.sweep.as_ref());
    }
    columns
}

impl Column<'_> {
    /// What the policy has come to in a task.
    pub fn task(&self, name: &str) -> Option<&TaskSummary> {
        self.summary?.tasks.iter().find(|known| known.task == name)
    }
}

/// Mean of a standard metric over the episodes of a task.
pub fn standard(task: &TaskSummary, name: &str) -> Option<f64> {
    task.standard.iter().find(|known| known.name == name).map(|known| known.value.mean)
}

#[cfg(test)]
mod tests;
