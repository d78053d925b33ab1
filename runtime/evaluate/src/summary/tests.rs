//! Sums over episodes, by hand.

use super::summarizer::TaskTally;
use super::*;
use crate::ByTerm;
use crate::settings::TaskSettings;

fn record(episode: u64, steps: u32, pose: f64, effort: f64, ended: &str) -> EpisodeRecord {
    let horizon = ended == "horizon";
    let by_term = |pose: f64, effort: f64| ByTerm(vec![("pose".into(), pose), ("effort".into(), effort)]);
    EpisodeRecord {
        task: "stand".into(),
        policy: "zero".into(),
        seed: 0,
        episode,
        success: horizon,
        terminated_by: if horizon { vec![] } else { vec![ended.into()] },
        finished_by: vec![],
        truncated: horizon,
        awaited: String::new(),
        fault: None,
        steps,
        total: pose + effort,
        success_step: None,
        return_to_success: None,
        terms: by_term(pose, effort),
        values: by_term(pose / 10.0, -effort),
        squares: ByTerm::default(),
        dead: ByTerm::default(),
        saturated: ByTerm::default(),
        weights_version: String::new(),
        weights: ByTerm::default(),
        parameters: ByTerm::default(),
        metrics: ByTerm(vec![("lean".into(), pose)]),
        last_metrics: ByTerm(vec![("lean".into(), f64::NAN)]),
        standard: ByTerm(vec![("activation_cost".into(), pose)]),
        recruitment: ByTerm(vec![("Calves".into(), 3.0), ("Glutes".into(), 1.0)]),
        task_hash: String::new(),
        model_hash: String::new(),
        condition: Default::default(),
        wall_time: 0.0,
    }
}

/// The summary of episodes of a task with these weights.
fn summary(weights: &[(&str, f64)], episodes: &[EpisodeRecord]) -> TaskSummary {
    let task = TaskSettings {
        name: "stand".into(),
        family: String::new(),
        hash: String::new(),
        model_hash: String::new(),
        condition: Default::default(),
        perturbation: String::new(),
        horizon: 30,
        weights: weights.iter().map(|(name, weight)| ((*name).to_owned(), *weight)).collect(),
        overlaid: vec![],
    };
    let mut tally = TaskTally::new(&task, vec!["rad".into()]);
    episodes.iter().for_each(|record| tally.add(record));
    tally.summary()
}

#[test]
fn terms_are_averaged_over_steps_and_shares_over_what_was_paid_and_charged() {
    let episodes = [record(0, 10, 60.0, -10.0, "horizon"), record(1, 30, 20.0, -10.0, "fallen")];
    let terms = summary(&[("pose", 10.0), ("effort", -1.0)], &episodes).terms;
    assert_eq!(terms[0].value_per_step, Some(0.2));
    assert_eq!(terms[0].pay_per_step, Some(2.0));
    assert_eq!(terms[0].share, Some(0.8));
    assert_eq!(terms[1].value_per_step, Some(0.5));
    assert_eq!(terms[1].share, Some(-0.2));
}

#[test]
fn metrics_are_averaged_over_the_episodes_in_which_they_are_numbers() {
    let episodes = [record(0, 10, 60.0, -10.0, "horizon"), record(1, 30, 20.0, -10.0, "fallen")];
    let metrics = summary(&[], &episodes).metrics;
    assert_eq!((metrics[0].name.as_str(), metrics[0].unit.as_str()), ("lean", "rad"));
    assert_eq!(metrics[0].mean.map(|spread| spread.mean), Some(40.0));
    assert_eq!(metrics[0].last, None);
}

#[test]
fn nothing_run_is_nothing_known() {
    let term = summary(&[("pose", 10.0)], &[]).terms.remove(0);
    assert_eq!((term.value_per_step, term.pay_per_step, term.share), (None, None, None));
}

#[test]
fn endings_are_counted_the_most_frequent_first() {
    let ends = ["tilted", "fallen", "horizon", "horizon"];
    let episodes: Vec<_> = (0..).zip(ends).map(|(i, end)| record(i, 10, 1.0, 0.0, end)).collect();
    let counted = summary(&[], &episodes).ended_by;
    assert_eq!(counted, [("horizon".into(), 2), ("fallen".into(), 1), ("tilted".into(), 1)]);
}

#[test]
fn weights_that_change_are_averaged_and_their_versions_counted_in_order() {
    let weighted = |episode: u64, version: &str, pose: f64| EpisodeRecord {
        weights_version: version.into(),
        weights: ByTerm(vec![("pose".into(), pose), ("effort".into(), -1.0)]),
        ..record(episode, 10, 1.0, 0.0, "horizon")
    };
    let episodes = [weighted(0, "b", 2.0), weighted(1, "a", 4.0), weighted(2, "b", 3.0)];
    let found = summary(&[("pose", 10.0), ("effort", -2.0)], &episodes);
    assert_eq!((found.terms[0].weight, found.terms[1].weight), (3.0, -1.0));
    assert_eq!(found.weights_versions, [("b".into(), 2), ("a".into(), 1)]);
}

#[test]
fn standard_metrics_and_recruitment_are_means_over_episodes() {
    let found = summary(&[], &[record(0, 10, 1.0, 0.0, "horizon"), record(1, 10, 2.0, 0.0, "horizon")]);
    assert_eq!(found.standard[0].name, "activation_cost");
    assert_eq!((found.standard[0].episodes, found.standard[0].value.mean), (2, 1.5));
    assert_eq!((found.recruitment[0].mass, found.recruitment[0].share), (3.0, 0.75));
}

#[test]
fn faults_are_counted_and_the_first_are_kept() {
    let faulty = |episode| EpisodeRecord { fault: Some("it broke".into()), ..record(episode, 1, 0.0, 0.0, "fallen") };
    let found = summary(&[], &(0..300).map(faulty).collect::<Vec<_>>());
    assert_eq!((found.faults.len(), found.faults[99].0), (100, 99));
    assert_eq!(found.ended_by, [("fault".into(), 300)]);
}

#[test]
fn returns_up_to_success_stand_beside_whole_ones() {
    let early = EpisodeRecord { success_step: Some(3), return_to_success: Some(2.0), ..record(0, 10, 20.0, 0.0, "horizon") };
    let never = record(1, 10, 6.0, 0.0, "fallen");
    let found = summary(&[("pose", 1.0), ("effort", 1.0)], &[early, never]);
    let means = [found.total, found.return_to_success].map(|spread| spread.unwrap().mean);
    assert_eq!(means, [13.0, 4.0]);
}
