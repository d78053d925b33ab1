//! Motions as tables: what is read, what lies between the rows, and the errors of texts that are no motion.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]
#![allow(clippy::disallowed_methods, reason = "what is expected need not agree between machines to the bit")]

#[allow(dead_code)] // The pages have their own tests.
use crate::support;

use msk_compiler::diagnostics::{FileId, Report, SourceMap, Style, codes};
use msk_compiler::motion::{Motion, RootPart, problems, read};
use std::f64::consts::{PI, TAU};
use support::compiling::vocabulary;

const HEAD: &str = "# name: test\n# source: made up\n";

fn motion(text: &str) -> Motion {
    read(FileId::default(), text).unwrap()
}

/// The diagnostics of a text, as printed.
fn rendered(text: &str) -> String {
    let mut sources = SourceMap::default();
    let file = sources.add("motion.csv", text);
    let diagnostics = match read(file, text) {
        Ok(motion) => problems(&motion, file, &vocabulary()),
        Err(diagnostics) => diagnostics,
    };
    Report::new(sources, diagnostics).render(Style::Plain)
}

/// A cycle of two seconds: a cosine of the knee, and a path that goes on by 3 m with a wave.
fn wave(rows: usize) -> Motion {
    let mut text = format!("{HEAD}# cycle: yes\n# duration: 2 s\n# advances: root.x\nphase, knee_angle_r [deg], root.x [m]\n");
    for row in 0..=rows {
        let phase = row as f64 / rows as f64;
        text += &format!("{phase}, {}, {}\n", 30.0 * (TAU * phase).cos(), 3.0 * phase + 0.1 * (TAU * phase).sin());
    }
    motion(&text)
}

#[test]
fn a_cycle_is_smooth_and_goes_on_for_ever() {
    let wave = wave(40);
    let (knee, x) = (wave.joint("knee_angle_r").unwrap(), wave.root(RootPart::X).unwrap());
    for step in -30..90 {
        let time = f64::from(step) * 0.0731;
        let angle = PI * time;
        assert!((wave.value(knee, time) - (30.0_f64).to_radians() * angle.cos()).abs() < 1e-6, "{time}");
        assert!((wave.rate(knee, time) + (30.0_f64).to_radians() * PI * angle.sin()).abs() < 1e-4, "{time}");
        assert!((wave.value(x, time) - (1.5 * time + 0.1 * angle.sin())).abs() < 1e-6, "{time}");
        assert!((wave.rate(x, time) - (1.5 + 0.1 * PI * angle.cos())).abs() < 1e-4, "{time}");
    }
    assert!((wave.advance(x) - 3.0).abs() < 1e-12 && wave.advance(knee) == 0.0);
    assert!((wave.phase_of(5.0) - 0.5).abs() < 1e-15 && wave.phase_of(-0.5) == 0.75);
}

#[test]
fn rows_are_met_to_the_bit() {
    let wave = wave(16);
    let times = wave.times.clone();
    let values: Vec<f64> = times.iter().take(16).map(|time| wave.value(0, *time)).collect();
    let expected: Vec<f64> = (0..16).map(|row| 30.0 * (TAU * (f64::from(row) / 16.0)).cos() * (PI / 180.0)).collect();
    assert_eq!(values, expected);
}

#[test]
fn bounds_hold_everywhere_and_are_reached() {
    let wave = wave(7);
    for column in 0..2 {
        let ([low, high], [slow, fast]) = (wave.range(column), wave.rate_range(column));
        let (mut values, mut rates) = (Vec::new(), Vec::new());
        for step in 0..=20_000 {
            let time = f64::from(step) * 1e-4 * (1.0 - 1e-12);
            values.push(wave.value(column, time));
            rates.push(wave.rate(column, time));
        }
        let least = |list: &[f64]| list.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |list: &[f64]| list.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (bound, reached) in [(low, least(&values)), (high, most(&values)), (slow, least(&rates)), (fast, most(&rates))] {
            assert!((bound - reached).abs() < 1e-4, "column {column}: {bound} against {reached}");
        }
        assert!(least(&values) >= low - 1e-12 && most(&values) <= high + 1e-12);
        assert!(least(&rates) >= slow - 1e-12 && most(&rates) <= fast + 1e-12);
    }
}

