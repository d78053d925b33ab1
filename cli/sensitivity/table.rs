//! The results of `msk sensitivity` as tables and as a picture.

use core::fmt::Write;
use msk::compiler::numbers::{fixed, for_people};
use msk::evaluate::Summary;
use msk::evaluate::report::{Table, in_markdown};
use msk::physics::scalar::Real;
use msk_text::in_one_line;

/// What a policy did under one set of weights.
pub struct Row {
    name: String,
    /// The changed term, and whether its weight grew in size.
    change: Option<(usize, bool)>,
    success_rate: f64,
    /// Mean control steps of an episode.
    steps: f64,
    /// Mean return of an episode under the unchanged weights.
    total: f64,
    /// Name and mean value per step of each term.
    values: Vec<(String, f64)>,
}

/// A value that moves by less than this part of the largest of its term does not count as a change.
const NOTABLE: f64 = 0.05;

impl Row {
    /// Of the episodes of a variant; `weights` are the unchanged ones. `None` without episodes.
    pub fn of(name: &str, change: Option<(usize, f64)>, summary: &Summary, weights: &[f64]) -> Option<Self> {
        let task = summary.tasks.first()?;
        let steps = task.steps.as_ref()?.mean;
        let values: Vec<(String, f64)> =
            task.terms.iter().map(|term| (term.name.clone(), term.value_per_step.unwrap_or(0.0))).collect();
        let per_step: f64 = values.iter().zip(weights).map(|((_, value), weight)| weight * value).sum();
        Some(Self {
            name: name.to_owned(),
            change: change.map(|(term, weight)| (term, weight.abs() > weights[term].abs())),
            success_rate: task.success_rate?,
            steps,
            total: steps * per_step,
            values,
        })
    }
}

/// Behaviour under each variant.
fn behaviour(rows: &[Row]) -> Table {
    let mut table = Table::new(&["weights", "success", "steps", "return", "change"]);
    let base = rows.first().map_or(0.0, |row| row.total);
    for row in rows {
        let change = 100.0 * (row.total - base) / base.abs().at_least(f64::MIN_POSITIVE);
        let change = if row.change.is_none() || !change.is_finite() {
            String::new()
        } else {
            format!("{}{} %", if change < 0.0 { "" } else { "+" }, fixed(change, 0))
        };
        let success = format!("{} %", fixed(100.0 * row.success_rate, 0));
        table.row(vec![row.name.clone(), success, fixed(row.steps, 0), for_people(row.total), change]);
    }
    table
}

/// Mean values of all terms under each variant.
fn values(rows: &[Row]) -> Table {
    let names = rows.first().map_or(&[][..], |row| row.values.as_slice());
    let head: Vec<&str> = ["weights"].into_iter().chain(names.iter().map(|(name, _)| name.as_str())).collect();
    let mut table = Table::new(&head);
    for row in rows {
        let values = row.values.iter().map(|(_, value)| for_people(*value));
        table.row([row.name.clone()].into_iter().chain(values).collect());
    }
    table
}

