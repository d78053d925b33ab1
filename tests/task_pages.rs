//! `docs/tasks.md` and its pictures match the tasks: `MSK_UPDATE=1 cargo test --test suite task_pages` writes them anew.

use msk::compiler::compile;
use msk::compiler::explain::{EndReport, Options as Telling, TaskReport, task_report};
use msk::compiler::task::CompiledTask;
use msk::draw::{Options, View, svg};
use msk::runtime::episode::Environment;
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The suite.
const FILE: &str = "tasks.msk";
/// Beyond the benchmark: sequences, and tasks that differ in one number.
const COMPOSED: &str = "tasks/composed.msk";
const LOADS: &str = "tasks/loads.msk";
const FAMILIES: [&str; 3] = ["stabilization", "locomotion", "interaction"];
/// A picture is no larger, bytes.
const LARGEST: usize = 60_000;

fn at(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Compares a file with what it should hold, or writes it.
fn hold(path: &str, expected: &str) {
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::create_dir_all(at(path).parent().unwrap()).unwrap();
        std::fs::write(at(path), expected).unwrap();
    }
    let found = std::fs::read_to_string(at(path)).unwrap_or_default();
    assert!(found == expected, "{path} is not that of the tasks; `MSK_UPDATE=1 cargo test --test suite task_pages` writes it");
}

/// The tasks that the suites of a file name, in their order, and all that the file knows.
fn tasks_of(file: &str, bodies: &BodyLibrary) -> (Vec<Arc<CompiledTask>>, Vec<Arc<CompiledTask>>) {
    let compilation = compile(&at(file), &FileLoader, bodies).unwrap_or_else(|report| panic!("{report}"));
    let named = compilation.suites.iter().flat_map(|suite| &suite.families).flat_map(|(_, tasks)| tasks);
    let named = named.map(|name| compilation.tasks.iter().find(|task| task.name == *name).unwrap().clone()).collect();
    (named, compilation.tasks)
}

/// The first moment of a task, from the right and from behind or in front, wherever more of it is seen.
fn picture(task: &Arc<CompiledTask>, bodies: &BodyLibrary) -> String {
    let staged = bodies.stage(&task.body, &task.scene).unwrap();
    let episode = Environment::new(staged.model, staged.body, task.clone()).unwrap();
    assert!(episode.ending().is_none(), "{}: {:?}", task.name, episode.ending());
    let mean = task.scene.objects.iter().map(|object| object.position[0]).sum::<f64>();
    let views = vec![View::Side, if mean > 0.0 { View::Back } else { View::Front }];
    let options = Options { views, anatomy: false, markers: episode.markers(), ..Options::default() };
    svg(&episode.context().snapshot(), &options)
}

