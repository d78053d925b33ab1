use super::super::average;
use super::super::c3d::tests::analog_file;
use super::*;

/// By `tests/oracle/recordings.py` with openpyxl.
const WORKBOOK: &[u8] = include_bytes!("channels.xlsx");
const RATE: usize = 1000;

#[test]
fn channels_of_muscles_stand_in_the_workbook() {
    let found = |participant, condition| channels(WORKBOOK, participant, condition);
    let pairs = |pairs: &[(&str, usize)]| pairs.iter().map(|(name, number)| ((*name).to_owned(), *number)).collect::<Channels>();
    assert_eq!(found(1, "3ms"), Ok(pairs(&[("Tibialis", 3), ("Sol", 5), ("Vastus", 4)])));
    assert_eq!(found(1, "5ms"), Ok(pairs(&[("Tibialis", 3), ("Sol", 4), ("Vastus", 5)])));
    // Without a row of its own: those of the others, unless they differ. A muscle that was not recorded has none.
    assert_eq!(found(2, "333ms"), Ok(pairs(&[("Tibialis", 3), ("Vastus", 4)])));
    let message = |error: Result<Channels, RecordingError>| error.unwrap_err().to_string();
    assert_eq!(message(found(1, "333ms")), "has no row with channels for this participant and condition");
    assert_eq!(message(found(3, "3ms")), "has no row with channels for this participant and condition");
    assert_eq!(message(channels(b"PK", 1, "3ms")), "has no ZIP archive, which a workbook is");
    assert_eq!(
        message(sheet(WORKBOOK, "Channels").map(|_| Vec::new())),
        "has no sheet `Channels`; it has Read me, Corresponding analogue channel"
    );
}

#[test]
fn files_are_named_by_participant_and_condition() {
    assert_eq!(named("Sub_01_3ms.c3d"), Some((1, "3ms")));
    assert_eq!(named("Sub_19_3deg_down.c3d"), Some((19, "3deg_down")));
    assert_eq!(named("Excel file with EMG channels.xlsx"), None);
    assert_eq!((speed("278ms"), speed("5ms"), speed("3deg_up")), (Some(2.78), Some(5.0), None));
}

/// Steps of 0.35 s, of which a foot stands for 0.2 s; a muscle with a burst of 0.1 s in every second step, from 0.1 s on.
fn recording(seconds: f64) -> Vec<u8> {
    let samples = (seconds * RATE as f64) as usize;
    let each = |value: &dyn Fn(f64, usize) -> f64| {
        (0..samples).map(|place| value(place as f64 / RATE as f64, place)).collect::<Vec<f64>>()
    };
    let stands = |time: f64| time % 0.35 > 0.15;
    let is_first = |time: f64| time % 0.7 < 0.35;
    let first = each(&|time, _| if stands(time) && is_first(time) { -1500.0 } else { 0.0 });
    let second = each(&|time, _| if stands(time) && !is_first(time) { -1500.0 } else { 0.0 });
    // Noise of a hundred and a half hertz, louder in bursts; an offset that a high-pass takes away.
    let noise = |place: usize| if place % 8 < 4 { 1.0 } else { -1.0 };
    let burst = |time: f64| if (0.1..0.2).contains(&(time % 0.7)) { 1.0 } else { 0.05 };
    let muscle = each(&|time, place| 3.0 + 0.2 * burst(time) * noise(place));
    let quiet = each(&|_, place| 0.01 * noise(place));
    analog_file(RATE as f32, &[("Force.Fz1", first), ("Force.Fz2", second), ("EMG1", muscle), ("EMG2", quiet)])
}

#[test]
fn envelopes_are_made_of_raw_signals() {
    let pairs = vec![("Sol".to_owned(), 3), ("Tibialis".to_owned(), 4)];
    let person = read(&recording(7.1), &pairs).unwrap();
    assert_eq!(person.cycles, 9);
    let found = average(&[person]);
    assert_eq!(found.names, ["percent", "Sol", "Tibialis"]);
    let largest =
        |curve: &[f64]| curve.iter().copied().enumerate().fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best });
    let (place, height) = largest(&found.columns[1]);
    // Strikes are at 0.15 s, so the burst around 0.15 s is at the ends of the cycle of 0.7 s.
    assert!((height - 1.0).abs() < 1e-12 && (place <= 3 || place >= 97), "{place} {height}");
    assert!(found.columns[1][50] < 0.2, "{}", found.columns[1][50]);
    // The other muscle is equally quiet all the time.
    assert!(found.columns[2].iter().all(|value| *value > 0.9), "{:?}", found.columns[2]);
}

#[test]
fn recordings_without_cycles_or_channels_are_refused() {
    let message = |bytes: &[u8], pairs: &Channels| read(bytes, pairs).unwrap_err().to_string();
    let of = |number: usize| vec![("Sol".to_owned(), number)];
    assert_eq!(message(&recording(2.0), &of(9)), "has 4 analog channels, expected `Sol` in channel 9");
    assert_eq!(message(&recording(0.9), &of(3)), "has no two gait cycles: the forces have too few strikes");
    let slow = analog_file(100.0, &[("Fz1", vec![0.0; 100]), ("Fz2", vec![0.0; 100]), ("EMG", vec![0.0; 100])]);
    assert_eq!(message(&slow, &of(3)), "is damaged: its rate: electromyograms need more than 900 samples per second");
    let none = analog_file(2000.0, &[("EMG", vec![0.0; 100])]);
    assert_eq!(message(&none, &of(1)), "has no channels `Force.Fz1` and `Force.Fz2`");
}

#[test]
fn a_step_that_is_missed_does_not_mix_the_feet() {
    let mut strikes: Vec<usize> = (0..12).map(|step| 100 + 350 * step).collect();
    strikes.remove(4);
    // Of the stretches 0 to 3 and 5 to 11 the second is longer.
    assert_eq!(cycles(&strikes), [[1850, 2550], [2550, 3250], [3250, 3950]]);
    assert!(cycles(&[5]).is_empty());
}
