//! Statistics and reasoners: what is asked, and what becomes of every kind of answer.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use msk_tuning::reasoner::{Http, Process, Reasoner, ReasonerError, ReplyError, Request, RuleBook, from_file, prompt, read};
use std::io::{Read, Write};
use std::net::TcpListener;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use support::{episodes, request, trial};

fn asked() -> Request {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    request(&trial, &episodes(&trial))
}

#[test]
fn statistics_tell_what_each_term_did() {
    let statistics = asked().statistics;
    assert_eq!((statistics.episodes, statistics.steps, statistics.success_rate), (4, 60, 0.5));
    assert_eq!(statistics.ended_by, [("horizon".to_owned(), 2), ("sunk".to_owned(), 2)]);
    let [pose, alive, effort, wave] = &statistics.terms[..] else { panic!("{statistics:?}") };
    let close = |found: Option<f64>, expected: f64| assert!((found.unwrap() - expected).abs() < 1e-9, "{found:?}, {expected}");
    // Worked by hand: 40 steps at 0.4 and 20 at 0.2.
    close(pose.mean, 1.0 / 3.0);
    close(pose.deviation, (0.4_f64 * 0.4 * 2.0 / 3.0 + 0.2 * 0.2 / 3.0 - 1.0 / 9.0).sqrt());
    close(pose.share, 200.0 / (200.0 + 300.0 + 6.0));
    close(pose.with_success, 1.0);
    close(pose.with_survival, 1.0);
    assert_eq!((alive.with_success, alive.saturated, alive.dead), (None, Some(1.0), Some(0.0)));
    assert!(effort.share.unwrap() < 0.0);
    assert_eq!((wave.dead, wave.range), (Some(1.0), [Some(0.0), Some(1.0)]));
    assert_eq!((statistics.metrics[0].metric.as_str(), statistics.metrics[0].unit.as_str()), ("pelvis.height", "m"));
}

#[test]
fn nothing_played_is_nothing_known() {
    let folder = tempfile::tempdir().unwrap();
    let trial = trial(folder.path());
    let statistics = request(&trial, &[]).statistics;
    assert_eq!((statistics.terms[0].mean, statistics.terms[0].share, statistics.survival), (None, None, None));
}

#[test]
fn the_prompt_holds_terms_with_ranges_bounds_and_units_and_wants_data_only() {
    let text = prompt(&Request { norm: Some(40.0), ..asked() });
    for part in [
        "- pose = exp(",
        "weight 10, allowed 5 to 30; value between 0.000005835 and 1",
        "weight 5, must stay above 0",
        "weight -1, must stay below 0",
        "weight 2, not to be changed",
        "pelvis.height [m]: mean 0.9000",
        "at most 20 % of its size",
        "must sum to 40",
        "Answer with data only",
        "No code",
    ] {
        assert!(text.contains(part), "no `{part}` in:\n{text}");
    }
}

#[test]
fn answers_are_read_strictly_but_words_around_them_are_forgiven() {
    let request = asked();
    let proposal =
        read("Sure!\n```json\n{\"weights\": {\"alive\": 4, \"pose\": 11.5}, \"reason\": \"more of it\"}\n```", &request).unwrap();
    assert_eq!(proposal.weights, [("pose".to_owned(), 11.5), ("alive".to_owned(), 4.0)]);
    assert_eq!(proposal.reason, "more of it");
    assert_eq!(read("{\"pose\": 11}", &request).unwrap().weights, [("pose".to_owned(), 11.0)]);
    let wrong = |text: &str| read(text, &request).unwrap_err().to_string();
    assert!(wrong("pose = 12").contains("expected one JSON object"));
    assert!(wrong("{\"weights\": {\"pose\": 11.5, \"ali").contains("ends in the middle"));
    assert!(wrong("{\"psoe\": 11}").contains("did you mean `pose`?"));
    assert!(wrong("{\"pose\": \"lots\"}").contains("expected a finite number for `pose`, found \"lots\""));
    assert!(wrong("{\"pose\": 1e999}").contains("JSON"));
}

