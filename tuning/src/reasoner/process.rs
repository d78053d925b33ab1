//! A reasoner that is a program: it gets the request as JSON on its standard input and answers on its standard output.

use super::{Proposal, Reasoner, ReasonerError, Request, prompt, read, shortened};
use serde_json::json;
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

/// Longest answer that is read, bytes.
const LONGEST: u64 = 1 << 20;
/// How often the program and the interrupt are looked at.
const GLANCE: Duration = Duration::from_millis(10);

/// A program.
#[derive(Debug, Clone)]
pub struct Process {
    /// The program and its arguments; no shell stands between.
    pub command: Vec<String>,
    /// Time that it has for an answer.
    pub limit: Duration,
}

impl Reasoner for Process {
    fn name(&self) -> String {
        format!("process {}", self.command.first().map_or("", String::as_str))
    }

    fn propose(&self, request: &Request, stop: &AtomicBool) -> Result<Proposal, ReasonerError> {
        let question = json!({ "request": request, "prompt": prompt(request) }).to_string();
        let said = self.ask(question, stop)?;
        let proposal = read(&said, request);
        proposal.map_err(|source| ReasonerError::Reply { source, said: shortened(&said) })
    }
}

impl Process {
    fn ask(&self, question: String, stop: &AtomicBool) -> Result<String, ReasonerError> {
        let silent = |reason: String| ReasonerError::Silent { attempts: 1, reason };
        let Some((program, arguments)) = self.command.split_first() else {
            return Err(ReasonerError::Refuses("no command is given".into()));
        };
        let mut child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| ReasonerError::Refuses(format!("`{program}` cannot be started: {error}")))?;
        let (Some(mut input), Some(output), Some(errors)) = (child.stdin.take(), child.stdout.take(), child.stderr.take()) else {
            return Err(silent("it has no standard input or output".into()));
        };
        // Threads of their own: a program that does not read must not block, and one that never ends its output neither.
        // A program may answer without reading its question to the end.
        std::thread::spawn(move || input.write_all(question.as_bytes()));
        let (output, errors) = (whole(output), whole(errors));
        let status = self.wait(&mut child, stop)?;
        // Whoever inherited the output could hold it open after the program has ended.
        let answer = output.recv_timeout(Duration::from_secs(5)).unwrap_or_default();
        if status != Some(0) {
            let errors = errors.recv_timeout(Duration::from_secs(1)).unwrap_or_default();
            let code = status.map_or("a signal ended it".into(), |code| format!("it ended with code {code}"));
            return Err(silent(shortened(
                format!("{code}: {}", String::from_utf8_lossy(&errors)).trim_end_matches([':', ' ', '\n']),
            )));
        }
        String::from_utf8(answer).map_err(|_| silent("its answer is no text".into()))
    }

    /// The exit code, once it has ended; a program that takes too long is ended.
    fn wait(&self, child: &mut Child, stop: &AtomicBool) -> Result<Option<i32>, ReasonerError> {
        let start = Instant::now();
        loop {
            match child.try_wait() {
                Ok(Some(status)) => return Ok(status.code()),
                Ok(None) if start.elapsed() < self.limit && !stop.load(Ordering::Relaxed) => std::thread::sleep(GLANCE),
                _ => break,
            }
        }
        // It may have ended by itself in this moment: that is as well.
        let _ = child.kill();
        let _ = child.wait();
        if stop.load(Ordering::Relaxed) {
            return Err(ReasonerError::Interrupted);
        }
        Err(ReasonerError::Silent { attempts: 1, reason: format!("no answer within {} s", self.limit.as_secs_f64()) })
    }
}

/// All that comes, in a thread of its own.
fn whole(source: impl Read + Send + 'static) -> Receiver<Vec<u8>> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let _ = source.take(LONGEST).read_to_end(&mut bytes);
        let _ = sender.send(bytes);
    });
    receiver
}
