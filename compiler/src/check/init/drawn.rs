//! Numbers of an initial state: known while compiling, or drawn for every episode by a `random` of the task.

use super::InitialState;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::value::Value;
use crate::diagnostics::{Span, codes};
use crate::graph::NodeId;
use crate::syntax::tree::Expr;
use crate::task::Setting;

impl InitialState {
    /// What a later statement sets instead.
    pub(super) fn forget(&mut self, settings: &[Setting]) {
        self.init.drawn.retain(|(setting, _)| !settings.contains(setting));
    }
}

impl<'a> Checker<'a> {
    /// A number of this dimension.
    pub(super) fn begin_number(
        &mut self,
        expr: &'a Expr,
        dimension: Dimension,
        wanted_by: &str,
        setting: Setting,
        initial: &mut InitialState,
    ) -> Checked<()> {
        let data = self.number_of(expr, dimension, wanted_by)?;
        self.begin(data.node, &[setting], expr.span, wanted_by, initial)
    }

    /// The components of a bracket.
    pub(super) fn begin_bracket<const SIZE: usize>(
        &mut self,
        expr: &'a Expr,
        dimension: Dimension,
        wanted_by: &str,
        settings: [Setting; SIZE],
        initial: &mut InitialState,
    ) -> Checked<()> {
        let data = match self.value(expr)? {
            Value::Typed(data) => data,
            other => return Err(self.not_numbers(&other, expr.span)),
        };
        self.must_be_bracket(&data, SIZE, dimension, expr.span, wanted_by)?;
        self.begin(data.node, &settings, expr.span, wanted_by, initial)
    }

    /// Writes what is known; keeps what is drawn.
    pub(super) fn begin(
        &mut self,
        node: NodeId,
        settings: &[Setting],
        span: Span,
        wanted_by: &str,
        initial: &mut InitialState,
    ) -> Checked<()> {
        for (lane, &setting) in settings.iter().enumerate() {
            let part = self.graph.select([lane], node);
            match self.graph.constant_value(part) {
                Some(value) if value.is_finite() => initial.init.set(setting, value),
                Some(_) => {
                    return Err(self.error(codes::types::WRONG_TYPE, span, format!("{wanted_by} takes finite numbers")));
                }
                None => {
                    self.must_be_drawn(part, span, wanted_by)?;
                    initial.init.drawn.push((setting, initial.drawn.len()));
                    initial.drawn.push(part);
                }
            }
        }
        Ok(())
    }

    /// The initial state comes before the first snapshot: only what is drawn without looking at the body is known by then.
    pub(in crate::check) fn must_be_drawn(&mut self, node: NodeId, span: Span, wanted_by: &str) -> Checked<()> {
        if self.graph.is_drawn_first(node) {
            return Ok(());
        }
        let diagnostic = self
            .diagnostic(codes::types::NOT_CONSTANT, span, format!("{wanted_by} is evaluated before the first snapshot"))
            .help("it may read numbers, constants and a `random`, but no signal of the body");
        Err(self.report(diagnostic))
    }
}
