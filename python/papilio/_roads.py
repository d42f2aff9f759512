"""Where work is done: here, or on the workers of a Dask cluster."""

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


#: How to get what a cluster needs. (Papilio is in no index of packages.)
INSTALL = 'pip install "./python[cluster]" at the top of the repository, or pip install distributed pyarrow'


class Job(Protocol):
    """Work that a thread does at once; it can be pickled. ``str()`` says what it is."""

    #: Its number: no two that are out at a time have the same.
    start: int
    #: How often it was given to a worker.
    tries: int

    def computed(self, question: Question, folder: str | None, threads: int = 1) -> Any:
        """The answer; None if it was written into the folder."""


AnyJob = TypeVar("AnyJob", bound=Job)

#: How long to wait for news before looking whether the cluster still lives, seconds.
_PATIENCE = 1.0

#: Batches that are out for each thread of the workers, so that none waits for the next.
_AHEAD = 2


class Failed(Exception):
    """A design of a batch that cannot be."""

    def __init__(self, error: DesignError, job: Any) -> None:
        super().__init__(str(error))
        self.error, self.batch = error, job


class Serial:
    """Batch after batch, here."""

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
        """Every job with its answer."""
        for job in jobs:
            try:
                yield job, job.computed(question, folder, self._threads)
            except DesignError as error:
                raise Failed(error, job) from None


class OnCluster:
    """Batches on the workers of a Dask cluster; as many are out as keep each of their threads busy."""

    def __init__(self, client: Client, question: Question, retries: int) -> None:
        self._client, self._retries = client, retries
        self._news: queue.SimpleQueue[tuple[Any, Future[Any]]] = queue.SimpleQueue()
        self._out: dict[int, tuple[Any, Future[Any]]] = {}
        self._threads, self._looked = 0, -1e9
        # A task of its own, and not data that is sent: what a lost worker held of it is made again.
        self._question = client.submit(_same, question, pure=False)

    def workers(self) -> int | None:
        """Threads that compute, as of some seconds ago."""
        if time.monotonic() - self._looked > 5.0:
            first, self._looked = self._looked < 0, time.monotonic()
            self._threads = sum(self._asked(self._client.nthreads).values())
            if first and not self._threads:
                warnings.warn("client: the cluster has no workers yet; waiting for the first", stacklevel=4)
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
                self._living(error)
        raise ClusterError("the trial was lost with its worker too often")

    def each(
        self, question: Question, jobs: Iterator[AnyJob], folder: str | None
    ) -> Generator[tuple[AnyJob, Any], None, None]:
        """Every job with its answer, in whatever order. Where ``jobs`` end while some are out, they are asked again later."""
        try:
            while self._filled(jobs, folder):
                job, future = self._waited()
                if job is None or self._out.pop(job.start, (None, None))[1] is not future:
                    continue
                answer = self._answer(job, future, written=folder is not None)
                if answer is None:
                    self._give(job, folder)
                else:
                    yield job, answer[0]
        finally:
            # Whatever ended this is what the caller has to hear of, and not that a closed cluster cannot be told.
            with suppress(Exception):
                self._asked(self._client.cancel, [future for _, future in self._out.values()], force=True)
            self._out.clear()

    def _filled(self, jobs: Iterator[AnyJob], folder: str | None) -> bool:
        """Gives out what is missing, and says whether anything is out."""
        while len(self._out) < _AHEAD * max(1, self.workers() or 0):
            job = next(jobs, None)
            if job is None:
                break
            self._give(job, folder)
        return bool(self._out)

    def _give(self, job: Job, folder: str | None) -> None:
        job.tries += 1
        self._out[job.start] = (job, self._submitted(job, _done, self._question, job, folder))

    def _submitted(self, job: Job | None, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = self._asked(self._client.submit, function, *arguments, pure=False)
        self._asked(future.add_done_callback, lambda done: self._news.put((job, done)))
        return future

    def _waited(self) -> tuple[Any, Future[Any]]:
        """The next thing that is done."""
        while True:
            try:
                return self._news.get(timeout=_PATIENCE)
            except queue.Empty:
                self._living(None)

    def _answer(self, job: Job, future: Future[Any], written: bool) -> tuple[Any] | None:
        """What a worker said of a job; None if it was lost, and may be given out anew."""
        if written and future.status == "finished":
            return (None,)  # it is on the disk: nothing to ask the worker for
        try:
            return (future.result(),)
        except DesignError as error:
            raise Failed(error, job) from None
        except PapilioError:
            raise
        except Exception as error:
            self._living(error)
            if job.tries > self._retries:
                said = f"{job} failed {job.tries} times"
                raise ClusterError(f"{said}; at last by {type(error).__name__}: {error}") from error
            return None

    def _asked(self, what: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        try:
            return what(*arguments, **options)
        except Exception as error:
            self._living(error)
            raise ClusterError(f"the cluster does not answer: {type(error).__name__}: {error}") from error

    def _living(self, error: Exception | None) -> None:
        if self._client.status != "running":
            raise ClusterError(f"the cluster was closed (its status: {self._client.status})") from error


def _same(question: Question) -> Question:
    return question


def _done(question: Question, job: Job, folder: str | None) -> Any:
    return job.computed(question, folder)


#: What a design of the last questions costs, so that an optimiser's generations need one trial.
_COSTS: dict[tuple[str, type], float] = {}


def seconds_each(question: Question, grid: Grid, road: Serial | OnCluster, skips: bool = False) -> float:
    """What a design costs on this road; with ``skips``, designs that cannot be are left out."""
    known = (question.address, type(road))
    if known not in _COSTS:
        cost = road.seconds_each(question, grid.sample(1024), skips)
        if cost is None:
            return 1e-3  # the batch that holds that design will say which it is
        while len(_COSTS) > 100:
            _COSTS.pop(next(iter(_COSTS)))
        _COSTS[known] = cost
    return _COSTS[known]


def check_client(client: Client) -> None:
    """Whether a cluster can be asked.

    Raises:
        ArgumentError: if it is none, or closed.
    """
    try:
        from distributed import Client as Known
    except ImportError:
        raise ArgumentError(f"client: dask.distributed is not installed: {INSTALL}") from None
    if not isinstance(client, Known):
        raise ArgumentError(f"client: expected a distributed.Client, not {described(client)}")
    if client.asynchronous:
        raise ArgumentError("client: expected a synchronous distributed.Client")
    if client.status != "running":
        raise ArgumentError(f"client: the cluster is closed (its status: {client.status})")
