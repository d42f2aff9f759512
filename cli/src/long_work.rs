//! Work of many hours: it is stopped soon after its begin, unless `--allow-long` is given.
//!
//! Bounds of memory, and of work that shows no progress, are checked before anything is computed
//! (docs/limits.md). What remains is work that makes progress, but takes very long: a large number of paths,
//! rays, samples or points. Its time is known from its own progress after [`JUDGED_AFTER`].

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use crate::interrupt;

/// Time after which the rest is estimated, once.
pub(crate) const JUDGED_AFTER: Duration = Duration::from_secs(20);

/// Longest time that is computed without being asked for, hours.
const LONGEST_HOURS: f64 = 12.0;

/// Set by `--allow-long`.
static ALLOWED: AtomicBool = AtomicBool::new(false);

/// The estimated time of stopped work, hours, as bits; 0: none was stopped.
static STOPPED: AtomicU64 = AtomicU64::new(0);

/// Work of any length is computed from now on.
pub(crate) fn allow() {
    ALLOWED.store(true, Ordering::Relaxed);
}

/// Judges work once.
#[derive(Debug, Default)]
pub(crate) struct Judged(AtomicBool);

impl Judged {
    /// Stops the program's work, as Ctrl-C does, if it would take too long: `fraction` of it is done after `elapsed`.
    pub(crate) fn judge(&self, fraction: f64, elapsed: Duration, after: Duration) {
        if fraction <= 0.0 || elapsed < after || self.0.swap(true, Ordering::Relaxed) {
            return;
        }
        let hours = hours(fraction, elapsed);
        if hours > LONGEST_HOURS && !ALLOWED.load(Ordering::Relaxed) {
            STOPPED.store(hours.to_bits(), Ordering::Relaxed);
            interrupt::STOP.store(true, Ordering::Relaxed);
        }
    }
}

/// Expected time of work of which a fraction is done.
fn hours(fraction: f64, elapsed: Duration) -> f64 {
    elapsed.as_secs_f64() / fraction / 3600.0
}

/// The message about stopped work; `left` says what there is of it.
pub(crate) fn refusal(left: &str) -> Option<String> {
    let hours = Some(f64::from_bits(STOPPED.load(Ordering::Relaxed))).filter(|hours| *hours > 0.0)?;
    let time = match hours {
        hours if hours < 100.0 => format!("{hours:.0} h"),
        hours if hours < 24.0 * 1000.0 => format!("{:.0} days", hours / 24.0),
        hours => format!("{:.0} years", (hours / 24.0 / 365.25).max(3.0)),
    };
    Some(format!(
        "error: this would take about {time} at its present speed (expected at most {LONGEST_HOURS} h): {left}\n  = help: use fewer \
         paths, rays, samples, points or directions, or a larger relative error; --allow-long computes it nevertheless"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_that_of_all_work() {
        assert_eq!(hours(0.01, Duration::from_secs(36)), 1.0);
        assert_eq!(refusal("nothing"), None);
    }
}
