//! Warnings about single formulas, found where they are checked: what compiles, but is probably not what was meant.
//!
//! Those that need a whole task are the `lint`s.

mod degrees;
mod folded;
mod repeated;
mod slips;
