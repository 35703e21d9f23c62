"""Tables and objects of other packages, where they are installed; and what is said where they are not."""

import importlib.util
import unittest
from unittest import mock

import numpy as np
import palpate
from bodies import bar, measured, model


def needs(name):
    return unittest.skipUnless(importlib.util.find_spec(name), f"{name} is not installed")


class Exchange(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.found = palpate.identify(model(), measured(), particles=40)

    @needs("pandas")
    def test_frames(self):
        m, s, posterior = model(), measured(), self.found.posterior
        self.assertEqual(len(m.to_frame()), len(m.links))
        self.assertIn("elongation [N/mm]", m.to_frame())
        frame = s.to_frame()
        self.assertEqual(len(frame), (~np.isnan(s.positions).all(axis=2)).sum())
        self.assertEqual(list(frame)[:3], ["probe", "time", "marker"])
        self.assertEqual(list(posterior.to_frame()["parameter"]), posterior.parameters)
        self.assertEqual(len(palpate.compare(m, s, reference=False).to_frame()), len(s.probes))

    def test_missing_packages_are_named(self):
        for name, call in (
            ("pandas", model().to_frame),
            ("xarray", measured().to_xarray),
            ("meshio", bar().to_meshio),
            ("pyvista", bar().to_pyvista),
            ("arviz", self.found.posterior.to_arviz),
        ):
            with mock.patch.dict("sys.modules", {name: None}), self.assertRaisesRegex(ImportError, f"install .*{name}"):
                call()

    def test_draws_of_equal_weight(self):
        posterior = self.found.posterior
        drawn = posterior.resampled(4000, seed=3)
        mean = posterior.weights @ posterior.draws
        sd = np.sqrt(posterior.weights @ (posterior.draws - mean) ** 2)
        # systematic resampling errs by less than independent draws, whose mean's sd is sd / sqrt(4000)
        self.assertTrue((np.abs(drawn.mean(axis=0) - mean) < 4 * sd / np.sqrt(4000)).all())
        np.testing.assert_array_equal(drawn, posterior.resampled(4000, seed=3))
        self.assertAlmostEqual(posterior.weights.sum(), 1, places=12)
        with self.assertRaisesRegex(palpate.InvalidInput, "draws: is 0, must be a whole number"):
            posterior.resampled(0)

    @needs("xarray")
    def test_xarray(self):
        data = measured().to_xarray()
        self.assertEqual(data["position"].attrs["units"], "mm")
        np.testing.assert_array_equal(data["position"], measured().positions)

    @needs("arviz")
    def test_arviz(self):
        import arviz

        posterior = self.found.posterior
        data = posterior.to_arviz(draws=50, seed=3)
        self.assertEqual(dict(data.posterior.sizes), {"chain": 1, "draw": 50})
        for i, (name, unit) in enumerate(zip(posterior.parameters, posterior.units)):
            np.testing.assert_array_equal(data.posterior[name][0], posterior.resampled(50, seed=3)[:, i])
            self.assertEqual(data.posterior[name].attrs["units"], unit)
        self.assertEqual(list(arviz.summary(data, kind="stats").index), posterior.parameters)

    @needs("meshio")
    def test_meshio(self):
        body = palpate.mesh(bar(), edge_length=14.0)
        back = palpate.Mesh.from_meshio(body.to_meshio())
        np.testing.assert_array_equal(back.nodes, body.nodes)
        np.testing.assert_array_equal(back.tetrahedra, body.tetrahedra)
        surface = palpate.Surface.from_meshio(bar().to_meshio())
        np.testing.assert_array_equal(surface.triangles, bar().triangles)
        with self.assertRaisesRegex(palpate.InvalidInput, "must have tetra"):
            palpate.Mesh.from_meshio(bar().to_meshio())

    @needs("pyvista")
    def test_pyvista(self):
        import pyvista

        surface = palpate.Surface.from_pyvista(bar().to_pyvista())
        np.testing.assert_array_equal(surface.triangles, bar().triangles)
        np.testing.assert_array_equal(surface.vertices, bar().vertices)
        self.assertAlmostEqual(palpate.Surface.from_pyvista(pyvista.Cube()).volume, 1, places=12)  # of quadrilaterals
        for linear in (False, True):
            body = palpate.mesh(bar(), edge_length=14.0, linear_elements=linear)
            grid = body.to_pyvista()
            self.assertEqual(grid.n_cells, len(body.tetrahedra))
            self.assertAlmostEqual(grid.volume, body.volume, delta=1e-9 * body.volume)
            back = palpate.Mesh.from_pyvista(grid)
            np.testing.assert_array_equal(back.nodes, body.nodes)
            np.testing.assert_array_equal(back.tetrahedra, body.tetrahedra)
        with self.assertRaisesRegex(palpate.InvalidInput, "is a UnstructuredGrid, must be a PolyData"):
            palpate.Surface.from_pyvista(grid)
        with self.assertRaisesRegex(palpate.InvalidInput, "is a PolyData without tetrahedra"):
            palpate.Mesh.from_pyvista(bar().to_pyvista())

    def test_notebooks_see_a_model(self):
        page = model()._repr_html_()
        self.assertTrue(page.startswith("<iframe srcdoc="))
        self.assertIn("&lt;canvas", page)


if __name__ == "__main__":
    unittest.main()
