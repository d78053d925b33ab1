//! Statistics and reasoners: what is asked, and what becomes of every kind of answer.

use crate::support;

use msk_tuning::reasoner::{
    Http, Process, Proposal, Reasoner, ReasonerError, ReplyError, Request, RuleBook, Secret, Secrets, from_file, prompt, read,
};
use std::io::{Read, Write};
use std::net::TcpListener;
use std::sync::atomic::{AtomicBool, Ordering};
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
        "weight 10, allowed 5 to 30; value between 5.835e-6 and 1",
        "weight 5, must stay above 0",
        "weight -1, must stay below 0",
        "weight 2, not to be changed",
        "pelvis.height [m]: mean 0.9",
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
    let proposal = read(
        "Sure!\n```json\n{\"weights\": {\"alive\": 4, \"pose\": 11.5}, \"reason\": \"more of it\"}\n```",
        &request,
        &Secrets::default(),
    )
    .unwrap();
    assert_eq!(proposal.weights, [("pose".to_owned(), 11.5), ("alive".to_owned(), 4.0)]);
    assert_eq!(proposal.reason, "more of it");
    assert_eq!(read("{\"pose\": 11}", &request, &Secrets::default()).unwrap().weights, [("pose".to_owned(), 11.0)]);
    let wrong = |text: &str| read(text, &request, &Secrets::default()).unwrap_err().to_string();
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
    // Always saturated: down by half a step.
    assert_eq!(weight("alive"), Some(4.5));
    // Dead and fixed: no weight helps.
    assert_eq!(weight("wave"), None);
    assert!(proposal.reason.contains("pose up: it has low values"), "{}", proposal.reason);
}

/// The paper's examples: too slow, so reward the wanted speed more; hunched, so reward being upright more.
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

/// Answers one connection after the other with the given answers, and keeps the requests.
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
    let key = Secret::new(KEY);
    Http::new(url, "thinker", Some(key), Duration::from_secs(4), attempts).unwrap().pause(Duration::from_millis(10))
}

fn propose(reasoner: &dyn Reasoner, request: &Request) -> Result<Proposal, ReasonerError> {
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
        (wrong, "is not a proposal"),
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
        let shown = format!("{error} {error:?} {reasoner:?}");
        assert!(shown.to_lowercase().contains(expected), "no `{expected}` in {shown}");
        assert!(!shown.contains(KEY), "{shown}");
    }
    // No server at all.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let error = propose(&http(&format!("http://127.0.0.1:{port}/v1"), 2), &request).unwrap_err().to_string();
    assert!(error.contains("no answer after 2 attempt(s)"), "{error}");
}

/// A chat whose content is a list of JSON of its own, with the key written in the ways that JSON allows.
fn echo(stream: &mut std::net::TcpStream) {
    let content = format!("{{\"weights\": {{\"pose\": 11.5, \"{KEY}\": 1}}, \"reason\": \"{KEY}\"}}");
    send(stream, "200 OK", &chat(&content));
}
fn echo_as_number(stream: &mut std::net::TcpStream) {
    send(stream, "200 OK", &chat(&format!("{{\"weights\": {{\"pose\": [\"\\u0073{}\"]}}}}", &KEY[1..])));
}
fn echo_in_words(stream: &mut std::net::TcpStream) {
    send(stream, "200 OK", &chat(&format!("your key is {KEY}")));
}
fn echo_at_the_cut(stream: &mut std::net::TcpStream) {
    send(stream, "200 OK", &chat(&format!("{}{KEY}", "x".repeat(1993))));
}
fn echo_without_choices(stream: &mut std::net::TcpStream) {
    send(stream, "200 OK", &format!("{{\"\\u0073{}\": \"{KEY}\", \"{KEY}\": [\"\\u0073{}\"]}}", &KEY[1..], &KEY[1..]));
}
fn echo_broken(stream: &mut std::net::TcpStream) {
    send(stream, "200 OK", &format!("{{\"model\": \"{KEY}"));
}
fn echo_refused(stream: &mut std::net::TcpStream) {
    send(stream, "403 Forbidden", &format!("{}{KEY}", "x".repeat(1990)));
}
fn echo_busy(stream: &mut std::net::TcpStream) {
    send(stream, "503 Service Unavailable", &format!("{{\"{KEY}\": \"{}{KEY}\"}}", "x".repeat(1975)));
}
fn echo_status(stream: &mut std::net::TcpStream) {
    send(stream, &format!("418 {KEY}"), KEY);
}
fn echo_in_a_good_answer(stream: &mut std::net::TcpStream) {
    let content = format!("{KEY} {{\"weights\": {{\"pose\": 11.5}}, \"reason\": \"{}{KEY} {KEY}\"}}", "x".repeat(1990));
    let reply = serde_json::json!({ "model": KEY, "choices": [{ "message": { "content": content } }], KEY: KEY });
    send(stream, "200 OK", &reply.to_string());
}

