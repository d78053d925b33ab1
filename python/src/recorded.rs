//! An environment whose present episode may be recorded, for a page that shows it.

use msk_runtime::episode::{Ending, Environment, EpisodeKey};
use msk_view::{Caption, Recorder, page};
use std::ops::{Deref, DerefMut};

/// An environment, with the frames of its present episode if they are kept.
pub struct Recorded {
    environment: Environment,
    wanted: bool,
    recorder: Option<Recorder>,
}

impl Recorded {
    pub fn new(environment: Environment, wanted: bool) -> Self {
        Self { environment, wanted, recorder: None }
    }

    /// Begins an episode as `begin` does it, and with it a recording.
    pub fn begin(&mut self, begin: impl FnOnce(&mut Environment)) {
        begin(&mut self.environment);
        self.recorder = self.wanted.then(|| Recorder::new(&self.environment, &[]));
        self.look();
    }

    /// Keeps the present step.
    pub fn look(&mut self) {
        if let Some(recorder) = &mut self.recorder {
            recorder.look(&self.environment);
        }
    }

    /// The episode so far as a page.
    ///
    /// # Errors
    /// Nothing is kept, or the episode could not begin: in words.
    pub fn page(&self, title: String) -> Result<String, String> {
        let Some(recorder) = &self.recorder else {
            let what =
                if self.wanted { "no episode has begun: call reset()" } else { "no steps are kept: make it with `record=True`" };
            return Err(what.to_owned());
        };
        let environment = &self.environment;
        let task = environment.task();
        let EpisodeKey { seed, episode } = environment.key();
        let caption = Caption {
            task: task.name.clone(),
            policy: title.clone(),
            episode: Some([seed, episode]),
            outcome: match environment.ending() {
                None => format!("{} steps of {}", environment.steps(), task.horizon),
                Some(Ending::Truncated) => "reached the horizon".to_owned(),
                Some(Ending::Fault(fault)) => format!("stopped by a fault: {fault}"),
                Some(ending) => format!("ended by {}", ending.conditions(task)),
            },
            success: environment.ending().map(|_| environment.success()),
            total: Some(environment.episode().total()),
            ..Caption::default()
        };
        let recording = recorder.recording(caption).map_err(|error| error.to_string())?;
        let title = if title.is_empty() { task.name.clone() } else { format!("{}, {title}", task.name) };
        page(&title, &[recording]).map_err(|error| error.to_string())
    }
}

impl Deref for Recorded {
    type Target = Environment;

    fn deref(&self) -> &Environment {
        &self.environment
    }
}

impl DerefMut for Recorded {
    fn deref_mut(&mut self) -> &mut Environment {
        &mut self.environment
    }
}
