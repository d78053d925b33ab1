//! The language as a specification: the pages under `tests/language/`.

#[allow(dead_code)] // `compiling` serves the other pages.
use crate::support;

use msk_compiler::diagnostics::{FileId, Report, SourceMap};
use msk_compiler::syntax::tree::{Item, Task, TaskStatement};
use msk_compiler::syntax::{self};
use support::reading::reading;
use support::{ENTRY, Reading, check_pages};

/// Pages about syntax are only parsed.
struct Parsing;

impl Reading for Parsing {
    fn surroundings(&self, kind: &str) -> Option<(String, String)> {
        let (before, after) = match kind {
            "" => ("", ""),
            "task" => ("task example {\n", "}\n"),
            "let" => ("task example {\nlet x =\n", "}\n"),
            "reward" | "observe" | "terminate" | "scene" | "init" | "params" => {
                return Some((format!("task example {{ {kind} {{\n"), "} }\n".to_owned()));
            }
            "test" => ("task example { test \"example\" {\n", "} }\n"),
            "body" => ("body example {\n", "}\n"),
            _ => return None,
        };
        Some((before.to_owned(), after.to_owned()))
    }

    fn read(&self, entry: &str, _files: &[(String, String)]) -> Report {
        let mut sources = SourceMap::default();
        let file = sources.add(ENTRY, entry);
        let report = Report::new(sources, syntax::parse(file, entry).diagnostics);
        let (corrected, applied) = report.fixed(file);
        let left = syntax::parse(file, &corrected).diagnostics.len();
        assert!(left + applied <= report.diagnostics.len(), "{applied} fixes made of\n{entry}\nthis\n{corrected}");
        report
    }
}

#[test]
fn syntax_pages_tell_the_truth() {
    check_pages("syntax", &Parsing);
}

#[test]
fn formulas_are_read_as_the_table_says() {
    let page = include_str!("language/syntax/formulas.md");
    let table = page.split("```readings\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let mut wrong = Vec::new();
    for line in table.lines() {
        let (written, expected) = line.split_once(" => ").unwrap();
        let text = format!("task t {{ let x = {written} }}");
        let parsed = syntax::parse(FileId::default(), &text);
        let found = match &parsed.tree.items[..] {
            [Item::Task(Task { statements, .. })] => match &statements[..] {
                [TaskStatement::Let(binding)] => reading(&binding.value),
                other => format!("{other:?}"),
            },
            other => format!("{other:?}"),
        };
        if found != expected || parsed.has_errors() {
            wrong.push(format!("{written}\n  expected {expected}\n  found    {found}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
