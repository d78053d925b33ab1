//! Weights files as texts: an edit touches the lines concerned and nothing else.

use msk_compiler::diagnostics::SourceMap;
use msk_tuning::overlay::{Overlay, edited};
use proptest::prelude::*;

fn lines(text: &str) -> Vec<(String, String, f64)> {
    let mut sources = SourceMap::default();
    let overlay = Overlay::read("weights.toml", text, &mut sources).unwrap();
    overlay.lines().iter().map(|line| (line.task.clone(), line.term.clone(), line.weight)).collect()
}

fn codes(text: &str) -> Vec<&'static str> {
    let mut sources = SourceMap::default();
    match Overlay::read("weights.toml", text, &mut sources) {
        Ok(_) => Vec::new(),
        Err(diagnostics) => diagnostics.iter().map(|diagnostic| diagnostic.code.id).collect(),
    }
}

#[test]
fn tasks_phases_and_inline_tables_are_read_in_order() {
    let text = "[stand]\npose = 11\n\"effort\" = -1e-2\n[rise]\nsit.pose = 3.5\n[rise.stand]\npose = 4\n[walk]\n";
    let line = |task: &str, term: &str, weight: f64| (task.to_owned(), term.to_owned(), weight);
    let expected = [
        line("stand", "pose", 11.0),
        line("stand", "effort", -0.01),
        line("rise", "sit.pose", 3.5),
        line("rise", "stand.pose", 4.0),
    ];
    assert_eq!(lines(text), expected);
    assert_eq!(lines("stand = { pose = 2 }\n"), [line("stand", "pose", 2.0)]);
    assert_eq!(lines("# nothing yet\n"), []);
}

#[test]
fn invalid_weights_are_reported_all_at_once() {
    assert_eq!(codes("pose = 1\n[stand]\na = \"1\"\nb = true\nc = [1]\nd = inf\ne.f.g = 1\n"), ["E0461"; 6]);
    assert_eq!(codes("[stand]\npose = 1\npose = 2\n"), ["E0460"]);
    assert_eq!(codes("[stand]\n\"sit.pose\" = 1\nsit.pose = 2\n"), ["E0461"]);
    assert_eq!(codes("[stand\n"), ["E0460"]);
    assert_eq!(codes("\u{0}"), ["E0460"]);
}

/// A file of weights with whatever people put between them.
fn files() -> impl Strategy<Value = (String, usize)> {
    let blank = || prop_oneof![Just(""), Just(" "), Just("\t"), Just("   ")];
    let tail = prop_oneof![Just(""), Just("  # why: 7 pose = 3"), Just(" #")];
    let between = prop_oneof![4 => Just(""), 1 => Just("\n"), 1 => Just("# a = 1\n")];
    let line = (blank(), blank(), blank(), -1e6..1e6_f64, tail, between);
    (prop::collection::vec(line, 1..8), prop_oneof![Just("\n"), Just("\r\n")]).prop_map(|(rows, end)| {
        let mut text = String::from("# head\n[stand]   # table\n");
        for (index, (before, a, b, value, tail, between)) in rows.iter().enumerate() {
            text += &format!("{between}{before}term{index}{a}={b}{value:?}{tail}\n");
        }
        (text.replace('\n', end), rows.len())
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_edit_touches_the_lines_concerned_and_nothing_else((text, count) in files(), chosen in any::<prop::sample::Index>(), weight in -1e3..1e3_f64) {
        let term = format!("term{}", chosen.index(count));
        let after = edited(&text, &[("stand", &term, weight)]).unwrap();
        let (before, now): (Vec<&str>, Vec<&str>) = (text.split('\n').collect(), after.split('\n').collect());
        prop_assert_eq!(before.len(), now.len());
        for (old, new) in before.iter().zip(&now) {
            if old.trim_start().starts_with(&format!("{term}=")) || old.trim_start().split(['=', ' ', '\t']).next() == Some(&term) {
                // Name, blanks and comment stay.
                prop_assert_eq!(old.split('=').next(), new.split('=').next());
                prop_assert_eq!(old.split_once('#').map(|parts| parts.1), new.split_once('#').map(|parts| parts.1));
            } else {
                prop_assert_eq!(old, new);
            }
        }
        for ((_, name, value), (_, _, old)) in lines(&after).iter().zip(lines(&text)) {
            prop_assert_eq!(*value, if *name == term { weight } else { old });
        }
    }
}
