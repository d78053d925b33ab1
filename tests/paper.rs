//! The benchmark's tasks beside the paper's tables: weights, constants, observations, ends and success, row by row.
//!
//! What the paper says is typed once, in `tests/paper/*.toml`. Whatever differs is named there with a reason, which the task
//! itself gives behind `ours:`; nothing else may differ. `docs/paper.md` lists it; `MSK_UPDATE=1` writes it anew.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

#[path = "paper/beginning.rs"]
mod beginning;

use beginning::Beginning;
use msk::compiler::compile;
use msk::compiler::snapshot::{Section, Snapshot};
use msk::compiler::task::CompiledTask;
use msk::runtime::library::{BodyLibrary, FileLoader};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The suite, and the tasks that are written but not proven.
const FILES: [&str; 1] = ["tasks.msk"];
const FAMILIES: [&str; 3] = ["stabilization", "locomotion", "interaction"];

#[derive(Deserialize)]
struct Sheet {
    task: Vec<Paper>,
}

/// A task in the paper.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Paper {
    name: String,
    terms: Vec<Row>,
    #[serde(default)]
    extra_terms: Vec<Extra>,
    observations: Channels,
    beginning: Beginning,
    scene: Option<Saying>,
    ends: Vec<EndRow>,
    #[serde(default)]
    extra_ends: Vec<String>,
    success: EndRow,
}

/// A row of a table of rewards; several of our terms may stand for it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    paper: String,
    formula: String,
    weight: Vec<f64>,
    #[serde(default)]
    numbers: Vec<f64>,
    #[serde(default)]
    without: Vec<f64>,
    ours: Vec<String>,
    #[serde(default)]
    differs: String,
}

/// Terms that the paper does not list.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Extra {
    ours: BTreeMap<String, f64>,
    differs: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Channels {
    paper: String,
    ours: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Saying {
    paper: String,
    #[serde(default)]
    differs: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EndRow {
    paper: String,
    #[serde(default)]
    numbers: Vec<f64>,
    #[serde(default)]
    without: Vec<f64>,
    #[serde(default)]
    ours: Vec<String>,
    #[serde(default)]
    differs: String,
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn sheets() -> Vec<(&'static str, Paper)> {
    let read = |family: &'static str| {
        let path = root().join(format!("tests/paper/{family}.toml"));
        let text = std::fs::read_to_string(&path).unwrap();
        let sheet: Sheet = toml::from_str(&text).unwrap_or_else(|error| panic!("{}:\n{error}", path.display()));
        sheet.task.into_iter().map(move |task| (family, task)).collect::<Vec<_>>()
    };
    FAMILIES.into_iter().flat_map(read).collect()
}

fn tasks() -> Vec<Arc<CompiledTask>> {
    let compiled = |file: &&str| {
        let compilation = compile(&root().join(file), &FileLoader, &BodyLibrary::default());
        compilation.unwrap_or_else(|report| panic!("{file}:\n{report}")).tasks
    };
    FILES.iter().flat_map(compiled).collect()
}

/// The reasons that a task gives for what differs: what stands behind `ours:`, up to the next `paper:` or the comment's end.
fn reasons(family: &str, task: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(format!("tasks/{family}/{task}.msk"))).unwrap();
    let mut reasons = Vec::new();
    let mut open: Option<String> = None;
    for line in text.lines() {
        let Some((_, comment)) = line.split_once("//") else {
            reasons.extend(open.take());
            continue;
        };
        let comment = comment.trim_start_matches(['/', '!']).trim();
        let (before, after) = match comment.split_once("ours:") {
            Some((before, after)) => (before, Some(after)),
            None => (comment, None),
        };
        if before.starts_with("paper:") {
            reasons.extend(open.take());
        } else if let Some(reason) = &mut open {
            *reason += &format!(" {}", before.trim());
        }
        if let Some(after) = after {
            open = Some(after.trim().to_owned());
        }
    }
    reasons.extend(open);
    reasons
}

/// What one comparison finds.
struct Comparison<'a> {
    paper: &'a Paper,
    snapshot: Snapshot,
    horizon: u32,
    reasons: Vec<String>,
    used: Vec<bool>,
    problems: Vec<String>,
    /// Rows of the list: what, the paper's, why ours differs.
    listed: Vec<[String; 3]>,
}

