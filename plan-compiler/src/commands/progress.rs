//! How far long work is, on a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// Work that takes less than this shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the clock is drawn anew.
const REDRAWN: Duration = Duration::from_millis(100);

/// Does `work`, which reports steps done and steps to do, so many for each layer, and shows on a
/// terminal how far it is once it takes longer than a second. The spinner and the clock move while
/// a step of a large layer takes long.
pub(super) fn with_progress<T>(
    quiet: bool,
    steps_a_layer: usize,
    work: impl FnOnce(&(dyn Fn(usize, usize) + Sync)) -> T,
) -> T {
    let template = "{spinner} {msg} {wide_bar} {elapsed}";
    shown(quiet, template, |bar| {
        work(&|done, steps| {
            bar.set_length(steps as u64);
            bar.set_position(done as u64);
            bar.set_message(said(done, steps, steps_a_layer));
        })
    })
}

/// How many layers are done, and what is done to the one under way where there is but one.
fn said(done: usize, steps: usize, steps_a_layer: usize) -> String {
    let layers = steps / steps_a_layer.max(1);
    match done {
        0 if layers == 1 && steps > 1 => "searching the layer".to_owned(),
        1 if layers == 1 && steps > 1 => "packing the layer".to_owned(),
        _ => format!("{} of {layers} layers done", done / steps_a_layer.max(1)),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_layer_alone_moves_too() {
        let lines: Vec<String> = (0..=2).map(|done| said(done, 2, 2)).collect();
        assert_eq!(lines, ["searching the layer", "packing the layer", "1 of 1 layers done"]);
        assert_eq!(said(5, 8, 2), "2 of 4 layers done");
        assert_eq!(said(0, 1, 1), "0 of 1 layers done");
    }
}
