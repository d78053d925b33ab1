//! `msk new`.

use super::project::{LEAN, Project};

#[test]
fn a_new_task_compiles_without_a_remark_is_laid_out_and_runs() {
    let project = Project::empty();
    project.msk(&["new", "task", "lean_back", "--family", "balance"]).succeeded();
    let text = project.read("lean_back.msk");
    assert!(text.contains("task lean_back {") && text.contains("family  balance"), "{text}");
    let done = project.msk(&["check", "lean_back.msk"]).succeeded();
    assert!(done.out.contains("1 task: no errors, no warnings"), "{}", done.out);
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
    assert!(done.out.contains("no errors, no warnings"), "{}", done.out);
    project.msk(&["fmt", "--check", "more/lean_more.msk"]).succeeded();
    project.msk(&["diff", "lean.msk", "more/lean_more.msk@lean_more"]).succeeded();
}

#[test]
fn a_new_body_fits_its_model_and_is_laid_out() {
    let project = Project::empty();
    let model = r#"<mujoco><worldbody><geom type="plane" size="0 0 1"/><body name="Trunk" pos="0 0 1"><freejoint/>
        <geom name="trunk" size="0.1"/><body name="shank" pos="0 0 -0.3"><joint name="knee" axis="0 1 0"/>
        <geom name="shank" size="0.1"/></body></body></worldbody></mujoco>"#;
    std::fs::write(project.path("legs.xml"), model).unwrap();
    project.msk(&["new", "body", "legs", "--model", "legs.xml"]).succeeded();
    let text = project.read("bodies/legs.msk");
    assert!(text.contains("model \"../legs.xml\"") && text.contains("landmark trunk "), "{text}");
    project.msk(&["fmt", "--check", "bodies/legs.msk"]).succeeded();
    let vocabulary = project.msk(&["vocabulary", "--body", "bodies/legs.msk"]).succeeded();
    assert!(vocabulary.out.contains("trunk") && vocabulary.out.contains("knee"), "{}", vocabulary.out);
    project.msk(&["new", "body", "legs", "--model", "legs.xml"]).failed(1, &["cannot be written"]);
    project.msk(&["new", "body", "arms", "--model", "arms.xml"]).failed(1, &["the model `arms.xml` cannot be read"]);
}

#[test]
fn what_is_no_name_is_refused() {
    let project = Project::empty();
    project.msk(&["new", "task", "Lean-Back"]).failed(2, &["`Lean-Back` is not a name for a task"]);
    project.msk(&["new", "task", "let"]).failed(1, &["nothing was written"]);
    assert!(!project.path("let.msk").exists());
}
