"""Where batches are computed: here, or on the workers of a Dask cluster."""

from __future__ import annotations

import os
import queue
import time
import warnings
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _batches
from ._batches import Batch, Columns, Question
from .errors import ClusterError, DesignError, PapilioError

if TYPE_CHECKING:
    from distributed import Client, Future

#: A batch with its answers; None if they were written as a part.
Answered = tuple[Batch, NDArray[np.float64] | None]

#: How long to wait for news before looking whether the cluster still lives, seconds.
_PATIENCE = 1.0

#: Batches that are out for each thread of the workers, so that none waits for the next.
_AHEAD = 2


class Failed(Exception):
    """A design of a batch that cannot be."""

    def __init__(self, error: DesignError, batch: Batch) -> None:
        super().__init__(str(error))
        self.error, self.batch = error, batch


class Serial:
    """Batch after batch, here."""

    def __init__(self, threads: int | None) -> None:
        self._threads = threads or os.cpu_count() or 1

    def workers(self) -> int | None:
        return None

    def seconds_each(self, question: Question, columns: Columns) -> float:
        return _batches.seconds_each(question, columns) / self._threads

    def each(self, question: Question, batches: Iterator[Batch], folder: str | None) -> Generator[Answered, None, None]:
        for batch in batches:
            try:
                yield batch, _batches.computed(question, batch.columns, folder, batch.address, self._threads)
            except DesignError as error:
                raise Failed(error, batch) from None


class OnCluster:
    """Batches on the workers of a Dask cluster; as many are out as keep each of their threads busy."""

    def __init__(self, client: Client, question: Question, retries: int) -> None:
        self._client, self._retries = client, retries
        self._news: queue.SimpleQueue[tuple[Batch | None, Future[Any]]] = queue.SimpleQueue()
        self._out: dict[int, tuple[Batch, Future[Any]]] = {}
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

    def seconds_each(self, question: Question, columns: Columns) -> float:
        self.workers()
        for _ in range(self._retries + 1):
            trial = self._submitted(None, _batches.seconds_each, self._question, columns)
            self._waited()
            try:
                return float(trial.result())
            except PapilioError:
                raise
            except Exception as error:
                self._living(error)
        raise ClusterError("the trial was lost with its worker too often")

    def each(self, question: Question, batches: Iterator[Batch], folder: str | None) -> Generator[Answered, None, None]:
        try:
            while self._filled(batches, folder):
                batch, future = self._waited()
                if batch is None or self._out.pop(batch.start, (None, None))[1] is not future:
                    continue
                answer = self._answer(batch, future, written=folder is not None)
                if answer is None:
                    self._give(batch, folder)
                else:
                    yield batch, answer[0]
        finally:
            # Whatever ended this is what the caller has to hear of, and not that a closed cluster cannot be told.
            with suppress(Exception):
                self._asked(self._client.cancel, [future for _, future in self._out.values()], force=True)
            self._out.clear()

    def _filled(self, batches: Iterator[Batch], folder: str | None) -> bool:
        """Gives out what is missing, and says whether anything is out."""
        while len(self._out) < _AHEAD * max(1, self.workers() or 0):
            batch = next(batches, None)
            if batch is None:
                break
            self._give(batch, folder)
        return bool(self._out)

    def _give(self, batch: Batch, folder: str | None) -> None:
        batch.tries += 1
        future = self._submitted(batch, _batches.computed, self._question, batch.columns, folder, batch.address)
        self._out[batch.start] = (batch, future)

    def _submitted(self, batch: Batch | None, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = self._asked(self._client.submit, function, *arguments, pure=False)
        self._asked(future.add_done_callback, lambda done: self._news.put((batch, done)))
        return future

    def _waited(self) -> tuple[Batch | None, Future[Any]]:
        """The next thing that is done."""
        while True:
            try:
                return self._news.get(timeout=_PATIENCE)
            except queue.Empty:
                self._living(None)

    def _answer(self, batch: Batch, future: Future[Any], written: bool) -> tuple[NDArray[np.float64] | None] | None:
        """What a worker said of a batch; None if it was lost, and may be given out anew."""
        if written and future.status == "finished":
            return (None,)  # it is on the disk: nothing to ask the worker for
        try:
            return (future.result(),)
        except DesignError as error:
            raise Failed(error, batch) from None
        except PapilioError:
            raise
        except Exception as error:
            self._living(error)
            if batch.tries > self._retries:
                said = f"{batch.size} designs from number {batch.start} on failed {batch.tries} times"
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
