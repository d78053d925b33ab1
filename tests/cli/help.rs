//! `msk help`, code pages, and the quiet end of a pipe.

use super::project::Project;
use std::io::Read;

#[test]
fn help_lists_the_commands_and_explains_each() {
    let project = Project::empty();
    let all = project.msk(&["help"]).succeeded().out;
    for command in ["check", "explain", "run", "eval", "test", "mutate", "exploit", "vocabulary", "physics"] {
        assert!(all.contains(&format!("\n  {command} ")), "no `{command}` in {all}");
        let own = project.msk(&["help", command]).succeeded().out;
        assert!(own.contains(&format!("Usage: msk {command}")), "{own}");
    }
    assert_eq!(project.msk(&["help", "eval"]).out, project.msk(&["eval", "--help"]).out);
}

#[test]
fn every_code_has_a_page() {
    let project = Project::empty();
    let page = project.msk(&["help", "E0101"]).succeeded().out;
    for part in ["E0101: ", "Wrong:", "Right:"] {
        assert!(page.contains(part), "{page}");
    }
    assert_eq!(project.msk(&["help", "e0101"]).succeeded().out, page);
    project.msk(&["help", "E9999"]).failed(2, &["no code `E9999`"]);
    project.msk(&["help", "dance"]).failed(2, &["no command `dance`"]);
}

#[test]
fn every_lint_is_listed_and_has_a_page_under_its_name_and_its_code() {
    let project = Project::empty();
    let list = project.msk(&["help", "lints"]).succeeded().out;
    let row = list.lines().find(|line| line.starts_with("W0511 ")).unwrap_or_else(|| panic!("{list}"));
    assert_eq!(row.split_whitespace().take(4).collect::<Vec<_>>(), ["W0511", "dead_at_reset", "warn", "probe"], "{row}");
    let page = project.msk(&["help", "dead_at_reset"]).succeeded().out;
    assert!(page.starts_with("W0511 dead_at_reset: "), "{page}");
    for asked in [["help", "w0511"], ["explain", "W0511"], ["explain", "dead_at_reset"]] {
        assert_eq!(project.msk(&asked).succeeded().out, page, "{asked:?}");
    }
}

#[test]
fn the_vocabulary_is_printed_for_people_and_as_json() {
    let project = Project::empty();
    let text = project.msk(&["vocabulary"]).succeeded().out;
    for part in ["clearance", "pelvis", "knee_angle_r", "soleus_r", "neutral"] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    let json: serde_json::Value = serde_json::from_str(&project.msk(&["vocabulary", "--json"]).succeeded().out).unwrap();
    assert!(json["signals"].as_array().unwrap().len() > 50);
    assert_eq!(json["body"]["muscles"].as_array().unwrap().len(), 416);
}

#[test]
fn a_reader_that_has_enough_ends_the_program_quietly() {
    let project = Project::empty();
    let mut child = project.command(&["vocabulary", "--json"]).spawn().unwrap();
    // Closes the pipe before anything was read.
    drop(child.stdout.take());
    let mut message = String::new();
    child.stderr.take().unwrap().read_to_string(&mut message).unwrap();
    assert!(child.wait().unwrap().success());
    assert_eq!(message, "");
}
