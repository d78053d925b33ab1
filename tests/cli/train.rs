//! `msk train`: a folder that resumes after any end, agents that act, and what is refused.

use super::project::{Done, Project};
use crate::support::repository;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

const SETTINGS: &str = "hidden = [16]\nepisodes = 4\nevaluate_every = 2000\nevaluation_episodes = 2\ncheckpoint_every = 1000\n\
    [ppo]\nhorizon = 50\nminibatch = 50\nepochs = 2\n";

/// A folder with the pendulum of the learners' own tests.
pub fn project() -> Project {
    let project = Project::empty();
    for file in ["pendulum.msk", "pendulum.xml"] {
        project.write(file, &std::fs::read_to_string(repository("learn/train/tests").join(file)).unwrap());
    }
    project.write("learner.toml", SETTINGS);
    project
}

pub fn train(project: &Project, steps: &str, out: &str) -> std::process::Command {
    project.command(&["train", "pendulum.msk", "--settings", "learner.toml", "--threads", "1", "--steps", steps, "--out", out])
}

#[test]
fn an_agent_is_trained_evaluated_and_acts() {
    let project = project();
    let done = Done::from(train(&project, "4000", "out").output().unwrap()).succeeded();
    assert!(done.err.contains("hold: ppo, 4000 steps, seed 0, in `out`"), "{}", done.err);
    assert!(done.err.contains("      2000 steps: return ") && done.err.contains("      4000 steps: return "), "{}", done.err);
    assert!(
        done.out.contains("best by success: ") && done.out.contains("--policy \"agent out/best-by-success\""),
        "{}",
        done.out
    );
    for folder in ["out", "out/last", "out/best-by-return"] {
        let policy = format!("agent {folder}");
        let out = project.msk(&["run", "pendulum.msk", "--policy", &policy]).succeeded().out;
        assert!(out.contains("hold, policy agent ") && out.contains("\nreturn "), "{out}");
    }
    let network = "network out/last/policy.safetensors";
    project.msk(&["eval", "pendulum.msk", "--policy", "agent out", "--policy", network, "--episodes", "2"]).succeeded();
    let shown = project.msk(&["agent", "show", "out"]).succeeded().out;
    assert!(shown.starts_with("task       hold (") && shown.contains("network    2 - 16 - 1, tanh\n"), "{shown}");
    project.msk(&["agent", "export", "out", "--onnx", "agent.onnx"]).succeeded();
    let returned = |policy: &str| {
        let out = project.msk(&["run", "pendulum.msk", "--policy", policy]).succeeded().out;
        out.lines().find(|line| line.starts_with("return ")).unwrap().to_owned()
    };
    assert_eq!(returned("network agent.onnx"), returned("agent out"));
    project.msk(&["agent", "export", "nowhere", "--onnx", "agent.onnx"]).failed(1, &["cannot open the folder `nowhere`"]);
    project.msk(&["agent", "export", "out"]).failed(2, &["--onnx <FILE>", "--half <DIR>"]);
    project.msk(&["agent", "export", "out", "--half", "small/hold"]).succeeded();
    let shown = project.msk(&["agent", "show", "small/hold"]).succeeded().out;
    assert!(shown.contains("network    2 - 16 - 1, tanh\n") && !shown.contains("evaluated"), "{shown}");
    let best = project.msk(&["eval", "pendulum.msk", "--policy", "agents small", "--episodes", "2"]).succeeded().out;
    assert!(best.contains("Policy `agents small ("), "{best}");
    project.msk(&["run", "pendulum.msk", "--policy", "agents"]).failed(1, &["no agent was trained on `hold`, only on "]);
    project.msk(&["run", "pendulum.msk", "--policy", "agents results"]).failed(1, &["cannot read `results`"]);
    // Once it is whole, the same command has nothing to do.
    let again = Done::from(train(&project, "4000", "out").output().unwrap()).succeeded();
    assert!(again.err.contains("resuming after 4000 steps"), "{}", again.err);
    assert_eq!(again.out, done.out);
}

/// Their tasks may not change without training them anew: `agents/README.md`.
#[test]
fn the_agents_that_come_with_the_program_succeed_in_their_tasks() {
    let project = Project::empty();
    let agents = msk::train::Agents::built_in().unwrap();
    let mut left: BTreeSet<&str> = agents.agents().iter().map(|agent| agent.description.task.as_str()).collect();
    for (file, tasks) in [("tasks.msk", 22), ("agents/targets.msk", 15)] {
        let path = repository(file);
        project.msk(&["eval", path.to_str().unwrap(), "--policy", "agents", "--episodes", "1", "--out", "out"]).succeeded();
        let report = project.read("out/report.md");
        std::fs::remove_dir_all(project.path("out")).unwrap();
        let before = left.len();
        for line in report.lines().filter(|line| line.contains("| 100 % ")) {
            left.remove(line[2..].split(' ').next().unwrap());
        }
        let skipped = report.lines().filter(|line| line.contains("| skipped: no agent was trained on ")).count();
        assert_eq!(skipped, tasks - (before - left.len()), "{report}");
    }
    assert!(left.is_empty(), "{left:?} were not played, or did not succeed");
}

