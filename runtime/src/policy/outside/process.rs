//! A program that acts: it reads a message per control step and writes one.

use super::message::{Encoding, Reply, Request, TaskDescription, shortened};
use super::pipes::{Incoming, LONGEST, Tail, reader, writer};
use crate::policy::{Policy, PolicyContext, PolicyError};
use crate::process_group::ProcessGroup;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// How often a wait looks whether it is to be given up.
const GLANCE: Duration = Duration::from_millis(20);
/// How long a program has for ending by itself once its input has ended, and for leaving a word on standard error.
const FAREWELL: Duration = Duration::from_millis(500);

/// A policy process.
pub(crate) struct Process<'a> {
    name: String,
    timeout: Duration,
    stop: &'a AtomicBool,
    group: ProcessGroup,
    /// `None` once its input is to end.
    requests: Option<Sender<Vec<u8>>>,
    replies: Receiver<Incoming>,
    encoding: Encoding,
    errors: Tail,
    /// Hash of the task that it has agreed to act on.
    task: Option<String>,
    /// What it was last asked about, for messages.
    asked: Asked,
}

/// A task, and where in which episode of it.
#[derive(Default)]
struct Asked {
    task: String,
    place: Option<(u64, u32)>,
}

impl<'a> Process<'a> {
    /// Starts the program with its arguments; no shell stands between.
    ///
    /// # Errors
    /// A program that cannot be started.
    pub fn start(
        name: &str,
        (command, encoding): (&[String], Encoding),
        timeout: Duration,
        stop: &'a AtomicBool,
    ) -> Result<Self, PolicyError> {
        let failed = |reason: String| PolicyError::Failed { policy: name.to_owned(), reason };
        let (program, arguments) = command.split_first().ok_or_else(|| failed("it has no command".into()))?;
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut group =
            ProcessGroup::start(&mut command).map_err(|error| failed(format!("`{program}` cannot be started: {error}")))?;
        let child = group.child();
        let (Some(input), Some(output), Some(errors)) = (child.stdin.take(), child.stdout.take(), child.stderr.take()) else {
            return Err(failed("it has no standard input or output".into()));
        };
        Ok(Self {
            name: name.to_owned(),
            timeout,
            stop,
            group,
            requests: Some(writer(input)),
            replies: reader(output, encoding),
            encoding,
            errors: Tail::of(errors),
            task: None,
            asked: Asked::default(),
        })
    }

    /// Sends a request and waits for the reply to it.
    fn ask(&mut self, request: &Request<'_>) -> Result<Reply, PolicyError> {
        let message = request.encoded(self.encoding).map_err(|error| self.failed(format!("cannot receive requests: {error}")))?;
        // A thread that has ended leaves its program to be found ended below.
        let _ = self.requests.as_ref().map(|requests| requests.send(message));
        let begin = Instant::now();
        loop {
            match self.replies.recv_timeout(GLANCE) {
                Ok(Incoming::Reply(reply)) => return reply.map_err(|reason| self.failed(reason)),
                Ok(Incoming::TooLong) => return Err(self.failed(format!("its reply is longer than {LONGEST} bytes"))),
                Err(RecvTimeoutError::Disconnected) => return Err(self.ended()),
                Err(RecvTimeoutError::Timeout) if self.stop.load(Ordering::Relaxed) => return Err(PolicyError::Interrupted),
                Err(RecvTimeoutError::Timeout) if begin.elapsed() >= self.timeout => {
                    let limit = self.timeout.as_secs_f64();
                    return Err(self.failed(format!("no reply within {limit} s (`--policy-timeout` sets the limit)")));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// With what it last wrote to standard error.
    fn failed(&self, reason: String) -> PolicyError {
        let errors = self.errors.text();
        let reason =
            if errors.is_empty() { reason } else { format!("{reason}\n  its standard error ends with:\n{}", indented(&errors)) };
        let task = &self.asked.task;
        let place = match self.asked.place {
            None => format!("before the first episode of `{task}`"),
            Some((episode, step)) => format!("in `{task}`, episode {episode}, step {step}"),
        };
        PolicyError::Failed { policy: self.name.clone(), reason: format!("{place}: {reason}") }
    }

    /// Its standard output has ended.
    fn ended(&mut self) -> PolicyError {
        let begin = Instant::now();
        while begin.elapsed() < FAREWELL && !self.group.has_ended().unwrap_or(true) {
            std::thread::sleep(GLANCE);
        }
        let by_itself = self.group.has_ended().unwrap_or(false);
        let status = self.group.end().ok().filter(|_| by_itself);
        // Its last words may still be on their way.
        std::thread::sleep(GLANCE);
        self.failed(match status.map(|status| status.code()) {
            Some(Some(code)) => format!("it ended with code {code}"),
            Some(None) => "it was ended by a signal".to_owned(),
            None => "it closed its standard output".to_owned(),
        })
    }
}

impl Policy for Process<'_> {
    fn name(&self) -> &str {
        &self.name
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        if self.task.as_ref() == Some(&context.task.hash) {
            return Ok(());
        }
        self.asked = Asked { task: context.task.name.clone(), place: None };
        let reply = self.ask(&Request::Task(TaskDescription::of(context)))?;
        match reply {
            Reply { error: Some(reason), .. } => {
                Err(PolicyError::Unable { policy: self.name.clone(), reason: shortened(&reason) })
            }
            Reply { ready: Some(true), action: None, .. } => {
                self.task = Some(context.task.hash.clone());
                Ok(())
            }
            _ => Err(self.failed("its reply to a task is neither `{\"ready\": true}` nor `{\"error\": \"...\"}`".into())),
        }
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        self.asked.place = Some((context.key.episode, context.step));
        match self.ask(&Request::act(context))? {
            Reply { error: Some(reason), .. } => Err(self.failed(format!("it replies with the error `{}`", shortened(&reason)))),
            Reply { action: Some(values), ready: None, .. } if values.len() == action.len() => {
                action.copy_from_slice(&values);
                Ok(())
            }
            Reply { action: Some(values), .. } => {
                let (found, expected) = (values.len(), action.len());
                Err(self.failed(format!("its action has {found} numbers, expected {expected}")))
            }
            _ => Err(self.failed("its reply contains no `action`".into())),
        }
    }
}

impl Drop for Process<'_> {
    fn drop(&mut self) {
        self.requests = None;
        let begin = Instant::now();
        while begin.elapsed() < FAREWELL && !self.group.has_ended().unwrap_or(true) {
            std::thread::sleep(GLANCE / 10);
        }
        // The group is ended with this value.
    }
}

fn indented(text: &str) -> String {
    text.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n")
}
