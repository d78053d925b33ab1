//! Bones: from each body's origin to the origins of the bodies that hang on it.

use super::camera::Camera;
use super::panel::{Item, Panel};
use super::path::Path;
use msk_runtime::body::sensors::Snapshot;
use nalgebra::Vector2;

/// Shorter ones (bodies that only carry a further axis of a joint) are not drawn, m.
const SHORTEST: f64 = 0.008;

/// Adds the skeleton.
pub(super) fn add(snapshot: &Snapshot<'_>, camera: &Camera, panel: &mut Panel) {
    let position = &snapshot.workspace.kinematics.body_position;
    let (members, parent) = (snapshot.body.members.clone(), &snapshot.model.bodies.parent);
    // Bodies without any shape at or below them are no bones but aids of the model.
    let mut carries = vec![false; members.len()];
    for &geom in &snapshot.body.shapes {
        let mut body = snapshot.model.geoms.body[geom];
        while body > members.start && !core::mem::replace(&mut carries[body - members.start], true) {
            body = parent[body];
        }
    }
    for body in members.clone().skip(1) {
        let ends = [position[parent[body]], position[body]];
        let length = (ends[1] - ends[0]).norm();
        if length < SHORTEST || !carries[body - members.start] {
            continue;
        }
        let mut path = Path::default();
        bone(camera.project(ends[0]), camera.project(ends[1]), length * 1000.0, &mut path);
        panel.add(Item::Bone { depth: camera.depth((ends[0] + ends[1]) / 2.0), path });
    }
}

/// A shaft with a knob at either end, as thick as a bone of that `length` (mm) is.
fn bone(from: Vector2<f64>, to: Vector2<f64>, length: f64, path: &mut Path) {
    let knob = (0.05 * length).clamp(2.2, 12.0);
    path.dumbbell(from, to, [knob, 0.3 * knob]);
}