#[test]
fn a_training_that_is_killed_ends_as_an_undisturbed_one() {
    let project = project();
    Done::from(train(&project, "20000", "whole").output().unwrap()).succeeded();
    let mut child = train(&project, "20000", "parts").spawn().unwrap();
    let start = Instant::now();
    while !project.path("parts/checkpoint.bin").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint has been written");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let resumed = Done::from(train(&project, "20000", "parts").output().unwrap()).succeeded();
    assert!(resumed.err.contains("resuming after "), "{}", resumed.err);
    for file in ["last/policy.safetensors", "best-by-success/policy.safetensors", "best-by-return/agent.toml"] {
        let bytes = |folder: &str| std::fs::read(project.path(folder).join(file)).unwrap();
        assert!(bytes("parts") == bytes("whole"), "{file}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_training_keeps_what_was_learned() {
    let project = project();
    let child = train(&project, "10000000", "out").spawn().unwrap();
    let start = Instant::now();
    while !project.path("out/checkpoint.bin").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint has been written");
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let done = Done::from(child.wait_with_output().unwrap());
    assert_eq!(done.code, Some(130), "{done:?}");
    assert!(done.err.contains("interrupted after ") && done.err.contains("--out out` resumes"), "{}", done.err);
}

#[test]
fn what_cannot_be_trained_is_explained() {
    let project = project();
    project.write("wrong.toml", "hidden = [16]\nepisodes = 0\n");
    let train = |more: &[&str]| project.msk(&[&["train", "pendulum.msk"], more].concat());
    train(&["--settings", "wrong.toml"]).failed(1, &["`wrong.toml`: line 2: `episodes` is 0; expected a whole number from 1"]);
    train(&["--settings", "learner.toml", "--preset", "fast"]).failed(2, &["cannot be used with"]);
    train(&["--algorithm", "dqn"]).failed(2, &["choose one of: ppo, sac, simba, dynsyn, mpo, clone"]);
    train(&["--budget", "soon"]).failed(2, &["`soon` is no time: write 90s, 30m, 2h or 1h30m"]);
    train(&["--settings", "learner.toml", "--steps", "200", "--out", "out"]).succeeded();
    train(&["--settings", "learner.toml", "--steps", "100", "--out", "out"])
        .failed(1, &["holds another training: its number of steps is 200, not 100; choose another folder with --out"]);
    train(&["--settings", "learner.toml", "--steps", "400", "--out", "out"])
        .failed(1, &["holds a training of 200 steps, which `anneal` of `[ppo]` has fitted to their number: it cannot have 400"]);
    project.write("changed.msk", &project.read("pendulum.msk").replace("0.5 rad)^2", "0.4 rad)^2"));
    project
        .msk(&["run", "changed.msk", "--policy", "agent out"])
        .failed(1, &["the task `hold` has changed since it was trained"]);
    project.msk(&["run", "changed.msk", "--policy", "agent --any-task out"]).succeeded();
    project.msk(&["run", "pendulum.msk", "--policy", "agent nowhere"]).failed(1, &["cannot read `nowhere`"]);
    project.msk(&["run", "pendulum.msk", "--policy", "agent"]).failed(1, &["`agent` needs a folder"]);
}

#[test]
fn a_budget_of_time_becomes_steps_that_are_kept() {
    let project = project();
    let train = || project.msk(&["train", "pendulum.msk", "--settings", "learner.toml", "--budget", "1s", "--out", "out"]);
    let first = train().succeeded();
    assert!(first.err.contains("steps within the budget"), "{}", first.err);
    let second = train().succeeded();
    assert!(second.err.contains("resuming after ") && !second.err.contains("within the budget"), "{}", second.err);
}

#[test]
fn a_curve_is_written_for_tensorboard_too() {
    let project = project();
    let train = |steps: &str| {
        let mut command = train(&project, steps, "out");
        command.arg("--tensorboard");
        Done::from(command.output().unwrap()).succeeded();
        let names = std::fs::read_dir(project.path("out")).unwrap().map(|entry| entry.unwrap().path());
        let events: Vec<_> = names.filter(|path| path.to_string_lossy().contains("events.out.tfevents.")).collect();
        assert_eq!(events.len(), 1, "{events:?}");
        String::from_utf8_lossy(&std::fs::read(&events[0]).unwrap()).into_owned()
    };
    let events = train("4000");
    let lines = project.read("out/curve.jsonl");
    for (tag, key) in [("evaluation/success", "\"evaluation\""), ("losses/entropy", "\"losses\""), ("terms/near", "\"terms\"")] {
        assert_eq!(events.matches(tag).count(), lines.matches(key).count(), "{tag}");
    }
    // A process that has nothing left to do writes the same curve again.
    assert_eq!(train("4000").matches("terms/near").count(), events.matches("terms/near").count());
}

/// What is short enough for a test.
const CLONE: &str =
    "algorithm = \"clone\"\nhidden = [32]\nepisodes = 2\nevaluation_episodes = 2\n[clone]\nupdates = 0.2\nbatch = 64\n";

#[test]
fn a_controller_is_cloned_from_its_episodes_and_as_a_teacher() {
    let project = Project::lean();
    project.write("clone.toml", CLONE);
    let observe = "observe {\n        pelvis.height\n        hip_flexion_{l,r}.q\n        knee_angle_{l,r}.q\n        ankle_angle_{l,r}.q\n    }";
    let lean = project.read("lean.msk").replace("observe { pelvis.height }", observe);
    project.write("lean.msk", &lean);
    // The same in a space of synergies: muscles that share an action ask for their mean.
    project.write(
        "synergies.msk",
        &lean.replace("    init {", "    act synergies { of [calves, hamstrings, quadriceps], sides }\n\n    init {"),
    );
    for task in ["lean.msk", "synergies.msk"] {
        let data = format!("data-{task}");
        project.msk(&["collect", task, "--policy", "cmc", "--episodes", "2", "--out", &data]).succeeded();
        let common = ["train", task, "--settings", "clone.toml", "--steps", "2048"];
        let recorded = project.msk(&[&common[..], &["--data", &data, "--out", &format!("recorded-{task}")]].concat()).succeeded();
        assert!(recorded.err.contains(": clone, 2048 steps"), "{}", recorded.err);
        let lines = project.read(format!("recorded-{task}/curve.jsonl"));
        let errors: Vec<f64> = lines
            .lines()
            .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["losses"]["error"].as_f64())
            .collect();
        assert!(errors.len() == 2 && errors[1] < 0.5 * errors[0], "{task}: {errors:?}");
        let taught =
            project.msk(&[&common[..4], &["--steps", "80", "--teacher", "cmc", "--out", &format!("taught-{task}")]].concat());
        let lines = taught.succeeded().err;
        assert!(lines.contains("80 steps: return "), "{lines}");
        project.msk(&["run", task, "--policy", &format!("agent taught-{task}")]).succeeded();
    }
    // Where actions ask for activations a teacher of excitations is asked what they lead to; recorded ones do not say.
    project.write("activations.msk", &project.read("synergies.msk").replace("sides }", "sides, activations }"));
    let clone = ["train", "activations.msk", "--settings", "clone.toml", "--steps", "80"];
    project.msk(&[&clone[..], &["--teacher", "cmc", "--out", "activations"]].concat()).succeeded();
    project.msk(&["run", "activations.msk", "--policy", "agent activations"]).succeeded();
    project.msk(&["collect", "activations.msk", "--policy", "cmc", "--episodes", "1", "--out", "data-activations"]).succeeded();
    project
        .msk(&[&clone[..], &["--data", "data-activations"]].concat())
        .failed(1, &["acts on muscles, and does not say to which activations"]);
    let start = ["train", "lean.msk", "--steps", "2000", "--out", "started", "--start", "recorded-lean.msk"];
    project.msk(&start).succeeded();
    assert!(project.read("started/training.toml").contains("hidden = [32]"));
    let refused = |more: &[&str], expected: &str| {
        project.msk(&[&["train", "lean.msk", "--steps", "100"], more].concat()).failed(1, &[expected]);
    };
    refused(&["--algorithm", "clone"], "there is nothing to imitate");
    refused(&["--data", "data-lean.msk"], "the algorithm `ppo` learns from what it plays itself");
    // Learners that remember learn from recorded rewards as well, of the task as it is.
    project.write(
        "sac.toml",
        "algorithm = \"sac\"\nhidden = [16]\nevaluation_episodes = 2\n[sac]\nstart = 100\nbatch = 32\nupdates = 0.05\n",
    );
    let beside = ["--settings", "sac.toml", "--steps", "1500", "--data", "data-lean.msk"];
    project.msk(&[&["train", "lean.msk", "--out", "beside"], &beside[..]].concat()).succeeded();
    assert!(
        project.read("beside/training.toml").contains("\"data data-lean.msk (")
            && project.read("beside/curve.jsonl").contains("\"critics\"")
    );
    project.write("changed.msk", &project.read("lean.msk").replace("10    pose", "11    pose"));
    project
        .msk(&[&["train", "changed.msk"], &beside[..]].concat())
        .failed(1, &["has the rewards of another task than `lean`, or of what it was"]);
    refused(&["--algorithm", "clone", "--data", "nowhere"], "`nowhere` holds no data set");
    refused(&["--algorithm", "clone", "--data", "data-synergies.msk", "--start", "nowhere"], "cannot open the folder `nowhere`");
    project
        .write("data-lean.msk/data.json", &project.read("data-lean.msk/data.json").replacen("pelvis.height", "pelvis.width", 1));
    refused(&["--algorithm", "clone", "--data", "data-lean.msk"], "observes other channels than the task `lean`");
}
