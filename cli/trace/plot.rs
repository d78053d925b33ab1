//! `msk trace plot`: columns of a trace over time.

use crate::error::Error;
use crate::output;
use crate::terminal;
use msk::draw::chart::{self, Chart, Panel};
use msk::evaluate::trace::{Quantity, Trace};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Most curves of a panel.
const MOST_CURVES: usize = 12;

/// Draw columns of a trace over time, as SVG
#[derive(clap::Args)]
pub struct Args {
    /// The trace
    trace: PathBuf,
    /// Columns, each QUANTITY or QUANTITY/NAME, where NAME may have `*` for any letters: a panel for each. Of muscles without a
    /// name the means of the recruitment families are drawn [default: what there is of activations, ground_reactions,
    /// center_of_mass, terms]
    #[arg(value_name = "COLUMNS")]
    columns: Vec<String>,
    /// The file to write; without it, standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Draws.
///
/// # Errors
/// A file that is no trace, columns that it does not have, or an output that cannot be written.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let trace = super::read(&args.trace)?;
    let usual = [Quantity::Activations, Quantity::GroundReactions, Quantity::CenterOfMass, Quantity::Terms];
    let there = usual.into_iter().filter(|quantity| trace.rows_of(*quantity) > 0).map(|quantity| quantity.name().to_owned());
    let wanted: Vec<String> = if args.columns.is_empty() { there.collect() } else { args.columns.clone() };
    let panels = wanted.iter().map(|text| panel(&trace, text)).collect::<Result<Vec<_>, _>>()?;
    let origin = &trace.origin;
    let title = format!("{}, {}, seed {}, episode {}", origin.task, origin.policy, origin.seed, origin.episode);
    let chart = Chart { title, axis: "time [s]".into(), at: trace.times(), panels, bands: Vec::new() };
    let picture = chart::svg(&chart);
    match &args.out {
        Some(path) => output::write(path, picture)?,
        None => terminal::bytes().write_all(picture.as_bytes())?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The panel of `QUANTITY` or `QUANTITY/NAME`.
fn panel(trace: &Trace, text: &str) -> Result<Panel, Error> {
    let (word, name) = text.split_once('/').map_or((text, None), |(word, name)| (word, Some(name)));
    let quantity: Quantity = word.parse().map_err(|error| Error::usage(format!("{error}")))?;
    let layout = trace.layout();
    let block = layout.block(quantity).ok_or_else(|| {
        let known = layout.blocks.iter().map(|block| block.quantity.name()).collect::<Vec<_>>().join(", ");
        Error::new(format!("the trace has no {quantity}")).hint(format!("it has {known}"))
    })?;
    let of_muscles = block.columns.len() == layout.muscles.len() && block.columns[0].name == layout.muscles[0].name;
    let of_families = name.is_none() && of_muscles && block.columns.len() > MOST_CURVES;
    let curves = match name {
        None if of_families => families(trace, quantity),
        name => {
            let wanted = |place: &usize| name.is_none_or(|name| matches(name, &block.columns[*place].name));
            let places: Vec<usize> = (0..block.columns.len()).filter(wanted).collect();
            let curve = |place: usize| (block.columns[place].name.clone(), column(trace, quantity, place));
            places.into_iter().take(MOST_CURVES).map(curve).collect::<Vec<_>>()
        }
    };
    if curves.is_empty() {
        let known = block.columns.iter().take(MOST_CURVES).map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ");
        let message = format!("no column of {quantity} is called `{}`", name.unwrap_or_default());
        return Err(
            Error::new(message).hint(format!("there are {known}{}", if block.columns.len() > MOST_CURVES { " ..." } else { "" }))
        );
    }
    let units = block.columns.iter().filter(|column| of_families || curves.iter().any(|(name, _)| *name == column.name));
    let mut units: Vec<&str> = units.map(|column| column.unit.as_str()).filter(|unit| !unit.is_empty()).collect();
    units.dedup();
    let unit = if let [unit] = units.as_slice() { format!(" [{unit}]") } else { String::new() };
    Ok(Panel { label: format!("{}{unit}", quantity.name().replace('_', " ")), curves })
}

/// A column with a value for every state: what belongs to steps has none at the reset.
fn column(trace: &Trace, quantity: Quantity, place: usize) -> Vec<f64> {
    let values = trace.column(quantity, place).unwrap_or_default();
    let before = trace.rows() - values.len();
    std::iter::repeat_n(f64::NAN, before).chain(values).collect()
}

/// The means of the recruitment families, the largest first.
fn families(trace: &Trace, quantity: Quantity) -> Vec<(String, Vec<f64>)> {
    let layout = trace.layout();
    let mean = |family: &String| {
        let members: Vec<usize> = (0..layout.muscles.len()).filter(|&muscle| layout.muscles[muscle].family == *family).collect();
        let of_row = |row: &[f64]| members.iter().map(|&muscle| row[muscle]).sum::<f64>() / members.len() as f64;
        (family.clone(), trace.block(quantity).map(of_row).collect::<Vec<f64>>())
    };
    let mut curves: Vec<(String, Vec<f64>)> = layout.families.iter().map(mean).collect();
    let size = |(_, values): &(String, Vec<f64>)| values.iter().sum::<f64>();
    curves.sort_by(|a, b| size(b).total_cmp(&size(a)));
    curves.truncate(MOST_CURVES);
    curves
}

/// Whether a name is as a pattern has it, in which `*` stands for any letters.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((head, rest)) => {
            let Some(tail) = name.strip_prefix(head) else { return false };
            let ends = tail.char_indices().map(|(at, _)| at).chain([tail.len()]);
            ends.into_iter().any(|at| matches(rest, &tail[at..]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_stands_for_any_letters() {
        assert!(
            matches("soleus_*", "soleus_l") && matches("*_l", "soleus_l") && matches("*", "") && matches("s*s_*", "soleus_l")
        );
        assert!(!matches("soleus", "soleus_l") && !matches("*_r", "soleus_l") && !matches("", "a"));
    }
}
