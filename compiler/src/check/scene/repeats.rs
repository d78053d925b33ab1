//! Numbers in formulas that repeat values of the scene, and groups that nothing reads.

use crate::check::context::Checker;
use crate::check::dimension::Dimension;
use crate::check::scene::geometry::Known;
use crate::check::types::{ElementType, Frame};
use crate::check::unit;
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::frame::Sensor;
use crate::graph::operation::Operation;
use crate::graph::{Graph, NodeId};
use crate::syntax::tree::{Expr, ExprKind};

impl Checker<'_> {
    /// Looks at a length that a formula of the task writes down.
    pub(crate) fn note_length(&mut self, value: f64, dimension: Dimension, span: Span) {
        let formula = self.scene.is_some() && self.place.in_task && !self.mode.initial;
        if !formula || dimension != Dimension::LENGTH || !telling(value) {
            return;
        }
        let place = (self.place.file, span);
        if self.repeated.iter().any(|(file, known, _)| (*file, *known) == place) {
            return;
        }
        if let Some(name) = self.known_length(value) {
            self.repeated.push((place.0, place.1, name));
        }
    }

    /// Looks at a height that is compared with, or subtracted from, a height that the formula writes down: a round number, too,
    /// is hardly met by chance if it is that of a thing's top.
    pub(crate) fn note_height(&mut self, height: NodeId, written: &Expr) {
        let mut number = written;
        while let ExprKind::Paren(inner) = &number.kind {
            number = inner;
        }
        let ExprKind::Number(quantity) = &number.kind else { return };
        let Some(Ok(one)) = quantity.unit.as_ref().map(unit::evaluate) else { return };
        let value = quantity.value * one.value;
        if value == 0.0 || telling(value) || one.dimension != Dimension::LENGTH || !is_height(&self.graph, height) {
            return;
        }
        let tops = |name: &&String| name.ends_with(".top");
        let same = |known: &Known| known.lanes.as_slice() == [value];
        let top = self.known.iter().filter(|(name, _)| tops(name)).find(|(_, known)| same(known)).map(|(name, _)| name.clone());
        let formula = self.scene.is_some() && self.place.in_task && !self.mode.initial;
        let place = (self.place.file, written.span);
        if let Some(name) = top.filter(|_| formula)
            && !self.repeated.iter().any(|(file, known, _)| (*file, *known) == place)
        {
            self.repeated.push((place.0, place.1, name));
        }
    }

    /// Which size or place of the scene is this length.
    fn known_length(&self, value: f64) -> Option<String> {
        let same = |lane: f64| (lane.abs() - value.abs()).abs() <= 1e-9 * value.abs();
        for (name, known) in &self.known {
            let components: &[&str] = match known.element {
                ElementType::Number(Dimension::LENGTH) => &[""],
                ElementType::Place(_) => &[".x", ".y", ".z"],
                ElementType::Vector { frame: Frame::World, .. } => &[".x", ".y", ".z"],
                ElementType::Vector { .. } => &[".forward", ".left", ".up"],
                _ => &[],
            };
            if let Some((component, _)) = components.iter().zip(&known.lanes).find(|(_, lane)| same(**lane)) {
                return Some(format!("{name}{component}"));
            }
        }
        None
    }

    /// Warnings about the scene, once all formulas are checked.
    pub(crate) fn scene_lints(&self, diagnostics: &mut Vec<Diagnostic>) {
        diagnostics.extend(self.repeated.iter().map(|(file, span, name)| {
            let message = format!("this repeats a size or place of the scene: `{name}`");
            Diagnostic::new(codes::lints::REPEATS_SCENE, *file, *span, message).help(format!(
                "read it, so that both change together: `{name}`; if the equality is accidental, write `allow repeats_scene \"...\"`"
            ))
        }));
        let groups = self.scene.into_iter().flat_map(|scene| &scene.statements.groups);
        for group in groups {
            let name = &group.statement.name;
            if !self.used.contains(&name.text) {
                let message = format!("unused group `{}`", name.text);
                diagnostics.push(Diagnostic::new(codes::lints::UNUSED, group.file, name.span, message));
            }
        }
    }
}

/// Whether a node is the height of a part of the body or of its centre of mass.
fn is_height(graph: &Graph, node: NodeId) -> bool {
    let known = graph.node(node);
    let (Operation::Select(lanes), [from]) = (&known.operation, known.inputs.as_slice()) else { return false };
    let place = |sensor: &Sensor| matches!(sensor, Sensor::LandmarkPosition(_) | Sensor::ComPosition);
    let measured = matches!(&graph.node(*from).operation, Operation::Sensors(sensors) if sensors.iter().all(place));
    measured && lanes.iter().all(|lane| lane % 3 == 2)
}

/// Whether a number is no round one, met by chance: two digits at least.
fn telling(value: f64) -> bool {
    let written = format!("{:.8e}", value.abs());
    let digits = written.split('e').next().unwrap_or_default().trim_end_matches('0').trim_end_matches('.');
    digits.contains('.')
}

#[cfg(test)]
mod tests {
    use super::telling;

    #[test]
    fn round_numbers_are_met_by_chance() {
        assert!(!telling(1.0) && !telling(0.5) && !telling(0.3) && !telling(20.0) && !telling(0.0));
        assert!(telling(0.47) && telling(0.15) && telling(1.2) && !telling(0.1 + 0.2));
    }
}
