//! The one reader of TOML, for mission files and what they say about behaviours.
//!
//! [`Fields`] takes typed values out of a table; [`Report`] gathers every mistake with its place
//! and words the same mistake in the same way everywhere.

mod fields;
mod report;
mod syntax;

pub(crate) use fields::{Fields, key_span};
pub(crate) use report::{Report, part_of};
pub use report::{Span, Spanned, Text};

use toml_edit::Value;

/// A TOML integer or float.
pub(crate) fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|integer| integer as f64))
}
