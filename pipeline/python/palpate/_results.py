"""What the functions return: numbers as the program's JSON has them, words, tables and arrays."""

from __future__ import annotations

import numpy as np

from . import _html
from ._exchange import frame


class _Result:
    """`json` is what the program prints with --json; `result[...]` reads it; `print(result)` tells it in words."""

    def __init__(self, text, json):
        self._text, self.json = text, json

    def __getitem__(self, key):
        return self.json[key]

    def __str__(self):
        return self._text.rstrip("\n")


class Check(_Result):
    """What is wrong with an input; `usable`: it can be run."""

    def __init__(self, text, json, usable):
        super().__init__(text, json)
        self.usable = usable

    @property
    def faults(self):
        return self.json["faults"]

    def __repr__(self):
        return f"<palpate.Check: {'usable' if self.usable else 'not usable'}, {len(self.faults)} faults>"

    def _repr_html_(self):
        return _html.words(self)


class Comparison(_Result):
    """A model against a Set: `predicted` and `errors` (measured less predicted) are (states, markers, 3) [mm]."""

    def __init__(self, text, json, set, predicted):
        super().__init__(text, json)
        self.set, self.predicted = set, predicted

    @property
    def rms(self):
        return self.json["error"]["rms_mm"]

    @property
    def adequate(self):
        return self.json["adequate"]

    @property
    def errors(self):
        return self.set.positions - self.predicted

    def to_frame(self):
        return frame(self.json["probes"])

    def __repr__(self):
        return f"<palpate.Comparison: {self.rms:.4g} mm rms, {'adequate' if self.adequate else 'not adequate'}>"

    def _repr_html_(self):
        return _html.words(self)


class Diagnosis(_Result):
    """What is missing: `verdict`, `explanation`, `ranking` and `next_probe` as in diagnosis.json."""

    def __init__(self, text, json, notes=()):
        super().__init__(text, json)
        self.notes = list(notes)

    @property
    def verdict(self):
        return self.json["verdict"]

    @property
    def explanation(self):
        return self.json["explanation"]

    @property
    def ranking(self):
        return self.json["ranking"]

    @property
    def next_probe(self):
        return self.json.get("next_probe")

    def to_frame(self):
        keys = ("effect", "kind", "probability", "log_bayes_factor", "predicted_rms_mm", "held_out_rms_mm")
        return frame([{key: row.get(key) for key in keys} for row in self.ranking])

    def __repr__(self):
        named = ": " + ", ".join(self.explanation) if self.explanation else ""
        return f"<palpate.Diagnosis: {self.verdict}{named}>"

    def _repr_html_(self):
        return _html.diagnosis(self)


class Ladder(_Result):
    """The error step by step, `rms` and `held_out_rms` (steps,) [mm]; `model` is the last step's."""

    def __init__(self, text, json, model, identification, notes=()):
        super().__init__(text, json)
        self.model, self.identification, self.notes = model, identification, list(notes)

    @property
    def steps(self):
        return self.json["steps"]

    @property
    def verdict(self):
        return self.json["verdict"]

    @property
    def rms(self):
        return np.array([step["rms_mm"] for step in self.steps])

    @property
    def held_out_rms(self):
        return np.array([np.nan if s["held_out_rms_mm"] is None else s["held_out_rms_mm"] for s in self.steps])

    def to_frame(self):
        keys = ("rms_mm", "held_out_rms_mm", "relative", "log_evidence")
        return frame([{"effects": ", ".join(s["effects"]), **{key: s[key] for key in keys}} for s in self.steps])

    def __repr__(self):
        errors = " -> ".join(f"{rms:.3g}" for rms in self.rms)
        return f"<palpate.Ladder: {errors} mm rms, {self.verdict}>"

    def _repr_html_(self):
        return _html.ladder(self)


class Simulation:
    """Equilibria; shapes and units are in the docstring of simulate()."""

    def __init__(self, model, displacement, sd, largest):
        self.model, self.displacement, self.sd = model, displacement, sd
        self.largest, self.interval = largest[:, 0], largest[:, 1:]

    def at(self, markers):
        """Displacements of points that hang on the skin nearest to them: (states, points, 3) [mm]."""
        from . import _core

        corners, shares = _core.nearest_on(self.model.surface, markers)
        return np.einsum("pc,spcx->spx", shares, self.displacement[:, corners])

    def __repr__(self):
        return f"<palpate.Simulation: {len(self.largest)} states, {self.largest.max(initial=0):.3g} mm at most>"
