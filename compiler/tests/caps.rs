//! What bounds a text: depth on a small stack, size, what unrolls, and what a task may remember.

#[allow(dead_code, reason = "the pages have their own tests")]
use crate::support;

use msk_compiler::compile;
use msk_compiler::diagnostics::{Report, Severity};
use msk_compiler::files::{LoadError, Loader};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use support::compiling::{Bodies, compile_text, complete};

/// The codes of the diagnostics of a text, in order, each once.
fn codes(text: &str) -> Vec<&'static str> {
    let diagnostics = match compile_text(text, &[]) {
        Ok(compilation) => compilation.warnings,
        Err(Report { diagnostics, .. }) => diagnostics,
    };
    let mut codes: Vec<&str> = diagnostics.iter().map(|diagnostic| diagnostic.code.id).collect();
    codes.dedup();
    codes
}

/// Runs on a thread with a stack of 1 MB, as a guest of another program might.
fn on_small_stack(run: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(1 << 20).spawn(run).unwrap().join().unwrap();
}

/// Functions that call each other, `count` deep.
fn chain(count: usize) -> String {
    let functions = (1..count).map(|index| format!("fn f{index}(x) = f{}(x) + 1\n", index - 1));
    let functions: String = std::iter::once("fn f0(x) = x\n".to_owned()).chain(functions).collect();
    format!("{functions}{}", complete(&format!("reward {{ 1 a = f{}(torso.up.z) }}", count - 1)))
}

#[test]
fn depth_is_bounded_on_a_small_stack() {
    on_small_stack(|| {
        assert!(codes(&chain(20)).is_empty());
        assert_eq!(codes(&chain(400)), ["E0410"]);
        let lets: String = (1..400).map(|index| format!("let a_{index} = a_{} + 1\n", index - 1)).collect();
        let named = complete(&format!("let a_0 = torso.up.z\n{lets}reward {{ 1 a = a_399 }}"));
        assert_eq!(codes(&named), ["E0410"]);
        for (open, close) in
            [("(", ")"), ("tanh(", ")"), ("[", "][0]"), ("-(", ")"), ("(if com.height > 1 m then (", ") else 1)")]
        {
            for depth in [5, 20, 30, 100, 2000] {
                let formula = format!("{}torso.up.z{}", open.repeat(depth), close.repeat(depth));
                let found = codes(&complete(&format!("reward {{ 1 a = {formula} }}")));
                assert!(
                    found.iter().all(|code| matches!(*code, "E0121" | "E0122" | "E0410" | "W0508")),
                    "{open} {depth}: {found:?}"
                );
            }
        }
        // What is handed to a function is computed before it, not within it.
        let nested = format!("fn deep(x) = {}x{}\n", "tanh(".repeat(30), ")".repeat(30));
        let called =
            format!("{nested}{}", complete(&format!("reward {{ 1 a = {}torso.up.z{} }}", "deep(".repeat(30), ")".repeat(30))));
        assert!(codes(&called).is_empty());
    });
}

#[test]
fn what_unrolls_is_bounded_and_takes_no_time() {
    let cases = [
        ("reward { 1 a = sum([i for i in 0..1000000000]) * torso.up.z }", "E0410"),
        ("reward { 1 a = sum([[j for j in 0..1000] for i in 0..1000]) * torso.up.z }", "E0410"),
        ("reward { 1 a = sum(pole_{0..4000000000}.height) / 1 m }", "E0410"),
        ("reward { 1 a = sum([sum([k * torso.up.z for k in 0..300]) for i in 0..1000]) }", "E0410"),
        ("scene { ground\n repeat i in 0..4000000000 { box b_{i} { size [1 m, 1 m, 1 m], at [3 m, 0, 1 m] } } }", "E0410"),
    ];
    for (statements, code) in cases {
        let started = Instant::now();
        assert_eq!(codes(&complete(statements)), [code], "{statements}");
        assert!(started.elapsed() < Duration::from_secs(20), "{statements}");
    }
    let doubling: String = (1..40).map(|index| format!("fn f{index}(x) = f{}(x) + f{}(x + 1)\n", index - 1, index - 1)).collect();
    let text = format!("fn f0(x) = x\n{doubling}{}", complete("reward { 1 a = f39(torso.up.z) }"));
    assert_eq!(codes(&text), ["E0410"]);
}

