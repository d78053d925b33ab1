//! `msk collect`: data sets.

use super::project::Project;
use msk::evaluate::npz::NpzReader;
use npyz::NpyFile;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

const COMMAND: [&str; 8] = ["collect", "lean", "--policy", "random", "--episodes", "2", "--out", "data"];

/// An array of an episode, with its shape.
fn array<T: npyz::Deserialize>(project: &Project, episode: u64, name: &str) -> (Vec<u64>, Vec<T>) {
    let file: PathBuf = project.path(&format!("data/{episode:04}.npz"));
    let bytes = fs::read(file).unwrap();
    let entry = NpzReader::new(&bytes).unwrap().entry(&format!("{name}.npy"), u64::MAX);
    let entry = entry.unwrap_or_else(|error| panic!("no array `{name}`: {error}"));
    let array = NpyFile::new(&entry[..]).unwrap();
    (array.shape().to_vec(), array.into_vec().unwrap())
}

#[test]
fn every_step_of_every_episode_is_kept() {
    let project = Project::lean();
    let done = project.msk(&COMMAND).succeeded();
    assert!(done.out.contains("2 episodes, 40 control steps, "), "{}", done.out);
    let layout: Value = serde_json::from_str(&project.read("data/data.json")).unwrap();
    let columns = |of: &str| layout[of].as_array().unwrap().iter().map(|part| part["size"].as_u64().unwrap()).sum::<u64>();
    let count = |of: &str| layout[of].as_array().unwrap().len() as u64;
    for episode in 0..2 {
        let (shape, observations) = array::<f32>(&project, episode, "observations");
        assert_eq!(shape, [21, columns("observations")]);
        assert!(observations.iter().all(|value| value.is_finite()));
        let (shape, actions) = array::<f64>(&project, episode, "actions");
        assert_eq!(shape, [20, count("actions")]);
        assert!(actions.iter().all(|action| (-1.0..=1.0).contains(action)));
        let (shape, terms) = array::<f64>(&project, episode, "terms");
        assert_eq!(shape, [20, count("terms")]);
        let (_, rewards) = array::<f64>(&project, episode, "rewards");
        for (reward, terms) in rewards.iter().zip(terms.chunks_exact(shape[1] as usize)) {
            assert!((reward - terms.iter().sum::<f64>()).abs() < 1e-9);
        }
        let ends = ["terminations", "truncations"].map(|name| array::<bool>(&project, episode, name).1);
        assert!(ends[0].iter().all(|ends| !ends) && ends[1].iter().filter(|ends| **ends).count() == 1 && ends[1][19]);
        let record: Value =
            serde_json::from_str(project.read("data/episodes.jsonl").lines().nth(episode as usize).unwrap()).unwrap();
        assert!((record["return"].as_f64().unwrap() - rewards.iter().sum::<f64>()).abs() < 1e-9);
        assert_eq!(array::<bool>(&project, episode, "success").1, [record["success"].as_bool().unwrap()]);
    }
}

#[test]
fn lost_arrays_are_noticed() {
    let project = Project::lean();
    project.msk(&COMMAND).succeeded();
    fs::remove_file(project.path("data/0001.npz")).unwrap();
    project.msk(&COMMAND).failed(1, &["has lost the arrays of 1 episodes, such as `0001.npz`", "hint: restore"]);
    let train = ["train", "lean", "--algorithm", "clone", "--data", "data", "--out", "trained"];
    project.msk(&train).failed(1, &["the data set `data` is not whole", "0001.npz"]);

    // Numbers that are none, in an archive that is otherwise right.
    let observations = array::<f32>(&project, 0, "observations").0[1] as usize;
    let actions = array::<f64>(&project, 0, "actions").0[1] as usize;
    let archive = |value: f64| {
        let mut archive = msk::evaluate::npz::NpzWriter::new(std::io::Cursor::new(Vec::new()));
        archive.array("observations", &vec![0.0_f32; 2 * observations], &[2, observations]).unwrap();
        archive.array("actions", &vec![value; actions], &[1, actions]).unwrap();
        archive.finish().unwrap().into_inner()
    };
    fs::write(project.path("data/0001.npz"), archive(f64::NAN)).unwrap();
    project.msk(&train).failed(1, &["0001.npz` has numbers that are not finite"]);
}

