//! The benchmark's tasks beside the paper's tables: weights, constants, observations, terminations and success, row by row.
//!
//! The content of the paper is typed once, in `tests/paper/*.toml`. Whatever differs is named there with a reason, which the task
//! itself gives behind `ours:`; nothing else may differ. Compared are contents, not names: the sensors, states and clocks that a
//! channel or a condition reads, and every constant that it adds to the paper's. `docs/paper.md` lists what differs; `MSK_UPDATE=1` writes it anew.

#[path = "paper/initial_state.rs"]
mod initial_state;

use initial_state::InitialState;
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
    initial_state: InitialState,
    scene: Option<Saying>,
    ends: Vec<EndRow>,
    #[serde(default)]
    extra_ends: Vec<ExtraEnd>,
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
    /// Constants of ours that the paper's formula does not have, but for 0 and 1.
    #[serde(default)]
    adds: Vec<f64>,
    /// What these are, where no reason of the task tells.
    #[serde(default)]
    of: String,
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
    /// What stands for it: channels with their contents, as [`contents`] tells them.
    ours: BTreeMap<String, String>,
    /// Why ours differs, where it does.
    #[serde(default)]
    differs: String,
    /// Channels that the paper does not list, with their contents.
    #[serde(default)]
    extra: BTreeMap<String, String>,
    /// What these are for.
    #[serde(default)]
    because: String,
}

/// What all tasks observe.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Base {
    paper: String,
    block: String,
    ours: BTreeMap<String, String>,
    differs: String,
}

