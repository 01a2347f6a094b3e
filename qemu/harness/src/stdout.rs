//! Standard output of the commands.

use std::io::{ErrorKind, Write as _};

/// Prints a result. The error is a message for the user, such as that of a full disk; a reader that has
/// closed the pipe wants no more, which is not an error.
pub fn print(text: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(format!("standard output cannot be written: {error}"))
        }
        _ => Ok(()),
    }
}
