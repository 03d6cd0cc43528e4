"""Real data sets: their sources and checksums, and a local copy that is checked before use.

Nothing of them is part of the project. A file is looked for in the folder that ``NAVSYM_DATA``
names, then in the cache of the user's machine, and only then fetched from its source at the
commit written here. Whatever its way, a file with another checksum is refused.
"""

from __future__ import annotations

import hashlib
import os
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.core.answers import Answer, named
from navsym.core.choice import one_of
from navsym.core.errors import MissingEngineError, NavsymError
from navsym.core.store import default_path


class ChecksumError(NavsymError):
    """A file that is not the one that was recorded."""

    kind = "checksum"


@dataclass(frozen=True, slots=True)
class Dataset:
    """One file: its name here, its source by repository, commit and path, and what one must know.

    name       : short name, as ``navsym data get`` takes it
    path       : place in a local copy
    repository : owner and name of the public source repository
    commit     : commit of that repository, as far as it is recorded
    source     : path in that repository
    sha256     : checksum of the file
    """

    name: str
    path: str
    what: str
    repository: str
    commit: str
    source: str
    sha256: str
    licence: str

    @property
    def address(self) -> str:
        """Where the file is fetched from: the recorded commit of its repository."""
        return f"https://raw.githubusercontent.com/{self.repository}/{self.commit}/{self.source}"

    @property
    def citation(self) -> str:
        """Repository, commit, file and licence in one line."""
        return f"{self.repository} at commit {self.commit}, {self.source}; {self.licence}"


DATASETS: Mapping[str, Dataset] = {
    name: Dataset(name, **row)
    for name, row in tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8")).items()
}


@dataclass(frozen=True, slots=True)
class DatasetRow:
    """One data set as it is on this machine.

    data    : what it is; here : its checked copy, or None; trouble : why a file that stands there is refused
    """

    data: Dataset
    here: Path | None
    trouble: str | None = None

    def document(self) -> dict[str, Any]:
        """The row of ``navsym data list``."""
        names = "name what path repository commit source sha256 licence"
        return named(self.data, names) | named(self, "here trouble")


@dataclass(frozen=True, slots=True)
class Datasets(Answer):
    """Data sets that are known, or that were fetched; the answer of :func:`data`.

    rows    : one :class:`DatasetRow` for each
    fetched : whether they were asked for by name, so that each has a copy here
    """

    rows: tuple[DatasetRow, ...]
    fetched: bool = False

    def __iter__(self) -> Iterator[DatasetRow]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, name: str) -> Path | None:
        """Path of the copy of a data set; None where there is none."""
        known = {row.data.name: row.here for row in self.rows}
        return known[one_of(name, known, "data")]

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym data list``, or of ``navsym data get``."""
        if not self.fetched:
            return {"datasets": [row.document() for row in self.rows]}
        got = [{"name": r.data.name, "path": str(r.here), "citation": r.data.citation} for r in self.rows]
        return {"datasets": got}

    def __repr__(self) -> str:
        return f"<Datasets: {sum(row.here is not None for row in self.rows)} of {len(self.rows)} here>"


def data(*names: str) -> Datasets:
    """The real data sets that are known; those that are named are fetched and checked.

    names : short names such as ``"srtm"``, or ``"all"``; without one nothing is fetched

    A file is taken from the folder that ``NAVSYM_DATA`` names, from the cache of this machine, or from its source at
    the recorded commit. Whatever its way, a file whose sha256 is not the recorded one is refused.

    Returns :class:`Datasets`; ``nav.data("srtm")["srtm"]`` is a path. Raises NavsymError of the kinds ``domain`` (a
    name that is not known), ``checksum``, and ``missing`` where there is neither a copy nor a network.

    >>> import navsym as nav
    >>> [row.data.name for row in nav.data()][:3]
    ['srtm', 'nasadem', 'nagoya-reference']
    """
    if not names:
        return Datasets(tuple(map(look_up, DATASETS.values())))
    wanted = [one_of(name, (*DATASETS, "all"), "data get") for name in names]
    wanted = list(DATASETS) if "all" in wanted else wanted
    return Datasets(tuple(DatasetRow(DATASETS[name], fetch(name)) for name in wanted), fetched=True)


def look_up(known: Dataset) -> DatasetRow:
    """A data set with its copy on this machine, or with the reason why what stands there is refused."""
    try:
        return DatasetRow(known, local_copy(known))
    except NavsymError as error:
        return DatasetRow(known, None, error.message)


def dataset(name: str) -> Dataset:
    """The data set of a name; raises DomainError with the names that exist."""
    return DATASETS[one_of(name, DATASETS, "data")]


def local_copy(known: Dataset) -> Path | None:
    """The checked file under ``NAVSYM_DATA`` or in the cache; None where there is none.

    Raises ChecksumError when a file stands there that is not the recorded one.
    """
    for folder in (os.environ.get("NAVSYM_DATA"), default_path().parent):
        if folder and (path := Path(folder) / known.path).is_file():
            require_checksum(path, known)
            return path
    return None


def require_checksum(path: Path, known: Dataset) -> None:
    """Raises ChecksumError when the sha256 of a file is not the recorded one."""
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    if digest != known.sha256:
        message = f"expected sha256 {known.sha256}; got {digest}; remove the file, it is not the recorded one"
        raise ChecksumError(message, where=str(path))


def fetch(name: str) -> Path:
    """Path of a checked data set: the local copy, or fetched once into the cache.

    Raises DomainError for an unknown name, ChecksumError for another file of that name, and
    MissingEngineError where there is neither a copy nor a network.
    """
    known = dataset(name)
    if (path := local_copy(known)) is not None:
        return path
    import pooch

    target = default_path().parent / known.path
    try:
        return Path(pooch.retrieve(known.address, f"sha256:{known.sha256}", target.name, target.parent))
    except (OSError, ValueError) as error:
        reason = "no answer" if isinstance(error, OSError) else "a file with another checksum"
        message = (
            f"expected {known.path} or a network; got {reason} ({type(error).__name__}); set NAVSYM_DATA to a folder "
            f"that has {known.path}, or fetch {known.address} yourself and put it at {target}"
        )
        raise MissingEngineError(message, where=known.name) from error
