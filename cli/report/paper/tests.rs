use super::super::read::Played;
use super::*;
use msk::evaluate::metrics::similarity::Similarity;
use msk::evaluate::session::{Comparison, Tracking};
use serde_json::json;

fn summary(policy: &str, success: [f64; 2]) -> Summary {
    let task = |name: &str, family: &str, rate: f64| {
        json!({
            "task": name, "family": family, "horizon": 10, "episodes": 50, "successes": (50.0 * rate) as u64,
            "success_rate": rate, "success_interval": [0.0, 1.0], "return": null, "steps": null, "ended_by": [], "faults": [],
            "terms": [], "metrics": [],
            "standard": [{ "name": "activation_cost", "unit": "", "episodes": 50, "value": { "mean": 0.25, "deviation": null } }],
        })
    };
    let group = |name: &str, tasks: usize, rate: f64| json!({ "name": name, "tasks": tasks, "evaluated": tasks, "success_rate": rate, "horizon_part": null });
    let mean = success.iter().sum::<f64>() / 2.0;
    serde_json::from_value(json!({
        "policy": policy, "protocol": { "episodes": 50, "seed": 0 },
        "families": [group("stabilization", 1, success[0]), group("locomotion", 1, success[1])],
        "overall": group("all tasks", 2, mean),
        "tasks": [task("stand", "stabilization", success[0]), task("walk_turn", "locomotion", success[1])],
    }))
    .unwrap()
}

fn sweep(policy: &str) -> Sweep {
    let of =
        |name: &str| json!({ "name": name, "family": "", "area": 75.0, "curves": [{ "success": [1.0, 0.5], "area": 75.0 }] });
    serde_json::from_value(json!({
        "policy": policy, "seed": 0, "episodes": 30, "axes": [["action", [0.0, 0.2]]],
        "tasks": [of("stand"), of("walk_turn")], "families": [], "overall": of("all tasks"),
    }))
    .unwrap()
}

fn source(label: &str) -> Source {
    Source { label: label.into(), ..Source::default() }
}

/// LaTeX of all tables that folders fill.
fn written(sources: &[Source]) -> String {
    latex(&tables(&columns(sources), sources, &[]))
}

fn expect(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(text.lines().any(|found| found == *line), "no `{line}` in\n{text}");
    }
}

#[test]
fn the_tables_of_the_suite_have_the_papers_columns() {
    let sources = [
        Source { summary: Some(summary("agent runs/walk_ppo/best", [0.5, 1.0])), ..source("a") },
        Source { sweep: Some(sweep("cmc")), ..source("b") },
        Source { summary: Some(summary("cmc", [1.0, 0.0])), ..source("c") },
        Source { curve: vec![[1e7, 2.0, 0.1], [3e7, 5.0, 0.2]], ..source("walk_ppo") },
    ];
    let text = written(&sources);
    let lines = [
        "\\begin{tabular}{@{}llrr@{}}",
        "Group & Metric & agent runs/walk\\_ppo/best & cmc \\\\",
        "\\multirow{3}{*}{SR (\\%) $\\uparrow$} & Stabilization (1) & 50.00 & \\textbf{100.00} \\\\",
        "& Average (2) & \\textbf{75.00} & 50.00 \\\\",
        "\\begin{adjustbox}{max width=\\linewidth}",
        "\\multirow{4}{*}{Robust. $\\uparrow$} & Action & -- & \\textbf{75.00} \\\\",
        // Not all axes were swept.
        "& Average & -- & -- \\\\",
        "Coverage $\\uparrow$ & SR $>$ 0 & \\textbf{2/2} & 1/2 \\\\",
        "\\begin{tabular}{lc c *{12}{c} ccc}",
        "Task & Policy & Activation & \\multicolumn{12}{c}{Robustness (\\%)} & Max & SR & log10 smooth \\\\",
        "\\cmidrule(lr){4-5} \\cmidrule(lr){6-10} \\cmidrule(lr){11-15}",
        "& & & 0 & 0.2 & 0 & 0.02 & 0.05 & 0.08 & 0.1 & 0 & 0.05 & 0.1 & 0.15 & 0.2 & & & \\\\",
        "\\multirow{2}{*}{walk\\_turn} & agent runs/walk\\_ppo/best & 0.2500 & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & 3.00 & 100 & -- \\\\",
        "& cmc & 0.2500 & 100 & 50 & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & -- & 0 & -- \\\\",
    ];
    expect(&text, &lines);
    assert_eq!(text.matches("\\begin{table*}").count(), 3, "one for all tasks, one for each family");
    assert_eq!(written(&[]), "");
    // The same cells, with all heads above a column in one.
    let all = tables(&columns(&sources), &sources, &[]);
    let found = csv(&all);
    assert!(
        found
            .lines()
            .any(|line| line.contains(",Task,Policy,Activation Cost,Robustness (%) Action 0,Robustness (%) Action 0.2,")),
        "{found}"
    );
    assert!(found.contains(",walk_turn,cmc,0.2500,100,50,--"), "{found}");
    assert!(markdown(&all).split('|').any(|cell| cell.trim() == "**75.00**"), "{}", markdown(&all));
}

#[test]
fn recruitment_stands_beside_each_other_for_few_tasks() {
    let mut loads = summary("cmc", [1.0, 0.0]);
    assert!(!written(&[Source { summary: Some(loads.clone()), ..source("none") }]).contains("Recruitment"));
    for (task, mass) in loads.tasks.iter_mut().zip([2.0, 3.5]) {
        task.recruitment = vec![msk::evaluate::FamilySummary { name: "Elbow flexors".into(), mass, share: mass / 10.0 }];
    }
    let text = written(&[Source { summary: Some(loads), ..source("loads") }]);
    let lines = [
        "& \\multicolumn{2}{c}{stand} & \\multicolumn{2}{c}{walk\\_turn} \\\\",
        "\\cmidrule(lr){2-3} \\cmidrule(lr){4-5}",
        "Elbow flexors & 2.000 & 20.0 & 3.500 & 35.0 \\\\",
    ];
    expect(&text, &lines);
}

