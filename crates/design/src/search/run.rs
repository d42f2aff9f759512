//! A search on threads: each takes a piece of its course, until there is none.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, mpsc};

use papilio_display::DisplayError;
use papilio_scenario::SearchRange;

use super::course::{Course, Piece};
use super::descent::descend;
use super::scalar::Scalar;
use super::starts::best_of_drawn;
use super::{Found, Record, Search, Task, Way};
use crate::{DesignError, Evaluator};

/// Who is told of every new record, and of how many tasks of its round are done, of how many.
pub type Tell<'a, E> = dyn FnMut(&Record, (usize, usize)) -> Result<(), E> + 'a;

/// What threads share.
struct Shared<'a> {
    search: &'a Search,
    course: Mutex<&'a mut Course>,
    /// Something was done, or all is to stop.
    turned: Condvar,
    stop: AtomicBool,
}

/// What a thread says: records, and how far the round is.
type Said = Result<(Vec<Record>, (usize, usize)), DesignError>;

impl Course {
    /// Goes to the end, or to that of its part, on so many threads. `tell` gets every new record, the tasks of a round in any
    /// order; an error from it ends the search.
    ///
    /// # Errors
    /// That of `tell`, or of the first piece that fails.
    pub fn run<E: From<DesignError>>(
        &mut self,
        evaluator: &Evaluator<'_>,
        threads: usize,
        tell: &mut Tell<'_, E>,
    ) -> Result<(), E> {
        let search = self.search();
        let (sender, receiver) = mpsc::channel::<Said>();
        drop(sender.send(Ok((self.news(), self.progress()))));
        let shared = Shared {
            search: &search,
            course: Mutex::new(self),
            turned: Condvar::new(),
            stop: AtomicBool::new(false),
        };
        let mut failure: Option<E> = None;
        std::thread::scope(|scope| {
            for _ in 0..threads.max(1) {
                let (sender, shared) = (sender.clone(), &shared);
                let mut evaluator = evaluator.worker();
                scope.spawn(move || shared.work(&mut evaluator, &sender));
            }
            drop(sender);
            for said in receiver {
                let told = said.map_err(E::from).and_then(|(records, progress)| {
                    records.iter().try_for_each(|record| tell(record, progress))
                });
                if let Err(error) = told {
                    shared.end();
                    failure.get_or_insert(error);
                }
            }
        });
        failure.map_or(Ok(()), Err)
    }
}

impl<'a> Shared<'a> {
    /// One thread's share.
    fn work(&self, evaluator: &mut Evaluator<'_>, sender: &mpsc::Sender<Said>) {
        // Threads that wait hear of a panic, too.
        let _ending = Ending(self);
        while let Some(piece) = self.piece() {
            let answer = match self.search.work(&piece, evaluator) {
                Ok(answer) => answer,
                Err(error) => {
                    self.end();
                    drop(sender.send(Err(error)));
                    return;
                }
            };
            let mut course = self.course();
            course.take(answer);
            // While the course is held: records come in the order of what they say.
            drop(sender.send(Ok((course.news(), course.progress()))));
            drop(course);
            self.turned.notify_all();
        }
    }

    /// The next piece, waited for; `None` at the end.
    fn piece(&self) -> Option<Piece> {
        let mut course = self.course();
        loop {
            if self.stop.load(Ordering::Relaxed) || course.is_over() {
                return None;
            }
            if let Some(piece) = course.piece() {
                return Some(piece);
            }
            course = self.turned.wait(course).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn course(&self) -> MutexGuard<'_, &'a mut Course> {
        self.course.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end(&self) {
        // Held, so that nobody begins to wait between the two.
        let _course = self.course();
        self.stop.store(true, Ordering::Relaxed);
        self.turned.notify_all();
    }
}

/// Ends all if its thread panics.
struct Ending<'a, 'b>(&'b Shared<'a>);

impl Drop for Ending<'_, '_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.end();
        }
    }
}

impl Search {
    /// Does a task that is no population.
    pub(super) fn pursue(&self, task: &Task, evaluator: &mut Evaluator<'_>) -> Result<Found, DesignError> {
        let scalar = Scalar::new(self, task, evaluator);
        if scalar.problem.free.is_empty() {
            scalar.cost(&[])?;
            return Ok(scalar.found());
        }
        let start = match &task.way {
            Way::From(design) => scalar.problem.point(design),
            Way::Population | Way::Start { start: 0, .. } => scalar.problem.point(&self.own),
            Way::Start { start, .. } => {
                best_of_drawn(&scalar, self.said.seed, self.stream(task), *start as u64)?
            }
        };
        descend(&scalar, start, task.evaluations)?;
        Ok(scalar.found())
    }

    /// The values that a task does not change.
    pub(super) fn fixed(&self, task: &Task) -> Vec<f64> {
        match &task.way {
            Way::Population => self.own.clone(),
            Way::From(design) => design.clone(),
            Way::Start { choices, .. } => {
                let mut choices = choices.iter();
                let variables = self.own.iter().zip(&self.said.variables);
                let value = |(own, variable): (&f64, &papilio_scenario::SearchVariable)| match variable.range
                {
                    SearchRange::Choices(_) => choices.next().map_or(*own, |choice| *choice as f64),
                    SearchRange::Bounds(..) => *own,
                };
                variables.map(value).collect()
            }
        }
    }

    /// Random numbers of a start: its own for each combination of choices.
    fn stream(&self, task: &Task) -> u64 {
        match &task.way {
            Way::Start { choices, .. } => {
                self.combinations.iter().position(|one| one == choices).unwrap_or(0) as u64
            }
            _ => 0,
        }
    }
}

/// True if a search that failed so was only stopped.
pub fn was_stopped(error: &DesignError) -> bool {
    matches!(error, DesignError::Display(DisplayError::Interrupted))
}
