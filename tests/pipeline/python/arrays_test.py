"""Arrays in and out: views of the objects' own memory, and what is refused."""

import gc
import resource
import unittest

import numpy as np
import palpate
from bodies import bar, measured, model

CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


class Views(unittest.TestCase):
    def test_are_no_copies(self):
        m = model()
        for name in ("centers", "radii", "masses", "held", "links", "lengths", "stiffness"):
            first, second = getattr(m, name), getattr(m, name)
            self.assertEqual(first.ctypes.data, second.ctypes.data, name)
            self.assertFalse(first.flags.owndata, name)
        s = measured()
        for name in ("positions", "sigma", "markers", "contact_forces"):
            self.assertEqual(getattr(s, name).ctypes.data, getattr(s, name).ctypes.data, name)

    def test_cannot_be_written_to(self):
        m, s = model(), measured()
        for array in (m.centers, m.stiffness, s.positions, bar().vertices):
            with self.assertRaises(ValueError):
                array[0] = 1

    def test_outlive_their_object(self):
        m = model()
        stiffness, kept = m.stiffness, m.stiffness.copy()
        del m
        gc.collect()
        np.testing.assert_array_equal(stiffness, kept)

    def test_have_shapes_that_fit(self):
        m, s = model(), measured()
        self.assertEqual(m.stiffness.shape, (len(m.links), len(m.stiffness_names)))
        self.assertEqual(m.centers.shape, (len(m.radii), 3))
        self.assertTrue((m.links[:, 0] < m.links[:, 1]).all())
        self.assertEqual(s.positions.shape, (len(s.probes), len(s.marker_names), 3))
        loaded = s.contact_states[np.linalg.norm(s.contact_forces, axis=1) > 0]
        self.assertTrue(set(loaded) <= set(range(len(s.probes))))

    def test_show_what_the_file_says(self):
        import json

        from bodies import model_file

        told, m = json.loads(model_file().read_text()), model()
        np.testing.assert_array_equal(m.centers, [sphere["center"] for sphere in told["spheres"]])
        np.testing.assert_array_equal(
            m.stiffness, [[link[name] for name in m.stiffness_names] for link in told["links"]]
        )


class Stiffness(unittest.TestCase):
    def test_is_assigned_whole(self):
        m = model()
        doubled = 2 * m.stiffness
        m.stiffness = doubled
        np.testing.assert_array_equal(m.stiffness, doubled)
        m.stiffness = np.asfortranarray(doubled, dtype=np.float32)
        np.testing.assert_array_equal(m.stiffness, doubled.astype(np.float32))

    def test_refuses_what_no_link_has(self):
        m = model()
        before = m.stiffness.copy()
        for wrong, words in (
            (before[:-1], "must have the shape"),
            (-before, "must be finite and at least 0"),
            (np.full_like(before, np.nan), "must be finite"),
            (before + 1j, "must be real numbers"),
            ("soft", "must be real numbers"),
        ):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                m.stiffness = wrong
        np.testing.assert_array_equal(m.stiffness, before)


class Given(unittest.TestCase):
    def test_any_layout_is_taken(self):
        wide = np.zeros((4, 6))
        wide[:, ::2] = CORNERS
        read_only = CORNERS.copy()
        read_only.flags.writeable = False
        for layout in (
            np.asfortranarray(CORNERS), wide[:, ::2], CORNERS[::-1][::-1], CORNERS.astype("f4"), CORNERS.astype(">f8"),
            CORNERS.astype(int), read_only, CORNERS.tolist(),
        ):  # fmt: skip
            np.testing.assert_array_equal(palpate.Surface(layout, FACES).vertices, CORNERS)
        self.assertAlmostEqual(palpate.Surface(CORNERS, np.array(FACES, order="F")).volume, 1 / 6, places=15)

    def test_is_copied(self):
        given = CORNERS.copy()
        surface = palpate.Surface(given, FACES)
        given[:] = 0
        np.testing.assert_array_equal(surface.vertices, CORNERS)

    def test_wrong_ones_are_refused_by_name(self):
        bad = CORNERS.copy()
        bad[2, 1] = np.nan
        for vertices, triangles, words in (
            (bad, FACES, "vertices: row 2 is .*must be three finite numbers"),
            (CORNERS[:, :2], FACES, r"vertices: .*must have the shape \(n, 3\)"),
            (CORNERS.T, FACES, r"must have the shape \(n, 3\); reshape or transpose"),
            (CORNERS.astype(complex), FACES, "vertices: .*complex128.*must be real numbers"),
            (CORNERS.astype(str), FACES, "must be real numbers"),
            (object(), FACES, "must be real numbers|must be numbers"),
            (CORNERS, [[0, 1, 4]], "triangles: row 0 names vertex 4, there are 4"),
            (CORNERS, [[0, 1, -1]], "names vertex -1"),
            (CORNERS, [[0.5, 1, 2]], "triangles: .*must be whole numbers"),
        ):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.Surface(vertices, triangles)

    def test_tetrahedra_are_checked(self):
        self.assertAlmostEqual(palpate.Mesh(CORNERS, [[0, 1, 2, 3]]).volume, 1 / 6, places=15)
        with self.assertRaisesRegex(palpate.InvalidInput, "volume.*must be above 0; exchange two"):
            palpate.Mesh(CORNERS, [[0, 2, 1, 3]])
        with self.assertRaisesRegex(palpate.InvalidInput, "names node 9"):
            palpate.Mesh(CORNERS, [[0, 1, 2, 9]])
        with self.assertRaisesRegex(palpate.InvalidInput, "must have the shape"):
            palpate.Mesh(CORNERS, [[0, 1, 2]])


