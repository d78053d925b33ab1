//! One muscle on a path that is moved by hand.

use super::curves::{Tendon, active, passive, passive_energy, velocity};
use super::fibre::{Curves, Fibre, Unit};
use super::table::Tables;
use std::sync::Arc;

/// A soleus with 5 kN: fibres of 50 mm, a tendon of 250 mm, ten fibre lengths a second.
fn soleus() -> Unit {
    Unit {
        place: [0, 0],
        optimal: 0.05,
        slack: 0.25,
        compliant: 0.25,
        peak: 5000.0,
        strength: 1.0,
        fastest: 10.0,
        damping: 0.1,
        thickness: 0.0,
        tendon: Tendon::new(0.049),
        curves: Curves::Published(Arc::new(Tables::new())),
    }
}

/// Moves the path along `path` over `time` seconds in steps of `step`, and shows each moment to `look` with the path's
/// length.
fn follow(unit: &Unit, activation: f64, step: f64, time: f64, path: impl Fn(f64) -> f64, mut look: impl FnMut(f64, &Fibre)) {
    let rate = (path(step) - path(0.0)) / step;
    let mut fibre = unit.equilibrium(path(0.0), rate, activation);
    look(path(0.0), &fibre);
    for count in 1..=(time / step).round() as u32 {
        let length = path(f64::from(count) * step);
        fibre = unit.advance(length, [fibre.length, fibre.velocity], activation, step);
        look(length, &fibre);
    }
}

#[test]
fn the_isometric_force_length_curve_of_the_whole_muscle_is_that_of_its_fibre() {
    let unit = soleus();
    for hundredth in 45..160 {
        let length = f64::from(hundredth) / 100.0;
        for activation in [0.05, 0.5, 1.0] {
            let expected = activation * active(length)[0] * velocity(0.0)[0] + passive(length)[0];
            // The path on which a fibre of this length stands: the tendon stretched until it carries the force.
            let strain = (0..60).fold([0.0, 0.2], |[low, high], _| {
                let middle = 0.5 * (low + high);
                if unit.tendon.force(middle)[0] < expected { [middle, high] } else { [low, middle] }
            })[0];
            let path = unit.slack + unit.compliant * strain + unit.optimal * length;
            let found = unit.equilibrium(path, 0.0, activation);
            assert!((found.force / unit.peak - expected).abs() < 1e-9, "length {length}: {} is not {expected}", found.force);
            assert!((found.length / unit.optimal - length).abs() < 1e-9);
        }
    }
}

#[test]
fn shortening_and_lengthening_at_constant_speed_give_the_force_velocity_curve() {
    let unit = soleus();
    for speed in [-0.8, -0.5, -0.2, -0.05, 0.05, 0.2, 0.5] {
        // From where the tendon has its steady stretch to optimal length, at a tenth of a millisecond.
        let rate = speed * unit.optimal * unit.fastest;
        let expected = velocity(speed)[0] + unit.damping * speed;
        let mut nearest = [f64::INFINITY, 0.0];
        let start = unit.slack + 0.045 * unit.compliant + unit.optimal - 0.03 * rate.signum();
        follow(
            &unit,
            1.0,
            1e-4,
            0.06 / rate.abs(),
            |time| start + rate * time,
            |_, fibre| {
                let distance = (fibre.length / unit.optimal - 1.0).abs();
                if distance < nearest[0] {
                    nearest = [distance, fibre.force / unit.peak];
                }
            },
        );
        // The tendon is not at rest: where the fibre is at its best its force still changes a little with length.
        assert!((nearest[1] - expected).abs() < 0.05, "at {speed}: {} is not {expected}", nearest[1]);
    }
}

#[test]
fn fibre_and_tendon_are_in_balance_after_every_step() {
    let unit = soleus();
    let path = |time: f64| 0.305 + 0.02 * libm::sin(30.0 * time);
    follow(&unit, 0.6, 1e-3, 0.5, path, |path, fibre| {
        let (length, speed) = (fibre.length / unit.optimal, fibre.velocity / (unit.optimal * unit.fastest));
        let force = 0.6 * active(length)[0] * velocity(speed)[0] + passive(length)[0] + unit.damping * speed;
        let pull = unit.tendon.force((path - fibre.length - unit.slack) / unit.compliant)[0];
        assert!((fibre.force / unit.peak - pull).abs() < 1e-8);
        // The curves over length are taken linear over a step.
        assert!((force - pull).abs() < 2e-3, "{force} against {pull}");
    });
}

