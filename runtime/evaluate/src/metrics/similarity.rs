//! Similarity of activations with envelopes of human electromyograms over the gait cycle.
//!
//! 1. Cycles run from strike to strike of the foot on the muscle's side ([`Gait`]); without strikes there is no result.
//! 2. Each cycle of activations is resampled to 101 points by a cubic spline; cycles are averaged, and the mean is scaled to 0..1. The
//!    deviation over cycles is divided by the range of the mean.
//! 3. r_m is the largest Pearson correlation of mean and human envelope over all cyclic shifts. 0 % and 100 % are the same point of the
//!    cycle, so shifts are of the 100 points without the last; at the first largest.
//! 4. r_EMG is the mean of r_m over the muscles.
//!
//! A largest value over shifts is positive also for curves that have nothing in common. [`chance`] estimates by how much: the same is
//! done with surrogates, curves with the spectrum of the simulated one and shuffled phases (Theiler et al., Physica D 58, 1992), and the
//! mean of their r is reported beside r, with the share of them that reaches it.
//!
//! Amplitudes and absolute timing are not compared. After Li et al. 2026 (MuscleMimic), where ends of the cycle count twice.

use super::Gait;
use super::curve::{POINTS, correlation, mean_and_deviation, normalized, range, resample};
use crate::trace::{Quantity, Trace};
use msk_runtime::episode::{EpisodeKey, Stream};

/// Fewest samples of a cycle.
const LEAST_SAMPLES: usize = 4;
/// Surrogates of a muscle.
const SURROGATES: usize = 200;

/// A human envelope of one muscle over a cycle from 0 to 100 %, in any unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// The muscle of the body that it is compared with.
    pub muscle: String,
    /// The column of the recording that it is of.
    pub column: String,
    /// Values at equal distances; more than three.
    pub values: Vec<f64>,
}

/// A muscle against a human envelope.
#[derive(Debug, Clone, PartialEq)]
pub struct Similarity {
    /// The muscle.
    pub muscle: String,
    /// The column of the recording.
    pub column: String,
    /// Cycles that were averaged.
    pub cycles: usize,
    /// Mean activation over the cycle, scaled to 0..1 and shifted: 101 points.
    pub simulated: Vec<f64>,
    /// Deviation over cycles by the range of the mean, shifted likewise.
    pub deviation: Vec<f64>,
    /// The human envelope, scaled to 0..1.
    pub human: Vec<f64>,
    /// Part of the cycle by which the simulated curve was shifted to be later, 0..1.
    pub shift: f64,
    /// Pearson's correlation at that shift.
    pub correlation: f64,
    /// Mean of the same over surrogates: what chance reaches.
    pub chance: f64,
    /// Share of surrogates that reach the correlation.
    pub reached: f64,
}

/// Why a muscle cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SimilarityError {
    /// The trace lacks what cycles and activations are read from.
    #[error("the trace has no {0}: keep activations, ground_reactions, feet and center_of_mass")]
    Missing(Quantity),
    /// No muscle of that name.
    #[error("the body has no muscle `{0}`")]
    Unknown(String),
    /// It walks too little.
    #[error("there is no whole gait cycle of `{0}`: the episode has fewer than two strikes of its foot")]
    NoCycle(String),
    /// A curve without a shape.
    #[error("the {0} of `{1}` is constant: there is nothing to correlate")]
    Constant(&'static str, String),
    /// Too few values.
    #[error("the envelope of `{0}` has {1} values, expected at least 4")]
    Short(String, usize),
}

/// Compares the activations of a trace with human envelopes, muscle by muscle.
///
/// # Errors
/// A trace without the quantities, a muscle that does not exist, one without a cycle, or a curve that is constant.
pub fn compare(trace: &Trace, envelopes: &[Envelope]) -> Result<Vec<Similarity>, SimilarityError> {
    let needed = [Quantity::Activations, Quantity::GroundReactions, Quantity::Feet, Quantity::CenterOfMass];
    if let Some(missing) = needed.into_iter().find(|quantity| trace.layout().block(*quantity).is_none()) {
        return Err(SimilarityError::Missing(missing));
    }
    let mut gait = Gait::default();
    trace.replay(|row| gait.look(row));
    envelopes.iter().map(|envelope| compare_one(trace, &gait, envelope)).collect()
}

/// Mean of r over muscles; `None` without any.
pub fn mean_correlation(similarities: &[Similarity]) -> Option<f64> {
    let count = similarities.len() as f64;
    (count > 0.0).then(|| similarities.iter().map(|similarity| similarity.correlation).sum::<f64>() / count)
}

