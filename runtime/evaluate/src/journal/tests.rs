//! What a journal keeps, refuses, and survives.

use super::*;
use crate::desk::Desk;
use crate::{Protocol, Shard, Summarizer, TaskSettings};
use msk_runtime::condition::{Fatigue, MuscleCondition};
use msk_storage::{FailAt, Failure};
use std::fs;
use std::sync::Arc;

pub(crate) fn settings(seed: u64) -> RunSettings {
    let task = TaskSettings {
        name: "stand".into(),
        family: String::new(),
        hash: "a".into(),
        model_hash: "b".into(),
        condition: Default::default(),
        perturbation: String::new(),
        horizon: 10,
        weights: vec![],
        overlaid: vec![],
    };
    RunSettings {
        version: "1".into(),
        build: "2".into(),
        policy: "zero".into(),
        protocol: Protocol { episodes: 3, seed },
        tasks: vec![task],
        shard: Shard::WHOLE,
        live: None,
    }
}

pub(crate) fn record(episode: u64) -> EpisodeRecord {
    let line = format!(
        r#"{{"task":"stand","policy":"zero","seed":0,"episode":{episode},"success":true,"terminated_by":[],"truncated":true,
        "fault":null,"steps":10,"return":1.5,"terms":{{}},"values":{{}},"task_hash":"a","model_hash":"b"}}"#
    );
    serde_json::from_str(&line).unwrap()
}

#[test]
fn the_same_run_is_continued() {
    let folder = tempfile::tempdir().unwrap();
    let (journal, before) = Journal::open(folder.path(), &settings(0)).unwrap();
    assert!(before.is_empty());
    journal.append(&record(2)).unwrap();
    drop(journal);
    let (journal, before) = Journal::open(folder.path(), &settings(0)).unwrap();
    assert_eq!(before, [record(2)]);
    journal.append(&record(0)).unwrap();
    drop(journal);
    assert_eq!(Journal::open(folder.path(), &settings(0)).unwrap().1, [record(2), record(0)]);
}

#[test]
fn another_run_is_refused_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    Journal::open(folder.path(), &settings(0)).unwrap().0.append(&record(0)).unwrap();
    let error = Journal::open(folder.path(), &settings(1)).unwrap_err().to_string();
    assert!(error.ends_with("contains another run: its seed is 0, not 1"), "{error}");
    assert_eq!(Journal::open(folder.path(), &settings(0)).unwrap().1, [record(0)]);
}

#[test]
fn a_line_that_was_cut_short_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    Journal::open(folder.path(), &settings(0)).unwrap().0.append(&record(0)).unwrap();
    let path = folder.path().join(EPISODES);
    let whole = fs::read_to_string(&path).unwrap();
    fs::write(&path, whole.clone() + &whole[..40]).unwrap();
    let (journal, before) = Journal::open(folder.path(), &settings(0)).unwrap();
    assert_eq!(before, [record(0)]);
    journal.append(&record(1)).unwrap();
    drop(journal);
    assert_eq!(Journal::open(folder.path(), &settings(0)).unwrap().1, [record(0), record(1)]);
}

#[test]
fn damage_is_reported_with_its_line_and_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    Journal::open(folder.path(), &settings(0)).unwrap().0.append(&record(0)).unwrap();
    let path = folder.path().join(EPISODES);
    let damaged = fs::read_to_string(&path).unwrap() + "{\"task\":\n";
    fs::write(&path, &damaged).unwrap();
    let error = Journal::open(folder.path(), &settings(0)).unwrap_err();
    assert!(matches!(error, JournalError::Damaged { line: 2, .. }), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), damaged);
}

#[test]
fn one_process_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let first = Journal::open(folder.path(), &settings(0)).unwrap();
    assert!(matches!(Journal::open(folder.path(), &settings(0)), Err(JournalError::Busy { .. })));
    drop(first);
    assert!(Journal::open(folder.path(), &settings(0)).is_ok());
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let error = Journal::open(&file.join("results"), &settings(0)).unwrap_err();
    assert!(matches!(error, JournalError::Unusable { .. }), "{error}");
}

