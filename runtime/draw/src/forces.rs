//! Contact forces as arrows: one resultant for every limb and what it touches.

use super::camera::Camera;
use super::path::{Bounds, Path, number};
use super::silhouette::limbs;
use core::fmt::Write;
use msk_runtime::body::sensors::Snapshot;
use msk_text::numbers::fixed;
use nalgebra::{Vector2, Vector3};
use std::collections::BTreeMap;

/// Length of the arrow of a force as large as the body's weight, mm.
const BODY_WEIGHT: f64 = 420.0;
/// Forces below this share of the body's weight are not shown.
const SMALLEST: f64 = 0.01;
/// Height of the line of a label, mm.
const LABEL: f64 = 36.0;

/// A force on the body at a point, both in the picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Arrow {
    tail: Vector2<f64>,
    head: Vector2<f64>,
    label: String,
    label_at: Vector2<f64>,
}

/// The resultants of all contacts of the body with anything else, each at its centre of pressure.
pub(super) fn arrows(snapshot: &Snapshot<'_>, camera: &Camera) -> Vec<Arrow> {
    let gravity = snapshot.model.options.gravity.norm();
    let weight = snapshot.body.mass * gravity;
    let limbs = limbs(snapshot.model, snapshot.body.members.clone());
    // Force, and the sum of points weighted by the size of their forces.
    let mut pairs: BTreeMap<[usize; 2], (Vector3<f64>, Vector3<f64>, f64)> = BTreeMap::new();
    for contact in snapshot.external_contacts() {
        let [own, other] = [contact.shape, contact.other].map(|geom| snapshot.model.geoms.body[geom]);
        let entry = pairs.entry([limbs[own - snapshot.body.members.start], other]).or_default();
        let size = contact.force.norm();
        entry.0 += contact.force;
        entry.1 += contact.position * size;
        entry.2 += size;
    }
    let mut arrows: Vec<Arrow> = pairs
        .into_values()
        .filter(|(force, _, _)| weight > 0.0 && force.norm() >= SMALLEST * weight)
        .map(|(force, moment, size)| {
            let tail = camera.project(moment / size);
            let head = tail + camera.direction(force) * (BODY_WEIGHT / 1000.0 / weight);
            Arrow { tail, head, label: format!("{} N", fixed(force.norm(), 0)), label_at: head + Vector2::new(16.0, 0.0) }
        })
        .collect();
    spread_labels(&mut arrows);
    arrows
}

/// Moves labels that would cover each other upwards.
fn spread_labels(arrows: &mut [Arrow]) {
    arrows.sort_by(|a, b| b.label_at.y.total_cmp(&a.label_at.y).then(a.label_at.x.total_cmp(&b.label_at.x)));
    for index in 1..arrows.len() {
        let (placed, rest) = arrows.split_at_mut(index);
        let Some(label) = rest.first_mut() else { continue };
        for other in placed {
            let gap = label.label_at - other.label_at;
            if gap.x.abs() < 3.5 * LABEL && gap.y.abs() < LABEL {
                label.label_at.y = other.label_at.y - LABEL;
            }
        }
    }
}

impl Arrow {
    /// The rectangle that arrow and label need.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::default();
        bounds.include(self.tail, 10.0);
        bounds.include(self.head, 10.0);
        bounds.include(self.label_at + Vector2::new(3.5 * LABEL, 0.0), 0.0);
        bounds
    }

    pub fn write_shaft(&self, out: &mut String) {
        let along = self.head - self.tail;
        let length = along.norm();
        if length < 1.0 {
            return;
        }
        let along = along / length;
        let across = Vector2::new(along.y, -along.x);
        let point = (0.5 * length).min(30.0);
        let shoulder = self.head - along * point;
        let (shaft, wing) = (across * 4.5, across * (0.42 * point));
        let mut path = Path::default();
        path.polygon(&[
            self.tail + shaft,
            shoulder + shaft,
            shoulder + wing,
            self.head,
            shoulder - wing,
            shoulder - shaft,
            self.tail - shaft,
        ]);
        // Writing to a string cannot fail.
        let _ = writeln!(out, r#"<path class="force" d="{}"/>"#, path.data());
    }

    pub fn write_label(&self, out: &mut String) {
        let (label, [x, y]) = (&self.label, [self.label_at.x, self.label_at.y].map(number));
        for class in ["halo", "force-label"] {
            let _ = writeln!(out, r#"<text class="{class}" x="{x}" y="{y}">{label}</text>"#);
        }
    }
}
