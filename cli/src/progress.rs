//! How far many pieces of work are: a bar on a terminal, a line now and then in a log.

use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::say;

/// A log gets a line as often as this.
const BETWEEN_LINES: Duration = Duration::from_secs(20);

/// Pieces of work that are done one after the other, or side by side.
pub(crate) struct Progress {
    bar: ProgressBar,
    known: usize,
    computed: usize,
    started: Instant,
    _log: Option<Heartbeat>,
}

impl Progress {
    /// So many pieces; `unit` is what they are called.
    pub(crate) fn new(pieces: usize, unit: &'static str) -> Self {
        let bar = bar(pieces, unit);
        let log = in_log(&bar, move |bar| {
            format!("{} of {} {unit}{}", bar.position(), bar.length().unwrap_or_default(), bar.message())
        });
        Self { bar, known: 0, computed: 0, started: Instant::now(), _log: log }
    }

    /// One piece more is done, computed now or known before.
    pub(crate) fn done(&mut self, computed: bool) {
        *(if computed { &mut self.computed } else { &mut self.known }) += 1;
        let done = (self.known + self.computed) as u64;
        let rest = self.bar.length().unwrap_or_default().saturating_sub(done) as usize;
        self.bar.set_position(done);
        self.bar.set_message(left(self.started.elapsed(), self.computed, rest));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// On standard error, and only where that is a terminal.
pub(crate) fn bar(pieces: usize, unit: &str) -> ProgressBar {
    let bar = ProgressBar::new(pieces as u64);
    if let Ok(style) = ProgressStyle::with_template(&format!("  {{bar:30}} {{pos}} of {{len}} {unit}{{msg}}"))
    {
        bar.set_style(style);
    }
    // It is there before the first piece is.
    bar.tick();
    bar
}

/// What a bar shows as a line now and then, where standard error is no terminal, until this is dropped.
pub(crate) fn in_log(
    bar: &ProgressBar,
    line: impl Fn(&ProgressBar) -> String + Send + 'static,
) -> Option<Heartbeat> {
    let bar = bar.clone();
    (!stderr().is_terminal()).then(|| Heartbeat::every(BETWEEN_LINES, move || say(&line(&bar))))
}

/// Does something again and again until it is dropped.
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
        // A beat that panicked has said so.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// How long the rest takes, if pieces go on as they went: what was known before took no time.
fn left(elapsed: Duration, computed: usize, rest: usize) -> String {
    if computed == 0 || rest == 0 {
        return String::new();
    }
    let seconds = elapsed.as_secs_f64() / computed as f64 * rest as f64;
    match seconds {
        s if s < 90.0 => format!(", {:.0} s to go", s.max(1.0)),
        s if s < 5400.0 => format!(", {:.0} min to go", s / 60.0),
        s => format!(", {:.1} h to go", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_known_took_no_time() {
        let after = |seconds, computed, rest| left(Duration::from_secs(seconds), computed, rest);
        assert_eq!(after(10, 5, 20), ", 40 s to go");
        assert_eq!(after(60, 1, 9), ", 9 min to go");
        assert_eq!(after(3600, 10, 100), ", 10.0 h to go");
        assert_eq!((after(10, 0, 20), after(10, 5, 0)), (String::new(), String::new()));
    }

    /// It beats while something long goes on, and no more afterwards.
    #[test]
    fn a_log_hears_of_long_work() {
        let (sender, beats) = channel();
        let heart = Heartbeat::every(Duration::from_millis(1), move || {
            let _ = sender.send(());
        });
        assert!(beats.recv().is_ok() && beats.recv().is_ok());
        drop(heart);
        // What was under way is heard, and then that there is nobody any more.
        assert!(beats.iter().count() < 1000);
    }
}
