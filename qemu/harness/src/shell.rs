//! What the commands share: standard output, and folders for files.

use std::io::{self, Write};
use std::path::Path;

/// Writes a command's text to standard output. A closed pipe is not a failure, since its reader has
/// what it wants.
///
/// # Errors
/// Returns a message for the user.
pub fn print(text: &str) -> Result<(), String> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("error: cannot write to standard output: {error}"))
        }
        _ => Ok(()),
    }
}

/// Creates the folder for the files of a run, before the run.
///
/// # Errors
/// Returns a message for the user.
pub fn create_folder(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder)
        .map_err(|error| format!("error: cannot create the folder {}: {error}", folder.display()))
}
