//! Numbers, points and goals as written on the command line.

use super::{Goal, GoalAt, geo_uri, is_geo_uri, tidy_name};
use maps::Point;
use plan_format::limits;

/// Reads a goal, `NAME=X,Y` in the map's metres or `NAME=geo:LAT,LON`, or several of one name,
/// `NAME=X,Y;X,Y`; otherwise returns the reason why it is not one.
pub fn goal(text: &str) -> Result<Goal, String> {
    let example = "write NAME=X,Y, for example gate=12.5,-40";
    let missing = || match pair(text) {
        Ok(_) => format!("a goal needs a name: write NAME={}, for example gate={}", text, text),
        Err(_) => example.to_owned(),
    };
    // A name may contain `=`, and so may the parameters of a `geo:` URI.
    let first = text.split(';').next().unwrap_or(text);
    let is_place = |at: &usize| is_geo_uri(&text[at + 1..]);
    let place = first.match_indices('=').map(|(at, _)| at).find(is_place);
    let equals = place.or_else(|| first.rfind('=')).ok_or_else(missing)?;
    let name = tidy_name(&text[..equals])?.to_owned();
    let mut at: Vec<GoalAt> = Vec::new();
    for member in members(&text[equals + 1..]) {
        at.push(if is_geo_uri(&member) {
            GoalAt::Globe(geo_uri(&member)?)
        } else {
            GoalAt::Position(pair(&member).map_err(|reason| format!("{reason}; {example}"))?)
        });
    }
    if at.len() > limits::MAX_GOALS {
        return Err(format!("{} positions, but a plan leads to {}", at.len(), limits::MAX_GOALS));
    }
    Ok(Goal { name, at, layers: None, place: None })
}

/// The parts between semicolons. A `geo:` URI keeps its parameters, `;NAME=VALUE`.
fn members(text: &str) -> Vec<String> {
    let mut members: Vec<String> = Vec::new();
    for part in text.split(';') {
        let is_parameter = part.contains('=') || part.is_empty();
        match members.last_mut().filter(|last| is_parameter && is_geo_uri(last)) {
            Some(last) => *last = format!("{last};{part}"),
            None => members.push(part.to_owned()),
        }
    }
    members
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
