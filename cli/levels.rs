//! `--deny`, `--warn`, `--allow`: levels of lints on the command line, in the order in which they stand there.

use clap::{Arg, ArgAction, ArgMatches, Command, Error, FromArgMatches};
use msk::compiler::diagnostics::{Level, Levels, Lints};

/// The levels that a command line sets.
#[derive(Debug, Clone, Default)]
pub struct LevelArgs {
    /// Later settings win.
    pub levels: Levels,
}

/// Each option with what it sets and its help.
const OPTIONS: [(&str, Level, &str); 3] = [
    (
        "deny",
        Level::Deny,
        "Turn the warnings of a lint into errors: a name (`unused`), a code (`W0507`), or `warnings` for all. Can be repeated and combined with --warn and --allow; the last one that matches a lint applies. `msk help lints` lists all lints",
    ),
    ("warn", Level::Warn, "Report a lint as a warning, after a more general --deny or --allow"),
    ("allow", Level::Allow, "Do not report a lint. In a file `allow LINT \"REASON\"` does so for one place"),
];

/// A lint as it was named.
#[derive(Debug, Clone)]
struct Named {
    lints: Lints,
    name: String,
}

impl clap::Args for LevelArgs {
    fn augment_args(command: Command) -> Command {
        OPTIONS.iter().fold(command, |command, (name, _, help)| {
            let parse = |name: &str| Lints::named(name).map(|lints| Named { lints, name: name.to_owned() });
            let option = Arg::new(*name).long(*name).value_name("LINT").action(ArgAction::Append);
            command.arg(option.value_parser(parse).help(*help))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for LevelArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut settings: Vec<(usize, &str, Level, &Named)> = Vec::new();
        for (option, level, _) in OPTIONS {
            let places = matches.indices_of(option).into_iter().flatten();
            let named = matches.get_many::<Named>(option).into_iter().flatten();
            settings.extend(places.zip(named).map(|(place, named)| (place, option, level, named)));
        }
        settings.sort_by_key(|(place, ..)| *place);
        let mut levels = Levels::default();
        for (_, option, level, named) in settings {
            levels.set(named.lints, level, format!("--{option} {}", named.name));
        }
        Ok(Self { levels })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
