//! Sessions of direct control in a report.

use super::read::{Played, Source};
use super::{Grid, Section};
use msk::compiler::numbers::{fixed, for_people};
use msk::evaluate::session::Tracking;

/// Sessions of direct control.
pub fn section(sources: &[Source]) -> Section {
    let row = |(label, played): (&str, &Played)| {
        let meters = |of: fn(&Tracking) -> f64| played.tracking.as_ref().map_or("-".into(), |tracking| for_people(of(tracking)));
        let diverged = played.comparison.as_ref().map_or("-".into(), |comparison| {
            comparison.diverged.map_or_else(
                || format!("not from {}", comparison.policy),
                |time| format!("{}, {}", fixed(time, 2), comparison.policy),
            )
        });
        let [rmse, last, largest] = [meters(|found| found.rmse), meters(|found| found.last), meters(|found| found.largest)];
        let duration = fixed(played.duration, 2);
        vec![
            label.to_owned(),
            played.task.clone(),
            played.decisions.to_string(),
            duration,
            rmse,
            last,
            largest,
            diverged,
            played.outcome.clone(),
        ]
    };
    let rows = sources.iter().filter_map(|source| Some((source.label.as_str(), source.session.as_ref()?))).map(row).collect();
    let head = [
        "session",
        "task",
        "decisions",
        "duration, s",
        "tracking error, m",
        "last, m",
        "largest, m",
        "diverged, s, from",
        "outcome",
    ];
    Section {
        title: "Direct control".into(),
        words: "Sessions that decide action by action; docs/sessions.md has the criteria.".into(),
        table: Some(Grid { head: head.map(String::from).to_vec(), rows }),
        figures: vec![],
    }
}
