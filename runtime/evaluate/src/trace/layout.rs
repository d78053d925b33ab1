//! The columns of a trace.

use super::Quantity;
use crate::room::{NoRoom, ensure_room};
use msk_physics::model::{JointKind, Model};
use msk_program::task::CompiledTask;
use msk_program::vocabulary::GroupKind;
use msk_runtime::body::Body;
use msk_runtime::episode::Engine;
use msk_text::numbers::exact;
use serde::{Deserialize, Serialize};

/// A column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its name within its block.
    pub name: String,
    /// Unit of its values; empty for dimensionless ones.
    pub unit: String,
}

/// The columns of one quantity.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Block {
    /// What they are.
    pub quantity: Quantity,
    /// Their names and units.
    pub columns: Vec<Column>,
}

/// A muscle of the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Muscle {
    /// Its name.
    pub name: String,
    /// Its recruitment family; empty if it belongs to none.
    pub family: String,
    /// Peak isometric force, N.
    pub peak_force: f64,
}

/// The columns of a trace, and what of task and body their evaluation needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Length of a control step, s.
    pub period: f64,
    /// Mass of the body without what it carries, kg.
    pub mass: f64,
    /// Size of gravity, m/s².
    pub gravity: f64,
    /// Axes forward, left and up of the root in its own frame, one after the other.
    pub root_axes: [[f64; 3]; 3],
    /// Recruitment families, in the order of their first muscles.
    pub families: Vec<String>,
    /// Muscles, in the order of the body.
    pub muscles: Vec<Muscle>,
    /// Names of the feet: the landmarks of the body's group `feet`.
    pub feet: Vec<String>,
    /// Blocks, in the order of [`Quantity::ALL`].
    pub blocks: Vec<Block>,
}

/// The group of landmarks that stand and walk.
const FEET: &str = "feet";

/// The landmarks on which a body walks; none if it has no group of that name.
pub(super) fn feet(body: &Body) -> &[usize] {
    let group = body.groups.iter().find(|group| group.name == FEET && group.kind == GroupKind::Landmarks);
    group.map_or(&[], |group| &group.members)
}

/// Degrees of freedom, or coordinates, of a body's own joints: what of the model, with name and unit.
pub(super) struct Coordinates {
    pub positions: Vec<usize>,
    pub velocities: Vec<usize>,
    position_columns: Vec<Column>,
    velocity_columns: Vec<Column>,
    torque_columns: Vec<Column>,
    /// Joints of the model, one for each reaction.
    pub joints: Vec<usize>,
    joint_columns: Vec<Column>,
}

fn column(name: impl Into<String>, unit: &str) -> Column {
    Column { name: name.into(), unit: unit.to_owned() }
}

impl Coordinates {
    /// Of the joints of a body, its root first as in the model; joints of objects that it carries are left out.
    pub fn of(model: &Model, body: &Body) -> Self {
        let mut all = Self {
            positions: Vec::new(),
            velocities: Vec::new(),
            position_columns: Vec::new(),
            velocity_columns: Vec::new(),
            torque_columns: Vec::new(),
            joints: Vec::new(),
            joint_columns: Vec::new(),
        };
        for joint in (0..model.joints.name.len()).filter(|&joint| body.owns(model.joints.body[joint])) {
            all.add(model, body, joint);
        }
        all
    }

