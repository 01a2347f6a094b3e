//! Two pipes to the harness, through semihosting: one record in and one out for each tick.
//!
//! Far faster than an emulated UART (tens of thousands of ticks a second), and as exact: the
//! machine stands still while it waits for bytes.

use core::ffi::CStr;
use robot_io::limits::SENSOR_RECORD_BYTES;
use robot_io::{CommandRecord, SensorRecord};
use runtime::lockstep::Transport;
use semihosting::fs::File;
use semihosting::io::{Read, Write};
use static_cell::StaticCell;

/// QEMU's own standard input and output, which the harness holds the other ends of.
const INPUT: &CStr = c"/dev/fd/0";
const OUTPUT: &CStr = c"/dev/fd/1";

/// The robot's end of the pipes. A mission ends when the harness closes its own.
pub struct Pipe {
    input: File,
    output: File,
    /// The record that is arriving; in static memory, to keep the stack small.
    arriving: &'static mut [u8; SENSOR_RECORD_BYTES],
}

impl Pipe {
    /// Opens both ends, once.
    ///
    /// # Panics
    /// Where QEMU was started without such pipes: there is nothing to drive then.
    pub fn open() -> Self {
        static ARRIVING: StaticCell<[u8; SENSOR_RECORD_BYTES]> = StaticCell::new();
        let arriving = ARRIVING.init_with(|| [0; SENSOR_RECORD_BYTES]);
        let input = File::open(INPUT).expect("standard input is a pipe");
        let output = File::create(OUTPUT).expect("standard output is a pipe");
        Self { input, output, arriving }
    }
}

impl Transport for Pipe {
    #[inline(never)]
    fn receive(&mut self) -> Option<SensorRecord> {
        self.input.read_exact(self.arriving).ok()?;
        SensorRecord::from_bytes(self.arriving)
    }

    #[inline(never)]
    fn send(&mut self, record: &CommandRecord) {
        // A harness that has gone closes the input too, and that ends the mission.
        if let Some(bytes) = record.to_bytes() {
            let _ = self.output.write_all(&bytes);
        }
    }
}
