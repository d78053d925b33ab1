//! Formulas as mathematics: what a paper would print.
//!
//! [`mathematics`] writes a formula in plain characters, close to its text. For print, a formula first becomes a tree of
//! mathematics ([`Formula`], built by `build` with the symbols of `letters`), which `latex` and `mathml` write.

mod build;
mod latex;
mod letters;
mod mathml;
mod plain;
mod reads;

pub(crate) use latex::{latex, words as latex_words};
pub(crate) use mathml::mathml;
pub(crate) use plain::mathematics;
pub(crate) use reads::names_in;

use crate::syntax::tree::Expr;
use msk_program::formula::{Fence, Formula, Letter, Notation, Sign};

/// A formula that counts as a number, or a condition that is asked.
pub(crate) fn notation(expr: &Expr) -> Notation {
    Notation { plain: mathematics(expr), tree: build::formula(expr) }
}

/// A condition that counts 0 or 1.
pub(crate) fn indicator(expr: &Expr) -> Notation {
    Notation { plain: mathematics(expr), tree: build::condition(expr) }
}

/// A condition for which something waits: without brackets around it.
pub(crate) fn clause(expr: &Expr) -> Notation {
    Notation { plain: mathematics(expr), tree: build::formula(build::bare(expr)) }
}
