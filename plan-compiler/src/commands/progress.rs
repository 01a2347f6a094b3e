//! How far long work is, on a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// Work that takes less than this shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the clock is drawn anew.
const REDRAWN: Duration = Duration::from_millis(100);

/// Does `work`, which reports layers done and layers to do, and shows on a terminal how far
/// it is once it takes longer than a second.
pub(super) fn with_progress<T>(
    quiet: bool,
    work: impl FnOnce(&(dyn Fn(usize, usize) + Sync)) -> T,
) -> T {
    let template = "{spinner} layer {pos} of {len} {wide_bar} {elapsed}";
    shown(quiet, template, |bar| {
        work(&|layers_done, layers| {
            bar.set_length(layers as u64);
            bar.set_position(layers_done as u64);
        })
    })
}

/// Does `work` that cannot tell how far it is, as reading a large extract.
pub(super) fn with_patience<T>(quiet: bool, what: &str, work: impl FnOnce() -> T) -> T {
    shown(quiet, &format!("{{spinner}} {what} {{elapsed}}"), |_| work())
}

fn shown<T>(quiet: bool, template: &str, work: impl FnOnce(&ProgressBar) -> T) -> T {
    let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::hidden());
    if quiet {
        return work(&bar);
    }
    let style = ProgressStyle::with_template(template);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let (done, waiting) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        let shown = bar.clone();
        scope.spawn(move || {
            // Hidden by itself where standard error is no terminal.
            if waiting.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(REDRAWN);
            }
        });
        let result = work(&bar);
        drop(done);
        bar.finish_and_clear();
        result
    })
}
