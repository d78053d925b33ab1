use super::super::average;
use super::*;

/// Cycles 1, 2 and 6 of `tests/oracle/recordings.py`: n + t, and n (1 - t), for t from 0 to 1.
const PROCESSED: &[u8] = include_bytes!("processed.mat");
const CONVERTED: &[u8] = include_bytes!("converted.mat");

#[test]
fn cycles_of_available_trials_are_averaged() {
    let person = read(PROCESSED, "LevelWalking").unwrap();
    assert_eq!((&person, person.cycles), (&read(CONVERTED, "LevelWalking").unwrap(), 3));
    let found = average(&[person]);
    assert_eq!(found.names, ["percent", "VastusLateralis", "GastrocnemuisMedialis"]);
    for point in [0, 40, 100] {
        let part = point as f64 / 100.0;
        assert_eq!(found.columns[0][point], point as f64);
        assert!(
            (found.columns[1][point] - (3.0 + part)).abs() < 1e-12
                && (found.columns[2][point] - 3.0 * (1.0 - part)).abs() < 1e-12
        );
    }
}

#[test]
fn people_count_the_same_however_many_cycles_they_have() {
    let cycle = |level: f64| vec![level; 101];
    let mut one = Participant::default();
    [1.0, 3.0].into_iter().for_each(|level| one.add(vec![("a", &cycle(level)), ("b", &cycle(5.0))]).unwrap());
    let mut other = Participant::default();
    other.add(vec![("a", &[8.0, 8.0, 8.0])]).unwrap();
    let found = average(&[one.clone(), other, Participant::default()]);
    assert_eq!(
        (found.names.as_slice(), found.columns[1][50], found.columns[2][50]),
        (&["percent", "a", "b"].map(String::from)[..], 5.0, 5.0)
    );
    assert_eq!(
        one.clone().add(vec![("b", &cycle(1.0)), ("a", &cycle(1.0))]).unwrap_err().to_string(),
        "is damaged: a cycle: it has other channels than the cycle before"
    );
    assert!(one.add(vec![("a", &[f64::NAN; 101]), ("b", &cycle(1.0))]).unwrap_err().to_string().contains("not finite"));
}

#[test]
fn a_movement_that_is_not_there_is_named() {
    let message = |movement: &str| read(PROCESSED, movement).unwrap_err().to_string();
    assert_eq!(message("StairAscent"), "has no variable `StairAscent`; it has LevelWalking");
}
