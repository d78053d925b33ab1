//! A step asks for no memory: neither a step of the physics, whatever takes part in it, nor a control step of a task.
//!
//! Lists of contacts and rows grow until they have been as long as they get. So each test takes its steps, goes back to the
//! beginning, and counts while the very same steps are taken again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use allocation_counter::measure;
use msk::compiler::compile;
use msk::physics::model::{ElasticTendons, Integrator, Model};
use msk::physics::{Plan, State, Workspace, step};
use msk::runtime::{
    bodies,
    episode::{Environment, Episode, EpisodeKey},
    library::{BodyLibrary, FileLoader},
};
use std::path::Path;
use support::{SplitMix, repository};

/// Takes `steps` steps under random controls, twice, and counts what the second time asks for.
fn asked(model: &Model, steps: usize) -> u64 {
    let start = State::<f64>::new(model);
    let mut state = start.clone();
    let mut workspace = Workspace::new(model);
    let mut contacts = 0;
    let mut run = |state: &mut State<f64>| {
        let mut random = SplitMix(1);
        for number in 0..steps {
            if number % 10 == 0 {
                state.control.fill_with(|| random.unit());
            }
            step(model, state, &mut workspace).unwrap();
            contacts = contacts.max(workspace.lanes[0].constraints.contacts.len());
        }
    };
    run(&mut state);
    state.copy_from(&start);
    let asked = measure(|| run(&mut state)).count_total;
    println!("{steps} steps, {contacts} contacts at most, {asked} requests for memory");
    asked
}

fn human() -> Model {
    bodies::model(&Path::new(bodies::ROOT).join("bodies/models/human416.xml")).unwrap()
}

#[test]
fn memory_that_is_asked_for_is_counted() {
    assert_eq!(measure(|| drop(std::hint::black_box(vec![1.0; 8]))).count_total, 1);
}

#[test]
fn a_step_of_the_body_asks_for_no_memory() {
    assert_eq!(asked(&human(), 400), 0);
}

/// What follows from the model is held once, however many workers there are.
#[test]
fn scratch_of_a_shared_plan_leaves_the_plan_out_and_gives_the_same_bits() {
    let model = human().with_elastic_tendons(ElasticTendons::default()).unwrap();
    let plan = Plan::new(&model);
    let shared = measure(|| drop(Workspace::<f64>::of(&model, &plan))).bytes_total;
    let own = measure(|| drop(Workspace::<f64>::new(&model))).bytes_total;
    assert!(own > shared + (100 << 10), "{own} bytes with a plan, {shared} without");
    let run = |mut workspace: Workspace<f64>| {
        let mut state = State::<f64>::new(&model);
        state.control.fill(0.3);
        (0..20).for_each(|_| step(&model, &mut state, &mut workspace).unwrap());
        state
    };
    assert_eq!(run(Workspace::of(&model, &plan)), run(Workspace::new(&model)));
}

#[test]
fn a_step_with_elastic_tendons_asks_for_no_memory() {
    assert_eq!(asked(&human().with_elastic_tendons(ElasticTendons::default()).unwrap(), 200), 0);
}

/// All kinds of shapes, constraints, actuators and integrators that the models of the comparisons with MuJoCo have.
#[test]
fn a_step_of_no_model_asks_for_memory() {
    let mut tried = 0;
    let mut found = Vec::new();
    for folder in ["models", "models/actuation", "models/mjcf", "contact_models", "row_models"] {
        let mut files: Vec<_> =
            std::fs::read_dir(repository("tests/oracle").join(folder)).unwrap().map(|f| f.unwrap().path()).collect();
        files.sort();
        for file in files.into_iter().filter(|file| file.extension().is_some_and(|end| end == "xml")) {
            let mut model = Model::from_file(&file).unwrap();
            for integrator in [Integrator::Euler, Integrator::Implicit, Integrator::RungeKutta] {
                model.options.integrator = integrator;
                let asked = asked(&model, 100);
                if asked > 0 {
                    found.push((file.clone(), integrator, asked));
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 100, "{tried} models only");
    assert!(found.is_empty(), "{found:#?}");
}

/// What an episode may take beside those that are already there.
const MOST_BYTES: usize = 64 << 10;

/// Sensors, observation, reward, ends and success of every task, with their scenes, and the physics between.
#[test]
fn a_control_step_of_no_task_asks_for_memory() {
    let bodies = BodyLibrary::default();
    let mut found = Vec::new();
    for task in compile(&repository("tasks.msk"), &FileLoader, &bodies).unwrap().tasks {
        let staged = bodies.stage(&task.body, &task.scene).unwrap();
        let mut episode = Environment::new(staged.model, staged.body, task).unwrap();
        episode.reset(EpisodeKey { seed: 1, episode: 0 });
        let start = episode.snapshot();
        // One episode more costs its data and no scratch.
        let bytes = measure(|| drop(episode.snapshot())).bytes_total as usize + size_of::<Episode>();
        println!("{}: {bytes} bytes", episode.task().name);
        assert!(bytes < MOST_BYTES, "an episode of {} takes {bytes} bytes", episode.task().name);
        let action = vec![-0.9; episode.context().body.muscles.len()];
        let mut steps = 0;
        while steps < 10 && episode.ending().is_none() {
            episode.step(&action).unwrap();
            steps += 1;
        }
        episode.restore(&start);
        // The report is new after a reset, and the step that ends an episode lists the reasons.
        episode.step(&action).unwrap();
        let count = || (1..steps - 1).for_each(|_| assert!(episode.step(&action).is_ok()));
        let asked = measure(count).count_total;
        assert!(steps > 4, "{} ends after {steps} steps", episode.task().name);
        println!("{}: {asked} requests", episode.task().name);
        if asked > 0 {
            found.push((episode.task().name.clone(), asked));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn two_hundred_control_steps_of_standing_ask_for_no_memory() {
    let bodies = BodyLibrary::default();
    let task = compile(&repository("tasks.msk"), &FileLoader, &bodies).unwrap().tasks[0].clone();
    let staged = bodies.stage(&task.body, &task.scene).unwrap();
    let (mut state, mut report) = Default::default();
    let episode = Environment::new(staged.model, staged.body, task.clone()).unwrap();
    let (frame, weights) = (episode.frame().to_vec(), task.weights());
    let mut observation = vec![0.0; task.observation_size()];
    task.reset(&frame, &mut msk::compiler::Middle, &mut state).unwrap();
    let mut run = || {
        for _ in 0..200 {
            task.step(&frame, &weights, &mut msk::compiler::Middle, &mut state, &mut report).unwrap();
            task.observe(&frame, &state, &mut observation);
        }
    };
    run();
    assert_eq!(measure(run).count_total, 0);
}