#[test]
fn a_data_set_is_completed_to_the_same_bytes() {
    let (project, whole) = (Project::lean(), Project::lean());
    whole.msk(&COMMAND).succeeded();
    project.msk(&["collect", "lean", "--policy", "random", "--episodes", "2", "--out", "data"]).succeeded();
    // As if the second episode had not come to its line in the journal.
    let lines = project.read("data/episodes.jsonl");
    project.write("data/episodes.jsonl", &format!("{}\n", lines.lines().next().unwrap()));
    project.write("data/0001.npz", "half of an archi");
    project.msk(&COMMAND).succeeded();
    for name in ["0000.npz", "0001.npz", "data.json", "run.json"] {
        let bytes = |project: &Project| fs::read(project.path(&format!("data/{name}"))).unwrap();
        assert_eq!(bytes(&project), bytes(&whole), "{name}");
    }
}

#[test]
fn another_policy_does_not_go_into_the_same_folder() {
    let project = Project::lean();
    project.msk(&COMMAND).succeeded();
    let other = project.msk(&["collect", "lean", "--policy", "zero", "--episodes", "2", "--out", "data"]);
    assert_eq!(other.code, Some(1));
    assert!(other.err.contains("choose another folder"), "{}", other.err);
}

#[test]
fn merged_shards_have_the_bytes_of_one_machine() {
    let project = Project::lean();
    let collect = |out: &str, more: &[&str]| {
        project.msk(&[&["collect", "lean", "--policy", "random", "--episodes", "5", "--out", out], more].concat())
    };
    collect("whole", &[]).succeeded();
    let shards = ["one", "two", "three"];
    for (number, out) in (1..).zip(shards) {
        collect(out, &["--shard", &format!("{number}/3")]).succeeded();
    }
    assert!(project.path("two/0001.npz").is_file() && !project.path("two/0000.npz").exists());
    collect("two", &[]).failed(1, &["its shard is 2/3, not none"]);
    let merge = |shards: &[&str], out: &str| project.msk(&[&["merge"], shards, &["--out", out]].concat());
    merge(&["two", "one"], "part").failed(1, &["episodes are missing, such as episode 2 of `lean`", "hint: finish all shards"]);
    assert!(!project.path("part").exists());
    let done = merge(&["three", "one", "two"], "merged").succeeded();
    assert!(done.out.starts_with("5 episodes, 100 control steps, "), "{}", done.out);
    for name in ["0000.npz", "0001.npz", "0002.npz", "0003.npz", "0004.npz", "data.json", "episodes.jsonl", "run.json"] {
        let bytes = |folder: &str| fs::read(project.path(&format!("{folder}/{name}"))).unwrap();
        assert_eq!(bytes("merged"), bytes("whole"), "{name}");
    }
    // The merged folder is a data set like any other: nothing is left to be played.
    collect("merged", &[]).succeeded();
    merge(&["one", "two", "three"], "merged").failed(1, &["cannot make the folder `merged`"]);

    // What shards say of the same thing has to be the same.
    let columns = project.read("two/data.json");
    project.write("two/data.json", &columns.replace("lean", "mean"));
    merge(&shards, "other").failed(1, &["`two` contains another run than `one`: its `data.json` differs"]);
    project.write("two/data.json", &columns);
    fs::remove_file(project.path("two/0001.npz")).unwrap();
    merge(&shards, "other").failed(1, &["0001.npz"]);
}

#[test]
fn a_shard_without_an_episode_is_refused() {
    let project = Project::lean();
    let none = ["collect", "lean", "--policy", "random", "--episodes", "2", "--shard", "3/3"];
    project.msk(&none).failed(2, &["shard 3/3 has none of the episodes", "hint:"]);
}
