"""Runs a notebook as it stands, and keeps its pictures: notebooks_test.py NOTEBOOK FOLDER."""

import os
import sys
import tempfile
from pathlib import Path

notebook, pictures = Path(sys.argv[1]), Path(sys.argv[2])
try:
    import matplotlib
except ImportError:
    sys.exit(77)  # skipped
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

plt.show = lambda *_, **__: None  # the pictures stay open, to be kept
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    exec(compile(notebook.read_text(), notebook.name, "exec"), {"__name__": "__main__"})
assert plt.get_fignums(), f"{notebook.name} shows no picture"
pictures.mkdir(parents=True, exist_ok=True)
plt.gcf().savefig(pictures / notebook.with_suffix(".png").name, dpi=100)
