//! The gap that a step of a route passes: the nearest blocked cells on either side of it.

use maps::Bitmap;
use math::scalar::wide;
use plan_format::{Cell, Direction};

/// What a step of a route passes between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    /// Free room from side to side through the centre of the step's cell, cells.
    pub(super) cells: f64,
    /// The blocked cells on the near side and on the far side.
    pub(super) sides: [Cell; 2],
}

/// Half the angle of the sector in which a side is searched. A grid's route turns by up to 45
/// degrees from the true direction of travel.
const HALF_ANGLE_RAD: f64 = std::f64::consts::FRAC_PI_3;

/// The gap at a cell that a route leaves in a direction. `None` if a side has no blocked cell
/// within `reach` cells. The grid's edge is not a side.
///
/// The far side lies opposite the near one: otherwise a route that leaves a straight wall would seem
/// to pass between two parts of that wall.
pub(super) fn across(blocked: &Bitmap, at: Cell, travel: Direction, reach: u32) -> Option<Gap> {
    let side = |turn| {
        let unit = Direction::from_code(travel.code() + turn).unit();
        nearest(blocked, at, [unit.x, unit.y].map(f64::from), reach)
    };
    let (left, right) = (side(2)?, side(6)?);
    let near = if left.0 <= right.0 { left } else { right };
    let from_here = |cell: Cell| {
        [(cell.column, at.column), (cell.row, at.row)].map(|(to, at)| f64::from(to) - f64::from(at))
    };
    let [x, y] = from_here(near.1);
    let length = wide::hypot(x, y);
    let far = nearest(blocked, at, [-x / length, -y / length], reach)?;
    let ahead = travel.unit();
    // The sign tells left from right of the route.
    let turn = |[x, y]: [f64; 2]| f64::from(ahead.x) * y - f64::from(ahead.y) * x;
    let is_between = turn([x, y]) * turn(from_here(far.1)) < 0.0;
    is_between.then_some(Gap { cells: near.0 + far.0, sides: [near.1, far.1] })
}

/// Least distance of the middle of a gap from any blocked cell, as a part of the gap's width. In the
/// middle of a true gap it is a half.
const CLEAR: f64 = 0.35;

impl Gap {
    /// Whether nothing stands between the sides: otherwise the gap is only a part of the line
    /// between them.
    pub(super) fn is_clear(&self, blocked: &Bitmap) -> bool {
        let [one, other] = self.sides;
        let middle = Cell::new((one.column + other.column) / 2, (one.row + other.row) / 2);
        let within = wide::ceil(CLEAR * self.cells) as u32;
        // Three sectors of 120 degrees see everything around.
        let sectors = [0.0, 1.0, 2.0].map(|third| third * std::f64::consts::TAU / 3.0);
        let sees = |angle: f64| {
            let axis = [wide::cos(angle), wide::sin(angle)];
            nearest(blocked, middle, axis, within)
        };
        // A gap of one cell has its middle in that cell.
        let limit = CLEAR * self.cells - 0.5;
        !blocked.get(middle)
            && sectors
                .iter()
                .filter_map(|&angle| sees(angle))
                .all(|(distance, _)| distance >= limit)
    }
}

/// The nearest blocked cell in the sector about a unit vector, and the distance from the centre of
/// `from` to its edge, cells.
pub(super) fn nearest(
    blocked: &Bitmap,
    from: Cell,
    towards: [f64; 2],
    reach: u32,
) -> Option<(f64, Cell)> {
    let sector = Sector::about(towards);
    let mut best: Option<(f64, Cell)> = None;
    let limit = f64::from(reach);
    let to_edge = |offset: f64| (offset.abs() - 0.5).max(0.0);
    for away in 0..=i64::from(reach) {
        if best.is_some_and(|(distance, _)| to_edge(away as f64) >= distance) {
            break;
        }
        let both = [away, -away];
        for &dy in &both[usize::from(away == 0)..] {
            let Ok(row) = u32::try_from(i64::from(from.row) + dy) else { continue };
            let Some([low, high]) = sector.in_row(dy as f64) else { continue };
            let (low, high) = (low.max(-limit), high.min(limit));
            let column = |dx: f64| f64::from(from.column) + dx;
            let (low, high) = (column(low).max(0.0), column(high));
            if row >= blocked.rows() || high < low {
                continue;
            }
            let (low, high) = (wide::ceil(low) as u32, wide::floor(high) as u32);
            for column in closest(blocked.row(row), low, high, from.column).into_iter().flatten() {
                let dx = f64::from(column) - f64::from(from.column);
                let distance = wide::hypot(to_edge(dx), to_edge(dy as f64));
                if distance <= limit && best.is_none_or(|(least, _)| distance < least) {
                    best = Some((distance, Cell::new(column, row)));
                }
            }
        }
    }
    best
}

/// The directions within [`HALF_ANGLE_RAD`] of an axis.
struct Sector {
    axis: [f64; 2],
    /// The rays that bound it.
    rays: [[f64; 2]; 2],
}

impl Sector {
    fn about([x, y]: [f64; 2]) -> Self {
        let turned = |angle: f64| {
            let (sine, cosine) = (wide::sin(angle), wide::cos(angle));
            [x * cosine - y * sine, x * sine + y * cosine]
        };
        Self { axis: [x, y], rays: [turned(-HALF_ANGLE_RAD), turned(HALF_ANGLE_RAD)] }
    }

    /// The offsets to the east that it covers in the row `dy` north of its tip.
    fn in_row(&self, dy: f64) -> Option<[f64; 2]> {
        let east = [0.0, f64::INFINITY];
        let west = [f64::NEG_INFINITY, 0.0];
        if dy == 0.0 {
            let cosine = wide::cos(HALF_ANGLE_RAD);
            return match self.axis[0] {
                x if x >= cosine => Some(east),
                x if x <= -cosine => Some(west),
                _ => None,
            };
        }
        // Where each ray meets the row; a ray away from the row does not.
        let meets = |[x, y]: [f64; 2]| (y * dy > 0.0).then(|| dy * x / y);
        match self.rays.map(meets) {
            [Some(one), Some(other)] => Some([one.min(other), one.max(other)]),
            [Some(end), None] | [None, Some(end)] => {
                Some(if self.axis[0] > 0.0 { [end, east[1]] } else { [west[0], end] })
            }
            [None, None] => None,
        }
    }
}

/// The cells of a row from `low` to `high` that are nearest to a column: one to the east, one to the
/// west.
fn closest(words: &[u64], low: u32, high: u32, near: u32) -> [Option<u32>; 2] {
    [first(words, near.max(low), high), last(words, low, near.min(high))]
}

/// The first cell of a row from a column to another one.
fn first(words: &[u64], from: u32, to: u32) -> Option<u32> {
    let mut mask = u64::MAX << (from % 64);
    for (index, word) in (from / 64..=to / 64).zip(words.get(from as usize / 64..)?) {
        if word & mask != 0 {
            let found = 64 * index + (word & mask).trailing_zeros();
            return (found <= to).then_some(found);
        }
        mask = u64::MAX;
    }
    None
}

/// The last cell of a row from a column to another one.
fn last(words: &[u64], from: u32, to: u32) -> Option<u32> {
    let mut mask = u64::MAX >> (63 - to % 64);
    for index in (from / 64..=to / 64).rev() {
        // Beyond the last word of the row, nothing is blocked.
        let word = words.get(index as usize).copied().unwrap_or(0) & mask;
        if word != 0 {
            let found = 64 * index + 63 - word.leading_zeros();
            return (found >= from).then_some(found);
        }
        mask = u64::MAX;
    }
    None
}
