"""The package as it is installed works by itself: install_test.py BUILD CMAKE."""

import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path

build, cmake = sys.argv[1:]
with tempfile.TemporaryDirectory() as prefix:
    subprocess.run([cmake, "--install", build, "--component", "python", "--prefix", prefix], check=True)
    (package,) = Path(prefix).glob("lib/python*/*-packages/palpate")
    missing = {"__init__.py", "__init__.pyi", "py.typed", "errors.py"} - {file.name for file in package.iterdir()}
    assert not missing, f"not installed: {missing}"
    code = (
        "import sys; sys.path.insert(0, sys.argv[1]); import palpate; print(palpate.__version__); "
        "assert palpate.__file__.startswith(sys.argv[1]); assert palpate.effects('gravity')['kind'] == 'body'"
    )
    command = [sys.executable, "-I", "-c", code, str(package.parent)]
    installed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
if importlib.util.find_spec("setuptools"):  # what pip would make of the folder
    folder = Path(__file__).resolve().parents[3] / "pipeline" / "python"
    told = subprocess.run(
        [sys.executable, "setup.py", "--version"], cwd=folder, capture_output=True, text=True, check=True
    )
    assert told.stdout == installed, f"pip's version is {told.stdout!r}, the program's {installed!r}"
