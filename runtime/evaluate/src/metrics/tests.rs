use super::*;
use crate::trace::{Block, Column, Layout, Muscle, Trace};
use std::sync::Arc;

/// A body with two muscles of two families, two hinges, a slide and two feet, 100 kg under gravity 10 m/s²: rows of every quantity.
fn play(rows: usize, row: impl Fn(f64) -> Values) -> StandardMetrics {
    let mut metrics = StandardMetrics::default();
    trace(rows, row).replay(|row| metrics.look(row));
    metrics
}

/// What a row of the body has.
struct Values {
    activations: [f64; 2],
    /// Of the root about x, the two hinges (rad/s) and the slide (m/s).
    velocities: [f64; 4],
    joint: f64,
    /// Vertical forces of the feet, N, and their places along x, m.
    feet: [[f64; 2]; 2],
    /// Place of the centre of mass along x, m.
    com: f64,
    power: f64,
    /// Distance from the reference motion, m.
    error: f64,
}

impl Default for Values {
    fn default() -> Self {
        Self {
            activations: [0.0; 2],
            velocities: [0.0; 4],
            joint: 0.0,
            feet: [[0.0; 2]; 2],
            com: 0.0,
            power: 0.0,
            error: f64::NAN,
        }
    }
}

fn trace(rows: usize, row: impl Fn(f64) -> Values) -> Trace {
    let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into() };
    let columns = |count: usize| (0..count).map(|index| column(&format!("c{index}"), "")).collect::<Vec<_>>();
    let muscle = |name: &str, family: &str| Muscle { name: name.into(), family: family.into(), peak_force: 1.0 };
    let block = |quantity, columns| Block { quantity, columns };
    let velocities = vec![column("root.x", "rad/s"), column("hip", "rad/s"), column("knee", "rad/s"), column("rail", "m/s")];
    let layout = Layout {
        period: 0.01,
        mass: 100.0,
        gravity: 10.0,
        root_axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        families: vec!["Calves".into(), "Glutes".into()],
        muscles: vec![muscle("soleus_l", "Calves"), muscle("gmax_l", "Glutes")],
        feet: vec!["sole_l".into(), "sole_r".into()],
        blocks: vec![
            block(Quantity::Activations, columns(2)),
            block(Quantity::Velocities, velocities),
            block(Quantity::JointReactions, columns(1)),
            block(Quantity::GroundReactions, columns(14)),
            block(Quantity::Feet, columns(6)),
            block(Quantity::CenterOfMass, columns(3)),
            block(Quantity::MetabolicPower, columns(1)),
            block(Quantity::TrackingError, columns(1)),
        ],
    };
    let mut trace = Trace::new(Arc::new(layout));
    for index in 0..rows {
        let Values { activations, velocities, joint, feet, com, power, error } = row(index as f64 * 0.01);
        let reaction = |[force, _]: [f64; 2]| [0.0, 0.0, force, 0.0, 0.0, 0.0, 0.0];
        let values: Vec<f64> = activations
            .into_iter()
            .chain(velocities)
            .chain([joint])
            .chain(feet.into_iter().flat_map(reaction))
            .chain(feet.into_iter().flat_map(|[_, x]| [x, 0.0, 0.0]))
            .chain([com, 0.0, 0.9, power, error])
            .collect();
        let layout = Arc::clone(trace.layout());
        trace.push(&Row::new(&layout, &values, index == 0));
    }
    trace
}

fn close(found: Option<f64>, expected: f64) {
    let found = found.unwrap_or(f64::NAN);
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{found} is not {expected}");
}

#[test]
fn an_episode_without_a_step_has_no_metrics_of_steps() {
    let found = play(1, |_| Values { activations: [1.0; 2], ..Values::default() });
    let names: Vec<String> = found.finish().0.into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["peak_ground_reaction", "peak_joint_reaction", "distance"]);
    assert!(found.recruitment().is_empty());
}

#[test]
fn activations_count_before_steps() {
    // 0, 0.5 and, after the last step, 1: the last row does not count.
    let found = play(3, |time| Values { activations: [50.0 * time, 0.1], ..Values::default() });
    close(found.finish().get("activation_cost"), (0.0 + 0.25 + 2.0 * 0.01) / 4.0);
    assert_eq!(found.recruitment().0, [("Calves".to_owned(), 0.25), ("Glutes".to_owned(), 0.1)]);
    let shares = shares(&found.recruitment().0);
    close(Some(shares[0].1), 0.25 / 0.35);
    assert_eq!(super::shares(&[("a".into(), 0.0)]), [("a".to_owned(), 0.0)]);
}

