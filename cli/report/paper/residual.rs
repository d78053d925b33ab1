//! Residual adaptation: success and similarity with electromyograms of several policies, task by task.

use super::super::episodes::Compared;
use super::Column;
use super::table::{Cell, Group, Head, NOTHING, PaperTable, cell, head, mark_largest, number};
use msk::compiler::numbers::fixed;
use msk::evaluate::metrics::similarity::mean_correlation;

/// Most channels whose correlations are given one by one.
const MOST_CHANNELS: usize = 3;

/// A row for each task of which an episode was compared with a recording of people; none without one.
pub fn table(columns: &[Column<'_>], compared: &[Compared]) -> Option<PaperTable> {
    let mut tasks: Vec<&str> = Vec::new();
    for comparison in compared {
        if !tasks.contains(&comparison.task.as_str()) {
            tasks.push(&comparison.task);
        }
    }
    let evaluated: Vec<&Column<'_>> = columns.iter().filter(|column| column.summary.is_some()).collect();
    let names = || evaluated.iter().map(|column| head(column.name));
    let row = |task: &&str| {
        let rates: Vec<Option<f64>> =
            evaluated.iter().map(|column| column.task(task)?.success_rate).map(|rate| rate.map(|rate| 100.0 * rate)).collect();
        let mut success: Vec<Cell> = rates.iter().map(|rate| number(*rate, 0)).collect();
        mark_largest(&mut success, &rates);
        let found: Vec<Option<&Compared>> = evaluated
            .iter()
            .map(|column| compared.iter().find(|known| known.task == **task && known.policy == column.name))
            .collect();
        let means: Vec<Option<f64>> = found.iter().map(|found| mean_correlation(&(*found)?.found)).collect();
        let mut similar: Vec<Cell> = found.iter().map(|found| found.map_or_else(|| cell(NOTHING), correlations)).collect();
        mark_largest(&mut similar, &means);
        [cell(*task)].into_iter().chain(success).chain(similar).collect()
    };
    let count = evaluated.len();
    (!tasks.is_empty() && count > 0).then(|| PaperTable {
        caption: "Success, and similarity of activations with electromyograms of people: r of each channel where there are at most 3, else \
                  their mean, of the first traced episode. Bold: best of each comparison."
            .into(),
        columns: format!("@{{}}l{}@{{}}", "c".repeat(2 * count)),
        head: vec![
            vec![
                head(""),
                Head { text: "SR (%) \u{2191}".into(), columns: count },
                Head { text: "EMG r \u{2191}".into(), columns: count },
            ],
            [head("Task")].into_iter().chain(names()).chain(names()).collect(),
        ],
        groups: vec![Group { name: None, rows: tasks.iter().map(row).collect() }],
    })
}

fn correlations(compared: &Compared) -> Cell {
    match compared.found.as_slice() {
        few if few.len() <= MOST_CHANNELS => {
            cell(few.iter().map(|muscle| fixed(muscle.correlation, 2)).collect::<Vec<_>>().join("/"))
        }
        all => number(mean_correlation(all), 2),
    }
}
