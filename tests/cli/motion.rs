//! `msk motion`: tables of motions, measured and drawn.

use super::project::Project;

const NOD: &str = "# name: nod\n# source: made up\n# cycle: yes\n# duration: 2 s\n\
    phase, lumbar_extension [deg], knee_angle_l [deg], knee_angle_r [deg]\n\
    0, 0, 5, 5\n0.25, -20, 10, 10\n0.5, -30, 10, 10\n0.75, -20, 10, 10\n1, 0, 5, 5\n";

#[test]
fn a_motion_is_checked_and_drawn() {
    let project = Project::empty();
    project.write("nod.csv", NOD);
    let checked = project.msk(&["motion", "check", "nod.csv"]).succeeded();
    for part in
        ["nod: a cycle of 2 s in 5 rows", "lumbar_extension           deg       -30", "at the same time", "all within the limits"]
    {
        assert!(checked.out.contains(part), "no `{part}` in {}", checked.out);
    }
    let json = project.msk(&["motion", "check", "nod.csv", "--json"]).succeeded();
    let json: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!(json["columns"][1]["name"], "knee_angle_l");
    project.msk(&["motion", "plot", "nod.csv", "--out", "nod.svg", "--bodies", "3"]).succeeded();
    let picture = project.read("nod.svg");
    assert!(picture.starts_with("<svg") && picture.ends_with("</svg>\n") && !picture.contains("NaN"));
    assert!(picture.contains("knee angle [deg]") && picture.contains("50 %"));
}

#[test]
fn what_is_no_motion_is_reported_with_its_place() {
    let project = Project::empty();
    project.write("nod.csv", &NOD.replace("knee_angle_l", "knee_angel_l").replace("0.5, -30", "0.5, x"));
    project.msk(&["motion", "check", "nod.csv"]).failed(1, &["nod.csv:8:6", "`x` is not a number"]);
    project.write("nod.csv", &NOD.replace("knee_angle_l", "knee_angel_l"));
    project.msk(&["motion", "plot", "nod.csv"]).failed(1, &["nod.csv:5:32", "did you mean `knee_angle_l`?"]);
    project.msk(&["motion", "check", "none.csv"]).failed(1, &["there is no motion `none.csv`"]);
}

#[test]
fn a_motion_becomes_a_page() {
    let project = Project::empty();
    project.write("nod.csv", NOD);
    project.msk(&["motion", "view", "nod.csv", "--out", "nod.html"]).succeeded();
    assert!(project.read("nod.html").contains("<title>nod</title>"));
    project.msk(&["motion", "view", "nod.csv", "--out", "nowhere/nod.html"]).failed(1, &["cannot write `nowhere/nod.html`"]);
    project.msk(&["motion", "view", "none.csv", "--out", "none.html"]).failed(1, &["there is no motion `none.csv`"]);
}
