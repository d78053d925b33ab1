//! What an agent may read before it does anything.

use crate::project::{Failure, Project};
use msk_compiler::check::scene::elements;
use msk_compiler::compile;
use msk_compiler::signals;
use msk_runtime::bodies;
use rmcp::model::Resource;
use serde_json::json;

/// The language.
pub const REFERENCE: &str = "msk://reference";
/// What a task may name on the human body, with units and ranges.
pub const VOCABULARY: &str = "msk://vocabulary";
/// How weights are edited.
pub const WEIGHTS: &str = "msk://weights";

/// All resources.
pub fn list() -> Vec<Resource> {
    let resource = |uri: &str, name: &str, description: &str, kind: &str| {
        Resource::new(uri, name).with_description(description).with_mime_type(kind)
    };
    vec![
        resource(
            REFERENCE,
            "reference",
            "The task language: statements, signals, functions, units, error codes",
            "text/markdown",
        ),
        resource(
            VOCABULARY,
            "vocabulary",
            "Signals, and the landmarks, joints, muscles, groups and poses of the human body, with units and ranges",
            "application/json",
        ),
        resource(WEIGHTS, "weights", "How the weights of a reward are listed, edited, bounded and tuned", "text/markdown"),
    ]
}

/// The text of a resource with its kind; `None` if there is none of that name.
pub fn read(project: &Project, uri: &str) -> Result<Option<(String, &'static str)>, Failure> {
    Ok(match uri {
        REFERENCE => Some((include_str!("../../grammar/REFERENCE.md").to_owned(), "text/markdown")),
        WEIGHTS => Some((include_str!("../../docs/weights.md").to_owned(), "text/markdown")),
        VOCABULARY => Some((vocabulary(project)?, "application/json")),
        _ => None,
    })
}

fn vocabulary(project: &Project) -> Result<String, Failure> {
    let file = bodies::builtin("human").ok_or("the human body is not built in")?;
    let compilation = compile(&file.path, &project.confined, &project.library)?;
    let description = compilation.bodies.first().ok_or("the file of the human body contains no body")?;
    let bound = project.library.bind(description)?;
    let scene = json!({ "elements": elements::KINDS, "joints": elements::JOINTS, "fields": elements::FIELDS });
    let all = json!({ "signals": signals::SIGNALS, "scene": scene, "body": bound.body.vocabulary(&bound.model) });
    Ok(all.to_string())
}
