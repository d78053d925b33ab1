//! How long a control step and an episode take.

use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::ends::LONGEST_EPISODE;
use crate::diagnostics::codes;
use crate::extremes::minimum;
use crate::numbers::{for_people, tidy};
use crate::syntax::tree::Expr;

/// Most physics steps in a control step.
const LONGEST_CONTROL_STEP: f64 = 1e6;

/// Most physics steps in an episode: at a hundred microseconds each they take twelve days.
const MOST_PHYSICS_STEPS: f64 = 1e10;

impl<'a> Checker<'a> {
    pub(super) fn control(&mut self, expr: &'a Expr) -> Checked<f64> {
        let frequency = self.number_of(expr, Dimension::FREQUENCY, "`control`")?;
        let Some(frequency) = self.graph.constant_value(frequency.node).filter(|f| *f > 0.0 && f.is_finite()) else {
            return Err(self.error(codes::types::NOT_CONSTANT, expr.span, "`control` is a positive constant frequency"));
        };
        let fastest = 1.0 / self.vocabulary.physics_step;
        let steps = 1.0 / (frequency * self.vocabulary.physics_step);
        if steps > LONGEST_CONTROL_STEP {
            let slowest = fastest / LONGEST_CONTROL_STEP;
            let message = "this control step is too long: it has more than a million physics steps";
            let diagnostic = self
                .diagnostic(codes::tasks::TIMING, expr.span, message)
                .expected(format!("{} .. {} Hz", for_people(slowest), for_people(fastest)))
                .found(format!("{} Hz", for_people(frequency)))
                .help("a policy acts once per control step: `control 50 Hz`");
            return Err(self.report(diagnostic));
        }
        if (steps - steps.round()).abs() > 1e-6 || steps.round() < 1.0 {
            let diagnostic = self
                .diagnostic(codes::tasks::TIMING, expr.span, "a control step must be a whole number of physics steps")
                .expected(format!("{} Hz divided by a whole number", tidy(fastest)))
                .found(format!("{} Hz", for_people(frequency)));
            return Err(self.report(diagnostic));
        }
        self.timing.interval = steps.round() * self.vocabulary.physics_step;
        Ok(frequency)
    }

    pub(super) fn horizon(&mut self, expr: &'a Expr) -> Checked<()> {
        let steps = self.steps(expr)?;
        let physics_steps = self.timing.interval / self.vocabulary.physics_step;
        let most = minimum(LONGEST_EPISODE, (MOST_PHYSICS_STEPS / physics_steps).floor());
        if !(1.0..=most).contains(&steps) {
            let [most, found] = self.durations_in_words([most, steps]);
            let diagnostic = self
                .diagnostic(codes::tasks::TIMING, expr.span, "the horizon is out of range")
                .expected(format!("from 1 step to {most}"))
                .found(found)
                .help("an episode of a minute is `horizon 60 s`");
            return Err(self.report(diagnostic));
        }
        self.timing.horizon = steps as u32;
        Ok(())
    }
}
