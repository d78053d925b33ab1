//! Episodes in a batch: each comes to the bits that it comes to alone.

use msk_physics::lanes::WIDTH;
use msk_physics::model::{Integrator, JointKind, Model};
use msk_physics::{
    Batch, BatchError, Fault, Input, Instructions, LaneGroup, Parts, Plan, Rates, State, Workspace, forward, step,
};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// SplitMix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 2f64.powi(-53)
    }
}

fn repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn human() -> &'static Arc<Model> {
    static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
    MODEL.get_or_init(|| Arc::new(Model::from_file(repository("bodies/models/human416.xml")).unwrap()))
}

/// Gives an episode a body of its own: other strengths, masses and frictions.
fn vary(state: &mut State<f64>, random: &mut Random) {
    state.strength.fill_with(|| 0.5 + random.unit());
    state.mass_scale.fill_with(|| 0.5 + random.unit());
    state.friction.fill_with(|| 2.0 * random.unit());
}

/// Controls of a step of an episode, new ones every ten steps.
fn controls(episode: usize, number: usize, into: &mut [f64]) {
    let mut random = Random((episode as u64) << 32 | (number as u64 / 10));
    into.fill_with(|| random.unit());
}

/// Everything of a state, as bits; a NaN is what it is.
fn bits(state: &State<f64>) -> Vec<u64> {
    let lists = [
        core::slice::from_ref(&state.time),
        &state.position,
        &state.velocity,
        &state.activation,
        &state.fibre_length,
        &state.fibre_velocity,
        core::slice::from_ref(&state.fibre_step),
        &state.warm_start,
    ];
    lists.concat().iter().map(|value| value.to_bits()).collect()
}

/// How an episode ends that is stepped alone: its state, and the fault that stopped it.
fn alone(model: &Model, episode: usize, start: &State<f64>, steps: usize) -> (Vec<u64>, Option<Fault>) {
    let (mut state, mut workspace) = (start.clone(), Workspace::new(model));
    for number in 0..steps {
        controls(episode, number, &mut state.control);
        if let Err(fault) = step(model, &mut state, &mut workspace) {
            return (bits(&state), Some(fault));
        }
    }
    (bits(&state), None)
}

/// The same for episodes in a batch, in the order of the list.
fn together(mut batch: Batch, model: &Model, episodes: &[(usize, &State<f64>)], steps: usize) -> Vec<(Vec<u64>, Option<Fault>)> {
    let mut control = vec![0.0; model.actuators.name.len()];
    for (place, (_, start)) in episodes.iter().enumerate() {
        batch.set(place, start).unwrap();
    }
    for number in 0..steps {
        for (place, (episode, _)) in episodes.iter().enumerate() {
            controls(*episode, number, &mut control);
            batch.set_control(place, &control).unwrap();
        }
        batch.step();
    }
    let mut state = State::new(model);
    let mut end = |place: usize| {
        batch.get(place, &mut state).unwrap();
        assert_eq!(batch.time(place), Some(state.time));
        (bits(&state), batch.fault(place).cloned())
    };
    (0..episodes.len()).map(&mut end).collect()
}

/// The same for episodes that are lent to one set of lanes, eight at a time, for ten steps; a fault of the forward pass of the last
/// state is found, too.
fn lent(group: &mut LaneGroup, model: &Model, starts: &[State<f64>], steps: usize) -> Vec<(Vec<u64>, Option<Fault>)> {
    let mut workspaces = vec![Workspace::new(model); WIDTH];
    let mut begin = |start: &State<f64>| {
        let mut state = start.clone();
        controls(0, 0, &mut state.control);
        let fault = forward(model, &state, &mut workspaces[0]).err();
        let rates = Rates::of(model, &state, &mut workspaces[0]);
        (state, rates, fault)
    };
    let mut episodes: Vec<(State<f64>, Rates, Option<Fault>)> = starts.iter().map(&mut begin).collect();
    for number in (0..steps).step_by(10) {
        for (first, episodes) in episodes.chunks_mut(WIDTH).enumerate() {
            for (lane, (state, ..)) in episodes.iter_mut().enumerate() {
                controls(first * WIDTH + lane, number, &mut state.control);
            }
            let mut loaded = [None; WIDTH];
            for (place, (state, rates, fault)) in loaded.iter_mut().zip(&*episodes) {
                *place = fault.is_none().then_some((state, rates));
            }
            group.load(&loaded);
            if model.actuators.act_by_activation() {
                group.excite()
            } else {
                group.forward()
            }
            for _ in number..steps.min(number + 10) {
                group.integrate();
                group.forward();
            }
            let mut states: [Option<&mut State<f64>>; WIDTH] = Default::default();
            let mut passes: [Option<(&mut Workspace<f64>, &mut Rates)>; WIDTH] = Default::default();
            for (lane, ((state, rates, fault), workspace)) in episodes.iter_mut().zip(&mut workspaces).enumerate() {
                if fault.is_none() {
                    states[lane] = Some(state);
                    *fault = group.take_fault(lane);
                    passes[lane] = fault.is_none().then_some((workspace, rates));
                }
            }
            group.store_states(states);
            group.store_passes(passes, Parts::ALL);
        }
    }
    episodes.into_iter().map(|(state, _, fault)| (bits(&state), fault)).collect()
}

