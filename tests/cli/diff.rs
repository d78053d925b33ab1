//! `msk diff` and `msk snapshot`.

use super::project::{Done, LEAN, Project};
use serde_json::Value;

/// The task, written differently and meaning the same.
fn rewritten() -> String {
    LEAN.replace("10    pose   =", "10 pose = // about the posture\n").replace("- 2 cm", "- 0.02 m")
}

/// Exit code 1, which is an answer and no failure.
fn differs(done: Done) -> Done {
    assert_eq!(done.code, Some(1), "{done:?}");
    done
}

#[test]
fn two_texts_of_one_meaning_are_the_same() {
    let project = Project::lean();
    project.write("other.msk", &rewritten());
    let done = project.msk(&["diff", "lean.msk", "other.msk"]).succeeded();
    assert_eq!(done.out, "");
}

#[test]
fn a_difference_is_reported_in_words_and_makes_the_exit_code() {
    let project = Project::lean();
    project.write("other.msk", &LEAN.replace("10    pose", "12 (5..20) pose").replace("- 2 cm", "- 3 cm"));
    let done = differs(project.msk(&["diff", "lean", "other.msk@lean"]));
    assert!(done.out.contains("~ term pose\n      weight 10 -> 12 (+20 %)\n      range none -> 5..20\n"), "{}", done.out);
    assert!(done.out.contains("~ ends by sunk") && done.out.contains("3 cm (+50 %)\n"), "{}", done.out);
    let done = differs(project.msk(&["diff", "lean.msk", "other.msk", "--format", "json"]));
    let differences: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(differences[0]["changes"][0]["fields"][0]["after"], "12");
}

#[test]
fn what_cannot_be_compared_has_an_exit_code_of_its_own() {
    let project = Project::lean();
    project.write("broken.msk", "task broken {");
    project.msk(&["diff", "lean", "broken.msk"]).failed(2, &["error"]);
    project.msk(&["diff", "lean", "missing.msk"]).failed(2, &["missing.msk"]);
}

#[test]
fn a_snapshot_holds_through_comments_and_layout_and_breaks_with_the_meaning() {
    let project = Project::lean();
    differs(project.msk(&["snapshot", "--check"]));
    let done = project.msk(&["snapshot"]).succeeded();
    assert!(done.out.contains("lean.snapshot"), "{}", done.out);
    assert!(project.read("snapshots/lean.snapshot").starts_with("msk snapshot 1\n\ntask lean\n"));
    project.write("lean.msk", &rewritten());
    project.msk(&["snapshot", "--check"]).succeeded();
    project.write("lean.msk", &LEAN.replace("-1    effort", "-2    effort"));
    let done = differs(project.msk(&["snapshot", "--check"]));
    assert!(done.err.contains("run `msk snapshot`"), "{}", done.err);
    assert_eq!(done.out, "lean\n  ~ term effort\n      weight -1 -> -2 (+100 %)\n");
    let done = project.msk(&["snapshot"]).succeeded();
    assert!(done.out.contains("weight -1 -> -2"), "{}", done.out);
    project.msk(&["snapshot", "--check"]).succeeded();
    project.msk(&["diff", "snapshots/lean.snapshot", "lean"]).succeeded();
    project.write("snapshots/gone.snapshot", "msk snapshot 1\n\ntask gone\n");
    let done = differs(project.msk(&["snapshot", "--check"]));
    assert!(done.out.contains("gone\n  has a snapshot"), "{}", done.out);
}

/// A relative of the links in `.msk`: a folder from somebody else may hold a link where a snapshot is written.
#[cfg(unix)]
#[test]
fn no_snapshot_is_written_through_a_link() {
    let (project, elsewhere) = (Project::lean(), tempfile::tempdir().unwrap());
    let victim = elsewhere.path().join(".bashrc");
    std::fs::write(&victim, "precious\n").unwrap();
    std::fs::create_dir(project.path("snapshots")).unwrap();
    std::os::unix::fs::symlink(&victim, project.path("snapshots/lean.snapshot")).unwrap();
    project.msk(&["snapshot"]).failed(1, &["lean.snapshot` is a symbolic link"]);
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious\n");
}
