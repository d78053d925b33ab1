//! `msk new`.

use crate::project::{LEAN, Project};

#[test]
fn a_new_task_compiles_without_a_remark_is_laid_out_and_runs() {
    let project = Project::empty();
    project.msk(&["new", "task", "lean_back", "--family", "balance"]).succeeded();
    let text = project.read("lean_back.msk");
    assert!(text.contains("task lean_back {") && text.contains("family  balance"), "{text}");
    let done = project.msk(&["check", "lean_back.msk"]).succeeded();
    assert!(done.out.contains("1 task, nothing to remark"), "{}", done.out);
    project.msk(&["fmt", "--check", "lean_back.msk"]).succeeded();
    project.msk(&["run", "lean_back.msk", "--policy", "zero"]).succeeded();
}

#[test]
fn what_exists_is_never_replaced() {
    let project = Project::lean();
    project.msk(&["new", "task", "lean"]).failed(1, &["`lean.msk` cannot be written"]);
    assert_eq!(project.read("lean.msk"), LEAN);
}

#[test]
fn a_new_task_may_change_another_one() {
    let project = Project::lean();
    project.msk(&["new", "task", "lean_more", "--from", "lean", "--out", "more/lean_more.msk"]).succeeded();
    let text = project.read("more/lean_more.msk");
    assert!(text.contains("use \"../lean.msk\"") && text.contains("task lean_more extends lean {"), "{text}");
    let done = project.msk(&["check", "more/lean_more.msk"]).succeeded();
    assert!(done.out.contains("nothing to remark"), "{}", done.out);
    project.msk(&["fmt", "--check", "more/lean_more.msk"]).succeeded();
    project.msk(&["diff", "lean.msk", "more/lean_more.msk@lean_more"]).succeeded();
}

#[test]
fn what_is_no_name_is_refused() {
    let project = Project::empty();
    project.msk(&["new", "task", "Lean-Back"]).failed(2, &["`Lean-Back` is no name for a task"]);
    project.msk(&["new", "task", "let"]).failed(1, &["nothing is written"]);
    assert!(!project.path("let.msk").exists());
}
