//! Muscle conditions: declared differences between a body's muscles and healthy, fresh ones.
//!
//! They are plain data beside the body, not an edit of it: the task, its vocabulary and its weights mean what they always
//! meant, and the results name the condition under which they were reached.
//!
//! * [`Weakness`] scales the active force of muscles; their passive tissue and tendons stay.
//! * [`Fatigue`] lets what a muscle can recruit run down with use and recover with rest ([`Compartments`]).

mod fatigue;

pub use fatigue::{Compartments, Fatigue};

use crate::body::Body;
use crate::library::BoundBody;
use msk_physics::model::Model;
use msk_program::digest::hexadecimal;
use msk_program::numbers::exact;
use msk_program::vocabulary::GroupKind;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt;

/// Conditions of a body's muscles. The default is none: healthy and fresh.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MuscleCondition {
    /// Weaknesses, one after the other: a muscle named by two has the product of both factors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub weakness: Vec<Weakness>,
    /// Fatigue of all muscles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fatigue: Option<Fatigue>,
}

/// Muscles that bring up only a part of their active force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weakness {
    /// A muscle, or a group of muscles; all muscles if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub muscles: Option<String>,
    /// Their active force over that of the healthy muscle, 0 to 1; sarcopenia is often modelled by 0.5.
    pub factor: f64,
}

/// A condition that a body cannot have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ConditionError {
    /// A factor or rate out of range.
    #[error("the {what} of a muscle condition is {}; it must be between 0 and {}", exact(*.value), exact(*.high))]
    Range {
        /// Which figure.
        what: &'static str,
        /// What was given.
        value: f64,
        /// Largest value that makes sense.
        high: f64,
    },
    /// Neither a muscle nor a group of muscles.
    #[error("the body `{body}` has no muscle or group of muscles `{name}`{}", hint(.nearest))]
    Unknown {
        /// The body.
        body: String,
        /// The name.
        name: String,
        /// The name most like it.
        nearest: Option<String>,
    },
}

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

/// As the command line takes it: `weakness 0.5, weakness calves=0.5, fatigue`; `none` if there is nothing to declare.
impl fmt::Display for MuscleCondition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let weakness = self.weakness.iter().map(|Weakness { muscles, factor }| match muscles {
            Some(muscles) => format!("weakness {muscles}={}", exact(*factor)),
            None => format!("weakness {}", exact(*factor)),
        });
        let fatigue = self.fatigue.iter().map(|fatigue| match *fatigue == Fatigue::default() {
            true => "fatigue".to_owned(),
            false => format!("fatigue {}/{}/{}", exact(fatigue.fatigue), exact(fatigue.recovery), exact(fatigue.rest)),
        });
        let parts: Vec<String> = weakness.chain(fatigue).collect();
        f.write_str(if parts.is_empty() { "none" } else { "" })?;
        f.write_str(&parts.join(", "))
    }
}

impl MuscleCondition {
    /// Whether there is nothing to declare.
    pub fn is_none(&self) -> bool {
        self.weakness.is_empty() && self.fatigue.is_none()
    }

    /// The strength of every muscle of `body`: its active force over that of the healthy muscle.
    ///
    /// # Errors
    /// A factor outside of 0..1, or a name that is neither a muscle nor a group of muscles.
    pub fn strengths(&self, body: &Body) -> Result<Vec<f64>, ConditionError> {
        let mut strengths = vec![1.0; body.muscles.len()];
        for Weakness { muscles, factor } in &self.weakness {
            within("strength", *factor, 1.0)?;
            for muscle in select(body, muscles.as_deref())? {
                strengths[muscle] *= factor;
            }
        }
        Ok(strengths)
    }
}

fn within(what: &'static str, value: f64, high: f64) -> Result<(), ConditionError> {
    if (0.0..=high).contains(&value) { Ok(()) } else { Err(ConditionError::Range { what, value, high }) }
}

/// The muscles of a name; all without one.
fn select(body: &Body, name: Option<&str>) -> Result<Vec<usize>, ConditionError> {
    let Some(name) = name else { return Ok((0..body.muscles.len()).collect()) };
    let groups = || body.groups.iter().filter(|group| group.kind == GroupKind::Muscles);
    if let Some(group) = groups().find(|group| group.name == name) {
        return Ok(group.members.clone());
    }
    if let Some(muscle) = body.muscles.iter().position(|muscle| muscle.name == name) {
        return Ok(vec![muscle]);
    }
    let known = groups().map(|group| group.name.as_str()).chain(body.muscles.iter().map(|muscle| muscle.name.as_str()));
    let likeness = |candidate: &&str| strsim::jaro_winkler(name, candidate);
    let nearest = known.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).filter(|candidate| likeness(candidate) > 0.75);
    Err(ConditionError::Unknown { body: body.name.clone(), name: name.to_owned(), nearest: nearest.map(str::to_owned) })
}

impl BoundBody {
    /// This body under a condition: its hash tells it from the healthy one.
    ///
    /// # Errors
    /// A condition that this body cannot have.
    pub fn under(&self, condition: &MuscleCondition) -> Result<Self, ConditionError> {
        if let Some(fatigue) = &condition.fatigue {
            fatigue.check()?;
        }
        let strengths = condition.strengths(&self.body)?;
        if condition.is_none() {
            return Ok(self.clone());
        }
        let mut hasher = Sha256::new();
        hasher.update(self.hash());
        // Plain data of strings and numbers always has a JSON form.
        hasher.update(serde_json::to_vec(condition).unwrap_or_default());
        let hash = hexadecimal(&hasher.finalize()[..16]);
        Ok(self.changed(weakened(&self.model, &strengths), condition.clone(), hash))
    }
}

fn weakened(model: &Model, strengths: &[f64]) -> Model {
    let mut model = model.clone();
    for (muscle, strength) in strengths.iter().enumerate() {
        model.actuators.scale_strength(muscle, *strength);
    }
    model
}
