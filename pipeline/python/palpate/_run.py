"""A run folder, read as it is asked for."""

from __future__ import annotations

import json
from functools import cached_property
from pathlib import Path

from . import _core, _html
from ._call import calling
from ._results import Diagnosis, Ladder
from .errors import FileError


class Run:
    """A run folder. `json`: what the program prints; `met`: the case's expectations are; `model`: the best there is,
    `identified` nothing added, `start` not fitted yet. Run(folder) opens one that is there."""

    def __init__(self, folder, json=None, text="", code=0):
        self.folder = Path(folder)
        self.json, self._text, self.met = json, text, code == 0
        if json is None:
            self.json = self._json("run.json")

    def _json(self, name):
        file = self.folder / name
        try:
            return json.loads(file.read_text())
        except OSError as error:
            raise FileError(f"{file}: cannot be read, {error.strerror}; name the folder of a finished run") from None

    def _optional(self, name):
        return self._json(name) if (self.folder / name).exists() else None

    @property
    def report(self):
        return self.folder / "report.html"

    @cached_property
    def comparison(self):
        return self._json("compare/compare.json")

    @cached_property
    def diagnosis(self):
        found = self._optional("diagnose/diagnosis.json")
        return Diagnosis(_core.diagnosis_in_words(json.dumps(found)), found) if found else None

    @cached_property
    def ladder(self):
        found = self._optional("improve/ladder.json")
        if not found:
            return None
        return Ladder(_core.ladder_in_words(json.dumps(found)), found, self.model, None, found.get("notes", ()))

    @cached_property
    def start(self):
        return _core.Model.read(self.folder / "skeleton/model.json")

    @cached_property
    def identified(self):
        return _core.Model.read(self.folder / "identify/model.json")

    @cached_property
    def model(self):
        better = self.folder / "improve/model.json"
        return _core.Model.read(better) if better.exists() else self.identified

    @cached_property
    def posterior(self):
        better = self.folder / "improve/posterior.csv"
        return _core.Posterior.read(better.parent if better.exists() else self.folder / "identify")

    @cached_property
    def mesh(self):
        return _core.Mesh.read(self.folder / "mesh/body.vtu")

    @cached_property
    def set(self):
        """The measurements that finite elements made, of a run on a mesh; else None: they are the run's input."""
        folder = self.folder / "measurements"
        if not (folder / "set.yaml").exists():
            return None
        with calling() as call:
            return _core.Set._read(folder, call)

    def __str__(self):
        return self._text.rstrip("\n") or repr(self)

    def __repr__(self):
        return f"<palpate.Run: {self.folder}>"

    def _repr_html_(self):
        return _html.run(self)
