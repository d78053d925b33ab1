//! Weights in use: one whole version for each reader, the last good one if a newer is refused.

use crate::support;

use msk_compiler::task::{CompiledTask, Origin};
use msk_evaluate::Feed;
use msk_tuning::live::{Live, LiveError};
use msk_tuning::overlay::{Wish, edited, wished};
use msk_tuning::store::{Store, StoreError, Version};
use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex};
use support::trial;

struct Room {
    _folder: tempfile::TempDir,
    path: std::path::PathBuf,
    task: Arc<CompiledTask>,
    messages: Arc<Mutex<Vec<String>>>,
}

impl Room {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let task = trial(folder.path()).task;
        Self { path: folder.path().join("weights.toml"), _folder: folder, task, messages: Arc::default() }
    }

    fn open(&self, task: &Arc<CompiledTask>) -> Result<Live, LiveError> {
        let messages = self.messages.clone();
        Live::open(&self.path, vec![task.clone()], move |message| messages.lock().unwrap().push(message.to_owned()))
    }

    fn messages(&self) -> Vec<String> {
        self.messages.lock().unwrap().drain(..).collect()
    }
}

fn pose(live: &Live) -> f64 {
    live.current().tasks[0].1[0]
}

#[test]
fn a_new_version_is_taken_and_named_by_its_content() {
    let room = Room::new();
    fs::write(&room.path, "[lean]\npose = 11\n").unwrap();
    let live = room.open(&room.task).unwrap();
    assert_eq!(live.current().tasks, [("lean".to_owned(), vec![11.0, 5.0, -1.0, 2.0])]);
    let first = live.current().version.clone();
    assert_eq!(first, Version::of("[lean]\npose = 11\n").hash);
    fs::write(&room.path, "[lean]\npose = 12\n").unwrap();
    assert_eq!(pose(&live), 12.0);
    fs::write(&room.path, "[lean]\npose = 11\n").unwrap();
    assert_eq!(live.current().version, first, "the same content is the same version");
    assert_eq!(live.weights(&room.task).weights, [11.0, 5.0, -1.0, 2.0]);
    assert!(room.messages().is_empty());
}

#[test]
fn what_is_refused_is_reported_once_and_the_weights_stay() {
    let room = Room::new();
    fs::write(&room.path, "[lean]\npose = 11\n").unwrap();
    let live = room.open(&room.task).unwrap();
    for (text, code) in
        [("[lean]\npose = 31\n", "E0464"), ("[lean]\nwave = 3\n", "E0464"), ("[lean]\npose = ", "E0460"), ("[laen]\n", "E0462")]
    {
        fs::write(&room.path, text).unwrap();
        assert_eq!((pose(&live), pose(&live)), (11.0, 11.0));
        let messages = room.messages();
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].contains(code) && messages[0].contains("the weights stay at version"), "{messages:?}");
    }
    fs::remove_file(&room.path).unwrap();
    assert_eq!((pose(&live), pose(&live)), (11.0, 11.0));
    assert_eq!(room.messages().len(), 1);
    fs::write(&room.path, "[lean]\npose = 13\n").unwrap();
    assert_eq!(pose(&live), 13.0);
}

#[test]
fn it_cannot_begin_with_a_file_that_is_not_there_or_not_allowed() {
    let room = Room::new();
    assert!(matches!(room.open(&room.task), Err(LiveError::Missing(_))));
    fs::write(&room.path, "[lean]\npose = -1\n").unwrap();
    assert!(matches!(room.open(&room.task), Err(LiveError::Refused(_))));
}

#[test]
fn the_command_line_wins_over_every_version() {
    let room = Room::new();
    fs::write(&room.path, "[lean]\npose = 11\n").unwrap();
    let wish = [Wish { term: "lean.pose".into(), weight: 9.0 }];
    let task = wished(std::slice::from_ref(&room.task), &wish, &Origin::CommandLine).unwrap().tasks[0].clone();
    let live = room.open(&task).unwrap();
    fs::write(&room.path, "[lean]\npose = 12\nalive = 6\n").unwrap();
    assert_eq!(live.current().tasks[0].1[..2], [9.0, 6.0]);
}

#[test]
fn threads_never_go_back_to_an_older_version() {
    let room = Room::new();
    let write = |path: &Path, weight: f64| {
        Store::open(path)
            .unwrap()
            .change::<(), StoreError>("test", |now| Ok((edited(&now.text, &[("lean", "pose", weight)]).unwrap(), ())))
            .unwrap();
    };
    write(&room.path, 10.0);
    let live = room.open(&room.task).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let mut newest = 10.0;
                while newest < 20.0 {
                    let seen = pose(&live);
                    assert!(seen >= newest, "{seen} after {newest}");
                    newest = seen;
                }
            });
        }
        (1..=100).for_each(|step| write(&room.path, 10.0 + 0.1 * f64::from(step)));
    });
    assert!(room.messages().is_empty());
}
