//! What cannot be built, found before it is.

use super::assembly;
use super::builder::SceneBuilder;
use super::elements::{NewAttachment, NewBody, NewGeom, NewJoint};
use msk_physics::model::rotation;
use msk_physics::model::{GeomKind, JointKind, Quaternion};
use msk_program::numbers::exact;

/// What cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// A name that two things of a kind share.
    #[error("there are two {kind}s with the name `{name}`")]
    Twice {
        /// Kind of thing.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A number that is not finite, or a size that is not positive.
    #[error("the {what} of `{name}` is {}; {expected}", exact(*.value))]
    Number {
        /// Name of the thing.
        name: String,
        /// Which of its numbers.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A joint that its body cannot have.
    #[error("body `{body}` cannot have the joint `{joint}`: {reason}")]
    Joint {
        /// The body.
        body: String,
        /// The joint.
        joint: String,
        /// Why not.
        reason: &'static str,
    },
    /// What the model as a whole cannot be.
    #[error("{0}")]
    Model(String),
}

impl SceneBuilder<'_> {
    /// Refuses names, numbers and joints that no model can have.
    pub(super) fn check(&self) -> Result<(), BuildError> {
        let base = self.base;
        unique("body", &base.bodies.name, self.bodies.iter().map(|body| &body.name))?;
        unique("joint", &base.joints.name, self.joints.iter().map(|(_, joint)| &joint.name))?;
        unique("shape", &base.geoms.name, self.geoms.iter().map(|(_, geom)| &geom.name))?;
        unique("site", &base.sites.name, self.sites.iter().map(|(_, site)| &site.name))?;
        unique("equality", &base.equalities.name, self.attachments.iter().map(|attachment| &attachment.name))?;
        let alone = |attachment: &&NewAttachment| {
            let [first, second] = attachment.sites.map(|site| self.carrier_of(site));
            first == second
        };
        if let Some(attachment) = self.attachments.iter().find(alone) {
            return Err(BuildError::Model(format!("both ends of `{}` are on one body", attachment.name)));
        }
        self.bodies.iter().try_for_each(check_body)?;
        self.joints.iter().try_for_each(|(_, joint)| check_joint(joint))?;
        self.geoms.iter().try_for_each(|(_, geom)| check_geom(geom))?;
        self.sites.iter().try_for_each(|(_, site)| finite(&site.name, "position", site.position.iter()))?;
        (0..self.bodies.len()).try_for_each(|body| self.check_joints_of(body))
    }

    /// A free joint stands alone, on a child of the world; together joints have at most six degrees of freedom.
    fn check_joints_of(&self, added: usize) -> Result<(), BuildError> {
        let body = &self.bodies[added];
        let index = self.base.bodies.name.len() + added;
        let joints = || self.joints.iter().filter(|(owner, _)| *owner == index).map(|(_, joint)| joint);
        let refuse = |joint: &NewJoint, reason: &'static str| {
            Err(BuildError::Joint { body: body.name.clone(), joint: joint.name.clone(), reason })
        };
        let dofs: usize = joints().map(|joint| assembly::widths(joint.kind)[1]).sum();
        match (joints().find(|joint| joint.kind == JointKind::Free), joints().next_back()) {
            (Some(free), _) if joints().count() > 1 => refuse(free, "a free body has no other joints"),
            (Some(free), _) if body.parent != 0 => refuse(free, "only a body that is a child of the world can be free"),
            (None, Some(last)) if dofs > 6 => refuse(last, "its joints have more than six degrees of freedom together"),
            _ => Ok(()),
        }
    }
}

/// No two names but empty ones are the same.
fn unique<'n>(kind: &'static str, known: &'n [String], added: impl Iterator<Item = &'n String>) -> Result<(), BuildError> {
    let mut seen: std::collections::BTreeSet<&String> = known.iter().collect();
    for name in added {
        if !name.is_empty() && !seen.insert(name) {
            return Err(BuildError::Twice { kind, name: name.clone() });
        }
    }
    Ok(())
}

