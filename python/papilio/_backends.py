"""Backends of computations: this machine, or the workers of a Dask cluster."""

from __future__ import annotations

import os
import queue
import time
import warnings
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from . import _batches
from ._arguments import described
from ._batches import Columns, Grid, Question
from .errors import ArgumentError, ClusterError, DesignError, PapilioError

if TYPE_CHECKING:
    from distributed import Client, Future


#: How to install the packages that a cluster needs. (Papilio is not in a package index.)
INSTALL = 'run pip install "./python[cluster]" at the top of the repository, or pip install distributed pyarrow'


class Job(Protocol):
    """Work for one call of one thread; it can be pickled, and ``str()`` describes it."""

    #: Its number, unique among the submitted jobs.
    start: int
    #: The number of times it was submitted to a worker.
    tries: int

    def compute(self, question: Question, folder: str | None, threads: int = 1) -> Any:
        """Computes the result, and returns it; writes it into ``folder`` and returns None if a folder is specified."""


AnyJob = TypeVar("AnyJob", bound=Job)

#: Interval between checks of the cluster's status while no result arrives, s.
_STATUS_INTERVAL = 1.0

#: Longest time without any worker before the computation ends, s.
_PATIENCE = 60.0

#: Jobs submitted for each thread of the workers, so that no thread is idle between jobs.
_JOBS_PER_THREAD = 2


class Failed(Exception):
    """An invalid design in a batch."""

    def __init__(self, error: DesignError, job: Any) -> None:
        super().__init__(str(error))
        self.error, self.batch = error, job


class LocalBackend:
    """Computes one batch after another on this machine."""

    def __init__(self, threads: int | None) -> None:
        self._threads = threads or os.cpu_count() or 1

    def workers(self) -> int | None:
        return None

    def seconds_each(self, question: Question, columns: Columns, skips: bool) -> float | None:
        cost = _batches.seconds_each(question, columns, skips)
        return None if cost is None else cost / self._threads

    def each(
        self, question: Question, jobs: Iterator[AnyJob], folder: str | None
    ) -> Generator[tuple[AnyJob, Any], None, None]:
        """Yields every job with its result."""
        for job in jobs:
            try:
                yield job, job.compute(question, folder, self._threads)
            except DesignError as error:
                raise Failed(error, job) from None


