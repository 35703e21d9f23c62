"""The stubs tell of what is there, all of it; everything has a docstring."""

import ast
import inspect
import unittest
from pathlib import Path

import palpate

STUB = ast.parse((Path(palpate.__file__).parent / "__init__.pyi").read_text())
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}


def public(names):
    return {name for name in names if not name.startswith("_")}


def told_members(node):
    names = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
    names |= {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
    for base in node.bases:
        names |= told_members(CLASSES[base.id]) if base.id in CLASSES else set()
    return public(names)


class Stubs(unittest.TestCase):
    def test_tell_every_name(self):
        functions = {node.name for node in STUB.body if isinstance(node, ast.FunctionDef)}
        errors = {name.asname for node in STUB.body if isinstance(node, ast.ImportFrom) for name in node.names}
        told = public(functions) | public(CLASSES) | public(name for name in errors if name)
        self.assertEqual(told, set(palpate.__all__))

    def test_tell_every_member(self):
        for name, node in CLASSES.items():
            if name.startswith("_"):
                continue
            there = public(dir(getattr(palpate, name)))
            told = told_members(node)
            fields = {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)} | {"json"}
            self.assertEqual(told - fields, there, name)

    def test_tell_every_parameter(self):
        for node in STUB.body:
            if not isinstance(node, ast.FunctionDef):
                continue
            told = [a.arg for a in node.args.args + node.args.kwonlyargs]
            there = inspect.signature(getattr(palpate, node.name)).parameters.values()
            self.assertEqual(told, [p.name for p in there if p.kind != p.VAR_KEYWORD], node.name)

    def test_are_documented(self):
        for name in palpate.__all__:
            self.assertTrue(inspect.getdoc(getattr(palpate, name)), name)
        for kind in (palpate.Surface, palpate.Mesh, palpate.Set, palpate.Model, palpate.Posterior, palpate.Body):
            for name in public(vars(kind)):
                self.assertTrue(inspect.getdoc(getattr(kind, name)), f"{kind.__name__}.{name}")


if __name__ == "__main__":
    unittest.main()
