//! What the entries of an action move: a sensor each, the length of a muscle, the mean length of those of a synergy, or minus the angle
//! that a torque turns. A sensor shrinks where its entry pulls.

use msk_program::action::ActionTarget;
use msk_runtime::episode::{Engine, Environment, Episode};

/// What an entry of an action moves.
enum Sensor {
    /// Lengths of actuators, of which it is the mean.
    Lengths(Vec<usize>),
    /// Place of a coordinate in the state, against which it counts.
    Angle(usize),
}

/// The sensors of an action space.
pub(crate) struct Sensors {
    sensors: Vec<Sensor>,
    /// The forward pass of a state.
    environment: Environment,
}

impl Sensors {
    /// Of the action space of a task.
    ///
    /// # Errors
    /// A space whose entries move neither muscles nor joints, in words.
    pub fn of(engine: &Engine) -> Result<Self, String> {
        let (task, body) = (engine.task(), engine.body());
        // Muscles are the first actuators of a body's model, in its order.
        let of = |muscle: usize| engine.model().actuators.name.iter().position(|name| *name == body.muscles[muscle].name);
        let lengths = |muscles: &[usize]| Sensor::Lengths(muscles.iter().filter_map(|muscle| of(*muscle)).collect());
        let sensors = match &task.action.target {
            ActionTarget::AllMuscles => (0..body.muscles.len()).map(|muscle| lengths(&[muscle])).collect(),
            ActionTarget::Muscles(chosen) => chosen.iter().map(|muscle| lengths(&[*muscle])).collect(),
            ActionTarget::Synergies(synergies) => synergies.iter().map(|synergy| lengths(&synergy.muscles)).collect(),
            ActionTarget::Torque { joints, .. } => {
                joints.iter().map(|joint| Sensor::Angle(body.joints[*joint].position)).collect()
            }
            ActionTarget::MuscleControl(_) => {
                return Err(format!(
                    "its actions have to move muscles or joints, and those of `act {}` do not",
                    task.action.word()
                ));
            }
        };
        Ok(Self { sensors, environment: Environment::of(engine.clone()) })
    }

    /// What they measure in an episode, m or rad.
    pub fn measure(&mut self, episode: &Episode) -> Vec<f64> {
        self.environment.restore(episode);
        self.read(&self.environment)
    }

    /// What they measure in the present episode of an environment of the same task, m or rad.
    pub fn read(&self, environment: &Environment) -> Vec<f64> {
        let context = environment.context();
        let length = &context.workspace.actuation.length;
        let value = |sensor: &Sensor| match sensor {
            Sensor::Lengths(chosen) => {
                let known = chosen.iter().filter_map(|actuator| length.get(*actuator));
                known.sum::<f64>() / chosen.len().max(1) as f64
            }
            Sensor::Angle(place) => -context.state.position.get(*place).copied().unwrap_or_default(),
        };
        self.sensors.iter().map(value).collect()
    }
}
