//! Every syntax code's page tells the truth: its example causes the code, its fix does not.

use msk_compiler::diagnostics::{FileId, codes, lints};
use msk_compiler::syntax::parse;
use std::collections::BTreeSet;

/// Pages whose example is a description because the text would be too long.
const DESCRIBED: [&str; 5] = ["E0121", "E0122", "E0123", "E0127", "E0131"];

#[test]
fn examples_of_syntax_codes_cause_them_and_fixes_do_not() {
    let mut wrong = Vec::new();
    for code in codes::syntax::ALL.iter().filter(|code| !DESCRIBED.contains(&code.id)) {
        let found: Vec<&str> =
            parse(FileId::default(), code.example).diagnostics.iter().map(|diagnostic| diagnostic.code.id).collect();
        if found != [code.id] {
            wrong.push(format!("{}: its example gives {found:?}", code.id));
        }
        let left: Vec<String> =
            parse(FileId::default(), code.fix).diagnostics.iter().map(|diagnostic| diagnostic.message.clone()).collect();
        if !left.is_empty() {
            wrong.push(format!("{}: its fix gives {left:?}", code.id));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn codes_are_unique_and_in_order() {
    let ids: Vec<&str> = codes::all().map(|code| code.id).collect();
    assert!(ids.windows(2).all(|pair| pair[0][1..] < pair[1][1..]), "{ids:?}");
    assert_eq!(codes::find("e0101").map(|code| code.id), Some("E0101"));
}

#[test]
fn every_warning_is_a_lint_under_a_name_of_its_own() {
    let named: BTreeSet<&str> = lints().map(|(_, lint)| lint.name).collect();
    let warnings: Vec<_> = codes::all().filter(|code| code.id.starts_with('W')).collect();
    assert!(warnings.iter().all(|code| code.lint.is_some()) && named.len() == warnings.len());
    assert_eq!(lints().find(|(code, _)| !code.id.starts_with('W')), None);
    let plain = |name: &&str| name.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'_') && **name != *"warnings";
    assert!(named.iter().all(plain), "{named:?}");
}
