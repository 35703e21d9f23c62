#!/usr/bin/python3
"""Scores anyone's results: score.py CHALLENGE RESULTS... -o table.html [--json FILE]

CHALLENGE holds commitments.json, keys.json and leagues.json. Each of RESULTS is a folder named after who took part, with
ID/diagnosis.json ({"verdict", "explanation"}) for each set, and, as far as there are any, ID/forecast.csv
(probe,time,marker,x,y,z and within_95: the half width in which a coordinate lies with 95 %) and ID/seconds.
Needs Python alone.
"""

import argparse
import csv
import html
import json
import math
import statistics
import sys
from pathlib import Path

from sealing import open_seals

verdicts = ("adequate", "missing-effect", "ambiguous", "unexplained")


def said_of(folder):
    """Verdict and explanation; ValueError says what is wrong with the file."""
    path = folder / "diagnosis.json"
    if not path.exists():
        return None, []
    told = json.loads(path.read_text())
    if told.get("verdict") not in verdicts:
        raise ValueError(f"{path}: verdict {told.get('verdict')!r}; allowed are {', '.join(verdicts)}")
    return told["verdict"], told.get("explanation", [])


def named(verdict, explanation, effects):
    """right, wrong or silent; of a set in which nothing is missing: right or blamed."""
    if verdict is None:
        return "absent"
    if not effects:
        return "right" if verdict == "adequate" else "blamed"
    if verdict != "missing-effect":
        return "silent"
    return "right" if sorted(explanation) == sorted(effects) else "wrong"


def forecast_of(folder, truth):
    """Root mean square over the noise, and the share of readings within the interval widened by the noise."""
    path = folder / "forecast.csv"
    if not path.exists() or not truth["held_out"]:
        return None, None
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = {(row["probe"], float(row["time"]), row["marker"]): row for row in csv.DictReader(lines)}
    squares, within = [], []
    noise = truth["noise_mm"]
    for probe, time, marker, *place in truth["held_out"]:
        row = rows.get((probe, time, marker))
        if row is None:
            raise ValueError(f"{path}: there is no row of probe {probe}, time {time:g}, marker {marker}; it is to be forecast")
        for axis, value in zip("xyz", place):
            if value is None:
                continue
            error = float(row[axis]) - value
            squares.append(error**2)
            if row.get("within_95"):
                within.append(abs(error) <= math.hypot(float(row["within_95"]), 1.96 * noise))
    return math.sqrt(statistics.fmean(squares)) / noise, statistics.fmean(within) if within else None


def scored(folder, truths, leagues):
    rows = []
    for name, truth in truths.items():
        verdict, explanation = said_of(folder / name)
        error, coverage = forecast_of(folder / name, truth)
        seconds = folder / name / "seconds"
        rows.append({"set": name, "league": leagues[name], "truth": truth["effects"], "said": explanation or [verdict],
                     "named": named(verdict, explanation, truth["effects"]), "forecast": error, "coverage": coverage,
                     "seconds": float(seconds.read_text()) if seconds.exists() else None})
    return rows


def summary(rows):
    missing, null = [r for r in rows if r["truth"]], [r for r in rows if not r["truth"]]
    median = lambda key: statistics.median(v) if (v := [r[key] for r in rows if r[key] is not None]) else None
    mean = [r["coverage"] for r in rows if r["coverage"] is not None]
    return {"named": sum(r["named"] == "right" for r in missing), "wrong": sum(r["named"] == "wrong" for r in missing),
            "of": len(missing), "blamed": sum(r["named"] == "blamed" for r in null), "null": len(null),
            "forecast": median("forecast"), "coverage": statistics.fmean(mean) if mean else None, "seconds": median("seconds")}


def cell(value, form="{:.2f}"):
    return "–" if value is None else form.format(value)


def line(who, s):
    cells = [f"{s['named']} of {s['of']}", s["wrong"], f"{s['blamed']} of {s['null']}", cell(s["forecast"]),
             cell(s["coverage"], "{:.0%}"), cell(s["seconds"], "{:.1f}")]
    return f"<tr><th>{html.escape(who)}</th>" + "".join(f"<td>{c}</td>" for c in cells) + "</tr>"


style = """body{font:16px/1.5 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em}div{overflow-x:auto}
table{border-collapse:collapse;margin:1em 0}th,td{padding:.3em .8em;border-bottom:1px solid #8884;text-align:right}
th:first-child{text-align:left}.wrong,.blamed{color:#b3261e}.right{color:#1a7f37}:root{color-scheme:light dark}
@media(prefers-color-scheme:dark){.wrong,.blamed{color:#ff8a80}.right{color:#7ee787}}"""
heads = "<tr><th></th><th>named</th><th>named wrongly</th><th>null blamed</th><th>forecast error / noise</th><th>within 95 %</th><th>s a set</th></tr>"


def page(tables):
    leagues = list(dict.fromkeys(r["league"] for rows in tables.values() for r in rows))
    text = f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>The challenge</title><style>{style}</style>"
    text += ("<h1>Which physics is missing?</h1><p>Sets of measurements in which an effect is hidden, or none. Named: the verdict is"
             " the hidden effect, no more and no less. Null blamed: a set without one that was not called adequate. Forecast: root mean"
             " square error on probes held out, over the noise, and the share of readings within the interval; medians over sets.</p>")
    for league in [None, *leagues]:
        text += f"<h2>{league or 'All sets'}</h2><div><table>{heads}"
        for who, rows in tables.items():
            text += line(who, summary([r for r in rows if league in (None, r["league"])]))
        text += "</table></div>"
    text += "<h2>Set by set</h2><div><table><tr><th>set</th><th>league</th><th>hidden</th>" + "".join(f"<th>{html.escape(w)}</th>" for w in tables) + "</tr>"
    for at in zip(*tables.values()):
        hidden = ", ".join(at[0]["truth"]) or "nothing"
        said = "".join(f"<td class={r['named']}>{html.escape(', '.join(map(str, r['said'])))}<br>{cell(r['forecast'])}</td>" for r in at)
        text += f"<tr><th>{at[0]['set']}</th><td>{at[0]['league']}</td><td>{hidden}</td>{said}</tr>"
    return text + "</table></div>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("challenge", type=Path)
    parser.add_argument("results", type=Path, nargs="+")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--json", type=Path)
    told = parser.parse_args()
    commitments, keys, leagues = (json.loads((told.challenge / f"{n}.json").read_text()) for n in ("commitments", "keys", "leagues"))
    try:
        truths = open_seals(commitments, keys)
        tables = {folder.name: scored(folder, truths, leagues) for folder in told.results}
    except ValueError as e:
        sys.exit(f"error: {e}")
    told.output.write_text(page(tables))
    sums = {who: summary(rows) for who, rows in tables.items()}
    if told.json:
        told.json.write_text(json.dumps({"summary": sums, "sets": tables}, indent=1))
    for who, s in sums.items():
        print(f"{who:16} named {s['named']} of {s['of']}, wrongly {s['wrong']}, null blamed {s['blamed']} of {s['null']}, "
              f"forecast {cell(s['forecast'])} of the noise, within {cell(s['coverage'], '{:.0%}')}, {cell(s['seconds'], '{:.1f}')} s")


if __name__ == "__main__":
    main()