/// One line for each term: what a larger weight makes larger and smaller.
fn effects(rows: &[Row]) -> Vec<String> {
    let Some((base, variants)) = rows.split_first() else { return Vec::new() };
    let largest = |term: usize| rows.iter().map(|row| row.values[term].1.abs()).fold(0.0, Real::at_least);
    let mut lines = Vec::new();
    for (term, (name, _)) in base.values.iter().enumerate() {
        let of_term = |grown: bool| variants.iter().find(|row| row.change == Some((term, grown)));
        // From the smaller weight to the larger one, as far as they were tried.
        let (low, high) = (of_term(false).unwrap_or(base), of_term(true).unwrap_or(base));
        if low.change.is_none() && high.change.is_none() {
            continue;
        }
        let moved = |sign: f64| {
            let names = base.values.iter().enumerate().filter(|(other, _)| {
                let change = sign * (high.values[*other].1 - low.values[*other].1);
                change > NOTABLE * largest(*other)
            });
            names.map(|(_, (name, _))| name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let line = match (moved(1.0).as_str(), moved(-1.0).as_str()) {
            ("", "") => "changes no term by more than 5 %".to_owned(),
            (up, "") => format!("raises {up}"),
            ("", down) => format!("lowers {down}"),
            (up, down) => format!("raises {up}; lowers {down}"),
        };
        lines.push(format!("more `{name}` {line}"));
    }
    lines
}

/// For a screen.
pub fn text(rows: &[Row]) -> String {
    format!("{}\n{}\n", behaviour(rows).markdown(), effects(rows).join("\n"))
}

/// As a page.
pub fn markdown(title: &str, rows: &[Row]) -> String {
    let effects: Vec<String> = effects(rows).iter().map(|line| format!("* {}", in_markdown(line))).collect();
    let [behaviour, values] = [behaviour(rows), values(rows)].map(|table| table.markdown());
    format!(
        "# {title}: one weight at a time\n\nThe return is that of the unchanged weights, whatever rewarded the episodes.\n\n{behaviour}\n\
         Mean unweighted value of each term per step:\n\n{values}\n{}\n",
        effects.join("\n")
    )
}

/// Width of the picture, of its names, and of a row's height.
const WIDTH: f64 = 1000.0;
const NAMES: f64 = 330.0;
const HEIGHT: f64 = 34.0;

/// Returns and success rates as bars, SVG.
pub fn plot(title: &str, rows: &[Row]) -> String {
    let largest = rows.iter().map(|row| row.total.abs()).fold(f64::MIN_POSITIVE, Real::at_least);
    let half = 0.5 * (WIDTH - NAMES - 130.0);
    let (zero, height) =
        (if rows.iter().any(|row| row.total < 0.0) { NAMES + half } else { NAMES }, 90.0 + HEIGHT * rows.len() as f64);
    let scale = if zero > NAMES { half } else { 2.0 * half } / largest;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img">"#);
    let _ = writeln!(out, "<title>{}</title>", escape(title));
    let _ = writeln!(out, "<style>text{{font:20px system-ui,sans-serif;fill:#4b4a47}}.end{{text-anchor:end}}</style>");
    let _ = writeln!(out, r##"<rect width="{WIDTH}" height="{height}" rx="16" fill="#fdfcfa"/>"##);
    let _ = writeln!(out, r#"<text x="24" y="40">{}: return by the unchanged weights, success</text>"#, escape(title));
    for (index, row) in rows.iter().enumerate() {
        let top = 64.0 + HEIGHT * index as f64;
        let (base, length) = (top + 22.0, scale * row.total);
        let (x, width) = (zero + length.at_most(0.0), length.abs());
        let fill = if row.change.is_none() { "#8a8577" } else { "#3f6fa8" };
        let _ = writeln!(out, r#"<text class="end" x="{:.1}" y="{base:.1}">{}</text>"#, NAMES - 14.0, escape(&row.name));
        let _ = writeln!(out, r#"<rect x="{x:.1}" y="{top:.1}" width="{width:.1}" height="26" rx="3" fill="{fill}"/>"#);
        let share = fixed(100.0 * row.success_rate, 0);
        let _ = writeln!(out, r#"<text class="end" x="{:.1}" y="{base:.1}">{share} %</text>"#, WIDTH - 24.0);
    }
    out.push_str("</svg>\n");
    out
}

fn escape(text: &str) -> String {
    in_one_line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, change: Option<(usize, bool)>, values: [f64; 2]) -> Row {
        let total = 10.0 * (2.0 * values[0] + values[1]);
        let values = ["pose", "still"].map(str::to_owned).into_iter().zip(values).collect();
        Row { name: name.into(), change, success_rate: 0.5, steps: 10.0, total, values }
    }

    #[test]
    fn terms_that_act_against_each_other_are_named() {
        let rows = [
            row("unchanged", None, [0.5, 0.5]),
            row("pose = 1", Some((0, false)), [0.4, 0.6]),
            row("pose = 4", Some((0, true)), [0.8, 0.2]),
            row("still = 0.5", Some((1, false)), [0.5, 0.5]),
        ];
        assert_eq!(effects(&rows), ["more `pose` raises pose; lowers still", "more `still` changes no term by more than 5 %"]);
        let text = text(&rows);
        assert!(text.contains("| pose = 4") && text.contains("+20 %"), "{text}");
        assert!(markdown("t", &rows).contains("| unchanged") && plot("a < b", &rows).contains("a &lt; b"));
    }
}
