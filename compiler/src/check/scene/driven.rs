//! Objects that move as formulas of time have it: platforms, treadmills that rock, doors of an elevator.
//!
//! What a formula changes from one control step to the next is how far its object moves in the step: the formula at the step before is
//! subtracted from that at the next, which is the same graph with the count of steps raised by one.

use super::expand::Locals;
use super::fields::Fields;
use super::{Stage, head};
use crate::check::context::{Checked, Checker, Failures};
use crate::check::dimension::Dimension;
use crate::check::value::Value;
use crate::diagnostics::{FileId, codes};
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Operation};
use crate::scene::{Motion, Parent};
use crate::syntax::tree::{Element, Expr};
use std::collections::BTreeMap;

/// The formulas by which an object moves.
#[derive(Debug, Clone)]
pub(crate) struct DrivenObject<'a> {
    /// Its place in the scene.
    pub object: usize,
    pub moves: Option<&'a Expr>,
    pub turns: Option<&'a Expr>,
    pub locals: Locals,
    pub file: FileId,
}

impl<'a> Checker<'a> {
    /// How an element moves that may have formulas for it. Noted for later: they may read what is not known yet.
    pub(super) fn driven(
        &mut self,
        stage: &mut Stage<'a>,
        element: &'a Element,
        (fields, locals): (&Fields<'a>, &Locals),
        (motion, parent): (Motion, &Parent),
    ) -> Checked<Motion> {
        if let (Motion::Joints(_), Parent::Object(carrier)) = (&motion, parent)
            && stage.is_driven(*carrier)
        {
            let message = "what a formula moves has no joints: its parts would not feel how it speeds up";
            let diagnostic = self
                .diagnostic(codes::scene::MOTION, head(element), message)
                .help("declare it at the top level and hold it with `weld` or `connect`");
            return Err(self.report(diagnostic));
        }
        let [moves, turns] = ["moves", "turns"].map(|name| fields.get(name));
        let Some(field) = moves.or(turns) else { return Ok(motion) };
        if !matches!((&motion, parent), (Motion::Fixed | Motion::Placed, Parent::World)) {
            let message = format!("only what is fixed to the world takes `{}`", field.name.text);
            let diagnostic = self.diagnostic(codes::scene::MOTION, field.span, message);
            let help =
                "a formula of time takes the place of `free`, of joints and of a carrier; parts move with what carries them";
            return Err(self.report(diagnostic.help(help)));
        }
        let mut value = |field: Option<&'a crate::syntax::tree::Field>| field.map(|field| self.field_value(field)).transpose();
        let (moves, turns) = (value(moves)?, value(turns)?);
        let object = stage.scene.objects.len();
        stage.driven.push(DrivenObject { object, moves, turns, locals: locals.clone(), file: self.place.file });
        Ok(Motion::Driven)
    }

    /// What each driven object does in a control step: how far it moves along the axes of the world, m, and turns about the vertical, rad.
    pub(super) fn drives(&mut self) -> Checked<Vec<(usize, NodeId)>> {
        let Some(scene) = self.scene else { return Ok(Vec::new()) };
        let (mut drives, mut failures) = (Vec::new(), Failures::default());
        for driven in &scene.driven {
            let drive = self.in_file(driven.file, |checker| {
                checker.with_locals(&driven.locals, |checker| {
                    let moves = driven.moves.map(|expr| checker.displacement(expr)).transpose();
                    let turns = driven.turns.map(|expr| checker.turn_of_step(expr)).transpose();
                    let (moves, turns) = (moves?, turns?);
                    let moves = moves.unwrap_or_else(|| checker.graph.constants(&[0.0; 3]));
                    let turns = turns.unwrap_or_else(|| checker.graph.constant(0.0));
                    Ok(checker.graph.join(&[moves, turns]))
                })
            });
            drives.extend(failures.catch(drive).map(|node| (driven.object, node)));
        }
        failures.or(drives)
    }

    fn displacement(&mut self, expr: &'a Expr) -> Checked<NodeId> {
        let data = match self.value(expr)? {
            Value::Typed(data) => data,
            other => return Err(self.not_numbers(&other, expr.span)),
        };
        self.must_be_bracket(&data, 3, Dimension::LENGTH, expr.span, "`moves`")?;
        self.change_in_a_step(data.node, expr, "moves")
    }

    fn turn_of_step(&mut self, expr: &'a Expr) -> Checked<NodeId> {
        let node = self.number_of(expr, Dimension::ANGLE, "`turns`")?.node;
        self.change_in_a_step(node, expr, "turns")
    }

    /// By how much a formula of time changes until the next step.
    fn change_in_a_step(&mut self, now: NodeId, expr: &'a Expr, name: &str) -> Checked<NodeId> {
        let reads = self.graph.reachable([now]);
        let measured = |id: &NodeId| {
            matches!(
                self.graph.node(*id).operation,
                Operation::Sensors(_)
                    | Operation::Memory(_)
                    | Operation::StateBefore(_)
                    | Operation::StateAfter(_)
                    | Operation::PhaseSuccess(_)
            )
        };
        if reads.iter().any(measured) {
            let diagnostic = self
                .diagnostic(codes::types::NOT_CONSTANT, expr.span, format!("`{name}` is a formula of time"))
                .help("it may read `t`, numbers, constants and a `random`, but no signal and nothing that remembers");
            return Err(self.report(diagnostic));
        }
        if !reads.iter().any(|id| self.graph.node(*id).operation == Operation::Step) {
            let diagnostic = self
                .diagnostic(codes::scene::MOTION, expr.span, format!("`{name}` does not depend on `t`, so nothing moves"))
                .help("`moves [0.1 m * sin(90 deg/s * t), 0, 0]`; `at` is where it stands at first");
            return Err(self.report(diagnostic));
        }
        let next = self.a_step_later(now, &reads);
        Ok(self.graph.binary(Binary::Subtract, next, now))
    }

    /// The same formula with the count of steps raised by one; `reads` are its nodes, inputs first.
    fn a_step_later(&mut self, node: NodeId, reads: &[NodeId]) -> NodeId {
        let mut later: BTreeMap<NodeId, NodeId> = BTreeMap::new();
        for &id in reads {
            let (operation, inputs) = (self.graph.node(id).operation.clone(), self.graph.node(id).inputs.clone());
            let moved: Vec<NodeId> = inputs.iter().map(|input| later.get(input).copied().unwrap_or(*input)).collect();
            let own = match operation {
                Operation::Step => {
                    let one = self.graph.constant(1.0);
                    self.graph.binary(Binary::Add, id, one)
                }
                _ if moved == inputs => id,
                // What a random draws is drawn once.
                Operation::Drawn(_) | Operation::DrawnAfter(_) => id,
                _ => self.graph.add(operation, &moved),
            };
            later.insert(id, own);
        }
        later.get(&node).copied().unwrap_or(node)
    }
}
