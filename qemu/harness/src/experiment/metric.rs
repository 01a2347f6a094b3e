//! The metrics of a trial, and what the paper found (W, section 3 and table 1).

use super::{Row, Trial};

/// A metric of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Time until the last robot arrived, seconds.
    Time,
    /// Distance of all robots, metres.
    Distance,
    /// Time that robots were connected, the sum over the robots, seconds.
    Connected,
    /// Share of the time as one network, 0 to 1.
    OneNetwork,
    /// Mean share of the linked pairs, 0 to 1.
    Connectivity,
    /// Area seen in squares, m^2.
    Coverage,
    /// Area seen in discs, m^2.
    CoverageDisc,
}

impl Metric {
    /// All metrics in the order of the table.
    pub const ALL: [Self; 7] = [
        Self::Time,
        Self::Distance,
        Self::Connected,
        Self::OneNetwork,
        Self::Connectivity,
        Self::Coverage,
        Self::CoverageDisc,
    ];

    /// Its name in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time_s",
            Self::Distance => "distance_m",
            Self::Connected => "connected_s",
            Self::OneNetwork => "one_network",
            Self::Connectivity => "connectivity",
            Self::Coverage => "coverage_m2",
            Self::CoverageDisc => "coverage_disc_m2",
        }
    }

    /// Its heading in tables, with the unit.
    pub fn heading(self) -> &'static str {
        match self {
            Self::Time => "time s",
            Self::Distance => "distance m",
            Self::Connected => "connected s",
            Self::OneNetwork => "one network %",
            Self::Connectivity => "connectivity %",
            Self::Coverage => "coverage m2",
            Self::CoverageDisc => "by discs m2",
        }
    }

    /// What its values are multiplied by in tables.
    pub fn scale(self) -> f64 {
        match self {
            Self::OneNetwork | Self::Connectivity => 100.0,
            _ => 1.0,
        }
    }

    /// Its value in a trial.
    pub fn of(self, trial: &Trial) -> f64 {
        match self {
            Self::Time => trial.time_s,
            Self::Distance => trial.distance_m,
            Self::Connected => trial.connected_s,
            Self::OneNetwork => trial.one_network,
            Self::Connectivity => trial.connectivity,
            Self::Coverage => trial.coverage_m2,
            Self::CoverageDisc => trial.coverage_disc_m2,
        }
    }

    /// Its value in a trial, to be changed.
    pub fn of_mut(self, trial: &mut Trial) -> &mut f64 {
        match self {
            Self::Time => &mut trial.time_s,
            Self::Distance => &mut trial.distance_m,
            Self::Connected => &mut trial.connected_s,
            Self::OneNetwork => &mut trial.one_network,
            Self::Connectivity => &mut trial.connectivity,
            Self::Coverage => &mut trial.coverage_m2,
            Self::CoverageDisc => &mut trial.coverage_disc_m2,
        }
    }

    /// Mean and standard deviation in the paper's table 1, where it has this metric. Its times are
    /// steps of unknown length.
    pub fn in_paper(self, row: Row) -> Option<(f64, f64)> {
        let column = match self {
            Self::Time => 0,
            Self::Distance => 1,
            Self::Connected => 2,
            Self::OneNetwork => 3,
            Self::Connectivity | Self::Coverage | Self::CoverageDisc => return None,
        };
        let row = match row {
            Row::Reactive => [(66.6, 11.6), (834.7, 80.2), (1_435.7, 180.1), (21.0, 2.8)],
            Row::MostlyReactive => [(49.5, 4.3), (797.0, 71.4), (1_408.8, 173.3), (20.6, 2.4)],
            Row::MostlyPlan => [(45.3, 4.0), (800.0, 71.2), (1_372.6, 146.2), (20.6, 2.4)],
            Row::Plan => [(53.8, 8.7), (820.8, 71.5), (1_347.5, 128.0), (20.4, 2.7)],
            Row::Parallel => [(60.6, 13.0), (1_017.8, 313.1), (2_051.9, 343.7), (98.9, 0.8)],
            Row::Serial => [(116.8, 23.7), (915.6, 69.3), (3_560.9, 317.5), (76.3, 7.0)],
        };
        Some(row[column])
    }
}

/// The pairs of rows that the paper compares, with the p-values of its table 1 for time, distance,
/// time connected and time as one network. It prints 0 for small ones.
pub const COMPARED: [(Row, Row, [f64; 4]); 7] = [
    (Row::Reactive, Row::MostlyReactive, [0.0, 0.06, 0.56, 0.56]),
    (Row::Reactive, Row::MostlyPlan, [0.0, 0.08, 0.14, 0.56]),
    (Row::Reactive, Row::Plan, [0.0, 0.478_6, 0.033_9, 0.401_3]),
    (Row::MostlyReactive, Row::MostlyPlan, [0.0, 0.87, 0.39, 1.0]),
    (Row::MostlyReactive, Row::Plan, [0.02, 0.20, 0.12, 0.76]),
    (Row::MostlyPlan, Row::Plan, [0.0, 0.26, 0.48, 0.76]),
    (Row::Parallel, Row::Serial, [0.0, 0.089_7, 0.0, 0.0]),
];
