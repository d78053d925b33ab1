//! The report of a task: as text, as data, as tables and as a page.

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::explain::{Options, TaskReport, html, latex, task_report, text};
use msk_compiler::task::CompiledTask;
use std::sync::Arc;
use support::compiling::{compile_text, complete};

fn compiled(source: &str) -> Arc<CompiledTask> {
    let files = [("lib/terms.msk".to_owned(), include_str!("../../tasks/lib/terms.msk").to_owned())];
    let compilation = compile_text(&source.replace("../lib/", "lib/"), &files).unwrap_or_else(|report| panic!("{report}"));
    compilation.tasks[0].clone()
}

fn report_of(source: &str) -> TaskReport {
    task_report(&compiled(source), &Options::default())
}

/// The formula of a term that rewards `formula`.
fn term(formula: &str) -> msk_compiler::explain::FormulaReport {
    report_of(&complete(&format!("reward {{\n1 a = {formula}\n}}"))).phases[0].terms[0].formula.clone()
}

const STAND: &str = include_str!("../../tasks/stabilization/stand.msk");
// A task as the suite once had it, so that the snapshots change only with the form of the report.
const CATCH: &str = include_str!("fixtures/catch.msk");

#[test]
fn a_task_with_objects_and_chance_is_reported_in_full() {
    insta::assert_snapshot!("catch_explained", text(&compiled(CATCH), &Options::default()));
}

#[test]
fn the_account_is_stable_data() {
    for (name, source) in [("stand", STAND), ("catch", CATCH)] {
        insta::assert_json_snapshot!(format!("{name}_report"), report_of(source));
    }
}

#[test]
fn a_scheduled_weight_is_explained_with_its_training() {
    let source = complete("reward { 20 -> 10 over 20 % .. 50 % (5..20) tall = pelvis.height / 1 m }");
    let shown = text(&compiled(&source), &Options::default());
    assert!(shown.contains("\n  20 -> 10 over 20 % .. 50 % (5..20) tall\n"), "{shown}");
    let tables = latex(&[report_of(&source)]);
    assert!(tables.contains("$20$ $\\to$ $10$ over 20 \\% .. 50 \\%"), "{tables}");
    let page = html("Tasks", &[report_of(&source)]);
    assert!(page.contains("20 → 10<br><span class=\"soft\">over 20 % .. 50 %</span>"), "{page}");
}

#[test]
fn a_parameter_of_an_episode_is_explained_as_one() {
    let source = complete(
        "params { low = 0.8 m (0.5..0.9 m) per episode }\nmetrics { low }\nrandom far = uniform(0 m .. 1 m)\nreward { 1 a = pelvis.height / (low + far) }",
    );
    let shown = text(&compiled(&source), &Options::default());
    assert!(shown.contains("\n  low = 0.8 m, 0.5 .. 0.9 m, per episode\n"), "{shown}");
    assert!(shown.contains("\nDrawn for each episode\n  far = uniform(0 m .. 1 m)\n"), "{shown}");
    let data = serde_json::to_value(report_of(&source)).unwrap();
    assert_eq!(data["parameters"][0]["per_episode"], true);
    assert_eq!(data["randoms"].as_array().unwrap().len(), 1);
}

#[test]
fn an_end_that_bootstraps_is_explained_as_one() {
    let source =
        complete("finish after 5 steps { arrived bootstrap when com.position.x > 2 m; done when com.position.x < -2 m }");
    let shown = text(&compiled(&source), &Options::default());
    let lines = "\nFinishes\n  arrived when com.position.x > 2 m, after 5 steps, bootstraps\n  done when com.position.x < -2 m, after 5 steps\n";
    assert!(shown.contains(lines), "{shown}");
    let report = report_of(&source);
    assert_eq!(report.phases[0].finishes.iter().map(|end| end.bootstrap).collect::<Vec<_>>(), [true, false]);
    assert!(latex(std::slice::from_ref(&report)).contains("(bootstraps)"));
    assert!(html("Tasks", &[report]).contains("<span class=\"soft\">bootstraps</span>"));
}

#[test]
fn tables_have_the_layout_of_the_paper() {
    insta::assert_snapshot!("tables", latex(&[report_of(STAND), report_of(CATCH)]));
}

#[test]
fn a_page_holds_everything_and_asks_for_nothing_from_outside() {
    let page = html("Tasks", &[report_of(STAND), report_of(CATCH)]);
    for outside in ["http://", "https://", "<script", "<link", "src=", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    // Every element that is opened is closed.
    for element in ["math", "mrow", "msub", "msup", "mfrac", "mi", "mo", "mn", "mtext", "table", "tr", "td", "section", "div"] {
        let opened = page.matches(&format!("<{element}>")).count() + page.matches(&format!("<{element} ")).count();
        assert_eq!(opened, page.matches(&format!("</{element}>")).count(), "{element}");
    }
    insta::assert_snapshot!("page", page);
}

#[test]
fn signals_have_the_symbols_of_mechanics() {
    for (formula, latex) in [
        ("exp(-10 s/m * com.speed)", r"\exp(- 10\,\mathrm{s\,m^{-1}} \cdot \lVert \mathbf{v}_{\text{CoM}} \rVert)"),
        ("com.velocity.z / 1 m/s", r"v_{\text{z,CoM}} / \mathrm{m\,s^{-1}}"),
        ("pelvis.position.x / 2 m", r"x_{\text{pelvis}} / 2\,\mathrm{m}"),
        ("mean(muscles.activation^2)", r"\operatorname{mean}({a}^{2})"),
        ("knee_angle_r.qd / 1 rad/s", r"\dot{q}_{\text{knee angle r}} / \mathrm{rad\,s^{-1}}"),
        (
            "pelvis.height > 0.6 m and not terminated",
            r"\mathbb{I}(z_{\text{pelvis}} > 0.6\,\mathrm{m} \land \lnot \mathit{terminated})",
        ),
        ("1 when pelvis.height > 0.6 m", r"1 \cdot \mathbb{I}(z_{\text{pelvis}} > 0.6\,\mathrm{m})"),
        ("pelvis.height / (pelvis.height + 1 m)", r"\frac{z_{\text{pelvis}}}{z_{\text{pelvis}} + 1\,\mathrm{m}}"),
    ] {
        assert_eq!(term(formula).latex, latex, "{formula}");
    }
}

#[test]
fn definitions_are_reported_before_their_readers() {
    let report = report_of(
        &complete(
            "let high = pelvis.height / 1 m
        fn twice(x) = 2 * x
        reward {
        1 a = twice(higher)
        }
        let higher = high + 1",
        )
        .replacen("fn twice(x) = 2 * x", "", 1)
        .replacen("task example", "fn twice(x) = 2 * x\ntask example", 1),
    );
    let names: Vec<&str> = report.phases[0].definitions.iter().map(|definition| definition.name.as_str()).collect();
    assert_eq!(names, ["twice", "high", "higher"]);
}
