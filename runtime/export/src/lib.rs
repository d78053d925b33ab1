//! Compiled tasks as modules in Python over MuJoCo's own model and data: the second back end of the compiler.
//!
//! 1. `readers` finds out which nodes of the graph get a method of their own: values with a name, values with several readers, and
//!    what remembers;
//! 2. `expression` writes a node as an expression, with no more brackets than needed; `sensors` writes what is measured;
//! 3. `module` puts the methods into a class, `anatomy` the names of the body before it;
//! 4. `msk_mujoco.py`, which is written beside every module, measures the signals and holds the operators with memory.
//!
//! Observation, terms, terminations and success are exported; how an episode begins, what disturbs it and how an action becomes
//! excitations is not.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod anatomy;
mod expression;
mod module;
mod readers;
mod sensors;
mod text;

use msk_physics::model::Model;
use msk_program::task::CompiledTask;
use msk_runtime::body::Body;
use std::collections::BTreeMap;

/// The module that every exported task imports.
pub const SUPPORT: &str = include_str!("msk_mujoco.py");

/// Its file name.
pub const SUPPORT_FILE: &str = "msk_mujoco.py";

/// A task for Python.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// Its name, which those of its files begin with.
    pub name: String,
    /// The module `NAME.py`.
    pub module: String,
    /// The model `NAME.xml`: the body in its scene, as MJCF.
    pub model: String,
    /// The motions that it follows, `NAME.json`; `None` if there are none.
    pub motions: Option<String>,
}

impl Exported {
    /// File names with their contents, that of the support module included.
    pub fn files(&self) -> BTreeMap<String, &str> {
        let Self { name, module, model, motions } = self;
        let own = [(format!("{name}.py"), module.as_str()), (format!("{name}.xml"), model.as_str())];
        let motions = motions.iter().map(|motions| (format!("{name}.json"), motions.as_str()));
        own.into_iter().chain(motions).chain([(SUPPORT_FILE.to_owned(), SUPPORT)]).collect()
    }
}

/// A task that cannot be expressed over MuJoCo's data.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("task `{task}` cannot be exported:{}", .reasons.iter().map(|reason| format!("\n  - {reason}")).collect::<String>())]
pub struct NotExportable {
    /// Its name.
    pub task: String,
    /// Everything that stands in the way.
    pub reasons: Vec<String>,
}

/// Writes a task on its body, which is bound to `model`, as a module in Python.
///
/// # Errors
/// Signals that MuJoCo does not have, or phases of a sequence: each with its reason.
pub fn python(task: &CompiledTask, body: &Body, model: &Model) -> Result<Exported, NotExportable> {
    let mut reasons = Vec::new();
    let [phase] = &*task.phases else {
        reasons.push("it is a sequence: export its tasks, one by one".to_owned());
        return Err(NotExportable { task: task.name.clone(), reasons });
    };
    if model.elastic_tendons.is_some() {
        reasons.push("its tendons are elastic, and those of MuJoCo are rigid".to_owned());
    }
    let module = module::Module::new(task, phase, body, model, &mut reasons).written();
    let motions = module::motions(task);
    match reasons.is_empty() {
        true => Ok(Exported { name: task.name.clone(), module, model: model.to_mjcf(), motions }),
        false => Err(NotExportable { task: task.name.clone(), reasons }),
    }
}