fn finite<'v>(name: &str, what: &'static str, mut values: impl Iterator<Item = &'v f64>) -> Result<(), BuildError> {
    /// Products of a few such numbers stay finite (the same bound as for files).
    const LARGEST: f64 = 1e30;
    match values.find(|value| value.is_nan() || value.abs() > LARGEST) {
        None => Ok(()),
        Some(&value) => {
            Err(BuildError::Number { name: name.into(), what, value, expected: "it must be a finite number of at most 1e30" })
        }
    }
}

fn not_negative(name: &str, what: &'static str, value: f64) -> Result<(), BuildError> {
    finite(name, what, [value].iter())?;
    if value >= 0.0 {
        return Ok(());
    }
    Err(BuildError::Number { name: name.into(), what, value, expected: "it must not be negative" })
}

fn rotation(name: &str, orientation: Quaternion) -> Result<(), BuildError> {
    if rotation::normalized(orientation) == Some(orientation) {
        return Ok(());
    }
    let value = orientation.iter().map(|part| part * part).sum::<f64>().sqrt();
    Err(BuildError::Number {
        name: name.into(),
        what: "length of the quaternion",
        value,
        expected: "orientations are unit quaternions",
    })
}

fn check_body(body: &NewBody) -> Result<(), BuildError> {
    finite(&body.name, "position", body.position.iter())?;
    rotation(&body.name, body.orientation)
}

fn check_joint(joint: &NewJoint) -> Result<(), BuildError> {
    let name = &joint.name;
    finite(name, "anchor", joint.anchor.iter())?;
    finite(name, "axis", joint.axis.iter())?;
    not_negative(name, "damping", joint.damping)?;
    not_negative(name, "stiffness", joint.stiffness)?;
    not_negative(name, "friction loss", joint.friction_loss)?;
    if rotation::unit_vector(joint.axis).is_none() {
        return Err(BuildError::Number {
            name: name.clone(),
            what: "axis' length",
            value: 0.0,
            expected: "it must not be a zero vector",
        });
    }
    if let Some([low, high]) = joint.range {
        finite(name, "range", [low, high].iter())?;
        if low >= high {
            let expected = "its upper bound must lie above its lower bound";
            return Err(BuildError::Number { name: name.clone(), what: "range's upper bound", value: high, expected });
        }
    }
    Ok(())
}

fn check_geom(geom: &NewGeom) -> Result<(), BuildError> {
    let name = &geom.name;
    finite(name, "position", geom.position.iter())?;
    finite(name, "size", geom.size.iter())?;
    rotation(name, geom.orientation)?;
    not_negative(name, "mass", geom.mass)?;
    geom.friction.iter().try_for_each(|&friction| not_negative(name, "friction", friction))?;
    if geom.kind == GeomKind::Mesh {
        return Err(BuildError::Model(format!("shape `{name}`: meshes cannot be added")));
    }
    check_heights(name, geom)?;
    match geom.size.iter().take(geom.kind.size_count()).find(|size| **size <= 0.0) {
        None => Ok(()),
        Some(&value) => Err(BuildError::Number { name: name.clone(), what: "size", value, expected: "it must be positive" }),
    }
}

/// A height field has as many samples as rows times columns, at least two by two, between 0 and 1.
fn check_heights(name: &str, geom: &NewGeom) -> Result<(), BuildError> {
    let wrong = |what: &'static str, value: f64, expected: &'static str| {
        Err(BuildError::Number { name: name.into(), what, value, expected })
    };
    let Some(field) = &geom.heights else {
        return if geom.kind == GeomKind::HeightField {
            wrong("number of heights", 0.0, "a height field needs heights")
        } else {
            Ok(())
        };
    };
    finite(name, "heights' samples", field.samples.iter())?;
    let count = field.samples.len();
    if field.rows < 2 || field.columns < 2 || field.rows.checked_mul(field.columns) != Some(count) {
        return wrong("number of heights", count as f64, "it must be rows times columns, at least 2 each");
    }
    if let Some(&sample) = field.samples.iter().find(|sample| !(0.0..=1.0).contains(*sample)) {
        return wrong("heights' sample", sample, "samples lie between 0 and 1");
    }
    match [field.radius[0], field.radius[1], field.elevation, field.base]
        .into_iter()
        .find(|extent| !(*extent > 0.0 && extent.is_finite()))
    {
        Some(extent) => wrong("extent of the heights", extent, "it must be positive"),
        None => Ok(()),
    }
}
