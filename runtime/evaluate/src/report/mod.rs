//! The summary for people: Markdown whose tables are aligned, so that a terminal shows it well and a page renders it.

mod comparison;
mod overview;
mod standard;
mod table;

pub use comparison::comparison;
pub use overview::overview;
pub use table::{Table, as_code, in_markdown};

use super::{MetricSummary, Spread, Summary, TaskSummary, TermSummary};
use core::fmt::Write;
use msk_text::numbers::{exact, fixed, for_people};

/// The whole report.
pub fn markdown(summary: &Summary) -> String {
    let mut text = format!("# {}\n\n", heading(summary));
    let mut tasks = Table::new(&["task", "success [95 %]", "return", "steps", "ended by"]);
    for task in &summary.tasks {
        task_row(task, summary.protocol.episodes, &mut tasks);
    }
    text.push_str(&tasks.markdown());
    // Writing to a string cannot fail.
    let _ = write!(text, "\n{}\n", overview::coverage(summary));
    if summary.tasks.len() > 1 {
        let mut means = Table::new(&["family", "tasks", "success", "horizon"]);
        for group in summary.families.iter().chain([&summary.overall]) {
            means.row(vec![
                overview::group(group),
                group.tasks.to_string(),
                percent(group.success_rate),
                percent(group.horizon_part),
            ]);
        }
        let _ = write!(text, "\n{}", means.markdown());
    }
    text.push_str(&to_success(&summary.tasks));
    for task in &summary.tasks {
        faults(task, &mut text);
    }
    for task in summary.tasks.iter().filter(|task| !task.terms.is_empty()) {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n## {}: reward terms\n\n", in_markdown(&task.task));
        text.push_str(&terms(&task.terms));
        if !task.weights_versions.is_empty() {
            let versions = task.weights_versions.iter().map(|(version, count)| format!("{} ({count})", in_markdown(version)));
            let _ = write!(text, "\nWeights while it ran (episodes): {}\n", versions.collect::<Vec<_>>().join(", "));
        }
    }
    for task in summary.tasks.iter().filter(|task| !task.metrics.is_empty()) {
        let _ = write!(text, "\n## {}: metrics\n\n{}", in_markdown(&task.task), metrics(&task.metrics));
    }
    text.push_str(&standard::markdown(&summary.tasks));
    text.push_str(
        "\nReturn and steps: mean ± standard deviation over episodes. Interval: Wilson's. Families: means over\ntasks; horizon: mean fraction of it that an episode lasted. Value: mean over all steps; reward:\nweight times value; share: reward over the sum of the absolute values of all rewards.\n",
    );
    text
}

/// Returns up to success beside whole ones; empty where they are the same.
fn to_success(tasks: &[TaskSummary]) -> String {
    let differ = |task: &&TaskSummary| task.return_to_success.is_some() && task.return_to_success != task.total;
    let tasks: Vec<&TaskSummary> = tasks.iter().filter(differ).collect();
    if tasks.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["task", "return", "return to success"]);
    let row = |task: &TaskSummary| vec![task.task.clone(), spread(task.total), spread(task.return_to_success)];
    tasks.into_iter().for_each(|task| table.row(row(task)));
    const WORDS: &str = "Return to success: up to the first step at which success held, as evaluators that stop there\ncount it; of other episodes the whole return. Tasks in which both are the same are left out.\n";
    format!("\n## Returns up to success\n\n{}\n{WORDS}", table.markdown())
}

/// The first few faults in full: what broke matters more than how often.
fn faults(task: &TaskSummary, text: &mut String) {
    const SHOWN: usize = 3;
    for (episode, fault) in task.faults.iter().take(SHOWN) {
        // Writing to a string cannot fail.
        let _ = write!(text, "\nFault in {}, episode {episode}: {}\n", as_code(&task.task), in_markdown(fault));
    }
    if task.faults.len() > SHOWN {
        let _ = write!(text, "\n... and {} more episodes of {}\n", task.faults.len() - SHOWN, as_code(&task.task));
    }
}