/// Whether episodes that are lent to lanes, and their forward passes at the end, are those of episodes alone.
fn check_lent(name: &str, model: &Arc<Model>, starts: &[State<f64>], steps: usize) {
    let mut group = LaneGroup::of(model, &Plan::new(model));
    let found = lent(&mut group, model, starts, steps);
    for (episode, (start, found)) in starts.iter().zip(found).enumerate() {
        let (mut state, mut workspace, mut fault) = (start.clone(), Workspace::new(model), None);
        for number in 0..steps {
            controls(episode, number, &mut state.control);
            fault = step(model, &mut state, &mut workspace).err();
            if fault.is_some() {
                break;
            }
        }
        let fault = fault.or_else(|| forward(model, &state, &mut workspace).err());
        assert_eq!(found.1, fault, "{name}: {episode}");
        assert!(found.0 == bits(&state), "{name}: {episode} lent to lanes");
    }
}

/// Whether every episode ends alike in batches of any size, order, instructions and number of workers.
fn check(name: &str, model: &Arc<Model>, starts: &[State<f64>], steps: usize) {
    check_lent(name, model, starts, steps);
    let expected: Vec<_> = starts.iter().enumerate().map(|(episode, start)| alone(model, episode, start, steps)).collect();
    let all: Vec<usize> = (0..starts.len()).collect();
    let backwards: Vec<usize> = all.iter().rev().copied().collect();
    let orders: [(&[usize], Instructions, usize); 6] = [
        (&all[..1], Instructions::Widest, 1),
        (&all[1..5], Instructions::Wide, 1),
        (&all[..8], Instructions::Baseline, 1),
        (&backwards, Instructions::Wide, 1),
        (&backwards, Instructions::Widest, 2),
        (&[3, 3, 9, 3], Instructions::Widest, 1),
    ];
    for (order, instructions, workers) in orders {
        let batch = Batch::new(model, order.len()).with_instructions(instructions).with_workers(workers);
        let episodes: Vec<_> = order.iter().map(|&episode| (episode, &starts[episode])).collect();
        for (place, (end, episode)) in together(batch, model, &episodes, steps).into_iter().zip(order).enumerate() {
            let (state, fault) = &expected[*episode];
            assert_eq!(end.1, *fault, "{name}: {episode} at {place} of {order:?}");
            let differs = end.0.iter().zip(state).position(|(found, expected)| found != expected);
            assert_eq!(differs, None, "{name}: {episode} at {place} of {order:?}, {instructions:?}, {workers} workers");
        }
    }
}

#[test]
fn a_body_with_contacts_has_the_same_bits_among_any_neighbours() {
    let model = human();
    // A fall to the ground, cut into ten initial states: in the air, on the feet, lying with limbs on the trunk.
    let (mut state, mut workspace) = (State::new(model), Workspace::new(model));
    let (mut starts, mut ground, mut limbs) = (Vec::new(), 0, 0);
    for number in 0..1000 {
        if number % 100 == 0 {
            starts.push(state.clone());
        }
        controls(77, number, &mut state.control);
        step(model, &mut state, &mut workspace).unwrap();
        for contact in &workspace.lanes[0].constraints.contacts {
            let rests = contact.geoms.iter().any(|&geom| model.geoms.body[geom] == 0);
            *if rests { &mut ground } else { &mut limbs } += 1;
        }
    }
    assert!(ground > 1000 && limbs > 100, "{ground} contacts with the ground, {limbs} between limbs");
    let mut random = Random(7);
    starts.iter_mut().skip(1).step_by(2).for_each(|start| vary(start, &mut random));
    check("human", model, &starts, 60);
}

/// Initial states at random, some of them far beyond limits.
fn initial_states(model: &Model) -> Vec<State<f64>> {
    let mut random = Random(5);
    let initial_state = |episode: usize| {
        let mut state = State::new(model);
        for joint in 0..model.joints.kind.len() {
            let address = model.joints.position_address[joint];
            if matches!(model.joints.kind[joint], JointKind::Hinge | JointKind::Slide) {
                state.position[address] += 0.1 * episode as f64 * (random.unit() - 0.5);
            }
        }
        state.velocity.fill_with(|| episode as f64 * (random.unit() - 0.5));
        if episode % 3 == 1 {
            vary(&mut state, &mut random);
        }
        if episode == 4 {
            state.body_force.iter_mut().for_each(|[force, _]| force.x = 0.5);
        }
        state
    };
    (0..10).map(initial_state).collect()
}

