//! `DynSyn` on an arm with antagonists: which muscles it takes together, and what it keeps of them.

use super::{STOP, acts_as_onnx, engine, engine_of, small, training};
use msk_train::{Agent, Algorithm, Lessons, Settings, Training};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use tempfile::tempdir;

fn dynsyn() -> Settings {
    let mut settings = small(Algorithm::Dynsyn);
    settings.dynsyn.rollout = 2_000;
    settings
}

/// The group of each muscle, as the description of an agent has it.
fn groups(folder: &Path) -> Vec<i64> {
    let text = std::fs::read_to_string(folder.join("agent.toml")).unwrap();
    let description: toml::Table = toml::from_str(&text).unwrap();
    let groups = description["synergies"]["group"].as_array().unwrap();
    groups.iter().map(|group| group.as_integer().unwrap()).collect()
}

#[test]
fn muscles_that_shorten_together_share_a_group() {
    let engine = engine_of("arm", &[]);
    let folder = tempdir().unwrap();
    training(&engine, &dynsyn(), 1).agent().save(folder.path()).unwrap();
    // In front of and behind the shoulder, in front of and behind the elbow.
    assert_eq!(groups(folder.path()), [0, 1, 0, 1, 2, 3, 2, 3]);
}

#[test]
fn entries_that_move_nothing_measurable_cannot_be_grouped() {
    let engine = engine(&[("act torque { joints all, range 3 N*m }", "act cmc { joints all, range 0.3 rad }")]);
    let message = Training::new(&engine, &dynsyn(), (1, 100), NonZeroUsize::MIN).err().unwrap().to_string();
    assert!(message.starts_with("the algorithm `dynsyn` cannot group the entries of an action"), "{message}");
    assert!(message.contains("`act cmc`"), "{message}");
}

#[test]
fn an_agent_keeps_groups_and_weights_and_is_where_others_start() {
    let engine = engine_of("arm", &[]);
    let mut settings = dynsyn();
    settings.dynsyn.release = 0.0;
    acts_as_onnx(&engine, &settings);
    let mut training = training(&engine, &settings, 1);
    while !training.is_over() {
        training.round().unwrap();
    }
    let folder = tempdir().unwrap();
    let agent = training.agent();
    agent.save(folder.path()).unwrap();
    let read = Agent::read(folder.path()).unwrap();
    assert_eq!(read, agent);
    assert!(read.sizes().contains("4 groups of 8 entries, weights from 0.9"), "{}", read.sizes());
    assert_eq!(read.lengths(), (4, 8));
    assert_eq!(training.evaluate(&read, &STOP).unwrap(), training.evaluate(&agent, &STOP).unwrap());

    let start = Lessons { start: Some(Arc::new(read)), ..Lessons::default() };
    let begin = |settings: &Settings| Training::with(&engine, settings, &start, (2, 2_000), NonZeroUsize::MIN);
    // Other groups would be found from so few steps.
    let mut other = dynsyn();
    (other.dynsyn.groups, other.dynsyn.rollout) = (2, 100);
    let again = tempdir().unwrap();
    begin(&other).unwrap().agent().save(again.path()).unwrap();
    assert_eq!(groups(again.path()), groups(folder.path()));
    let message = begin(&small(Algorithm::Sac)).err().unwrap().to_string();
    assert!(message.contains("it acts through groups of entries, as only `dynsyn` does"), "{message}");
}
