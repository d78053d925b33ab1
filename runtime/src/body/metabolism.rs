//! Metabolic power of muscles after Bhargava, Pandy and Anderson, "A phenomenological model for estimating metabolic energy
//! consumption in muscle contraction", J. Biomech. 37 (2004).
//!
//! Power is activation heat + maintenance heat + shortening heat + work. As OpenSim's probe of this model has it, the decay of the
//! activation heat is left out, heat is at least 1 W per kilogram of muscle, and power is not negative: a muscle that is stretched does
//! not store what it absorbs. The basal rate of the body is not part of it. Half of the fibres of every muscle are slow.

use msk_physics::scalar::Real;

/// Share of slow fibres.
const SLOW: f64 = 0.5;
/// Activation heat of slow and fast fibres, W/kg.
const ACTIVATION: [f64; 2] = [40.0, 133.0];
/// Maintenance heat of slow and fast fibres, W/kg.
const MAINTENANCE: [f64; 2] = [74.0, 111.0];
/// Shortening heat per velocity, of the isometric force and of the force; and of the force of a fibre that lengthens.
const SHORTENING: [f64; 2] = [0.16, 0.18];
const LENGTHENING: f64 = 0.157;
/// Least heat, W/kg.
const LEAST_HEAT: f64 = 1.0;
/// Specific tension, Pa, and density, kg/m³, of muscle. The tension is that by which Rajagopal et al. (IEEE Trans. Biomed. Eng. 63, 2016)
/// made peak forces of muscle volumes: the muscles of the embedded body then weigh 31 kg together.
const TENSION: f64 = 0.6e6;
const DENSITY: f64 = 1059.7;

/// A muscle at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contraction {
    /// Peak isometric force, N.
    pub peak_force: f64,
    /// Optimal fibre length, m.
    pub optimal_length: f64,
    /// Fibre length over the optimal one.
    pub length: f64,
    /// Rate at which the fibre lengthens, m/s.
    pub velocity: f64,
    pub excitation: f64,
    pub activation: f64,
    /// Active force of the fibre, N.
    pub force: f64,
    /// Active force at this activation if the fibre kept its length, N.
    pub isometric_force: f64,
}

impl Contraction {
    /// Mass of the muscle: volume, its cross-section times its length, times density, kg.
    pub fn mass(&self) -> f64 {
        self.peak_force / TENSION * self.optimal_length * DENSITY
    }

    /// Metabolic power, W.
    pub fn metabolic_power(&self) -> f64 {
        let mass = self.mass();
        let activation = recruited(self.excitation, ACTIVATION) * mass;
        let maintenance = by_length(self.length) * recruited(self.activation, MAINTENANCE) * mass;
        let per_velocity = match self.velocity < 0.0 {
            true => SHORTENING[0] * self.isometric_force + SHORTENING[1] * self.force,
            false => LENGTHENING * self.force,
        };
        let heat = activation + maintenance - per_velocity * self.velocity;
        let work = -self.force * self.velocity;
        (heat.at_least(LEAST_HEAT * mass) + work).at_least(0.0)
    }
}

/// Heat per mass at a share of recruitment: slow fibres come first.
fn recruited(share: f64, [slow, fast]: [f64; 2]) -> f64 {
    let (sine, cosine) = libm::sincos(core::f64::consts::FRAC_PI_2 * share.clip(0.0, 1.0));
    SLOW * slow * sine + (1.0 - SLOW) * fast * (1.0 - cosine)
}

/// How maintenance heat depends on the fibre's length: the cross-bridges that can form.
fn by_length(length: f64) -> f64 {
    let line = |from: [f64; 2], to: [f64; 2]| from[1] + (to[1] - from[1]) * (length - from[0]) / (to[0] - from[0]);
    match length {
        _ if length <= 0.5 => 0.5,
        _ if length <= 1.0 => line([0.5, 0.5], [1.0, 1.0]),
        _ if length <= 1.5 => line([1.0, 1.0], [1.5, 0.0]),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 kg of muscle.
    fn muscle() -> Contraction {
        let optimal_length = 0.1;
        let peak_force = TENSION / (DENSITY * optimal_length);
        let (length, velocity, excitation, activation, force, isometric_force) = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        Contraction { peak_force, optimal_length, length, velocity, excitation, activation, force, isometric_force }
    }

    #[test]
    fn a_resting_muscle_gives_its_least_heat() {
        assert!((muscle().mass() - 1.0).abs() < 1e-12);
        assert!((muscle().metabolic_power() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_isometric_contraction_gives_activation_and_maintenance_heat() {
        let full = Contraction { excitation: 1.0, activation: 1.0, force: 2000.0, isometric_force: 2000.0, ..muscle() };
        assert!((full.metabolic_power() - (0.5 * (40.0 + 133.0) + 0.5 * (74.0 + 111.0))).abs() < 1e-9);
        let long = Contraction { length: 1.25, ..full };
        assert!((long.metabolic_power() - (0.5 * (40.0 + 133.0) + 0.25 * (74.0 + 111.0))).abs() < 1e-9);
        // Slow fibres are recruited first: sin(30°) of them, 1 - cos(30°) of the fast ones.
        let third = Contraction { excitation: 1.0 / 3.0, activation: 0.0, ..full };
        let fast = 1.0 - 0.75_f64.sqrt();
        assert!((third.metabolic_power() - (0.5 * 40.0 * 0.5 + 0.5 * 133.0 * fast)).abs() < 1e-9);
    }

    #[test]
    fn shortening_costs_heat_and_work_and_lengthening_gives_nothing_back() {
        let held = Contraction { excitation: 1.0, activation: 1.0, force: 1000.0, isometric_force: 2000.0, ..muscle() };
        let shortening = Contraction { velocity: -0.1, ..held };
        let more = shortening.metabolic_power() - held.metabolic_power();
        assert!((more - (0.1 * (0.16 * 2000.0 + 0.18 * 1000.0) + 100.0)).abs() < 1e-9, "{more}");
        let lengthening = Contraction { velocity: 1.0, ..held };
        assert_eq!(lengthening.metabolic_power(), 0.0);
    }
}
