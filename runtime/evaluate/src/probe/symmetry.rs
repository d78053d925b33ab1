//! The rewards of a task declared symmetric for states and for their mirror images.

use super::at;
use super::mirror::Mirror;
use super::poses::Room;
use super::search::Shown;
use msk_compiler::diagnostics::Diagnostic;
use msk_compiler::diagnostics::codes::probing;
use msk_compiler::survey::{About, Survey};
use msk_physics::State;
use msk_physics::scalar::Real;
use msk_program::numbers::{beside, for_people};
use msk_program::task::{CompiledTask, StepReport};
use msk_runtime::episode::{Environment, EpisodeKey, Stream};

/// How many states are mirrored.
const STATES: usize = 24;
/// The body's two sides differ a little: rewards that differ by less than this part of the largest are equal.
const SAME: f64 = 0.05;
/// So many states must tell: one may stand on the edge of a contact.
const WITNESSES: usize = 2;
/// Feet are pressed so far into the ground, so that no contact is a matter of rounding, m.
const PRESSED: f64 = 3e-3;
/// Speeds of joints (rad/s) and of the root (m/s, rad/s).
const SPEED: f64 = 0.5;

/// Compares states with their mirror images; a sequence and a scene with two unlike sides are left alone.
pub(super) fn probe(task: &CompiledTask, room: &mut Room<'_>, shown: &[Shown], episode: &Environment) -> Vec<Diagnostic> {
    let (true, 1, Some(survey)) = (task.symmetric, Survey::phases(task), Survey::new(task, 0)) else { return Vec::new() };
    let Some(mirror) = Mirror::new(room.model, room.body, &room.begins) else { return Vec::new() };
    let mut episode = episode.clone();
    let mut chance = Stream::new(EpisodeKey::default(), "probe/mirror");
    let mut pairs: Vec<[StepReport; 2]> = Vec::new();
    for shown in shown.iter().take(STATES) {
        room.show(&shown.pose);
        let state = moving(room, &mut chance);
        let image = mirror.image(room.model, room.body, &state);
        if let (Some(here), Some(there)) = (looked(&mut episode, &state), looked(&mut episode, &image)) {
            pairs.push([here, there]);
        }
    }
    let mut diagnostics = Vec::new();
    for subject in survey.subjects().iter().filter(|subject| !subject.reads_more) {
        let value = |report: &StepReport| -> Option<f64> {
            let truth = |holds: &bool| f64::from(u8::from(*holds));
            match subject.about {
                About::Term(index) => report.terms.get(index).copied(),
                About::Termination(index) => report.terminations.get(index).map(truth),
                About::Finish(index) => report.finishes.get(index).map(truth),
                About::Success | About::Comparison => None,
            }
        };
        let values: Vec<[f64; 2]> = pairs.iter().filter_map(|[here, there]| Some([value(here)?, value(there)?])).collect();
        let largest = values.iter().flatten().fold(0.0_f64, |most, value| most.at_least(value.abs()));
        let unlike: Vec<&[f64; 2]> = values.iter().filter(|[a, b]| (a - b).abs() > SAME * largest).collect();
        let most = unlike.iter().max_by(|[a, b], [c, d]| (a - b).abs().total_cmp(&(c - d).abs()));
        let Some([here, there]) = most.filter(|_| unlike.len() >= WITNESSES) else { continue };
        let (name, message) = match subject.about {
            About::Term(index) => (
                &task.terms[index].name,
                format!("is {} in a state and {} in its mirror image", beside(*here, &[*there]), beside(*there, &[*here])),
            ),
            About::Termination(index) => (&task.terminations[index], "holds in a state and not in its mirror image".to_owned()),
            About::Finish(index) => (&task.finishes[index], "holds in a state and not in its mirror image".to_owned()),
            About::Success | About::Comparison => continue,
        };
        let message = format!("the task is `symmetric`, but `{name}` {message}");
        let warning = at(probing::UNMIRRORED, subject.at, message)
            .found(format!("{} of {} states differ, by {} at most", unlike.len(), values.len(), for_people((here - there).abs())))
            .help("read both sides alike, or remove `symmetric`");
        diagnostics.push(warning);
    }
    diagnostics
}

/// The state that the room shows, pressed to the ground, moving, muscles at work.
fn moving(room: &Room<'_>, chance: &mut Stream) -> State<f64> {
    let mut state = room.state.clone();
    for joint in &room.body.joints {
        state.velocity[joint.dof] = if joint.independent { SPEED * chance.normal() } else { 0.0 };
    }
    room.body.solve_coupled_velocities(room.model, &state.position, &mut state.velocity);
    if let Some((root, dof)) = room.body.root.free {
        state.position[root + 2] -= PRESSED;
        state.velocity[dof..dof + 6].iter_mut().for_each(|speed| *speed = SPEED * chance.normal());
    }
    for (activation, control) in state.activation.iter_mut().zip(&mut state.control) {
        *activation = chance.uniform();
        *control = *activation;
    }
    state
}

/// The reward of a state; `None` if the physics or the task cannot.
fn looked(episode: &mut Environment, state: &State<f64>) -> Option<StepReport> {
    episode.reset_to(EpisodeKey::default(), &mut |present| present.copy_from(state));
    episode.ending().is_none().then(|| episode.report().clone())
}