#[test]
fn smoothness_is_of_hinges_alone() {
    // Velocities t² of one hinge: a jerk of 2 rad/s³ at any time; the root and the slide do not count.
    let found = play(40, |time| Values { velocities: [time.powi(4), time * time, 0.0, time.powi(5)], ..Values::default() });
    close(found.finish().get("joint_smoothness"), (4.0_f64 / 2.0).log10());
    close(play(9, |_| Values::default()).finish().get("joint_smoothness"), -12.0);
    // Two samples before steps have no second difference.
    assert_eq!(play(3, |_| Values::default()).finish().get("joint_smoothness"), None);
    assert!(play(4, |_| Values::default()).finish().get("joint_smoothness").is_some());
}

#[test]
fn energy_is_the_integral_of_power() {
    let found = play(101, |time| Values { power: 200.0 * time, com: 2.0 * time, ..Values::default() }).finish();
    close(found.get("metabolic_energy"), 100.0);
    close(found.get("metabolic_power"), 1.0);
    close(found.get("distance"), 2.0);
    close(found.get("cost_of_transport"), 100.0 / (100.0 * 10.0 * 2.0));
    let still = play(101, |time| Values { power: 1.0, com: 0.5 * time, ..Values::default() }).finish();
    assert_eq!(still.get("cost_of_transport"), None);
}

#[test]
fn tracking_errors_are_of_the_rows_that_follow_a_motion() {
    let follows = |time: f64| if time < 0.015 { 300.0 * time + 1.0 } else { f64::NAN };
    // 1 at the reset and 4 after the first step; then the task follows nothing.
    let found = play(4, |time| Values { error: follows(time), ..Values::default() }).finish();
    close(found.get("tracking_error"), (17.0_f64 / 2.0).sqrt());
    assert_eq!(play(4, |_| Values::default()).finish().get("tracking_error"), None);
}

#[test]
fn reactions_are_in_body_weights() {
    let feet = |time: f64| [[500.0, 0.0], [if time == 0.03 { 1500.0 } else { 500.0 }, 0.0]];
    let found = play(5, |time| Values { feet: feet(time), joint: 3000.0 - 1e4 * time, ..Values::default() }).finish();
    close(found.get("peak_ground_reaction"), 2.0);
    close(found.get("peak_joint_reaction"), 3.0);
}

/// A walk along x at 1.2 m/s: cycles of one second, stances of 0.6 s, the right foot half a cycle later; feet land `ahead` (m) of the
/// centre of mass and stay.
fn walk(time: f64, ahead: [f64; 2]) -> Values {
    let foot = |index: usize| {
        let phase = time - 0.5 * index as f64 + 2.0 + 1e-9;
        let (turn, part) = (phase.floor(), phase - phase.floor());
        // Where it struck last, relative to where the body is now.
        let place = 1.2 * (turn + 0.5 * index as f64 - 2.0) + ahead[index];
        [if part < 0.6 { 500.0 } else { 0.0 }, place]
    };
    Values { feet: [foot(0), foot(1)], com: 1.2 * time, ..Values::default() }
}

#[test]
fn a_walk_has_its_cadence_steps_and_stances() {
    let found = play(600, |time| walk(time, [0.3, 0.3])).finish();
    close(found.get("cadence"), 120.0);
    close(found.get("step_length"), 0.6);
    close(found.get("stance_share"), 0.6);
    close(found.get("step_length_asymmetry"), 0.0);
    close(found.get("stance_asymmetry"), 0.0);
    // The left foot lands 0.1 m further ahead: its steps are as much longer, those of the right shorter.
    let lame = play(600, |time| walk(time, [0.4, 0.3])).finish();
    close(lame.get("step_length_asymmetry"), 0.2 / 0.6);
}

#[test]
fn chatter_is_no_step() {
    // A foot that loses the ground for 20 ms each 0.2 s.
    let found = play(300, |time| {
        let force = if time % 0.2 > 0.175 { 0.0 } else { 500.0 };
        Values { feet: [[force, 0.0], [500.0, 0.0]], com: time, ..Values::default() }
    });
    assert_eq!(found.gait.figures(), GaitFigures::default());
}

#[test]
fn curves_are_resampled_as_scipy_does() {
    // tests/oracle/metrics.py prints these: CubicSpline(bc_type="not-a-knot") at 0, 1/4, .. of the range.
    let values = [0.2, 0.9, 0.4, 0.7, 0.1, 0.3];
    let found = curve::resample(&values, 9);
    let expected = [
        0.2,
        0.9507161458333335,
        0.7619791666666667,
        0.4182942708333334,
        0.5524999999999999,
        0.6787760416666667,
        0.28645833333333326,
        -0.07200520833333335,
        0.3,
    ];
    for (found, expected) in found.iter().zip(expected) {
        close(Some(*found), expected);
    }
    close(curve::resample(&[1.0, 4.0, 9.0], 5).get(1).copied(), 2.25);
    assert_eq!(curve::resample(&[1.0, 3.0], 3), [1.0, 2.0, 3.0]);
    assert_eq!(curve::resample(&[2.0], 3), [2.0; 3]);
    // Cubics come out as they are.
    let cubic = |x: f64| x * x * x - 2.0 * x;
    let resampled = curve::resample(&(0..7).map(|x| cubic(f64::from(x))).collect::<Vec<_>>(), 25);
    for (index, found) in resampled.iter().enumerate() {
        close(Some(*found), cubic(index as f64 / 4.0));
    }
    close(curve::correlation(&values, &[1.0, 2.0, 0.0, 4.0, 3.0, 1.0]), 0.279684081179889);
}

