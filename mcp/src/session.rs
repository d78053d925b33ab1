//! Direct control by an agent: sessions in folders of the project.

use crate::confine::Outside;
use crate::project::{Failure, Project, SUITE};
use msk_evaluate::Trial;
use msk_evaluate::session::{Moment, Session, SessionFolder, SessionFolderError, Visible, read_action};
use msk_storage::Folder;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::Path;

/// Most decisions of a session.
const DECISIONS: u32 = 1000;

/// What `session_init` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Init {
    /// Name of a task in tasks.msk, or FILE@TASK with a file of the project.
    pub task: String,
    /// Folder for the session, relative to the project; it must not have one.
    pub folder: String,
    /// Seed of the episode; 0 if it is left out.
    pub seed: Option<u64>,
    /// How long an action is held, s: whole control steps; 0.2 if it is left out.
    pub hold: Option<f64>,
    /// Most decisions, at most 1000; 15 if it is left out.
    pub decisions: Option<u32>,
}

/// What `session_submit` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Submit {
    /// Folder of the session, relative to the project.
    pub folder: String,
    /// The action: a list with one number from -1 to 1 for each of `visible.action`, in that order.
    pub action: Value,
}

/// What `session_status` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Status {
    /// Folder of the session, relative to the project.
    pub folder: String,
}

/// Begins a session.
pub fn init(project: &Project, asked: &Init) -> Result<Value, Failure> {
    let trial = trial(project, &asked.task)?;
    let hold = Session::hold(&trial, asked.hold.unwrap_or(0.2))?;
    let decisions = asked.decisions.unwrap_or(15).clamp(1, DECISIONS);
    let moment = Session::begin(&trial, &asked.task, (asked.seed.unwrap_or(0), hold, decisions))?;
    let path = project.confined.spelled(Path::new(&asked.folder));
    let folder =
        project.confined.folder().create_subfolder(&path).map_err(|error| Outside::of(Path::new(&asked.folder), &error))?;
    SessionFolder::begin(folder, &moment)?;
    Ok(answer(&moment.session, moment.visible.as_ref()))
}

/// Takes the next decision.
pub fn submit(project: &Project, asked: &Submit) -> Result<Value, Failure> {
    let (folder, session) = open(project, &asked.folder)?;
    let trial = trial(project, &session.settings.task)?;
    let names = trial.task.action.names(&trial.task.vocabulary);
    let entries = read_action(&asked.action.to_string(), &names)
        .map_err(|error| Failure(json!({ "error": format!("the action is rejected: {error}"), "changed": false })))?;
    let decided: Result<Moment, SessionFolderError> = folder.decide(|session| Ok(session.decide(&trial, entries)?));
    let moment = decided?;
    Ok(answer(&moment.session, moment.visible.as_ref()))
}

/// How far a session is. How closely it followed the reference of its task is known once it has stopped.
pub fn status(project: &Project, asked: &Status) -> Result<Value, Failure> {
    let (folder, session) = open(project, &asked.folder)?;
    let visible = if session.stopped.is_none() { folder.visible(session.decisions.len())? } else { None };
    let mut answer = answer(&session, visible.as_ref());
    if session.stopped.is_some() {
        answer["tracking"] = serde_json::to_value(folder.tracking()?)?;
    }
    Ok(answer)
}

fn answer(session: &Session, visible: Option<&Visible>) -> Value {
    json!({
        "task": session.settings.task,
        "decisions_taken": session.decisions.len(),
        "decisions": session.settings.decisions,
        "steps": session.decisions.last().map_or(0, |decision| decision.steps),
        "return": session.total,
        "stopped": session.stopped,
        "success": session.success,
        "visible": visible,
    })
}

fn open(project: &Project, name: &str) -> Result<(SessionFolder, Session), Failure> {
    let path = project.confined.spelled(Path::new(name));
    let folder: Result<Folder, _> = project.confined.folder().subfolder(&path);
    Ok(SessionFolder::open(folder.map_err(|error| Outside::of(Path::new(name), &error))?)?)
}

/// The task of a session, named as on the command line.
fn trial(project: &Project, name: &str) -> Result<Trial, Failure> {
    let (file, task) = name.split_once('@').unwrap_or((SUITE, name));
    project.trial(project.task(Some(file), task, None)?)
}
