//! Time on a robot that has an embassy time driver.

use embassy_time::{Duration, Instant, Ticker};

use crate::control::TICK_PERIOD_US;

/// Microseconds since start.
pub fn now_us() -> u64 {
    Instant::now().as_micros()
}

/// Paces the control task, for [`crate::Robot::wait`].
pub struct Pace {
    ticker: Ticker,
    last: Instant,
}

impl Default for Pace {
    fn default() -> Self {
        Self { ticker: Ticker::every(Self::PERIOD), last: Instant::now() }
    }
}

impl Pace {
    const PERIOD: Duration = Duration::from_micros(TICK_PERIOD_US);

    /// Waits for the next tick. Returns its time, microseconds since start.
    pub async fn next(&mut self) -> u64 {
        // A ticker makes up for missed ticks; a delayed robot must not run several old ticks in a
        // row.
        if self.last.elapsed() > Self::PERIOD {
            warn!("tick overrun");
            self.ticker.reset();
        }
        self.ticker.next().await;
        self.last = Instant::now();
        self.last.as_micros()
    }
}
