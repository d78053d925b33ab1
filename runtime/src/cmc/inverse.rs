//! Actions that ask for activations in place of excitations: the last step of computed muscle control by itself.

use super::Present;
use super::activation::{Hold, Lead, Muscles, excitation_range};
use crate::action::{action_for, excitation};
use msk_physics::model::Model;

/// A worker's memory for the muscles of one model.
#[derive(Debug, Clone)]
pub(crate) struct ActivationInverse {
    muscles: Muscles,
    /// The activations that each muscle can reach within the control step.
    reach: Vec<[f64; 2]>,
    /// What each muscle is asked for: an activation first, then the excitation that brings it there.
    asked: Vec<f64>,
}

impl ActivationInverse {
    /// For the muscles of a model.
    pub fn new(model: &Model) -> Self {
        let count = model.actuators.muscles().count();
        Self { muscles: Muscles::new(model), reach: vec![[0.0; 2]; count], asked: vec![0.0; count] }
    }

    /// Replaces actions that ask for activations at the end of a control step of so many physics steps by actions that lead there, or as
    /// near as muscles come within it.
    pub fn invert(&mut self, present: &Present<'_>, substeps: u32, actions: &mut [f64]) {
        let &Present { body, model, state, .. } = present;
        let Self { muscles, reach, asked } = self;
        let (hold, range) = (hold(model, substeps), excitation_range(body.excitation));
        asked.iter_mut().zip(&*actions).for_each(|(asked, entry)| *asked = excitation(body.excitation, *entry));
        muscles.reach(hold, &state.activation, range, reach);
        muscles.excitations(Lead::Exact, hold, &state.activation, (range, reach), asked);
        actions.iter_mut().zip(asked).for_each(|(entry, asked)| *entry = action_for(body.excitation, *asked));
    }

    /// Replaces actions by those that ask for the activations to which they lead.
    pub fn predict(&mut self, present: &Present<'_>, substeps: u32, actions: &mut [f64]) {
        let &Present { body, model, state, .. } = present;
        let Self { muscles, asked, .. } = self;
        asked.iter_mut().zip(&*actions).for_each(|(asked, entry)| *asked = excitation(body.excitation, *entry));
        muscles.predict(hold(model, substeps), &state.activation, asked);
        actions.iter_mut().zip(asked).for_each(|(entry, asked)| *entry = action_for(body.excitation, *asked));
    }
}

fn hold(model: &Model, substeps: u32) -> Hold {
    Hold { steps: substeps, timestep: model.options.timestep }
}