def resident():
    """Memory of this process [bytes]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


class Memory(unittest.TestCase):
    def test_is_given_back(self):
        def round_trip():
            m, surface = model(), palpate.Surface(CORNERS, FACES)
            kept = m.stiffness, m.centers, surface.vertices
            body = palpate.Body(m)
            kept += (body.skin, body.positions)
            body.push(body.touch((60, 10, 20)), (0, 0, -0.01))
            body.close()
            with self.assertRaises(palpate.InvalidInput):
                palpate.Surface(CORNERS, [[0, 1, 9]])

        for _ in range(20):
            round_trip()
        before = resident()
        for _ in range(100):
            round_trip()
        # A model, a body and their arrays take more than 100 kB: a hundred of them, were one of these kept, 10 MB.
        self.assertLess(resident() - before, 4e6)


class Sets(unittest.TestCase):
    def given(self, **changed):
        told = {
            "surface": bar(),
            "supports": {"box": {"min": [-1, -1, -1], "max": [3, 21, 21]}},
            "markers": [[60, 10, 20], [30, 10, 20]],
            "positions": [[[60, 10, 19.5], [np.nan, np.nan, np.nan]], [[60, 10.25, 20], [30, 10, 19.9]]],
            "points": [[60, 10, 20], [60, 10, 20]],
            "forces": [[0, 0, -0.1], [0, 0.1, 0]],
            "radius": 4,
            "noise": 0.01,
        }
        return {**told, **changed}

    def test_out_of_arrays(self):
        told = self.given(sigma=[[0.01, 0.02]], density=1000, gravity=(0, 0, -9810), name="rig")
        s = palpate.Set.from_arrays(**told)
        np.testing.assert_array_equal(s.positions, told["positions"])
        np.testing.assert_array_equal(s.markers, told["markers"])
        np.testing.assert_array_equal(s.contact_forces, told["forces"])
        np.testing.assert_array_equal(s.sigma, [[0.01, np.nan], [0.01, 0.02]])
        self.assertEqual((s.name, s.gravity), ("rig", (0, 0, -9810)))
        self.assertAlmostEqual(s.density, 1000, places=9)  # to tonnes and back

    def test_wrong_ones_are_refused_by_name(self):
        for changed, words in (
            ({"forces": [[0, 0, 1]]}, r"forces: has the shape \(1, 3\), must have the shape \(2, 3\)"),
            ({"markers": [[60, 10], [30, 10]]}, "markers: has the shape"),
            ({"markers": [[60, 10, np.nan], [30, 10, 20]]}, "markers: nan at .*must be finite"),
            ({"positions": np.full((2, 2, 3), np.inf)}, "positions: inf at .*NaN is a missing reading"),
            ({"positions": "here"}, "positions: must be real numbers"),
            ({"marker_names": ["a"]}, "marker_names: has 1 names"),
            ({"positions": np.full((2, 2, 3), np.nan)}, "^positions.csv: the set has no readings"),
            ({"supports": {"ball": {}}}, "set.yaml"),
            ({"supports": None}, "supports: is None, must be a box"),
            ({"supports": {"box": {"min": object()}}}, "supports: a object stands in it"),
            ({"radius": [1, 2, 3]}, r"radius: must be a real number, or real numbers of shape \(2,\)"),
            ({"sigma": 1j}, r"sigma: must be a real number, or real numbers of shape \(2, 2\)"),
            ({"sigma": "thin"}, "sigma: must be a real number"),
            ({"noise": "low"}, "noise: is 'low', must be a real number"),
            ({"gravity": [0, -9810]}, r"gravity: has the shape \(2,\)"),
            ({"probes": [1, 1.5]}, "probes: 1.5 is no whole number"),
        ):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.Set.from_arrays(**self.given(**changed))
        with self.assertRaisesRegex(TypeError, "surface: is a str, must be a Surface or a Mesh"):
            palpate.Set.from_arrays(**self.given(surface="organ.stl"))


if __name__ == "__main__":
    unittest.main()
