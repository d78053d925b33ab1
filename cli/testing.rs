//! For the tests of one's own tasks: what a task means, held by a snapshot (feature `insta`).
//!
//! ```toml
//! [dev-dependencies]
//! msk = { version = "0.1", features = ["insta"] }
//! ```
//!
//! ```no_run
//! #[test]
//! fn the_reward_of_crouch() {
//!     msk::assert_task_snapshot!("tasks/crouch.msk", "crouch");
//! }
//! ```
//!
//! The first run writes the snapshot, `cargo insta review` accepts it. From then on the test fails when a term, a weight, a
//! range, a threshold, an observation, an end, the scene or the initial state means something else; comments and layout do not
//! matter. A change of one term changes that term's section of the snapshot only.

use crate::compiler::compile;
use crate::runtime::library::{BodyLibrary, FileLoader};
use std::path::Path;

pub use insta;

/// The snapshot of a task of a file, as text.
///
/// # Errors
/// The diagnostics of the file, or that it holds no task of that name.
pub fn snapshot(file: &Path, task: &str) -> Result<String, String> {
    let compilation = compile(file, &FileLoader, &BodyLibrary::default()).map_err(|report| report.to_string())?;
    match compilation.tasks.iter().find(|known| known.name == task) {
        Some(task) => Ok(task.snapshot().to_string()),
        None => {
            let known: Vec<&str> = compilation.tasks.iter().map(|task| task.name.as_str()).collect();
            Err(format!("`{}` contains no task `{task}`; it contains: {}", file.display(), known.join(", ")))
        }
    }
}

/// Asserts that a task means what its snapshot records: `assert_task_snapshot!("tasks/crouch.msk", "crouch")`. The path is
/// relative to the package. Panics with the diagnostics if the file does not compile.
#[macro_export]
macro_rules! assert_task_snapshot {
    ($path:expr, $task:expr) => {{
        let file = ::std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join($path);
        match $crate::testing::snapshot(&file, $task) {
            Ok(text) => $crate::testing::insta::assert_snapshot!($task, text),
            Err(problem) => panic!("{problem}"),
        }
    }};
}
