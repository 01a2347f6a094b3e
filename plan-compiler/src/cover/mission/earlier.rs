//! What an earlier run of `cover` wrote into a mission, told from what the user wrote.
//!
//! Names decide, and only in a file that `cover` wrote: `strip 3` of a user's own mission is the user's.

use super::{AT_STRIP, COVER, DONE, OURS, is_title};
use std::collections::BTreeSet;
use toml_edit::{DocumentMut, Item, TableLike};

/// The names of an earlier run.
pub(super) struct Earlier {
    /// Whether there was one.
    was: bool,
    /// Those that the next run writes anew: tables and keys.
    old: BTreeSet<[String; 2]>,
}

impl Earlier {
    /// What an earlier run wrote into this text.
    pub(super) fn of(text: &str, document: &DocumentMut) -> Self {
        let has_title = text.lines().any(is_title);
        let plan = table(document, "frames").and_then(|frames| frames.get(COVER));
        let was =
            has_title || plan.is_some_and(|plan| plan.to_string().contains("entry -> strips 1"));
        if !was {
            return Self { was, old: BTreeSet::new() };
        }
        let names = |name: &str, is_ours: &dyn Fn(&str) -> bool| {
            let all = table(document, name).into_iter().flat_map(TableLike::iter);
            let ours = all.map(|(key, _)| key.to_owned()).filter(|key| is_ours(key));
            ours.map(|key| [name.to_owned(), key]).collect::<Vec<_>>()
        };
        let has = |name: &str, key: &str| {
            table(document, name).is_some_and(|table| table.contains_key(key))
        };
        let is_plan = |key: &str| {
            key.strip_prefix("go to ").is_some_and(|strip| is_strip(strip) && has("frames", strip))
        };
        let old = [
            names("goals", &|key| is_strip(key) && has("actions", &format!("go to {key}"))),
            names("frames", &|key| is_strip(key) || is_group(key)),
            names("actions", &|key| is_plan(key) || OURS.contains(&key)),
        ];
        Self { was, old: old.into_iter().flatten().collect() }
    }

    /// Removes what the next run writes anew.
    pub(super) fn forget(&self, document: &mut DocumentMut) {
        for [name, key] in &self.old {
            if let Some(table) = document.get_mut(name).and_then(Item::as_table_like_mut) {
                table.remove(key);
            }
        }
    }

    /// Whether a key is one that every run writes, where it stands.
    pub(super) fn stays(&self, name: &str, key: &str) -> bool {
        let names =
            [("behaviours", COVER), ("frames", COVER), ("facts", DONE), ("facts", AT_STRIP)];
        self.was && names.contains(&(name, key))
    }
}

fn table<'d>(document: &'d DocumentMut, name: &str) -> Option<&'d dyn TableLike> {
    document.get(name).and_then(Item::as_table_like)
}

/// The behaviours of a mission besides `cover`, whose plans may lead the robot away from its strip.
pub fn other_behaviours(text: &str) -> Vec<String> {
    let Ok(document) = text.parse::<DocumentMut>() else { return Vec::new() };
    let all = table(&document, "behaviours").into_iter().flat_map(TableLike::iter);
    all.map(|(name, _)| name.to_owned()).filter(|name| name != COVER).collect()
}

/// `strip 3`.
fn is_strip(name: &str) -> bool {
    name.strip_prefix("strip ").is_some_and(is_number)
}

/// `strips 1 to 8`, or `strips 9`.
fn is_group(name: &str) -> bool {
    let Some(numbers) = name.strip_prefix("strips ") else { return false };
    match numbers.split_once(" to ") {
        Some((first, last)) => is_number(first) && is_number(last),
        None => is_number(numbers),
    }
}

fn is_number(text: &str) -> bool {
    text.parse::<usize>().is_ok_and(|number| number > 0 && number.to_string() == text)
}
