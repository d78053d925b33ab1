//! A folder with a small task, and the program run in it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Twenty steps of the human body, with an end that lies within reach.
pub const LEAN: &str = r#"//! A short task.

task lean {
    family   stabilization
    body     human
    control  100 Hz
    horizon  20 steps

    init {
        pose neutral
        root { height on ground }
        noise joints     normal(0, 0.02 rad)
        noise velocities normal(0, 0.2 rad/s)
    }

    observe { pelvis.height }

    reward {
         10    pose   = exp(-norm(independent.q - independent.neutral) / 1 rad)
          5    alive  = not terminated
         -1    effort = mean(muscles.activation^2)
    }

    terminate { sunk when pelvis.height < neutral(pelvis.height) - 2 cm }

    success survived
}
"#;

/// A temporary folder, removed when dropped.
pub struct Project {
    folder: tempfile::TempDir,
}

impl Project {
    /// An empty folder.
    pub fn empty() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A folder with `lean.msk` and a suite of it in `tasks.msk`.
    pub fn lean() -> Self {
        let project = Self::empty();
        project.write("lean.msk", LEAN);
        project.write(
            "tasks.msk",
            "use \"lean.msk\"\n\nsuite short {\n    family stabilization { lean }\n    protocol { episodes 3, seed 5 }\n}\n",
        );
        project
    }

    /// Path of `name` in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file, and the folders that it lies in.
    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// The text of a file.
    pub fn read(&self, name: impl AsRef<Path>) -> String {
        let path = self.folder.path().join(name);
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// The program in this folder, without a terminal.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_msk"));
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs the program to its end.
    pub fn msk(&self, arguments: &[&str]) -> Done {
        Done::from(self.command(arguments).output().unwrap())
    }
}

/// What the program left.
#[derive(Debug)]
pub struct Done {
    /// Exit code; `None` if it was ended by a signal.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl From<Output> for Done {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Done {
    /// Panics unless the program succeeded.
    pub fn succeeded(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// Panics unless the program failed with `code` and one message that holds all of `parts`, without a panic.
    pub fn failed(self, code: i32, parts: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert!(!self.err.contains("panicked"), "{}", self.err);
        for part in parts {
            assert!(self.err.contains(part), "no `{part}` in:\n{}", self.err);
        }
        assert!(self.err.matches("error").count() >= 1, "{}", self.err);
        self
    }
}

/// The lines of a journal: they have the same bytes in the same order, whatever happened meanwhile.
pub fn journal(text: &str) -> Vec<String> {
    text.lines().map(str::to_owned).collect()
}