#[test]
fn an_endpoint_that_echoes_the_key_gets_it_into_nothing() {
    let request = asked();
    let cases: [Answering; 10] = [
        echo,
        echo_as_number,
        echo_in_words,
        echo_at_the_cut,
        echo_without_choices,
        echo_broken,
        echo_refused,
        echo_busy,
        echo_status,
        echo_in_a_good_answer,
    ];
    for (index, answer) in cases.into_iter().enumerate() {
        let (url, heard) = server(vec![answer]);
        let reasoner = http(&url, 1);
        let result = propose(&reasoner, &request);
        assert!(heard.lock().unwrap()[0].contains(KEY), "the key was sent");
        let shown = match &result {
            Ok(proposal) => serde_json::to_string(proposal).unwrap(),
            Err(error) => error.to_string(),
        };
        let shown = format!("{shown} {result:?} {reasoner:?} {}", reasoner.name());
        // Nor the part of it that a cut leaves.
        assert!(!shown.contains("sk-v"), "case {index}: {shown}");
        assert_eq!(result.is_ok(), index == 9, "case {index}: {shown}");
    }
}

#[test]
fn an_interrupt_does_not_wait_for_the_endpoint() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}/v1", listener.local_addr().unwrap());
    let stop = Arc::new(AtomicBool::new(false));
    let asked_to_stop = stop.clone();
    // It hears the question and never answers; only the end of the test ends the connection.
    let silent = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        hear(&mut stream);
        asked_to_stop.store(true, Ordering::Relaxed);
        stream
    });
    let reasoner = Http::new(&url, "thinker", None, Duration::from_secs(20), 1).unwrap();
    let result = reasoner.propose(&asked(), &stop);
    assert!(matches!(result, Err(ReasonerError::Interrupted)), "{result:?}");
    drop(silent.join().unwrap());
}

#[test]
fn a_refusal_is_not_asked_again() {
    let (url, heard) = server(vec![refused, well]);
    assert!(matches!(propose(&http(&url, 5), &asked()), Err(ReasonerError::Refuses(_))));
    assert_eq!(heard.lock().unwrap().len(), 1);
}

#[test]
fn a_key_travels_under_cover_only() {
    let key = || Some(Secret::new(KEY));
    let new = |url: &str, key| Http::new(url, "m", key, Duration::from_secs(1), 1).map(|_| ());
    assert!(new("http://example.org/v1", key()).unwrap_err().contains("https only"));
    assert!(new("http://localhost.example.org/v1", key()).is_err());
    assert!(new("https://name:word@example.org/v1", None).unwrap_err().contains("environment"));
    assert!(new("ftp://example.org", None).is_err() && new("example.org", None).is_err());
    assert!(new("https://example.org/v1", key()).is_ok() && new("http://[::1]:8080", key()).is_ok());
}

fn process(script: &str, limit: Duration) -> Process {
    Process::new(vec!["sh".into(), "-c".into(), script.into()], limit, &[], |name| std::env::var(name).ok()).unwrap()
}

