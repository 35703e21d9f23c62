"""How a call of the libraries is made: threads, seed, progress, messages and settings."""

from __future__ import annotations

import contextlib
import difflib
import functools
import json
import logging
import numbers
import os
import tempfile
from pathlib import Path

from . import _core
from .errors import InvalidInput

_log = logging.getLogger("palpate")
_LEVELS = (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR)


def _tell(importance: int, text: str) -> None:
    _log.log(_LEVELS[importance], "%s", text)


def whole(given, name, low, high, remedy=""):
    """A whole number of Python's or numpy's, within bounds."""
    if isinstance(given, bool) or not isinstance(given, numbers.Integral) or not low <= given <= high:
        raise InvalidInput(f"{name}: is {given!r}, must be a whole number in [{low}, {high}]{remedy}")
    return int(given)


def real(given, name):
    try:
        return float(given)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name}: is {given!r}, must be a real number") from None


def words_of(given, name):
    """A name, or several."""
    told = [given] if isinstance(given, str) else given
    if not isinstance(told, (list, tuple, set, frozenset)) or not all(isinstance(word, str) for word in told):
        raise TypeError(f"{name}: is {given!r}, must be a name or a list of names")
    return list(told)


class _Bar:
    """A bar of tqdm's, one after the other for each step of the work."""

    def __init__(self) -> None:
        from tqdm.auto import tqdm

        self._tqdm, self._what, self._bar = tqdm, None, None

    def __call__(self, what: str, fraction: float) -> None:
        if what != self._what:
            self.close()
            self._what, self._bar = what, self._tqdm(total=100, desc=what, unit="%", leave=False)
        self._bar.update(round(100 * fraction) - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


@contextlib.contextmanager
def calling(threads=None, seed=None, force=False, progress=None):
    """A call's circumstances. `progress`: a function of (what, fraction in [0, 1]); True: a bar, where tqdm is installed."""
    bar = None
    if progress is True:
        try:
            bar = progress = _Bar()
        except ImportError:
            progress = None
    if progress is not None and not callable(progress):
        raise TypeError(f"progress: is {progress!r}, must be a function of (what, fraction), True or None")
    threads = whole((os.cpu_count() or 1) if threads is None else threads, "threads", 1, 1024, "; None takes all cores")
    seed = None if seed is None else whole(seed, "seed", 0, 2**64 - 1, "; None takes the case's, or 1")
    try:
        yield _core.Call(threads, seed, bool(force), progress, _tell)
    finally:
        if bar is not None:
            bar.close()


@functools.lru_cache(maxsize=None)
def _settings():
    return {s["place"].rsplit(".", 1)[-1]: s for s in _core.settings() if s["group"]}


def settings_of(groups, given, also=()):
    """Keyword arguments as (place, YAML) pairs. `groups`: of settings that the function takes; `also`: places besides."""
    known = {n: s for n, s in _settings().items() if s["group"] in groups or s["place"] in also}
    pairs = []
    for name, value in given.items():
        if value is None:
            continue
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            hint = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(sorted(known))}"
            raise TypeError(f"there is no setting '{name}'; {hint}")
        text = _as_yaml(name, value)
        objection = _core.objection(known[name]["place"], text)
        if objection:
            raise InvalidInput(f"{name}: {objection}")
        pairs.append((known[name]["place"], text))
    return pairs


def _as_yaml(name, value):
    if hasattr(value, "tolist"):  # numpy's
        value = value.tolist()
    if isinstance(value, str):
        return value
    try:
        return json.dumps(value)
    except TypeError:
        raise TypeError(f"{name}: is a {type(value).__name__}, must be a number, a word or a list of them") from None


@contextlib.contextmanager
def as_path(given, kinds):
    """The file or folder that stands for `given`: a path as it is, an object written out meanwhile."""
    if isinstance(given, (str, os.PathLike)):
        yield Path(given)
        return
    for kind, name in kinds:
        if isinstance(given, kind):
            with tempfile.TemporaryDirectory(prefix="palpate-") as folder:
                given.write(Path(folder) / name)
                yield Path(folder) / name
            return
    names = ", ".join(kind.__name__ for kind, _ in kinds)
    raise TypeError(f"got a {type(given).__name__}, must be a path or one of {names}")
