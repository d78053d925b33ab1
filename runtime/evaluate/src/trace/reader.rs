//! One step of an episode after the other, as numbers in columns.

use super::layout::{Coordinates, feet};
use super::{Layout, Quantity};
use msk_physics::sensors::Dynamics;
use msk_program::scene::Part;
use msk_runtime::body::sensors::Snapshot;
use msk_runtime::episode::Engine;
use msk_runtime::policy::PolicyContext;
use msk_runtime::reference::Reference;
use nalgebra::Vector3;
use std::sync::Arc;

/// Numbers of the ground reaction of a foot.
const REACTION: usize = 7;

/// The numbers of one control step, or of the reset.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    layout: &'a Layout,
    values: &'a [f64],
    is_reset: bool,
}

impl<'a> Row<'a> {
    pub(crate) fn new(layout: &'a Layout, values: &'a [f64], is_reset: bool) -> Self {
        Self { layout, values, is_reset }
    }

    /// The columns.
    pub fn layout(&self) -> &'a Layout {
        self.layout
    }

    /// Whether nothing has happened yet.
    pub fn is_reset(&self) -> bool {
        self.is_reset
    }

    /// The values of a quantity: none if it is not among the columns, or is one of steps and this is the reset.
    pub fn of(&self, quantity: Quantity) -> &'a [f64] {
        if self.is_reset && quantity.is_of_steps() {
            return &[];
        }
        let mut start = 0;
        for block in &self.layout.blocks {
            let width = block.columns.len();
            if block.quantity == quantity {
                return self.values.get(start..start + width).unwrap_or_default();
            }
            start += width;
        }
        &[]
    }
}

/// Reads the columns of a layout.
pub struct StepReader {
    layout: Arc<Layout>,
    coordinates: Coordinates,
    feet: Vec<usize>,
    landmarks: Vec<usize>,
    reference: Reference,
    values: Vec<f64>,
}

impl StepReader {
    /// For episodes of an engine.
    pub fn new(engine: &Engine, quantities: &[Quantity]) -> Self {
        let (model, body) = (engine.model(), engine.body());
        Self {
            layout: Arc::new(Layout::of(engine, quantities)),
            coordinates: Coordinates::of(model, body),
            feet: feet(body).to_vec(),
            landmarks: (0..body.landmarks.len()).filter(|&landmark| !body.landmarks[landmark].of_scene).collect(),
            reference: Reference::new(model),
            values: Vec::new(),
        }
    }