#[test]
fn models_of_every_constraint_and_integrator_have_the_same_bits_among_any_neighbours() {
    let mut tried = 0;
    for folder in ["models", "models/actuation", "contact_models", "row_models"] {
        let mut files: Vec<_> =
            std::fs::read_dir(repository("tests/oracle").join(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        for file in files.into_iter().filter(|file| file.extension().is_some_and(|end| end == "xml")) {
            let mut model = Model::from_file(&file).unwrap();
            for integrator in [Integrator::Euler, Integrator::Implicit, Integrator::RungeKutta] {
                model.options.integrator = integrator;
                check(&format!("{}, {integrator:?}", file.display()), &Arc::new(model.clone()), &initial_states(&model), 25);
                tried += 1;
            }
        }
    }
    assert!(tried > 40, "{tried} models only");
}

#[test]
fn passes_without_steps_have_the_same_bits_and_a_fault_is_that_of_its_episode() {
    let model = human();
    let mut states = initial_states(model);
    states.truncate(WIDTH);
    states[3].velocity[2] = f64::INFINITY;
    let plan = Plan::new(model);
    let mut workspaces: Vec<Workspace<f64>> = states.iter().map(|_| Workspace::of(model, &plan)).collect();
    let mut group = LaneGroup::of(model, &plan);
    // On the ground, one lower than the other.
    for (depth, state) in states.iter_mut().skip(5).enumerate() {
        state.position[2] -= 0.02 * (depth + 1) as f64;
    }
    let mut touching = 0;
    // What the lanes held before does not matter, nor does one that holds nothing.
    for empty in [0, 5] {
        let mut pairs = states.iter().zip(&mut workspaces);
        let faults = group.pass(core::array::from_fn(|lane| pairs.next().filter(|_| lane != empty)));
        for (lane, fault) in faults.iter().enumerate().filter(|(lane, _)| *lane != empty) {
            let mut alone = Workspace::of(model, &plan);
            assert_eq!(forward(model, &states[lane], &mut alone).err(), *fault, "lane {lane}");
            if fault.is_none() {
                let together = &workspaces[lane];
                assert!(alone.acceleration == together.acceleration && alone.constraint_force == together.constraint_force);
                assert_eq!(alone.actuation.force, together.actuation.force, "lane {lane}");
                // Rows that the lanes have made together are those that an episode makes alone, with their forces.
                let rows = |workspace: &Workspace<f64>| workspace.lanes[0].constraints.rows.clone();
                assert!(!rows(&alone).is_empty() && rows(&alone) == rows(together), "lane {lane}");
                let pushes = |workspace: &Workspace<f64>| -> Vec<[f64; 6]> {
                    workspace.lanes[0].constraints.contacts.iter().map(|contact| contact.force).collect()
                };
                assert_eq!(pushes(&alone), pushes(together), "lane {lane}");
                touching += usize::from(pushes(together).iter().any(|push| push[0] > 0.0));
            }
        }
    }
    assert!(touching > 2, "{touching} touch the ground");
}

#[test]
fn a_fault_stops_its_episode_alone_until_it_is_set_again() {
    let model = human();
    let start = State::new(model);
    let mut batch = Batch::new(model, 3);
    (0..3).for_each(|episode| batch.set(episode, &start).unwrap());
    let mut control = vec![0.5; 416];
    for _ in 0..3 {
        batch.step();
    }
    control[7] = f64::NAN;
    batch.set_control(1, &control).unwrap();
    for _ in 0..3 {
        batch.step();
    }
    assert!(matches!(batch.fault(1), Some(Fault::Input { input: Input::Excitation, .. })), "{:?}", batch.fault(1));
    assert_eq!(
        [0, 1, 2, 3].map(|episode| batch.time(episode).map(|time| (time * 1000.0).round())),
        [Some(6.0), Some(3.0), Some(6.0), None]
    );
    assert!(batch.fault(0).is_none() && batch.fault(2).is_none());
    batch.set(1, &start).unwrap();
    batch.step();
    assert!(batch.fault(1).is_none());
    let (mut first, mut second) = (State::new(model), State::new(model));
    batch.get(1, &mut first).unwrap();
    step(model, &mut second, &mut Workspace::new(model)).unwrap();
    assert_eq!(bits(&first), bits(&second));
}

#[test]
fn what_does_not_fit_is_refused() {
    let model = human();
    let mut batch = Batch::new(model, 9);
    assert_eq!(batch.len(), 9);
    let start = State::new(model);
    assert_eq!(batch.set(9, &start), Err(BatchError::Index { index: 9, count: 9 }));
    assert_eq!(batch.set_control(0, &[0.0; 3]), Err(BatchError::Shape { what: "list of controls" }));
    let mut short = start.clone();
    short.velocity.pop();
    assert_eq!(batch.set(0, &short), Err(BatchError::Shape { what: "state" }));
    assert_eq!(batch.get(0, &mut short), Err(BatchError::Shape { what: "state" }));
    let mut none = Batch::new(model, 0).with_workers(4);
    none.step();
    assert!(none.is_empty() && none.time(0).is_none());
}
