//! `msk run --png`, `--strip`: moments of an episode as pictures.

use super::project::Project;
use std::fs;

/// The bytes of a PNG file, its width and its height.
fn picture(project: &Project, name: &str) -> (Vec<u8>, [u32; 2]) {
    let bytes = fs::read(project.path(name)).unwrap();
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    let size = [number(16), number(20)];
    (bytes, size)
}

#[test]
fn moments_become_pictures_with_the_same_bytes() {
    let project = Project::lean();
    let run = ["run", "lean", "--policy", "random", "--seed", "3", "--size", "96x120"];
    for names in [["a.png", "a-strip.png"], ["b.png", "b-strip.png"]] {
        project
            .msk(&[&run[..], &["--png", names[0], "--at", "0.1 s", "--strip", names[1], "--frames", "3"]].concat())
            .succeeded();
    }
    let (first, size) = picture(&project, "a.png");
    assert_eq!(size, [96, 120]);
    assert_eq!(first, picture(&project, "b.png").0);
    let (strip, size) = picture(&project, "a-strip.png");
    // Three frames of 77 pixels with two gaps of three.
    assert_eq!(size, [3 * 77 + 6, 120]);
    assert_eq!(strip, picture(&project, "b-strip.png").0);
    for changed in [["--at", "0"], ["--view", "back"], ["--theme", "dark"], ["--colour", "force"]] {
        project.msk(&[&run[..], &["--png", "c.png"], &changed].concat()).succeeded();
        assert_ne!(first, picture(&project, "c.png").0, "{changed:?}");
    }
}

#[test]
fn an_episode_of_an_evaluation_becomes_a_picture() {
    let project = Project::lean();
    project.msk(&["eval", "lean.msk", "--policy", "zero", "--episodes", "2", "--out", "results"]).succeeded();
    project.msk(&["run", "lean", "--replay", "results", "--episode", "1", "--png", "one.png", "--size", "64x48"]).succeeded();
    project.msk(&["run", "lean", "--policy", "zero", "--episode", "1", "--png", "two.png", "--size", "64x48"]).succeeded();
    assert_eq!(picture(&project, "one.png"), picture(&project, "two.png"));
    project.msk(&["run", "lean", "--ignore-terminations", "--policy", "zero", "--png", "on.png", "--size", "64x48"]).succeeded();
    assert_ne!(picture(&project, "one.png"), picture(&project, "on.png"));
}

#[test]
fn what_cannot_be_a_picture_is_refused() {
    let project = Project::lean();
    let run = ["run", "lean", "--policy", "zero"];
    let with = |more: &[&str]| project.msk(&[&run[..], more].concat());
    with(&["--png", "a.png", "--at", "99"]).failed(1, &["there is no picture at 99 s: the episode ended after", "--at"]);
    with(&["--png", "nowhere/a.png"]).failed(1, &["cannot write `nowhere/a.png`"]);
    with(&["--png", "a.png", "--at=-1"]).failed(2, &["a number of seconds"]);
    with(&["--png", "a.png", "--size", "0x9"]).failed(2, &["two numbers from 1 to 8192"]);
    with(&["--png", "a.png", "--view", "below"]).failed(2, &["choose one of: three-quarter, front"]);
    with(&["--at", "1"]).failed(2, &["--png"]);
    with(&["--strip", "a.png", "--frames", "0"]).failed(2, &["0 is not in 1..=64"]);
    with(&["--strip", "a.png", "--frames", "64", "--size", "99x8000"]).failed(1, &["expected a picture of 1 to 8192 pixels"]);
}
