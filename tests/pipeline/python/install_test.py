"""The package as it is installed works by itself: install_test.py BUILD CMAKE."""

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
        "import sys; sys.path.insert(0, sys.argv[1]); import palpate; "
        "assert palpate.__file__.startswith(sys.argv[1]); assert palpate.effects('gravity')['kind'] == 'body'"
    )
    subprocess.run([sys.executable, "-I", "-c", code, str(package.parent)], check=True)