/// A termination that the paper does not list.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExtraEnd {
    ours: String,
    reads: String,
    because: String,
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
    adds: Vec<f64>,
    /// What these are, where no reason of the task tells.
    #[serde(default)]
    of: String,
    /// What the condition reads, as [`contents`] tells it.
    reads: String,
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

    /// Whether the numbers of a formula of the paper are among the constants of ours, and all others on either side are declared.
    fn numbers(&mut self, what: &str, ours: &[&Section], declared: &Numbers<'_>) {
        let Numbers { numbers, without, adds, of, differs } = *declared;
        let own: Vec<f64> = ours.iter().flat_map(|section| constants(section)).collect();
        let among = |list: &[f64], number: f64| list.iter().any(|known| (known.abs() - number.abs()).abs() < 1e-9);
        let known = [own.as_slice(), &[f64::from(self.horizon)]].concat();
        let missing: Vec<f64> = numbers.iter().copied().filter(|&number| !among(&known, number)).collect();
        if missing != without {
            self.problem(format!(
                "{what}: of the paper's numbers {numbers:?}, ours lacks {missing:?}, and {without:?} are said to be lacking"
            ));
        }
        let mut more: Vec<f64> =
            own.into_iter().filter(|&number| !among(numbers, number) && !among(&[0.0, 1.0], number)).collect();
        more.sort_by(f64::total_cmp);
        more.dedup();
        if more.len() != adds.len() || !more.iter().all(|&number| among(adds, number)) {
            self.problem(format!("{what}: ours adds the numbers {more:?}, and {adds:?} are said to be added"));
        }
        let added = !adds.is_empty() && of.is_empty();
        if (!without.is_empty() || added) && differs.is_empty() || adds.is_empty() && !of.is_empty() {
            self.problem(format!("{what}: numbers are missing or added for no reason, or a reason is given for none"));
        }
        if !of.is_empty() {
            let numbers: Vec<String> = adds.iter().map(|number| format!("{}", (number * 1e4).round() / 1e4)).collect();
            self.listed.push([what.to_owned(), "not given".into(), format!("{}: {of}", numbers.join(", "))]);
        }
    }

    /// Whether conditions read what the table declares.
    fn reads(&mut self, what: &str, ours: &[&Section], reads: &str) {
        let found = contents(ours);
        if found != reads {
            self.problem(format!("{what}: reads = \"{found}\", and \"{reads}\" is said"));
        }
    }

    fn terms(&mut self) {
        let mut listed: Vec<&str> = Vec::new();
        let paper = self.paper;
        for row in &paper.terms {
            let what = format!("term `{}`", row.paper);
            let mut sections = Vec::new();
            assert_eq!(row.weight.len(), row.ours.len(), "{}: {what}: a weight for each of our terms", paper.name);
            for (name, weight) in row.ours.iter().zip(&row.weight) {
                listed.push(name);
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
            self.numbers(&what, &sections, &Numbers::of_term(row));
            self.differs(&what, &format!("{}, {:?}", row.formula, row.weight), &row.differs);
        }
        for extra in &paper.extra_terms {
            for (name, weight) in &extra.ours {
                listed.push(name);
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
        for name in own.iter().filter(|name| !listed.contains(&name.as_str())) {
            self.problem(format!("the term `{name}` stands for no row of the paper"));
        }
    }

    fn channels(&mut self, task: &CompiledTask, base: &Base) {
        let report = msk::compiler::explain::task_report(task, &msk::compiler::explain::Options::default());
        let (mut own, mut shared) = (BTreeMap::new(), BTreeMap::new());
        for channel in &report.observation.channels {
            let sections: Vec<&Section> = self.section("channel", &channel.name).into_iter().collect();
            let found = contents(&sections);
            let map = if channel.block == base.block { &mut shared } else { &mut own };
            map.insert(channel.name.clone(), found);
        }
        if shared != base.ours {
            self.problem(format!("`{}` holds {}", base.block, as_toml(&shared)));
        }
        let observed = &self.paper.observations;
        let listed: BTreeMap<String, String> = observed.ours.clone().into_iter().chain(observed.extra.clone()).collect();
        if own != listed {
            let problem = format!("for `{}` the task observes {}", observed.paper, as_toml(&own));
            self.problem(problem);
        }
        self.differs("observation", &observed.paper, &observed.differs);
        if observed.extra.is_empty() != observed.because.is_empty() {
            self.problem("further channels need a reason behind `because`, and only they".to_owned());
        }
        if !observed.extra.is_empty() {
            let names: Vec<String> = observed.extra.keys().map(|name| format!("`{name}`")).collect();
            self.listed.push([format!("observation {}", names.join(", ")), "not listed".into(), observed.because.clone()]);
        }
    }

    fn initial_state(&mut self, task: &CompiledTask) {
        let paper = self.paper;
        self.differs("initial state", &paper.initial_state.paper, &paper.initial_state.differs);
        let (problems, mut rows) = initial_state::compare(&paper.initial_state, &self.snapshot, &task.vocabulary);
        problems.into_iter().for_each(|problem| self.problem(problem));
        self.listed.append(&mut rows);
    }

    fn ends(&mut self) {
        let paper = self.paper;
        let mut listed: Vec<&str> = paper.extra_ends.iter().map(|extra| extra.ours.as_str()).collect();
        for row in &paper.ends {
            let what = format!("termination `{}`", row.paper);
            let sections: Vec<Section> = row.ours.iter().filter_map(|name| self.section("terminate", name).cloned()).collect();
            if sections.len() != row.ours.len() {
                self.problem(format!("{what}: of the ends {:?} only {} are there", row.ours, sections.len()));
            }
            listed.extend(row.ours.iter().map(String::as_str));
            let sections: Vec<&Section> = sections.iter().collect();
            self.numbers(&what, &sections, &Numbers::of_end(row));
            self.reads(&what, &sections, &row.reads);
            self.differs(&what, "", &row.differs);
        }
        for extra in &paper.extra_ends {
            let what = format!("termination `{}`", extra.ours);
            let Some(section) = self.section("terminate", &extra.ours).cloned() else {
                self.problem(format!("{what} is said to be added, and is not there"));
                continue;
            };
            self.reads(&what, &[&section], &extra.reads);
            let condition = section.get("when").unwrap_or(&section.formula).to_owned();
            self.listed.push([what, "not listed".into(), format!("{}: {condition}", extra.because)]);
        }
        let own: Vec<String> = self.snapshot.sections.iter().filter(|s| s.kind == "terminate").map(|s| s.name.clone()).collect();
        for name in own.iter().filter(|name| !listed.contains(&name.as_str())) {
            self.problem(format!("the end `{name}` stands for nothing in the paper"));
        }
        let success = self.section("success", "").cloned();
        let success: Vec<&Section> = success.iter().collect();
        self.numbers("success", &success, &Numbers::of_end(&paper.success));
        self.reads("success", &success, &paper.success.reads);
        self.differs("success", &paper.success.paper, &paper.success.differs);
    }

    /// Every reason that the task gives must be on the list, unless it states that nothing differs.
    fn nothing_unlisted(&mut self) {
        let unlisted: Vec<String> = (0..self.reasons.len())
            .filter(|&index| !self.used[index] && !self.reasons[index].starts_with("the same"))
            .map(|index| self.reasons[index].clone())
            .collect();
        for reason in unlisted {
            self.problem(format!("the task gives a reason that no row has: `ours: {reason}`"));
        }
    }
}

/// The numbers of a row.
struct Numbers<'a> {
    numbers: &'a [f64],
    without: &'a [f64],
    adds: &'a [f64],
    of: &'a str,
    differs: &'a str,
}

impl<'a> Numbers<'a> {
    fn of_term(row: &'a Row) -> Self {
        Self { numbers: &row.numbers, without: &row.without, adds: &row.adds, of: &row.of, differs: &row.differs }
    }

    fn of_end(row: &'a EndRow) -> Self {
        Self { numbers: &row.numbers, without: &row.without, adds: &row.adds, of: &row.of, differs: &row.differs }
    }
}

/// What sections read of body, scene, time, chance and memory: the leaves of their graphs that are no constants, in order and
/// once each, joined by semicolons.
fn contents(sections: &[&Section]) -> String {
    let lines = sections.iter().flat_map(|section| &section.graph);
    let values = lines.filter_map(|line| line.split_once(" = ").map(|(_, value)| value));
    let mut leaves: Vec<&str> = values.filter(|value| !value.contains('%') && !value.starts_with("constant ")).collect();
    leaves.iter_mut().for_each(|leaf| *leaf = leaf.strip_prefix("sensors ").unwrap_or(leaf));
    leaves.sort_unstable();
    leaves.dedup();
    leaves.join("; ")
}

/// As it is typed in a sheet.
fn as_toml(channels: &BTreeMap<String, String>) -> String {
    let rows: Vec<String> = channels.iter().map(|(name, contents)| format!("\"{name}\" = \"{contents}\"")).collect();
    format!("{{ {} }}", rows.join(", "))
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
    let base: Base = toml::from_str(&std::fs::read_to_string(root().join("tests/paper/base.toml")).unwrap()).unwrap();
    let mut list = format!(
        "{HEAD}\n## All tasks\n\n| what | paper | ours |\n|:--|:--|:--|\n| observation | {} | {} |\n",
        base.paper, base.differs
    );
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
        comparison.channels(task, &base);
        comparison.initial_state(task);
        if let Some(scene) = &paper.scene {
            comparison.differs("scene", &scene.paper, &scene.differs);
        }
        comparison.ends();
        comparison.nothing_unlisted();
        problems.append(&mut comparison.problems);
        let _ = writeln!(list, "\n## {}\n\n| what | paper | ours |\n|:--|:--|:--|", paper.name);
        for [what, theirs, ours] in comparison.listed {
            let cell = |text: &str| text.replace('|', "\\|");
            let _ = writeln!(list, "| {} | {} | {} |", cell(&what), cell(&theirs), cell(&ours));
        }
    }
    (problems, list)
}

const HEAD: &str = "# Differences between our tasks and the paper's tables

Written by `MSK_UPDATE=1 cargo test --test suite paper`, which compares every row of the tables (typed into `tests/paper/*.toml`) with the
compiled tasks: weights, constants, the inputs of observations, terminations and success, initial states. Everything that is not listed here
is as in the paper; where the suite differs because the paper's formula rewards an exploit, [`tasks/paper.msk`](../tasks/paper.msk) has the
paper's formula. Where the paper abbreviates an initial state, the values of its published code are used (rad, m, m/s; `noise` as standard
deviations). If a body starts on the ground, its soles, hands or knees do, independent of the published height of the root.
";

#[test]
fn nothing_differs_from_the_paper_without_a_declared_reason() {
    let (problems, list) = compared();
    assert!(problems.is_empty(), "\n{}", problems.join("\n"));
    let path: &Path = &root().join("docs/paper.md");
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::write(path, &list).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap_or_default();
    assert!(written == list, "docs/paper.md is not up to date: write it with MSK_UPDATE=1");
}

#[test]
fn the_paper_has_twenty_two_tasks() {
    assert_eq!(sheets().len(), 22);
}
