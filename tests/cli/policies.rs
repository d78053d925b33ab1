//! Policies from outside: programs that answer line by line, recorded actions, and several policies side by side.

use super::project::{Done, Project, journal};
use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Command;

/// A program for `sh` that is ready for every task and does `answer` with every observation.
fn agent(answer: &str) -> String {
    format!(
        r#"action() {{ awk -v n="$1" -v x="$2" 'BEGIN {{ printf "{{\"action\": ["; for (i = 0; i < n; i++) printf "%s%s", i ? "," : "", x; print "]}}" }}'; }}
while read -r line; do
    case "$line" in
        '{{"task"'*) echo '{{"ready": true}}' ;;
        *) {answer} ;;
    esac
done
"#
    )
}

fn project(program: &str) -> Project {
    let project = Project::lean();
    project.write("agent.sh", program);
    project
}

fn eval(project: &Project, more: &[&str]) -> Done {
    let arguments = ["eval", "lean.msk", "--policy", "process sh agent.sh", "--episodes", "2", "--seed", "5", "--out", "out"];
    project.msk(&[&arguments, more].concat())
}

#[test]
fn a_program_acts_like_the_built_in_policy_that_does_the_same() {
    let project = project(&agent("action 416 -1"));
    let done = eval(&project, &[]).succeeded();
    assert!(done.out.contains("Policy `process sh agent.sh`, 2 episodes per task, seed 5"), "{}", done.out);
    project.msk(&["eval", "lean.msk", "--policy", "zero", "--episodes", "2", "--seed", "5", "--out", "zero"]).succeeded();
    let returns = |folder: &str| -> BTreeMap<u64, f64> {
        let text = project.read(format!("{folder}/episodes.jsonl"));
        let records = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        records.map(|record| (record["episode"].as_u64().unwrap(), record["return"].as_f64().unwrap())).collect()
    };
    assert_eq!(returns("out").len(), 2);
    assert_eq!(returns("out"), returns("zero"));
}

/// A program for `sh` that is ready, and then gives `count` actions in MessagePack, of 416 numbers that `printf` makes.
fn packed(count: usize, number: &str) -> String {
    format!(
        r#"printf '\201\245ready\303'
for step in $(seq {count}); do
    printf '\201\246action\334\001\240'
    printf '%.0s{number}' $(seq 416)
done
cat > requests
"#
    )
}

#[test]
fn a_program_acts_in_message_pack_as_in_json() {
    let project = project(&packed(40, "\\377"));
    let run = |policy: &str, folder: &str| {
        let arguments =
            ["eval", "lean.msk", "--policy", policy, "--episodes", "2", "--seed", "5", "--threads", "1", "--out", folder];
        project.msk(&arguments)
    };
    let done = run("process --messagepack sh agent.sh", "out").succeeded();
    assert!(done.out.contains("Policy `process --messagepack sh agent.sh`"), "{}", done.out);
    run("zero", "zero").succeeded();
    let returns = |folder: &str| -> Vec<f64> {
        let text = project.read(format!("{folder}/episodes.jsonl"));
        text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["return"].as_f64().unwrap()).collect()
    };
    assert_eq!(returns("out"), returns("zero"));
    // Requests are maps with one key: "task", and then "act".
    let requests = std::fs::read(project.path("requests")).unwrap();
    assert!(requests.starts_with(b"\x81\xa4task"), "{:?}", &requests[..20]);
    assert!(requests.windows(5).filter(|window| *window == b"\x81\xa3act").count() >= 10);
    // The errors are those of JSON.
    let wrong = |program: String, reason: &str| {
        project.write("agent.sh", &program);
        let done = project.msk(&["run", "lean.msk", "--policy", "process --messagepack sh agent.sh"]);
        done.failed(1, &["policy `process --messagepack sh agent.sh` failed", reason]);
    };
    wrong(packed(3, "\\312\\177\\300\\000\\000"), "its action contains NaN, which is not a number");
    wrong("echo '{\"ready\": true}'; cat > requests".to_owned(), "its reply does not follow the protocol");
    wrong(
        "printf '\\201\\245ready\\303\\201\\246action\\221\\000'; cat > requests".to_owned(),
        "its action has 1 numbers, expected 416",
    );
    wrong("printf '\\201\\245ready\\303\\201\\246act'; exit 3".to_owned(), "it ended with code 3");
}

