"""The pages of the package are built without a warning, and tell of every name: docs_test.py FOLDER_OF_DOCS."""

import contextlib
import io
import sys
import tempfile
from pathlib import Path

import palpate

try:
    from sphinx.cmd.build import main
except ImportError:
    sys.exit(77)  # skipped
with tempfile.TemporaryDirectory() as folder:
    with contextlib.redirect_stderr(io.StringIO()) as told:
        failed = main(["-q", "-W", "--keep-going", "-d", f"{folder}/kept", sys.argv[1], f"{folder}/pages"])
    assert not failed and not told.getvalue(), told.getvalue()
    page = (Path(folder) / "pages" / "index.html").read_text()
missing = [name for name in palpate.__all__ if f'id="palpate.{name}"' not in page]
assert not missing, f"not told of: {missing}"
