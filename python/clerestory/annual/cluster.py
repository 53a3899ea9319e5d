"""A study on a Dask cluster: workers find its parts and put them into a cache that all share.

The client then runs the study from the cache, so that its results are those of a run without a cluster.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clerestory._core import ClerestoryError
from clerestory.annual.cache import digest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from clerestory.annual.study import Study

_TOGETHER = 8
"""Parts of the year of a task."""
_PATIENCE = "30s"
"""For a scheduler to answer."""


@dataclass(frozen=True)
class Job:
    """A study as workers see it."""

    source: str
    """Its file."""
    mark: str
    """SHA-256 of the file."""
    cache: str
    """Folder of matrices and parts."""


@dataclass(frozen=True)
class Task:
    """Some of a study."""

    block: int
    """Number of its points or eyes."""
    choice: str | None = None
    """What stands in the windows; None for the matrices, which hold for all."""
    first: int = 0
    """Number of the first part of the year."""
    last: int = 0
    """And after the last."""


@contextmanager
def cluster(*, scheduler: str | None = None, workers: int | None = None) -> Iterator[Any]:
    """A client of a scheduler that runs, or of one with so many workers on this machine, which ends with it.

    Raises
    ------
    ClerestoryError
        Dask is not installed, or no scheduler answers.
    """
    dask = _dask()
    if scheduler is not None:
        try:
            client = dask.Client(scheduler, timeout=_PATIENCE)
        except (OSError, TimeoutError, ValueError) as error:
            raise ClerestoryError(
                f"{scheduler}: no Dask scheduler answers (give its address, such as tcp://host:8786)"
            ) from error
        with client:
            yield client
        return
    count = workers or 1
    threads = str(max(1, (os.cpu_count() or 1) // count))
    local = dask.LocalCluster(
        n_workers=count,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        env={"RAYON_NUM_THREADS": threads},
    )
    with local, dask.Client(local) as client:
        yield client


def _dask() -> Any:  # noqa: ANN401 (has no types)
    try:
        return import_module("distributed")
    except ImportError as error:
        raise ClerestoryError("workers need Dask (pip install 'clerestory[dask]')") from error


def spread(study: Study, source: Path, client: Any, progress: Callable[[float], object] | None = None) -> None:  # noqa: ANN401
    """Have the parts of a study found by the workers of a cluster, into the study's cache.

    Workers see the study's files and the folder of the cache under the same names. What a worker leaves undone when
    it dies is done by another.

    Parameters
    ----------
    study
        That was read from `source`.
    source
        Its file.
    client
        Of `cluster`.
    progress
        Called with the share that is done.

    Raises
    ------
    ClerestoryError
        Workers do not see the same files or cache, or fail.
    """
    path = source.resolve()
    job = Job(str(path), digest(path.read_bytes()), str(study.cache.folder.resolve()))
    matrices = [Task(block) for block in range(len(study.blocks))]
    parts = [
        Task(block, name, first, min(first + _TOGETHER, len(study.year(study.blocks[block]).chunks)))
        for block in range(len(study.blocks))
        for name in study.choices
        for first in range(0, len(study.year(study.blocks[block]).chunks), _TOGETHER)
    ]
    count, done = len(matrices) + len(parts), 0
    # What all blocks share is found once, by the first; then the blocks' own.
    for tasks in (matrices[:1], matrices[1:], parts):
        for _ in _done(client, job, tasks):
            done += 1
            if progress is not None:
                progress(done / count)
    left = sum(
        len(study.year(block).missing(choice.systems, choice.when))
        for block in study.blocks
        for choice in study.choices.values()
    )
    if left:
        raise ClerestoryError(
            f"{job.cache}: {left} parts that the workers found are not there (give a folder that all machines share: "
            "--cache)"
        )


def _done(client: Any, job: Job, tasks: list[Task]) -> Iterator[None]:  # noqa: ANN401
    """Has tasks done; yields as each is."""
    dask = _dask()
    futures = client.map(_work, [job] * len(tasks), tasks, pure=False)
    try:
        for future in dask.as_completed(futures):
            future.result()
            yield
    except dask.KilledWorker as error:
        raise ClerestoryError(f"workers died over and over ({error}; give them more memory)") from None
    finally:
        client.cancel(futures)


def _work(job: Job, task: Task) -> None:
    """One task, in a worker."""
    study = _study(job)
    year = study.year(study.blocks[task.block])
    if task.choice is None:
        year.prepare()
        return
    choice = study.choices[task.choice]
    when = None if choice.when is None else {task.choice: choice.when}
    for _ in year.of({task.choice: choice.systems}, when=when, steps=year.chunks[task.first : task.last]):
        pass


@lru_cache(maxsize=1)
def _study(job: Job) -> Study:
    from clerestory.annual.study import load

    path = Path(job.source)
    if not path.is_file() or digest(path.read_bytes()) != job.mark:
        raise ClerestoryError(f"{path}: a worker does not see this file as it is (share its folder with all machines)")
    return load(path, cache=job.cache)
