//! Presets: what settings are where a file says nothing.

use super::{
    Algorithm, CloneSettings, DepSettings, DynsynSettings, MpoSettings, PpoSettings, Precision, Preset, SacSettings, Settings,
};
use msk_network::Activation;

impl Settings {
    /// Those of a preset.
    pub fn of(algorithm: Algorithm, preset: Preset) -> Self {
        let fast = Self::fast(algorithm);
        if preset == Preset::Fast { fast } else { fast.paper() }
    }

    fn fast(algorithm: Algorithm) -> Self {
        let simba = algorithm == Algorithm::Simba;
        let hidden = match algorithm {
            Algorithm::Ppo => vec![64, 64],
            Algorithm::Simba => vec![128],
            Algorithm::Sac | Algorithm::Dynsyn | Algorithm::Mpo | Algorithm::Clone => vec![256, 256],
        };
        let sac = match simba {
            true => SacSettings {
                critic_rate: 3e-4,
                actor_delay: 1,
                temperature: 0.01,
                target_entropy: 0.5,
                weight_decay: 0.01,
                ..SacSettings::default()
            },
            false => SacSettings::default(),
        };
        Self {
            algorithm,
            preset: Preset::Fast,
            episodes: 8,
            hidden,
            critic_hidden: if simba { vec![256, 256] } else { Vec::new() },
            activation: if algorithm == Algorithm::Ppo { Activation::Tanh } else { Activation::Relu },
            layer_norm: false,
            residual: simba,
            discount: 0.99,
            action_repeat: 1,
            normalize_observations: true,
            normalize_rewards: algorithm == Algorithm::Ppo,
            noise_correlation: 0.0,
            evaluate_every: 50_000,
            evaluation_episodes: 10,
            checkpoint_every: 50_000,
            replay_precision: Precision::Single,
            replay_memory: 4.0,
            critics_first: 10_000,
            ppo: PpoSettings::default(),
            sac,
            dynsyn: DynsynSettings::default(),
            mpo: MpoSettings::default(),
            dep: DepSettings::default(),
            clone: CloneSettings::default(),
        }
    }

    /// The values of the paper that an algorithm is from, or of the benchmark's where it has them.
    fn paper(self) -> Self {
        let algorithm = self.algorithm;
        let ppo = PpoSettings {
            anneal: false,
            horizon: 2048,
            minibatch: 256,
            clip_values: false,
            entropy: 0.005,
            ..PpoSettings::default()
        };
        let mpo = MpoSettings {
            actor_rate: 5e-5,
            critic_rate: 8e-5,
            dual_rate: 2e-3,
            start: 100_000,
            batch: 256,
            updates: 0.03,
            samples: 20,
            ..MpoSettings::default()
        };
        let dynsyn = DynsynSettings { rollout: 500_000, ..DynsynSettings::default() };
        let (hidden, critic_hidden) = match algorithm {
            Algorithm::Simba => (vec![128], vec![512, 512]),
            Algorithm::Dynsyn => (vec![1024, 1024, 1024], Vec::new()),
            Algorithm::Ppo | Algorithm::Sac | Algorithm::Mpo | Algorithm::Clone => (vec![1024, 1024], Vec::new()),
        };
        let episodes = match algorithm {
            Algorithm::Dynsyn => 64,
            Algorithm::Mpo => 16,
            _ => self.episodes,
        };
        let evaluate_every = match algorithm {
            Algorithm::Ppo => 500_000,
            Algorithm::Dynsyn => 5_000_000,
            _ => 200_000,
        };
        Self {
            preset: Preset::Paper,
            episodes,
            hidden,
            critic_hidden,
            evaluate_every,
            evaluation_episodes: if algorithm == Algorithm::Dynsyn { 3 } else { self.evaluation_episodes },
            checkpoint_every: evaluate_every,
            normalize_rewards: matches!(algorithm, Algorithm::Ppo | Algorithm::Sac),
            ppo,
            sac: self.paper_sac(),
            dynsyn,
            mpo,
            ..self
        }
    }

    fn paper_sac(&self) -> SacSettings {
        let sac = SacSettings { actor_delay: 1, ..self.sac.clone() };
        match self.algorithm {
            Algorithm::Dynsyn => SacSettings {
                actor_rate: 5e-4,
                critic_rate: 5e-4,
                start: 10_000,
                updates: 1.0 / 64.0,
                temperature: 1.0,
                anneal: 0.25,
                ..sac
            },
            Algorithm::Simba => SacSettings { actor_rate: 1e-4, critic_rate: 1e-4, updates: 2.0, ..sac },
            _ => SacSettings {
                actor_rate: 1e-4,
                critic_rate: 1e-4,
                start: 100,
                updates: 0.125,
                temperature: 0.05,
                automatic: false,
                ..sac
            },
        }
    }
}

impl Default for MpoSettings {
    fn default() -> Self {
        Self {
            actor_rate: 3e-4,
            critic_rate: 3e-4,
            dual_rate: 1e-2,
            replay: 1_000_000,
            start: 5_000,
            batch: 128,
            updates: 0.1,
            block: 30,
            steps: 3,
            samples: 10,
            follow: 0.005,
            epsilon: 0.1,
            epsilon_penalty: 1e-3,
            epsilon_mean: 1e-3,
            epsilon_std: 1e-6,
        }
    }
}

impl Default for DepSettings {
    fn default() -> Self {
        Self {
            explores: true,
            gain: 1169.7,
            horizon: 40,
            bias_rate: 0.002,
            delay: 5,
            smoothing: 2,
            probability: 0.001,
            length: 5,
        }
    }
}

impl Default for CloneSettings {
    fn default() -> Self {
        Self { learning_rate: 1e-3, anneal: true, batch: 256, updates: 0.5, guided: 0.0, memory: 200_000, squash: false }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::of(Algorithm::default(), Preset::default())
    }
}

impl Default for PpoSettings {
    fn default() -> Self {
        Self {
            learning_rate: 3e-4,
            anneal: true,
            horizon: 256,
            minibatch: 64,
            epochs: 10,
            lambda: 0.95,
            clip: 0.2,
            clip_values: true,
            entropy: 0.0,
            value_weight: 0.5,
            gradient_norm: 0.5,
            log_std: 0.0,
        }
    }
}

impl Default for SacSettings {
    fn default() -> Self {
        Self {
            actor_rate: 3e-4,
            critic_rate: 1e-3,
            replay: 1_000_000,
            start: 5_000,
            zero_init: false,
            batch: 256,
            updates: 0.25,
            actor_delay: 2,
            follow: 0.005,
            temperature: 0.2,
            automatic: true,
            target_entropy: 1.0,
            anneal: 1.0,
            weight_decay: 0.0,
        }
    }
}

impl Default for DynsynSettings {
    fn default() -> Self {
        Self { groups: 76, amplitude: 0.1, release: 0.6, rollout: 5_000, speed: 5.0 }
    }
}
