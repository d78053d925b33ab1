//! Butterworth filters without delay, for raw electromyograms and forces.
//!
//! A filter of the fourth order, as two sections of the second by the bilinear transform (Oppenheim and Schafer, "Discrete-Time Signal
//! Processing", 3rd ed., 7.2 and 7.3), runs forwards and backwards over the signal, which shifts no frequency in time and doubles the
//! order. Ends are extended by the signal turned about its first and last value, as SciPy's `sosfiltfilt` does, against which the numbers
//! are tested.

use core::f64::consts::PI;

/// Sections of the second order.
const SECTIONS: usize = 2;
/// Samples by which each end is extended: three times the number of coefficients.
const EXTENSION: usize = 3 * (2 * SECTIONS + 1);

/// Which frequencies pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// Those below the corner.
    Low,
    /// Those above.
    High,
}

/// A section: numerator and denominator, whose first coefficient is 1.
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// Filters samples taken `rate` times per second by a corner frequency, both in Hz. The corner has to be below half of the rate, and the
/// signal longer than the extension of its ends, else it comes back as it is.
pub fn filter(samples: &[f64], pass: Pass, corner: f64, rate: f64) -> Vec<f64> {
    if samples.len() <= EXTENSION || !(corner > 0.0 && corner < 0.5 * rate) {
        return samples.to_vec();
    }
    let sections: Vec<Section> = (0..SECTIONS).map(|place| section(pass, corner / rate, place)).collect();
    let last = samples.len() - 1;
    let before = (1..=EXTENSION).rev().map(|place| 2.0 * samples[0] - samples[place]);
    let after = (1..=EXTENSION).map(|place| 2.0 * samples[last] - samples[last - place]);
    let mut signal: Vec<f64> = before.chain(samples.iter().copied()).chain(after).collect();
    for _ in 0..2 {
        sections.iter().fold(signal.first().copied().unwrap_or(0.0), |level, section| section.run(&mut signal, level));
        signal.reverse();
    }
    signal[EXTENSION..EXTENSION + samples.len()].to_vec()
}

/// Section number `place` of the filter with that corner, as a part of the rate.
fn section(pass: Pass, corner: f64, place: usize) -> Section {
    // Poles stand on a circle, those of a section at this angle to the real axis.
    let angle = PI * (2 * place + 1) as f64 / (4 * SECTIONS) as f64;
    let (sine, cosine) = libm::sincos(PI * corner);
    let k = sine / cosine;
    let damping = 2.0 * libm::cos(angle) * k;
    let scale = 1.0 / (1.0 + damping + k * k);
    let b = match pass {
        Pass::Low => [k * k * scale, 2.0 * k * k * scale, k * k * scale],
        Pass::High => [scale, -2.0 * scale, scale],
    };
    Section { b, a: [2.0 * (k * k - 1.0) * scale, (1.0 - damping + k * k) * scale] }
}

impl Section {
    /// Filters in place, from a state as if the signal had always been at `level`; gives the level that comes out for that.
    fn run(&self, signal: &mut [f64], level: f64) -> f64 {
        let Self { b, a } = self;
        let gain = (b[0] + b[1] + b[2]) / (1.0 + a[0] + a[1]);
        let mut state = [(gain - b[0]) * level, (b[2] - a[1] * gain) * level];
        for sample in signal {
            let out = b[0] * *sample + state[0];
            state = [b[1] * *sample - a[0] * out + state[1], b[2] * *sample - a[1] * out];
            *sample = out;
        }
        gain * level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal() -> Vec<f64> {
        (0..60).map(|place| f64::from(place * place % 17) - 0.05 * f64::from(place)).collect()
    }

    /// Every tenth sample by `sosfiltfilt(butter(4, corner, pass, fs=100, output="sos"), signal)`: `tests/oracle/metrics.py` prints them.
    #[test]
    fn filters_are_those_of_scipy() {
        let check = |pass, corner, expected: [f64; 6]| {
            let found = filter(&signal(), pass, corner, 100.0);
            for (place, expected) in expected.into_iter().enumerate() {
                assert!((found[10 * place] - expected).abs() < 1e-9, "{pass:?} {place}: {} is not {expected}", found[10 * place]);
            }
        };
        check(Pass::Low, 6.0, [0.090276392558, 10.015785901762, 5.883735368503, 6.270679164839, 7.516491042396, 2.890520776162]);
        check(
            Pass::High,
            20.0,
            [0.001881835418, 4.445893717221, -1.161940174486, 5.243871615770, -6.082084467533, 0.077019178407],
        );
    }

    #[test]
    fn a_filter_keeps_what_passes_and_has_no_delay() {
        let wave =
            |frequency: f64| (0..400).map(|place| libm::sin(2.0 * PI * frequency * f64::from(place) / 100.0)).collect::<Vec<_>>();
        let kept = filter(&wave(2.0), Pass::Low, 10.0, 100.0);
        assert!(kept.iter().zip(wave(2.0)).skip(50).take(300).all(|(found, wanted)| (found - wanted).abs() < 1e-4));
        assert!(filter(&wave(40.0), Pass::Low, 10.0, 100.0)[50..350].iter().all(|value| value.abs() < 1e-4));
        assert!(filter(&[3.0; 100], Pass::High, 20.0, 100.0).iter().all(|value| value.abs() < 1e-12));
    }

    #[test]
    fn a_signal_that_cannot_be_filtered_comes_back() {
        assert_eq!(filter(&[1.0, 2.0], Pass::Low, 6.0, 100.0), [1.0, 2.0]);
        assert_eq!(filter(&[1.0; 40], Pass::Low, 60.0, 100.0), [1.0; 40]);
    }
}
