//! Points as people and programs write them, one per line.
//!
//! `X Y`, `X,Y`, columns of a table separated by tabs or semicolons, `[X, Y]`; a pose `X Y
//! HEADING`, whose heading is ignored; and named numbers as in ROS messages and JSON, `{x: X, y: Y,
//! z: 0}`, where the first `x` and the first `y` are used. Empty lines, lines that begin with `#`
//! and a table's head `x,y` contain no point.

use plan_compiler::mission::words::number;

/// The point in a line; `None` if the line contains none.
pub(super) fn point(line: &str) -> Result<Option<[f64; 2]>, String> {
    // Programs on Windows begin a file with a byte order mark.
    let line = line.trim_start_matches('\u{feff}').trim();
    if line.starts_with('#') || line == "---" {
        return Ok(None);
    }
    let is_between = |c: char| c.is_whitespace() || ",;:={}[]()\"'".contains(c);
    let words: Vec<&str> = line.split(is_between).filter(|word| !word.is_empty()).collect();
    if words.iter().any(|word| word.parse::<f64>().is_err()) {
        return named(&words);
    }
    match words[..] {
        [] if line.is_empty() => Ok(None),
        [x, y] | [x, y, _] => {
            words.iter().try_for_each(|word| number(word).map(drop))?;
            Ok(Some([number(x)?, number(y)?]))
        }
        _ => Err(format!("{} numbers, not a point or a pose", words.len())),
    }
}

/// The point in words and numbers: each number belongs to the word before it.
fn named(words: &[&str]) -> Result<Option<[f64; 2]>, String> {
    let mut found = [None; 2];
    let mut is_head = true;
    let mut last = None;
    for word in words {
        if word.parse::<f64>().is_err() {
            last = Some(word.to_ascii_lowercase());
            continue;
        }
        is_head = false;
        let slot = match last.take().as_deref() {
            Some("x") => &mut found[0],
            Some("y") => &mut found[1],
            _ => continue,
        };
        if slot.is_none() {
            *slot = Some(number(word)?);
        }
    }
    let has = |name: &str| words.iter().any(|word| word.eq_ignore_ascii_case(name));
    match found {
        [Some(x), Some(y)] => Ok(Some([x, y])),
        [None, None] if is_head && has("x") && has("y") => Ok(None),
        [Some(_), None] => Err("y is missing".into()),
        [None, Some(_)] => Err("x is missing".into()),
        [None, None] => {
            let is_word = |word: &&&str| word.parse::<f64>().is_err();
            let word = words.iter().find(is_word).copied().unwrap_or_default();
            Err(format!("`{word}` is not a number"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_read_as_people_and_programs_write_them() {
        for line in [
            "1 -2.5",
            " 1\t-2.5 \r",
            "\u{feff}1 -2.5",
            "1,-2.5",
            "1, -2.5",
            "1;-2.5",
            "[1, -2.5]",
            "(1.0, -2.5e0)",
            "1 -2.5 0.7",
            "1,-2.5,3.14",
            "x: 1 y: -2.5",
            "x=1, y=-2.5",
            "{\"x\":1,\"y\":-2.5,\"cost_m\":null}",
            "{y: -2.5, x: 1, yaw: 0.3}",
            "{position: {x: 1.0, y: -2.5, z: 0.0}, orientation: {x: 0, y: 0, z: 0, w: 1}}",
        ] {
            assert_eq!(point(line), Ok(Some([1.0, -2.5])), "{line}");
        }
        for line in
            ["", "\u{feff}", "\u{feff}x,y", "  ", "# a comment 1 2", "x,y", "x\ty\tyaw", "---"]
        {
            assert_eq!(point(line), Ok(None), "{line}");
        }
        for (line, expected) in [
            ("1", "1 numbers"),
            ("1 2 3 4", "4 numbers"),
            ("one two", "`one` is not a number"),
            ("1 two", "`two` is not a number"),
            ("nan 1", "`nan` is not a finite number"),
            ("1 inf", "`inf` is not a finite number"),
            ("1 1e999", "not a finite number"),
            ("x: 1", "y is missing"),
            ("y: 1", "x is missing"),
            ("x: nan y: 1", "not a finite number"),
            (",", "0 numbers"),
        ] {
            let reason = point(line).expect_err(line);
            assert!(reason.contains(expected), "{line}: {reason}");
        }
    }
}
