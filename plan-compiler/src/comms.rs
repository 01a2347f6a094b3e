//! Where radio reaches: the margin of the links from every cell to places (W, section 5: areas that
//! attenuate communication, computed from the map).
//!
//! The margin of a link is the received power above the receiver's sensitivity, in dB, by the model
//! of [`maps::radio`], between a place and the centre of a cell. A cell is out of reach if its
//! margin is below a threshold.

use maps::radio::Model;
use maps::{Bitmap, Point};
use plan_format::{Cell, Grid};
use rayon::prelude::*;

/// Which of several places a robot must reach.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Need {
    /// Every place: the worst link counts.
    #[default]
    All,
    /// Any place: the best link counts.
    Any,
}

/// The margins of all cells of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Margins {
    columns: u32,
    /// The link that counts, dB; by rows from the south, each from the west.
    counting_db: Vec<f32>,
    /// For each place, the number of cells that were to be counted and are out of its reach.
    pub out_of_reach: Vec<usize>,
}

impl Margins {
    /// The links from places to every cell of a grid. `counted` holds the cells that
    /// [`Margins::out_of_reach`] counts.
    pub fn of(
        model: &Model,
        grid: &Grid,
        places: &[Point],
        need: Need,
        threshold_db: f64,
        counted: &Bitmap,
    ) -> Self {
        let rows: Vec<(Vec<f32>, Vec<usize>)> = (0..grid.rows)
            .into_par_iter()
            .map(|row| {
                let mut out_of_reach = vec![0; places.len()];
                let mut margin = |cell: Cell| {
                    let (centre, is_counted) = (grid.centre(cell), counted.get(cell));
                    let links = places.iter().zip(&mut out_of_reach).map(|(place, count)| {
                        let margin_db = model.margin_db(*place, centre) as f32;
                        *count += usize::from(is_counted && is_below(margin_db, threshold_db));
                        margin_db
                    });
                    match need {
                        Need::All => links.fold(f32::INFINITY, f32::min),
                        Need::Any => links.fold(f32::NEG_INFINITY, f32::max),
                    }
                };
                let margins = (0..grid.columns).map(|column| margin(Cell::new(column, row)));
                (margins.collect(), out_of_reach)
            })
            .collect();
        let mut all = Self {
            columns: grid.columns,
            counting_db: Vec::with_capacity(grid.cells()),
            out_of_reach: vec![0; places.len()],
        };
        for (margins, out_of_reach) in rows {
            all.counting_db.extend(margins);
            all.out_of_reach.iter_mut().zip(out_of_reach).for_each(|(sum, count)| *sum += count);
        }
        all
    }

    /// The margin of the link that counts, dB.
    pub fn at(&self, cell: Cell) -> f32 {
        self.counting_db[cell.row as usize * self.columns as usize + cell.column as usize]
    }

    /// The margins by rows from the south, each from the west.
    pub fn all(&self) -> &[f32] {
        &self.counting_db
    }

    /// The cells below a threshold.
    pub fn below(&self, threshold_db: f64) -> Bitmap {
        let rows = self.counting_db.len() / self.columns.max(1) as usize;
        Bitmap::from_fn(self.columns, rows as u32, |cell| is_below(self.at(cell), threshold_db))
    }
}

fn is_below(margin_db: f32, threshold_db: f64) -> bool {
    f64::from(margin_db) < threshold_db
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::radio::Settings;
    use maps::{Extent, Feature, Map, Role, Shape};

    /// A wall between the west and the east of a map of 40 x 10 m.
    fn walled() -> Map {
        let wall = Feature {
            shape: Shape::Polyline(vec![[20.0, -10.0], [20.0, 20.0]]),
            role: Role::Obstacle,
            name: String::new(),
            height_m: Some(30.0),
            span: 0..0,
        };
        let extent = Extent { corner: [0.0, 0.0], size: [40.0, 10.0] };
        Map { features: vec![wall], ..Map::empty(extent) }
    }

    #[test]
    fn cells_behind_a_wall_are_out_of_reach_of_all_places_but_not_of_any() {
        let grid = Grid { columns: 40, rows: 10, resolution_m: 1.0, corner_m: [0.0, 0.0] };
        // Weak enough that only a free line reaches 40 m.
        let settings = Settings { power_dbm: -25.0, ..Settings::default() };
        let model = Model::of(&walled(), &settings);
        let places = [[5.5, 5.5], [35.5, 5.5]];
        let counted = Bitmap::from_fn(40, 10, |cell| cell.row < 5);
        let of = |places: &[Point], need| {
            let margins = Margins::of(&model, &grid, places, need, 0.0, &counted);
            for cell in (0..10).flat_map(|row| (0..40).map(move |column| Cell::new(column, row))) {
                let links = places.iter().map(|at| model.margin_db(*at, grid.centre(cell)) as f32);
                let links: Vec<f32> = links.collect();
                let expected = match need {
                    Need::All => links.into_iter().fold(f32::INFINITY, f32::min),
                    Need::Any => links.into_iter().fold(f32::NEG_INFINITY, f32::max),
                };
                assert_eq!(margins.at(cell), expected);
            }
            (margins.below(0.0), margins.out_of_reach)
        };
        let east = Bitmap::from_fn(40, 10, |cell| cell.column >= 20);
        assert_eq!(of(&places[..1], Need::All), (east, vec![100]));
        let (all, any) = (of(&places, Need::All), of(&places, Need::Any));
        assert_eq!((all.0.count(), any.0.count()), (400, 0));
        assert_eq!((all.1, any.1), (vec![100, 100], vec![100, 100]));
    }
}
