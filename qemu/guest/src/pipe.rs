//! The transport to the harness: two semihosting pipes, one record in and one out per tick.
//!
//! Pipes are far faster than an emulated UART (tens of thousands of ticks a second) and just as
//! exact, because the machine stops while it waits for bytes.

use core::ffi::CStr;
use robot_io::limits::SENSOR_RECORD_BYTES;
use robot_io::{CommandRecord, SensorRecord};
use runtime::lockstep::Transport;
use semihosting::fs::File;
use semihosting::io::{Read, Write};
use static_cell::StaticCell;

/// QEMU's standard input and output, connected to the harness.
const INPUT: &CStr = c"/dev/fd/0";
const OUTPUT: &CStr = c"/dev/fd/1";

/// The robot's end of the pipes. The run ends when the harness closes the other end.
pub struct Pipe {
    input: File,
    output: File,
    /// The arriving record; in static memory to keep the stack small.
    arriving: &'static mut [u8; SENSOR_RECORD_BYTES],
}

impl Pipe {
    /// Opens both ends, once.
    ///
    /// # Panics
    /// If QEMU was started without these pipes: the image cannot run then.
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
        // A harness that has ended closes the input too, and that ends the run.
        if let Some(bytes) = record.to_bytes() {
            let _ = self.output.write_all(&bytes);
        }
    }
}
