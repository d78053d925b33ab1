//! `msk fmt`.

use super::project::{LEAN, Project};

#[test]
fn files_are_laid_out_in_place_and_then_left_alone() {
    let project = Project::empty();
    project.write("deep/a.msk", "const  a=1\n");
    project.write("b.msk", "const b = 1\n");
    let check = project.msk(&["fmt", "--check"]);
    assert_eq!((check.code, check.out.as_str()), (Some(1), "deep/a.msk would change\n"));
    assert_eq!(project.read("deep/a.msk"), "const  a=1\n");
    assert_eq!(project.msk(&["fmt"]).succeeded().out, "deep/a.msk\n");
    assert_eq!(project.read("deep/a.msk"), "const a = 1\n");
    assert_eq!(project.msk(&["fmt", "--check", "."]).succeeded().out, "");
}

#[test]
fn files_with_errors_are_reported_and_left_as_they_are() {
    let project = Project::empty();
    let broken = LEAN.replace("reward {", "reward { 10 a = (");
    project.write("broken.msk", &broken);
    let done = project.msk(&["fmt", "broken.msk"]);
    assert_eq!(done.code, Some(1));
    assert!(done.err.contains("broken.msk:"), "{}", done.err);
    assert_eq!(project.read("broken.msk"), broken);
    let missing = project.msk(&["fmt", "nothing.msk"]);
    assert_eq!(missing.code, Some(1));
    assert!(missing.err.contains("nothing.msk"), "{}", missing.err);
}

#[cfg(unix)]
#[test]
fn a_read_only_file_is_not_replaced() {
    use std::os::unix::fs::PermissionsExt;
    let project = Project::empty();
    let text = LEAN.replace("    family   stabilization", "  family stabilization");
    project.write("lean.msk", &text);
    std::fs::set_permissions(project.path("lean.msk"), std::fs::Permissions::from_mode(0o444)).unwrap();
    project.msk(&["fmt", "lean.msk"]).failed(1, &["lean.msk` is read-only", "chmod u+w"]);
    assert_eq!(project.read("lean.msk"), text);
}