class ClusterBackend:
    """Computes batches on the workers of a Dask cluster, with enough submitted to keep all threads busy."""

    def __init__(self, client: Client, question: Question, retries: int) -> None:
        self._client, self._retries = client, retries
        self._finished: queue.SimpleQueue[tuple[Any, Future[Any]]] = queue.SimpleQueue()
        self._submitted_jobs: dict[int, tuple[Any, Future[Any]]] = {}
        self._threads, self._checked = 0, -1e9
        #: Since when the cluster has no workers; None: it has some.
        self._alone_since: float | None = None
        # Submitted as a task instead of data, so that the cluster can restore it after the loss of a worker.
        self._question = client.submit(_identity, question, pure=False)

    def workers(self) -> int | None:
        """Returns the number of computing threads, at most 5 s out of date."""
        if time.monotonic() - self._checked > 5.0:
            first, self._checked = self._checked < 0, time.monotonic()
            self._threads = sum(self._request(self._client.nthreads).values())
            if self._threads:
                self._alone_since = None
            elif self._alone_since is None:
                self._alone_since = self._checked
            if first and not self._threads:
                begins = f"the computation begins when the first worker connects, and ends if none does within {_PATIENCE:g} s"
                warnings.warn(f"client: the cluster has no workers yet; {begins}", stacklevel=4)
        return self._threads

    def seconds_each(self, question: Question, columns: Columns, skips: bool) -> float | None:
        self.workers()
        for _ in range(self._retries + 1):
            trial = self._submitted(None, _batches.seconds_each, self._question, columns, skips)
            self._waited()
            try:
                cost: float | None = trial.result()
                return cost
            except PapilioError:
                raise
            except Exception as error:
                self._check_status(error)
        raise ClusterError(f"the worker that measured the computing time was lost {self._retries + 1} times; increase retries or check the workers")

    def each(
        self, question: Question, jobs: Iterator[AnyJob], folder: str | None
    ) -> Generator[tuple[AnyJob, Any], None, None]:
        """Yields every job with its result, in any order.

        If ``jobs`` ends while some jobs are not complete, it is asked again later.
        """
        try:
            while self._filled(jobs, folder):
                job, future = self._waited()
                if job is None or self._submitted_jobs.pop(job.start, (None, None))[1] is not future:
                    continue
                answer = self._answer(job, future, written=folder is not None)
                if answer is None:
                    self._submit_job(job, folder)
                else:
                    yield job, answer[0]
        finally:
            # An error of the cancellation must not replace the exception that ended the loop.
            with suppress(Exception):
                self._request(self._client.cancel, [future for _, future in self._submitted_jobs.values()], force=True)
            self._submitted_jobs.clear()

    def _filled(self, jobs: Iterator[AnyJob], folder: str | None) -> bool:
        """Submits jobs until all threads are busy, and returns whether any job is submitted."""
        while len(self._submitted_jobs) < _JOBS_PER_THREAD * max(1, self.workers() or 0):
            job = next(jobs, None)
            if job is None:
                break
            self._submit_job(job, folder)
        return bool(self._submitted_jobs)

    def _submit_job(self, job: Job, folder: str | None) -> None:
        job.tries += 1
        self._submitted_jobs[job.start] = (job, self._submitted(job, _compute, self._question, job, folder))

    def _submitted(self, job: Job | None, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = self._request(self._client.submit, function, *arguments, pure=False)
        self._request(future.add_done_callback, lambda done: self._finished.put((job, done)))
        return future

    def _waited(self) -> tuple[Any, Future[Any]]:
        """Waits for the next job or trial to finish."""
        while True:
            try:
                return self._finished.get(timeout=_STATUS_INTERVAL)
            except queue.Empty:
                self._check_status(None)
                self._check_workers()

    def _answer(self, job: Job, future: Future[Any], written: bool) -> tuple[Any] | None:
        """Returns the result of a job; None if it was lost and may be submitted again."""
        if written and future.status == "finished":
            return (None,)  # the worker has written the result to the disk
        try:
            return (future.result(),)
        except DesignError as error:
            raise Failed(error, job) from None
        except PapilioError:
            raise
        except Exception as error:
            self._check_status(error)
            if job.tries > self._retries:
                raise ClusterError(f"{job} failed {job.tries} times; the last error was {type(error).__name__}: {error}") from error
            return None

    def _request(self, function: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        try:
            return function(*arguments, **options)
        except Exception as error:
            self._check_status(error)
            raise ClusterError(f"a request to the cluster failed: {type(error).__name__}: {error}") from error

    def _check_workers(self) -> None:
        """Ends a computation for which nothing computes."""
        self.workers()
        if self._alone_since is None or time.monotonic() - self._alone_since < _PATIENCE:
            return
        self._checked = 0.0  # a worker may have connected since
        if not self.workers():
            what = f"client: the cluster has had no workers for {_PATIENCE:g} s"
            raise ClusterError(f"{what}; start workers first, and wait for them with client.wait_for_workers(1) if they need longer")

    def _check_status(self, error: Exception | None) -> None:
        if self._client.status != "running":
            raise ClusterError(f"the cluster was closed (its status: {self._client.status})") from error


def _identity(question: Question) -> Question:
    return question


def _compute(question: Question, job: Job, folder: str | None) -> Any:
    return job.compute(question, folder)


#: Seconds per design of recent requests, so that the generations of an optimiser need one trial.
_COSTS: dict[tuple[str, type], float] = {}


def seconds_each(question: Question, grid: Grid, backend: LocalBackend | ClusterBackend, skips: bool = False) -> float:
    """Returns the seconds per design on a backend; with ``skips``, invalid designs are skipped."""
    known = (question.address, type(backend))
    if known not in _COSTS:
        cost = backend.seconds_each(question, grid.sample(1024), skips)
        if cost is None:
            return 1e-3  # the batch that contains the invalid design reports it
        while len(_COSTS) > 100:
            _COSTS.pop(next(iter(_COSTS)))
        _COSTS[known] = cost
    return _COSTS[known]


def check_client(client: Client) -> None:
    """Checks that a client is usable.

    Raises:
        ArgumentError: if it is not a synchronous `distributed.Client`, or is closed.
    """
    try:
        from distributed import Client as Known
    except ImportError:
        raise ArgumentError(f"client: dask.distributed is not installed: {INSTALL}") from None
    if not isinstance(client, Known):
        raise ArgumentError(f"client: expected a distributed.Client, not {described(client)}")
    if client.asynchronous:
        raise ArgumentError("client: expected a synchronous distributed.Client, not an asynchronous one")
    if client.status != "running":
        raise ArgumentError(f"client: the cluster is closed (its status: {client.status})")
