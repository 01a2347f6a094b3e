//! Suggestions for misspelt names, and words that name a choice.

/// The candidate most similar to `word`, for "did you mean"; `None` if none is similar.
///
/// Words longer than 100 bytes and candidates beyond the first 10,000 are not compared.
pub fn nearest<'c>(word: &str, candidates: impl Iterator<Item = &'c str>) -> Option<&'c str> {
    const MAX_WORD_BYTES: usize = 100;
    const MAX_CANDIDATES: usize = 10_000;
    if word.len() > MAX_WORD_BYTES {
        return None;
    }
    let word = word.to_lowercase();
    candidates
        .take(MAX_CANDIDATES)
        .filter(|candidate| candidate.len() <= MAX_WORD_BYTES)
        .map(|candidate| (strsim::jaro_winkler(&word, &candidate.to_lowercase()), candidate))
        .filter(|(similarity, _)| *similarity > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// A choice that command lines and files write as one word.
pub trait Word: Copy + PartialEq + 'static {
    /// Each word, its meaning (for help), and its value.
    const WORDS: &'static [(&'static str, &'static str, Self)];

    /// The word of a value.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|entry| entry.2 == self).map_or("", |entry| entry.0)
    }

    /// The value of a word.
    fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|entry| entry.0 == word).map(|entry| entry.2)
    }
}