impl Comparison<'_> {
    fn problem(&mut self, text: String) {
        self.problems.push(format!("{}: {text}", self.paper.name));
    }

    fn section(&self, kind: &str, name: &str) -> Option<&Section> {
        self.snapshot.sections.iter().find(|section| section.kind == kind && section.name == name)
    }

    /// The reason that the task gives and the sheet begins.
    fn differs(&mut self, what: &str, paper: &str, begins: &str) {
        if begins.is_empty() {
            return;
        }
        let found: Vec<usize> = (0..self.reasons.len()).filter(|&index| self.reasons[index].starts_with(begins)).collect();
        let Some(&first) = found.first() else {
            return self.problem(format!("{what}: no comment gives the reason `ours: {begins}...`"));
        };
        found.into_iter().for_each(|index| self.used[index] = true);
        self.listed.push([what.to_owned(), paper.to_owned(), self.reasons[first].clone()]);
    }

    /// Whether the numbers of a formula of the paper are among the constants of ours, and no others are said to be missing.
    fn numbers(&mut self, what: &str, ours: &[&Section], numbers: &[f64], without: &[f64], differs: &str) {
        let known: Vec<f64> = ours.iter().flat_map(|section| constants(section)).chain([f64::from(self.horizon)]).collect();
        let has = |number: &f64| known.iter().any(|known| (known - number.abs()).abs() < 1e-9);
        let missing: Vec<f64> = numbers.iter().copied().filter(|number| !has(number)).collect();
        if missing != without {
            self.problem(format!(
                "{what}: of the paper's numbers {numbers:?}, ours lacks {missing:?}, and {without:?} are said to be lacking"
            ));
        }
        if !without.is_empty() && differs.is_empty() {
            self.problem(format!("{what}: numbers are missing for no reason"));
        }
    }

    fn terms(&mut self) {
        let mut told: Vec<&str> = Vec::new();
        let paper = self.paper;
        for row in &paper.terms {
            let what = format!("term `{}`", row.paper);
            let mut sections = Vec::new();
            assert_eq!(row.weight.len(), row.ours.len(), "{}: {what}: a weight for each of our terms", paper.name);
            for (name, weight) in row.ours.iter().zip(&row.weight) {
                told.push(name);
                let Some(section) = self.section("term", name).cloned() else {
                    self.problem(format!("{what}: there is no term `{name}`"));
                    continue;
                };
                if section.get("weight") != Some(weight.to_string().as_str()) {
                    self.problem(format!("{what}: the paper's weight is {weight}, that of `{name}` {:?}", section.get("weight")));
                }
                sections.push(section);
            }
            let sections: Vec<&Section> = sections.iter().collect();
            self.numbers(&what, &sections, &row.numbers, &row.without, &row.differs);
            self.differs(&what, &format!("{}, {:?}", row.formula, row.weight), &row.differs);
        }
        for extra in &paper.extra_terms {
            for (name, weight) in &extra.ours {
                told.push(name);
                let found = self.section("term", name).and_then(|section| section.get("weight")).map(str::to_owned);
                if found != Some(weight.to_string()) {
                    self.problem(format!(
                        "the term `{name}`, which the paper does not list, has the weight {found:?}, not {weight}"
                    ));
                }
            }
            let names: Vec<&str> = extra.ours.keys().map(String::as_str).collect();
            self.differs(&format!("terms {}", names.join(", ")), "not listed", &extra.differs);
        }
        let own: Vec<String> = self.snapshot.sections.iter().filter(|s| s.kind == "term").map(|s| s.name.clone()).collect();
        for name in own.iter().filter(|name| !told.contains(&name.as_str())) {
            self.problem(format!("the term `{name}` stands for no row of the paper"));
        }
    }

    fn channels(&mut self, task: &CompiledTask) {
        let account = msk::compiler::explain::account(task, &msk::compiler::explain::Options::default());
        let own = account.observation.channels.iter().filter(|channel| channel.block.is_empty());
        let own: Vec<&str> = own.map(|channel| channel.name.as_str()).collect();
        if own != self.paper.observations.ours {
            let problem = format!("for `{}` the task observes {own:?}", self.paper.observations.paper);
            self.problem(problem);
        }
    }

    fn beginning(&mut self, task: &CompiledTask) {
        let paper = self.paper;
        self.differs("beginning", &paper.beginning.paper, &paper.beginning.differs);
        let (problems, mut rows) = beginning::compare(&paper.beginning, &self.snapshot, &task.vocabulary);
        problems.into_iter().for_each(|problem| self.problem(problem));
        self.listed.append(&mut rows);
    }

    fn ends(&mut self) {
        let paper = self.paper;
        let mut told: Vec<&str> = paper.extra_ends.iter().map(String::as_str).collect();
        for row in &paper.ends {
            let what = format!("end `{}`", row.paper);
            let sections: Vec<Section> = row.ours.iter().filter_map(|name| self.section("terminate", name).cloned()).collect();
            if sections.len() != row.ours.len() {
                self.problem(format!("{what}: of the ends {:?} only {} are there", row.ours, sections.len()));
            }
            told.extend(row.ours.iter().map(String::as_str));
            let sections: Vec<&Section> = sections.iter().collect();
            self.numbers(&what, &sections, &row.numbers, &row.without, &row.differs);
            self.differs(&what, "", &row.differs);
        }
        let own: Vec<String> = self.snapshot.sections.iter().filter(|s| s.kind == "terminate").map(|s| s.name.clone()).collect();
        for name in own.iter().filter(|name| !told.contains(&name.as_str())) {
            self.problem(format!("the end `{name}` stands for nothing in the paper"));
        }
        let extra: Vec<&String> = paper.extra_ends.iter().filter(|name| own.contains(name)).collect();
        if extra.len() != paper.extra_ends.len() {
            self.problem(format!("of the further ends {:?} only {extra:?} are there", paper.extra_ends));
        }
        let success = self.section("success", "").cloned();
        let success: Vec<&Section> = success.iter().collect();
        self.numbers("success", &success, &paper.success.numbers, &paper.success.without, &paper.success.differs);
        self.differs("success", &paper.success.paper, &paper.success.differs);
    }

    /// Every reason that the task gives must be on the list, unless it says that nothing differs.
    fn nothing_untold(&mut self) {
        let untold: Vec<String> = (0..self.reasons.len())
            .filter(|&index| !self.used[index] && !self.reasons[index].starts_with("the same"))
            .map(|index| self.reasons[index].clone())
            .collect();
        for reason in untold {
            self.problem(format!("the task gives a reason that no row has: `ours: {reason}`"));
        }
    }
}