    /// The columns.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// Reads the present step of an episode of that engine.
    pub fn read(&mut self, context: &PolicyContext<'_>) -> Row<'_> {
        let mut values = std::mem::take(&mut self.values);
        values.clear();
        let layout = Arc::clone(&self.layout);
        for block in &layout.blocks {
            let end = values.len() + block.columns.len();
            self.write(block.quantity, context, &mut values);
            // At the reset there are no terms, and an episode that met a fault has no report.
            values.resize(end, 0.0);
        }
        self.values = values;
        Row::new(&self.layout, &self.values, context.step == 0)
    }

    fn write(&mut self, quantity: Quantity, context: &PolicyContext<'_>, values: &mut Vec<f64>) {
        let snapshot = context.snapshot();
        let Snapshot { body, model, state, workspace } = snapshot;
        let report = context.episode.report();
        let muscles = body.muscles.len();
        let of_dofs = |all: &[f64]| self.coordinates.velocities.iter().map(|&dof| all[dof]).collect::<Vec<_>>();
        match quantity {
            Quantity::Excitations => values.extend(state.control.iter().take(muscles)),
            Quantity::Activations => values.extend(state.activation.iter().take(muscles)),
            // Tension is negative in the physics.
            Quantity::MuscleForces => values.extend(workspace.actuation.force.iter().take(muscles).map(|force| -force)),
            Quantity::Positions => values.extend(self.coordinates.positions.iter().map(|&place| state.position[place])),
            Quantity::Velocities => values.extend(of_dofs(&state.velocity)),
            Quantity::Torques => values.extend(of_dofs(&workspace.forces.actuator)),
            Quantity::JointReactions => {
                let dynamics = Dynamics::new(model, state, workspace);
                let force = |&joint: &usize| dynamics.joint_reaction(model, workspace, joint)[1].norm();
                values.extend(self.coordinates.joints.iter().map(force));
            }
            Quantity::Contacts => values.extend(self.contacts(&snapshot)),
            Quantity::GroundReactions => {
                values.extend(self.feet.iter().flat_map(|&foot| ground_reaction(&snapshot, foot)));
            }
            Quantity::Feet => {
                let place = |&foot: &usize| body.landmark_position(&workspace.kinematics, foot);
                values.extend(self.feet.iter().flat_map(|foot| <[f64; 3]>::from(place(foot))));
            }
            Quantity::CenterOfMass => values.extend(body.centre_of_mass(model, &workspace.kinematics).iter()),
            Quantity::MetabolicPower => values.push((0..muscles).map(|muscle| snapshot.metabolic_power(muscle)).sum()),
            // A phase of a sequence may follow none, and then has no error.
            Quantity::TrackingError => values.push(self.tracking_error(context).unwrap_or(f64::NAN)),
            Quantity::Terms => values.extend(context.weights.iter().zip(&report.terms).map(|(weight, value)| weight * value)),
            Quantity::Rewards => values.push(report.reward),
            Quantity::Observations => values.extend_from_slice(context.observation),
            Quantity::Actions => values.extend_from_slice(context.episode.action()),
        }
    }

    fn tracking_error(&mut self, context: &PolicyContext<'_>) -> Option<f64> {
        let (body, present) = (context.body, &context.workspace.kinematics);
        let reference = self.reference.kinematics(context)?;
        let square = |&landmark: &usize| {
            (body.landmark_position(present, landmark) - body.landmark_position(reference, landmark)).norm_squared()
        };
        let squares: f64 = self.landmarks.iter().map(square).sum();
        Some((squares / (3.0 * self.landmarks.len() as f64)).sqrt())
    }

    fn contacts(&self, snapshot: &Snapshot<'_>) -> Vec<f64> {
        let mut forces = vec![Vector3::zeros(); self.landmarks.len()];
        for contact in snapshot.external_contacts() {
            for (force, &landmark) in forces.iter_mut().zip(&self.landmarks) {
                if snapshot.body.holds(snapshot.model, Part::Landmark(landmark), contact.shape) {
                    *force += contact.force;
                }
            }
        }
        forces.iter().map(Vector3::norm).collect()
    }
}

/// Force, centre of pressure and free torque about the vertical of what the ground does to a foot. Where nothing presses, the centre is
/// the world's origin.
fn ground_reaction(snapshot: &Snapshot<'_>, foot: usize) -> [f64; REACTION] {
    let (mut force, mut moment, mut pressure) = (Vector3::zeros(), Vector3::zeros(), 0.0);
    let mut contacts = Vec::new();
    for contact in snapshot.external_contacts() {
        let of_foot = snapshot.body.holds(snapshot.model, Part::Landmark(foot), contact.shape);
        if of_foot && snapshot.body.holds(snapshot.model, Part::Ground, contact.other) {
            // A foot is carried, never pulled.
            let weight = if contact.force.z > 0.0 { contact.force.z } else { 0.0 };
            force += contact.force;
            moment += contact.position * weight;
            pressure += weight;
            contacts.push(contact);
        }
    }
    let centre = if pressure > 0.0 { moment / pressure } else { Vector3::zeros() };
    let torque: f64 = contacts.iter().map(|contact| (contact.position - centre).cross(&contact.force).z).sum();
    [force.x, force.y, force.z, centre.x, centre.y, centre.z, torque]
}
