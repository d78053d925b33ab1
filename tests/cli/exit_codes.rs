//! What scripts rely on: the exit codes of `docs/exit-codes.md`, by one case for each that a command can end with.

use super::project::{LEAN, Project};

fn project() -> Project {
    let project = Project::lean();
    project.write("broken.msk", &LEAN.replace("exp(-norm(", "exp(-norm(("));
    project.write("other.msk", &LEAN.replace("5    alive", "6    alive"));
    project.write("loose.msk", &LEAN.replace("    family   stabilization", "  family stabilization"));
    project
}

#[test]
fn the_page_is_printed() {
    let page = Project::empty().msk(&["help", "exit-codes"]).succeeded().out;
    assert!(page.contains("| code | meaning |") && page.contains("| `msk eval` |"), "{page}");
    assert!(Project::empty().msk(&["--help"]).succeeded().out.contains("msk help exit-codes"));
}

#[test]
fn commands_end_with_the_codes_of_the_page() {
    let project = project();
    let missing = "missing.msk";
    let cases: &[(i32, &[&str])] = &[
        (0, &["check", "lean.msk"]),
        (1, &["check", "broken.msk"]),
        (1, &["check", missing]),
        (0, &["explain", "lean.msk"]),
        (1, &["explain", "broken.msk"]),
        (0, &["diff", "lean.msk", "lean.msk"]),
        (1, &["diff", "lean.msk", "other.msk"]),
        (2, &["diff", "lean.msk", "broken.msk"]),
        (1, &["snapshot", "lean.msk", "--check"]),
        (0, &["snapshot", "lean.msk"]),
        (0, &["snapshot", "lean.msk", "--check"]),
        (1, &["fmt", "--check", "loose.msk"]),
        (0, &["fmt", "loose.msk"]),
        (0, &["fmt", "--check", "loose.msk"]),
        (1, &["fmt", "broken.msk"]),
        (0, &["new", "task", "fresh"]),
        (1, &["new", "task", "fresh"]),
        (2, &["new", "task", "No-Name"]),
        (0, &["run", "lean.msk", "--policy", "zero"]),
        (1, &["run", "broken.msk"]),
        (1, &["run", "lean.msk", "--policy", "nobody"]),
        (0, &["run", "lean.msk", "--policy", "zero", "--png", "lean.png", "--size", "64x48"]),
        (1, &["run", "lean.msk", "--policy", "zero", "--png", "lean.png", "--at", "1000"]),
        (2, &["run", "lean.msk", "--png", "lean.png", "--at", "soon"]),
        (0, &["eval", "lean.msk", "--policy", "zero", "--episodes", "1", "--out", "results"]),
        (1, &["eval", "lean.msk", "--policy", "zero", "--episodes", "1", "--seed", "9", "--out", "results"]),
        (1, &["eval", "broken.msk"]),
        (0, &["merge", "results", "--out", "merged"]),
        (1, &["merge", "results", "--out", "merged"]),
        (2, &["merge", "results"]),
        (2, &["eval", "lean.msk", "--episodes", "none"]),
        (2, &["eval", "lean.msk", "--sweep", "wind"]),
        (0, &["run", "lean.msk", "--policy", "zero", "--trace", "lean.npz"]),
        (0, &["trace", "plot", "lean.npz"]),
        (1, &["trace", "plot", "missing.npz"]),
        (2, &["trace"]),
        (0, &["session", "init", "lean", "session"]),
        (1, &["session", "init", "lean", "session"]),
        (0, &["session", "status", "session"]),
        (1, &["session", "submit", "session", "missing.json"]),
        (2, &["session", "init", "lean", "other", "--hold", "0.001"]),
        (0, &["report", "results", "--out", "report"]),
        (1, &["report", "missing"]),
        (2, &["report"]),
        (0, &["compare", "results", "results"]),
        (1, &["compare", "results", "missing"]),
        (2, &["compare", "results"]),
        (1, &["test", "broken.msk"]),
        (0, &["exploit", "lean.msk", "--budget", "5"]),
        (1, &["exploit", "broken.msk"]),
        (2, &["exploit", "lean.msk", "--budget", "0"]),
        (0, &["vocabulary"]),
        (1, &["vocabulary", "--body", "nobody"]),
        (0, &["weights", "list", "lean.msk"]),
        (0, &["weights", "set", "lean.msk", "pose=11", "--dry-run"]),
        (1, &["weights", "set", "lean.msk", "pose=-1"]),
        (2, &["weights", "set", "lean.msk", "pose"]),
        (1, &["agent", "show", "missing"]),
        (1, &["agent", "export", "missing", "--onnx", "agent.onnx"]),
        (2, &["agent"]),
        (1, &["collect", "broken.msk"]),
        (1, &["view", "nowhere"]),
        (2, &["view"]),
        (1, &["sensitivity", "broken.msk"]),
        (1, &["tune", "broken.msk"]),
        (2, &["tune", "lean.msk", "--interval", "0"]),
        (0, &["draw", "--out", "picture.svg"]),
        (1, &["draw", "--body", "nobody", "--out", "picture.svg"]),
        (0, &["physics", "muscle", "soleus_r", "--joint", "ankle_angle_r", "--steps", "2"]),
        (1, &["physics", "muscle", "nothing", "--joint", "ankle_angle_r"]),
        (1, &["motion", "check", "missing.csv"]),
        (0, &["help"]),
        (2, &["help", "dance"]),
        (2, &["dance"]),
        (1, &["mcp", "--project", "nowhere"]),
    ];
    for (code, arguments) in cases {
        let done = project.msk(arguments);
        assert_eq!(done.code, Some(*code), "msk {}: {done:?}", arguments.join(" "));
        assert!(!done.err.contains("panicked"), "msk {}: {}", arguments.join(" "), done.err);
    }
}

#[test]
fn an_editor_that_goes_without_a_word_is_no_success() {
    // Standard input is empty: neither `shutdown` nor `exit` comes.
    assert_eq!(project().msk(&["lsp"]).code, Some(1));
}
