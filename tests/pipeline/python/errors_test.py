"""What goes wrong is an exception that tells file, line and remedy; what is in the way stays."""

import tempfile
import unittest
from pathlib import Path

import numpy as np
import palpate
from bodies import bar_file, measured, model, set_folder


class Errors(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = Path(kept.name)

    def test_tell_file_line_and_remedy(self):
        measured().write(self.folder / "set")
        table = self.folder / "set" / "positions.csv"
        lines = table.read_text().splitlines()
        number = next(i for i, line in enumerate(lines) if line and not line.startswith("#")) + 1
        cells = lines[number].split(",")
        lines[number] = ",".join([*cells[:3], "soft", *cells[4:]])
        table.write_text("\n".join(lines))
        with self.assertRaises(palpate.InvalidInput) as caught:
            palpate.Set.read(self.folder / "set")
        self.assertEqual(caught.exception.file, table.name)
        self.assertEqual(caught.exception.line, number + 1)
        self.assertIn("soft", str(caught.exception))

    def test_remedies_are_the_last_clause(self):
        error = palpate.InvalidInput("set.yaml, line 3: noise is -1, must be above 0; give 1 sigma")
        self.assertEqual((error.file, error.line, error.remedy), ("set.yaml", 3, "give 1 sigma"))
        error = palpate.InvalidInput("threads: is 0, must be in [1, 1024]")
        self.assertEqual((error.file, error.line, error.remedy), (None, None, None))
        error = palpate.InvalidInput("probes.csv: the table has no rows. Add a row per contact and instant.")
        self.assertEqual((error.file, error.remedy), ("probes.csv", "Add a row per contact and instant."))

    def test_are_of_python_s_kinds(self):
        with self.assertRaises(OSError) as caught:
            palpate.Model.read(self.folder / "missing.json")
        self.assertIsInstance(caught.exception, palpate.FileError)
        self.assertIsInstance(caught.exception, palpate.Error)
        self.assertTrue(issubclass(palpate.InvalidInput, ValueError))
        self.assertTrue(issubclass(palpate.SolverFailure, ArithmeticError))

    def test_settings_are_told(self):
        for call, kind, words in (
            (lambda: palpate.mesh(bar_file(), edge_lenght=5), TypeError, "did you mean 'edge_length'"),
            (lambda: palpate.mesh(bar_file(), edge_length=-5), palpate.InvalidInput, "edge_length: .*-5"),
            (lambda: palpate.mesh(bar_file(), edge_length=object()), TypeError, "must be a number"),
            (lambda: palpate.mesh(bar_file(), threads=0), palpate.InvalidInput, "threads: is 0"),
            (lambda: palpate.run(bar_file(), seed=-1), palpate.InvalidInput, "seed: is -1"),
            (lambda: palpate.mesh(bar_file(), progress=3), TypeError, "progress: is 3"),
            (lambda: palpate.mesh(7), TypeError, "must be a path or one of Surface"),
            (lambda: palpate.identify(model(), 7), TypeError, "set: is a int"),
            (lambda: palpate.identify(7, measured()), TypeError, "model: is a int"),
            (lambda: palpate.improve(model(), measured()), palpate.InvalidInput, "add: names no effect"),
            (lambda: palpate.improve(model(), measured(), "gravty"), palpate.InvalidInput, "gravity"),
            (lambda: palpate.diagnose(model(), measured(), without="ghost"), palpate.InvalidInput, "ghost"),
            (lambda: palpate.diagnose(model(), measured(), body="air"), palpate.InvalidInput, "body: is 'air'"),
            (lambda: palpate.probe(bar_file(), law="hard"), palpate.InvalidInput, "law: is 'hard'"),
            (lambda: palpate.export(model(), "a.xyz"), palpate.InvalidInput, "tells no format"),
            (lambda: palpate.Run(self.folder), palpate.FileError, "run.json"),
            (lambda: palpate.diagnose(model(), measured(), without=5), TypeError, "without: is 5"),
            (lambda: palpate.check(set_folder(), expect="ghost"), palpate.InvalidInput, "effect 'ghost' is not known"),
            (lambda: palpate.check(set_folder(), expect=[1]), TypeError, "expect: is .1., must be a name"),
            (lambda: palpate.simulate(model(), measured(), draws=-5), palpate.InvalidInput, "draws: is -5"),
            (lambda: model().with_effect("gravity", gx="up"), palpate.InvalidInput, "gx: is 'up', must be a real"),
            (lambda: model().with_effect(None), TypeError, "name: is a NoneType"),
        ):
            with self.assertRaisesRegex(kind, words):
                call()

    def test_counts_of_numpy_are_counts(self):
        self.assertTrue(palpate.check(set_folder(), threads=np.int64(1)).usable)

    def test_a_check_tells_what_a_run_would_take(self):
        coarse, fine = (palpate.check(bar_file(), cost=True, edge_length=edge, spheres=4)["cost"] for edge in (8, 2))
        self.assertGreater(fine["nodes"], 10 * coarse["nodes"])
        self.assertGreater(fine["gigabytes"], coarse["gigabytes"])
        self.assertNotIn("cost", palpate.check(bar_file()).json)

    def test_nothing_of_yours_is_overwritten(self):
        (self.folder / "mine.json").write_text("mine")
        (self.folder / "mine").mkdir()
        (self.folder / "mine" / "notes.txt").write_text("mine")
        for call in (
            lambda: model().write(self.folder / "mine.json"),
            lambda: measured().write(self.folder / "mine"),
            lambda: palpate.compare(model(), measured(), self.folder / "mine", reference=False),
        ):
            with self.assertRaisesRegex(palpate.InvalidInput, "was not made by palpate"):
                call()
        self.assertEqual((self.folder / "mine.json").read_text(), "mine")
        self.assertEqual((self.folder / "mine" / "notes.txt").read_text(), "mine")
        model().write(self.folder / "mine.json", force=True)
        self.assertEqual(len(palpate.Model.read(self.folder / "mine.json").links), len(model().links))

    def test_a_bad_body_is_told_before_a_run(self):
        (self.folder / "flat.stl").write_text(
            "solid flat\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
            "endsolid flat\n"
        )
        checked = palpate.check(self.folder / "flat.stl")
        self.assertFalse(checked.usable)
        self.assertIn("cannot be run", str(checked))
        with self.assertRaises(palpate.InvalidInput):
            palpate.mesh(self.folder / "flat.stl")
        self.assertTrue(palpate.check(set_folder()).usable)


if __name__ == "__main__":
    unittest.main()
