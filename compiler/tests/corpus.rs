//! The corpora of wrong programs, counted: defects of published tasks with what is said of each, and every code with its cases.
//!
//! The pages themselves are compared with what the compiler says by `meaning.rs` and `language.rs`; here is looked at what
//! they claim. `MSK_UPDATE=1 cargo test` rewrites the table of `defects/README.md`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use msk_compiler::diagnostics::codes;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What may be said of a defect, from what is best to what is worst.
const VERDICTS: [&str; 6] =
    ["impossible to express", "compile error", "lint", "caught by probing", "shown by the task's own test", "not caught"];

/// The least number of wrong programs.
const WRONG_PROGRAMS: usize = 300;

/// Codes that need a text larger than a page should hold, which `robustness.rs` and `statements.rs` hold, and the one of which the
/// compiler itself is the cause.
const LARGE: [&str; 6] = ["E0412", "E0121", "E0122", "E0123", "E0127", "E0131"];

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/language").join(name)
}

/// The pages of a folder, by name.
fn pages(name: &str) -> Vec<(String, String)> {
    let mut pages: Vec<_> = std::fs::read_dir(folder(name)).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md") && !page.ends_with("README.md"));
    pages.sort();
    let named = |page: PathBuf| (page.file_stem().unwrap().to_str().unwrap().to_owned(), std::fs::read_to_string(page).unwrap());
    pages.into_iter().map(named).collect()
}

/// A defect: its title, what is said of it, and its text.
struct Defect {
    title: String,
    verdict: &'static str,
    text: String,
}

fn defects(page: &str, text: &str) -> Vec<Defect> {
    text.split("\n## ")
        .skip(1)
        .map(|section| {
            let title = section.lines().next().unwrap().to_owned();
            let said = section.lines().find_map(|line| line.strip_prefix("Verdict: "));
            let said = said.unwrap_or_else(|| panic!("{page}: `{title}` says no verdict"));
            let verdict = VERDICTS.into_iter().find(|known| *known == said);
            let verdict = verdict.unwrap_or_else(|| panic!("{page}: `{said}` of `{title}` is no verdict"));
            Defect { title, verdict, text: section.to_owned() }
        })
        .collect()
}

#[test]
fn what_is_said_of_a_defect_is_what_the_compiler_says() {
    let mut wrong = Vec::new();
    for (page, text) in pages("defects") {
        for defect in defects(&page, &text) {
            let error = defect.text.contains("\nerror[E");
            let warning = defect.text.contains("\nwarning[W") || defect.text.contains("```text\nwarning[W");
            let error = error || defect.text.contains("```text\nerror[E");
            let holds = match defect.verdict {
                "compile error" => error,
                "lint" => warning,
                "caught by probing" => !error && defect.text.contains("\n```probed\n"),
                "not caught" | "shown by the task's own test" => !error,
                _ => true,
            };
            if !holds {
                wrong.push(format!("{page}: {}: {}", defect.title, defect.verdict));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_table_of_defects_counts_them() {
    let mut table = format!("| page | defects | {} |\n|---|---:|{}\n", VERDICTS.join(" | "), "---:|".repeat(VERDICTS.len()));
    let mut totals = [0; VERDICTS.len()];
    let mut row = |name: &str, counts: &[usize]| {
        let cells: Vec<String> = counts.iter().map(usize::to_string).collect();
        let _ = writeln!(table, "| {name} | {} | {} |", counts.iter().sum::<usize>(), cells.join(" | "));
    };
    for (page, text) in pages("defects") {
        let mut counts = [0; VERDICTS.len()];
        for defect in defects(&page, &text) {
            counts[VERDICTS.iter().position(|known| *known == defect.verdict).unwrap()] += 1;
        }
        totals.iter_mut().zip(counts).for_each(|(total, count)| *total += count);
        row(&format!("[{page}]({page}.md)"), &counts);
    }
    row("**all**", &totals);
    let path = folder("defects").join("README.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once("<!-- table -->\n").unwrap();
    let (_, after) = rest.split_once("<!-- /table -->").unwrap();
    let fresh = format!("{before}<!-- table -->\n{table}<!-- /table -->{after}");
    if std::env::var_os("MSK_UPDATE").is_some() {
        std::fs::write(&path, &fresh).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), fresh, "MSK_UPDATE=1 rewrites the table");
    assert!(totals.iter().sum::<usize>() > 150, "{totals:?}");
    assert_eq!(totals[VERDICTS.len() - 1], 0, "a defect that nothing shows");
}

#[test]
fn hundreds_of_wrong_programs_and_every_code_among_them() {
    let mut cases = 0;
    let mut by_code: BTreeMap<String, usize> = BTreeMap::new();
    for text in ["syntax", "meaning", "defects", "mistakes"].into_iter().flat_map(pages).map(|(_, text)| text) {
        for answer in text.split("\n```text\n").skip(1).map(|rest| rest.split("\n```").next().unwrap()) {
            let told = answer.lines().filter_map(|line| line.strip_prefix("error[").or(line.strip_prefix("warning[")));
            let told: Vec<&str> = told.map(|line| &line[..5]).collect();
            cases += usize::from(!told.is_empty());
            for code in told {
                *by_code.entry(code.to_owned()).or_default() += 1;
            }
        }
    }
    // Files of weights are no programs, and probing takes the model at hand: their own tests hold what is said of them.
    let programs = codes::all().filter(|code| !codes::weights::ALL.contains(code) && !codes::probing::ALL.contains(code));
    let seldom: Vec<String> = programs
        .filter(|code| !LARGE.contains(&code.id) && by_code.get(code.id).is_none_or(|count| *count < 2))
        .map(|code| format!("{} {}: {}", code.id, code.title, by_code.get(code.id).unwrap_or(&0)))
        .collect();
    println!("{cases} wrong programs, {} codes", by_code.len());
    assert!(cases >= WRONG_PROGRAMS, "{cases} wrong programs");
    assert!(seldom.is_empty(), "codes with fewer than two cases:\n{}", seldom.join("\n"));
}
