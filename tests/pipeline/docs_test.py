"""The pages of pipeline/docs are made without a link that leads nowhere, and do what they show: docs_test.py PALPATE SOURCE.

A block marked "run" is typed into a shell, in a folder where samples/ is; "exit=3 says=..." tells how its last command ends.
A block marked "message=NAME" is what the program prints where docs_messages.py provokes it.
The gallery has a section and a picture for each effect, in the order of `palpate effects`.
"""

import os
import re
import struct
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from docs_messages import exits, scripts

palpate, source = sys.argv[1], Path(sys.argv[2])
try:
    import markdown_it  # noqa: F401
except ImportError:
    sys.exit(77)  # skipped
ran = 0
with tempfile.TemporaryDirectory() as scratch:
    site = Path(scratch) / "site"
    made = subprocess.run([sys.executable, source / "pipeline" / "docs" / "build.py", "-o", site, "--palpate", palpate], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    assert "<script" not in (site / "pipeline" / "docs" / "start.html").read_text()
    programs = Path(scratch) / "bin"
    programs.mkdir()
    (programs / "palpate").symlink_to(palpate)
    environment = os.environ | {"PATH": f"{programs}:{os.environ['PATH']}"}

    def shell(folder, script):
        folder.mkdir(exist_ok=True)
        for name in "samples", "README.md":
            if not (folder / name).exists():
                (folder / name).symlink_to(source / name)
        return subprocess.run(["bash", "-e"], input=script, cwd=folder, env=environment, capture_output=True, text=True)

    here = Path(scratch) / "here"
    messages = set()
    for page in sorted((source / "pipeline" / "docs").glob("*.md")):
        for name, block in re.findall(r"^```text message=(\S+)\n((?:.*\n)*?)```", page.read_text(), re.M):
            run = shell(Path(scratch) / name, scripts[name])
            assert run.returncode == exits.get(name, 3), f"{name}: {run.returncode}: {run.stdout}{run.stderr}"
            pattern = ".*".join(re.escape(" ".join(part.split())) for part in block.split("…"))
            assert re.search(pattern, run.stdout + run.stderr), f"{page.name}: {block}is not what it prints: {run.stdout}{run.stderr}"
            assert not list((Path(scratch) / name).glob("made*")), f"{name}: something was written"
            messages.add(name)
        for marks, block in re.findall(r"^```sh run(.*)\n((?:.*\n)*?)```", page.read_text(), re.M):
            code = int(found[1]) if (found := re.search(r"exit=(\d)", marks)) else 0
            said = found[1] if (found := re.search(r'says="([^"]*)"', marks)) else ""
            run = shell(here, block)
            assert run.returncode == code, f"{page.name}: {block}ends with {run.returncode}: {run.stderr}"
            assert said in run.stdout + run.stderr, f"{page.name}: {block}does not say '{said}': {run.stderr}"
            ran += 1
    listed = subprocess.run([palpate, "effects"], capture_output=True, text=True, check=True).stdout
    effects = re.findall(r"^(\S+) +(?:body|measurement) ", listed, re.M)
    gallery = (source / "pipeline" / "docs" / "gallery.md").read_text()
    pictures = re.findall(r"^## (.+)\n\n!\[\1: .*\]\(gallery/(.+)\.png\)$", gallery, re.M)
    assert len(effects) > 20 and pictures == [(e.capitalize().replace("-", " "), e) for e in effects], pictures
    assert {p.stem for p in (source / "pipeline" / "docs" / "gallery").glob("*.png")} == set(effects)
    if find_spec("vtkmodules") and find_spec("matplotlib"):
        drawn = subprocess.run([sys.executable, source / "pipeline" / "docs" / "gallery.py", "-o", here / "pictures", "--palpate", palpate, "gravity"],
                               capture_output=True, text=True)
        assert drawn.returncode == 0, drawn.stderr
        width, height = struct.unpack(">II", (here / "pictures" / "gravity.png").read_bytes()[16:24])
        assert width == 960 and 100 < height < 400, (width, height)
assert ran >= 6, ran
assert messages == set(scripts), messages ^ set(scripts)