#[cfg(unix)]
#[test]
fn a_program_answers_or_its_failure_is_reported() {
    let (request, long) = (asked(), Duration::from_secs(60));
    let proposal = propose(&process("grep -q '\"task\":\"lean\"' && echo '{\"pose\": 11}'", long), &request).unwrap();
    assert_eq!(proposal.weights, [("pose".to_owned(), 11.0)]);
    let error_of = |script: &str| propose(&process(script, long), &request).unwrap_err().to_string();
    assert!(error_of("echo 'no idea' >&2; exit 3").contains("it ended with code 3: no idea"));
    assert!(error_of("echo '{\"pose\": '").contains("ends in the middle"));
    assert!(error_of("true").contains("there is none"));
    let missing = Process::new(vec!["./none-of-that-name".into()], long, &[], |_| None).unwrap();
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

/// A pipe with a name, which both ends open; and a path for a mark.
#[cfg(unix)]
fn pipe(folder: &tempfile::TempDir) -> (std::path::PathBuf, std::path::PathBuf) {
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    (pipe, folder.path().join("mark"))
}

#[cfg(unix)]
#[test]
fn what_a_program_has_started_ends_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let (pipe, mark) = pipe(&folder);
    // A child of the program's child holds the pipe open, and leaves a mark if it lives to the end.
    let script = format!("exec 9>{}; (sh -c 'sleep 20; echo lived > {}') & wait", pipe.display(), mark.display());
    let reader = std::thread::spawn(move || std::fs::read(pipe).unwrap());
    let error = propose(&process(&script, Duration::from_millis(500)), &asked()).unwrap_err().to_string();
    assert!(error.contains("no answer within 0.5 s"), "{error}");
    // The pipe ends once none of them is left.
    assert!(reader.join().unwrap().is_empty());
    assert!(!mark.exists());
}

