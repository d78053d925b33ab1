//! A reasoner behind an endpoint for chats, in the form that OpenAI began and most others understand.

use super::{GLANCE, Proposal, Reasoner, ReasonerError, Request, Secret, Secrets, prompt, read};
use serde_json::{Value, json};
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};
use ureq::Agent;

/// Longest answer that is read, bytes.
const LONGEST: u64 = 1 << 20;
/// Pause after the first failure; each further one doubles it.
const PAUSE: Duration = Duration::from_millis(500);

/// An endpoint.
#[derive(Debug)]
pub struct Http {
    /// The address before `/chat/completions`.
    url: String,
    model: String,
    key: Option<Secret>,
    /// The key again, as what must not be shown.
    secrets: Secrets,
    temperature: f64,
    attempts: u32,
    pause: Duration,
    agent: Agent,
}

/// One failure.
enum Failure {
    /// Worth another try.
    Passing(ReasonerError),
    /// The same would come again.
    Lasting(ReasonerError),
}

impl Http {
    /// An endpoint at `url`, such as `https://host/v1`, asked `attempts` times at most, each at most `limit` long.
    ///
    /// # Errors
    /// An address that is none, or a key that would travel in the clear.
    pub fn new(url: &str, model: &str, key: Option<Secret>, limit: Duration, attempts: u32) -> Result<Self, String> {
        let url = url.trim_end_matches('/').to_owned();
        let host = url.split_once("://").map(|(_, rest)| rest.split(['/', '?']).next().unwrap_or_default());
        let host =
            host.filter(|host| !host.is_empty()).ok_or_else(|| format!("`{url}` is not an address such as https://host/v1"))?;
        if host.contains('@') {
            return Err("an address must not contain a name and password: keys come from the environment".into());
        }
        let name = host.trim_start_matches('[').split([']']).next().unwrap_or_default();
        let name = if host.starts_with('[') { name } else { name.split(':').next().unwrap_or_default() };
        let here = matches!(name, "localhost" | "127.0.0.1" | "::1");
        match url.split_once("://").map(|(scheme, _)| scheme) {
            Some("https") => {}
            Some("http") if here || key.is_none() => {}
            Some("http") => return Err(format!("a key is sent over https only, not to `{url}`")),
            _ => return Err(format!("`{url}` must begin with https:// or http://")),
        }
        let config = Agent::config_builder()
            .timeout_global(Some(limit))
            .http_status_as_error(false)
            // A key goes to the address that was given and to no other.
            .max_redirects(0)
            .max_redirects_will_error(false);
        let config = if here { config.proxy(None) } else { config };
        let agent = config.build().new_agent();
        let (attempts, secrets) = (attempts.max(1), Secrets::new(key.clone()));
        Ok(Self { url, model: model.to_owned(), key, secrets, temperature: 0.2, attempts, pause: PAUSE, agent })
    }

    /// The same with another temperature.
    pub fn temperature(self, temperature: f64) -> Self {
        Self { temperature, ..self }
    }

    /// The same with another pause after the first failure.
    pub fn pause(self, pause: Duration) -> Self {
        Self { pause, ..self }
    }

    fn ask(&self, request: &Request, question: &str, stop: &AtomicBool) -> Result<Proposal, Failure> {
        let silent = |reason: &str| ReasonerError::Silent { attempts: 1, reason: self.secrets.shown(reason) };
        let answer = self.post(question).map_err(|error| Failure::Passing(silent(&error.to_string())))?;
        let (status, text) = loop {
            match answer.recv_timeout(GLANCE) {
                Ok(Ok(answer)) => break answer,
                Ok(Err(error @ (ureq::Error::BadUri(_) | ureq::Error::Http(_)))) => {
                    return Err(Failure::Lasting(silent(&error.to_string())));
                }
                Ok(Err(error)) => return Err(Failure::Passing(silent(&error.to_string()))),
                Err(RecvTimeoutError::Disconnected) => return Err(Failure::Passing(silent("the connection was interrupted"))),
                Err(RecvTimeoutError::Timeout) if stop.load(Ordering::Relaxed) => {
                    return Err(Failure::Lasting(ReasonerError::Interrupted));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        };
        let reason = || format!("status {status}: {}", self.secrets.shown_body(&text));
        match status {
            200..=299 => self.proposal(&text, request).map_err(Failure::Passing),
            408 | 425 | 429 | 500..=599 => Err(Failure::Passing(ReasonerError::Silent { attempts: 1, reason: reason() })),
            _ => Err(Failure::Lasting(ReasonerError::Refuses(reason()))),
        }
    }

    /// Asks in a thread of its own, which gives status and text. Who does not wait for it leaves it to its time limit: a call that
    /// is under way cannot be called off.
    fn post(&self, question: &str) -> io::Result<Receiver<Result<(u16, String), ureq::Error>>> {
        let body = json!({
            "model": self.model,
            "temperature": self.temperature,
            "messages": [{ "role": "user", "content": question }],
        });
        let mut post = self.agent.post(format!("{}/chat/completions", self.url)).header("content-type", "application/json");
        if let Some(key) = &self.key {
            post = post.header("authorization", format!("Bearer {}", key.reveal()));
        }
        let (sender, receiver) = mpsc::channel();
        std::thread::Builder::new().spawn(move || {
            let answer = post.send(body.to_string()).and_then(|mut response| {
                let text = response.body_mut().with_config().limit(LONGEST).read_to_string()?;
                Ok((response.status().as_u16(), text))
            });
            // The receiver may be gone.
            let _ = sender.send(answer);
        })?;
        Ok(receiver)
    }

    /// The proposal in the first choice of an answer.
    fn proposal(&self, text: &str, request: &Request) -> Result<Proposal, ReasonerError> {
        let wrong = |source, reply: &str| ReasonerError::Reply { source, reply: self.secrets.shown_body(reply) };
        let none = |reason: &str| super::ReplyError::NoObject(reason.to_owned());
        let reply: Value = serde_json::from_str(text).map_err(|error| wrong(none(&error.to_string()), text))?;
        let content = reply["choices"][0]["message"]["content"].as_str();
        let content = content.ok_or_else(|| wrong(none("the reply has no choices[0].message.content"), text))?;
        let proposal = read(content, request, &self.secrets).map_err(|source| wrong(source, content))?;
        let by = reply["model"].as_str().unwrap_or(&self.model);
        Ok(Proposal { by: self.secrets.shown(by), ..proposal })
    }
}

impl Reasoner for Http {
    fn name(&self) -> String {
        format!("http {}", self.model)
    }

    fn propose(&self, request: &Request, stop: &AtomicBool) -> Result<Proposal, ReasonerError> {
        let question = prompt(request);
        let mut pause = self.pause;
        let mut attempt = 1;
        loop {
            if stop.load(Ordering::Relaxed) {
                return Err(ReasonerError::Interrupted);
            }
            let error = match self.ask(request, &question, stop) {
                Ok(proposal) => return Ok(proposal),
                Err(Failure::Lasting(error)) => return Err(error),
                Err(Failure::Passing(error)) => error,
            };
            if attempt >= self.attempts {
                return Err(match error {
                    ReasonerError::Silent { reason, .. } => ReasonerError::Silent { attempts: attempt, reason },
                    error => error,
                });
            }
            let begin = Instant::now();
            while begin.elapsed() < pause && !stop.load(Ordering::Relaxed) {
                std::thread::sleep(GLANCE);
            }
            (pause, attempt) = (pause.saturating_mul(2), attempt + 1);
        }
    }
}
