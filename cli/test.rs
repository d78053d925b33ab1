//! `msk test [FILES]`: the tests inside files.

use crate::error::{Context, Error, FAILURE};
use crate::eval::in_path;
use crate::levels::LevelArgs;
use crate::output;
use crate::policies::Limits;
use crate::project::{Project, Settings};
use crate::ranking;
use crate::terminal;
use clap::ValueEnum;
use msk::compiler::diagnostics::{FileId, Span};
use msk::compiler::task::CompiledTask;
use msk::evaluate::testing::{self, Stage, TestReport};
use msk::runtime::episode::Environment;
use msk::runtime::policy::PolicySource;
use msk::view::{Caption, Recorder, Recording, page};
use msk_storage::Folder;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Run the tests inside files: `test "..." { }` and `cheat "..." { }` of all tasks
///
/// Plays the script of each test, or runs a policy where the test has `run`, and evaluates its expectations; results depend
/// neither on random numbers nor on the number of cores. The ranking of its cheats follows the tests of each task: the
/// returns of the demonstration (the first test that expects `success` at its end) and of every cheat, held to the horizon;
/// each cheat must stay below the demonstration. Tests with `run policy` test the policy of --policy. Exit code 0 if every test passes, 1 if one fails or there is no test.
#[derive(clap::Args)]
pub struct Args {
    /// Files with tasks, or suites of them
    #[arg(default_value = "tasks.msk")]
    files: Vec<PathBuf>,
    /// Only tests whose task and title, `stand: a fall ends it`, contain this
    #[arg(long, value_name = "TEXT")]
    filter: Option<String>,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// The policy that tests with `run policy` test, as in `msk eval`; without it they are left out
    #[arg(long, value_name = "POLICY")]
    policy: Option<String>,
    #[command(flatten)]
    limits: Limits,
    /// Write a page for a browser to this folder for each test that fails: its episodes, step by step
    #[arg(long, value_name = "DIR")]
    html: Option<PathBuf>,
    #[command(flatten)]
    lints: LevelArgs,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Text for people: a line per test, and the failed expectations
    Text,
    /// JSON: a line per test
    Json,
}

/// Runs the tests.
///
/// # Errors
/// Errors in a file, a task without a body, or no test to run.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut out = terminal::out();
    let (mut seen, mut names) = (BTreeSet::new(), BTreeSet::new());
    let policy = args.policy.as_ref().map(|policy| args.limits.source(policy)).transpose()?;
    let (mut passed, mut failed, mut left_out, mut without) = (0, 0, 0, Vec::new());
    for file in &args.files {
        let project = Project::open_at(file, &args.settings.settings, &args.lints.levels)?;
        let fresh = project.compilation.tasks.iter().filter(|task| seen.insert(task.name.clone()));
        let tasks: Vec<&Arc<CompiledTask>> = fresh.collect();
        without.extend(tasks.iter().filter(|task| task.tests.is_none()).map(|task| task.name.clone()));
        let wanted = |task: &str, title: &str| args.filter.as_ref().is_none_or(|text| format!("{task}: {title}").contains(text));
        let mut jobs = Vec::new();
        for task in &tasks {
            let Some(tests) = &task.tests else { continue };
            let name = &task.name;
            let body =
                project.bodies.stage(&task.body, &task.scene).context(|| format!("task `{name}` has no body to run on"))?;
            let places = (0..tests.tests.len()).filter(|&place| wanted(name, &tests.tests[place].title));
            let (ready, waiting): (Vec<usize>, Vec<usize>) =
                places.partition(|&place| policy.is_some() || !tests.tests[place].needs_policy());
            left_out += waiting.len();
            jobs.extend(ready.into_iter().map(|place| (tests.as_ref(), body.clone(), place)));
        }
        let reports = testing::run_all(&jobs, policy.as_ref())?;
        if let Some(folder) = &args.html {
            write_pages(folder, &jobs, &reports, policy.as_ref(), &mut names)?;
        }
        passed += reports.iter().filter(|report| report.passed()).count();
        failed += reports.iter().filter(|report| !report.passed()).count();
        for reports in reports.chunk_by(|left, right| left.task == right.task) {
            match args.format {
                Format::Json => reports.iter().try_for_each(|report| writeln!(out, "{}", as_json(report, &project)))?,
                Format::Text => {
                    writeln!(out, "{}", reports[0].task)?;
                    reports.iter().try_for_each(|report| tell(&mut out, report, &project))?;
                    write!(out, "{}", ranking::table(&reports.iter().collect::<Vec<_>>()))?;
                }
            }
        }
    }
    if passed + failed == 0 {
        return Err(none(args.filter.as_deref(), left_out, &seen));
    }
    if args.format == Format::Text {
        if !without.is_empty() && args.filter.is_none() {
            writeln!(out, "without tests: {}", without.join(", "))?;
        }
        let waiting = if left_out > 0 {
            format!(", {left_out} left out: `--policy` names the policy that they test")
        } else {
            String::new()
        };
        writeln!(out, "{passed} passed, {failed} failed{waiting}")?;
    }
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

