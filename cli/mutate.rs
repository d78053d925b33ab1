//! `msk mutate [FILES]`: mutation testing of tasks.

use crate::error::{Error, FAILURE};
use crate::numbers::within;
use crate::project::Project;
use crate::terminal;
use clap::ValueEnum;
use msk::compiler::mutation::{self, Class, Part};
use msk::evaluate::testing::mutation::{Count, Outcome, Verdict, mutate};
use msk::runtime::library::FileLoader;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Mutate tasks, one token at a time, and list the mutants that neither checks nor lints nor tests kill
///
/// Signs, comparisons, units, sides, axes, rates, numbers, weights, `and` and `or`, functions: each is changed separately in
/// every formula of the task's values, terms, terminations and success. A mutant is killed by an error (checks), by an
/// additional warning of `msk check` (lints), or by a failing test of the task (tests); otherwise it survived. Exit code 1
/// if more mutants survived than --max-survivors or --max-scene-survivors allow.
#[derive(clap::Args)]
pub struct Args {
    /// Files with tasks, or suites of them
    #[arg(default_value = "tasks.msk")]
    files: Vec<PathBuf>,
    /// Only this task
    #[arg(long)]
    task: Option<String>,
    /// Also mutate scene, initial state and observation; they have a separate table
    #[arg(long)]
    include_scene: bool,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Percentage of the mutants of values, terms, terminations and success that may survive
    #[arg(long, value_name = "PERCENT", default_value_t = 100.0, value_parser = within(0.0, 100.0))]
    max_survivors: f64,
    /// Percentage of the mutants of scene, initial state and observation that may survive
    #[arg(long, value_name = "PERCENT", requires = "include_scene", value_parser = within(0.0, 100.0))]
    max_scene_survivors: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Text for people: the mutants that survived, then a table by class
    Text,
    /// JSON: a line per mutant
    Json,
}

/// Makes the mutants and tries to kill them.
///
/// # Errors
/// Errors in a file, or no such task.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut out = terminal::out();
    let mut all: Vec<Verdict> = Vec::new();
    let mut known: Vec<String> = Vec::new();
    let parts = if args.include_scene { &Part::ALL[..] } else { &[Part::Meaning] };
    for file in &args.files {
        let project = Project::open(file, &[])?;
        let compilation = &project.compilation;
        for source in compilation.sources.files() {
            let (path, text) = (compilation.sources.path(source), compilation.sources.text(source));
            for name in mutation::tasks(text) {
                known.push(name.clone());
                if args.task.as_ref().is_some_and(|task| *task != name) {
                    continue;
                }
                let verdicts = mutate(Path::new(path), text, &name, parts, &FileLoader, &project.bodies)
                    .map_err(|report| Error::rendered(&report))?;
                for verdict in &verdicts {
                    print(&mut out, args.format, &name, path, text, verdict)?;
                }
                if args.format == Format::Text {
                    let count = of_meaning(&verdicts);
                    writeln!(out, "{name}: {} of {} mutants survived", count.survived, count.all)?;
                    if args.include_scene {
                        let count = of_scene(&verdicts);
                        let parts = "scene, initial state and observation";
                        writeln!(out, "{name}: {} of {} mutants of {parts} survived", count.survived, count.all)?;
                    }
                }
                all.extend(verdicts);
            }
        }
    }
    if let Some(task) = args.task.as_ref().filter(|task| !known.contains(task)) {
        return Err(Error::new(format!("there is no task `{task}`")).hint(format!("there are: {}", known.join(", "))));
    }
    if all.is_empty() {
        return Err(Error::new("there is nothing to mutate").hint("give a file with tasks, or select one with `--task`"));
    }
    let (meaning, scene) = (of_meaning(&all), of_scene(&all));
    if args.format == Format::Text {
        let of_class = |class| Count::of(all.iter(), |part, known| part == Part::Meaning && known == class);
        let classes = Class::ALL.map(|class| (class.name(), of_class(class)));
        write!(out, "\n{}", table("mutation", &classes, meaning))?;
        if args.include_scene {
            let others = Part::ALL.into_iter().filter(|part| *part != Part::Meaning);
            let count = |part: Part| (part.name(), Count::of(all.iter(), |known, _| known == part));
            write!(out, "\n{}", table("mutated", &others.map(count).collect::<Vec<_>>(), scene))?;
        }
    }
    let survived = |count: Count| percent(count.survived, count.all);
    let scene_passes = args.max_scene_survivors.is_none_or(|most| survived(scene) <= most);
    let passes = survived(meaning) <= args.max_survivors && scene_passes;
    Ok(if passes { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

fn print(out: &mut impl Write, format: Format, task: &str, path: &str, text: &str, verdict: &Verdict) -> Result<(), Error> {
    let mutant = &verdict.mutant;
    let start = mutant.span.start as usize;
    let line = text[..start].matches('\n').count() + 1;
    let from = mutant.span.of(text);
    match format {
        Format::Json => {
            let record = json!({
                "task": task,
                "file": path,
                "line": line,
                "part": mutant.part,
                "class": mutant.class,
                "from": from,
                "to": mutant.replacement,
                "outcome": verdict.outcome.name(),
                "killed_by": verdict.outcome.killer(),
                "by": verdict.by,
            });
            writeln!(out, "{record}")?;
        }
        Format::Text if verdict.outcome == Outcome::Survived => {
            let whole = text.lines().nth(line - 1).unwrap_or_default().trim();
            let class = mutant.class.name();
            writeln!(out, "{path}:{line}: {class}: `{from}` -> `{}` in `{whole}`", mutant.replacement)?;
        }
        Format::Text => {}
    }
    Ok(())
}

/// Mutants of values, terms, terminations and success.
fn of_meaning(verdicts: &[Verdict]) -> Count {
    Count::of(verdicts.iter(), |part, _| part == Part::Meaning)
}

/// Mutants of scene, initial state and observation.
fn of_scene(verdicts: &[Verdict]) -> Count {
    Count::of(verdicts.iter(), |part, _| part != Part::Meaning)
}

fn table(title: &str, rows: &[(&str, Count)], total: Count) -> String {
    let heads = "all | killed by checks | by lints | by tests | survived";
    let mut text = format!("| {title} | {heads} |\n|:--|--:|--:|--:|--:|--:|\n");
    let row = |name: &str, count: Count| {
        format!("| {name} | {} | {} | {} | {} | {} |\n", count.all, count.checks, count.lints, count.tests, count.survived)
    };
    for (name, count) in rows.iter().filter(|(_, count)| count.all > 0) {
        text += &row(name, *count);
    }
    let share = |part| format!("{:.1} %", percent(part, total.all));
    let shares = [total.checks, total.lints, total.tests, total.survived].map(share).join(" | ");
    format!("{text}{}| | | {shares} |\n", row("all", total))
}

fn percent(part: usize, all: usize) -> f64 {
    if all == 0 { 0.0 } else { 100.0 * part as f64 / all as f64 }
}
