//! Synergies: groups of muscles that share an action.

use super::spaces::form;
use crate::action::Synergy;
use crate::check::context::{Checked, Checker};
use crate::diagnostics::{Span, codes};
use crate::syntax::tree::{Expr, ExprKind, Field};
use crate::vocabulary::Vocabulary;

/// On which side of the body a muscle is.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
    Middle,
}

impl<'a> Checker<'a> {
    /// `of [soleus_{l,r}, hamstrings]`, with `sides` each divided into left and right.
    pub(super) fn synergies(&mut self, of: Option<&'a Field>, sides: Option<&'a Field>) -> Checked<Vec<Synergy>> {
        // `of` is required, and its absence has been reported.
        let Some(field) = of else { return Ok(Vec::new()) };
        let expr = self.setting_value(field)?;
        let divided = sides.map_or(Ok(false), |field| self.flag_value(field))?;
        let alone = std::slice::from_ref(expr);
        let groups = if let ExprKind::List(groups) = &expr.kind { groups.as_slice() } else { alone };
        let mut synergies: Vec<Synergy> = Vec::new();
        let mut all = Vec::new();
        for (index, group) in groups.iter().enumerate() {
            let muscles = self.muscles_of(group)?;
            all.extend_from_slice(&muscles);
            self.must_be_once(&all, group)?;
            let name = name_of_group(group, index);
            let parts = if divided { by_side(&name, muscles, self.vocabulary) } else { vec![Synergy { name, muscles }] };
            for part in parts {
                self.must_be_named_once(&synergies, &part, group.span)?;
                synergies.push(part);
            }
        }
        if synergies.is_empty() {
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, expr.span, "there are no groups of muscles here")
                .expected(format!("`{}`", form("of")));
            return Err(self.report(diagnostic));
        }
        Ok(synergies)
    }

    fn must_be_named_once(&mut self, known: &[Synergy], synergy: &Synergy, span: Span) -> Checked<()> {
        if known.iter().any(|other| other.name == synergy.name) {
            let message = format!("two synergies are called `{}`", synergy.name);
            return Err(self.error(codes::tasks::REPEATED, span, message));
        }
        Ok(())
    }
}

/// The name of a group as it is written, where it is a name; else its number.
fn name_of_group(group: &Expr, index: usize) -> String {
    match &group.kind {
        ExprKind::Name(name) if !name.text.contains('{') => name.text.clone(),
        ExprKind::Text(text) => text.clone(),
        _ => format!("synergy_{}", index + 1),
    }
}

/// A group divided into its muscles of the left, of the right and of neither side, as far as there are any.
fn by_side(name: &str, muscles: Vec<usize>, vocabulary: &Vocabulary) -> Vec<Synergy> {
    let part = |side: Side, suffix: &str| {
        let own = muscles.iter().copied().filter(|&muscle| side_of(muscle, vocabulary) == side);
        Synergy { name: format!("{name}{suffix}"), muscles: own.collect() }
    };
    let parts = [part(Side::Left, "_l"), part(Side::Right, "_r"), part(Side::Middle, "")];
    parts.into_iter().filter(|part| !part.muscles.is_empty()).collect()
}

/// The side of a muscle by its name: models call the partners `soleus_l` and `soleus_r`, or `DELT1_left` and `DELT1`.
fn side_of(muscle: usize, vocabulary: &Vocabulary) -> Side {
    let Some(name) = vocabulary.muscles.get(muscle).map(|muscle| muscle.name.as_str()) else { return Side::Middle };
    let exists = |name: String| vocabulary.muscles.iter().any(|muscle| muscle.name == name);
    if name.ends_with("_l") || name.ends_with("_left") {
        Side::Left
    } else if name.ends_with("_r") || name.ends_with("_right") || exists(format!("{name}_left")) {
        Side::Right
    } else {
        Side::Middle
    }
}
