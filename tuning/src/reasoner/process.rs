//! A reasoner that is a program: it gets the request as JSON on its standard input and answers on its standard output.

use super::{GLANCE, Proposal, Reasoner, ReasonerError, Request, Secrets, prompt, read};
use msk_runtime::process_group::ProcessGroup;
use serde_json::json;
use std::io::{self, Read, Write};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest answer that is read, bytes.
const LONGEST: usize = 1 << 20;
/// How long the end of an output is waited for when somebody outside the program's group holds it open.
const PATIENCE: Duration = Duration::from_millis(500);
/// What every program needs of the environment.
#[cfg(not(windows))]
const USUAL: &[&str] = &["PATH", "HOME", "LANG"];
#[cfg(windows)]
const USUAL: &[&str] = &["PATH", "HOME", "LANG", "SystemRoot", "TEMP", "USERPROFILE"];

/// A program.
#[derive(Clone)]
pub struct Process {
    command: Vec<String>,
    limit: Duration,
    variables: Vec<(String, String)>,
    secrets: Secrets,
}

impl Process {
    /// A program with its arguments (no shell stands between), and the time that it has for an answer.
    ///
    /// Of the environment, which `lookup` looks up, it gets PATH, HOME and LANG, and the variables named in `named`, whose values
    /// are taken for secrets.
    ///
    /// # Errors
    /// The name of a variable that is not set.
    pub fn new(
        command: Vec<String>,
        limit: Duration,
        named: &[String],
        lookup: impl Fn(&str) -> Option<String>,
    ) -> Result<Self, String> {
        let find = |name: &String| lookup(name).map(|value| (name.clone(), value)).ok_or_else(|| name.clone());
        let named = named.iter().map(find).collect::<Result<Vec<_>, _>>()?;
        let secrets = Secrets::of_variables(&named);
        let usual = USUAL.iter().filter_map(|name| Some(((*name).to_owned(), lookup(name)?)));
        Ok(Self { command, limit, variables: usual.chain(named).collect(), secrets })
    }
}

impl Reasoner for Process {
    fn name(&self) -> String {
        format!("process {}", self.command.first().map_or("", String::as_str))
    }

    fn propose(&self, request: &Request, stop: &AtomicBool) -> Result<Proposal, ReasonerError> {
        let question = json!({ "request": request, "prompt": prompt(request) }).to_string();
        let reply = self.ask(question, stop)?;
        let proposal = read(&reply, request, &self.secrets);
        proposal.map_err(|source| ReasonerError::Reply { source, reply: self.secrets.shown_body(&reply) })
    }
}

impl Process {
    fn ask(&self, question: String, stop: &AtomicBool) -> Result<String, ReasonerError> {
        let silent = |reason: String| ReasonerError::Silent { attempts: 1, reason };
        let system = |error: io::Error| silent(format!("waiting for it failed: {error}"));
        let mut group = self.start()?;
        let child = group.child();
        let (Some(mut input), Some(output), Some(errors)) = (child.stdin.take(), child.stdout.take(), child.stderr.take()) else {
            return Err(silent("it has no standard input or output".into()));
        };
        // Threads of their own: a program that does not read must not block, and one that never ends its output neither.
        // A program may answer without reading its question to the end.
        std::thread::spawn(move || input.write_all(question.as_bytes()));
        let (output, errors) = (Output::read(output), Output::read(errors));
        let begin = Instant::now();
        while !group.has_ended().map_err(system)? {
            if stop.load(Ordering::Relaxed) {
                return Err(ReasonerError::Interrupted);
            }
            if begin.elapsed() >= self.limit {
                return Err(silent(format!("no answer within {} s", self.limit.as_secs_f64())));
            }
            std::thread::sleep(GLANCE);
        }
        // Others of the group could hold the output open, and with it the answer that is in it.
        let status = group.end().map_err(system)?;
        if !status.success() {
            return Err(silent(self.failure(status, &errors.take())));
        }
        let answer = output.take();
        if answer.len() > LONGEST {
            return Err(silent(format!("its answer is longer than {LONGEST} bytes")));
        }
        String::from_utf8(answer).map_err(|_| silent("its answer is not UTF-8 text".into()))
    }

    fn start(&self) -> Result<ProcessGroup, ReasonerError> {
        let Some((program, arguments)) = self.command.split_first() else {
            return Err(ReasonerError::Refuses("no command is given".into()));
        };
        let mut command = Command::new(program);
        command.args(arguments).env_clear().envs(self.variables.iter().map(|(name, value)| (name, value)));
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        ProcessGroup::start(&mut command)
            .map_err(|error| ReasonerError::Refuses(format!("`{program}` cannot be started: {error}")))
    }

    fn failure(&self, status: ExitStatus, errors: &[u8]) -> String {
        let code = status.code().map_or("it was ended by a signal".into(), |code| format!("it ended with code {code}"));
        match self.secrets.shown(String::from_utf8_lossy(errors).trim()) {
            errors if errors.is_empty() => code,
            errors => format!("{code}: {errors}"),
        }
    }
}

/// What a program has written so far: read in a thread of its own, to the end, so that the program is never held up.
#[derive(Clone, Default)]
struct Output(Arc<(Mutex<Written>, Condvar)>);

#[derive(Default)]
struct Written {
    /// The beginning, one byte longer than the longest answer if there was more.
    bytes: Vec<u8>,
    total: u64,
    over: bool,
}

impl Output {
    fn read(mut source: impl Read + Send + 'static) -> Self {
        let output = Self::default();
        let written = output.clone();
        std::thread::spawn(move || {
            let mut piece = [0; 8192];
            loop {
                let count = match source.read(&mut piece) {
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                    count => count.unwrap_or(0),
                };
                let (mut written, changed) = written.lock();
                let room = (LONGEST + 1).saturating_sub(written.bytes.len());
                written.bytes.extend_from_slice(&piece[..count.min(room)]);
                written.total += count as u64;
                written.over = count == 0;
                changed.notify_all();
                if count == 0 {
                    break;
                }
            }
        });
        output
    }

    /// All of it once it has ended, or once nothing has been added for a while: who holds it open need not write any more.
    fn take(&self) -> Vec<u8> {
        let (mut written, changed) = self.lock();
        loop {
            let before = written.total;
            let still = |written: &mut Written| !written.over && written.total == before;
            (written, _) = changed.wait_timeout_while(written, PATIENCE, still).unwrap_or_else(PoisonError::into_inner);
            if written.over || written.total == before {
                return std::mem::take(&mut written.bytes);
            }
        }
    }

    /// A thread that panicked left what it had read.
    fn lock(&self) -> (MutexGuard<'_, Written>, &Condvar) {
        (self.0.0.lock().unwrap_or_else(PoisonError::into_inner), &self.0.1)
    }
}
