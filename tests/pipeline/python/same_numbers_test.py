"""The package's numbers are the program's, to the last digit."""

import csv
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
import palpate
from bodies import COARSE, bar_file, measured, model, model_file, program, set_folder

SHORT = ("--particles", 40, "--threads", 1)


class SameNumbers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        kept = tempfile.TemporaryDirectory()
        cls.addClassCleanup(kept.cleanup)
        cls.folder = Path(kept.name)

    def test_skeleton(self):
        file = self.folder / "skeleton.json"
        program("skeleton", bar_file(), "-o", file, "--edge-length", COARSE["edge_length"], "--spheres", 6)
        self.assertEqual(file.read_bytes(), model_file().read_bytes())

    def test_identify(self):
        theirs, ours = self.folder / "identified", self.folder / "identified_here"
        program("identify", model_file(), set_folder(), "-o", theirs, *SHORT)
        found = palpate.identify(model(), measured(), ours, particles=40, threads=1)
        for name in ("model.json", "posterior.csv", "particles.csv", "identify.json", "convergence.csv"):
            self.assertEqual((theirs / name).read_bytes(), (ours / name).read_bytes(), name)
        np.testing.assert_array_equal(found.model.stiffness, palpate.Model.read(theirs / "model.json").stiffness)
        self.assertEqual(found.summary, json.loads((theirs / "identify.json").read_text()))
        posterior = palpate.Posterior.read(theirs)
        self.assertEqual(posterior.parameters, found.posterior.parameters)
        np.testing.assert_allclose(posterior.draws, found.posterior.draws, rtol=1e-5)  # six digits in the file

    def test_compare(self):
        theirs = program("compare", model_file(), set_folder(), "--no-reference")
        ours = palpate.compare(model(), measured(), reference=False)
        self.assertEqual(ours.json, theirs)
        errors = ours.errors[~np.isnan(ours.errors)]
        self.assertAlmostEqual(np.sqrt(np.mean(errors**2)), ours.rms, delta=1e-12 * ours.rms)

    def test_diagnose_and_improve(self):
        theirs = program("diagnose", model_file(), set_folder(), "--body", "skeleton")
        ours = palpate.diagnose(model_file(), set_folder(), body="skeleton")
        self.assertEqual(ours.json, theirs)
        self.assertIn(ours.verdict, str(ours._repr_html_()))
        ladder = palpate.improve(
            model(), measured(), "gravity", self.folder / "improved", body="skeleton", particles=40, threads=1
        )
        theirs = self.folder / "improved_there"
        program("improve", model_file(), set_folder(), "--add", "gravity", "--body", "skeleton", "-o", theirs, *SHORT)
        self.assertEqual(ladder.json, json.loads((theirs / "ladder.json").read_text()))
        self.assertEqual(
            (theirs / "model.json").read_bytes(), (self.folder / "improved" / "model.json").read_bytes()
        )
        self.assertEqual([effect["name"] for effect in ladder.model.effects], ["gravity"])

    def test_improve_by_what_is_left(self):
        ladder = palpate.improve(
            model(), measured(), "residual", self.folder / "taken_up", body="skeleton", particles=40, threads=1
        )
        theirs = self.folder / "taken_up_there"
        program("improve", model_file(), set_folder(), "--residual", "--body", "skeleton", "-o", theirs, *SHORT)
        self.assertEqual(ladder.json, json.loads((theirs / "ladder.json").read_text()))

    def test_simulate(self):
        program("simulate", model_file(), "--probes", set_folder() / "probes.csv", "-o", self.folder / "played")
        with open(self.folder / "played" / "positions.csv") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        played = palpate.simulate(model(), set_folder() / "probes.csv")
        u = played.displacement.reshape(-1, 3)
        for axis, name in enumerate(("ux", "uy", "uz")):
            np.testing.assert_allclose(u[:, axis], [float(row[name]) for row in rows], rtol=1e-5, atol=1e-12)  # six digits in the file
        np.testing.assert_array_equal(palpate.simulate(model(), measured()).displacement, played.displacement)
        at = played.at(model().surface.vertices[:5])
        np.testing.assert_allclose(at, played.displacement[:, :5], atol=1e-12)  # a vertex hangs on itself

    def test_check(self):
        self.assertEqual(palpate.check(set_folder()).json, program("check", set_folder()))

    def test_run(self):
        how = ("--spheres", 6, "--edge-length", 14, "--probes", 6, *SHORT)
        program("run", bar_file(), "-o", self.folder / "run", *how)
        ours = palpate.run(
            bar_file(), self.folder / "run_here", spheres=6, edge_length=14.0, probes=6, particles=40, threads=1
        )
        for name in ("identify/model.json", "compare/compare.json", "case.yaml"):
            self.assertEqual((self.folder / "run" / name).read_bytes(), (ours.folder / name).read_bytes(), name)
        self.assertEqual(ours.model.stiffness.shape[0], len(ours.start.links))
        self.assertIsNone(ours.diagnosis)
        self.assertGreater(len(ours.set.probes), 0)
        self.assertAlmostEqual(ours.mesh.volume, 24000, delta=24)  # as repair and remeshing keep it
        self.assertIn("<iframe", ours._repr_html_())
        self.assertEqual(palpate.Run(ours.folder).comparison, ours.comparison)


if __name__ == "__main__":
    unittest.main()
