//! Progress of long work, shown on a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// Work that takes less time than this shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the clock is redrawn.
const REDRAWN: Duration = Duration::from_millis(100);

/// Does `work`, which reports steps done and steps in total, `steps_a_layer` per layer. Shows the
/// progress on a terminal once the work takes longer than a second. The spinner and the clock also
/// move during a long step.
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
            bar.set_message(message(done, steps, steps_a_layer));
        })
    })
}

/// The number of layers done; if there is only one layer, its current step.
fn message(done: usize, steps: usize, steps_a_layer: usize) -> String {
    let layers = steps / steps_a_layer.max(1);
    match done {
        0 if layers == 1 && steps > 1 => "searching the layer".to_owned(),
        1 if layers == 1 && steps > 1 => "packing the layer".to_owned(),
        _ => format!("{} of {layers} layers done", done / steps_a_layer.max(1)),
    }
}

/// Does `work` that cannot report progress, such as reading a large extract.
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
            // indicatif hides the bar if standard error is not a terminal.
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
        let lines: Vec<String> = (0..=2).map(|done| message(done, 2, 2)).collect();
        assert_eq!(lines, ["searching the layer", "packing the layer", "1 of 1 layers done"]);
        assert_eq!(message(5, 8, 2), "2 of 4 layers done");
        assert_eq!(message(0, 1, 1), "0 of 1 layers done");
    }
}
