//! Numbers, points and goals as written on the command line.

use super::{Goal, GoalAt, geo_uri, is_geo_uri, tidy_name};
use maps::Point;
use plan_format::limits;

/// Reads a goal, `NAME=X,Y` in the map's metres or `NAME=geo:LAT,LON`, or several of one name,
/// `NAME=X,Y;X,Y`; otherwise returns the reason why it is not one.
pub fn goal(text: &str) -> Result<Goal, String> {
    let goal = named(text, "goal", "gate")?;
    if goal.at.len() > limits::MAX_GOALS {
        let count = goal.at.len();
        return Err(format!("{count} positions, but a plan leads to {}", limits::MAX_GOALS));
    }
    Ok(goal)
}

/// Reads a place that a radio reaches, as a goal with one position.
pub fn place(text: &str) -> Result<Goal, String> {
    let place = named(text, "place", "base")?;
    match place.at.len() {
        1 => Ok(place),
        count => Err(format!("{count} positions, but a place has one: give each as a place")),
    }
}

/// Reads a name and its positions. `what` has the name, for example `example`.
fn named(text: &str, what: &str, example: &str) -> Result<Goal, String> {
    let like = example;
    let example = format!("write NAME=X,Y, for example {like}=12.5,-40");
    let missing = || match pair(text) {
        Ok(_) => format!("a {what} needs a name: write NAME={text}, for example {like}={text}"),
        Err(_) => example.clone(),
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