/// The journal of a run of three episodes, and its lines.
fn three_episodes() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let (journal, _) = Journal::open(folder.path(), &settings(0)).unwrap();
    (0..3).for_each(|episode| journal.append(&record(episode)).unwrap());
    let lines = fs::read_to_string(folder.path().join(EPISODES)).unwrap();
    (folder, lines)
}

/// The error of a journal whose lines are replaced.
fn refusal(folder: &Path, lines: &str) -> String {
    fs::write(folder.join(EPISODES), lines).unwrap();
    let error = Journal::open(folder, &settings(0)).unwrap_err().to_string();
    assert_eq!(fs::read_to_string(folder.join(EPISODES)).unwrap(), lines, "what is refused stays as it is");
    assert_eq!(Journal::records(folder).unwrap_err().to_string(), error);
    error
}

#[test]
fn an_edited_line_is_noticed() {
    let (folder, lines) = three_episodes();
    for (before, after) in
        [("\"return\":1.5", "\"return\":9.5"), ("\"success\":true", "\"success\":false"), ("\"steps\":10", "\"steps\":11")]
    {
        assert!(lines.contains(before), "{lines}");
        let error = refusal(folder.path(), &lines.replacen(before, after, 1));
        assert!(error.contains("line 1") && error.contains("its checksum does not match its content"), "{error}");
    }
    // Behind the checksum earlier programs wrote a time, and nothing else counts there.
    let (first, rest) = lines.split_once('\n').unwrap();
    let with = |tail: &str| format!("{}{tail}\n{rest}", first.strip_suffix('}').unwrap());
    fs::write(folder.path().join(EPISODES), with(",\"wall_time\":1.5}")).unwrap();
    assert_eq!(Journal::records(folder.path()).unwrap().len(), 3);
    for tail in [",\"wall_time\":1,\"finished_by\":[\"arrived\"]}", ",\"wall_time\":1,\"other\":1}", ",\"awaited\":\"x\"}"] {
        let error = refusal(folder.path(), &with(tail));
        assert!(error.contains("its checksum does not match its content"), "{error}");
    }
    let bare = lines.replacen(",\"checksum\"", ",\"other\"", 1);
    assert!(refusal(folder.path(), &bare).contains("it has no checksum"));
}

#[test]
fn a_journal_without_its_settings_is_not_taken_over() {
    let (folder, lines) = three_episodes();
    fs::remove_file(folder.path().join(SETTINGS)).unwrap();
    for seed in [0, 7] {
        let error = Journal::open(folder.path(), &settings(seed)).unwrap_err();
        assert!(matches!(error, JournalError::Unclaimed { .. }), "{error}");
    }
    assert!(!folder.path().join(SETTINGS).exists());
    assert_eq!(fs::read_to_string(folder.path().join(EPISODES)).unwrap(), lines);
}

