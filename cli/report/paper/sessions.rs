//! Direct control: duration, first divergence, tracking error and outcome of sessions.

use super::super::read::Source;
use super::table::{Cell, Group, PaperTable, cell, head, number};

/// A row for each session; none without one.
pub fn table(sources: &[Source]) -> Option<PaperTable> {
    let rows: Vec<Vec<Cell>> = sources
        .iter()
        .filter_map(|source| source.session.as_ref())
        .map(|session| {
            // Of one that was not compared with a policy nothing is known; one that was may not have diverged.
            let divergence = match &session.comparison {
                Some(comparison) => comparison.diverged.map_or_else(|| cell("N/A"), |time| number(Some(time), 2)),
                None => number(None, 2),
            };
            let rmse = session.tracking.as_ref().map(|tracking| tracking.rmse);
            vec![cell(&*session.task), number(Some(session.duration), 2), divergence, number(rmse, 3), cell(&*session.outcome)]
        })
        .collect();
    (!rows.is_empty()).then(|| PaperTable {
        caption:
            "Direct muscle control. Div.: first sustained divergence from a policy that follows the same motion; N/A: it did not \
                  diverge; --: not compared, which `msk session tracking` does."
                .into(),
        columns: "@{}lcccc@{}".into(),
        head: vec![
            ["Task", "Duration (s) \u{2191}", "Div. (s) \u{2191}", "Tracking RMSE (m) \u{2193}", "Outcome"].map(head).into(),
        ],
        groups: vec![Group { name: None, rows }],
    })
}
