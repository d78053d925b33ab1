//! The names of a body before the class of a task.

use crate::sensors::Measured;
use crate::text::{flat, laid_out, number, quoted, tuple};
use msk_physics::model::Model;
use nalgebra::Vector3;
use std::fmt::Write;

/// The anatomy that signals need, as an assignment in a class.
pub(crate) fn anatomy(measured: &Measured<'_>) -> String {
    let (body, model) = (measured.body, measured.model);
    let name = |body: usize| quoted(&model.bodies.name[body]);
    let mut text = format!("    anatomy = Anatomy(\n        root={},\n", name(body.root.body));
    if !body.carried.is_empty() {
        let carried: Vec<String> = body.carried.iter().map(|&carried| name(carried)).collect();
        let _ = writeln!(text, "        carried={},", tuple(&carried, 16, 8));
    }
    text += "        landmarks={\n";
    let rooted = ("the root".to_owned(), body.root.body, Vector3::zeros(), body.root.axes, &[] as &[usize]);
    let landmarks = measured.landmarks.iter().map(|&index| {
        let landmark = &body.landmarks[index];
        (landmark.name.clone(), landmark.body, landmark.point, landmark.axes, landmark.segment.as_slice())
    });
    for (label, carrier, point, axes, segment) in landmarks.chain([rooted]) {
        let mut parts = vec![name(carrier)];
        if point != Vector3::zeros() {
            parts.push(format!("point={}", triple(point.as_slice())));
        }
        if axes != nalgebra::Matrix3::identity() {
            let columns: Vec<String> = axes.column_iter().map(|column| triple(column.clone_owned().as_slice())).collect();
            parts.push(format!("axes=({})", columns.join(", ")));
        }
        if !segment.is_empty() {
            parts.push(format!("segment={}", shapes(model, segment)));
        }
        let landmark = format!("Landmark({})", parts.join(", "));
        let _ = writeln!(text, "            {}: {},", quoted(&label), laid_out(&landmark, 15 + label.len(), 12));
    }
    text += "        },\n";
    if !measured.groups.is_empty() {
        text += "        groups={\n";
        for &index in &measured.groups {
            let group = &body.groups[index];
            let members: Vec<String> = group.members.iter().map(|&member| quoted(&body.landmarks[member].name)).collect();
            let _ = writeln!(text, "            {}: {},", quoted(&group.name), tuple(&members, 40, 12));
        }
        text += "        },\n";
    }
    let joints = measured.joints.iter().map(|&index| &body.joints[index]);
    let renamed: Vec<String> = joints
        .filter(|joint| model.joints.name[joint.index] != joint.name)
        .map(|joint| format!("{}: {}", quoted(&joint.name), quoted(&model.joints.name[joint.index])))
        .collect();
    if !renamed.is_empty() {
        let _ = writeln!(text, "        joints={},", laid_out(&format!("{{{}}}", renamed.join(", ")), 16, 8));
    }
    let _ = writeln!(text, "        ground={},\n    )", laid_out(&shapes(model, &body.ground), 16, 8));
    text
}

fn triple(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|&value| number(value)).collect();
    format!("({})", numbers.join(", "))
}

/// Shapes by name; by number those that have none.
fn shapes(model: &Model, shapes: &[usize]) -> String {
    let name = |&geom: &usize| match model.geoms.name[geom].as_str() {
        "" => geom.to_string(),
        name => quoted(name),
    };
    flat(&shapes.iter().map(name).collect::<Vec<_>>())
}
