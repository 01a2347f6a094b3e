//! Numbers, points and goals as written on the command line.

use super::{Goal, GoalAt, geo_uri, is_geo_uri, tidy_name};
use maps::Point;

/// Reads a goal, `NAME=X,Y` in the map's metres or `NAME=geo:LAT,LON`; otherwise returns the reason
/// why it is not one.
pub fn goal(text: &str) -> Result<Goal, String> {
    let example = "write NAME=X,Y, for example gate=12.5,-40";
    let missing = || match pair(text) {
        Ok(_) => format!("a goal needs a name: write NAME={}, for example gate={}", text, text),
        Err(_) => example.to_owned(),
    };
    // A name may contain `=`, and so may the parameters of a `geo:` URI.
    let is_place = |(at, _): &(usize, &str)| is_geo_uri(&text[at + 1..]);
    let place = text.match_indices('=').find(is_place).map(|(at, _)| text.split_at(at));
    let (name, at) = match place {
        Some((name, uri)) => (name, GoalAt::Globe(geo_uri(&uri[1..])?)),
        None => {
            let (name, at) = text.rsplit_once('=').ok_or_else(missing)?;
            (name, GoalAt::Position(pair(at).map_err(|reason| format!("{reason}; {example}"))?))
        }
    };
    let name = tidy_name(name)?.to_owned();
    Ok(Goal { name, at, layers: None, place: None })
}

/// Reads two numbers separated by a comma.
pub fn pair(text: &str) -> Result<Point, String> {
    let (x, y) = text.split_once(',').ok_or("two numbers separated by a comma are needed")?;
    if y.trim().is_empty() {
        return Err("nothing follows the comma: write X,Y without a space, or in quotes".into());
    }
    Ok([number(x)?, number(y)?])
}

/// Reads a finite number.
pub fn number(text: &str) -> Result<f64, String> {
    let number: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if number.is_finite() { Ok(number) } else { Err(format!("`{text}` is not a finite number")) }
}
