//! Whatever the text: a result, never a panic, an overflow or a hang; and every place in it lies in the text.

use msk_compiler::diagnostics::{FileId, Report, SourceMap, Span, Style};
use msk_compiler::syntax::{MAXIMUM_FILE_SIZE, parse};
use proptest::prelude::*;
use std::time::{Duration, Instant};

const FILES: [&str; 4] = [
    include_str!("../../tasks.msk"),
    include_str!("../../tasks/stabilization/stand.msk"),
    include_str!("../../tasks/lib/posture.msk"),
    include_str!("language/everything.msk"),
];

/// Parses, renders, and looks at every place.
fn check(text: &str) -> usize {
    let mut sources = SourceMap::default();
    let file = sources.add("any.msk", text);
    let parsed = parse(file, text);
    let sound = |span: Span| span.start <= span.end && text.get(span.range()).is_some();
    for diagnostic in &parsed.diagnostics {
        for label in &diagnostic.labels {
            assert!(sound(label.span), "{:?} of {diagnostic:?} in {text:?}", label.span);
        }
        for edit in diagnostic.fixes.iter().flat_map(|fix| &fix.edits) {
            assert!(sound(edit.span), "{edit:?} in {text:?}");
        }
    }
    let count = parsed.diagnostics.len();
    let report = Report::new(sources, parsed.diagnostics);
    assert!(report.render(Style::Coloured).len() + report.to_json().to_string().len() > 0);
    count
}

/// Runs on a thread with a small stack, as a guest of another program might.
fn on_small_stack(run: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(1 << 20).spawn(run).unwrap().join().unwrap();
}

/// Words and marks of the language, in any order: likelier to reach deep rules than arbitrary characters.
fn language_soup() -> impl Strategy<Value = String> {
    let token = prop_oneof![
        Just("task t {\n"),
        Just("reward {\n"),
        Just("}\n"),
        Just("{"),
        Just("}"),
        Just("("),
        Just(")"),
        Just("["),
        Just("]"),
        Just("\n"),
        Just(" "),
        Just(";"),
        Just(","),
        Just("="),
        Just("=="),
        Just("<"),
        Just(">="),
        Just("+"),
        Just("-"),
        Just("*"),
        Just("/"),
        Just("^"),
        Just(".."),
        Just("."),
        Just("10 a = "),
        Just("0.25 m"),
        Just("1 m/s"),
        Just("%"),
        Just("com.speed"),
        Just("sole_{l,r}"),
        Just("pole_{"),
        Just("if "),
        Just(" then "),
        Just(" else "),
        Just(" when "),
        Just(" in "),
        Just(" not "),
        Just(" and "),
        Just(" or "),
        Just("becomes "),
        Just("state x = 0 "),
        Just("let x = "),
        Just("// note\n"),
        Just("/// doc\n"),
        Just("\""),
        Just("scene {\n"),
        Just("box b { "),
        Just("at "),
        Just("for "),
        Just("−"),
        Just("≥"),
        Just("&&"),
        Just("é"),
        Just("\t"),
        Just("\r\n"),
        Just("expect "),
        Just("pose a "),
        Just("so "),
        Just("from "),
        Just(" to "),
        Just("repeat i in 0..3 {\n"),
        Just("norm("),
        Just("muscle \"a\""),
        Just("ended by "),
    ];
    prop::collection::vec(token, 0..60).prop_map(|tokens| tokens.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_text_is_read(text in "\\PC{0,200}") {
        check(&text);
    }

    #[test]
    fn arbitrary_lines_are_read(text in "[ -~\n\t\r]{0,400}") {
        check(&text);
    }

    #[test]
    fn words_of_the_language_in_any_order_are_read(text in language_soup()) {
        check(&text);
    }

    #[test]
    fn a_file_cut_and_spliced_anywhere_is_read(
        which in 0..FILES.len(), from in any::<prop::sample::Index>(), length in 0..40_usize, insert in language_soup(),
    ) {
        let file = FILES[which];
        let boundaries: Vec<usize> = file.char_indices().map(|(byte, _)| byte).collect();
        let start = from.index(boundaries.len());
        let end = (start + length).min(boundaries.len() - 1);
        check(&format!("{}{insert}{}", &file[..boundaries[start]], &file[boundaries[end]..]));
    }
}

/// Signs that stand for several of the language, or for one of another length: found by fuzzing, where a place in the middle of
/// one was reported.
#[test]
fn places_beside_foreign_signs_lie_between_characters() {
    use msk_compiler::syntax::tree::walk::{Visitor, walk_expression, walk_file};
    use msk_compiler::syntax::tree::{Expr, ExprKind};
    struct Places<'t>(&'t str, usize);
    impl<'a> Visitor<'a> for Places<'_> {
        fn expression(&mut self, expression: &'a Expr) {
            assert!(self.0.get(expression.span.range()).is_some(), "{:?} in {:?}", expression.span, self.0);
            if let ExprKind::Binary { operator_span, .. } = &expression.kind {
                assert!(self.0.get(operator_span.range()).is_some(), "{operator_span:?} in {:?}", self.0);
            }
            self.1 += 1;
            walk_expression(self, expression);
        }
    }
    for text in
        ["x\u{b2} * y", "a \u{2212} b\u{b3}", "a \u{2265} b && !c", "\u{bd} * x\u{b2}\u{b3}", "a\u{d7}b\u{b2}", "2\u{b2}^x"]
    {
        let text = format!("task t {{ let v = {text} }}");
        let parsed = parse(FileId::default(), &text);
        let mut places = Places(&text, 0);
        walk_file(&mut places, &parsed.tree);
        check(&text);
    }
}

