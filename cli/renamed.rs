//! Options that had another name: a command line with the former one is answered with the present one.

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// The former names of options, with the present ones.
const OPTIONS: [(&str, &str); 4] = [
    ("--past-ends", "--ignore-terminations"),
    ("--again", "--replay"),
    ("--most", "--max-survivors"),
    ("--surroundings", "--include-scene"),
];

/// Adds the present name to an error about a former one, in place of options that are only spelled alike.
pub fn with_present_name(mut error: clap::Error) -> clap::Error {
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    let Some(ContextValue::String(written)) = error.get(ContextKind::InvalidArg) else { return error };
    let written = written.split('=').next().unwrap_or_default();
    let Some((former, present)) = OPTIONS.iter().find(|(former, _)| *former == written) else { return error };
    let tip = format!("`{former}` is now `{present}`").into();
    error.remove(ContextKind::SuggestedArg);
    error.remove(ContextKind::TrailingArg);
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip]));
    error
}
