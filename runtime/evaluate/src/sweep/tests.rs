use super::*;
use crate::{GroupSummary, Protocol, Spread, TaskSummary, wilson_interval};

/// A task of ten episodes with so many successes; none played with `None`.
fn task(name: &str, family: &str, successes: Option<u64>) -> TaskSummary {
    TaskSummary {
        task: name.into(),
        family: family.into(),
        condition: Default::default(),
        skipped: None,
        horizon: 10,
        episodes: successes.map_or(0, |_| 10),
        successes: successes.unwrap_or(0),
        success_rate: successes.map(|count| count as f64 / 10.0),
        success_interval: wilson_interval(successes.unwrap_or(0), 10),
        return_to_success: None,
        total: Some(Spread { mean: 1.0, deviation: None }),
        steps: None,
        ended_by: vec![],
        faults: vec![],
        terms: vec![],
        weights_versions: vec![],
        metrics: vec![],
        standard: vec![],
        recruitment: vec![],
    }
}

fn summary(stand: u64, walk: Option<u64>) -> Summary {
    let tasks = vec![task("stand", "stabilization", Some(stand)), task("walk", "locomotion", walk)];
    Summary::new("cmc".into(), Protocol { episodes: 10, seed: 0 }, tasks)
}

#[test]
fn the_area_is_numpys() {
    // tests/oracle/metrics.py: 100 * trapezoid(success, scales) / (scales[-1] - scales[0])
    let found = area(&Axis::Observation.grid(), &[1.0, 0.9, 0.5, 0.1, 0.0]).unwrap();
    assert!((found - 50.0).abs() < 1e-12, "{found}");
    let whole = area(&Axis::Action.grid(), &[1.0; 5]).unwrap();
    assert!((whole - 100.0).abs() < 1e-12, "{whole}");
    assert_eq!(area(&[0.0], &[1.0]), None);
    assert_eq!(area(&[0.0, 1.0], &[1.0]), None);
    assert_eq!(area(&[], &[]), None);
}

#[test]
fn families_and_all_tasks_are_means_of_tasks() {
    let action: Vec<(f64, Summary)> =
        Axis::Action.grid().iter().zip([10, 10, 8, 4, 0]).map(|(scale, stand)| (*scale, summary(stand, Some(0)))).collect();
    let gain: Vec<(f64, Summary)> = Axis::Gain.grid().iter().map(|scale| (*scale, summary(10, None))).collect();
    let sweep = Sweep::of(&[(Axis::Action, action), (Axis::Gain, gain)]).unwrap();
    assert!((sweep.tasks[0].curves[0].area.unwrap() - 67.5).abs() < 1e-12);
    assert!((sweep.overall.curves[0].area.unwrap() - 33.75).abs() < 1e-12);
    // Walking was not played under changed gains.
    assert_eq!((sweep.tasks[1].curves[1].area, sweep.overall.curves[1].area), (None, Some(100.0)));
    insta::assert_snapshot!(markdown(&sweep), @r"
    # Robustness of `cmc`: 10 episodes per task and scale, seed 0

    ## Action: standard deviation of the noise on every entry

    | task          |   0 | 0.05 | 0.1 | 0.15 | 0.2 | area |
    |:--------------|----:|-----:|----:|-----:|----:|-----:|
    | stabilization | 100 |  100 |  80 |   40 |   0 | 67.5 |
    | - stand       | 100 |  100 |  80 |   40 |   0 | 67.5 |
    | locomotion    |   0 |    0 |   0 |    0 |   0 |  0.0 |
    | - walk        |   0 |    0 |   0 |    0 |   0 |  0.0 |
    | all tasks     |  50 |   50 |  40 |   20 |   0 | 33.8 |

    ## Gain: largest relative change of a muscle's force, drawn per episode

    | task          |   0 | 0.05 | 0.1 | 0.15 | 0.2 |  area |
    |:--------------|----:|-----:|----:|-----:|----:|------:|
    | stabilization | 100 |  100 | 100 |  100 | 100 | 100.0 |
    | - stand       | 100 |  100 | 100 |  100 | 100 | 100.0 |
    | locomotion    |   - |    - |   - |    - |   - |     - |
    | - walk        |   - |    - |   - |    - |   - |     - |
    | all tasks     | 100 |  100 | 100 |  100 | 100 | 100.0 |

    ## Areas

    | task          | action |  gain | mean |
    |:--------------|-------:|------:|-----:|
    | stabilization |   67.5 | 100.0 | 83.8 |
    | - stand       |   67.5 | 100.0 | 83.8 |
    | locomotion    |    0.0 |     - |  0.0 |
    | - walk        |    0.0 |     - |  0.0 |
    | all tasks     |   33.8 | 100.0 | 41.9 |

    Success in percent. Area: mean of success along the axis by trapezoids, 0 to 100. Families: means
    over tasks.
    ");
    let read: Sweep = serde_json::from_str(&sweep.json()).unwrap();
    assert_eq!(read, sweep);
    assert_eq!(Sweep::of(&[]), None);
    let GroupSummary { tasks, .. } = &summary(1, None).overall;
    assert_eq!(*tasks, 2);
}

#[test]
fn every_axis_is_a_perturbation_and_the_scale_0_is_none() {
    for axis in Axis::ALL {
        let grid = axis.grid();
        assert!(perturbation(axis, 0.0, None).is_none() && !perturbation(axis, grid[1], None).is_none(), "{axis:?}");
        assert!(perturbation(axis, grid[4], None).check().is_ok());
        assert_eq!(serde_json::to_string(&axis).unwrap(), format!("\"{}\"", axis.name()));
        // What the language accepts as a scale can be played, and the other way round.
        for scale in [0.5, 1.0, 1000.0, 1001.0] {
            assert_eq!(
                axis.refuses(scale).is_none() || axis == Axis::Latency && scale == 0.5,
                perturbation(axis, scale, None).check().is_ok(),
                "{axis:?} {scale}"
            );
        }
    }
}

#[test]
fn moments_are_those_of_the_whole_sample() {
    let mut entries = Vec::new();
    for value in [1.0, 2.0, 4.0, 9.0] {
        normalization::add(&mut entries, &[value, 5.0]);
    }
    let found = normalization::finish(&entries);
    assert_eq!(found.mean, [4.0, 5.0]);
    // numpy.std([1, 2, 4, 9]), and the least deviation.
    assert!((found.deviation[0] - 3.082_207_001_484_488).abs() < 1e-8 && (found.deviation[1] - 1e-4).abs() < 1e-15, "{found:?}");
}
