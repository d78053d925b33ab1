//! `msk mutate [FILES]`: one-token changes that nothing notices.

use crate::error::{Error, FAILURE};
use crate::project::{Project, style};
use clap::ValueEnum;
use msk::compiler::mutation::{self, Class, Part};
use msk::runtime::library::FileLoader;
use msk::runtime::testing::mutation::{Count, Notice, Verdict, mutate};
use serde_json::json;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Make every one-token change of tasks and list those that neither checks nor tests notice
///
/// Signs, comparisons, units, sides, axes, rates, numbers, weights, `and` and `or`, functions: each is changed by itself in every
/// formula of the task's values, terms, ends and success. A change is noticed by an error, by a warning more, as `msk check` tells
/// it, or by a test of the task that fails. Exit code 0 if fewer than --most of these changes go unseen, 1 if more do.
#[derive(clap::Args)]
pub struct Args {
    /// Files with tasks, or suites of them
    #[arg(default_value = "tasks.msk")]
    files: Vec<PathBuf>,
    /// Only this task
    #[arg(long)]
    task: Option<String>,
    /// Change scenes, beginnings and channels, too: a table of its own
    #[arg(long)]
    surroundings: bool,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Per cent of changes that may go unseen
    #[arg(long, default_value_t = 100.0)]
    most: f64,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: the unseen changes, then a table by class
    Text,
    /// For machines: a line per change
    Json,
}

/// Makes the changes.
///
/// # Errors
/// Errors in a file, or no such task.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut out = io::stdout().lock();
    let mut all: Vec<Verdict> = Vec::new();
    let mut known: Vec<String> = Vec::new();
    let parts = if args.surroundings { &Part::ALL[..] } else { &[Part::Meaning] };
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
                    .map_err(|report| Error::told(report.render(style(&io::stderr()))))?;
                for verdict in &verdicts {
                    tell(&mut out, args.format, &name, path, text, verdict)?;
                }
                if args.format == Format::Text {
                    let count = meaning(&verdicts);
                    writeln!(out, "{name}: {} of {} changes unseen", count.unseen, count.all)?;
                    if args.surroundings {
                        let count = Count::of(verdicts.iter(), |part, _| part != Part::Meaning);
                        writeln!(out, "{name}: {} of {} changes of its surroundings unseen", count.unseen, count.all)?;
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
        return Err(Error::new("there is nothing to change").hint("give a file with tasks, or the name of one with `--task`"));
    }
    let total = meaning(&all);
    if args.format == Format::Text {
        let classes =
            Class::ALL.map(|class| (class.name(), Count::of(all.iter(), |part, known| part == Part::Meaning && known == class)));
        write!(out, "\n{}", table("change", &classes, total))?;
        if args.surroundings {
            let around = |part: &Part| *part != Part::Meaning;
            let count = |part: Part| (part.name(), Count::of(all.iter(), |known, _| known == part));
            let rows: Vec<(&str, Count)> = Part::ALL.into_iter().filter(around).map(count).collect();
            write!(out, "\n{}", table("surroundings", &rows, Count::of(all.iter(), |part, _| part != Part::Meaning)))?;
        }
    }
    let share = percent(total.unseen, total.all);
    Ok(if share <= args.most { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

fn tell(out: &mut impl Write, format: Format, task: &str, path: &str, text: &str, verdict: &Verdict) -> Result<(), Error> {
    let mutant = &verdict.mutant;
    let start = mutant.span.start as usize;
    let line = text[..start].matches('\n').count() + 1;
    let from = mutant.span.of(text);
    match format {
        Format::Json => {
            let told = json!({
                "task": task,
                "file": path,
                "line": line,
                "part": mutant.part,
                "class": mutant.class,
                "from": from,
                "to": mutant.replacement,
                "noticed": verdict.notice,
                "by": verdict.by,
            });
            writeln!(out, "{told}")?;
        }
        Format::Text if verdict.notice == Notice::Unseen => {
            let whole = text.lines().nth(line - 1).unwrap_or_default().trim();
            let class = mutant.class.name();
            writeln!(out, "{path}:{line}: {class}: `{from}` -> `{}` in `{whole}`", mutant.replacement)?;
        }
        Format::Text => {}
    }
    Ok(())
}

/// Changes of what tasks mean.
fn meaning(verdicts: &[Verdict]) -> Count {
    Count::of(verdicts.iter(), |part, _| part == Part::Meaning)
}

fn table(title: &str, rows: &[(&str, Count)], total: Count) -> String {
    let mut text = format!("| {title} | all | checks | lints | tests | unseen |\n|:--|--:|--:|--:|--:|--:|\n");
    let row = |name: &str, count: Count| {
        format!("| {name} | {} | {} | {} | {} | {} |\n", count.all, count.checks, count.lints, count.tests, count.unseen)
    };
    for (name, count) in rows.iter().filter(|(_, count)| count.all > 0) {
        text += &row(name, *count);
    }
    let share = |part| format!("{:.1} %", percent(part, total.all));
    let shares = [total.checks, total.lints, total.tests, total.unseen].map(share).join(" | ");
    format!("{text}{}| | | {shares} |\n", row("all", total))
}

fn percent(part: usize, all: usize) -> f64 {
    if all == 0 { 0.0 } else { 100.0 * part as f64 / all as f64 }
}
