//! Agents as folders: what they say of themselves, on what they act, and what is refused.

use super::{STOP, Silent, action, engine, open, session_settings, small, training};
use msk_runtime::episode::{Engine, Environment, EpisodeKey};
use msk_runtime::policy::PolicySource;
use msk_train::{Agent, Agents, Algorithm, source};
use std::fs;
use std::sync::atomic::AtomicBool;
use tempfile::tempdir;

#[test]
fn agents_are_folders_that_say_what_they_fit() {
    let engine_here = engine(&[]);
    let folder = tempdir().unwrap();
    open(folder.path(), &engine_here, &session_settings(Algorithm::Sac)).run(&STOP, &mut Silent).unwrap();
    let agent = Agent::read(folder.path()).unwrap();
    assert_eq!(agent, Agent::read(&folder.path().join("best-by-success")).unwrap());
    assert_eq!((agent.description.task.as_str(), agent.description.algorithm.as_str()), ("hold", "sac"));
    // What was evaluated is what is read.
    let evaluation = agent.description.evaluation.unwrap();
    let mut training = training(&engine_here, &session_settings(Algorithm::Sac), 1);
    assert_eq!(training.evaluate(&agent, &STOP).unwrap(), Some(evaluation));

    let shown = folder.path().display();
    let reset = |text: &str, engine: &Engine| {
        let source = source(text).unwrap().unwrap();
        let stop = AtomicBool::new(false);
        let mut policy = source.open(&stop).unwrap();
        let environment = msk_runtime::episode::Environment::of(engine.clone());
        policy.reset(&environment.context()).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert_eq!(reset(&format!("agent {shown}"), &engine_here), "");
    let other = engine(&[("0.5 rad)^2", "0.4 rad)^2")]);
    let message = reset(&format!("agent {shown}"), &other);
    assert!(message.contains("the task `hold` has changed since it was trained; `agent --any-task FOLDER`"), "{message}");
    assert_eq!(reset(&format!("agent --any-task {shown}"), &other), "");
    let seen = engine(&[("        swing.q\n        swing.qd", "        swing.qd\n        swing.q")]);
    let message = reset(&format!("agent --any-task {shown}"), &seen);
    assert!(message.contains("channel 1 is `swing.qd` (1), expected `swing.q` (1)"), "{message}");
}

#[test]
fn of_several_agents_the_best_that_was_trained_on_the_task_acts() {
    let here = engine(&[]);
    let folder = tempdir().unwrap();
    assert!(Agents::read(folder.path()).unwrap_err().to_string().contains("holds no folder of an agent"));
    // Two trainings, of which one succeeded more, one of another task, and a folder that is none of these.
    let session = |name: &str, engine: &Engine, success: f64| {
        let path = folder.path().join(name);
        open(&path, engine, &session_settings(Algorithm::Ppo)).run(&STOP, &mut Silent).unwrap();
        let mut agent = Agent::read(&path).unwrap();
        let evaluation = agent.description.evaluation.as_mut().unwrap();
        evaluation.success = success;
        agent.save(&path).unwrap();
    };
    session("a", &here, 0.25);
    session("b", &here, 0.75);
    let other = engine(&[("task hold", "task lift"), ("0.5 rad)^2", "0.4 rad)^2")]);
    session("c", &other, 1.0);
    fs::create_dir(folder.path().join("results")).unwrap();
    let agents = Agents::read(folder.path()).unwrap();
    let success = |engine: &Engine| agents.best(engine).map(|agent| agent.description.evaluation.unwrap().success);
    assert_eq!((success(&here), success(&other)), (Ok(0.75), Ok(1.0)));
    let changed = engine(&[("0.5 rad)^2", "0.3 rad)^2")]);
    assert_eq!(success(&changed), Err("the task `hold` has changed since it was trained".into()));
    let unknown = engine(&[("task hold", "task swing_up")]);
    assert_eq!(success(&unknown), Err("no agent was trained on `swing_up`, only on `hold`, `lift`".into()));
    let source = source(&format!("agents {}", folder.path().display())).unwrap().unwrap();
    assert!(source.name().ends_with(&format!("({})", agents.digest())), "{}", source.name());
}

#[test]
fn an_agent_in_half_precision_is_small_and_acts_almost_as_before() {
    let here = engine(&[]);
    let agent = training(&here, &small(Algorithm::Ppo), 1).agent();
    let folder = tempdir().unwrap();
    let saved = |name: &str, agent: &Agent| {
        let path = folder.path().join(name);
        agent.save(&path).unwrap();
        (Agent::read(&path).unwrap(), fs::metadata(path.join("policy.safetensors")).unwrap().len())
    };
    let (single, size) = saved("single", &agent);
    let (half, smaller) = saved("half", &agent.in_half_precision().unwrap());
    assert_eq!(single, agent);
    assert_eq!(half, agent.in_half_precision().unwrap());
    let weights = 16 * 2 + 16 + 16 * 16 + 16 + 16 + 1;
    // Headers are of different lengths, and padded.
    assert!((size - smaller).abs_diff(2 * weights) <= 16, "{size} {smaller}");
    assert_ne!(half.digest(), single.digest());
    let (exact, rounded) = (action(&single), action(&half));
    assert!(rounded != exact && (rounded - exact).abs() < 1e-3, "{rounded} {exact}");
    // The policy `network` reads it, too.
    let network = PolicySource::parse(&format!("network {}", folder.path().join("half/policy.safetensors").display())).unwrap();
    let mut policy = network.open(&STOP).unwrap();
    let mut environment = Environment::of(here);
    environment.reset(EpisodeKey { seed: 1, episode: 0 });
    policy.reset(&environment.context()).unwrap();
    let mut action = [0.0];
    policy.act(&environment.context(), &mut action).unwrap();
    assert!(action[0].is_finite());
}

#[test]
fn what_is_no_agent_is_refused() {
    let message = |text: &str| source(text).unwrap().err().unwrap().to_string();
    assert!(message("agent").contains("`agent` needs a folder: write `agent results/walk`"), "{}", message("agent"));
    assert!(message("agent nowhere").starts_with("cannot read `nowhere`"), "{}", message("agent nowhere"));
    let folder = tempdir().unwrap();
    let path = folder.path().display().to_string();
    assert!(message(&format!("agent {path}")).contains("holds no `agent.toml`"));
    fs::write(folder.path().join("agent.toml"), "task = 3").unwrap();
    assert!(message(&format!("agent {path}")).contains("describes no agent"));
    assert!(source("cmc").is_none());

    // Descriptions that do not belong to their network.
    let agent = training(&engine(&[]), &small(Algorithm::Ppo), 1).agent();
    let changed = |from: &str, to: &str| {
        agent.save(folder.path()).unwrap();
        let file = folder.path().join("agent.toml");
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(&file, text.replace(from, to)).unwrap();
        message(&format!("agent {path}"))
    };
    assert!(
        changed("[16, 16]", "[1048576, 1048576]").contains("and `agent.toml` describes a network of 1099"),
        "room for a terabyte"
    );
    assert!(changed("clip = 10.0", "clip = nan").contains("bounds observations by NaN"));
    assert!(changed("clip = 10.0", "clip = 0.0").contains("bounds observations by 0"));
    assert!(changed("action_repeat = 1", "action_repeat = 0").contains("repeats an action for 0 control steps"));
    let measured = |numbers: &str| changed("[network]", &format!("[evaluation]\nepisodes = 5\n{numbers}\n\n[network]"));
    let beyond = measured("success = 1e307\nreturn = 1.0\nsteps = 1.0");
    assert!(beyond.contains("describes an evaluation whose success is 1e307: expected a number from 0 to 1"), "{beyond}");
    let infinite = measured("success = 1.0\nreturn = -inf\nsteps = 1.0");
    assert!(infinite.contains("describes an evaluation of return -inf in 1 steps: expected finite numbers"), "{infinite}");
    let largest = i64::MAX;
    let sizes = changed("inputs = ", &format!("inputs = {largest} #"));
    assert!(sizes.contains(&format!("describes a network of {largest} inputs")), "{sizes}");
    assert!(changed("size = ", &format!("size = {largest} #")).contains("observed numbers"), "sums of sizes stay sums");
}
