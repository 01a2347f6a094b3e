//! Lists of turns, shortened where the same turns come again and again.

use super::story::Turn;
use std::fmt;

/// Turns that repeat in groups of up to this many are folded.
const MAX_GROUP: usize = 12;
/// Groups that come in a row more often than this are folded.
const MAX_SHOWN: usize = 3;

/// A line of a list of turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line<'t> {
    /// A turn.
    Turn(&'t Turn),
    /// The last lines came again.
    Again(Again),
}

/// How often a group of lines came again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Again {
    /// Lines of the group.
    pub lines: usize,
    /// How many times it came again.
    pub times: usize,
    /// Time of the last turn of the last time, seconds since the robot's start.
    pub until_s: f64,
}

impl fmt::Display for Again {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.lines {
            1 => f.write_str("this line")?,
            lines => write!(f, "these {lines} lines")?,
        }
        write!(f, " {} times more, until {:.2} s", self.times, self.until_s)
    }
}

/// The turns as lines. A group of turns with the same texts that comes more than three times in a row
/// is shown once, with how often it comes again. Places and times may differ.
pub fn folded(turns: &[Turn]) -> Vec<Line<'_>> {
    let mut lines = Vec::new();
    let mut at = 0;
    while at < turns.len() {
        let left = &turns[at..];
        let times_of = |group: usize| {
            let same = left.iter().zip(&left[group..]).take_while(|(a, b)| a.text == b.text);
            1 + same.count() / group
        };
        let groups = 1..=MAX_GROUP.min(left.len() - 1);
        let repeating = groups.map(|group| (group, times_of(group)));
        match repeating.into_iter().find(|(_, times)| *times > MAX_SHOWN) {
            Some((group, times)) => {
                lines.extend(left[..group].iter().map(Line::Turn));
                let until_s = left[group * times - 1].time_s;
                lines.push(Line::Again(Again { lines: group, times: times - 1, until_s }));
                at += group * times;
            }
            None => {
                lines.push(Line::Turn(&left[0]));
                at += 1;
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(texts: &str) -> String {
        let turns: Vec<Turn> = texts
            .chars()
            .enumerate()
            .map(|(tick, text)| Turn {
                tick,
                time_s: tick as f64,
                at: None,
                interrupted_at_once: None,
                text: text.to_string(),
            })
            .collect();
        let lines = folded(&turns);
        let text = |line: &Line<'_>| match line {
            Line::Turn(turn) => turn.text.clone(),
            Line::Again(Again { lines, times, until_s }) => {
                format!("({lines} x {times} until {until_s})")
            }
        };
        lines.iter().map(text).collect()
    }

    #[test]
    fn what_comes_again_and_again_is_shown_once() {
        for (texts, expected) in [
            ("", ""),
            ("a", "a"),
            ("aaa", "aaa"),
            ("aaaa", "a(1 x 3 until 3)"),
            ("xababababy", "xab(2 x 3 until 8)y"),
            ("xabababay", "xabababay"),
            ("abcabcabcabcab", "abc(3 x 3 until 11)ab"),
            ("aabaabaabaab", "aab(3 x 3 until 11)"),
        ] {
            assert_eq!(shown(texts), expected, "{texts}");
        }
    }

    #[test]
    fn what_repeats_is_said_in_words() {
        let words = |lines| Again { lines, times: 7, until_s: 1.5 }.to_string();
        assert_eq!(words(1), "this line 7 times more, until 1.50 s");
        assert_eq!(words(2), "these 2 lines 7 times more, until 1.50 s");
    }
}