/// The terms of one episode or task alone, as a table.
pub fn terms(terms: &[TermSummary]) -> String {
    let mut table = Table::new(&["term", "weight", "value / step", "reward / step", "share"]);
    for term in terms {
        table.row(term_row(term));
    }
    table.markdown()
}

/// The metrics as a table: mean over the steps, and value at the last step.
pub fn metrics(metrics: &[MetricSummary]) -> String {
    let mut table = Table::new(&["metric", "unit", "mean", "at the end"]);
    let number = |spread: Option<Spread>| match spread {
        None => "-".into(),
        Some(Spread { mean, deviation: None }) => for_people(mean),
        Some(Spread { mean, deviation: Some(deviation) }) => format!("{} ± {}", for_people(mean), for_people(deviation)),
    };
    for metric in metrics {
        let unit = if metric.unit.is_empty() { "-".to_owned() } else { metric.unit.clone() };
        table.row(vec![metric.name.clone(), unit, number(metric.mean), number(metric.last)]);
    }
    table.markdown()
}

/// What was run, in a line.
fn heading(summary: &Summary) -> String {
    let protocol = summary.protocol;
    let episodes = if protocol.episodes == 1 { "episode" } else { "episodes" };
    format!("Policy {}, {} {episodes} per task, seed {}", as_code(&summary.policy), protocol.episodes, protocol.seed)
}

fn task_row(task: &TaskSummary, planned: u64, table: &mut Table) {
    let label = label(task, planned);
    match &task.skipped {
        Some(reason) => table.remark(label, format!("skipped: {reason}")),
        None => table.row(vec![label, success(task), spread(task.total), spread(task.steps), endings(&task.ended_by, 2)]),
    }
}

/// The task, the condition of its muscles, and how many episodes there are where not all are.
fn label(task: &TaskSummary, planned: u64) -> String {
    let condition = if task.condition.is_none() { String::new() } else { format!(", {}", task.condition) };
    match task.episodes == planned || task.skipped.is_some() {
        true => format!("{}{condition}", task.task),
        false => format!("{}{condition}, {} so far", task.task, task.episodes),
    }
}

fn success(task: &TaskSummary) -> String {
    let [low, high] = task.success_interval.map(|bound| fixed(100.0 * bound, 0));
    task.success_rate.map_or("-".into(), |rate| format!("{} % [{low}, {high}]", fixed(100.0 * rate, 0)))
}

fn percent(part: Option<f64>) -> String {
    part.map_or("-".into(), |part| format!("{} %", fixed(100.0 * part, 0)))
}

/// The `most` most frequent ends, and how many episodes ended otherwise.
fn endings(ended_by: &[(String, u64)], most: usize) -> String {
    let named = ended_by.iter().take(most).map(|(reason, count)| format!("{reason} {count}"));
    let others: u64 = ended_by.iter().skip(most).map(|(_, count)| count).sum();
    named.chain((others > 0).then(|| format!("other {others}"))).collect::<Vec<_>>().join(", ")
}

fn term_row(term: &TermSummary) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or("-".into(), for_people);
    vec![
        term.name.clone(),
        exact(term.weight),
        number(term.value_per_step),
        number(term.pay_per_step),
        term.share.map_or("-".into(), |share| format!("{} %", fixed(100.0 * share, 2))),
    ]
}

/// One decimal, or none where the numbers are large, or powers of ten where they are very large.
fn spread(spread: Option<Spread>) -> String {
    let Some(Spread { mean, deviation }) = spread else { return "-".into() };
    if !mean.is_finite() || mean.abs() >= 1e6 {
        let deviation = deviation.map_or(String::new(), |deviation| format!(" ± {}", for_people(deviation)));
        return for_people(mean) + &deviation;
    }
    let decimals = usize::from(mean.abs() < 1000.0);
    let deviation = deviation.map_or(String::new(), |deviation| format!(" ± {}", fixed(deviation, decimals)));
    format!("{}{deviation}", fixed(mean, decimals))
}

