//! Progress of a computation: a bar on a terminal, a line every 20 s in a log. What is shown never goes back.

use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, Once, OnceLock, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use papilio_display::{Control, DisplayError, Progress as Report, ProgressFraction};
use papilio_scenario::Resolved;

use crate::long_work::{JUDGED_AFTER, Judged};
use crate::terminal::is_quiet;
use crate::{Failure, interrupt, print_message};

/// Time between two lines in a log, unless [`BETWEEN_LINES_VARIABLE`] is set.
const BETWEEN_LINES: Duration = Duration::from_secs(20);

/// Environment variable: seconds between two lines in a log.
const BETWEEN_LINES_VARIABLE: &str = "PAPILIO_PROGRESS_SECONDS";

/// Time between two frames of a computation's bar: it appears after the first, and its time goes on while a
/// level is computed.
const BETWEEN_FRAMES: Duration = Duration::from_secs(1);

/// Positions of a bar that shows a fraction.
const POSITIONS: u64 = 1000;

/// Computes a quantity of a scenario with a progress bar; `None` if interrupted before there was a result.
pub(crate) fn with_progress<T>(
    resolved: &Resolved,
    threads: Option<u16>,
    compute: impl FnOnce(&Control<'_>) -> Result<T, DisplayError>,
) -> Result<Option<T>, Failure> {
    Computation::in_parts(&[1.0]).part(resolved, threads, compute)
}

/// A computation of a display in one or more parts, with one bar for all of them.
pub(crate) struct Computation {
    /// Fractions of the whole at which the parts begin, and 1.
    begins: Vec<f64>,
    next: usize,
    // These end before the bar, which is full at its end, whatever was computed: fields are dropped in order.
    _log: Option<Heartbeat>,
    _shown: Heartbeat,
    bar: FractionBar,
}

impl Computation {
    /// `parts` are the expected work of each part, relative to each other.
    pub(crate) fn in_parts(parts: &[f64]) -> Self {
        Self::after(0.0, FractionBar::new(), parts)
    }

    /// Continues a bar of which this fraction is other work.
    pub(crate) fn after(other: f64, bar: FractionBar, parts: &[f64]) -> Self {
        let log = bar.in_log(String::new);
        let waiting = bar.bar.clone();
        let all: f64 = parts.iter().sum();
        let mut begins = vec![other];
        parts.iter().for_each(|part| begins.push(begins[begins.len() - 1] + (1.0 - other) * part / all));
        let shown = Heartbeat::every(BETWEEN_FRAMES, move || waiting.tick());
        Self { begins, next: 0, _log: log, _shown: shown, bar }
    }

    /// Computes the next part; `None` if interrupted before it had a result.
    pub(crate) fn part<T>(
        &mut self,
        resolved: &Resolved,
        threads: Option<u16>,
        compute: impl FnOnce(&Control<'_>) -> Result<T, DisplayError>,
    ) -> Result<Option<T>, Failure> {
        interrupt::catch_ctrl_c();
        let at = |number: usize| self.begins.get(number).copied().unwrap_or(1.0);
        let part = [at(self.next), at(self.next + 1)];
        self.next += 1;
        let show = |report: Report<'_>| self.bar.show(&report.within(part));
        let threads = threads.map(usize::from);
        match compute(&Control { threads, progress: &show, stop: &interrupt::STOP }) {
            Err(DisplayError::Interrupted) => Ok(None),
            other => other.map(Some).map_err(|error| Failure::from_display(resolved, error)),
        }
    }
}

/// A bar that shows a fraction, which never decreases, and words on the current work.
pub(crate) struct FractionBar {
    bar: ProgressBar,
    fraction: ProgressFraction,
    /// The fraction and the paths of the report that is shown.
    last: Mutex<(f64, u64)>,
    /// The part that was known before.
    first: OnceLock<f64>,
    started: Instant,
    judged: Judged,
}

/// Time after which a fraction tells how long the rest takes, and the fraction that is computed by then.
const ESTIMATED_AFTER: (Duration, f64) = (Duration::from_secs(5), 0.02);

/// Time within which a fraction is of work that was known before.
const KNOWN_WITHIN: Duration = Duration::from_secs(1);

impl FractionBar {
    /// A bar on standard error, visible only on a terminal.
    pub(crate) fn new() -> Self {
        let bar = if is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(POSITIONS) };
        bar.set_length(POSITIONS);
        if let Ok(style) = ProgressStyle::with_template("  {bar:30} {percent:>3} %  {msg}  {elapsed}") {
            bar.set_style(style);
        }
        Self {
            bar,
            fraction: ProgressFraction::default(),
            last: Mutex::default(),
            first: OnceLock::new(),
            started: Instant::now(),
            judged: Judged::default(),
        }
    }

    /// Shows a report, unless a later one of another thread is shown already.
    pub(crate) fn show(&self, report: &Report<'_>) {
        let fraction = report.fraction();
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let paths = report.paths.unwrap_or(0);
        if fraction < last.0 && paths <= last.1 {
            return;
        }
        *last = (fraction.max(last.0), paths);
        self.advance(fraction, in_words(report));
    }

    /// Shows a fraction, unless more was shown before, and words.
    pub(crate) fn advance(&self, fraction: f64, words: String) {
        let fraction = self.fraction.advance(fraction);
        self.bar.set_position((POSITIONS as f64 * fraction) as u64);
        let elapsed = self.started.elapsed();
        let known = || if elapsed < KNOWN_WITHIN { fraction } else { 0.0 };
        let done = fraction - self.first.get_or_init(known);
        // Of what was not known before, which alone takes time.
        let of_new = done / (done + 1.0 - fraction);
        self.judged.judge(of_new, elapsed, between_lines().min(JUDGED_AFTER));
        let is_known = elapsed >= ESTIMATED_AFTER.0 && done >= ESTIMATED_AFTER.1;
        let left = if is_known { time_left(elapsed, done, 1.0 - fraction) } else { String::new() };
        let parts = [words, left].into_iter().filter(|part| !part.is_empty());
        self.bar.set_message(parts.collect::<Vec<_>>().join(", "));
    }

    /// Prints a message above the bar.
    pub(crate) fn print(&self, text: &str) {
        self.bar.suspend(|| print_message(&text));
    }

    /// Prints the fraction, the words and `more` periodically in a log, until the result is dropped.
    pub(crate) fn in_log(&self, more: impl Fn() -> String + Send + 'static) -> Option<Heartbeat> {
        in_log(&self.bar, move |bar| {
            let parts = [format!("{} % done", 100 * bar.position() / POSITIONS), bar.message(), more()];
            parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
        })
    }
}

impl Drop for FractionBar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// The error, the paths and the views of a report.
fn in_words(report: &Report<'_>) -> String {
    let target = report.target.map_or(String::new(), |target| format!(" (target {:.2} %)", 100.0 * target));
    let error = report.relative_error.filter(|error| error.is_finite());
    let error = error.map(|error| format!("relative error {:.2} %{target}", 100.0 * error));
    let paths = report.paths.map(|paths| format!("{paths} paths"));
    let (done, all) = report.views_done;
    let views = (all > 1).then(|| format!("{done} of {all} {} done", report.unit));
    let level = report.level.map(|level| format!("level {level} of adding"));
    [level, error, paths, views].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Time between two lines in a log.
fn between_lines() -> Duration {
    static WARNED: Once = Once::new();
    let Ok(text) = std::env::var(BETWEEN_LINES_VARIABLE) else { return BETWEEN_LINES };
    let seconds = text.trim().parse::<f64>().ok().filter(|seconds| *seconds > 0.0);
    seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()).unwrap_or_else(|| {
        WARNED.call_once(|| {
            print_message(&format!(
                "warning: {BETWEEN_LINES_VARIABLE} = \"{text}\" is not a number of seconds above 0; progress is printed every {} s",
                BETWEEN_LINES.as_secs()
            ));
        });
        BETWEEN_LINES
    })
}

/// Progress of work items, sequential or parallel.
pub(crate) struct Progress {
    bar: ProgressBar,
    reused: usize,
    computed: usize,
    started: Instant,
    log: Option<Heartbeat>,
    judged: Judged,
}

impl Progress {
    /// Progress of `items` work items; `unit` is their name in the plural.
    pub(crate) fn new(items: usize, unit: &'static str) -> Self {
        let bar = bar(items, unit);
        let log = in_log(&bar, move |bar| {
            format!("{} of {} {unit}{}", bar.position(), bar.length().unwrap_or_default(), bar.message())
        });
        Self { bar, reused: 0, computed: 0, started: Instant::now(), log, judged: Judged::default() }
    }

    /// Counts a finished item, computed now or known before.
    pub(crate) fn done(&mut self, computed: bool) {
        *(if computed { &mut self.computed } else { &mut self.reused }) += 1;
        let done = (self.reused + self.computed) as u64;
        let remaining = self.bar.length().unwrap_or_default().saturating_sub(done) as usize;
        self.bar.set_position(done);
        // Items that were known take no time; the first ones of all threads end together.
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        if self.computed > 2 * threads {
            let of_new = self.computed as f64 / (self.computed + remaining) as f64;
            self.judged.judge(of_new, self.started.elapsed(), between_lines().min(JUDGED_AFTER));
        }
        let left = time_left(self.started.elapsed(), self.computed as f64, remaining as f64);
        self.bar.set_message(if left.is_empty() { left } else { format!(", {left}") });
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        // The bar is full at its end, also after an interruption.
        drop(self.log.take());
        self.bar.finish_and_clear();
    }
}

/// A progress bar on standard error, visible only on a terminal.
fn bar(items: usize, unit: &str) -> ProgressBar {
    let bar = if is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(items as u64) };
    bar.set_length(items as u64);
    if let Ok(style) = ProgressStyle::with_template(&format!("  {{bar:30}} {{pos}} of {{len}} {unit}{{msg}}"))
    {
        bar.set_style(style);
    }
    // Show the bar before the first item is finished.
    bar.tick();
    bar
}

