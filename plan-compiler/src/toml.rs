//! The only reader of TOML, for mission files and their behaviour tables.
//!
//! [`Fields`] takes typed values out of a table; [`Report`] collects every mistake with its place
//! and uses the same words for the same mistake.

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
