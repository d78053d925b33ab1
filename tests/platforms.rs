//! Objects that formulas of time move, and what they carry.

use super::episodes::episode;
use msk::runtime::episode::{Environment, EpisodeKey};

const KEY: EpisodeKey = EpisodeKey { seed: 3, episode: 0 };

/// A cube on a platform beside the body.
fn cube_on(platform: &str, cube: [f64; 2]) -> Environment {
    let [x, y] = cube;
    let scene = format!(
        "scene {{
        ground
        box platform {{ size [1 m, 1 m, 0.1 m], at [3 m, 0, 0.5 m], {platform}, box rail {{ size [1 m, 2 cm, 10 cm], at [0, 0.5 m, 0.1 m] }} }}
        box cube {{ size [0.1 m, 0.1 m, 0.1 m], mass 2 kg, free, at [3 m + {x} m, {y} m, 0.6 m] }}
    }}
    init {{"
    );
    let observed = "observe { platform = platform.position; moving = platform.velocity; turning = platform.angular_velocity; rail = platform.rail.position; cube = cube.position; carried = cube.velocity;";
    episode(&[
        ("init {", &scene),
        ("observe {", observed),
        ("horizon 12 steps", "horizon 200 steps"),
        ("step > 100", "step > 1000"),
    ])
}

fn seen(environment: &Environment, channel: &str) -> Vec<f64> {
    let channels = &environment.engine().task().channels;
    let channel = channels.iter().find(|known| known.name == channel).unwrap_or_else(|| panic!("no channel `{channel}`"));
    environment.observation()[channel.offset..channel.offset + channel.size].to_vec()
}

fn after(environment: &mut Environment, steps: usize) {
    environment.reset(KEY);
    let action = vec![-1.0; environment.engine().action_size()];
    (0..steps).for_each(|_| environment.step(&action).map(|_| ()).unwrap());
}

fn near(found: &[f64], expected: [f64; 3], tolerance: f64) {
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < tolerance), "{found:?} {expected:?}");
}

#[test]
fn a_platform_is_where_its_formula_has_it() {
    let mut environment = cube_on("moves [0.2 m * sin(90 deg/s * t), 0, 0.1 m/s * t], turns 30 deg/s * t", [0.0, 0.0]);
    environment.reset(KEY);
    near(&seen(&environment, "platform"), [3.0, 0.0, 0.5], 1e-12);
    after(&mut environment, 100);
    near(&seen(&environment, "platform"), [3.2, 0.0, 0.6], 1e-9);
    near(&seen(&environment, "turning"), [0.0, 0.0, 30_f64.to_radians()], 1e-9);
    let (sine, cosine) = (0.5 * 0.5, 0.5 * 0.75_f64.sqrt());
    near(&seen(&environment, "rail"), [3.2 - sine, cosine, 0.7], 1e-9);
}

#[test]
fn friction_carries_what_stands_on_a_platform() {
    let mut environment = cube_on("moves [0.2 m/s * t, 0.1 m/s * t, 0]", [0.0, 0.0]);
    after(&mut environment, 100);
    near(&seen(&environment, "moving"), [0.2, 0.1, 0.0], 1e-9);
    near(&seen(&environment, "carried"), [0.2, 0.1, 0.0], 1e-3);
    // It slips while it takes up speed: v² / 2 μ g.
    near(&seen(&environment, "cube"), [3.2, 0.1, 0.6], 0.01);
}

#[test]
fn a_platform_that_turns_carries_around_its_middle() {
    let mut environment = cube_on("turns 30 deg/s * t", [0.3, 0.0]);
    after(&mut environment, 100);
    near(&seen(&environment, "cube"), [3.0 + 0.3 * 0.75_f64.sqrt(), 0.15, 0.6], 0.01);
}

#[test]
fn a_lift_raises_what_stands_on_it() {
    let mut environment = cube_on("moves [0, 0, 0.05 m * (1 - cos(90 deg/s * t))]", [0.0, 0.0]);
    after(&mut environment, 200);
    near(&seen(&environment, "cube"), [3.0, 0.0, 0.7], 0.003);
}