    fn add(&mut self, model: &Model, body: &Body, joint: usize) {
        let (position, dof) = (model.joints.position_address[joint], model.joints.dof_address[joint]);
        // Names of tasks where there is one, else those of the model.
        let known = body.joints.iter().find(|known| known.index == joint).map(|known| known.name.clone());
        let name = known.unwrap_or_else(|| model.joints.name[joint].clone());
        let (axes, quaternion) = (["x", "y", "z"], ["qw", "qx", "qy", "qz"]);
        let (mut positions, mut velocities, mut torques) = (Vec::new(), Vec::new(), Vec::new());
        let linear = |of: &str| axes.map(|axis| format!("{of}.{axis}"));
        match model.joints.kind[joint] {
            JointKind::Hinge => {
                positions.push(column(&name, "rad"));
                velocities.push(column(&name, "rad/s"));
                torques.push(column(&name, "N m"));
            }
            JointKind::Slide => {
                positions.push(column(&name, "m"));
                velocities.push(column(&name, "m/s"));
                torques.push(column(&name, "N"));
            }
            JointKind::Ball => {
                positions.extend(quaternion.map(|part| column(format!("{name}.{part}"), "")));
                velocities.extend(linear(&name).map(|name| column(name, "rad/s")));
                torques.extend(linear(&name).map(|name| column(name, "N m")));
            }
            JointKind::Free => {
                let name = "root";
                positions.extend(linear(name).map(|name| column(name, "m")));
                positions.extend(quaternion.map(|part| column(format!("{name}.{part}"), "")));
                velocities.extend(linear("root.velocity").map(|name| column(name, "m/s")));
                velocities.extend(linear("root.angular_velocity").map(|name| column(name, "rad/s")));
                torques.extend(linear("root.force").map(|name| column(name, "N")));
                torques.extend(linear("root.torque").map(|name| column(name, "N m")));
            }
        }
        self.positions.extend(position..position + positions.len());
        self.velocities.extend(dof..dof + velocities.len());
        self.position_columns.extend(positions);
        self.velocity_columns.extend(velocities);
        self.torque_columns.extend(torques);
        if model.joints.kind[joint] != JointKind::Free {
            self.joints.push(joint);
            self.joint_columns.push(column(name, "N"));
        }
    }
}

impl Layout {
    /// Checks, before an episode of `task` begins, that there is room for `steps` rows.
    ///
    /// # Errors
    /// More than [`MOST_BYTES`](crate::MOST_BYTES).
    pub fn ensure_room(&self, task: &CompiledTask, steps: u32) -> Result<(), NoRoom> {
        let width: usize = self.blocks.iter().map(|block| block.columns.len()).sum();
        ensure_room(task, steps, width * size_of::<f64>())
    }

    /// The columns of `quantities` for the episodes of an engine.
    pub fn of(engine: &Engine, quantities: &[Quantity]) -> Self {
        let (model, body, task) = (engine.model(), engine.body(), engine.task());
        let coordinates = Coordinates::of(model, body);
        let mut families: Vec<String> = Vec::new();
        for muscle in body.muscles.iter().filter(|muscle| !muscle.family.is_empty()) {
            if !families.contains(&muscle.family) {
                families.push(muscle.family.clone());
            }
        }
        let muscle = |muscle: &msk_runtime::body::Muscle| Muscle {
            name: muscle.name.clone(),
            family: muscle.family.clone(),
            peak_force: muscle.peak_force,
        };
        let muscles: Vec<Muscle> = body.muscles.iter().map(muscle).collect();
        let landmark = |index: &usize| body.landmarks[*index].name.clone();
        let feet: Vec<String> = feet(body).iter().map(landmark).collect();
        let of_muscles = |unit: &str| muscles.iter().map(|muscle| column(&muscle.name, unit)).collect();
        let columns = |quantity: Quantity| -> Vec<Column> {
            match quantity {
                Quantity::Excitations | Quantity::Activations => of_muscles(""),
                Quantity::MuscleForces => of_muscles("N"),
                Quantity::Positions => coordinates.position_columns.clone(),
                Quantity::Velocities => coordinates.velocity_columns.clone(),
                Quantity::Torques => coordinates.torque_columns.clone(),
                Quantity::JointReactions => coordinates.joint_columns.clone(),
                Quantity::Contacts => {
                    let own = body.landmarks.iter().filter(|landmark| !landmark.of_scene);
                    own.map(|landmark| column(&landmark.name, "N")).collect()
                }
                Quantity::GroundReactions => feet.iter().flat_map(|foot| ground_reaction(foot)).collect(),
                Quantity::Feet => feet.iter().flat_map(|foot| vector(foot, "m")).collect(),
                Quantity::CenterOfMass => vector("com", "m").to_vec(),
                Quantity::MetabolicPower => vec![column("muscles", "W")],
                Quantity::TrackingError if task.motions.is_empty() => vec![],
                Quantity::TrackingError => vec![column("landmarks", "m")],
                Quantity::Terms => task.terms.iter().map(|term| column(&term.name, "")).collect(),
                Quantity::Rewards => vec![column("reward", "")],
                Quantity::Observations => {
                    let channels = task.channels.iter().flat_map(|channel| {
                        (0..channel.size).map(move |element| match channel.size {
                            1 => column(&channel.name, &channel.unit),
                            _ => column(format!("{}[{element}]", channel.name), &channel.unit),
                        })
                    });
                    channels.collect()
                }
                Quantity::Actions => task.action.names(&task.vocabulary).into_iter().map(|name| column(name, "")).collect(),
            }
        };
        let wanted = Quantity::ALL.into_iter().filter(|quantity| quantities.contains(quantity));
        let blocks = wanted.map(|quantity| Block { quantity, columns: columns(quantity) });
        Self {
            period: engine.control_period(),
            mass: body.mass,
            gravity: model.options.gravity.norm(),
            root_axes: body.root.axes.into(),
            families,
            blocks: blocks.filter(|block| !block.columns.is_empty()).collect(),
            muscles,
            feet,
        }
    }

