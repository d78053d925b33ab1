//! Standard metrics: numbers that an evaluation computes of every episode, whatever its task. One file each, with formula and source.
//!
//! All are computed from the [rows](crate::trace::Row) of an episode, as they come or from a trace that was kept, with the same bits.
//! Samples "before a step" are those of the reset and of all steps but the last, as published evaluators take them.

mod activation_cost;
mod energy;
mod gait;
mod reactions;
mod recruitment;
mod smoothness;
mod tracking;

pub mod curve;
pub mod peak;
pub mod similarity;

pub use gait::{Gait, GaitFigures, Strike};
pub use recruitment::{Recruitment, shares};

use crate::trace::{Quantity, Row, StepReader};
use crate::{ByTerm, EpisodeRecord};
use activation_cost::ActivationCost;
use energy::Energy;
use msk_runtime::episode::{Ending, Engine};
use msk_runtime::policy::PolicyContext;
use reactions::Reactions;
use smoothness::Smoothness;
use tracking::Tracking;

/// What standard metrics are computed from.
pub const QUANTITIES: [Quantity; 8] = [
    Quantity::Activations,
    Quantity::Velocities,
    Quantity::JointReactions,
    Quantity::GroundReactions,
    Quantity::Feet,
    Quantity::CenterOfMass,
    Quantity::MetabolicPower,
    Quantity::TrackingError,
];

/// Names of the standard metrics with their units, in the order of results.
pub const STANDARD: [(&str, &str); 14] = [
    ("activation_cost", ""),
    ("joint_smoothness", "log10(rad^2/s^6)"),
    ("metabolic_energy", "J"),
    ("metabolic_power", "W/kg"),
    ("cost_of_transport", ""),
    ("peak_ground_reaction", "body weight"),
    ("peak_joint_reaction", "body weight"),
    ("distance", "m"),
    ("cadence", "1/min"),
    ("step_length", "m"),
    ("stance_share", ""),
    ("step_length_asymmetry", ""),
    ("stance_asymmetry", ""),
    ("tracking_error", "m"),
];

/// Computes the standard metrics of an episode while it is played.
#[derive(Debug, Clone, Default)]
pub struct StandardMetrics {
    activation_cost: ActivationCost,
    smoothness: Smoothness,
    energy: Energy,
    reactions: Reactions,
    gait: Gait,
    tracking: Tracking,
    recruitment: Recruitment,
}

impl StandardMetrics {
    /// Adds the next row.
    pub fn look(&mut self, row: &Row<'_>) {
        self.activation_cost.look(row);
        self.smoothness.look(row);
        self.energy.look(row);
        self.reactions.look(row);
        self.gait.look(row);
        self.tracking.look(row);
        self.recruitment.look(row);
    }

    /// The metrics that the episode has, by the names of [`STANDARD`]: one that stood still has no cost of transport, one without two
    /// steps no cadence, one of a task that follows no motion no tracking error.
    pub fn finish(&self) -> ByTerm {
        let gait = self.gait.figures();
        let values = [
            self.activation_cost.finish(),
            self.smoothness.finish(),
            self.energy.energy(),
            self.energy.power(),
            self.energy.cost_of_transport(),
            self.reactions.ground(),
            self.reactions.joint(),
            self.energy.distance(),
            gait.cadence,
            gait.step_length,
            gait.stance_share,
            gait.step_length_asymmetry,
            gait.stance_asymmetry,
            self.tracking.finish(),
        ];
        let named = STANDARD.iter().zip(values).filter_map(|((name, _), value)| Some(((*name).to_owned(), value?)));
        ByTerm(named.filter(|(_, value)| value.is_finite()).collect())
    }

    /// Activation mass of every recruitment family.
    pub fn recruitment(&self) -> ByTerm {
        ByTerm(self.recruitment.masses())
    }
}

/// Reads every step of an episode for its standard metrics.
pub(crate) struct Measurement {
    reader: StepReader,
    metrics: StandardMetrics,
    /// Rows so far.
    rows: u32,
}

impl Measurement {
    /// Of the next episode of an engine.
    pub fn new(engine: &Engine) -> Self {
        Self { reader: StepReader::new(engine, &QUANTITIES), metrics: StandardMetrics::default(), rows: 0 }
    }

    /// Reads the reset or the step that has just been taken. A step that met a fault has no numbers and is left out.
    pub fn look(&mut self, context: &PolicyContext<'_>) {
        if context.step == self.rows && !matches!(context.episode.ending(), Some(Ending::Fault(_))) {
            self.rows += 1;
            self.metrics.look(&self.reader.read(context));
        }
    }

    /// The record of the episode with its standard metrics.
    pub fn note(&self, record: EpisodeRecord) -> EpisodeRecord {
        EpisodeRecord { standard: self.metrics.finish(), recruitment: self.metrics.recruitment(), ..record }
    }
}

#[cfg(test)]
mod tests;
