"""The challenge, from its sets to the table: challenge_test.py PALPATE SOURCE. CalculiX's set is left out where ccx is missing."""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

palpate, source = sys.argv[1:]
folder = Path(source) / "samples" / "challenge"
sys.path.insert(0, str(folder))
import score  # noqa: E402
from sealing import open_seals, seal  # noqa: E402

commitments, keys = seal({"01": {"effects": ["gravity"]}})
assert open_seals(commitments, keys)["01"]["effects"] == ["gravity"]
keys["01"]["truth"] = {"effects": []}
try:
    open_seals(commitments, keys)
    raise AssertionError("a truth that was altered is taken")
except ValueError as e:
    assert "set 01" in str(e)
assert score.named("missing-effect", ["gravity"], ["gravity"]) == "right"
assert score.named("missing-effect", ["gravity", "contact"], ["gravity"]) == "wrong"
assert score.named("unexplained", [], ["gravity"]) == "silent"
assert score.named("missing-effect", ["gravity"], []) == "blamed"

with tempfile.TemporaryDirectory() as scratch:
    scratch = Path(scratch)
    sets = "1,3,18,57" + (",43" if shutil.which("ccx") else "")
    make = [sys.executable, folder / "make_sets.py", "--secret", "rehearsal", "--palpate", palpate, "-o", scratch / "made"]
    subprocess.run([*map(str, make), "--sets", sets], check=True)
    enter = [sys.executable, folder / "entrants.py", scratch / "made", "-o", scratch / "results", "--palpate", palpate]
    subprocess.run([*map(str, enter), "--only", "palpate", "--edge-length", "8"], check=True)
    table, numbers = scratch / "table.html", scratch / "table.json"
    subprocess.run([sys.executable, folder / "score.py", scratch / "made", scratch / "results" / "palpate", "-o", table, "--json", numbers],
                   check=True)
    told = json.loads(numbers.read_text())["summary"]["palpate"]
    # All four effects are named at this coarse mesh: one less allows for rounding.
    assert told["named"] >= 3 and told["wrong"] <= 1 and told["blamed"] == 0, told
    assert "<script" not in table.read_text() and "Set by set" in table.read_text()
    # What a newcomer may get wrong: a verdict of his own making, a forecast with a row missing.
    mine = scratch / "mine" / "01"
    mine.mkdir(parents=True)
    for name, text, said in (("diagnosis.json", '{"verdict": "gravity"}', "allowed are adequate"),
                             ("forecast.csv", "probe,time,marker,x,y,z\n", "it is to be forecast")):
        (mine / "diagnosis.json").write_text('{"verdict": "adequate"}')
        (mine / name).write_text(text)
        failed = subprocess.run([sys.executable, folder / "score.py", scratch / "made", mine.parent, "-o", table], capture_output=True, text=True)
        assert failed.returncode and said in failed.stderr, failed.stderr
