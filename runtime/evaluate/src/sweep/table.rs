//! A sweep as tables, one for each axis.

use super::{Axis, Robustness, Sweep};
use crate::report::{Table, as_code};
use core::fmt::Write;
use msk_text::numbers::{exact, fixed};

fn percent(part: Option<f64>) -> String {
    part.map_or("-".into(), |part| fixed(100.0 * part, 0))
}

fn area(area: Option<f64>) -> String {
    area.map_or("-".into(), |area| fixed(area, 1))
}

/// The tables as Markdown: success in percent at every scale, and the area; at last the areas of all axes.
pub fn markdown(sweep: &Sweep) -> String {
    let mut text = format!(
        "# Robustness of {}: {} episodes per task and scale, seed {}\n",
        as_code(&sweep.policy),
        sweep.episodes,
        sweep.seed
    );
    for (place, (axis, scales)) in sweep.axes.iter().enumerate() {
        let heads: Vec<String> = scales.iter().copied().map(exact).collect();
        let mut head = vec!["task"];
        head.extend(heads.iter().map(String::as_str));
        head.push("area");
        let mut table = Table::new(&head);
        let mut row = |name: String, of: &Robustness| {
            let curve = &of.curves[place];
            let cells = curve.success.iter().map(|rate| percent(*rate)).chain([area(curve.area)]);
            table.row([name].into_iter().chain(cells).collect());
        };
        each(sweep, &mut row);
        // Writing to a string cannot fail.
        let _ = write!(text, "\n## {}\n\n{}", heading(*axis), table.markdown());
    }
    let mut head = vec!["task"];
    head.extend(sweep.axes.iter().map(|(axis, _)| axis.name()));
    head.push("mean");
    let mut table = Table::new(&head);
    let mut row = |name: String, of: &Robustness| {
        let cells = of.curves.iter().map(|curve| area(curve.area)).chain([area(of.area)]);
        table.row([name].into_iter().chain(cells).collect());
    };
    each(sweep, &mut row);
    let _ = write!(text, "\n## Areas\n\n{}", table.markdown());
    text.push_str(
        "\nSuccess in percent. Area: mean of success along the axis by trapezoids, 0 to 100. Families: means\nover tasks.\n",
    );
    text
}

/// Every family with its tasks, and all tasks.
fn each(sweep: &Sweep, row: &mut dyn FnMut(String, &Robustness)) {
    let several = sweep.tasks.len() > 1;
    for family in &sweep.families {
        if several {
            row(if family.name.is_empty() { "no family".into() } else { family.name.clone() }, family);
        }
        for task in sweep.tasks.iter().filter(|task| task.family == family.name) {
            row(format!("{}{}", if several { "- " } else { "" }, task.name), task);
        }
    }
    if several {
        row(sweep.overall.name.clone(), &sweep.overall);
    }
}

/// Name and scale of an axis.
fn heading(axis: Axis) -> String {
    let name = axis.name();
    // Names are ASCII words.
    format!("{}{}: {}", name[..1].to_uppercase(), &name[1..], axis.scale())
}