#[test]
fn nesting_is_bounded_on_a_small_stack() {
    on_small_stack(|| {
        for (open, close) in [("(", ")"), ("[", "]"), ("f(", ")"), ("a[", "]"), ("-(", ")"), ("(if a then (", ") else b)")] {
            for depth in [10, 31, 60, 64, 65, 5000] {
                let text = format!("task t {{ let x = {}1{} }}", open.repeat(depth), close.repeat(depth));
                let brackets = open.matches(['(', '[']).count() * depth + 1;
                let started = Instant::now();
                let errors = check(&text);
                assert!(started.elapsed() < Duration::from_secs(20), "{open} {depth}");
                assert_eq!(errors, usize::from(brackets > 64), "{open} {depth}");
            }
        }
        for block in ["scene { repeat i in 0..2 {", "box b {", "{"] {
            check(&format!("task t {{ {}{}", block.repeat(5000), "}".repeat(5000)));
            check(&block.repeat(5000));
        }
    });
}

#[test]
fn long_statements_are_bounded_on_a_small_stack() {
    on_small_stack(|| {
        let repeated = |head: &str, piece: &str, count: usize| format!("task t {{ let x = {head}{} }}", piece.repeat(count));
        for piece in [" + a", " * a", " and a", " < a", ".a", "(a)", "[1]", " in a", "^2", " - (a + a)"] {
            assert!(check(&repeated("a", piece, 20_000)) > 0, "{piece}");
        }
        assert_eq!(check(&repeated("a", " + a", 512)), 0);
        assert_eq!(check(&repeated("a", " + a", 513)), 1);
        assert_eq!(check(&repeated("a", ".a", 512)), 0);
        check(&repeated("if a then b", " else if a then b", 20_000));
        check(&format!("task t {{ let x = {}a }}", "-".repeat(20_000)));
        check(&format!("task t {{ let x = {}a }}", "not ".repeat(20_000)));
    });
}

#[test]
fn files_beyond_the_limit_are_refused_and_none_takes_long() {
    let most = MAXIMUM_FILE_SIZE;
    assert_eq!(check(&" ".repeat(most + 1)), 1);
    let patterns = [
        "\n",
        "(",
        "[",
        "{",
        "}",
        ")",
        "{\n",
        "}\n",
        "a ",
        "a\n",
        "1 ",
        "\"",
        "// c\n",
        "/// d\n",
        "_{",
        "-",
        "+",
        "0..",
        "x.",
        "task t {\n",
        "10 a = b\n",
        "é",
        "−",
        "&",
        "#",
        "if a then ",
        "f(",
        "(\n",
        "a_{l,r} ",
        "\t",
        "\r",
        "m ",
        "1 m ",
    ];
    for pattern in patterns {
        for head in ["", "task t { reward {\n"] {
            let text = format!("{head}{}", pattern.repeat((most - head.len()) / pattern.len()));
            let started = Instant::now();
            std::hint::black_box(parse(FileId::default(), &text));
            let time = started.elapsed();
            assert!(time < Duration::from_secs(20), "{head:?} then {pattern:?} took {time:?}");
        }
    }
}

#[test]
fn one_missing_byte_is_one_error_on_its_line() {
    let file = FILES[1];
    let (mut broken, mut single, mut on_line) = (0, 0, 0);
    let mut sources = SourceMap::default();
    let whole = sources.add("whole.msk", file);
    // Every third: each costs a parse of the whole file.
    for byte in (0..file.len()).step_by(3) {
        let (before, after) = (&file[..byte], &file[byte + 1..]);
        let text = format!("{before}{after}");
        let diagnostics = parse(FileId::default(), &text).diagnostics;
        if diagnostics.is_empty() {
            continue;
        }
        broken += 1;
        single += usize::from(diagnostics.len() == 1);
        let line = sources.line_column(whole, byte).0;
        let near = diagnostics.iter().any(|diagnostic| {
            let found = text[..diagnostic.span().start as usize].matches('\n').count() + 1;
            found.abs_diff(line) <= 1
        });
        on_line += usize::from(near);
    }
    assert!(broken > 200, "{broken}");
    assert!(single * 100 >= broken * 97, "{single} of {broken} have exactly one error");
    assert!(on_line * 100 >= broken * 95, "{on_line} of {broken} have an error beside the edit");
}