#[test]
fn episodes_of_another_run_do_not_count_whatever_the_settings_say() {
    let (folder, lines) = three_episodes();
    type Change<'a> = &'a dyn Fn(&mut RunSettings);
    let others: [(Change<'_>, &str); 6] = [
        (&|s| s.protocol.seed = 7, "its seed is 0, not 7"),
        (&|s| s.policy = "random".into(), "its policy is zero, not random"),
        (&|s| s.tasks[0].hash = "c".into(), "no task of the run is its `stand`"),
        (&|s| s.tasks[0].model_hash = "c".into(), "no task of the run is its `stand`"),
        (&|s| s.protocol.episodes = 2, "it belongs to run"),
        (&|s| s.build = "3".into(), "it belongs to run"),
    ];
    for (change, reason) in others {
        let mut other = settings(0);
        change(&mut other);
        // As somebody would who wants the episodes to be of another run.
        fs::write(folder.path().join(SETTINGS), pretty(&other)).unwrap();
        let error = Journal::open(folder.path(), &other).unwrap_err();
        assert!(matches!(error, JournalError::Foreign { line: 1, .. }) && error.to_string().contains(reason), "{error}");
        let error = Journal::records(folder.path()).unwrap_err();
        assert!(matches!(error, JournalError::Foreign { line: 1, .. }), "{error}");
    }
    assert_eq!(fs::read_to_string(folder.path().join(EPISODES)).unwrap(), lines);
}

#[test]
fn lines_that_a_run_cannot_have_are_refused() {
    let (folder, lines) = three_episodes();
    let run = settings(0).identity();
    let more = |record: EpisodeRecord| refusal(folder.path(), &format!("{lines}{}\n", Line::written(&record, &run)));
    assert!(more(record(3)).contains("line 4, belongs to another run than `run.json` beside it: it is episode 3 of a run of 3"));
    assert!(more(record(1)).contains("line 4, was modified: episode 1 of `stand` already exists"));
    let fatigue = MuscleCondition { fatigue: Some(Fatigue::default()), ..MuscleCondition::default() };
    let error = more(EpisodeRecord { condition: fatigue, ..record(0) });
    assert!(error.contains("no task of the run is its `stand` with muscles in the condition `fatigue`"), "{error}");
}

#[test]
fn one_task_under_two_conditions_keeps_both() {
    let fatigue = MuscleCondition { fatigue: Some(Fatigue::default()), ..MuscleCondition::default() };
    let mut both = settings(0);
    both.tasks.push(TaskSettings { condition: fatigue.clone(), model_hash: "d".into(), ..both.tasks[0].clone() });
    let tired = EpisodeRecord { condition: fatigue, model_hash: "d".into(), ..record(0) };
    let folder = tempfile::tempdir().unwrap();
    let (journal, _) = Journal::open(folder.path(), &both).unwrap();
    journal.append(&tired).unwrap();
    journal.append(&record(0)).unwrap();
    drop(journal);
    let (mut records, folder) = (Vec::new(), Folder::open(folder.path()).unwrap());
    let (_journal, kept) = Journal::open_with(folder, &both, &mut |record| records.push(record)).unwrap();
    assert_eq!(records, [tired, record(0)]);
    for (job, there) in [((0, 0), true), ((0, 1), false), ((1, 0), true), ((1, 2), false)] {
        assert_eq!(kept.done.contains(job), there, "{job:?}");
    }
}

/// Plays the episodes that are not there already, which end in the order of `ends`, and sums up.
fn attempt(folder: Folder, ends: [u64; 3]) -> Result<(), JournalError> {
    let mut summarizer = Summarizer::of(settings(0), vec![vec![]]);
    let (journal, kept) = Journal::open_with(folder, &settings(0), &mut |record| summarizer.add(&record))?;
    let mut desk = Desk::new(&journal, (1, 3), Shard::WHOLE, kept, summarizer);
    desk.enter()?;
    let claimed: Vec<u64> = std::iter::from_fn(|| desk.claim().job()).map(|(_, episode)| episode).collect();
    for episode in ends.into_iter().filter(|episode| claimed.contains(episode)) {
        desk.keep((0, episode), record(episode))?;
    }
    journal.complete()?;
    journal.write("summary.json", desk.outcome().summary.json())
}

#[test]
fn whichever_call_fails_the_run_is_continued_to_the_same_bytes() {
    let contents = |folder: &Path| {
        assert!(!folder.join(EARLY).exists(), "what was held is gone");
        [SETTINGS, EPISODES, "summary.json"].map(|name| fs::read(folder.join(name)).unwrap())
    };
    let mut one = None;
    for ends in [[0, 1, 2], [2, 1, 0], [1, 2, 0], [2, 0, 1]] {
        let (undisturbed, calls) = {
            let place = tempfile::tempdir().unwrap();
            let faults = Arc::new(FailAt::never());
            attempt(Folder::open(place.path()).unwrap().with_faults(faults.clone()), ends).unwrap();
            (contents(place.path()), faults.calls())
        };
        assert!(calls > 12, "only {calls} calls are made");
        assert_eq!(one.get_or_insert_with(|| undisturbed.clone()), &undisturbed, "{ends:?}");
        for failure in [Failure::StorageFull, Failure::Device, Failure::Crash] {
            for call in 0..calls {
                let place = tempfile::tempdir().unwrap();
                let folder = Folder::open(place.path()).unwrap();
                let faults = Arc::new(FailAt::new(call, failure));
                let error = attempt(folder.clone().with_faults(faults), ends).unwrap_err();
                assert!(matches!(error, JournalError::Unusable { .. }), "{failure:?} at call {call}: {error}");
                attempt(folder, [0, 2, 1]).unwrap_or_else(|error| panic!("{failure:?} at call {call}: {error}"));
                assert_eq!(contents(place.path()), undisturbed, "{failure:?} at call {call} of {ends:?}");
            }
        }
    }
}

#[test]
fn what_ended_early_survives_the_program_and_damage_of_it_does_not_matter() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::open(place.path()).unwrap();
    let open = || Journal::open_with(folder.clone(), &settings(0), &mut |_| {}).unwrap();
    let (journal, _) = open();
    journal.hold(&record(2)).unwrap();
    journal.hold(&record(1)).unwrap();
    drop(journal);
    let early = place.path().join(EARLY);
    let text = fs::read_to_string(&early).unwrap();
    let episodes = |kept: &Kept| kept.early.keys().map(|(_, episode)| *episode).collect::<Vec<_>>();
    assert_eq!(episodes(&open().1), [1, 2]);
    // A power cut may leave anything of lines that were not waited for.
    let first = text.lines().next().unwrap();
    for (left, expected) in
        [(format!("{first}\n\0\0\0\n"), vec![2]), (first[..40].to_owned(), vec![]), (text.replace("1.5", "2.5"), vec![])]
    {
        fs::write(&early, left).unwrap();
        assert_eq!(episodes(&open().1), expected);
    }
    // One that has its line by now is not due again.
    fs::write(&early, text).unwrap();
    let (journal, _) = open();
    journal.append(&record(2)).unwrap();
    drop(journal);
    assert_eq!(episodes(&open().1), [1]);
    assert_eq!(Journal::records(place.path()).unwrap(), [record(2)]);
}

