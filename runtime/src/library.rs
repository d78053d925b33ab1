//! The bodies of this machine, as the compiler asks for them.

#[cfg(feature = "system")]
pub use crate::files::FileLoader;
pub use crate::files::WithText;

use crate::bodies;
use crate::body::{BindError, Body, ChangeError};
use crate::condition::MuscleCondition;
use crate::files::{Fingerprints, Recorder};
use crate::scene::{self, SceneError};
#[cfg(feature = "system")]
use msk_physics::model::DiskFiles;
use msk_physics::model::{ElasticTendons, Model, ModelError, ModelFiles};
use msk_program::body::{BodyDescription, TendonKind};
use msk_program::digest::hexadecimal;
use msk_program::files::BodySource;
use msk_program::motion::Motion;
use msk_program::scene::SceneDescription;
use msk_program::vocabulary::Vocabulary;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// A body file bound to its model, shared by all that run on it.
#[derive(Debug, Clone)]
pub struct BoundBody {
    /// The model.
    pub model: Arc<Model>,
    /// The body.
    pub body: Arc<Body>,
    /// Condition of its muscles, which the model already has but for fatigue.
    pub condition: MuscleCondition,
    identity: Arc<Identity>,
}

/// What makes a body that body. Its hash is computed when it is asked for: it takes as long as reading the model.
#[derive(Debug)]
struct Identity {
    description: BodyDescription,
    model: Arc<Model>,
    hash: OnceLock<String>,
}

impl BoundBody {
    fn new(description: &BodyDescription, model: Model, body: Body) -> Self {
        let model = Arc::new(model);
        let identity = Identity { description: description.clone(), model: Arc::clone(&model), hash: OnceLock::new() };
        Self { model, body: Arc::new(body), condition: MuscleCondition::default(), identity: Arc::new(identity) }
    }

    /// The same with another model and condition, which `hash` tells apart.
    pub(crate) fn changed(&self, model: Model, condition: MuscleCondition, hash: String) -> Self {
        let model = Arc::new(model);
        let description = self.identity.description.clone();
        let identity = Identity { description, model: Arc::clone(&model), hash: OnceLock::from(hash) };
        Self { model, body: Arc::clone(&self.body), condition, identity: Arc::new(identity) }
    }

    /// Hash of the body file's meaning, of the model's text and of the condition.
    pub fn hash(&self) -> &str {
        let Identity { description, model, hash } = &*self.identity;
        hash.get_or_init(|| hash_of(description, model))
    }
}

/// Why a body cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum BodyError {
    /// The model cannot be read.
    #[error("the model of body `{body}` cannot be read")]
    Model {
        /// Name of the body.
        body: String,
        /// What is wrong with it.
        source: ModelError,
    },
    /// The body file does not fit its model.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// The scene cannot be built around it.
    #[error("the scene and the body `{body}` cannot be merged")]
    Scene {
        /// Name of the body.
        body: String,
        /// What is wrong with it.
        source: SceneError,
    },
    /// What a task changes on the body does not fit it.
    #[error(transparent)]
    Change(#[from] ChangeError),
}

/// The bodies of this machine: those on disk and those embedded in the program.
///
/// Each is bound once, and once in each scene, as long as the files of its model are what they were; those that were used last are
/// kept.
#[derive(Debug)]
pub struct BodyLibrary {
    files: Box<dyn ModelFiles + Send + Sync>,
    bound: Mutex<Bound>,
    staged: Mutex<Vec<Staged>>,
}

/// Most bodies that are kept.
const MOST_BOUND: usize = 16;
/// Most bodies in scenes that are kept: those of a large suite.
const MOST_STAGED: usize = 64;

/// Bodies, the one used last at the end.
#[derive(Debug, Default)]
struct Bound {
    bodies: Vec<BoundFrom>,
    /// Revision of the body that was read last.
    revision: u64,
}

/// What was read for a description.
#[derive(Debug)]
struct BoundFrom {
    description: BodyDescription,
    files: Fingerprints,
    /// Another for each reading.
    revision: u64,
    /// `None` where reading or binding failed: the error is made again when it is asked for.
    body: Option<BoundBody>,
}

/// A body in a scene.
#[derive(Debug)]
struct Staged {
    description: BodyDescription,
    scene: SceneDescription,
    /// Of the body alone.
    revision: u64,
    body: BoundBody,
}

impl Bound {
    /// Takes out what is known of a description, if its files are what they were.
    fn take(&mut self, description: &BodyDescription, files: &dyn ModelFiles) -> Option<BoundFrom> {
        let place = self.bodies.iter().position(|known| known.description == *description)?;
        let known = self.bodies.remove(place);
        known.files.are_unchanged(files).then_some(known)
    }

