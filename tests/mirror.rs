//! The human body in a mirror: mirrored states have mirrored accelerations, as far as the model's figures are symmetric.
//!
//! `MSK_UPDATE=1 cargo test --test parity mirror` writes what is found to `docs/mirror.md`; without it the page must be as found.

use crate::support;

use core::fmt::Write;
use msk_physics::model::{JointKind, Model};
use msk_physics::{self as physics, State, Workspace, kinematics};
use nalgebra::Vector3;
use support::{SplitMix, draw, page, repository};

/// The model with its sides exchanged: for every joint and muscle the one on the other side, for joints also the sign.
struct Mirror {
    model: Model,
    joint: Vec<(usize, f64)>,
    muscle: Vec<usize>,
}

fn other_side(name: &str) -> String {
    if let Some(stem) = name.strip_suffix("_left") {
        stem.to_owned()
    } else if let Some(stem) = name.strip_suffix("_r") {
        format!("{stem}_l")
    } else if let Some(stem) = name.strip_suffix("_l") {
        format!("{stem}_r")
    } else {
        format!("{name}_left")
    }
}

/// The body's lateral axis is the world's x: a vector turns its x, an axis of rotation its y and z.
fn reflected(vector: Vector3<f64>, rotation: bool) -> Vector3<f64> {
    let image = Vector3::new(-vector.x, vector.y, vector.z);
    if rotation { -image } else { image }
}

impl Mirror {
    fn new() -> Self {
        let model = Model::from_file(repository("bodies/models/human416.xml")).unwrap();
        let mut frames = kinematics::Kinematics::new(&model);
        kinematics::update(&model, &State::<f64>::new(&model), &mut frames);
        let find = |names: &[String], name: &str| names.iter().position(|known| *known == other_side(name));
        let joint = (0..model.joints.name.len()).map(|joint| {
            // A joint in the middle is its own mirror image.
            let partner = find(&model.joints.name, &model.joints.name[joint]).unwrap_or(joint);
            let rotation = model.joints.kind[joint] != JointKind::Slide;
            let cosine = frames.joint_axis[partner].dot(&reflected(frames.joint_axis[joint], rotation));
            (partner, cosine.signum())
        });
        let muscle =
            model.actuators.name.iter().map(|name| find(&model.actuators.name, name).expect("every muscle has a partner"));
        Self { joint: joint.collect(), muscle: muscle.collect(), model }
    }

    /// The mirror image of a vector over dofs.
    fn dofs(&self, values: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; values.len()];
        let joints = &self.model.joints;
        for (joint, &(partner, sign)) in self.joint.iter().enumerate() {
            let (from, to) = (joints.dof_address[joint], joints.dof_address[partner]);
            if joints.kind[joint] == JointKind::Free {
                let signs = [-1.0, 1.0, 1.0, 1.0, -1.0, -1.0];
                (0..6).for_each(|axis| image[from + axis] = signs[axis] * values[from + axis]);
            } else {
                image[to] = sign * values[from];
            }
        }
        image
    }

    fn state(&self, state: &State<f64>) -> State<f64> {
        let mut image = state.clone();
        let joints = &self.model.joints;
        for (joint, &(partner, sign)) in self.joint.iter().enumerate() {
            let (from, to) = (joints.position_address[joint], joints.position_address[partner]);
            if joints.kind[joint] == JointKind::Free {
                let signs = [-1.0, 1.0, 1.0, 1.0, 1.0, -1.0, -1.0];
                (0..7).for_each(|axis| image.position[from + axis] = signs[axis] * state.position[from + axis]);
            } else {
                image.position[to] = sign * state.position[from];
            }
        }
        image.velocity = self.dofs(&state.velocity);
        for (muscle, &partner) in self.muscle.iter().enumerate() {
            image.activation[partner] = state.activation[muscle];
        }
        image
    }
}

#[test]
fn a_mirrored_state_has_a_mirrored_acceleration() {
    let mirror = Mirror::new();
    let model = &mirror.model;
    let (mut here, mut there) = (Workspace::new(model), Workspace::new(model));
    let mut random = SplitMix(12);
    let mut lengths = vec![0.0_f64; model.actuators.name.len()];
    let (mut forces, mut accelerations, mut masses) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..20 {
        let mut state = draw(model, &mut random);
        state.applied_force.fill(0.0);
        state.body_force.fill([Vector3::zeros(); 2]);
        physics::smooth(model, &state, &mut here);
        physics::smooth(model, &mirror.state(&state), &mut there);
        for (muscle, &partner) in mirror.muscle.iter().enumerate() {
            let error = (here.actuation.length[muscle] - there.actuation.length[partner]).abs();
            lengths[muscle] = lengths[muscle].max(error);
        }
        // On the scale of each dof's inertia, of the largest.
        let roots: Vec<f64> = model.dofs.row.iter().map(|row| here.inertia.matrix[row.end - 1].sqrt()).collect();
        let compare = |here: &[f64], there: &[f64], power: i32| {
            let image = mirror.dofs(here);
            let scaled =
                |values: &[f64]| values.iter().zip(&roots).map(|(value, root)| value * root.powi(power)).collect::<Vec<_>>();
            let (image, there) = (scaled(&image), scaled(there));
            let largest = image.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            image.iter().zip(&there).map(|(a, b)| (a - b).abs() / largest).fold(0.0, f64::max)
        };
        forces = forces.max(compare(&here.forces.actuator, &there.forces.actuator, -1));
        accelerations = accelerations.max(compare(&here.forces.smooth_acceleration, &there.forces.smooth_acceleration, 1));
        let there_mass: Vec<f64> = model.dofs.row.iter().map(|row| there.inertia.matrix[row.end - 1]).collect();
        for (joint, &(partner, _)) in
            mirror.joint.iter().enumerate().filter(|(joint, _)| model.joints.kind[*joint] != JointKind::Free)
        {
            let [a, b] = [joint, partner].map(|joint| model.joints.dof_address[joint]);
            masses = masses.max((here.inertia.matrix[model.dofs.row[a].end - 1] / there_mass[b] - 1.0).abs());
        }
    }
    let mut text = String::from(
        "# The human body in a mirror\n\nWritten by `MSK_UPDATE=1 cargo test --test parity mirror`, from 20 random states of the whole body and their mirror images\n\
         (joints up to a tenth of their range beyond it, random velocities and activations).\n\n",
    );
    let _ = writeln!(text, "| quantity | largest difference between a state and its mirror image |\n|---|---|");
    let _ = writeln!(text, "| diagonal of the mass matrix | {masses:.1e} of itself |");
    let _ = writeln!(text, "| generalised muscle forces | {forces:.1e} of the largest |");
    let _ = writeln!(text, "| accelerations without constraints | {accelerations:.1e} of the largest |");
    let mut broken: Vec<(usize, f64)> = lengths.iter().copied().enumerate().filter(|(_, error)| *error > 1e-4).collect();
    broken.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let close = lengths.iter().filter(|error| **error <= 1e-6).count();
    let _ = writeln!(
        text,
        "\n{close} of {} muscles have the length of their partner within a micrometre; {} differ by more than 0.1 mm:\n",
        lengths.len(),
        broken.len()
    );
    if !broken.is_empty() {
        let _ = writeln!(text, "| muscle | difference of length, mm |\n|---|---|");
    }
    for (muscle, error) in &broken {
        let _ = writeln!(text, "| {} | {:.2} |", model.actuators.name[*muscle], 1e3 * error);
    }
    page("mirror", &text);
}