#[test]
fn what_a_task_remembers_is_bounded() {
    assert_eq!(codes(&complete("reward { 1 a = delay(torso.up.z, 100001 steps) }")), ["E0310"]);
    let many: String = (0..40).map(|index| format!("1 a_{index} = delay(torso.up.z, {} steps)\n", 99_000 - index)).collect();
    assert!(codes(&complete(&format!("reward {{\n{many}}}"))).contains(&"E0410"));
}

#[test]
fn the_longest_delay_is_the_one_that_is_documented() {
    let found = |steps: &str| codes(&complete(&format!("reward {{ 1 a = delay(torso.up.z, {steps} steps) }}")));
    assert!(found("100000").is_empty(), "{:?}", found("100000"));
    assert_eq!(found("100001"), ["E0310"]);
}

#[test]
fn weights_are_bounded() {
    for weight in ["1e308", "-1e308", "2e9", "5 (1..1e300)", "5 (-1e300..6)"] {
        assert_eq!(codes(&complete(&format!("reward {{ {weight} a = torso.up.z }}"))), ["E0406"], "{weight}");
    }
    assert!(codes(&complete("reward { 1e9 a = torso.up.z }")).is_empty());
}

#[test]
fn a_term_that_is_never_finite_is_an_error() {
    for formula in ["1 / 0", "0 / 0", "max(torso.up.z, 1 / 0)", "torso.up.z + 1e308 * 10", "exp(1000)", "log(0)"] {
        assert_eq!(codes(&complete(&format!("reward {{ 1 a = {formula} }}"))), ["E0411"], "{formula}");
    }
    for block in ["observe { ratio = 1 / 0 }", "observe { pair = [1, 1 / 0] }", "metrics { ratio = 0 / 0 }"] {
        assert!(codes(&complete(&format!("reward {{ 1 a = torso.up.z }}\n{block}"))).contains(&"E0411"), "{block}");
    }
    // What is infinite and never rewarded is allowed.
    assert!(!codes(&complete("reward { 1 a = min(torso.up.z, 1 / 0) }")).contains(&"E0411"));
    assert!(!codes(&complete("reward { 1 a = 1 / torso.up.z }")).contains(&"E0411"));
    let phases = "task second extends example { reward { 2 b = 1 / 0 } }\nsequence both { phase example until com.height > 2 m; phase second }";
    assert!(codes(&format!("{}{phases}", complete(""))).contains(&"E0411"));
}

#[test]
fn a_comparison_with_what_is_never_finite_is_an_error() {
    for condition in ["0 / 0 > 1", "com.height > 1 m / 0", "not com.speed < log(-1) * 1 m/s", "exp(1000) >= 1"] {
        let block = format!("terminate {{ low when {condition} }}");
        assert_eq!(codes(&complete(&block)), ["E0411"], "{condition}");
    }
    assert!(!codes(&complete("terminate { low when 1 / com.position.x > 2 / 1 m }")).contains(&"E0411"));
}

