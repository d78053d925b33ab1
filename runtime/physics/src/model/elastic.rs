//! What turns the muscles of a model into fibres and tendons in series.

use super::Model;
use crate::scalar::Real;
use serde::{Deserialize, Serialize};

/// Elastic tendons for all muscles of a model: a choice of curves and four figures, each with its source.
///
/// Optimal fibre length L0 and tendon slack length LT of each muscle follow from its operating range, as MuJoCo's muscle
/// derives them: path = LT + (scaled length) L0 at both ends of `lengthrange` with the scaled lengths of `range`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ElasticTendons {
    /// Curves of the fibre.
    pub curves: FibreCurves,
    /// Strain of the tendon at peak isometric force. Millard et al. 2013: 0.049; Thelen 2003: 0.033 for young adults.
    pub strain: f64,
    /// Damping of the fibre in units of peak force per maximal shortening velocity. Millard et al. 2013: 0.1.
    pub damping: f64,
    /// Least length that stretches like tendon, as a share of the path in the middle of its range. Fibres insert into
    /// sheets of tendon within the muscle, so that no path is wholly stiff; and the range of many muscles of the trunk puts
    /// LT at or below zero, where it is an offset of the fibre and no length that could stretch (`docs/elastic-tendons.md`).
    pub least: f64,
    /// Pennation angle at optimal fibre length, rad, by muscle; muscles that are not listed have none.
    pub pennation: Vec<(String, f64)>,
}

/// Curves of a fibre: active force over length and velocity, passive force over length.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FibreCurves {
    /// The closed forms of De Groote et al. 2016, fitted to the curves of Millard et al. 2013.
    #[default]
    Published,
    /// Those of the model's rigid muscles: with stiff tendons nothing changes.
    Model,
}

impl Default for ElasticTendons {
    fn default() -> Self {
        Self { curves: FibreCurves::default(), strain: 0.049, damping: 0.1, least: 0.1, pennation: Vec::new() }
    }
}

/// A figure of elastic tendons that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ElasticError {
    /// Out of range.
    #[error("`{name}` of elastic tendons is {value}; it lies between {low} and {high}")]
    Range {
        /// The figure.
        name: &'static str,
        /// What was given.
        value: f64,
        /// Smallest value that makes sense.
        low: f64,
        /// Largest value that makes sense.
        high: f64,
    },
    /// Pennation of a muscle that the model does not have.
    #[error("elastic tendons give a pennation angle to `{muscle}`, which the model does not have")]
    Muscle {
        /// The name.
        muscle: String,
    },
}

impl ElasticTendons {
    /// Whether all figures make sense for a model with muscles of these names.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self, muscles: &[String]) -> Result<(), ElasticError> {
        let within = |name, value: f64, low, high| {
            let good = low <= value && value <= high;
            if good { Ok(()) } else { Err(ElasticError::Range { name, value, low, high }) }
        };
        within("strain", self.strain, 1e-6, 0.5)?;
        within("damping", self.damping, 1e-6, 10.0)?;
        within("least", self.least, 1e-3, 1.0)?;
        for (muscle, angle) in &self.pennation {
            if !muscles.contains(muscle) {
                return Err(ElasticError::Muscle { muscle: muscle.clone() });
            }
            within("pennation", *angle, 0.0, 1.2)?;
        }
        Ok(())
    }
}

impl ElasticTendons {
    /// Length of tendon that stretches, m: the slack length, or the least share of the path in the middle of its range.
    pub fn stretching_length(&self, slack: f64, [shortest, longest]: [f64; 2]) -> f64 {
        slack.at_least(self.least * 0.5 * (shortest + longest))
    }
}

impl Model {
    /// The model with elastic tendons.
    ///
    /// # Errors
    /// A figure that makes no sense.
    pub fn with_elastic_tendons(mut self, settings: ElasticTendons) -> Result<Self, ElasticError> {
        settings.check(&self.actuators.name)?;
        self.elastic_tendons = Some(settings);
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_that_make_no_sense_are_refused_by_name() {
        let muscles = ["soleus".to_owned()];
        let with = |change: &dyn Fn(&mut ElasticTendons)| {
            let mut settings = ElasticTendons::default();
            change(&mut settings);
            settings.check(&muscles).map_err(|error| error.to_string())
        };
        assert_eq!(with(&|s| s.pennation = vec![("soleus".into(), 0.4)]), Ok(()));
        assert_eq!(with(&|s| s.strain = 0.0).unwrap_err(), "`strain` of elastic tendons is 0; it lies between 0.000001 and 0.5");
        assert!(with(&|s| s.damping = f64::NAN).unwrap_err().starts_with("`damping` of elastic tendons is NaN"));
        assert!(with(&|s| s.pennation = vec![("solus".into(), 0.4)]).unwrap_err().contains("`solus`"));
    }
}