/// Constants in what a section computes, in SI units, without their signs.
fn constants(section: &Section) -> Vec<f64> {
    let lines = section.graph.iter().filter_map(|line| line.split_once("constant ").map(|(_, values)| values));
    let values = lines.flat_map(|values| values.split(' ')).filter(|value| !value.starts_with('x'));
    values.filter_map(|value| value.parse::<f64>().ok()).map(f64::abs).collect()
}

fn compared() -> (Vec<String>, String) {
    let tasks = tasks();
    let mut problems = Vec::new();
    let mut list = String::from(HEAD);
    let sheets = sheets();
    for task in &tasks {
        if !sheets.iter().any(|(_, paper)| paper.name == task.name) {
            problems.push(format!("{}: not in the paper's tables", task.name));
        }
    }
    for (family, paper) in &sheets {
        let Some(task) = tasks.iter().find(|task| task.name == paper.name) else { continue };
        let reasons = reasons(family, &paper.name);
        let mut comparison = Comparison {
            paper,
            snapshot: task.snapshot(),
            horizon: task.horizon,
            used: vec![false; reasons.len()],
            reasons,
            problems: Vec::new(),
            listed: Vec::new(),
        };
        comparison.terms();
        comparison.channels(task);
        comparison.beginning(task);
        if let Some(scene) = &paper.scene {
            comparison.differs("scene", &scene.paper, &scene.differs);
        }
        comparison.ends();
        comparison.nothing_untold();
        problems.append(&mut comparison.problems);
        let _ = writeln!(list, "\n## {}\n\n| what | paper | ours |\n|:--|:--|:--|", paper.name);
        for [what, theirs, ours] in comparison.listed {
            let cell = |text: &str| text.replace('|', "\\|");
            let _ = writeln!(list, "| {} | {} | {} |", cell(&what), cell(&theirs), cell(&ours));
        }
    }
    (problems, list)
}

const HEAD: &str = "# Where our tasks differ from the paper's tables

Written by `MSK_UPDATE=1 cargo test --test paper`, which compares every row of the tables (typed into `tests/paper/*.toml`) with the
compiled tasks: weights, constants, observations, beginnings, ends and success. What is not listed here is as the paper says; where
the paper abbreviates a beginning, the figures of its published code stand for it (rad, m, m/s; `noise` as standard deviations).
Wherever a body begins on the ground, so do its soles, hands or knees, whatever height of the root was published.
";

#[test]
fn nothing_differs_from_the_paper_but_what_is_said_with_a_reason() {
    let (problems, list) = compared();
    assert!(problems.is_empty(), "\n{}", problems.join("\n"));
    let path: &Path = &root().join("docs/paper.md");
    if std::env::var_os("MSK_UPDATE").is_some() {
        std::fs::write(path, &list).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap_or_default();
    assert!(written == list, "docs/paper.md is not up to date: write it with MSK_UPDATE=1");
}

#[test]
fn the_paper_has_twenty_two_tasks() {
    assert_eq!(sheets().len(), 22);
}
