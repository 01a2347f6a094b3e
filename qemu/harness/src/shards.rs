//! Files of shards that are put together to the one of a whole campaign.

/// What a file of a shard has: its name, its campaign, and what was run.
pub type Part<C, T> = (String, C, Vec<T>);

/// Puts the parts of one campaign together, sorted by `key`. `told` is a campaign's text, `twice` the
/// message about something that is in two files. The error is a message for the user.
pub fn merge<C: PartialEq, T, K: Ord>(
    parts: Vec<Part<C, T>>,
    told: impl Fn(&C) -> String,
    key: impl Fn(&T) -> K,
    twice: impl Fn(&T) -> String,
) -> Result<(C, Vec<T>), String> {
    let mut parts = parts.into_iter();
    let (first, campaign, mut merged) = parts.next().ok_or("no file to merge")?;
    for (name, other, more) in parts {
        if other != campaign {
            return Err(format!(
                "{name} and {first} are of different campaigns: {}; {}",
                told(&other),
                told(&campaign)
            ));
        }
        merged.extend(more);
    }
    merged.sort_by_key(&key);
    match merged.windows(2).find(|pair| key(&pair[0]) == key(&pair[1])) {
        Some(pair) => Err(twice(&pair[0])),
        None => Ok((campaign, merged)),
    }
}