#[test]
fn numbers_in_messages_are_short_whatever_a_text_holds() {
    let statements = [
        "success pelvis.height > 1e308 m",
        "success pelvis.height > -1e308 m and knee_angle_r.q < 1e307 deg",
        "terminate { bent when knee_angle_r.q > 1e308 rad }",
        "terminate { low when held(com.height < 1e-308 m, 1e300 s) }",
        "reward { 1 a = tolerance(com.height, 1e308 m, 1.1e308 m, 1e-308 m) }",
        "reward { 1e308 (1e307..1e308) a = torso.up.z * 1e308 }",
        "reward { 1 a = knee_angle_r.q - 1e308 rad }",
        "params { speed = 1e308 m/s (1e300..1e307 m/s) }",
        "control 1e-308 Hz",
        "control 1e308 Hz",
        "control 123.456789e-300 Hz",
        "horizon 1e308 s",
        "horizon 1e-308 s",
        "init { pose neutral { knee_angle_r = 1e308 deg } }",
        "init { pose neutral\n root { height 1e308 m } }",
        "init { pose neutral\n noise joints normal(0, 1e308 rad) }",
        "init { pose neutral\n settle 1e308 s }",
        "act torque { joints legs, range 1e308 N*m }",
        "disturb pelvis { force [1e308 N, 0, 0], at 1e308 s, for 0.1 s }",
        "observe { pelvis.height noise normal(0, 1e308 m) scale 1e-308 m clip -1e308 m .. 1e308 m }",
        "random x = uniform(1e308 m .. 1e307 m)",
        "test \"far\" { pose neutral { root.at = [1e308 m, 0 m] }\n expect pelvis.height > 1e308 m }",
    ];
    for statement in statements {
        let diagnostics = match compile_text(&complete(statement), &[]) {
            Ok(compilation) => compilation.warnings,
            Err(Report { diagnostics, .. }) => diagnostics,
        };
        for diagnostic in diagnostics {
            let notes = diagnostic.expected.iter().chain(&diagnostic.found).chain(&diagnostic.help);
            let labels = diagnostic.labels.iter().map(|label| &label.text).chain(diagnostic.fixes.iter().map(|fix| &fix.title));
            for text in notes.chain(labels).chain([&diagnostic.message]) {
                let longest = text.split(|c: char| !c.is_ascii_digit()).map(str::len).max().unwrap_or_default();
                assert!(longest <= 17, "{statement}: {text}");
            }
        }
    }
}

#[test]
fn functions_and_names_hide_no_event() {
    let library = "fn own_once(c) = once(c)\nfn own_rising(c) = rising(c)\nfn own_falling(c) = falling(c)\n";
    let events = ["once", "own_once", "rising", "own_rising", "falling", "own_falling"];
    for event in events {
        let term = |kind: &str, formula: &str| {
            codes(&format!(
                "{library}{}",
                complete(&format!("let there = {event}(com.height > 0.9 m)\n{kind} {{ 1 a = {formula} }}"))
            ))
        };
        let direct = format!("{event}(com.height > 0.9 m)");
        for formula in [&direct, "there", "1 when there"] {
            assert!(term("reward per second", formula).contains(&"E0433"), "{event}: {formula}");
            let found = term("reward", formula);
            assert!(
                !found.iter().any(|code| code.starts_with('E')) && !found.contains(&"W0511"),
                "{event}: {formula}: {found:?}"
            );
        }
        // How often something began is no single step.
        assert!(!term("reward per second", &format!("count({direct}) / 10")).contains(&"E0433"), "{event}");
    }
}

#[test]
fn the_clock_of_a_sequence_counts_all_phases() {
    let sequence = |list: &str| {
        let index = format!("reward {{ 1 a = {list}[floor(episode.t / 1 s)] * torso.up.z }}");
        let second = format!("task second extends first {{\n{} }}", index.replace("1 a", "1 b"));
        let whole = complete("horizon 100 steps").replace("task example", "task first");
        format!("{whole}{second}\nsequence both {{ phase first until com.height > 2 m; phase second }}")
    };
    // The second phase ends up to two seconds after the beginning of the episode.
    assert!(codes(&sequence("[1, 2]")).contains(&"E0311"), "{:?}", codes(&sequence("[1, 2]")));
    assert!(!codes(&sequence("[1, 2, 3]")).iter().any(|code| code.starts_with('E')), "{:?}", codes(&sequence("[1, 2, 3]")));
}

/// Files without end, each of which uses the next `breadth`; counts how often each is read.
struct Endless {
    breadth: usize,
    filling: String,
    loads: RefCell<BTreeMap<PathBuf, usize>>,
}

impl Loader for Endless {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        let missing = || LoadError::Missing(path.to_path_buf());
        let number: usize = path.file_stem().and_then(|stem| stem.to_str()?.parse().ok()).ok_or_else(missing)?;
        *self.loads.borrow_mut().entry(path.to_path_buf()).or_default() += 1;
        let uses = (1..=self.breadth).map(|step| format!("use \"{}.msk\"\n", number + step));
        Ok(uses.collect::<String>() + &self.filling)
    }
}

