//! How errors look: carets stand under what they mean, whatever the line holds.

use msk_compiler::diagnostics::{Diagnostic, FileId, Report, SourceMap, Span, Style, codes, fixed};
use msk_compiler::syntax::parse;

/// A text and an error at the first place of `needle` in it.
fn error_at(text: &str, needle: &str) -> (SourceMap, Diagnostic) {
    let mut sources = SourceMap::default();
    let file = sources.add("tasks/example.msk", text);
    let start = text.find(needle).unwrap();
    let span = Span::new(start, start + needle.len());
    (sources, Diagnostic::new(codes::syntax::UNEXPECTED, file, span, "something is wrong").here("this"))
}

fn rendered((sources, diagnostic): (SourceMap, Diagnostic)) -> String {
    diagnostic.render(&sources, Style::Plain)
}

#[test]
fn an_error_shows_its_line_its_place_and_what_to_do() {
    let text = "task stand {\n    let lean = torso.up.x\n    success lean + 1 m < 2\n}\n";
    let (sources, diagnostic) = error_at(text, "1 m");
    let start = text.find("torso.up.x").unwrap();
    let diagnostic = diagnostic
        .label(FileId::default(), Span::new(start, start + 10), "a plain number")
        .expected("a plain number")
        .found("a length")
        .help("divide by a length")
        .suggest("write `1`", Span::new(start, start), "1");
    insta::assert_snapshot!(rendered((sources, diagnostic)), @r"
    error[E0101]: something is wrong
     --> tasks/example.msk:3:20
      |
    2 |     let lean = torso.up.x
      |                ---------- a plain number
    3 |     success lean + 1 m < 2
      |                    ^^^ this
      |
      = expected: a plain number
      =    found: a length
      = help: divide by a length
      = help: write `1`
    ");
}

#[test]
fn tabs_wide_letters_and_accents_do_not_shift_the_carets() {
    insta::assert_snapshot!(rendered(error_at("\tlet é = 高 + wrong // 好\n", "wrong")), @r"
    error[E0101]: something is wrong
     --> tasks/example.msk:1:14
      |
    1 |     let é = 高 + wrong // 好
      |                  ^^^^^ this
    ");
}

#[test]
fn a_long_line_is_cut_around_the_place() {
    let text = format!("{} there {}\n", "a + ".repeat(100), " + b".repeat(100));
    let shown = rendered(error_at(&text, "there"));
    let line = shown.lines().find(|line| line.contains("there")).unwrap();
    let carets = shown.lines().find(|line| line.contains("^^^^^")).unwrap();
    assert!(line.chars().count() < 140 && line.contains("..."), "{line}");
    let column = |line: &str, piece: &str| line[..line.find(piece).unwrap()].chars().count();
    assert_eq!(column(line, "there"), column(carets, "^"));
}

#[test]
fn a_place_over_several_lines_is_marked_on_its_first() {
    let text = "let x = (a +\n    b)\n";
    assert!(rendered(error_at(text, "(a +\n    b)")).contains("1 | let x = (a +\n  |         ^^^^ this"));
}

#[test]
fn nothing_in_a_file_reaches_the_terminal_as_a_command() {
    let text = "let \u{1b}[2J\u{9b}2Jx = \u{202e}1 // \u{200b}\n";
    let (sources, mut diagnostic) = error_at(text, "x");
    diagnostic.message = "undefined name `\u{202e}x`".to_owned();
    insta::assert_snapshot!(rendered((sources, diagnostic)), @r"
    error[E0101]: undefined name `<U+202E>x`
     --> tasks/example.msk:1:19
      |
    1 | let ␛[2J<U+009B>2Jx = <U+202E>1 // <U+200B>
      |                   ^ this
    ");
}

#[test]
fn no_text_of_a_report_hides_anything() {
    let (sources, diagnostic) = error_at("let \u{202e}x = 1\n", "x");
    let hidden = "`\u{202e}x\u{1b}[2J`";
    let diagnostic = diagnostic.here(hidden).expected(hidden).found(hidden).help(hidden);
    let diagnostic = diagnostic.fix(hidden, Span::new(0, 3), "\u{202e}y");
    let json = Report::new(sources, vec![diagnostic]).to_json();
    let diagnostic = &json["diagnostics"][0];
    let texts = [&diagnostic["labels"][0]["text"], &diagnostic["expected"], &diagnostic["found"], &diagnostic["help"][0]];
    for text in texts.into_iter().chain([&diagnostic["fixes"][0]["title"]]) {
        assert_eq!(text, "`<U+202E>x\u{241b}[2J`");
    }
    // What is written into the file is what was meant.
    assert_eq!(diagnostic["fixes"][0]["edits"][0]["replacement"], "\u{202e}y");
}

#[test]
fn the_name_of_a_file_is_no_command_either() {
    let mut sources = SourceMap::default();
    let file = sources.add("a\u{1b}]0;b\u{7}\u{2067}.msk", "x\n");
    let shown = Diagnostic::new(codes::syntax::UNEXPECTED, file, Span::new(0, 1), "wrong").render(&sources, Style::Plain);
    assert!(shown.contains("--> a\u{241b}]0;b\u{2407}<U+2067>.msk:1:1"), "{shown:?}");
}

#[test]
fn an_empty_file_and_the_end_of_a_file_can_be_pointed_at() {
    for text in ["", "\n", "task", "é"] {
        let mut sources = SourceMap::default();
        let file = sources.add("empty.msk", text);
        let end = Span::at(text.len());
        let shown = Diagnostic::new(codes::syntax::UNEXPECTED, file, end, "more was expected").render(&sources, Style::Plain);
        assert!(shown.contains('^'), "{text:?}: {shown}");
    }
}

#[test]
fn a_report_is_sorted_counted_and_coloured_on_demand() {
    let text = "task t {\n    rewrad { }\n    control 0.25m\n    /// Nothing.\n}\n";
    let mut sources = SourceMap::default();
    let file = sources.add("t.msk", text);
    let mut diagnostics = parse(file, text).diagnostics;
    diagnostics.reverse();
    let report = Report::new(sources, diagnostics);
    let plain = report.to_string();
    assert!(plain.ends_with("\n2 errors, 1 warning\n"), "{plain}");
    assert!(plain.find("rewrad").unwrap() < plain.find("0.25").unwrap());
    assert!(!plain.contains('\u{1b}') && report.render(Style::Coloured).contains("\u{1b}[1m\u{1b}[91merror[E0115]"));
}

#[test]
fn json_holds_places_and_edits() {
    let text = "task t {\n    control 0.25m\n}\n";
    let mut sources = SourceMap::default();
    let file = sources.add("t.msk", text);
    let report = Report::new(sources, parse(file, text).diagnostics);
    insta::assert_json_snapshot!(report.to_json(), @r#"
    {
      "diagnostics": [
        {
          "code": "E0107",
          "denied_by": null,
          "expected": null,
          "fixes": [
            {
              "automatic": true,
              "edits": [
                {
                  "place": {
                    "end": {
                      "byte": 26,
                      "column": 18,
                      "line": 2
                    },
                    "file": "t.msk",
                    "start": {
                      "byte": 21,
                      "column": 13,
                      "line": 2
                    }
                  },
                  "replacement": "0.25 m"
                }
              ],
              "title": "write `0.25 m`"
            }
          ],
          "found": null,
          "help": [],
          "labels": [
            {
              "place": {
                "end": {
                  "byte": 26,
                  "column": 18,
                  "line": 2
                },
                "file": "t.msk",
                "start": {
                  "byte": 21,
                  "column": 13,
                  "line": 2
                }
              },
              "text": ""
            }
          ],
          "lint": null,
          "message": "missing space between `0.25` and `m`",
          "severity": "error"
        }
      ]
    }
    "#);
}

#[test]
fn automatic_fixes_lead_to_a_text_without_these_errors() {
    let text = "# Stands.\ntask stand\n{\n    control = 100Hz\n    let a = com.height − 1/m^2 * x²\n        + 2 && !fallen\n}\n";
    let mut present = text.to_owned();
    for _ in 0..5 {
        let diagnostics = parse(FileId::default(), &present).diagnostics;
        let (next, applied) = fixed(&present, FileId::default(), &diagnostics);
        present = next;
        if applied == 0 {
            break;
        }
    }
    let expected = "// Stands.\ntask stand {\n\n    control  100 Hz\n    let a = com.height - 1 m^-2 * x^2 +\n         2 and not fallen\n}\n";
    assert_eq!(present, expected);
    assert_eq!(parse(FileId::default(), &present).diagnostics, []);
}

#[test]
fn every_code_has_a_page() {
    for code in codes::all() {
        let page = code.page();
        assert!(page.starts_with(code.id) && !code.explanation.is_empty() && !code.example.is_empty(), "{page}");
    }
}
