//! Numbers on the command line: none of them makes a command panic, hang or go on with something that was not asked for.

use super::project::Project;

/// What no option takes.
const NONE: [&str; 8] = ["nan", "inf", "-inf", "1e308", "-1e308", "1e999", "", "many"];

/// Every option that takes a number with decimals, in commands that would need nothing else, and what it is then said to be.
const OPTIONS: [(&[&str], &str, &str); 13] = [
    (&["motion", "check", "walk.msk"], "--sliding", "is not a number from 0 to 1000000"),
    (&["mutate"], "--max-survivors", "is not a number from 0 to 100"),
    (&["mutate", "--include-scene"], "--max-scene-survivors", "is not a number from 0 to 100"),
    (&["physics", "bench"], "--seconds", "is not a number from 0 to 86400"),
    (&["draw"], "--activation", "is not a number from 0 to 1"),
    (&["tune", "lean"], "--step", "is not a number from 0.000001 to 1"),
    (&["tune", "lean"], "--norm", "is not a number from 0.000001 to 1000000000000"),
    (&["weights", "normalize", "lean.msk"], "--norm", "is not a number from 0.000001 to 1000000000000"),
    (&["session", "init", "lean", "folder"], "--hold", "is not a number from 0.000001 to 1000000"),
    (&["run", "lean"], "--policy-timeout", "is not a number from 0.001 to 3600"),
    (&["run", "lean", "--png", "a.png"], "--at", "is no time"),
    (&["train", "lean"], "--budget", "is no time"),
    (&["exploit", "lean"], "--budget", "is not a budget"),
];

#[test]
fn a_number_that_makes_no_sense_is_refused_with_what_it_may_be() {
    let project = Project::empty();
    for (command, option, expected) in OPTIONS {
        for number in NONE {
            let unit = if option == "--budget" { "s" } else { "" };
            let option = format!("{option}={number}{unit}");
            let command: Vec<&str> = command.iter().copied().chain([option.as_str()]).collect();
            project.msk(&command).failed(2, &[expected]);
        }
    }
}

#[test]
fn a_factor_that_makes_no_sense_is_refused() {
    for factor in NONE {
        Project::empty()
            .msk(&["weights", "scale", "lean.msk", "--", factor])
            .failed(2, &["is not a number from -1000000000 to 1000000000"]);
    }
}
