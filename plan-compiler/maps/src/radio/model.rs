//! The loss between two antennas: free space, edges of obstacles, foliage.

use super::losses::{self, Edge};
use super::scene::{Kind, Ray, Scene, Stretch};
use super::{Settings, WEISSBERGER};
use crate::model::{FoliageLoss, Map, Point, Role};
use math::scalar::wide;

/// The loss of radio between points of a map, by the settings' radio and heights.
#[derive(Clone, Debug)]
pub struct Model {
    scene: Scene,
    settings: Settings,
    foliage: FoliageLoss,
    wavelength_m: f64,
}

impl Model {
    /// Prepares the shapes of a map. Foliage has the map's coefficients, if it gives some, else
    /// Weissberger's own.
    pub fn of(map: &Map, settings: &Settings) -> Self {
        Self {
            scene: Scene::of(map, settings, |feature| feature.role != Role::Zone),
            settings: *settings,
            foliage: map.radio.map_or(WEISSBERGER, |radio| radio.foliage),
            wavelength_m: losses::wavelength_m(settings.frequency_ghz),
        }
    }

    /// Loss between two antennas, dB: one over `a`, at the first height of the settings, and one
    /// over `b`, at the second.
    pub fn loss_db(&self, a: Point, b: Point) -> f64 {
        let (ray, is_exchanged) = Ray::between(a, b);
        let mut heights_m = self.settings.antenna_heights_m;
        if is_exchanged {
            heights_m.reverse();
        }
        let length_m = ray.length();
        let straight_m = wide::hypot(length_m, heights_m[1] - heights_m[0]);
        let mut stretches = Vec::new();
        self.scene.stretches(&ray, &mut stretches);
        let path = Path { length_m, heights_m };
        losses::free_space_db(straight_m, self.wavelength_m)
            + self.obstacles_db(&path, &stretches)
            + self.foliage_db(&path, &stretches)
    }

    /// What is left of the signal above the receiver's sensitivity, dB.
    pub fn margin_db(&self, a: Point, b: Point) -> f64 {
        self.settings.power_dbm - self.settings.sensitivity_dbm - self.loss_db(a, b)
    }

    /// Height of the highest obstacle that holds a point, metres; `None` if no obstacle does.
    pub fn roof_m(&self, at: Point) -> Option<f64> {
        let (ray, _) = Ray::between(at, [at[0] + 1.0, at[1]]);
        let mut stretches = Vec::new();
        self.scene.stretches(&ray, &mut stretches);
        let holds = |stretch: &&Stretch| {
            stretch.kind == Kind::Obstacle && stretch.span[0] <= 0.0 && stretch.span[1] > 0.0
        };
        let roofs = stretches.iter().filter(holds).map(|stretch| self.height_m(stretch));
        roofs.max_by(f64::total_cmp)
    }

    fn height_m(&self, stretch: &Stretch) -> f64 {
        stretch.height_m.unwrap_or(match stretch.kind {
            Kind::Obstacle => self.settings.obstacle_height_m,
            Kind::Foliage => self.settings.foliage_height_m,
        })
    }

    /// Loss by obstacles: over their edges or, if the settings give the loss of a wall and it is
    /// less, through their walls.
    fn obstacles_db(&self, path: &Path, stretches: &[Stretch]) -> f64 {
        let mut edges = Vec::new();
        for stretch in stretches.iter().filter(|stretch| stretch.kind == Kind::Obstacle) {
            let height_m = self.height_m(stretch);
            let [from, to] = stretch.span;
            // A ray that begins or ends inside meets one wall only.
            let walls = [(from > 0.0 || from == to, from), (to < 1.0 && from < to, to)];
            let met = walls.into_iter().filter(|(is_met, _)| *is_met);
            edges.extend(met.map(|(_, part)| Edge { at_m: part * path.length_m, height_m }));
        }
        if edges.is_empty() {
            return 0.0;
        }
        edges.sort_unstable_by(|a, b| {
            a.at_m.total_cmp(&b.at_m).then(a.height_m.total_cmp(&b.height_m))
        });
        let over = losses::edges_db(&edges, path.ends(), self.wavelength_m);
        let Some(wall_db) = self.settings.wall_db else { return over };
        let walls = edges.iter().filter(|edge| edge.height_m > path.line_m(edge.at_m)).count();
        over.min(wall_db * walls as f64)
    }

    /// Loss by foliage: by the length of the straight line that lies in it. Areas that overlap count
    /// once.
    fn foliage_db(&self, path: &Path, stretches: &[Stretch]) -> f64 {
        let foliage = stretches.iter().filter(|stretch| stretch.kind == Kind::Foliage);
        let mut spans: Vec<[f64; 2]> = foliage
            .filter_map(|stretch| path.below(stretch.span, self.height_m(stretch)))
            .collect();
        spans.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let (mut depth, mut reached) = (0.0, 0.0_f64);
        for [from, to] in spans {
            depth += (to - from.max(reached)).max(0.0);
            reached = reached.max(to);
        }
        losses::foliage_db(&self.foliage, self.settings.frequency_ghz, depth * path.length_m)
    }
}

/// The straight line between two antennas, in the vertical plane.
struct Path {
    length_m: f64,
    heights_m: [f64; 2],
}

impl Path {
    fn ends(&self) -> [Edge; 2] {
        let [first, second] = self.heights_m;
        [Edge { at_m: 0.0, height_m: first }, Edge { at_m: self.length_m, height_m: second }]
    }

    /// Height of the line at a distance, metres.
    fn line_m(&self, at_m: f64) -> f64 {
        let [first, second] = self.heights_m;
        first + (second - first) * at_m / self.length_m
    }

    /// The part of a span where the line is below a height; `None` if there is none.
    fn below(&self, [from, to]: [f64; 2], height_m: f64) -> Option<[f64; 2]> {
        let [first, second] = self.heights_m;
        let rise = second - first;
        let reaches = (height_m - first) / rise;
        let span = match rise.total_cmp(&0.0) {
            _ if rise == 0.0 => (first < height_m).then_some([from, to])?,
            std::cmp::Ordering::Greater => [from, to.min(reaches)],
            _ => [from.max(reaches), to],
        };
        (span[0] < span[1]).then_some(span)
    }
}
