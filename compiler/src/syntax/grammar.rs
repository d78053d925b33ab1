//! The parser that pest makes of `grammar/msk.pest`.

use pest_derive::Parser;

/// Parses masked text.
#[derive(Parser)]
#[grammar = "../../grammar/msk.pest"]
pub(super) struct Grammar;

/// A node of pest's parse.
pub(super) type Pair<'a> = pest::iterators::Pair<'a, Rule>;