#[test]
fn what_is_no_cycle_stands_still_before_and_after() {
    let text =
        format!("{HEAD}# cycle: no\ntime [ms], hip_flexion_l [rad], root.height [cm]\n0, 0, 95\n500, 1, 80\n2000, 1.5, 50\n");
    let sitting = motion(&text);
    assert_eq!((sitting.duration, sitting.cycle), (2.0, false));
    assert_eq!(sitting.at(-1.0), sitting.at(0.0));
    assert_eq!(sitting.at(7.0), [1.5, 0.5]);
    assert_eq!((sitting.rates(-1.0), sitting.rates(7.0)), (vec![0.0; 2], vec![0.0; 2]));
    assert!(sitting.rate(0, 1.0) > 0.0);
    assert_eq!((sitting.phase_of(-1.0), sitting.phase_of(1.0), sitting.phase_of(9.0)), (0.0, 0.5, 1.0));
    // Two rows are joined by a straight line.
    let line = motion(&format!("{HEAD}# cycle: no\ntime [s], hip_flexion_l [rad]\n0, 0\n2, 1\n"));
    assert_eq!((line.value(0, 0.5), line.rate(0, 0.5)), (0.25, 0.5));
}

#[test]
fn uneven_rows_make_the_same_curve() {
    let phases = [0.0, 0.03, 0.11, 0.2, 0.26, 0.38, 0.47, 0.55, 0.61, 0.7, 0.79, 0.9, 0.96, 1.0];
    let rows: String = phases.iter().map(|phase| format!("{phase}, {}\n", (TAU * phase).sin())).collect();
    let uneven = motion(&format!("{HEAD}# cycle: yes\n# duration: 1 s\nphase, knee_angle_r [rad]\n{rows}"));
    for step in 0..100 {
        let time = f64::from(step) / 100.0;
        assert!((uneven.value(0, time) - (TAU * time).sin()).abs() < 3e-3, "{time}");
    }
    // Slopes and bends go over the seam without a step.
    let bend = |time: f64| (uneven.rate(0, time + 1e-6) - uneven.rate(0, time - 1e-6)) / 2e-6;
    assert!((uneven.rate(0, 1.0 - 1e-9) - uneven.rate(0, 1.0 + 1e-9)).abs() < 1e-6);
    assert!((bend(1.0 - 1e-5) - bend(1.0 + 1e-5)).abs() < 0.05);
}

#[test]
fn times_that_are_no_numbers_give_no_panic() {
    let wave = wave(8);
    for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        let _ = (wave.at(time), wave.rates(time), wave.phase_of(time));
    }
}

#[test]
fn a_cell_beyond_all_angles_is_an_error() {
    for cell in ["1e308", "-1e308", "1.1e6"] {
        let answer = rendered(&format!("{HEAD}# cycle: no\ntime [s], knee_angle_r [deg]\n0, 0\n1, {cell}\n"));
        assert!(answer.contains(&format!("`{cell}` is too large: the largest number of a motion is 1e6")), "{answer}");
    }
    assert_eq!(rendered(&format!("{HEAD}# cycle: no\ntime [s], knee_angle_r [deg]\n0, 0\n1, 120\n")), "");
}

#[test]
fn errors_say_what_is_wrong_and_where() {
    insta::assert_snapshot!(rendered(
        "# name: walk\n# sorce: nobody\n# cycle: perhaps\n# advances: knee_angle_r\n\
         fase, knee_angle_r [deg], knee_angle_r [deg], root.hight [m], hip_flexion_r, root.pitch [m]\n0, 1, 2, 3, 4, 5\n"
    ));
    insta::assert_snapshot!(rendered(&format!(
        "{HEAD}# cycle: yes\n# duration: 1.1\n# advances: knee_angle_r, root.y\nphase, knee_angle_r [deg]\n\
         0, 1\n0.5, one\n0.5, 2\n0.4, 2\n0.7\n1, inf\n"
    )));
    insta::assert_snapshot!(rendered(&format!(
        "{HEAD}# cycle: yes\n# duration: 1.1 s\nphase, knee_angle_r [deg], root.x [m]\n0, 1, 0\n0.3, 2, 0.5\n0.6, 2, 0.9\n1, 5, 1.4\n"
    )));
    insta::assert_snapshot!(rendered(&format!(
        "{HEAD}# cycle: no\ntime [s], knee_angel_r [deg], hip_flexion_r [cm]\n0, 1, 2\n1, 2, 3\n"
    )));
    for text in ["", "# nothing but a remark\n", "phase, knee_angle_r [deg]\n", "\u{feff},,,\n,,\n", "time [s]\n0\n1\n"] {
        assert!(rendered(text).contains("error[E04"), "{text:?}: {}", rendered(text));
    }
}

#[test]
fn examples_of_codes_cause_them_and_fixes_do_not() {
    for id in ["E0437", "E0438", "E0439"] {
        let code = codes::find(id).unwrap();
        let rendered = |example: &str| {
            let head = if example.contains("# cycle") { HEAD.to_owned() } else { format!("{HEAD}# cycle: no\n") };
            rendered(&format!("{head}# duration: 1 s\n{example}\n"))
        };
        assert!(rendered(code.example).contains(id), "{id}: {}", rendered(code.example));
        assert!(!rendered(code.fix).contains(id), "{id}: {}", rendered(code.fix));
    }
}