#[cfg(test)]
mod tests {
    use super::super::{FamilySummary, Protocol, StandardSummary, wilson_interval};
    use super::*;
    use msk_runtime::condition::{MuscleCondition, Weakness};

    fn task(name: &str, family: &str, successes: u64) -> TaskSummary {
        TaskSummary {
            task: name.into(),
            family: family.into(),
            condition: MuscleCondition::default(),
            skipped: None,
            horizon: 1000,
            episodes: 50,
            successes,
            success_rate: Some(successes as f64 / 50.0),
            success_interval: wilson_interval(successes, 50),
            total: Some(Spread { mean: 38123.46, deviation: Some(1234.5) }),
            return_to_success: Some(Spread { mean: 30210.5, deviation: Some(99.0) }),
            steps: Some(Spread { mean: 970.0, deviation: Some(120.0) }),
            ended_by: vec![("horizon".into(), 40), ("fallen".into(), 7), ("tilted".into(), 2), ("fault".into(), 1)],
            faults: vec![],
            terms: vec![],
            weights_versions: vec![],
            metrics: vec![],
            standard: vec![],
            recruitment: vec![],
        }
    }

    fn standard(name: &str, mean: f64) -> StandardSummary {
        StandardSummary { name: name.into(), unit: String::new(), episodes: 50, value: Spread { mean, deviation: Some(0.5) } }
    }

    fn family(name: &str, mass: f64, share: f64) -> FamilySummary {
        FamilySummary { name: name.into(), mass, share }
    }

    fn nothing(name: &str) -> TaskSummary {
        TaskSummary {
            episodes: 0,
            success_rate: None,
            success_interval: [0.0, 1.0],
            total: None,
            return_to_success: None,
            steps: None,
            ended_by: vec![],
            ..task(name, "locomotion", 0)
        }
    }

    fn summary(tasks: Vec<TaskSummary>) -> Summary {
        Summary::new("cmc".into(), Protocol { episodes: 50, seed: 0 }, tasks)
    }

