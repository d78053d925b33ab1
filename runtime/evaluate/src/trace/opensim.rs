//! A trace as files of OpenSim: tables of numbers separated by tabs, `.sto` (storage) and `.mot` (motion).
//!
//! OpenSim's ground has x forward, y up and z to the right; here the world has z up, so (x, y, z) becomes (x, z, -y). The root becomes
//! the coordinates of a pelvis: translations, and the angles tilt, list and rotation of a sequence about z, x and y of the body. Angles
//! are in degrees. Joints keep the names of the body file, so that a model with other names needs a table of both.

use super::{Quantity, Trace};
use core::fmt::Write;
use msk_physics::scalar::Real;
use msk_text::{in_one_line, numbers::exact};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// A file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenSimFile {
    /// The end of its name, such as `coordinates.mot`.
    pub name: &'static str,
    /// Its text.
    pub text: String,
}

/// Everything of a trace that OpenSim has a file for: activations, excitations, forces of muscles, coordinates, ground reactions.
pub fn opensim(trace: &Trace) -> Vec<OpenSimFile> {
    let muscles = |quantity: Quantity, name: &'static str| {
        let columns = trace.layout().block(quantity)?.columns.iter().map(|column| column.name.clone()).collect();
        let rows = trace.block(quantity).map(<[f64]>::to_vec).collect();
        Some(OpenSimFile { name, text: table(trace, name, false, columns, rows) })
    };
    let files = [
        muscles(Quantity::Activations, "activations.sto"),
        muscles(Quantity::Excitations, "controls.sto"),
        muscles(Quantity::MuscleForces, "forces.sto"),
        coordinates(trace),
        ground_reactions(trace),
    ];
    files.into_iter().flatten().collect()
}

/// A table with OpenSim's header; `degrees` tells whether angles are in degrees.
fn table(trace: &Trace, name: &str, degrees: bool, columns: Vec<String>, rows: Vec<Vec<f64>>) -> String {
    let mut text = String::new();
    let (width, in_degrees) = (columns.len() + 1, if degrees { "yes" } else { "no" });
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "{}_{name}\nversion=1\nnRows={}\nnColumns={width}\ninDegrees={in_degrees}\nendheader\ntime",
        in_one_line(&trace.origin.task),
        rows.len()
    );
    columns.iter().for_each(|column| text.extend(["\t", &in_one_line(column)]));
    text.push('\n');
    for (time, row) in trace.times().into_iter().zip(rows) {
        text.push_str(&exact(time));
        row.into_iter().for_each(|value| text.extend(["\t", &exact(value)]));
        text.push('\n');
    }
    text
}

/// A vector of the world in OpenSim's ground.
fn in_ground([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, z, -y]
}

fn coordinates(trace: &Trace) -> Option<OpenSimFile> {
    let block = trace.layout().block(Quantity::Positions)?;
    let root = block.columns.iter().position(|column| column.name == "root.x");
    // A quaternion has no place in a table of coordinates.
    let joints: Vec<usize> = (0..block.columns.len()).filter(|&place| !block.columns[place].unit.is_empty()).collect();
    let joints: Vec<usize> =
        joints.into_iter().filter(|place| root.is_none_or(|root| !(root..root + 3).contains(place))).collect();
    let pelvis = ["pelvis_tilt", "pelvis_list", "pelvis_rotation", "pelvis_tx", "pelvis_ty", "pelvis_tz"];
    let of_root = pelvis.iter().filter(|_| root.is_some()).map(|name| (*name).to_owned());
    let columns = of_root.chain(joints.iter().map(|&place| block.columns[place].name.clone())).collect();
    let axes = Matrix3::from(trace.layout().root_axes);
    let row = |values: &[f64]| {
        let mut row = Vec::new();
        if let Some(&[x, y, z, qw, qx, qy, qz]) = root.and_then(|root| values.get(root..root + 7)) {
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(qw, qx, qy, qz));
            row.extend(pelvis_angles(turn.to_rotation_matrix().into_inner() * axes));
            row.extend(in_ground([x, y, z]));
        }
        row.extend(joints.iter().map(|&place| match block.columns[place].unit.as_str() {
            "rad" => values[place].to_degrees(),
            _ => values[place],
        }));
        row
    };
    let rows = trace.block(Quantity::Positions).map(row).collect();
    Some(OpenSimFile { name: "coordinates.mot", text: table(trace, "coordinates.mot", true, columns, rows) })
}

/// Tilt, list and rotation in degrees of a root whose axes forward, left and up are the columns of `axes` in the world.
pub(super) fn pelvis_angles(axes: Matrix3<f64>) -> [f64; 3] {
    let ground = |axis: Vector3<f64>| Vector3::from(in_ground(axis.into()));
    let [forward, left, up] = [0, 1, 2].map(|column| ground(axes.column(column).into()));
    // Columns forward, up and right; R = Rz(tilt) Rx(list) Ry(rotation).
    let turn = Matrix3::from_columns(&[forward, up, -left]);
    let list = libm::asin(turn[(2, 1)].clip(-1.0, 1.0));
    let tilt = libm::atan2(-turn[(0, 1)], turn[(1, 1)]);
    let rotation = libm::atan2(-turn[(2, 0)], turn[(2, 2)]);
    [tilt, list, rotation].map(f64::to_degrees)
}

fn ground_reactions(trace: &Trace) -> Option<OpenSimFile> {
    trace.layout().block(Quantity::GroundReactions)?;
    let feet = &trace.layout().feet;
    let axes = ["x", "y", "z"];
    let columns = feet.iter().flat_map(|foot| {
        let part = move |what: &str, letter: &str| axes.map(|axis| format!("{what}_{foot}_{letter}{axis}"));
        [part("ground_force", "v"), part("ground_force", "p"), part("ground_torque", "")].into_iter().flatten()
    });
    let columns = columns.collect();
    let row = |values: &[f64]| {
        let feet = values.chunks_exact(7).flat_map(|foot| {
            let vector = |from: usize| in_ground([foot[from], foot[from + 1], foot[from + 2]]);
            [vector(0), vector(3), [0.0, foot[6], 0.0]].into_iter().flatten()
        });
        feet.collect()
    };
    let rows = trace.block(Quantity::GroundReactions).map(row).collect();
    Some(OpenSimFile { name: "ground_reactions.mot", text: table(trace, "ground_reactions.mot", false, columns, rows) })
}