    /// Why a file that says so is no layout, in words that continue "its layout": what reads a trace counts on all of this.
    pub(super) fn wrong(&self) -> Option<String> {
        if !(self.period > 0.0 && self.period.is_finite()) {
            return Some(format!("has a control step of {} s", exact(self.period)));
        }
        for (place, block) in self.blocks.iter().enumerate() {
            let (name, found) = (block.quantity.name(), block.columns.len());
            if self.place(block.quantity) != Some(place) {
                return Some(format!("has `{name}` twice"));
            }
            let expected = match block.quantity {
                Quantity::Excitations | Quantity::Activations | Quantity::MuscleForces => self.muscles.len(),
                Quantity::GroundReactions => 7 * self.feet.len(),
                Quantity::Feet => 3 * self.feet.len(),
                Quantity::CenterOfMass => 3,
                Quantity::MetabolicPower | Quantity::TrackingError | Quantity::Rewards => 1,
                _ => found,
            };
            if found != expected || found == 0 {
                return Some(format!("has {found} columns of `{name}`, expected {}", expected.max(1)));
            }
        }
        None
    }

    /// The block of a quantity; `None` if it is not among the columns, or has none.
    pub fn block(&self, quantity: Quantity) -> Option<&Block> {
        self.place(quantity).map(|place| &self.blocks[place])
    }

    /// Which block that is.
    pub(super) fn place(&self, quantity: Quantity) -> Option<usize> {
        self.blocks.iter().position(|block| block.quantity == quantity)
    }

    /// Number of columns of a quantity; 0 if it is not there.
    pub fn width(&self, quantity: Quantity) -> usize {
        self.block(quantity).map_or(0, |block| block.columns.len())
    }

    /// Weight of the body, N.
    pub fn weight(&self) -> f64 {
        self.mass * self.gravity
    }
}

fn vector(of: &str, unit: &str) -> [Column; 3] {
    ["x", "y", "z"].map(|axis| column(format!("{of}.{axis}"), unit))
}

/// The columns of a foot: force, centre of pressure, free torque about the vertical.
fn ground_reaction(foot: &str) -> Vec<Column> {
    let force = vector(&format!("{foot}.force"), "N");
    let pressure = vector(&format!("{foot}.pressure"), "m");
    force.into_iter().chain(pressure).chain([column(format!("{foot}.torque"), "N m")]).collect()
}
