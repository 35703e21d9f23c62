"""How results look in a notebook."""

from __future__ import annotations

import html
import tempfile
from pathlib import Path

from . import _core
from ._call import calling


def _page(text, height):
    """A page of its own within the notebook's."""
    return (
        f'<iframe srcdoc="{html.escape(text)}" style="width:100%;height:{height}px;border:1px solid #ccc" '
        'sandbox="allow-scripts"></iframe>'
    )


def words(result):
    return f"<pre>{html.escape(str(result))}</pre>"


def _cell(value):
    if value is None:
        return "–"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _table(head, rows):
    def row(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{html.escape(_cell(c))}</{tag}>" for c in cells) + "</tr>"

    return "<table>" + row(head, "th") + "".join(row(cells, "td") for cells in rows) + "</table>"


def diagnosis(found):
    keys = ("effect", "probability", "log_bayes_factor", "predicted_rms_mm", "held_out_rms_mm")
    head = ("effect", "probability", "ln Bayes factor", "predicted rms [mm]", "held-out rms [mm]")
    named = f": {', '.join(found.explanation)}" if found.explanation else ""
    text = f"<p><b>{html.escape(found.verdict + named)}</b></p>"
    text += _table(head, [[row.get(key) for key in keys] for row in found.ranking])
    probe = found.next_probe
    return text + (f"<p>Next probe ({probe['kind']}): {html.escape(probe['why'])}</p>" if probe else "")


def ladder(found):
    head = ("with", "rms [mm]", "held-out rms [mm]")
    rows = [(", ".join(s["effects"]) or "nothing added", s["rms_mm"], s["held_out_rms_mm"]) for s in found.steps]
    return f"<p><b>{html.escape(found.verdict)}</b></p>" + _table(head, rows)


def run(found):
    """The report of the run, as it is."""
    return _page(found.report.read_text(encoding="utf-8"), 900)


def model(shown):
    """The model in three dimensions, to be touched."""
    with tempfile.TemporaryDirectory(prefix="palpate-") as folder, calling(1) as call:
        file = Path(folder) / "model.json"
        shown.write(file)
        _core.play_page(file, Path(folder) / "page.html", call)
        return _page((Path(folder) / "page.html").read_text(encoding="utf-8"), 640)