    #[test]
    fn the_report_fits_a_terminal_and_renders_as_tables() {
        let task = TaskSummary {
            faults: vec![(31, "at 0.2 s the velocity of joint `knee` (body `tibia`) is inf".into())],
            terms: vec![TermSummary {
                name: "pose".into(),
                weight: 10.0,
                value_per_step: Some(0.93),
                pay_per_step: Some(9.3),
                share: Some(0.25),
            }],
            weights_versions: vec![("0123456789abcdef".into(), 40), ("fedcba9876543210".into(), 10)],
            metrics: vec![MetricSummary {
                name: "lean".into(),
                unit: "rad".into(),
                mean: Some(Spread { mean: 0.5, deviation: None }),
                last: None,
            }],
            standard: vec![standard("activation_cost", 0.04417), standard("cost_of_transport", 3.25)],
            recruitment: vec![family("Calves", 1.25, 0.25), family("Glutes", 3.75, 0.75)],
            ..task("single_leg_stand", "stabilization", 47)
        };
        let summarized = task.clone();
        let text = markdown(&summary(vec![task]));
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
        assert!(text.contains("| task             | success [95 %] |"), "{text}");
        assert!(
            text.contains("| single_leg_stand |  94 % [84, 98] | 38123 ± 1234 | 970.0 ± 120.0 | horizon 40, fallen 7, other 3 |"),
            "{text}"
        );
        assert!(text.contains("| single_leg_stand | 38123 ± 1234 |        30210 ± 99 |"), "{text}");
        assert!(text.contains("\nFault in `single_leg_stand`, episode 31: at 0.2 s the velocity of joint `knee`"), "{text}");
        assert!(text.contains("| lean   |  rad |  0.5 |          - |"), "{text}");
        insta::assert_snapshot!(standard::markdown(&[self::task("run", "", 1), summarized]), @r"
        ## Standard metrics

        | task             | activation | smoothness | W/kg | transport | ground | joint |
        |:-----------------|-----------:|-----------:|-----:|----------:|-------:|------:|
        | single_leg_stand |    0.04417 |          - |    - |      3.25 |      - |     - |

        Activation: mean squared activation. Smoothness: log10 of the mean squared angular jerk,
        rad^2/s^6. W/kg: metabolic power. Transport: cost of transport. Ground, joint: largest reactions,
        body weights. Means over episodes.

        ## Recruitment

        | family | single_leg_stand |
        |:-------|-----------------:|
        | Calves |      1.25 (25 %) |
        | Glutes |      3.75 (75 %) |

        Sum over a family's muscles of their mean activations, and its part of that of all families.
        ");
        assert!(text.contains("| pose |     10 |         0.93 |           9.3 | 25.00 % |"), "{text}");
    }

    #[test]
    fn a_run_that_has_only_begun_says_so() {
        let text = markdown(&summary(vec![nothing("stand")]));
        assert!(text.contains("| stand, 0 so far |              - |      - |     - |"), "{text}");
    }

    #[test]
    fn the_overview_groups_tasks_by_family_with_their_means() {
        let reason = "no test of `run` plays a script up to `expect success`, and this reason is longer than a line";
        let fault = "at 0.2 s the velocity of joint `knee` (body `tibia`) is inf, which is longer than a line may be";
        let skipped = TaskSummary { skipped: Some(reason.into()), ..nothing("run") };
        let faulty = TaskSummary { faults: vec![(3, fault.into())], ..task("crawl", "locomotion", 0) };
        let weak = MuscleCondition { weakness: vec![Weakness { muscles: None, factor: 0.5 }], fatigue: None };
        let weak = TaskSummary { condition: weak, ..task("sit", "stabilization", 25) };
        let tasks = vec![task("single_leg_stand", "stabilization", 47), skipped, faulty, weak];
        insta::assert_snapshot!(overview(&summary(tasks)), @r"
        Policy `cmc`, 50 episodes per task, seed 0

        task                 success [95 %]  return  horizon  ended by
        stabilization                  72 %             97 %
          single_leg_stand    94 % [84, 98]   38123     97 %  horizon 40, other 10
          sit, weakness 0.5   50 % [37, 63]   38123     97 %  horizon 40, other 10
        locomotion (1 of 2)             0 %             97 %
          run                skipped: no test of `run` plays a script up to `expect s...
          crawl                  0 % [0, 7]   38123     97 %  horizon 40, other 10
        all tasks (3 of 4)             48 %             97 %

        [ ]: Wilson's interval; horizon: mean fraction of it that an episode lasted
        Fault in `crawl`, episode 3: at 0.2 s the velocity of joint `knee` (body `tib...
        Coverage: success in 2 of 4 tasks; played: 150 of 200 episodes, 1 task skipped
        ");
    }

    #[test]
    fn the_overview_of_a_single_task_is_its_row() {
        insta::assert_snapshot!(overview(&summary(vec![task("stand", "", 50)])), @r"
        Policy `cmc`, 50 episodes per task, seed 0

        task    success [95 %]  return  horizon  ended by
        stand  100 % [93, 100]   38123     97 %  horizon 40, other 10

        [ ]: Wilson's interval; horizon: mean fraction of it that an episode lasted
        Coverage: success in 1 of 1 tasks; played: 50 of 50 episodes
        ");
    }

    #[test]
    fn the_overview_of_many_tasks_fits_a_small_terminal() {
        let tasks = (0..22).map(|index| task(&format!("a_long_name_of_a_task_{index}"), ["a", "b", "c"][index / 8], 1)).collect();
        let text = overview(&summary(tasks));
        assert!(text.lines().all(|line| line.chars().count() <= 80) && text.lines().count() <= 36, "{text}");
    }
}