/// Work done on the muscle = stored in tendon and parallel element + taken up by the contractile element and the damper. What
/// is missing is an error of the step, which shrinks with it.
#[test]
fn the_energy_of_a_stretch_and_release_is_accounted_for() {
    let unit = soleus();
    let missing = |activation: f64, step: f64| {
        let stored = |path: f64, fibre: &Fibre| {
            let strain = (path - fibre.length - unit.slack) / unit.compliant;
            unit.peak * (unit.compliant * unit.tendon.energy(strain) + unit.optimal * passive_energy(fibre.length / unit.optimal))
        };
        let (mut work, mut taken, mut ends, mut before) = (0.0, 0.0, Vec::new(), None::<(f64, Fibre)>);
        let path = |time: f64| 0.30 + 0.02 * (1.0 - libm::cos(20.0 * time));
        follow(&unit, activation, step, std::f64::consts::PI / 10.0, path, |path, fibre| {
            if let Some((last, old)) = before {
                work += 0.5 * (fibre.force + old.force) * (path - last);
                let inner = |fibre: &Fibre| fibre.force - unit.peak * passive(fibre.length / unit.optimal)[0];
                taken += 0.5 * (inner(fibre) + inner(&old)) * (fibre.length - old.length);
            }
            ends.push(stored(path, fibre));
            before = Some((path, *fibre));
        });
        let stored = ends[ends.len() - 1] - ends[0];
        assert!(work > 1.0, "a stretch and release of an active muscle costs work: {work} J");
        (work - stored - taken).abs() / work
    };
    for activation in [0.2, 1.0] {
        let [coarse, fine] = [1e-3, 0.5e-3].map(|step| missing(activation, step));
        assert!(coarse < 1e-2, "{coarse} of the work is missing at 1 ms");
        assert!(fine < 0.6 * coarse, "{fine} at half the step against {coarse}");
    }
}

#[test]
fn a_muscle_at_rest_stays_as_it_begins() {
    let mut unit = soleus();
    for thickness in [0.0, 0.4] {
        unit.thickness = thickness;
        for (activation, path) in [(0.0, 0.2), (0.0, 0.33), (0.3, 0.31), (1.0, 0.28), (1.0, 0.36)] {
            let first = unit.equilibrium(path, 0.0, activation);
            follow(
                &unit,
                activation,
                1e-3,
                0.1,
                |_| path,
                |_, fibre| {
                    assert!((fibre.force - first.force).abs() < 1e-4, "{} N became {} N", first.force, fibre.force);
                    assert!(fibre.velocity.abs() < 1e-6);
                },
            );
        }
    }
}

#[test]
fn no_jump_of_the_path_breaks_a_muscle() {
    let mut unit = soleus();
    for strain in [1e-6, 1e-3, 0.049, 0.3] {
        unit.tendon = Tendon::new(strain);
        for activation in [0.0, 1e-6, 0.5, 1.0] {
            for path in [0.0, 0.1, 0.249, 0.26, 0.3, 0.4, 1.0, 100.0] {
                for before in [[0.0025, 0.0], [0.05, -5.0], [0.05, 1e3], [0.2, 0.0], [5.0, -1e3]] {
                    let fibre = unit.advance(path, before, activation, 1e-3);
                    assert!(fibre.length >= 0.0025 && fibre.length.is_finite() && fibre.velocity.is_finite(), "{fibre:?}");
                    assert!(fibre.force >= 0.0 && fibre.force.is_finite(), "{fibre:?}");
                }
            }
        }
    }
}

/// With pennation of constant thickness the fibre's pull along the tendon is smaller by the cosine of its angle.
#[test]
fn a_pennate_fibre_pulls_by_its_cosine() {
    let unit = Unit { thickness: 0.5, ..soleus() };
    let fibre = unit.equilibrium(0.25 * 1.045 + 0.05 * libm::sqrt(0.75), 0.0, 1.0);
    let length = fibre.length / unit.optimal;
    let cosine = libm::sqrt(1.0 - 0.25 / (length * length));
    let expected = (active(length)[0] * velocity(0.0)[0] + passive(length)[0]) * cosine;
    assert!((fibre.force / unit.peak - expected).abs() < 1e-9);
    assert!((0.8..0.9).contains(&cosine));
}
