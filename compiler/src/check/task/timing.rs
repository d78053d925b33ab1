//! How long a control step and an episode take.

use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::ends::tidy;
use crate::diagnostics::codes;
use crate::numbers::for_people;
use crate::syntax::tree::Expr;

impl<'a> Checker<'a> {
    pub(super) fn control(&mut self, expr: &'a Expr) -> Checked<f64> {
        let frequency = self.number_of(expr, Dimension::FREQUENCY, "`control`")?;
        let Some(frequency) = self.graph.constant_value(frequency.node).filter(|f| *f > 0.0 && f.is_finite()) else {
            return Err(self.error(codes::types::NOT_CONSTANT, expr.span, "`control` is a positive constant frequency"));
        };
        let steps = 1.0 / (frequency * self.vocabulary.physics_step);
        if (steps - steps.round()).abs() > 1e-6 || steps.round() < 1.0 {
            let physics = tidy(1.0 / self.vocabulary.physics_step);
            let diagnostic = self
                .diagnostic(codes::tasks::TIMING, expr.span, "a control step must be a whole number of physics steps")
                .expected(format!("{physics} Hz divided by a whole number"))
                .found(format!("{} Hz", for_people(frequency)));
            return Err(self.report(diagnostic));
        }
        self.timing.interval = steps.round() * self.vocabulary.physics_step;
        Ok(frequency)
    }

    pub(super) fn horizon(&mut self, expr: &'a Expr) -> Checked<()> {
        let steps = self.steps(expr)?;
        if !(1.0..=1e8).contains(&steps) {
            return Err(self.error(codes::tasks::TIMING, expr.span, "an episode takes between one step and a hundred million"));
        }
        self.timing.horizon = steps as u32;
        Ok(())
    }
}