#[test]
fn files_and_their_bytes_are_bounded_and_each_is_read_once() {
    for (breadth, filling, most, words) in [
        (1, String::new(), compile::MAXIMUM_FILES, "file number 1001"),
        (30, String::new(), compile::MAXIMUM_FILES, "file number 1001"),
        (1, "// long\n".repeat(30_000), 71, "exceeds 16 MB"),
    ] {
        let endless = Endless { breadth, filling, loads: RefCell::default() };
        let Err(report) = msk_compiler::compile(Path::new("0.msk"), &endless, &Bodies) else { panic!("it ends") };
        let found: Vec<&str> = report.diagnostics.iter().map(|diagnostic| diagnostic.code.id).collect();
        assert_eq!(found, ["E0410"], "{report}");
        assert!(report.diagnostics[0].message.contains(words), "{report}");
        let loads = endless.loads.into_inner();
        assert!(loads.len() <= most && loads.values().all(|count| *count == 1), "{} files are read", loads.len());
    }
}

#[test]
fn errors_of_a_file_are_capped_and_the_others_are_counted() {
    let functions: String = (0..2000).map(|number| format!("fn f{number}(x) = x + missing_{number}\n")).collect();
    let text = functions + &complete("reward { 1 a = torso.up.z + missing }");
    let Err(report) = compile_text(&text, &[]) else { panic!("names are missing") };
    let errors: Vec<_> = report.diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error).collect();
    assert_eq!(errors.len(), 501);
    let last = errors[500];
    assert_eq!(last.code.id, "E0131");
    assert!(last.message.starts_with("and 1501 more errors in this file"), "{}", last.message);
}

#[test]
fn warnings_of_a_file_are_capped_and_the_others_are_counted() {
    let unread: String = (0..600).map(|number| format!("let spare_{number} = com.height\n")).collect();
    let warnings = compile_text(&complete(&unread), &[]).unwrap_or_else(|report| panic!("{report}")).warnings;
    assert_eq!(warnings.len(), 501);
    let last = &warnings[500];
    assert_eq!(last.code.id, "W0514");
    assert!(last.message.ends_with(" more warnings in this file: at most 500 are shown"), "{}", last.message);
}

#[test]
fn what_tasks_inherit_is_bounded() {
    let line = |count: usize| -> String { (1..count).map(|n| format!("task t{n} extends t{} {{ }}\n", n - 1)).collect() };
    let base = complete("reward { 1 a = torso.up.z }").replace("task example", "task t0");
    assert!(base.contains("task t0"));
    assert!(codes(&(base.clone() + &line(60))).iter().all(|code| code.starts_with('W')));
    assert!(codes(&(base + &line(100))).contains(&"E0410"));
    // Many copies of much.
    let lets: String = (0..4000).map(|n| format!("let a_{n} = 1\n")).collect();
    let large = complete(&format!("{lets}reward {{ 1 a = torso.up.z }}")).replace("task example", "task t0");
    let copies: String = (1..100).map(|n| format!("task c{n} extends t0 {{ }}\n")).collect();
    assert!(codes(&(large + &copies)).contains(&"E0410"));
}

#[test]
fn formulas_that_are_read_twice_again_and_again_are_followed_once() {
    let sums: String = (1..50).map(|index| format!("let a_{index} = a_{0} + a_{0}\n", index - 1)).collect();
    let both = |index: usize| format!("let c_{index} = c_{0} and (c_{0} and com.height > {index} cm)\n", index - 1);
    let conditions: String = (1..31).map(both).collect();
    let task = complete(&format!(
        "let a_0 = com.velocity.z / 1 m/s\nlet c_0 = pelvis.height > 0.5 m\n{sums}{conditions}\
         reward {{ 1 a = exp(-a_49) / a_49 when c_30 }}\nterminate {{ low when c_30 }}\nfinish {{ there when c_29 }}\nsuccess c_28"
    ));
    assert!(codes(&task).iter().all(|code| code.starts_with('W')), "{:?}", codes(&task));
}
