//! Progress of a computation: a bar on a terminal, a line every 20 s in a log.

use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::print_message;
use crate::terminal::is_quiet;

/// Time between two lines in a log.
const BETWEEN_LINES: Duration = Duration::from_secs(20);

/// Progress of work items, sequential or parallel.
pub(crate) struct Progress {
    bar: ProgressBar,
    reused: usize,
    computed: usize,
    started: Instant,
    _log: Option<Heartbeat>,
}

impl Progress {
    /// Progress of `items` work items; `unit` is their name in the plural.
    pub(crate) fn new(items: usize, unit: &'static str) -> Self {
        let bar = bar(items, unit);
        let log = in_log(&bar, move |bar| {
            format!("{} of {} {unit}{}", bar.position(), bar.length().unwrap_or_default(), bar.message())
        });
        Self { bar, reused: 0, computed: 0, started: Instant::now(), _log: log }
    }

    /// Counts a finished item, computed now or known before.
    pub(crate) fn done(&mut self, computed: bool) {
        *(if computed { &mut self.computed } else { &mut self.reused }) += 1;
        let done = (self.reused + self.computed) as u64;
        let remaining = self.bar.length().unwrap_or_default().saturating_sub(done) as usize;
        self.bar.set_position(done);
        self.bar.set_message(time_left(self.started.elapsed(), self.computed, remaining));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A progress bar on standard error, visible only on a terminal.
pub(crate) fn bar(items: usize, unit: &str) -> ProgressBar {
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

/// Prints the state of a bar as a line every 20 s, if standard error is not a terminal, until the result is dropped.
pub(crate) fn in_log(
    bar: &ProgressBar,
    line: impl Fn(&ProgressBar) -> String + Send + 'static,
) -> Option<Heartbeat> {
    let bar = bar.clone();
    (!stderr().is_terminal()).then(|| Heartbeat::every(BETWEEN_LINES, move || print_message(&line(&bar))))
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

/// Estimated remaining time, from the mean time of the computed items (reused items take no time).
fn time_left(elapsed: Duration, computed: usize, remaining: usize) -> String {
    if computed == 0 || remaining == 0 {
        return String::new();
    }
    let seconds = elapsed.as_secs_f64() / computed as f64 * remaining as f64;
    match seconds {
        s if s < 90.0 => format!(", {:.0} s left", s.max(1.0)),
        s if s < 5400.0 => format!(", {:.0} min left", s / 60.0),
        s => format!(", {:.1} h left", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remaining_time_excludes_reused_items() {
        let after = |seconds, computed, rest| time_left(Duration::from_secs(seconds), computed, rest);
        assert_eq!(after(10, 5, 20), ", 40 s left");
        assert_eq!(after(60, 1, 9), ", 9 min left");
        assert_eq!(after(3600, 10, 100), ", 10.0 h left");
        assert_eq!((after(10, 0, 20), after(10, 5, 0)), (String::new(), String::new()));
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
