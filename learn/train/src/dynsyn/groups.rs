//! Which entries of an action belong together: those whose sensors, such as the lengths of muscles, change alike while the body is
//! shaken and nobody acts (section 4.1 of the paper).

use super::Synergies;
use super::medoids::{Distances, clusters};
use crate::sensors::Sensors;
use crate::settings::DynsynSettings;
use msk_runtime::episode::{Engine, Environment, EpisodeKey, Stream};

/// Control steps from one shake to the next, and shakes of a window.
const STEPS: usize = 10;
const SHAKES: usize = 10;
/// Searches for clusters, of which the best counts.
const TRIES: usize = 20;
/// Added to ranges of sensors, m or rad, and to products of norms: both may be 0.
const EPSILON: f64 = 1e-9;

/// What each sensor measured over the control steps of a window.
type Window = Vec<Vec<f64>>;

/// The groups of the action space of a task.
///
/// # Errors
/// A space whose entries move neither muscles nor joints, or a body that cannot be shaken, in words.
pub(crate) fn find(engine: &Engine, settings: &DynsynSettings, seed: u64) -> Result<Synergies, String> {
    let sensors = Sensors::of(engine)?;
    let mut shaker = Shaker::new(engine, settings.speed, seed);
    let windows = settings.rollout.div_ceil(STEPS * SHAKES);
    let mut windows: Vec<Window> = (0..windows as u64).filter_map(|window| shaker.window(window, &sensors)).collect();
    if windows.is_empty() {
        return Err(
            "the physics of its body fails wherever joints are set in motion, so nothing shows what moves together".into()
        );
    }
    scale(&mut windows);
    let distances = Distances::of(windows[0].len(), |one, other| 1.0 - similarity(&windows, one, other));
    let mut chance = Stream::new(EpisodeKey { seed, episode: 0 }, "train/groups");
    Ok(Synergies::new(&clusters(&distances, settings.groups, TRIES, &mut chance)))
}

/// Gives joints random speeds again and again, which the body then carries on by itself.
struct Shaker {
    environment: Environment,
    dofs: Vec<usize>,
    /// Largest speed, rad/s or m/s.
    speed: f64,
    rest: Vec<f64>,
    seed: u64,
    chance: Stream,
}

impl Shaker {
    fn new(engine: &Engine, speed: f64, seed: u64) -> Self {
        let joints = engine.body().joints.iter().filter(|joint| joint.independent && !joint.of_scene);
        Self {
            environment: Environment::of(engine.clone()),
            dofs: joints.map(|joint| joint.dof).collect(),
            speed,
            rest: vec![engine.task().action.rest(); engine.action_size()],
            seed,
            chance: Stream::new(EpisodeKey { seed, episode: 0 }, "train/shakes"),
        }
    }

    /// What the sensors measure from an initial state of the task on; `None` where the physics fails.
    fn window(&mut self, episode: u64, sensors: &Sensors) -> Option<Window> {
        let key = EpisodeKey { seed: self.seed, episode };
        self.environment.reset(key);
        let mut window = Window::new();
        for _ in 0..SHAKES {
            self.shake(key);
            for _ in 0..STEPS {
                // The task has no say here, unless its horizon is shorter than a shake.
                if self.environment.episode().ending().is_some() && !self.environment.ignore_termination() {
                    break;
                }
                self.environment.step(&self.rest).ok()?;
                let values = sensors.read(&self.environment);
                window.resize_with(values.len(), Vec::new);
                window.iter_mut().zip(values).for_each(|(sensor, value)| sensor.push(value));
            }
        }
        window.first().is_some_and(|values| values.iter().all(|value| value.is_finite())).then_some(window)
    }

    /// Begins an episode where the last one is, with random speeds.
    fn shake(&mut self, key: EpisodeKey) {
        let before = self.environment.state().clone();
        let Self { environment, dofs, speed, chance, .. } = self;
        environment.reset_to(key, &mut |state| {
            state.clone_from(&before);
            state.velocity.fill(0.0);
            dofs.iter().for_each(|dof| state.velocity[*dof] = *speed * (2.0 * chance.uniform() - 1.0));
        });
    }
}

/// Makes shares of its range over all windows of what each sensor measured.
fn scale(windows: &mut [Window]) {
    let sensors = windows.first().map_or(0, Vec::len);
    for sensor in 0..sensors {
        let all = || windows.iter().flat_map(|window| &window[sensor]);
        let low = all().fold(f64::INFINITY, |low, value| if *value < low { *value } else { low });
        let high = all().fold(f64::NEG_INFINITY, |high, value| if *value > high { *value } else { high });
        let range = high - low + EPSILON;
        windows.iter_mut().flat_map(|window| &mut window[sensor]).for_each(|value| *value = (*value - low) / range);
    }
}

/// The mean over the windows of the cosine between what two sensors measured.
fn similarity(windows: &[Window], one: usize, other: usize) -> f64 {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let cosine = |window: &Window| {
        let (a, b) = (&window[one], &window[other]);
        product(a, b) / (libm::sqrt(product(a, a) * product(b, b)) + EPSILON)
    };
    windows.iter().map(cosine).sum::<f64>() / windows.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Windows of four sensors: two that rise together, one of them tenfold, and two that fall.
    fn windows() -> Vec<Window> {
        let window = |shift: f64| -> Window {
            let wave: Vec<f64> = (0..50).map(|step| libm::sin(0.1 * f64::from(step) + shift)).collect();
            let of = |scale: f64, shift: f64| wave.iter().map(|value| scale * value + shift).collect();
            vec![of(1.0, 0.0), of(-2.0, 5.0), of(10.0, -3.0), of(-0.5, 0.0)]
        };
        (0..8).map(|index| window(0.8 * f64::from(index))).collect()
    }

    #[test]
    fn sensors_that_change_alike_are_near_whatever_their_units() {
        let mut windows = windows();
        scale(&mut windows);
        let near = |one, other| similarity(&windows, one, other);
        assert!((near(0, 2) - 1.0).abs() < 1e-6 && (near(1, 3) - 1.0).abs() < 1e-6);
        assert!(near(0, 1) < 0.7 && near(2, 3) < 0.7, "{} {}", near(0, 1), near(2, 3));
        let distances = Distances::of(4, |one, other| 1.0 - near(one, other));
        let mut chance = Stream::new(EpisodeKey::default(), "groups");
        assert_eq!(clusters(&distances, 2, 3, &mut chance), [0, 1, 0, 1]);
    }

    #[test]
    fn what_does_not_move_is_like_nothing() {
        let mut windows = windows();
        windows.iter_mut().for_each(|window| window[2].fill(7.0));
        scale(&mut windows);
        assert!(similarity(&windows, 0, 2) < 1e-6);
    }
}
