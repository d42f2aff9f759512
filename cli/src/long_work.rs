//! Work of many hours: it is stopped soon after its begin, unless `--allow-long` is given.
//!
//! Bounds of memory, and of work that shows no progress, are checked before anything is computed
//! (docs/limits.md). Work whose counts are known is refused before it begins ([`Expected`]). The time of any other is
//! known from its own progress after [`JUDGED_AFTER`].
//!
//! **Time.** A program that waits for other programs on a busy machine has little time of processors: its own work is
//! judged by that, not by the clock.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use crate::{Failure, interrupt};

/// Time after which the rest is estimated, once.
pub(crate) const JUDGED_AFTER: Duration = Duration::from_secs(20);

/// Longest time that is computed without being asked for, hours.
const LONGEST_HOURS: f64 = 12.0;

/// Most memory that is taken without being asked for, bytes.
const MOST_BYTES: f64 = 1e9;

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
        // With several threads, the time on the clock is the smaller one.
        let elapsed = processor_time().map_or(elapsed, |used| used.min(elapsed));
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

/// Time of processors that the program has used, if the system reports it.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    let time = nix::time::clock_gettime(nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID).ok()?;
    Some(Duration::new(time.tv_sec().try_into().ok()?, time.tv_nsec().try_into().ok()?))
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}

/// Work of which the time is known before it begins.
pub(crate) struct Expected<'a> {
    /// What is computed, with its number, such as `1e12 paths for each of 3 views`.
    pub(crate) what: String,
    /// The keys or options that determine the number.
    pub(crate) keys: &'a str,
    /// Time of one processor, s: its cost from the table of [`crate::costs`], or an estimate of the physics.
    pub(crate) seconds: f64,
    /// Memory, bytes.
    pub(crate) bytes: f64,
}

impl Expected<'_> {
    /// Fails if the work would take too long on this number of threads (`None`: one for each processor), or too
    /// much memory, unless it was asked for.
    pub(crate) fn check(&self, threads: Option<u16>) -> Result<(), Failure> {
        let threads = thread_count(threads);
        let hours = self.seconds / 3600.0 / threads as f64;
        let Self { what, keys, bytes, .. } = self;
        let what_it_takes = if hours > LONGEST_HOURS {
            format!("about {} on {threads} threads (expected at most {LONGEST_HOURS} h)", in_words(hours))
        } else if *bytes > MOST_BYTES {
            format!("about {:.1} GB of memory (expected at most {:.0} GB)", 1e-9 * bytes, 1e-9 * MOST_BYTES)
        } else {
            return Ok(());
        };
        if ALLOWED.load(Ordering::Relaxed) {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "{what} would take {what_it_takes}, estimated to within a factor of ten; nothing was computed\n  = help: use a smaller \
             number ({keys}); --allow-long computes it nevertheless"
        )))
    }
}

/// Number of threads; `None`: one for each processor.
pub(crate) fn thread_count(threads: Option<u16>) -> usize {
    threads.map_or_else(
        || std::thread::available_parallelism().map_or(1, usize::from),
        |threads| usize::from(threads).max(1),
    )
}

/// Expected time of work of which a fraction is done.
fn hours(fraction: f64, elapsed: Duration) -> f64 {
    elapsed.as_secs_f64() / fraction / 3600.0
}

fn in_words(hours: f64) -> String {
    match hours {
        hours if hours < 100.0 => format!("{hours:.0} h"),
        hours if hours < 24.0 * 1000.0 => format!("{:.0} days", hours / 24.0),
        hours if hours < 1e13 => format!("{:.0} years", (hours / 24.0 / 365.25).max(3.0)),
        hours => format!("{:.0e} years", hours / 24.0 / 365.25),
    }
}

/// The message about stopped work; `left` says what there is of it.
pub(crate) fn refusal(left: &str) -> Option<String> {
    let hours = Some(f64::from_bits(STOPPED.load(Ordering::Relaxed))).filter(|hours| *hours > 0.0)?;
    let time = in_words(hours);
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

    #[test]
    fn work_above_a_limit_is_refused_with_its_keys() {
        let of = |seconds: f64, bytes: f64, threads: u16| {
            let work = Expected { what: "1e9 samples".to_owned(), keys: "tolerance.samples", seconds, bytes };
            work.check(Some(threads)).map_err(|failure| failure.to_string())
        };
        assert_eq!(of(40_000.0, 1e8, 1), Ok(()));
        assert_eq!(of(80_000.0, 1e8, 2), Ok(()));
        let long = of(80_000.0, 1e8, 1).unwrap_err();
        assert!(
            long.contains("22 h on 1 threads") && long.contains("(tolerance.samples); --allow-long"),
            "{long}"
        );
        assert!(of(1.0, 2e9, 1).unwrap_err().contains("2.0 GB of memory"));
        assert!(of(1e30, 0.0, 1).unwrap_err().contains("e22 years"));
    }
}