#[test]
fn a_program_knows_what_it_sees_and_moves() {
    let project = project(&format!("exec 3> requests\n{}", agent("action 416 0").replace("case", "echo \"$line\" >&3; case")));
    eval(&project, &["--threads", "1"]).succeeded();
    let requests: Vec<Value> = project.read("requests").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let task = &requests[0]["task"];
    assert_eq!((&task["name"], &task["protocol"], &task["horizon"]), (&"lean".into(), &1.into(), &20.into()));
    assert_eq!(task["control_period"], 0.01);
    assert_eq!(task["observation"][0]["unit"], "m");
    assert_eq!(task["action"].as_array().unwrap().len(), 416);
    let first = &requests[1]["act"];
    assert_eq!((&first["seed"], &first["episode"], &first["step"]), (&5.into(), &0.into(), &0.into()));
    assert_eq!(first["observation"].as_array().unwrap().len(), 1);
    // The task is not described again for the second episode.
    assert_eq!(requests.iter().filter(|request| request.get("task").is_some()).count(), 1);
    assert!(requests.iter().any(|request| request["act"]["episode"] == 1));
}

#[test]
fn a_task_that_a_program_refuses_is_skipped_with_its_reason() {
    let project = project("read -r line; echo '{\"error\": \"trained for another body\"}'; read -r line\n");
    let done = eval(&project, &["--threads", "1"]);
    assert!(done.out.contains("skipped: trained for another body"), "{}", done.out);
    done.failed(1, &["policy `process sh agent.sh` supports none of the tasks"]);
}

#[test]
fn a_program_that_breaks_down_is_reported_with_its_last_words() {
    let place = "policy `process sh agent.sh` failed: in `lean`, episode 0, step 0: ";
    let cases = [
        ("echo no weights >&2; exit 3", "it ended with code 3\n  its standard error ends with:\n    no weights"),
        ("kill -9 $$", "it was ended by a signal"),
        ("exec >&-; sleep 100", "it closed its standard output"),
        ("action 415 0", "its action has 415 numbers, expected 416"),
        ("action 416 NaN", "its action contains NaN, which is not a number"),
        ("echo loading", "its reply does not follow the protocol: `loading` ("),
        ("echo '{\"ready\": true}'", "its reply contains no `action`"),
        ("echo '{\"error\": \"out of memory\"}'", "it replies with the error `out of memory`"),
        ("sleep 100", "no reply within 0.3 s (`--policy-timeout` sets the limit)"),
    ];
    for (answer, message) in cases {
        let project = project(&agent(answer));
        eval(&project, &["--threads", "1", "--policy-timeout", "0.3"]).failed(1, &[&format!("{place}{message}")]);
    }
}

#[test]
fn a_program_that_cannot_be_used_is_refused_at_once() {
    let project = Project::lean();
    let run = |policy: &str| project.msk(&["run", "lean.msk", "--policy", policy]);
    run("process ./nothing").failed(1, &["policy `process ./nothing` failed", "`./nothing` cannot be started"]);
    run("process").failed(1, &["`process` needs a command: write `process python3 policy.py`"]);
    run("replay nothing.npy").failed(1, &["cannot read `nothing.npy`"]);
    run("pocess sh").failed(1, &["there is no policy `pocess sh`", "process COMMAND, network FILE, replay FILE"]);
    project.msk(&["run", "lean.msk", "--policy-timeout", "0"]).failed(2, &["is not a number from 0.001 to 3600"]);
}

#[test]
fn what_was_done_is_continued_when_the_program_works_again() {
    // It breaks down in the second episode.
    let project = project(&agent("case \"$line\" in *'\"episode\":1,'*) exit 4 ;; esac; action 416 -1"));
    eval(&project, &["--threads", "1"]).failed(1, &["in `lean`, episode 1, step 0: it ended with code 4"]);
    assert_eq!(project.read("out/episodes.jsonl").lines().count(), 1);
    project.write("agent.sh", &agent("action 416 -1"));
    let done = eval(&project, &["--threads", "1"]).succeeded();
    assert!(done.err.contains("resuming `out`: 1 of 2 episodes exist"), "{}", done.err);
    assert_eq!(project.read("out/episodes.jsonl").lines().count(), 2);
}

