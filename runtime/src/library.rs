//! The bodies and texts of this machine, as the compiler asks for them.

use crate::bodies;
use crate::body::{BindError, Body, ChangeError};
use crate::condition::MuscleCondition;
use crate::model::{ElasticTendons, Model, ModelError};
use crate::scene::{self, SceneError};
use msk_compiler::body::{BodyDescription, TendonKind};
use msk_compiler::files::{BodySource, LARGEST_FILE, LoadError, Loader};
use msk_compiler::motion::Motion;
use msk_compiler::scene::SceneDescription;
use msk_compiler::vocabulary::Vocabulary;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Reads texts from the file system, and those embedded in the program.
#[derive(Debug, Clone, Copy, Default)]
pub struct FileLoader;

impl Loader for FileLoader {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if let Some(text) = bodies::text(path) {
            return Ok(text);
        }
        let unreadable = |error: std::io::Error| match error.kind() {
            ErrorKind::NotFound => LoadError::Missing(path.into()),
            ErrorKind::InvalidData => LoadError::NotText(path.into()),
            _ => LoadError::Unreadable { path: path.into(), reason: error.to_string() },
        };
        let file = File::open(path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        // Devices and pipes have no size: what is read is bounded, not what the file claims to be.
        file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > LARGEST_FILE {
            return Err(LoadError::TooLarge(path.into()));
        }
        String::from_utf8(bytes).map_err(|_| LoadError::NotText(path.into()))
    }
}

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
    #[error("the scene around body `{body}` cannot be built")]
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

/// The bodies of this machine: those on disk and those embedded in the program. Each is bound once, and once in each scene.
#[derive(Debug, Default)]
pub struct BodyLibrary {
    bound: Mutex<Vec<(BodyDescription, BoundBody)>>,
    staged: Mutex<Vec<(BodyDescription, SceneDescription, BoundBody)>>,
}

impl BodyLibrary {
    /// The body that `description` describes, bound to its model.
    ///
    /// # Errors
    /// A model that cannot be read, or a description that does not fit it.
    pub fn bind(&self, description: &BodyDescription) -> Result<BoundBody, BodyError> {
        // A thread that panicked here left the list whole: it only grows by finished entries.
        let mut bound = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = bound.iter().find(|(known, _)| known == description) {
            return Ok(known.clone());
        }
        let mut model = bodies::model(Path::new(&description.model))
            .map_err(|source| BodyError::Model { body: description.name.clone(), source })?;
        if description.tendons == TendonKind::Elastic {
            model.elastic_tendons = Some(ElasticTendons::default());
        }
        let mut body = Body::bind(description, &model)?;
        body.change(&mut model, &description.changes)?;
        let fresh = BoundBody::new(description, model, body);
        bound.push((description.clone(), fresh.clone()));
        Ok(fresh)
    }

    /// The body that `description` describes in a scene, as a compiled task wants it.
    ///
    /// # Errors
    /// Those of [`bind`](Self::bind), or a scene that no model can hold.
    pub fn stage(&self, description: &BodyDescription, scene: &SceneDescription) -> Result<BoundBody, BodyError> {
        let alone = self.bind(description)?;
        let mut staged = self.staged.lock().unwrap_or_else(PoisonError::into_inner);
        let known = |known: &&(BodyDescription, SceneDescription, BoundBody)| known.0 == *description && known.1 == *scene;
        if let Some((_, _, known)) = staged.iter().find(known) {
            return Ok(known.clone());
        }
        let (model, body) = scene::stage(&alone.model, &alone.body, scene)
            .map_err(|source| BodyError::Scene { body: description.name.clone(), source })?;
        // Where the scene adds nothing, all that is known of the body alone holds.
        let same = model == *alone.model && body == *alone.body;
        let fresh = if same { alone } else { BoundBody::new(description, model, body) };
        staged.push((description.clone(), scene.clone(), fresh.clone()));
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
pub(crate) fn in_words(error: &dyn std::error::Error) -> String {
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
    hasher.finalize().iter().take(16).fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_cannot_be_read_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, content: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            FileLoader.load(&path)
        };
        assert_eq!(file("good.msk", b"task"), Ok("task".into()));
        assert!(matches!(file("binary.msk", &[0xff, 0xfe]), Err(LoadError::NotText(_))));
        let limit = usize::try_from(LARGEST_FILE).unwrap();
        assert!(matches!(file("large.msk", &vec![b' '; limit + 1]), Err(LoadError::TooLarge(_))));
        assert!(file("largest.msk", &vec![b' '; limit]).is_ok());
        assert!(matches!(FileLoader.load(&folder.path().join("none.msk")), Err(LoadError::Missing(_))));
        assert!(matches!(FileLoader.load(folder.path()), Err(LoadError::Unreadable { .. })));
    }

    #[test]
    #[cfg(unix)]
    fn an_endless_file_is_refused() {
        assert!(matches!(FileLoader.load(Path::new("/dev/zero")), Err(LoadError::TooLarge(_))));
    }

    #[test]
    fn the_human_can_be_found_without_any_file() {
        let (path, text) = BodyLibrary::default().find("human").unwrap();
        assert!(path.ends_with("bodies/human.msk") && text.contains("body human"));
        assert_eq!(BodyLibrary::default().find("nobody"), None);
    }
}
