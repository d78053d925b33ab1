//! Which protocol an evaluation follows.

use super::Args;
use crate::error::Error;
use crate::project::Project;
use msk::evaluate::sweep::SweepProtocol;
use msk::evaluate::{Plan, Protocol};

/// The protocol of an evaluation, and what there is to choose from.
pub(super) struct Chosen {
    /// Its name in the suite; empty if it has none.
    name: String,
    /// Names of the others.
    others: Vec<String>,
    pub protocol: Protocol,
    /// Along what it sweeps; if it does not, the first protocol of the suite that does, or the paper's.
    pub sweep: SweepProtocol,
}

impl Chosen {
    /// The command line wins over the suite, the suite over the usual protocol.
    pub fn of(args: &Args, project: &Project) -> Result<Self, Error> {
        let protocols = || project.compilation.suites.iter().flat_map(|suite| &suite.protocols);
        let names = || protocols().map(|protocol| protocol.name.clone()).filter(|name| !name.is_empty());
        let of_suite = match &args.protocol {
            None => protocols().next(),
            Some(name) => Some(protocols().find(|protocol| protocol.name == *name).ok_or_else(|| {
                let known = names().collect::<Vec<_>>().join(", ");
                let hint = if known.is_empty() {
                    "a suite declares one as in `protocol quick { episodes 5, seed 0 }`".to_owned()
                } else {
                    format!("protocols are {known}")
                };
                Error::new(format!("`{}` has no protocol `{name}`", args.file.display())).hint(hint)
            })?),
        };
        let usual = msk::compiler::Protocol::default();
        let from = of_suite.unwrap_or(&usual);
        let others = names().filter(|name| *name != from.name).collect();
        let protocol = Protocol { episodes: args.episodes.unwrap_or(from.episodes.into()), seed: args.seed.unwrap_or(from.seed) };
        // With another number of episodes it is no longer the protocol of that name.
        let name = if protocol.episodes == u64::from(from.episodes) { from.name.clone() } else { String::new() };
        let sweep = from.sweep.as_ref().or_else(|| protocols().find_map(|protocol| protocol.sweep.as_ref()));
        Ok(Self { name, others, protocol, sweep: sweep.cloned().unwrap_or_default() })
    }

    /// What is going to be run.
    pub fn heading(&self, plan: &Plan, policies: &[&str]) -> String {
        let count = |number: usize, one: &str| format!("{number} {one}{}", if number == 1 { "" } else { "s" });
        let tasks = count(plan.trials.len(), "task");
        let episodes = count(usize::try_from(self.protocol.episodes).unwrap_or(usize::MAX), "episode");
        let protocol = match (self.name.as_str(), self.others.as_slice()) {
            ("", _) => String::new(),
            (name, []) => format!(" (protocol {name})"),
            (name, others) => format!(" (protocol {name}; there is also {})", others.join(", ")),
        };
        let acting = if policies.len() == 1 { "policy" } else { "policies" };
        let shard = if plan.shard.is_whole() { String::new() } else { format!(", shard {}", plan.shard) };
        format!("{tasks}, {episodes} each{protocol}{shard}, seed {}, {acting} {}", self.protocol.seed, policies.join("; "))
    }
}