#[test]
fn the_built_in_rules_emphasise_what_is_deficient() {
    let request = asked();
    let proposal = RuleBook.propose(&request, &AtomicBool::new(false)).unwrap();
    assert_eq!(proposal, RuleBook.propose(&request, &AtomicBool::new(false)).unwrap());
    let weight = |term: &str| proposal.weights.iter().find(|(name, _)| name == term).map(|(_, weight)| *weight);
    // Mean a third of what it could be, and in successful episodes more: up by the whole step.
    let pose = weight("pose").unwrap();
    assert!(pose > 11.0 && pose <= 12.0, "{pose}");
    // Always fully paid: down by half a step.
    assert_eq!(weight("alive"), Some(4.5));
    // Dead and fixed: no weight helps.
    assert_eq!(weight("wave"), None);
    assert!(proposal.reason.contains("pose up: it is deficient"), "{}", proposal.reason);
}

/// The paper's examples: too slow, so pay more for the speed that is wanted; hunched, so pay more for being upright.
#[test]
fn the_papers_examples_come_out() {
    let mut request = asked();
    let terms = &mut request.statistics.terms;
    terms.truncate(3);
    for (term, (name, weight, mean)) in
        terms.iter_mut().zip([("tracking_vel", 10.0, 0.2), ("upright_reward", 6.0, 0.9), ("anti_hunch", 8.0, 0.3)])
    {
        (term.term, term.weight, term.mean, term.in_scope) = (name.into(), weight, Some(mean), true);
        term.range = [Some(0.0), Some(1.0)];
        (term.share, term.saturated, term.dead, term.with_success, term.with_survival) =
            (Some(0.3), Some(0.0), Some(0.0), None, None);
        term.bounds = msk_tuning::statistics::Allowed::SameSign;
    }
    let proposal = RuleBook.propose(&request, &AtomicBool::new(false)).unwrap();
    let up = |weight: f64, mean: f64| weight * (1.0 + 0.2 * (1.0 - mean));
    assert_eq!(proposal.weights, [("tracking_vel".to_owned(), up(10.0, 0.2)), ("anti_hunch".to_owned(), up(8.0, 0.3))]);
}

/// What a server does with a question.
type Answering = fn(&mut std::net::TcpStream);

/// Answers one connection after the other as told, and keeps what was asked.
fn server(answers: Vec<Answering>) -> (String, Arc<Mutex<Vec<String>>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}/v1", listener.local_addr().unwrap());
    let heard = Arc::new(Mutex::new(Vec::new()));
    let notes = heard.clone();
    std::thread::spawn(move || {
        for answer in answers {
            let (mut stream, _) = listener.accept().unwrap();
            let notes = notes.clone();
            // A thread for each, so that a late answer does not hold up the next.
            std::thread::spawn(move || {
                let heard = hear(&mut stream);
                notes.lock().unwrap().push(heard);
                answer(&mut stream);
            });
        }
        // Further connections stay without an answer while the test lasts.
        std::thread::sleep(Duration::from_secs(60));
        drop(listener);
    });
    (url, heard)
}

/// A whole question.
fn hear(stream: &mut std::net::TcpStream) -> String {
    let (mut bytes, mut part) = (Vec::new(), [0; 4096]);
    loop {
        let count = stream.read(&mut part).unwrap_or(0);
        bytes.extend_from_slice(&part[..count]);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let lower = text.to_lowercase();
        let length = lower.split("content-length: ").nth(1).and_then(|rest| rest.lines().next()?.trim().parse().ok());
        let body = text.find("\r\n\r\n").map(|at| bytes.len() - at - 4);
        if count == 0 || (body.is_some() && body >= length) {
            return text;
        }
    }
}

fn send(stream: &mut std::net::TcpStream, status: &str, body: &str) {
    let head = format!(
        "HTTP/1.1 {status}\r\ncontent-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n",
        body.len()
    );
    let _ = stream.write_all((head + body).as_bytes());
}

fn chat(content: &str) -> String {
    serde_json::json!({ "model": "thinker-2", "choices": [{ "message": { "role": "assistant", "content": content } }] })
        .to_string()
}