    /// Reads and binds a body, unless that is done already.
    fn bind(&mut self, description: &BodyDescription, files: &dyn ModelFiles) -> Result<(BoundBody, u64), BodyError> {
        let known = match self.take(description, files) {
            Some(known) => match known.body.clone() {
                Some(body) => {
                    let revision = known.revision;
                    self.keep(known);
                    return Ok((body, revision));
                }
                None => Some(known.revision),
            },
            None => None,
        };
        let recorder = Recorder::new(files);
        let fresh = read(description, &recorder);
        let files = recorder.into_fingerprints();
        // What fails twice for the same reason has not changed.
        let revision = known.filter(|_| fresh.is_err()).unwrap_or(self.revision + 1);
        self.revision = revision.max(self.revision);
        let (description, body) = (description.clone(), fresh.as_ref().ok().cloned());
        self.keep(BoundFrom { description, files, revision, body });
        fresh.map(|body| (body, revision))
    }

    /// The revision of a body, which is read if it is not known.
    fn revision(&mut self, description: &BodyDescription, files: &dyn ModelFiles) -> u64 {
        match self.take(description, files) {
            Some(known) => {
                let revision = known.revision;
                self.keep(known);
                revision
            }
            // A body that cannot be read has a revision, too: that of its files as they are.
            None => self.bind(description, files).map_or(self.revision, |(_, revision)| revision),
        }
    }

    fn keep(&mut self, body: BoundFrom) {
        let excess = (self.bodies.len() + 1).saturating_sub(MOST_BOUND);
        self.bodies.drain(..excess);
        self.bodies.push(body);
    }
}

fn read(description: &BodyDescription, files: &dyn ModelFiles) -> Result<BoundBody, BodyError> {
    let mut model = bodies::model_from(Path::new(&description.model), files)
        .map_err(|source| BodyError::Model { body: description.name.clone(), source })?;
    if description.tendons == TendonKind::Elastic {
        model.elastic_tendons = Some(ElasticTendons::default());
    }
    let mut body = Body::bind(description, &model)?;
    body.change(&mut model, &description.changes)?;
    Ok(BoundBody::new(description, model, body))
}

/// The library of all files.
#[cfg(feature = "system")]
impl Default for BodyLibrary {
    fn default() -> Self {
        Self::of(DiskFiles)
    }
}

impl BodyLibrary {
    /// The library of bodies whose models are read from `files`.
    pub fn of(files: impl ModelFiles + Send + Sync + 'static) -> Self {
        Self { files: Box::new(files), bound: Mutex::default(), staged: Mutex::default() }
    }

    /// The body that `description` describes, bound to its model.
    ///
    /// # Errors
    /// A model that cannot be read, or a description that does not fit it.
    pub fn bind(&self, description: &BodyDescription) -> Result<BoundBody, BodyError> {
        Ok(self.bound().bind(description, &*self.files)?.0)
    }

    fn bound(&self) -> MutexGuard<'_, Bound> {
        // A thread that panicked here left the list whole: it only changes by finished entries.
        self.bound.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The body that `description` describes in a scene, as a compiled task wants it.
    ///
    /// # Errors
    /// Those of [`bind`](Self::bind), or a scene that no model can hold.
    pub fn stage(&self, description: &BodyDescription, scene: &SceneDescription) -> Result<BoundBody, BodyError> {
        let (alone, revision) = self.bound().bind(description, &*self.files)?;
        let mut staged = self.staged.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |known: &Staged| known.description == *description && known.scene == *scene;
        if let Some(place) = staged.iter().position(same) {
            let known = staged.remove(place);
            if known.revision == revision {
                let body = known.body.clone();
                staged.push(known);
                return Ok(body);
            }
        }
        let (model, body) = scene::stage(&alone.model, &alone.body, scene)
            .map_err(|source| BodyError::Scene { body: description.name.clone(), source })?;
        // Where the scene adds nothing, all that is known of the body alone holds.
        let same = model == *alone.model && body == *alone.body;
        let fresh = if same { alone } else { BoundBody::new(description, model, body) };
        let excess = (staged.len() + 1).saturating_sub(MOST_STAGED);
        staged.drain(..excess);
        staged.push(Staged { description: description.clone(), scene: scene.clone(), revision, body: fresh.clone() });
        Ok(fresh)
    }
}