/// Prints the state of a bar as a line every 20 s (or [`BETWEEN_LINES_VARIABLE`]), if standard error is not a
/// terminal, until the result is dropped.
fn in_log(bar: &ProgressBar, line: impl Fn(&ProgressBar) -> String + Send + 'static) -> Option<Heartbeat> {
    let bar = bar.clone();
    (!stderr().is_terminal()).then(|| Heartbeat::every(between_lines(), move || print_message(&line(&bar))))
}

/// A thread that calls a function periodically until this is dropped.
pub(crate) struct Heartbeat {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Heartbeat {
    pub(crate) fn every(period: Duration, mut beat: impl FnMut() + Send + 'static) -> Self {
        let (stop, stopped) = channel();
        let beats = move || {
            while stopped.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
                beat();
            }
        };
        Self { stop: Some(stop), thread: Some(std::thread::spawn(beats)) }
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        drop(self.stop.take());
        // A panic in the thread has already been reported.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Estimated remaining time, from the time of what is computed (what was known takes none), in the unit of what
/// remains; empty if nothing is computed, or nothing remains.
fn time_left(elapsed: Duration, computed: f64, remaining: f64) -> String {
    if computed <= 0.0 || remaining <= 0.0 {
        return String::new();
    }
    let seconds = elapsed.as_secs_f64() / computed * remaining;
    match seconds {
        s if s < 90.0 => format!("{:.0} s left", s.max(1.0)),
        s if s < 5400.0 => format!("{:.0} min left", s / 60.0),
        s => format!("{:.1} h left", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remaining_time_excludes_reused_items() {
        let after = |seconds, computed, rest| time_left(Duration::from_secs(seconds), computed, rest);
        assert_eq!(after(10, 5.0, 20.0), "40 s left");
        assert_eq!(after(60, 1.0, 9.0), "9 min left");
        assert_eq!(after(3600, 0.1, 1.0), "10.0 h left");
        assert_eq!((after(10, 0.0, 20.0), after(10, 5.0, 0.0)), (String::new(), String::new()));
    }

    #[test]
    fn heartbeat_stops_when_dropped() {
        let (sender, beats) = channel();
        let heart = Heartbeat::every(Duration::from_millis(1), move || {
            let _ = sender.send(());
        });
        assert!(beats.recv().is_ok() && beats.recv().is_ok());
        drop(heart);
        // Calls that were already made are received; then the channel is closed.
        assert!(beats.iter().count() < 1000);
    }
}