fn well(stream: &mut std::net::TcpStream) {
    send(stream, "200 OK", &chat("{\"weights\": {\"pose\": 11.5}, \"reason\": \"it is low\"}"));
}
fn late(stream: &mut std::net::TcpStream) {
    std::thread::sleep(Duration::from_secs(8));
    well(stream);
}
fn wrong(stream: &mut std::net::TcpStream) {
    send(stream, "200 OK", &chat("def reward(state): return 1"));
}
fn half(stream: &mut std::net::TcpStream) {
    let body = chat("{\"weights\": {\"pose\": 11.5}}");
    let head = format!("HTTP/1.1 200 OK\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n", body.len());
    let _ = stream.write_all((head + &body[..body.len() / 2]).as_bytes());
}
fn nothing(_: &mut std::net::TcpStream) {}
fn busy(stream: &mut std::net::TcpStream) {
    send(stream, "429 Too Many Requests", "slow down");
}
fn refused(stream: &mut std::net::TcpStream) {
    send(stream, "401 Unauthorized", "the key sk-very-secret is not valid");
}
fn elsewhere(stream: &mut std::net::TcpStream) {
    let _ = stream
        .write_all(b"HTTP/1.1 302 Found\r\nlocation: http://example.invalid/\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
}

const KEY: &str = "sk-very-secret";

fn http(url: &str, attempts: u32) -> Http {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("reasoner.toml");
    let text = "kind = \"http\"\nurl = \"https://unused.invalid\"\nmodel = \"m\"\nkey_variable = \"THE_KEY\"\n";
    std::fs::write(&file, text).unwrap();
    assert!(from_file(&file, |name| (name == "THE_KEY").then(|| KEY.into())).is_ok());
    let key = msk_tuning::reasoner::Secret::new(KEY);
    Http::new(url, "thinker", Some(key), Duration::from_secs(4), attempts).unwrap().pause(Duration::from_millis(10))
}

fn propose(reasoner: &dyn Reasoner, request: &Request) -> Result<msk_tuning::reasoner::Proposal, ReasonerError> {
    reasoner.propose(request, &AtomicBool::new(false))
}

#[test]
fn a_server_that_answers_well_is_heard() {
    let (url, heard) = server(vec![well]);
    let proposal = propose(&http(&url, 1), &asked()).unwrap();
    assert_eq!((proposal.weights, proposal.by.as_str()), (vec![("pose".to_owned(), 11.5)], "thinker-2"));
    let heard = heard.lock().unwrap()[0].clone();
    assert!(heard.starts_with("POST /v1/chat/completions HTTP/1.1"), "{heard}");
    assert!(heard.to_lowercase().contains("authorization: bearer sk-very-secret"));
    let body: serde_json::Value = serde_json::from_str(heard.split("\r\n\r\n").nth(1).unwrap()).unwrap();
    assert_eq!((body["model"].as_str(), body["temperature"].as_f64()), (Some("thinker"), Some(0.2)));
    assert!(body["messages"][0]["content"].as_str().unwrap().contains("Answer with data only"));
}

#[test]
fn late_wrong_half_busy_and_missing_answers_are_asked_for_again() {
    let (url, heard) = server(vec![late, wrong, half, nothing, busy, well]);
    let proposal = propose(&http(&url, 6), &asked()).unwrap();
    assert_eq!(proposal.weights, [("pose".to_owned(), 11.5)]);
    assert_eq!(heard.lock().unwrap().len(), 6);
}

#[test]
fn every_failure_says_what_it_was_and_none_shows_the_key() {
    let request = asked();
    let cases: [(Answering, &str); 7] = [
        (late, "timeout"),
        (wrong, "is no proposal"),
        (half, "no answer after 1"),
        (nothing, "no answer after 1"),
        (busy, "status 429"),
        (refused, "status 401: the key (key) is not valid"),
        (elsewhere, "status 302"),
    ];
    for (answer, expected) in cases {
        let (url, _) = server(vec![answer]);
        let reasoner = http(&url, 1);
        let error = propose(&reasoner, &request).unwrap_err();
        let told = format!("{error} {error:?} {reasoner:?}");
        assert!(told.to_lowercase().contains(expected), "no `{expected}` in {told}");
        assert!(!told.contains(KEY), "{told}");
    }
    // Nobody there at all.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let error = propose(&http(&format!("http://127.0.0.1:{port}/v1"), 2), &request).unwrap_err().to_string();
    assert!(error.contains("no answer after 2 attempt(s)"), "{error}");
}

#[test]
fn a_refusal_is_not_asked_again() {
    let (url, heard) = server(vec![refused, well]);
    assert!(matches!(propose(&http(&url, 5), &asked()), Err(ReasonerError::Refuses(_))));
    assert_eq!(heard.lock().unwrap().len(), 1);
}

#[test]
fn a_key_travels_under_cover_only() {
    let key = || Some(msk_tuning::reasoner::Secret::new(KEY));
    let new = |url: &str, key| Http::new(url, "m", key, Duration::from_secs(1), 1).map(|_| ());
    assert!(new("http://example.org/v1", key()).unwrap_err().contains("https only"));
    assert!(new("http://localhost.example.org/v1", key()).is_err());
    assert!(new("https://name:word@example.org/v1", None).unwrap_err().contains("environment"));
    assert!(new("ftp://example.org", None).is_err() && new("example.org", None).is_err());
    assert!(new("https://example.org/v1", key()).is_ok() && new("http://[::1]:8080", key()).is_ok());
}

fn process(script: &str, limit: Duration) -> Process {
    Process { command: vec!["sh".into(), "-c".into(), script.into()], limit }
}

#[cfg(unix)]
#[test]
fn a_program_answers_or_its_failure_is_told() {
    let (request, long) = (asked(), Duration::from_secs(60));
    let proposal = propose(&process("grep -q '\"task\":\"lean\"' && echo '{\"pose\": 11}'", long), &request).unwrap();
    assert_eq!(proposal.weights, [("pose".to_owned(), 11.0)]);
    let told = |script: &str| propose(&process(script, long), &request).unwrap_err().to_string();
    assert!(told("echo 'no idea' >&2; exit 3").contains("it ended with code 3: no idea"));
    assert!(told("echo '{\"pose\": '").contains("ends in the middle"));
    assert!(told("true").contains("there is none"));
    let missing = Process { command: vec!["./none-of-that-name".into()], limit: long };
    assert!(matches!(propose(&missing, &request), Err(ReasonerError::Refuses(_))));
}

#[cfg(unix)]
#[test]
fn a_program_that_never_ends_is_ended() {
    let begin = Instant::now();
    let error = propose(&process("exec sleep 100", Duration::from_millis(200)), &asked()).unwrap_err().to_string();
    assert!(error.contains("no answer within 0.2 s"), "{error}");
    assert!(begin.elapsed() < Duration::from_secs(50));
    let stopped = process("exec sleep 100", Duration::from_secs(60)).propose(&asked(), &AtomicBool::new(true));
    assert!(matches!(stopped, Err(ReasonerError::Interrupted)));
}

#[test]
fn settings_that_make_no_sense_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("reasoner.toml");
    let told = |text: &str| {
        std::fs::write(&file, text).unwrap();
        from_file(&file, |_| None).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert!(told("kind = \"oracle\"").contains("unknown variant `oracle`"));
    assert!(told("kind = \"http\"\nurl = \"https://h\"").contains("missing field `model`"));
    assert!(told("kind = \"http\"\nurl = \"https://h\"\nmodel = \"m\"\nkey = \"sk\"").contains("unknown field `key`"));
    assert!(told("kind = \"http\"\nurl = \"https://h\"\nmodel = \"m\"\nkey_variable = \"K\"").contains("variable `K`"));
    assert!(told("kind = \"process\"\ncommand = []").contains("`command` is empty"));
    assert!(told("kind = \"process\"\ncommand = [\"a\"]\ntimeout_s = -1").contains("timeout_s"));
    assert_eq!(told("kind = \"rules\""), "");
    assert!(matches!(read("{", &asked()), Err(ReplyError::NoObject(_))));
}
