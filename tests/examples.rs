//! Every example compiles, without a warning.
#![allow(clippy::expect_used, clippy::panic, reason = "tests")]

use msk::compiler;
use msk_runtime::library::{BodyLibrary, FileLoader};
use std::{fs, path::Path};

#[test]
fn every_example_compiles_without_a_remark() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<_> = fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "msk"));
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let compilation = compiler::compile(&file, &FileLoader, &BodyLibrary::default())
            .unwrap_or_else(|report| panic!("{}:\n{report}", file.display()));
        assert!(compilation.warnings.is_empty(), "{}: {:?}", file.display(), compilation.warnings);
        assert!(!compilation.tasks.is_empty(), "{} holds no task", file.display());
    }
}