impl BodyLibrary {
    fn traced(&self, description: &BodyDescription, motion: &Motion) -> Result<Vec<Vec<[f64; 3]>>, BodyError> {
        let BoundBody { model, body, .. } = self.bind(description)?;
        Ok(body.trace(&model, motion))
    }
}

/// An error with its causes, in one line.
pub fn in_words(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text = format!("{text}: {cause}");
        source = cause.source();
    }
    text
}

impl BodySource for BodyLibrary {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        bodies::builtin(name).map(|file| (file.path, file.text))
    }

    fn vocabulary(&self, description: &BodyDescription) -> Result<Vocabulary, String> {
        match self.bind(description) {
            Ok(bound) => Ok(bound.body.vocabulary(&bound.model)),
            Err(error) => Err(in_words(&error)),
        }
    }

    fn revision(&self, description: &BodyDescription) -> u64 {
        self.bound().revision(description, &*self.files)
    }

    fn trace(&self, description: &BodyDescription, motion: &Motion) -> Result<Vec<Vec<[f64; 3]>>, String> {
        self.traced(description, motion).map_err(|error| in_words(&error))
    }
}

/// Hash of what a body is: its description without the place of the model, and the model in canonical form.
fn hash_of(description: &BodyDescription, model: &Model) -> String {
    let description = BodyDescription { model: String::new(), ..description.clone() };
    let mut hasher = Sha256::new();
    // Plain data of strings and numbers always has a JSON form.
    hasher.update(serde_json::to_vec(&description).unwrap_or_default());
    hasher.update(model.to_mjcf());
    hexadecimal(&hasher.finalize()[..16])
}

#[cfg(test)]
#[cfg(feature = "system")]
mod tests {
    use super::*;
    use msk_program::body::Axis;

    #[test]
    fn the_human_can_be_found_without_any_file() {
        let (path, text) = BodyLibrary::default().find("human").unwrap();
        assert!(path.ends_with("bodies/human.msk") && text.contains("body human"));
        assert_eq!(BodyLibrary::default().find("nobody"), None);
    }

    const MODEL: &str = "<mujoco><worldbody><body name=\"trunk\" pos=\"0 0 1\"><freejoint name=\"root\"/>\
        <geom name=\"ball\" size=\"0.1\" mass=\"1.0\"/></body></worldbody></mujoco>";

    fn description(model: &Path) -> BodyDescription {
        BodyDescription {
            name: "ball".to_owned(),
            model: model.display().to_string(),
            root: "trunk".to_owned(),
            root_up: Axis::PlusZ,
            poses: vec![("neutral".to_owned(), Vec::new())],
            ..BodyDescription::default()
        }
    }

    #[test]
    fn a_model_that_changes_on_disk_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        std::fs::write(&path, MODEL).unwrap();
        let library = BodyLibrary::default();
        let body = description(&path);
        let scene = SceneDescription::default();
        let first = library.stage(&body, &scene).unwrap();
        let revision = BodySource::revision(&library, &body);
        assert!(Arc::ptr_eq(&first.model, &library.stage(&body, &scene).unwrap().model));
        assert_eq!(BodySource::revision(&library, &body), revision);

        std::fs::write(&path, MODEL.replace("mass=\"1.0\"", "mass=\"2.0\"")).unwrap();
        assert_ne!(BodySource::revision(&library, &body), revision);
        let second = library.stage(&body, &scene).unwrap();
        assert_ne!(first.model, second.model);
        assert_ne!(first.hash(), second.hash());

        std::fs::write(&path, "no model").unwrap();
        assert!(library.bind(&body).is_err());
        let broken = BodySource::revision(&library, &body);
        assert_eq!(BodySource::revision(&library, &body), broken);
        std::fs::write(&path, MODEL).unwrap();
        assert_ne!(BodySource::revision(&library, &body), broken);
        assert_eq!(library.bind(&body).unwrap().model, first.model);
    }

    #[test]
    fn what_is_kept_is_bounded() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        std::fs::write(&path, MODEL).unwrap();
        let library = BodyLibrary::default();
        let body = description(&path);
        for number in 0..2 * MOST_STAGED {
            let other = BodyDescription { name: format!("ball{number}"), ..body.clone() };
            library.stage(&other, &SceneDescription::default()).unwrap();
            library.bind(&body).unwrap();
            assert!(library.bound().bodies.len() <= MOST_BOUND);
            assert!(library.staged.lock().unwrap().len() <= MOST_STAGED);
            assert!(library.bound().bodies.iter().any(|known| known.description == body), "the one used last stays");
        }
    }
}
