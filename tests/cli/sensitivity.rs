//! `msk sensitivity`: one weight at a time.

use super::project::Project;

#[test]
fn every_weight_that_may_change_takes_the_ends_of_its_range() {
    let project = Project::lean();
    project.write("quick.toml", "samples = 4\nhorizon = 0.05\ntail = 0.0\nfirst_rounds = 1\nreplan = 5\n");
    let arguments = ["sensitivity", "lean", "--policy", "plan quick.toml", "--term", "pose", "--episodes", "1", "--out", "out"];
    let done = project.msk(&arguments).succeeded();
    for part in ["unchanged", "pose = 5", "pose = 20", "more `pose` "] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    assert!(project.read("out/sensitivity.md").contains("Mean unweighted value of each term"));
    assert!(project.read("out/sensitivity.svg").starts_with("<svg"));
    // All is there: nothing is played again.
    let lines = project.read("out/pose=20/episodes.jsonl");
    assert_eq!(project.msk(&arguments).succeeded().out, done.out);
    assert_eq!(project.read("out/pose=20/episodes.jsonl"), lines);
}

#[test]
fn what_cannot_show_a_difference_is_refused() {
    let project = Project::lean();
    project.msk(&["sensitivity", "lean", "--policy", "cmc"]).failed(1, &["`cmc` does the same whatever the weights are", "plan"]);
    project.msk(&["sensitivity", "lean", "--term", "psoe"]).failed(1, &["did you mean `pose`"]);
}