#[test]
fn a_mean_of_fewer_tasks_is_no_better() {
    let mut some = summary("agents", [1.0, 0.0]);
    (some.families[0].tasks, some.overall.evaluated) = (6, 1);
    let text = written(&[
        Source { summary: Some(some), ..source("a") },
        Source { summary: Some(summary("cmc", [0.5, 0.25])), ..source("c") },
    ]);
    let lines = [
        "\\multirow{3}{*}{SR (\\%) $\\uparrow$} & Stabilization (6) & 100.00\\textsuperscript{1/6} & \\textbf{50.00} \\\\",
        "& Average (2) & 50.00\\textsuperscript{1/2} & \\textbf{37.50} \\\\",
    ];
    expect(&text, &lines);
}

#[test]
fn settings_of_a_task_that_follows_a_motion_are_matched() {
    let tracked = |label: &str, steps: f64, error: f64| {
        let mut found = summary("agent a", [1.0, 0.0]);
        let walk = &mut found.tasks[1];
        walk.steps = Some(msk::evaluate::Spread { mean: steps, deviation: None });
        let standard =
            json!({ "name": "tracking_error", "unit": "m", "episodes": 50, "value": { "mean": error, "deviation": null } });
        walk.standard.push(serde_json::from_value(standard).unwrap());
        Source { summary: Some(found), ..source(label) }
    };
    let (fixed, tuned) = (tracked("Fixed reward", 417.0, 0.4446), tracked("Reasoner", 246.6, 0.4355));
    assert!(!written(std::slice::from_ref(&fixed)).contains("Matched"), "a single one is compared with nothing");
    let text = written(&[fixed, tuned]);
    let lines = [
        "\\caption{Matched comparison of settings on walk\\_turn. Means over episodes.}",
        "Setting & Survival (steps) $\\uparrow$ & Tracking RMSE (m) $\\downarrow$ & Activation $\\downarrow$ \\\\",
        "Fixed reward & 417.0 & 0.4446 & 0.2500 \\\\",
        "Reasoner & 246.6 & 0.4355 & 0.2500 \\\\",
    ];
    expect(&text, &lines);
    assert_eq!(text.matches("Matched").count(), 1, "the other task follows no motion");
}

#[test]
fn sessions_have_their_duration_divergence_and_outcome() {
    let played = |task: &str, duration: f64, comparison: Option<Option<f64>>, tracking: Option<f64>| Source {
        session: Some(Played {
            task: task.into(),
            decisions: 4,
            duration,
            outcome: "fall".into(),
            tracking: tracking.map(|rmse| Tracking { rmse, last: 1.0, largest: 2.0 }),
            comparison: comparison.map(|diverged| Comparison { policy: "cmc".into(), steps: 75, diverged }),
        }),
        ..source(task)
    };
    let text = written(&[
        played("walk", 0.75, Some(Some(0.53)), Some(0.158)),
        played("stairs", 0.8, Some(None), Some(0.173)),
        played("stand", 3.0, None, None),
    ]);
    let lines = [
        "Task & Duration (s) $\\uparrow$ & Div. (s) $\\uparrow$ & Tracking RMSE (m) $\\downarrow$ & Outcome \\\\",
        "walk & 0.75 & 0.53 & 0.158 & fall \\\\",
        "stairs & 0.80 & N/A & 0.173 & fall \\\\",
        "stand & 3.00 & -- & -- & fall \\\\",
    ];
    expect(&text, &lines);
}

#[test]
fn residuals_are_compared_by_success_and_electromyograms() {
    let muscle = |name: &str, correlation: f64| Similarity {
        muscle: name.into(),
        column: name.into(),
        cycles: 3,
        simulated: vec![],
        deviation: vec![],
        human: vec![],
        shift: 0.0,
        correlation,
        chance: 0.0,
        reached: 0.0,
    };
    let compared = |policy: &str, task: &str, found: &[f64]| Compared {
        policy: policy.into(),
        task: task.into(),
        found: found.iter().map(|correlation| muscle("soleus_r", *correlation)).collect(),
    };
    let sources = [
        Source { summary: Some(summary("prior", [1.0, 0.9])), ..source("a") },
        Source { summary: Some(summary("residual", [1.0, 1.0])), ..source("b") },
    ];
    let all = [
        compared("prior", "stand", &[0.71, 0.69, 0.63]),
        compared("residual", "stand", &[0.75, 0.80, 0.67]),
        compared("prior", "walk_turn", &[0.5, 0.25, 0.75, 0.5]),
    ];
    let text = latex(&tables(&columns(&sources), &sources, &all));
    let lines = [
        "& \\multicolumn{2}{c}{SR (\\%) $\\uparrow$} & \\multicolumn{2}{c}{EMG r $\\uparrow$} \\\\",
        "\\cmidrule(lr){2-3} \\cmidrule(lr){4-5}",
        "Task & prior & residual & prior & residual \\\\",
        "stand & \\textbf{100} & \\textbf{100} & 0.71/0.69/0.63 & \\textbf{0.75/0.80/0.67} \\\\",
        "walk\\_turn & 90 & \\textbf{100} & \\textbf{0.50} & -- \\\\",
    ];
    expect(&text, &lines);
}
