//! What does not fit when an episode begins: numbers for warnings, nothing is mended.

use msk_physics::Workspace;
use msk_physics::constraint::RowKind;
use msk_physics::model::{Equality, Model};
use msk_physics::scalar::Real;

/// Shapes that overlap by less than this count as touching, m.
const DEEPEST_TOUCH: f64 = 1e-3;

/// Residuals below this are rounding, m or rad.
const LEAST_RESIDUAL: f64 = 1e-6;

/// What does not fit when an episode begins.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StartReport {
    /// Shapes that overlap by more than a millimetre, the deepest first.
    pub penetrations: Vec<Penetration>,
    /// Couplings, connections and welds that do not hold, in the order of the model.
    pub residuals: Vec<Residual>,
}

/// Two shapes that overlap.
#[derive(Debug, Clone, PartialEq)]
pub struct Penetration {
    /// Names of the shapes.
    pub shapes: [String; 2],
    /// How deep, m.
    pub depth: f64,
}

/// Something that should hold and does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    /// The coupled joint of a coupling, or the name of the connection.
    pub name: String,
    /// What is missing: rad or m of a coupling, m between the ends of a connection.
    pub distance: f64,
    /// Angle between the axes of a weld, rad.
    pub turn: f64,
}

impl StartReport {
    /// What does not fit in a forward pass.
    pub(super) fn of(model: &Model, workspace: &Workspace<f64>) -> Self {
        // One episode has one lane.
        let Some(episode) = workspace.lanes.first() else { return Self::default() };
        let constraints = &episode.constraints;
        let name = |geom: usize| model.geoms.name[geom].clone();
        let overlapping = constraints.contacts.iter().filter(|contact| contact.distance < -DEEPEST_TOUCH);
        let mut penetrations: Vec<Penetration> =
            overlapping.map(|contact| Penetration { shapes: contact.geoms.map(name), depth: -contact.distance }).collect();
        penetrations.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        let mut residuals = Vec::new();
        for equality in 0..model.equalities.kind.len() {
            let rows = constraints.rows.kind.iter().zip(&constraints.rows.position);
            let own: Vec<f64> =
                rows.filter(|(kind, _)| **kind == RowKind::Equality(equality)).map(|(_, position)| *position).collect();
            residuals.extend(residual(model, equality, &own));
        }
        Self { penetrations, residuals }
    }
}

/// The residual of an equality from those of its rows; `None` where it holds.
fn residual(model: &Model, equality: usize, rows: &[f64]) -> Option<Residual> {
    let norm = |part: &[f64]| part.iter().map(|row| row * row).sum::<f64>().sqrt();
    let places = rows.len().min(3);
    let (distance, sine) = (norm(&rows[..places]), norm(&rows[places..]));
    let (name, turn) = match &model.equalities.kind[equality] {
        Equality::Joint(coupling) => (model.joints.name[model.couplings.joint[*coupling]].clone(), 0.0),
        // The rows of a weld's turn are half its sine, weighted.
        Equality::Weld { torque_scale, .. } if *torque_scale > 0.0 => {
            (model.equalities.name[equality].clone(), 2.0 * libm::asin((sine / torque_scale).at_most(1.0)))
        }
        _ => (model.equalities.name[equality].clone(), 0.0),
    };
    (distance > LEAST_RESIDUAL || turn > LEAST_RESIDUAL).then_some(Residual { name, distance, turn })
}