#[test]
fn wall_times_stand_in_a_file_of_their_own() {
    let place = tempfile::tempdir().unwrap();
    let (journal, _) = Journal::open(place.path(), &settings(0)).unwrap();
    journal.append(&EpisodeRecord { wall_time: 0.25, ..record(1) }).unwrap();
    let read = |name: &str| fs::read_to_string(place.path().join(name)).unwrap();
    assert!(!read(EPISODES).contains("wall_time"));
    assert_eq!(read(WALL_TIMES), "{\"episode\":1,\"task\":\"stand\",\"wall_time\":0.25}\n");
}

#[test]
fn lines_of_earlier_programs_with_wall_times_are_read() {
    let (folder, lines) = three_episodes();
    let earlier = lines.replace("\"}\n", "\",\"wall_time\":0.25}\n");
    assert_ne!(earlier, lines);
    fs::write(folder.path().join(EPISODES), earlier).unwrap();
    let records = Journal::records(folder.path()).unwrap();
    assert!(records.len() == 3 && records.iter().zip(0..).all(|(found, episode)| found.same_as(&record(episode))));
    assert_eq!(records[0].wall_time, 0.25);
}

#[test]
fn an_episode_that_could_not_be_kept_leaves_no_trace() {
    // Each append makes some calls; wherever they fail and can be repaired, the next episode is kept.
    for call in 0..12 {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        drop(Journal::open_in(folder.clone(), &settings(0)).unwrap());
        let faults = Arc::new(FailAt::new(call, Failure::StorageFull));
        let Ok((journal, _)) = Journal::open_in(folder.clone().with_faults(faults), &settings(0)) else { continue };
        let kept: Vec<u64> = (0..3).filter(|episode| journal.append(&record(*episode)).is_ok()).collect();
        drop(journal);
        let found: Vec<u64> = Journal::records(place.path()).unwrap().iter().map(|record| record.episode).collect();
        assert_eq!(found, kept, "call {call}");
        assert!(kept.len() >= 2, "call {call}");
    }
}

#[cfg(unix)]
#[test]
fn a_read_only_file_of_results_is_not_replaced() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (journal, _) = Journal::open(folder.path(), &settings(0)).unwrap();
    let path = folder.path().join("summary.json");
    journal.write("summary.json", "mine").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    journal.write("summary.json", "yours").unwrap();
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    assert!(journal.write("summary.json", "theirs").is_err());
    assert_eq!(fs::read_to_string(&path).unwrap(), "yours");
}
