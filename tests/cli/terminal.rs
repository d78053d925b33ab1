//! Files and folders of other people whose names and texts would steer a terminal: every command shows them and none obeys.

use super::project::{LEAN, Project};

/// Clears a screen, sets a title, goes back in its line, reverses what follows, in C0, C1 and Unicode.
const HOSTILE: &str = "x\u{1b}[2J\u{1b}]0;t\u{7}\r\u{9b}31m\u{202e}y";

/// Whether a text has a character that acts, but for line ends and tabs.
fn acts(text: &str) -> bool {
    text.chars()
        .any(|letter| (letter.is_control() && !matches!(letter, '\n' | '\t')) || ('\u{202a}'..='\u{202e}').contains(&letter))
}

#[test]
fn no_command_obeys_the_name_of_a_file_or_folder() {
    let project = Project::lean();
    std::fs::create_dir(project.path(HOSTILE)).unwrap();
    let (source, broken) = (format!("{HOSTILE}.msk"), format!("{HOSTILE}-broken.msk"));
    project.write(&source, LEAN);
    project.write(&broken, &LEAN.replace("pelvis.height", &format!("pelvis.heigth # {HOSTILE}\n")));
    project.write(&format!("{HOSTILE}.csv"), HOSTILE);
    project.write(&format!("{HOSTILE}.npz"), HOSTILE);
    let (table, trace) = (format!("{HOSTILE}.csv"), format!("{HOSTILE}.npz"));
    let commands: &[&[&str]] = &[
        &["check", &source, &broken],
        &["check", &broken, "--format", "json"],
        &["fmt", "--check", &source, &broken],
        &["explain", &broken],
        &["explain", HOSTILE],
        &["run", &format!("{source}@{HOSTILE}"), "--policy", "zero"],
        &["run", &source, "--policy", HOSTILE],
        &["run", &source, "--policy", "zero", "--html", &format!("{HOSTILE}/none/{HOSTILE}")],
        &["run", &source, "--policy", "zero", "--weight", &format!("{HOSTILE}=1")],
        &["run", &source, "--policy", "zero", "--set", &format!("{HOSTILE}=1")],
        &["run", &source, "--policy", "zero", "--weakness", &format!("{HOSTILE}=0.5")],
        &["eval", &source, "--policy", "zero", "--episodes", "1", "--out", &format!("{HOSTILE}/results")],
        &["eval", &source, "--policy", "zero", "--episodes", "1", "--protocol", HOSTILE],
        &["collect", &source, "--policy", "zero", "--episodes", "1", "--out", &format!("{HOSTILE}/data")],
        &["report", HOSTILE],
        &["report", &format!("{HOSTILE}/results"), "--out", &format!("{HOSTILE}/report")],
        &["compare", &format!("{HOSTILE}/results"), &format!("{HOSTILE}/results")],
        &["compare", HOSTILE, HOSTILE],
        &["merge", HOSTILE, "--out", "merged"],
        &["merge", &format!("{HOSTILE}/results"), "--out", &format!("{HOSTILE}/merged")],
        &["agent", "show", HOSTILE],
        &["train", &source, "--settings", &table],
        &["train", &source, "--start", HOSTILE],
        &["session", "init", &source, &format!("{HOSTILE}/session")],
        &["session", "submit", &format!("{HOSTILE}/session"), &table],
        &["session", "status", HOSTILE],
        &["trace", "plot", &trace],
        &["trace", "export", &trace],
        &["trace", "envelopes", HOSTILE],
        &["motion", "check", &table],
        &["view", HOSTILE],
        &["tune", &source, "--reasoner", &table],
        &["weights", "list", &source],
        &["weights", "set", &source, "none=1"],
        &["vocabulary", HOSTILE],
        &["test", &source, "--filter", HOSTILE],
        &["snapshot", &source, "--out", &format!("{HOSTILE}/snapshots")],
        &["diff", &source, &broken],
        &["help", HOSTILE],
    ];
    for command in commands {
        let done = project.msk(command);
        assert!(!acts(&done.out) && !acts(&done.err), "{command:?}: {done:?}");
        assert!(!done.err.contains("panicked"), "{command:?}: {done:?}");
    }
}

/// Results name their policy; the words stand behind a checksum that anybody can compute.
#[test]
fn no_command_obeys_the_words_of_an_agent_or_a_session() {
    let project = Project::lean();
    project.msk(&["session", "init", "lean", "session"]).succeeded();
    let session = project.read("session/session.json");
    let hostile = serde_json::to_string(HOSTILE).unwrap();
    project.write("session/session.json", &session.replace("\"task\": \"lean\"", &format!("\"task\": {hostile}")));
    assert_ne!(project.read("session/session.json"), session);
    for command in [&["session", "status", "session"][..], &["session", "tracking", "session"], &["report", "session"]] {
        let done = project.msk(command);
        assert!(!acts(&done.out) && !acts(&done.err), "{command:?}: {done:?}");
    }
    assert!(
        project
            .msk(&["session", "status", "session"])
            .succeeded()
            .out
            .starts_with("x\\u001b[2J\\u001b]0;t\\u0007\\r\\u009b31m\\u202ey: ")
    );
}
