//! How far many pieces of work are: a bar on a terminal, a line now and then in a log.

use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::say;

/// A log gets a line no more often than this.
const BETWEEN_LINES: Duration = Duration::from_secs(20);

pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    pieces: usize,
    /// What they are called.
    unit: &'static str,
    known: usize,
    computed: usize,
    started: Instant,
    said: Instant,
}

impl Progress {
    pub(crate) fn new(pieces: usize, unit: &'static str) -> Self {
        let bar = stderr().is_terminal().then(|| bar(pieces, unit));
        let now = Instant::now();
        Self { bar, pieces, unit, known: 0, computed: 0, started: now, said: now }
    }

    /// One piece more is done, computed now or known before.
    pub(crate) fn done(&mut self, computed: bool) {
        *(if computed { &mut self.computed } else { &mut self.known }) += 1;
        let done = self.known + self.computed;
        let left = left(self.started.elapsed(), self.computed, self.pieces - done);
        match &self.bar {
            Some(bar) => {
                bar.set_position(done as u64);
                bar.set_message(left);
            }
            None if self.said.elapsed() >= BETWEEN_LINES => {
                self.said = Instant::now();
                say(&format!("{done} of {} {}{left}", self.pieces, self.unit));
            }
            None => {}
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

fn bar(pieces: usize, unit: &str) -> ProgressBar {
    let bar = ProgressBar::new(pieces as u64);
    if let Ok(style) = ProgressStyle::with_template(&format!("  {{bar:30}} {{pos}} of {{len}} {unit}{{msg}}"))
    {
        bar.set_style(style);
    }
    // It is there before the first piece is.
    bar.tick();
    bar
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
}