#[test]
fn the_best_shift_is_found_without_the_duplicated_end() {
    let curve = |shift: f64| {
        let value = |point: usize| (core::f64::consts::TAU * (point as f64 / 100.0 - shift)).sin().powi(3);
        (0..101).map(value).collect::<Vec<_>>()
    };
    let (shift, r) = similarity::best_shift(&curve(0.0), &curve(0.37)).unwrap();
    assert_eq!(shift, 37);
    close(Some(r), 1.0);
    let later = similarity::shifted(&curve(0.0), 37);
    assert!(later.iter().zip(curve(0.37)).all(|(a, b)| (a - b).abs() < 1e-9));
    assert_eq!(later[0], later[100]);
    // A cubed sine has two frequencies: surrogates of it correlate well by chance.
    let (chance, reached) = similarity::chance(&curve(0.0), &curve(0.37), 1.0 - 1e-9, "soleus_l");
    assert!((0.5..1.0).contains(&chance) && reached < 0.1, "{chance} {reached}");
}

/// `tests/oracle/metrics.py`: cycles of 60, 70 and 80 samples, resampled, averaged, scaled and shifted by NumPy and SciPy.
#[test]
fn an_envelope_is_that_of_numpy_and_scipy() {
    use core::f64::consts::TAU;
    let of = |count: usize, value: &dyn Fn(f64) -> f64| {
        (0..count).map(|place| value(place as f64 / (count - 1) as f64)).collect::<Vec<_>>()
    };
    let cycle = |count: usize| of(count, &|part| (TAU * part).sin().powi(3) + 0.01 * count as f64);
    let curves: Vec<Vec<f64>> = [60, 70, 80].map(|count| curve::resample(&cycle(count), 101)).to_vec();
    let human = of(40, &|part| (TAU * part).cos().powi(3) + 0.2 * (2.0 * TAU * part).sin());
    let human = curve::normalized(&curve::resample(&human, 101)).unwrap();
    let (mean, deviation) = curve::mean_and_deviation(&curves).unwrap();
    let simulated = curve::normalized(&mean).unwrap();
    let [low, high] = curve::range(&mean).unwrap();
    let (shift, r) = similarity::best_shift(&simulated, &human).unwrap();
    assert_eq!(shift, 75);
    close(Some(r), 0.9694603117733295);
    close(Some(deviation[0] / (high - low)), 0.040824930344082036);
    close(Some(simulated[30]), 0.9301193357055195);
}

#[test]
fn activations_are_compared_over_the_cycles_of_their_side() {
    let phase = |time: f64| (core::f64::consts::TAU * time).sin();
    let walk = |time: f64| Values { activations: [0.5 + 0.4 * phase(time), 0.25], ..walk(time, [0.3, 0.3]) };
    let trace = trace(600, walk);
    let human = (0..50).map(|point| 3.0 + phase(f64::from(point) / 49.0 - 0.25)).collect();
    let envelope =
        |muscle: &str, values: Vec<f64>| similarity::Envelope { muscle: muscle.into(), column: "human".into(), values };
    let found = similarity::compare(&trace, &[envelope("soleus_l", human)]).unwrap();
    assert_eq!((found[0].cycles, found[0].shift), (4, 0.25));
    close(similarity::mean_correlation(&found).map(|r| (1e4 * r).round()), 1e4);
    let error = |envelope| similarity::compare(&trace, &[envelope]).unwrap_err().to_string();
    assert_eq!(error(envelope("soleus", vec![0.0; 9])), "the body has no muscle `soleus`");
    assert_eq!(error(envelope("soleus_l", vec![0.0; 3])), "the envelope of `soleus_l` has 3 values, expected at least 4");
    assert_eq!(
        error(envelope("soleus_l", vec![0.0; 9])),
        "the human envelope of `soleus_l` is constant: there is nothing to correlate"
    );
    assert_eq!(error(envelope("gmax_l", vec![0.0; 9])), "the activation of `gmax_l` is constant: there is nothing to correlate");
    let standing = super::tests::trace(50, |_| Values::default());
    let error = similarity::compare(&standing, &[envelope("soleus_l", vec![0.0; 9])]).unwrap_err().to_string();
    assert_eq!(error, "there is no whole gait cycle of `soleus_l`: the episode has fewer than two strikes of its foot");
}
