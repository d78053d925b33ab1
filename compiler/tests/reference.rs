//! The reference tells the truth: its examples are read, its list of codes is the compiler's.

use msk_compiler::check::action::spaces;
use msk_compiler::check::functions::{self, Function};
use msk_compiler::check::scene::elements;
use msk_compiler::diagnostics::{Code, FileId, Lint, codes, lints};
use msk_compiler::signals;
use msk_compiler::syntax::{self, UNITS};
use std::fmt::Write;
use std::path::Path;

fn path() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../grammar/REFERENCE.md")
}

fn page() -> String {
    std::fs::read_to_string(path()).unwrap()
}

#[test]
fn examples_are_read() {
    let mut wrong = String::new();
    for block in page().split("\n```msk").skip(1) {
        let (kind, rest) = block.split_once('\n').unwrap();
        let snippet = rest.split("\n```").next().unwrap();
        let text = match kind.trim() {
            "" => snippet.to_owned(),
            "task" => format!("task example {{\n{snippet}\n}}"),
            section => format!("task example {{ {section} {{\n{snippet}\n}} }}"),
        };
        for diagnostic in syntax::parse(FileId::default(), &text).diagnostics {
            let _ = writeln!(wrong, "{}: {}\n{snippet}\n", diagnostic.code.id, diagnostic.message);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// One code as a section of the reference.
fn section(code: &Code) -> String {
    let fence = |text: &str| format!("```text\n{text}\n```\n");
    format!(
        "### {}: {}\n\n{}{}\n\n{}\nis written\n\n{}\n",
        code.id,
        code.title,
        code.lint.map_or(String::new(), |lint| format!("Lint `{}`. ", lint.name)),
        code.explanation,
        fence(code.example),
        fence(code.fix)
    )
}

/// The lints, each with a link to its page.
fn lint_table() -> String {
    let row = |(code, lint): (&Code, Lint)| {
        format!("| {} | `{}` | {} | {} | {} |\n", code.id, lint.name, lint.level().name(), lint.stage.name(), code.title)
    };
    format!("| code | lint | level | stage | what it finds |\n|---|---|---|---|---|\n{}", lints().map(row).collect::<String>())
}

/// A table of functions.
fn table(functions: &[Function]) -> String {
    let row = |function: &Function| {
        let (takes, gives) = function.in_words();
        format!("| `{}` | {} | {takes} | {gives} |\n", function.signature, function.description)
    };
    format!("| function | value | takes | gives |\n|---|---|---|---|\n{}", functions.iter().map(row).collect::<String>())
}

#[test]
fn generated_parts_are_those_of_the_compiler() {
    let list = |codes: &[&'static Code]| codes.iter().map(|code| section(code)).collect::<String>();
    let meaning = [
        codes::names::ALL,
        codes::types::ALL,
        codes::tasks::ALL,
        codes::scene::ALL,
        codes::composition::ALL,
        codes::tests::ALL,
        codes::weights::ALL,
        codes::lints::ALL,
        codes::probing::ALL,
        codes::intent::ALL,
        codes::incentive::ALL,
        codes::slips::ALL,
        codes::exploits::ALL,
    ]
    .concat();
    let parts = [
        ("actions", spaces::markdown()),
        ("elements", elements::markdown()),
        ("codes", list(codes::syntax::ALL)),
        ("lints", lint_table()),
        ("signals", signals::markdown()),
        ("functions", table(functions::FUNCTIONS)),
        ("operators", table(functions::OPERATORS)),
        ("meaning", list(&meaning)),
    ];
    let mut page = page();
    for (name, expected) in parts {
        let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->\n"));
        let (before, rest) = page.split_once(&begin).unwrap();
        let (listed, after) = rest.split_once(&end).unwrap();
        let update = std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty());
        assert!(update || listed == expected, "the part `{name}` is out of date: MSK_UPDATE=1 rewrites it");
        page = format!("{before}{begin}{expected}{end}{after}");
    }
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::write(path(), page).unwrap();
    }
}

#[test]
fn units_are_listed() {
    let page = page();
    let table = page.split("## 3 Numbers and units").nth(1).unwrap().split("## 4").next().unwrap();
    for unit in UNITS {
        assert!(table.contains(&format!("`{unit}`")), "`{unit}` is missing");
    }
}
