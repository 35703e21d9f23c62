"""The pages of pipeline/docs are made without a link that leads nowhere, and do what they show: docs_test.py PALPATE SOURCE.

A block marked "run" is typed into a shell, in a folder where samples/ is; "exit=3 says=..." tells how its last command ends.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

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
    here = Path(scratch) / "here"
    (here / "bin").mkdir(parents=True)
    (here / "bin" / "palpate").symlink_to(palpate)
    for name in "samples", "README.md":
        (here / name).symlink_to(source / name)
    environment = os.environ | {"PATH": f"{here}/bin:{os.environ['PATH']}"}
    for page in sorted((source / "pipeline" / "docs").glob("*.md")):
        for marks, block in re.findall(r"^```sh run(.*)\n((?:.*\n)*?)```", page.read_text(), re.M):
            code = int(found[1]) if (found := re.search(r"exit=(\d)", marks)) else 0
            said = found[1] if (found := re.search(r'says="([^"]*)"', marks)) else ""
            run = subprocess.run(["bash", "-e"], input=block, cwd=here, env=environment, capture_output=True, text=True)
            assert run.returncode == code, f"{page.name}: {block}ends with {run.returncode}: {run.stderr}"
            assert said in run.stdout + run.stderr, f"{page.name}: {block}does not say '{said}': {run.stderr}"
            ran += 1
assert ran >= 6, ran