/// A page for each test that failed.
fn write_pages(
    folder: &Path,
    jobs: &[testing::Job<'_>],
    reports: &[TestReport],
    policy: Option<&PolicySource>,
    names: &mut BTreeSet<String>,
) -> Result<(), Error> {
    for ((tests, body, place), report) in jobs.iter().zip(reports).filter(|(_, report)| !report.passed()) {
        let mut recorders: BTreeMap<usize, Recorder> = BTreeMap::new();
        let mut look = |take: usize, episode: &Environment| {
            recorders.entry(take).or_insert_with(|| Recorder::new(episode, &[])).look(episode);
        };
        // What could not be played has been reported as such.
        let played = Stage::new(tests, body)?.with_policy(policy).show(*place, &mut look);
        let outcome = report.failures.iter().map(|failure| format!("expected {}, found {}", failure.expected, failure.found));
        let caption = Caption {
            task: report.task.clone(),
            policy: report.title.clone(),
            outcome: outcome.collect::<Vec<_>>().join("; "),
            ..Caption::default()
        };
        let label = |take: usize| if take == 0 { String::new() } else { format!("episode {}", take + 1) };
        let recordings: Vec<Recording> = recorders
            .into_iter()
            .filter_map(|(take, recorder)| recorder.recording(Caption { label: label(take), ..caption.clone() }).ok())
            .collect();
        if played.is_err() || recordings.is_empty() {
            continue;
        }
        let title = format!("{}: {}", report.task, report.title);
        let content = page(&title, &recordings)?;
        let name = file_name(&report.task, &report.title, names);
        output::write_in(&Folder::create(folder)?, &name, content)?;
        writeln!(terminal::notes(), "{}", folder.join(name).display())?;
    }
    Ok(())
}

/// The file of a test's page. Titles that differ in punctuation alone are numbered: no page takes the place of another.
fn file_name(task: &str, title: &str, names: &mut BTreeSet<String>) -> String {
    let stem = format!("{task}-{}", in_path(title));
    let numbered = (2_u64..).map(|number| format!("{stem}-{number}.html"));
    let fresh = [format!("{stem}.html")].into_iter().chain(numbered).find(|name| !names.contains(name));
    let name = fresh.unwrap_or_else(|| format!("{stem}.html"));
    names.insert(name.clone());
    name
}

/// Why no test was run.
fn none(filter: Option<&str>, left_out: usize, tasks: &BTreeSet<String>) -> Error {
    let names: Vec<&str> = tasks.iter().map(String::as_str).collect();
    match filter {
        _ if left_out > 0 => {
            Error::new("the tests run the policy that is tested, and none is named").hint("name it: `msk test --policy cmc`")
        }
        _ if names.is_empty() => Error::new("there is no task to test").hint("a task begins with `task NAME {`"),
        Some(filter) => Error::new(format!("no test contains `{filter}` in its task and title, as in `stand: a fall ends it`"))
            .hint(format!("the tasks are: {}", names.join(", "))),
        None => Error::new(format!("there is no test to run: tasks without tests are {}", names.join(", ")))
            .hint("tests are declared in their task: `test \"...\" { pose neutral; expect not success }`"),
    }
}

fn tell(out: &mut impl Write, report: &TestReport, project: &Project) -> Result<(), Error> {
    let kind = if report.cheat { "cheat " } else { "" };
    let mark = if report.passed() { "ok  " } else { "FAIL" };
    writeln!(out, "  {mark}  {kind}{}", report.title)?;
    for failure in &report.failures {
        writeln!(out, "        {}", place(failure.at, project))?;
        writeln!(out, "        expected {}", failure.expected)?;
        writeln!(out, "           found {}", failure.found)?;
    }
    Ok(())
}

fn as_json(report: &TestReport, project: &Project) -> serde_json::Value {
    let failures: Vec<serde_json::Value> = report
        .failures
        .iter()
        .map(|failure| {
            json!({
                "at": place(failure.at, project),
                "expected": failure.expected,
                "found": failure.found,
                "sides": failure.sides,
            })
        })
        .collect();
    json!({
        "task": report.task,
        "test": report.title,
        "cheat": report.cheat,
        "at": place(report.at, project),
        "passed": report.passed(),
        "failures": failures,
        "returns": report.ranking.as_ref().map(|ranking| ranking::figures(&ranking.returns)),
        "demonstration": report.ranking.as_ref().and_then(|ranking| ranking.demonstration.as_ref()).map(ranking::demonstration),
    })
}

/// `tasks/stabilization/stand.msk:70`
fn place((file, span): (FileId, Span), project: &Project) -> String {
    let sources = &project.compilation.sources;
    format!("{}:{}", sources.path(file), sources.line_column(file, span.start as usize).0)
}