fn compare_one(trace: &Trace, gait: &Gait, envelope: &Envelope) -> Result<Similarity, SimilarityError> {
    let muscle = || envelope.muscle.clone();
    let layout = trace.layout();
    let place = layout.muscles.iter().position(|known| known.name == envelope.muscle);
    let activation = place.and_then(|place| trace.column(Quantity::Activations, place));
    let activation = activation.ok_or_else(|| SimilarityError::Unknown(muscle()))?;
    if envelope.values.len() < LEAST_SAMPLES {
        return Err(SimilarityError::Short(muscle(), envelope.values.len()));
    }
    let cycles = cycles(&activation, gait, side(&envelope.muscle, &layout.feet));
    let (mean, deviation) = mean_and_deviation(&cycles).ok_or_else(|| SimilarityError::NoCycle(muscle()))?;
    let [low, high] = range(&mean).ok_or_else(|| SimilarityError::Constant("activation", muscle()))?;
    let constant = || SimilarityError::Constant("human envelope", muscle());
    let human = normalized(&resample(&envelope.values, POINTS)).ok_or_else(constant)?;
    let simulated = normalized(&mean).ok_or_else(|| SimilarityError::Constant("activation", muscle()))?;
    let (shift, correlation) = best_shift(&simulated, &human).ok_or_else(constant)?;
    let (chance, reached) = chance(&simulated, &human, correlation, &envelope.muscle);
    let deviation: Vec<f64> = deviation.iter().map(|value| value / (high - low)).collect();
    Ok(Similarity {
        muscle: muscle(),
        column: envelope.column.clone(),
        cycles: cycles.len(),
        simulated: shifted(&simulated, shift),
        deviation: shifted(&deviation, shift),
        human,
        shift: shift as f64 / (POINTS - 1) as f64,
        correlation,
        chance,
        reached,
    })
}

/// The foot on the side of a muscle: that whose name ends like the muscle's, else the first.
fn side(muscle: &str, feet: &[String]) -> usize {
    let end = |name: &str| name.rsplit_once('_').map(|(_, end)| end.to_owned());
    feet.iter().position(|foot| end(foot) == end(muscle)).unwrap_or(0)
}

/// The cycles of a curve from strike to strike of a foot, resampled.
pub fn cycles(values: &[f64], gait: &Gait, foot: usize) -> Vec<Vec<f64>> {
    let strikes = gait.strikes();
    let rows: Vec<usize> = strikes.iter().filter(|strike| strike.foot == foot).map(|strike| strike.row as usize).collect();
    let cycle = |pair: &[usize]| values.get(pair[0]..=pair[1]).filter(|part| part.len() >= LEAST_SAMPLES);
    rows.windows(2).filter_map(cycle).map(|part| resample(part, POINTS)).collect()
}

/// The curve later by so many of its points, where the last point is the first of the next cycle.
pub fn shifted(curve: &[f64], by: usize) -> Vec<f64> {
    let count = curve.len() - 1;
    (0..curve.len()).map(|point| curve[(point + count - by % count) % count]).collect()
}

/// The first shift with the largest correlation, and that; `None` where a curve is constant.
pub fn best_shift(simulated: &[f64], human: &[f64]) -> Option<(usize, f64)> {
    let count = simulated.len() - 1;
    let mut best: Option<(usize, f64)> = None;
    for shift in 0..count {
        let r = correlation(&shifted(simulated, shift)[..count], &human[..count])?;
        if best.is_none_or(|(_, largest)| r > largest) {
            best = Some((shift, r));
        }
    }
    best
}

/// The mean of the best correlation of surrogates, and the share of them that reaches `correlation`.
pub fn chance(simulated: &[f64], human: &[f64], correlation: f64, name: &str) -> (f64, f64) {
    let count = simulated.len() - 1;
    let mut stream = Stream::new(EpisodeKey::default(), &format!("surrogates/{name}"));
    let spectrum = spectrum(&simulated[..count]);
    let (mut sum, mut reached) = (0.0, 0);
    for _ in 0..SURROGATES {
        let mut surrogate = surrogate(&spectrum, count, &mut stream);
        surrogate.push(surrogate[0]);
        let r = best_shift(&surrogate, human).map_or(0.0, |(_, r)| r);
        sum += r;
        reached += usize::from(r >= correlation);
    }
    (sum / SURROGATES as f64, reached as f64 / SURROGATES as f64)
}

/// Amplitude of every frequency above 0 and up to the half of the points.
fn spectrum(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let amplitude = |frequency: usize| {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (index, value) in values.iter().enumerate() {
            let angle = core::f64::consts::TAU * ((frequency * index) % count) as f64 / count as f64;
            let (sine, cosine) = libm::sincos(angle);
            real += value * cosine;
            imaginary -= value * sine;
        }
        libm::hypot(real, imaginary) / count as f64
    };
    (1..=count / 2).map(amplitude).collect()
}

/// A curve of that spectrum with random phases.
fn surrogate(spectrum: &[f64], count: usize, stream: &mut Stream) -> Vec<f64> {
    let mut values = vec![0.0; count];
    for (index, amplitude) in spectrum.iter().enumerate() {
        let frequency = index + 1;
        let phase = core::f64::consts::TAU * stream.uniform();
        for (place, value) in values.iter_mut().enumerate() {
            let angle = core::f64::consts::TAU * ((frequency * place) % count) as f64 / count as f64;
            *value += 2.0 * amplitude * libm::cos(angle + phase);
        }
    }
    values
}