fn code(text: &str) -> String {
    format!("`{}`", text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|"))
}

fn ends(text: &mut String, title: &str, ends: &[EndReport]) {
    if ends.is_empty() {
        return;
    }
    let reasons: Vec<String> = ends
        .iter()
        .map(|end| {
            let after = if end.after.is_empty() { String::new() } else { format!(" after {}", end.after) };
            format!("{}{after} when {}", end.name, code(&end.condition.source))
        })
        .collect();
    let _ = writeln!(text, "{title}: {}.\n", reasons.join("; "));
}

fn succeeds(text: &mut String, title: &str, success: Option<&EndReport>) {
    if let Some(success) = success {
        let _ = writeln!(text, "{title} when {}.\n", code(&success.condition.source));
    }
}

/// Section of a task; the `parts` are those that a sequence runs.
fn section(report: &TaskReport, parts: &[TaskReport]) -> String {
    let mut text = String::new();
    let title = report.name.replace('_', " ");
    let _ = writeln!(text, "### {title}\n\n{}\n", report.summary);
    let _ = writeln!(text, "![Initial state of {title}](tasks/{}.svg)\n", report.name);
    let (seconds, steps, size) = (report.duration, report.horizon, report.observation.size);
    let _ = writeln!(text, "{steps} steps at {} Hz ({seconds} s), {size} observed values.\n", report.control_frequency);
    for motion in &report.motions {
        let start = motion.start.map_or("a phase drawn for each episode".to_owned(), |start| format!("phase {start}"));
        let _ = writeln!(text, "Follows the motion {} of {} s from {start}.\n", motion.title, motion.duration);
    }
    let sequence = report.phases.len() > 1;
    for phase in &report.phases {
        if sequence {
            let left = phase
                .until
                .as_ref()
                .map_or(format!("{} steps long", phase.horizon), |until| format!("until {}", code(&until.source)));
            let _ = writeln!(text, "**{}**, {left}:\n", phase.name.replace('_', " "));
        }
        let _ = writeln!(text, "| weight | term | formula |\n|---:|:---|:---|");
        for term in &phase.terms {
            let _ = writeln!(text, "| {} | {} | {} |", term.weight, term.name, code(&term.formula.source));
        }
        text.push('\n');
        ends(&mut text, "Failures", &phase.terminations);
        ends(&mut text, "Finishes", &phase.finishes);
        let alone = parts.iter().find(|part| part.name == phase.name).map_or(phase, |part| &part.phases[0]);
        succeeds(&mut text, "Succeeds", alone.success.as_ref());
    }
    if sequence {
        succeeds(&mut text, "The sequence succeeds", report.phases[0].success.as_ref());
    }
    text
}

/// Section, with its picture held beside it.
fn shown(task: &Arc<CompiledTask>, parts: &[TaskReport], bodies: &BodyLibrary) -> String {
    let picture = picture(task, bodies);
    assert!(picture.len() < LARGEST, "{}: {} bytes", task.name, picture.len());
    hold(&format!("docs/tasks/{}.svg", task.name), &picture);
    section(&task_report(task, &Telling::default()), parts)
}

/// Tasks that are one task but for its parameters.
fn study(tasks: &[Arc<CompiledTask>]) -> String {
    let mut text = "| task | description | parameters |\n|:---|:---|:---|\n".to_owned();
    for task in tasks {
        let report = task_report(task, &Telling::default());
        let set: Vec<String> = report.parameters.iter().map(|set| format!("{} {} {}", set.name, set.value, set.unit)).collect();
        let _ = writeln!(text, "| `{}` | {} | {} |", report.name, report.summary, set.join(", "));
    }
    text
}

#[test]
fn the_page_of_the_tasks_is_that_of_the_tasks() {
    let bodies = BodyLibrary::default();
    let (tasks, _) = tasks_of(FILE, &bodies);
    let mut page = "# The tasks\n\nWritten by `MSK_UPDATE=1 cargo test --test suite task_pages` from the texts in `tasks/`. The pictures show the \
        initial state\n(`msk draw --task NAME --plain`): from the right, and from behind or in front; the quartered disc is the centre \
        of mass, arrows are\nforces on the body.\n\n".to_owned();
    for family in FAMILIES {
        let _ = writeln!(page, "## {}{}\n", family[..1].to_uppercase(), &family[1..]);
        for task in tasks.iter().filter(|task| task.family == family) {
            page += &shown(task, &[], &bodies);
        }
    }
    page += "## Beyond the paper\n\nSequences run tasks one after the other in one episode (`tasks/composed.msk`); only the terms of the current\n\
        phase contribute to the reward. The load study (`tasks/loads.msk`) holds bars of four masses overhead, by the rewards of `powerlift`.\n\n";
    let (sequences, all) = tasks_of(COMPOSED, &bodies);
    let parts: Vec<TaskReport> = all.iter().map(|task| task_report(task, &Telling::default())).collect();
    for sequence in sequences {
        page += &shown(&sequence, &parts, &bodies);
    }
    let _ = writeln!(page, "### loads\n\n{}", study(&tasks_of(LOADS, &bodies).0));
    assert!(tasks.iter().all(|task| FAMILIES.contains(&task.family.as_str())));
    hold("docs/tasks.md", &(page.trim_end().to_owned() + "\n"));
}
