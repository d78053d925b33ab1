//! The tasks that `benches/compiled.rs` weighs against Rust by hand come to the same numbers both ways.

#[path = "../benches/hand/mod.rs"]
mod hand;
use crate::support;

use hand::{Outcome, Sums, TASKS};
use msk::compiler::{Middle, compile, task::StepReport};
use msk::runtime::{
    episode::{Environment, EpisodeKey},
    library::{BodyLibrary, FileLoader},
};
use support::{SplitMix, repository};

/// Records of an episode, and of the same with every number shaken: no body could be like that, but all thresholds are crossed.
fn frames(episode: &mut Environment, random: &mut SplitMix) -> Vec<Vec<f64>> {
    let muscles = episode.context().body.muscles.len();
    episode.reset(EpisodeKey { seed: 3, episode: 0 });
    let mut frames = vec![episode.frame().to_vec()];
    while frames.len() < 12 && episode.ending().is_none() {
        let action: Vec<f64> = (0..muscles).map(|_| 2.0 * random.unit() - 1.0).collect();
        episode.step(&action).unwrap();
        frames.push(episode.frame().to_vec());
    }
    for size in [0.1, 1.0, 3.0, 50.0] {
        for number in 0..60 {
            let base = frames[number % 12].clone();
            frames.push(
                base.into_iter().map(|value| value + size * (random.unit() - 0.5) + 0.02 * f64::from(number as u8)).collect(),
            );
        }
    }
    frames
}

#[test]
fn by_hand_and_compiled_come_to_the_same() {
    let bodies = BodyLibrary::default();
    for ((file, by_hand), sums) in TASKS.into_iter().flat_map(|task| [Sums::Chain, Sums::Columns].map(|sums| (task, sums))) {
        let task = compile(&repository(file), &FileLoader, &bodies).unwrap().tasks[0].clone();
        let staged = bodies.stage(&task.body, &task.scene).unwrap();
        let mut episode = Environment::new(staged.model, staged.body, task.clone()).unwrap();
        let frames = frames(&mut episode, &mut SplitMix(17));
        let (weights, mut hand) = (task.weights(), by_hand(&task, sums));
        let (mut state, mut report, mut outcome) = (Default::default(), StepReport::default(), Outcome::default());
        let mut observed = [vec![0.0; task.observation_size()], vec![0.0; task.observation_size()]];
        task.reset(&frames[0], &mut Middle, &mut state).unwrap();
        hand.reset(&frames[0]);
        let (mut ended, mut succeeded) = ([false; 2], false);
        for (number, frame) in frames.iter().cycle().skip(1).take(1100).enumerate() {
            task.step(frame, &weights, &mut Middle, &mut state, &mut report).unwrap();
            hand.step(frame, &weights, &mut outcome);
            let what = format!("{file}, step {number}");
            for (term, (found, expected)) in task.terms.iter().zip(outcome.terms.iter().zip(&report.terms)) {
                assert!(
                    (found - expected).abs() <= 1e-12 * expected.abs().max(1.0),
                    "{what}: {} is {expected}, by hand {found}",
                    term.name
                );
            }
            assert!((outcome.reward - report.reward).abs() <= 1e-9, "{what}: {} and {}", outcome.reward, report.reward);
            assert_eq!(outcome.ends[..], report.terminations[..], "{what}");
            assert_eq!((outcome.truncated, outcome.success), (report.truncated, report.success), "{what}");
            task.observe(frame, &state, &mut observed[0]);
            hand.observe(frame, &mut observed[1]);
            for (slot, (expected, found)) in observed[0].iter().zip(&observed[1]).enumerate() {
                assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{what}: observation {slot}");
            }
            ended.iter_mut().zip(outcome.ends).for_each(|(seen, now)| *seen |= now);
            succeeded |= outcome.success;
        }
        assert!(ended == [true; 2] && succeeded, "{file}: {ended:?}, {succeeded}: not all was tried");
    }
}
