//! Metabolic energy and cost of transport.
//!
//! The energy is the integral of the metabolic power of all muscles (Bhargava, Pandy and Anderson, J. Biomech. 37, 2004; without the
//! basal rate of the body) over the episode, by trapezoids, J. The cost of transport is energy / (m g d), dimensionless (Tucker, Am. Sci.
//! 63, 1975), where d is how far the centre of mass came horizontally, from its first to its last place; one that came less far than a
//! metre has none.

use crate::trace::{Quantity, Row};

/// What comes less far goes nowhere, m.
const LEAST_DISTANCE: f64 = 1.0;

/// Integrates power, and keeps the first and the last place.
#[derive(Debug, Clone, Default)]
pub(super) struct Energy {
    energy: f64,
    steps: u32,
    power: Option<f64>,
    places: Option<[[f64; 2]; 2]>,
    period: f64,
    mass: f64,
    gravity: f64,
}

impl Energy {
    pub fn look(&mut self, row: &Row<'_>) {
        let layout = row.layout();
        (self.period, self.mass, self.gravity) = (layout.period, layout.mass, layout.gravity);
        if let [power] = *row.of(Quantity::MetabolicPower)
            && let Some(before) = self.power.replace(power)
        {
            self.energy += 0.5 * (before + power) * self.period;
            self.steps += 1;
        }
        if let [x, y, _] = *row.of(Quantity::CenterOfMass) {
            let [first, _] = self.places.unwrap_or([[x, y]; 2]);
            self.places = Some([first, [x, y]]);
        }
    }

    /// Energy of the episode, J; `None` without a step.
    pub fn energy(&self) -> Option<f64> {
        (self.steps > 0).then_some(self.energy)
    }

    /// Mean power over mass, W/kg.
    pub fn power(&self) -> Option<f64> {
        self.energy().map(|energy| energy / (f64::from(self.steps) * self.period * self.mass))
    }

    /// How far the centre of mass came horizontally, m.
    pub fn distance(&self) -> Option<f64> {
        self.places.map(|[[x, y], [to_x, to_y]]| libm::hypot(to_x - x, to_y - y))
    }

    /// Cost of transport; `None` of one that goes nowhere.
    pub fn cost_of_transport(&self) -> Option<f64> {
        let distance = self.distance().filter(|distance| *distance >= LEAST_DISTANCE)?;
        self.energy().map(|energy| energy / (self.mass * self.gravity * distance))
    }
}
