#!/usr/bin/env python3
"""How far the skeleton's error falls when the effect that a set hides is added: one row a set, as Markdown.

    for set in SETS/finger-*; do palpate run $set -o RUNS/$(basename $set) --threads 1; done
    tests/bench/skeleton/after_adding.py SETS RUNS [BEFORE]

SETS holds folders BODY-EFFECT, BODY-none* among them; RUNS their run folders. A row: the skeleton's rms error in mm before
and after adding, fitted and held out, and over that of the set of the same body that hides nothing at equal load (that
whose noise, a share of the displacement, is nearest). BEFORE: run folders of another state of the program, told beside.
"""
import json
import math
import pathlib
import re
import sys


def noise(folder):
    found = re.search(r'noise:.*position:\s*([0-9.eE+-]+)', (folder / 'set.yaml').read_text())
    return float(found.group(1))


def errors(run):
    """Of the first and of the last rung: fitted, held out."""
    file = run / 'improve' / 'ladder.json'
    if not file.exists():
        return None
    steps = json.loads(file.read_text())['steps']
    return [(s['rms_mm'], s.get('held_out_rms_mm') or math.nan) for s in (steps[0], steps[-1])]


def null_of(sets, folder):
    body = folder.name.split('-')[0]
    nulls = [s for s in sets.glob(body + '-none*') if (s / 'set.yaml').exists()]
    return min(nulls, key=lambda s: abs(math.log(noise(s) / noise(folder))), default=None)


def cells(sets, runs, folder):
    own = errors(runs / folder.name)
    null = null_of(sets, folder)
    base = errors(runs / null.name) if null else None
    if own is None:
        return ['-'] * 4
    (first, first_out), (last, last_out) = own
    ratios = [last / base[0][0], last_out / base[0][1]] if base else [math.nan] * 2
    return [f'{first:.3f} -> {last:.3f}', f'{first_out:.3f} -> {last_out:.3f}'] + [f'{r:.2f}' for r in ratios]


def main():
    sets, *all_runs = [pathlib.Path(a) for a in sys.argv[1:]]
    names = ['after'] if len(all_runs) == 1 else ['after', 'before']
    head = ['set', 'noise [mm]']
    for name in names:
        head += [f'{what}, {name}' if len(names) > 1 else what
                 for what in ('fitted [mm]', 'held out [mm]', 'over nothing hidden', 'the same, held out')]
    print('| ' + ' | '.join(head) + ' |')
    print('| ' + ' | '.join(['---'] * len(head)) + ' |')
    for folder in sorted(sets.iterdir()):
        if not (folder / 'set.yaml').exists() or not (all_runs[0] / folder.name).exists():
            continue
        row = [folder.name, f'{noise(folder):.3f}']
        for runs in all_runs:
            row += cells(sets, runs, folder)
        print('| ' + ' | '.join(row) + ' |')


main()