#[cfg(unix)]
#[test]
fn an_answer_counts_although_somebody_holds_the_output_open() {
    let folder = tempfile::tempdir().unwrap();
    let (pipe, mark) = pipe(&folder);
    let script = format!("exec 9>{}; (sleep 20; echo lived > {}) & echo '{{\"pose\": 11}}'", pipe.display(), mark.display());
    let reader = std::thread::spawn(move || std::fs::read(pipe).unwrap());
    let proposal = propose(&process(&script, Duration::from_secs(60)), &asked()).unwrap();
    assert_eq!(proposal.weights, [("pose".to_owned(), 11.0)]);
    assert!(reader.join().unwrap().is_empty() && !mark.exists(), "what it left behind has ended");
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_counts_although_somebody_outside_the_group_holds_the_output_open() {
    let script = "setsid sleep 20 & echo '{\"pose\": 11}'";
    let proposal = propose(&process(script, Duration::from_secs(60)), &asked()).unwrap();
    assert_eq!(proposal.weights, [("pose".to_owned(), 11.0)]);
}

#[cfg(unix)]
#[test]
fn a_program_may_write_many_errors_and_no_endless_answer() {
    let long = Duration::from_secs(60);
    let chatty = "head -c 3000000 /dev/zero >&2 && echo '{\"pose\": 11}'";
    assert_eq!(propose(&process(chatty, long), &asked()).unwrap().weights, [("pose".to_owned(), 11.0)]);
    let error = propose(&process("echo '{\"pose\": 11}'; head -c 3000000 /dev/zero", long), &asked()).unwrap_err();
    assert!(error.to_string().contains("longer than 1048576 bytes"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_program_gets_the_variables_that_its_settings_name_and_their_values_are_not_shown() {
    let own = |name: &str| match name {
        "TOKEN" => Some(KEY.to_owned()),
        "DEVICE" => Some("1".to_owned()),
        _ => std::env::var(name).ok(),
    };
    let ask = |script: &str| {
        let command = vec!["sh".into(), "-c".into(), script.into()];
        let process = Process::new(command, Duration::from_secs(60), &["TOKEN".into(), "DEVICE".into()], own).unwrap();
        propose(&process, &asked())
    };
    let names = "env | cut -d= -f1 | tr '\n' ' '";
    let printed =
        ask(&format!("echo \"{{\\\"weights\\\": {{\\\"pose\\\": 11}}, \\\"reason\\\": \\\"$({names})\\\"}}\"")).unwrap().reason;
    let got: Vec<&str> = printed.split(' ').collect();
    assert!(got.contains(&"PATH") && got.contains(&"TOKEN") && got.contains(&"DEVICE"), "{printed}");
    // Cargo sets this for every test; a key of the user's would be no different.
    assert!(std::env::var("CARGO_MANIFEST_DIR").is_ok() && !printed.contains("CARGO"), "{printed}");

    let reason = ask("echo \"{\\\"weights\\\": {\\\"pose\\\": 11}, \\\"reason\\\": \\\"$TOKEN on $DEVICE\\\"}\"").unwrap().reason;
    assert_eq!(reason, "(TOKEN) on 1");
    for script in ["echo $TOKEN >&2; exit 3", "echo $TOKEN", "echo \"{\\\"$TOKEN\\\": 1}\"", "printf '%1995s' x; echo $TOKEN"] {
        let error = ask(script).unwrap_err();
        assert!(!format!("{error} {error:?}").contains("sk-v"), "{script}: {error:?}");
    }
    let missing = Process::new(vec!["true".into()], Duration::from_secs(1), &["MSK_NONE".into()], |_| None);
    assert_eq!(missing.err().as_deref(), Some("MSK_NONE"));
}

#[test]
fn settings_that_make_no_sense_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("reasoner.toml");
    let error_of = |text: &str| {
        std::fs::write(&file, text).unwrap();
        from_file(&file, |_| None).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert!(error_of("kind = \"oracle\"").contains("unknown variant `oracle`"));
    assert!(error_of("kind = \"http\"\nurl = \"https://h\"").contains("missing field `model`"));
    assert!(error_of("kind = \"http\"\nurl = \"https://h\"\nmodel = \"m\"\nkey = \"sk\"").contains("unknown field `key`"));
    assert!(error_of("kind = \"rules\"\nkey = sk\n").contains("line 2: "));
    // A key in the wrong place is not repeated.
    assert!(!error_of("kind = \"http\"\nurl = \"https://h\"\nmodel = \"m\"\nkey = \"sk-very-secret\"").contains("sk-v"));
    assert!(error_of("kind = \"process\"\ncommand = [\"a\"]\nenvironment = [\"K\"]").contains("variable `K` is not set"));
    assert!(error_of("kind = \"http\"\nurl = \"https://h\"\nmodel = \"m\"\nkey_variable = \"K\"").contains("variable `K`"));
    assert!(error_of("kind = \"process\"\ncommand = []").contains("`command` is empty"));
    assert!(error_of("kind = \"process\"\ncommand = [\"a\"]\ntimeout_s = -1").contains("timeout_s"));
    for (key, value, expected) in [
        ("timeout_s", "nan", "timeout_s is NaN, not 0.001 to 3600"),
        ("timeout_s", "1e308", "timeout_s is 1e308, not 0.001 to 3600"),
        ("temperature", "inf", "temperature is inf, not 0 to 2"),
        ("temperature", "-1e-308", "temperature is -1e-308, not 0 to 2"),
        ("attempts", "0", "attempts is 0, not 1 to 10"),
        ("attempts", "4000000000", "attempts is 4000000000, not 1 to 10"),
    ] {
        let error = error_of(&format!("kind = \"http\"\nurl = \"https://h\"\nmodel = \"m\"\n{key} = {value}"));
        assert!(error.ends_with(expected), "{error}");
    }
    assert_eq!(error_of("kind = \"rules\""), "");
    assert!(matches!(read("{", &asked(), &Secrets::default()), Err(ReplyError::NoObject(_))));
}
