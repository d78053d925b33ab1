//! The corpora of wrong programs, counted: defects of published tasks and typical mistakes with the verdict on each, and every code
//! with its cases.
//!
//! The pages themselves are compared with the diagnostics of the compiler by `meaning.rs` and `language.rs`; here the verdicts
//! are compared with the answers below them. `MSK_UPDATE=1 cargo test` rewrites the tables of `defects/README.md` and
//! `mistakes/README.md`.

use msk_compiler::diagnostics::codes;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Verdicts on a defect, from the best to the worst.
const VERDICTS: [&str; 6] =
    ["impossible to express", "compile error", "lint", "caught by probing", "shown by the task's own test", "not caught"];

/// The verdicts on a typical mistake.
const MISTAKE_VERDICTS: [&str; 5] = ["compile error", "lint", "caught by probing", "not caught", "no mistake"];

/// How far the answer to a mistake that is caught helps to correct it.
const HELP: [&str; 3] = ["helpful", "partly", "poor"];

/// The least number of wrong programs.
const WRONG_PROGRAMS: usize = 300;

/// Codes that need a text larger than a page should hold, which `robustness.rs` and `statements.rs` hold, and the one of which the
/// compiler itself is the cause.
const LARGE: [&str; 7] = ["E0412", "E0121", "E0122", "E0123", "E0127", "E0131", "W0514"];

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

/// A defect: its title, its verdict, and its text.
struct Defect {
    title: String,
    verdict: &'static str,
    text: String,
}

impl Defect {
    /// Whether the answers below the text are of the kind that the verdict claims.
    fn verdict_holds(&self) -> bool {
        let error = self.text.contains("\nerror[E");
        let warning = self.text.contains("\nwarning[W");
        match self.verdict {
            "compile error" => error,
            "lint" => warning,
            "caught by probing" => !error && self.text.contains("\n```probed\n"),
            "not caught" | "shown by the task's own test" | "no mistake" => !error,
            _ => true,
        }
    }
}

fn defects(page: &str, text: &str) -> Vec<Defect> {
    text.split("\n## ")
        .skip(1)
        .map(|section| {
            let title = section.lines().next().unwrap().to_owned();
            let written = section.lines().find_map(|line| line.strip_prefix("Verdict: "));
            let written = written.unwrap_or_else(|| panic!("{page}: `{title}` says no verdict"));
            let verdict = VERDICTS.into_iter().find(|known| *known == written);
            let verdict = verdict.unwrap_or_else(|| panic!("{page}: `{written}` of `{title}` is no verdict"));
            Defect { title, verdict, text: section.to_owned() }
        })
        .collect()
}

