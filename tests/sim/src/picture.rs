//! A robot's route as text, for the message of a failing test.

use crate::{Point, World};

/// Draws obstacles as `#`, the route as `.`, its start `S`, its end `E` and the goal `G`. North is
/// up; one character covers `metres` from west to east and twice that from south to north.
pub fn text(world: &World, route: &[Point], goal: Point, metres: f64) -> String {
    let Some([low, high]) = world.bounds() else { return String::new() };
    let columns = ((high[0] - low[0]) / metres) as usize + 1;
    let rows = ((high[1] - low[1]) / (2.0 * metres)) as usize + 1;
    let mut canvas = vec![vec![' '; columns]; rows];
    for (row, line) in canvas.iter_mut().enumerate() {
        for (column, character) in line.iter_mut().enumerate() {
            let x = low[0] + (column as f64 + 0.5) * metres;
            let y = low[1] + (row as f64 + 0.5) * 2.0 * metres;
            if !world.is_clear([x, y], metres / 2.0) {
                *character = '#';
            }
        }
    }
    let mut put = |at: Point, character: char| {
        let column = ((at[0] - low[0]) / metres) as usize;
        let row = ((at[1] - low[1]) / (2.0 * metres)) as usize;
        if let Some(cell) = canvas.get_mut(row).and_then(|line| line.get_mut(column)) {
            *cell = character;
        }
    };
    route.iter().for_each(|&at| put(at, '.'));
    put(goal, 'G');
    route.first().into_iter().for_each(|&at| put(at, 'S'));
    route.last().into_iter().for_each(|&at| put(at, 'E'));
    let lines = canvas.iter().rev().map(|line| line.iter().collect::<String>());
    lines.map(|line| line.trim_end().to_owned() + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::Shape;

    #[test]
    fn north_is_up() {
        let wall = Shape::Polyline(vec![[0.5, 5.0], [6.5, 5.0]]);
        let low = Shape::Circle { centre: [7.5, 0.5], radius: 0.5 };
        let world = World::new([&wall, &low]);
        let picture = text(&world, &[[1.0, 1.0], [3.0, 1.0], [4.5, 2.5]], [6.0, 3.0], 1.0);
        assert_eq!(picture, "######\n    EG\nS .   ##\n");
    }
}
