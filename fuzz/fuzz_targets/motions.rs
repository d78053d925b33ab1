//! Any text given as a motion: it is read or refused, and what is read is a number at every time.

#![no_main]

mod language;

use libfuzzer_sys::fuzz_target;
use msk_compiler::diagnostics::{Report, SourceMap};
use msk_compiler::motion;

fuzz_target!(|text: &str| {
    let mut sources = SourceMap::default();
    let file = sources.add("motion.csv", text);
    let motion = match motion::read(file, text) {
        Ok(motion) => motion,
        Err(diagnostics) => {
            assert!(!diagnostics.is_empty(), "refused without a word: {text:?}");
            return language::must_be_sound(&Report::new(sources, diagnostics));
        }
    };
    assert!(motion.duration > 0.0 && !motion.columns.is_empty() && motion.times.len() >= 2);
    let end = motion.duration;
    for time in [0.0, end, end / 3.0, 2.5 * end, -0.5 * end].into_iter().chain(motion.times.iter().copied().take(50)) {
        assert!(motion.at(time).iter().chain(&motion.rates(time)).all(|number| number.is_finite()), "at {time} s: {text:?}");
        assert!((0.0..=1.0).contains(&motion.phase_of(time)), "at {time} s: {text:?}");
    }
    for column in 0..motion.columns.len() {
        let ([low, high], [slow, fast]) = (motion.range(column), motion.rate_range(column));
        assert!(low <= high && slow <= fast, "{:?}: {text:?}", motion.columns[column]);
        let value = motion.value(column, end / 3.0);
        let slack = 1e-9 * (low.abs() + high.abs()) + 1e-9;
        assert!(value >= low - slack && value <= high + slack, "{value} is not in {low}..{high}: {text:?}");
    }
    let problems = motion::problems(&motion, file, language::vocabulary());
    language::must_be_sound(&Report::new(sources, problems));
});