#[test]
fn recorded_actions_are_played_again_bit_for_bit() {
    let project = Project::lean();
    let episode = |more: &[&str]| -> Value {
        let done = project.msk(&[&["run", "lean.msk", "--seed", "5", "--json"], more].concat()).succeeded();
        serde_json::from_str(&done.out).unwrap()
    };
    let recorded = episode(&["--policy", "random", "--actions", "random.npy"]);
    let replayed = episode(&["--policy", "replay random.npy"]);
    assert_eq!(recorded["return"], replayed["return"]);
    assert_eq!(recorded["steps"], replayed["steps"]);
    assert!(replayed["policy"].as_str().unwrap().starts_with("replay random.npy ("), "{}", replayed["policy"]);
    // Zero falls later or earlier: where the actions end before the episode, that is reported.
    let longer = project.read("lean.msk").replace("terminate { sunk when pelvis.height < neutral(pelvis.height) - 2 cm }", "");
    project.write("longer.msk", &longer.replace("horizon  20 steps", "horizon  200 steps"));
    let done = project.msk(&["run", "longer.msk", "--policy", "replay random.npy"]);
    done.failed(1, &["`random.npy` contains only ", " actions, but the episode continues"]);
    project.write("text.npy", "text");
    project.msk(&["run", "lean.msk", "--policy", "replay text.npy"]).failed(1, &["`text.npy` is not a NumPy array"]);
}

/// A network with one layer that gives `value` for every muscle, whatever it sees.
fn constant_network(value: f32, inputs: usize, metadata: &str) -> Vec<u8> {
    let (weight, bias) = (4 * 416 * inputs, 4 * 416);
    let header = format!(
        r#"{{"__metadata__":{{{metadata}}},"0.weight":{{"dtype":"F32","shape":[416,{inputs}],"data_offsets":[0,{weight}]}},"0.bias":{{"dtype":"F32","shape":[416],"data_offsets":[{weight},{}]}}}}"#,
        weight + bias
    );
    let numbers = vec![0.0; 416 * inputs].into_iter().chain(vec![value; 416]);
    let length = (header.len() as u64).to_le_bytes();
    length.into_iter().chain(header.into_bytes()).chain(numbers.flat_map(f32::to_le_bytes)).collect()
}

#[test]
fn a_network_acts_on_the_task_that_it_was_trained_for() {
    let project = Project::lean();
    let write = |name: &str, bytes: Vec<u8>| std::fs::write(project.path(name), bytes).unwrap();
    let episode = |policy: &str| -> Value {
        let done = project.msk(&["run", "lean.msk", "--json", "--policy", policy]).succeeded();
        serde_json::from_str(&done.out).unwrap()
    };
    let channels = r#""observation":"[{\"name\": \"pelvis.height\", \"size\": 1}]""#;
    write("rest.safetensors", constant_network(-1.0, 1, channels));
    assert_eq!(episode("network rest.safetensors")["return"], episode("zero")["return"]);
    write("half.safetensors", constant_network(-0.5, 1, ""));
    assert_ne!(episode("network half.safetensors")["return"], episode("zero")["return"]);
    let refused = |name: &str, parts: &[&str]| {
        project.msk(&["run", "lean.msk", "--policy", &format!("network {name}")]).failed(1, parts);
    };
    let golden = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/networks");
    write("half.onnx", std::fs::read(golden.join("half.onnx")).unwrap());
    assert_eq!(episode("network half.onnx")["return"], episode("network half.safetensors")["return"]);
    write("actor.onnx", std::fs::read(golden.join("actor.onnx")).unwrap());
    refused("actor.onnx", &["`actor.onnx` takes 3 numbers, the observation has 1"]);
    write("other.safetensors", constant_network(-1.0, 1, &channels.replace("pelvis", "head")));
    refused(
        "other.safetensors",
        &["trained to see something else: channel 1 is `pelvis.height` (1), expected `head.height` (1)"],
    );
    write("wide.safetensors", constant_network(-1.0, 3, ""));
    refused("wide.safetensors", &["`wide.safetensors` takes 3 numbers, the observation has 1"]);
    write("cut.safetensors", constant_network(-1.0, 1, "")[..100].to_vec());
    refused("cut.safetensors", &["cannot read `cut.safetensors`: it is no safetensors file"]);
}

