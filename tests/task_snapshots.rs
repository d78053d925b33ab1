//! What the benchmark's tasks mean, term by term: a change that shows in no snapshot changes no meaning.
//!
//! After a change that is meant: `INSTA_UPDATE=always cargo test --test suite task_snapshots`, then read the difference.

use std::collections::BTreeSet;
use std::path::Path;

/// A test for each task, by family.
macro_rules! snapshots {
    ($($family:ident: $($task:ident)*;)*) => {
        $(mod $family {
            $(#[test]
            fn $task() {
                let file = concat!("tasks/", stringify!($family), "/", stringify!($task), ".msk");
                msk::assert_task_snapshot!(file, stringify!($task));
            })*
        })*

        /// Family and name of each.
        const ALL: &[(&str, &str)] = &[$($((stringify!($family), stringify!($task)),)*)*];
    };
}

snapshots! {
    stabilization: stand powerlift single_leg_stand sit balance squat;
    locomotion: walk crawl run jump walk_turn sidestep;
    interaction: stairs hurdle step_stones slide open_door reach walk_and_sit chin_up catch pole_walk;
}

#[test]
fn every_task_has_its_snapshot() {
    let tasks = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks");
    let mut found = BTreeSet::new();
    for family in ["stabilization", "locomotion", "interaction"] {
        let Ok(folder) = std::fs::read_dir(tasks.join(family)) else { panic!("there is no folder tasks/{family}") };
        for file in folder.flatten() {
            let name = file.file_name().to_string_lossy().trim_end_matches(".msk").to_owned();
            found.insert((family, name));
        }
    }
    let held: BTreeSet<(&str, String)> = ALL.iter().map(|(family, task)| (*family, (*task).to_owned())).collect();
    assert_eq!(found, held);
}