#[test]
fn the_verdict_on_a_defect_is_that_of_the_compiler() {
    let mut wrong = Vec::new();
    for (page, text) in pages("defects") {
        let defects = defects(&page, &text);
        let claims = defects.iter().filter(|defect| !defect.verdict_holds());
        wrong.extend(claims.map(|defect| format!("{page}: {}: {}", defect.title, defect.verdict)));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A typical mistake with the verdict on its answer, and how far that helps; nothing where it is not caught or is no mistake.
struct Mistake {
    defect: Defect,
    help: Option<&'static str>,
}

/// The mistakes of a page; none where its sections carry no verdicts.
fn mistakes(page: &str, text: &str) -> Vec<Mistake> {
    if !text.contains("\nVerdict: ") {
        return Vec::new();
    }
    let read = |section: &str| {
        let title = section.lines().next().unwrap().to_owned();
        let written = section.lines().find_map(|line| line.strip_prefix("Verdict: "));
        let written = written.unwrap_or_else(|| panic!("{page}: `{title}` carries no verdict"));
        let (verdict, help) = written.split_once(", ").map_or((written, None), |(verdict, help)| (verdict, Some(help)));
        let known = |words: &[&'static str], word: &str| words.iter().copied().find(|known| *known == word);
        let verdict = known(&MISTAKE_VERDICTS, verdict).unwrap_or_else(|| panic!("{page}: `{title}`: {written}"));
        let help = help.map(|help| known(&HELP, help).unwrap_or_else(|| panic!("{page}: `{title}`: {written}")));
        let caught = !matches!(verdict, "not caught" | "no mistake");
        assert_eq!(help.is_some(), caught, "{page}: `{title}`: {written}");
        Mistake { defect: Defect { title, verdict, text: section.to_owned() }, help }
    };
    text.split("\n## ").skip(1).map(read).collect()
}

#[test]
fn the_verdict_on_a_mistake_is_what_the_compiler_says() {
    let mut wrong = Vec::new();
    for (page, text) in pages("mistakes") {
        let mistakes = mistakes(&page, &text);
        let claims = mistakes.iter().map(|mistake| &mistake.defect).filter(|defect| !defect.verdict_holds());
        wrong.extend(claims.map(|defect| format!("{page}: {}: {}", defect.title, defect.verdict)));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_table_of_mistakes_counts_them() {
    let kinds: Vec<&str> = MISTAKE_VERDICTS.into_iter().chain(HELP).collect();
    let mut table = format!("| page | texts | {} |\n|---|---:|{}\n", kinds.join(" | "), "---:|".repeat(kinds.len()));
    let mut totals = vec![0; kinds.len()];
    let mut uncaught = String::new();
    for (page, text) in pages("mistakes") {
        let mistakes = mistakes(&page, &text);
        if mistakes.is_empty() {
            continue;
        }
        let count = |kind: &&str| {
            mistakes.iter().filter(|mistake| mistake.defect.verdict == *kind || mistake.help == Some(*kind)).count()
        };
        let counts: Vec<usize> = kinds.iter().map(count).collect();
        totals.iter_mut().zip(&counts).for_each(|(total, count)| *total += count);
        let cells: Vec<String> = counts.iter().map(usize::to_string).collect();
        let _ = writeln!(table, "| [{page}]({page}.md) | {} | {} |", mistakes.len(), cells.join(" | "));
        for mistake in mistakes.iter().filter(|mistake| mistake.defect.verdict == "not caught") {
            let _ = writeln!(uncaught, "- {page}: {}", mistake.defect.title);
        }
    }
    let of = |kind: &str| totals[kinds.iter().position(|known| *known == kind).unwrap()];
    let (texts, slips) = (MISTAKE_VERDICTS.iter().map(|kind| of(kind)).sum::<usize>(), |texts: usize| texts - of("no mistake"));
    let cells: Vec<String> = totals.iter().map(usize::to_string).collect();
    let _ = writeln!(table, "| **all** | {texts} | {} |", cells.join(" | "));
    let _ = writeln!(table, "\nNot caught are {} of {}:\n\n{uncaught}", of("not caught"), slips(texts));
    between_marks(&folder("mistakes").join("README.md"), table.trim_end());
    assert!(texts > 150, "{texts}");
}

/// Compares what stands between the marks of a table with what it should be.
fn between_marks(path: &Path, table: &str) {
    let page = std::fs::read_to_string(path).unwrap();
    let (before, rest) = page.split_once("<!-- table -->\n").unwrap();
    let (_, after) = rest.split_once("<!-- /table -->").unwrap();
    let fresh = format!("{before}<!-- table -->\n{table}\n<!-- /table -->{after}");
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::write(path, &fresh).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), fresh, "MSK_UPDATE=1 rewrites the table");
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
    between_marks(&folder("defects").join("README.md"), table.trim_end());
    assert!(totals.iter().sum::<usize>() > 150, "{totals:?}");
    assert_eq!(totals[VERDICTS.len() - 1], 0, "a defect that nothing shows");
}

#[test]
fn hundreds_of_wrong_programs_and_every_code_among_them() {
    let mut cases = 0;
    let mut by_code: BTreeMap<String, usize> = BTreeMap::new();
    for text in ["syntax", "meaning", "defects", "mistakes"].into_iter().flat_map(pages).map(|(_, text)| text) {
        for answer in text.split("\n```text\n").skip(1).map(|rest| rest.split("\n```").next().unwrap()) {
            let codes = answer.lines().filter_map(|line| line.strip_prefix("error[").or(line.strip_prefix("warning[")));
            let codes: Vec<&str> = codes.map(|line| &line[..5]).collect();
            cases += usize::from(!codes.is_empty());
            for code in codes {
                *by_code.entry(code.to_owned()).or_default() += 1;
            }
        }
    }
    // Files of weights are no programs, and probing takes the model at hand: their own tests hold their diagnostics.
    let programs = codes::all().filter(|code| !codes::weights::ALL.contains(code) && !codes::probing::ALL.contains(code));
    let seldom: Vec<String> = programs
        .filter(|code| !LARGE.contains(&code.id) && by_code.get(code.id).is_none_or(|count| *count < 2))
        .map(|code| format!("{} {}: {}", code.id, code.title, by_code.get(code.id).unwrap_or(&0)))
        .collect();
    println!("{cases} wrong programs, {} codes", by_code.len());
    assert!(cases >= WRONG_PROGRAMS, "{cases} wrong programs");
    assert!(seldom.is_empty(), "codes with fewer than two cases:\n{}", seldom.join("\n"));
}