#[test]
fn a_residual_is_added_to_a_network_that_sees_its_channels_by_their_names() {
    let project = Project::lean();
    let channels = r#""observation":"[{\"name\": \"pelvis.height\", \"size\": 1}]""#;
    std::fs::write(project.path("half.safetensors"), constant_network(-0.5, 1, channels)).unwrap();
    let lean = project.read("lean.msk");
    // The network does not see what was added for the residual.
    let beside = lean.replace(
        "observe { pelvis.height }",
        "act muscles { residual \"half.safetensors\" }\n    observe { com.velocity; pelvis.height }",
    );
    assert_ne!(lean, beside);
    project.write("beside.msk", &beside);
    let reward = |arguments: &[&str]| -> Value {
        let done = project.msk(&[&["run", "--json"], arguments].concat()).succeeded();
        serde_json::from_str::<Value>(&done.out).unwrap()["return"].clone()
    };
    assert_eq!(reward(&["beside.msk", "--policy", "zero"]), reward(&["lean.msk", "--policy", "network half.safetensors"]));
    let hash = || project.msk(&["explain", "beside.msk"]).succeeded().out;
    assert!(hash().contains("half.safetensors"), "{}", hash());
    std::fs::remove_file(project.path("half.safetensors")).unwrap();
    project.msk(&["run", "beside.msk"]).failed(1, &["E0208", "cannot read the network \"half.safetensors\": there is no file"]);
    std::fs::write(project.path("half.safetensors"), constant_network(-0.5, 1, &channels.replace("pelvis", "head"))).unwrap();
    let done = project.msk(&["run", "beside.msk", "--policy", "zero"]).succeeded();
    let reason = "the network `half.safetensors` sees a channel `head.height`, which the task does not observe";
    assert!(done.out.contains(reason), "{}", done.out);
}

#[test]
fn several_policies_are_compared_in_one_table() {
    let project = Project::lean();
    let arguments = ["eval", "tasks.msk", "--policy", "zero", "--policy", "random", "--policy", "demonstration", "--out", "out"];
    let done = project.msk(&arguments);
    for part in ["(1) zero, 3 episodes per task, seed 5", "(2) random, 3 episodes", "task", "(1)", "return", "Results: out"] {
        assert!(done.out.contains(part), "no `{part}` in {}", done.out);
    }
    assert!(done.out.lines().all(|line| line.chars().count() <= 80), "{}", done.out);
    for folder in ["out/1-zero", "out/2-random"] {
        assert_eq!(journal(&project.read(format!("{folder}/episodes.jsonl"))).len(), 3);
    }
    // The task has no test, so there is nothing to demonstrate: that column is empty, and the exit code tells.
    let row = done.out.lines().find(|line| line.starts_with("lean")).unwrap();
    assert!(row.ends_with('-'), "{row}");
    done.failed(1, &["policy `demonstration` supports none of the tasks"]);
    project.msk(&["eval", "tasks.msk", "--policy", "zero", "--policy", "zero"]).failed(2, &["the policy `zero` is given twice"]);
}

#[test]
fn results_start_no_program() {
    let project = project(&agent("touch started; action 416 -1"));
    eval(&project, &[]).succeeded();
    std::fs::remove_file(project.path("started")).unwrap();
    let done = project.msk(&["run", "lean.msk", "--replay", "out", "--episode", "0"]);
    done.failed(1, &["there is no policy `process sh agent.sh`"]);
    assert!(!project.path("started").exists());
}

#[test]
fn the_example_in_python_acts() {
    if Command::new("python3").arg("--version").output().is_err() {
        eprintln!("not run: there is no python3 here");
        return;
    }
    let project = Project::lean();
    project.write("policy.py", include_str!("../../examples/policy.py"));
    let done = project.msk(&["run", "lean.msk", "--policy", "process python3 policy.py"]).succeeded();
    assert!(done.out.contains("lean, policy process python3 policy.py, seed 0, episode 0"), "{}", done.out);
}
