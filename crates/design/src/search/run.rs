//! Search on several threads, which take work items from one schedule.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, mpsc};

use papilio_display::DisplayError;
use papilio_scenario::SearchRange;

use super::descent::descend;
use super::schedule::{SearchProgress, SearchSchedule, WorkItem};
use super::starts::best_random_point;
use super::task_problem::DescentTask;
use super::{Record, Search, SearchResult, Task, TaskMethod};
use crate::{DesignError, Evaluator};

/// Callback for every new record, with the progress of the search.
pub type OnRecord<'a, E> = dyn FnMut(&Record, SearchProgress) -> Result<(), E> + 'a;

/// State that the threads share.
struct SharedState<'a> {
    search: &'a Search,
    schedule: Mutex<&'a mut SearchSchedule>,
    /// Notified when a result was added or the search is to stop.
    changed: Condvar,
    stop: AtomicBool,
}

/// Message of a thread: new records and the progress of the search.
type Message = Result<(Vec<Record>, SearchProgress), DesignError>;

impl SearchSchedule {
    /// Runs the search, or its shard, to the end on `threads` threads.
    ///
    /// `on_record` is called with every new record; the order of the tasks of a round is arbitrary. An error
    /// that it returns ends the search.
    ///
    /// # Errors
    /// The error of `on_record`, or of the first work item that fails.
    pub fn run<E: From<DesignError>>(
        &mut self,
        evaluator: &Evaluator<'_>,
        threads: usize,
        on_record: &mut OnRecord<'_, E>,
    ) -> Result<(), E> {
        let search = self.search();
        let (sender, receiver) = mpsc::channel::<Message>();
        drop(sender.send(Ok((self.take_records(), self.progress()))));
        let shared = SharedState {
            search: &search,
            schedule: Mutex::new(self),
            changed: Condvar::new(),
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
            for message in receiver {
                let outcome = message.map_err(E::from).and_then(|(records, progress)| {
                    records.iter().try_for_each(|record| on_record(record, progress))
                });
                if let Err(error) = outcome {
                    shared.stop();
                    failure.get_or_insert(error);
                }
            }
        });
        failure.map_or(Ok(()), Err)
    }
}

impl<'a> SharedState<'a> {
    /// Computes work items until there are none left.
    fn work(&self, evaluator: &mut Evaluator<'_>, sender: &mpsc::Sender<Message>) {
        // A panic of this thread also ends the threads that wait.
        let _guard = StopOnPanic(self);
        while let Some(item) = self.next_item() {
            let result = match self.search.work(&item, evaluator) {
                Ok(result) => result,
                Err(error) => {
                    self.stop();
                    drop(sender.send(Err(error)));
                    return;
                }
            };
            let mut schedule = self.schedule();
            schedule.add_result(result);
            // Sent while the schedule is locked, so that records arrive in order.
            drop(sender.send(Ok((schedule.take_records(), schedule.progress()))));
            drop(schedule);
            self.changed.notify_all();
        }
    }

    /// Waits for the next work item; `None` at the end of the search.
    fn next_item(&self) -> Option<WorkItem> {
        let mut schedule = self.schedule();
        loop {
            if self.stop.load(Ordering::Relaxed) || schedule.is_finished() {
                return None;
            }
            if let Some(item) = schedule.next_item() {
                return Some(item);
            }
            schedule = self.changed.wait(schedule).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn schedule(&self) -> MutexGuard<'_, &'a mut SearchSchedule> {
        self.schedule.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stops all threads.
    fn stop(&self) {
        // Locked, so that no thread starts to wait between the two statements.
        let _schedule = self.schedule();
        self.stop.store(true, Ordering::Relaxed);
        self.changed.notify_all();
    }
}

/// Stops all threads if its own thread panics.
struct StopOnPanic<'a, 'b>(&'b SharedState<'a>);

impl Drop for StopOnPanic<'_, '_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.stop();
        }
    }
}

impl Search {
    /// Runs a task that is a descent.
    pub(super) fn run_task(
        &self,
        task: &Task,
        evaluator: &mut Evaluator<'_>,
    ) -> Result<SearchResult, DesignError> {
        let scalar = DescentTask::new(self, task, evaluator);
        if scalar.problem.free.is_empty() {
            scalar.cost(&[])?;
            return Ok(scalar.result());
        }
        let start = match &task.method {
            TaskMethod::From(design) => scalar.problem.point(design),
            TaskMethod::Population | TaskMethod::Start { start: 0, .. } => scalar.problem.point(&self.own),
            TaskMethod::Start { start, .. } => {
                best_random_point(&scalar, self.spec.seed, self.stream(task), *start as u64)?
            }
        };
        descend(&scalar, start, task.evaluations)?;
        Ok(scalar.result())
    }

    /// Values of the variables that a task does not change.
    pub(super) fn fixed(&self, task: &Task) -> Vec<f64> {
        match &task.method {
            TaskMethod::Population => self.own.clone(),
            TaskMethod::From(design) => design.clone(),
            TaskMethod::Start { choices, .. } => {
                let mut choices = choices.iter();
                let variables = self.own.iter().zip(&self.spec.variables);
                let value = |(own, variable): (&f64, &papilio_scenario::SearchVariable)| match variable.range
                {
                    SearchRange::Choices(_) => choices.next().map_or(*own, |choice| *choice as f64),
                    SearchRange::Bounds(..) => *own,
                };
                variables.map(value).collect()
            }
        }
    }

    /// Stream of random numbers of a start; each combination of choices has its own.
    fn stream(&self, task: &Task) -> u64 {
        match &task.method {
            TaskMethod::Start { choices, .. } => {
                self.combinations.iter().position(|one| one == choices).unwrap_or(0) as u64
            }
            _ => 0,
        }
    }
}

/// Returns true if the error is an interruption.
pub fn was_stopped(error: &DesignError) -> bool {
    matches!(error, DesignError::Display(DisplayError::Interrupted))
}
