//! Hints beside weights: which share each has in the sum of their sizes.

use crate::positions::Lines;
use lsp_types::{InlayHint, InlayHintLabel, InlayHintTooltip};
use msk_compiler::compile::Inspection;
use msk_compiler::diagnostics::Span;
use msk_compiler::numbers::for_people;
use msk_compiler::syntax::tree::{File, Item, TaskStatement, Term, walk};

/// The share of every weight of a file within `range`.
pub fn shares(tree: &File, whole: &Inspection, lines: &Lines<'_>, range: Span) -> Vec<InlayHint> {
    let mut hints = Vec::new();
    for item in &tree.items {
        let Item::Task(task) = item else { continue };
        let terms: Vec<&Term> = task
            .statements
            .iter()
            .filter_map(|statement| if let TaskStatement::Reward(reward) = statement { Some(reward) } else { None })
            .flat_map(|reward| walk::items(&reward.terms))
            .collect();
        // Inherited terms count as well; where it does not compile, what stands in the text must do.
        let compiled = whole.tasks.iter().find(|known| known.name == task.name.text);
        let total: f64 = match compiled {
            Some(compiled) => compiled.terms.iter().map(|term| term.weight.abs()).sum(),
            None => terms.iter().filter_map(|term| term.weight.as_ref()).map(|weight| weight.value.abs()).sum(),
        };
        for term in terms {
            let Some(weight) = &term.weight else { continue };
            let outside = weight.span.end < range.start || range.end < weight.span.start;
            if outside || !(total > 0.0 && total.is_finite() && weight.value.is_finite()) {
                continue;
            }
            hints.push(InlayHint {
                position: lines.position(weight.span.end as usize),
                label: InlayHintLabel::String(share(weight.value.abs() / total)),
                kind: None,
                text_edits: None,
                tooltip: Some(InlayHintTooltip::String(format!(
                    "share of the sum of the absolute values of all weights, {}",
                    for_people(total)
                ))),
                padding_left: Some(true),
                padding_right: None,
                data: None,
            });
        }
    }
    hints
}

/// `27 %`, `0.02 %`: two digits.
pub fn share(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        0.0 => "0 %".to_owned(),
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 1.0 => format!("{p:.1} %"),
        p if p >= 0.01 => format!("{p:.2} %"),
        _ => "< 0.01 %".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::share;

    #[test]
    fn shares_have_two_digits() {
        let shares = [0.273, 0.0734, 0.0002, 1e-9, 0.0].map(share);
        assert_eq!(shares, ["27 %", "7.3 %", "0.02 %", "< 0.01 %", "0 %"]);
    }
}
