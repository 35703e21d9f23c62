"""What nobody should do, done to the extension: refused by an exception, or done right; never a crash.

`memory_check` runs it under valgrind.
"""

import gc
import itertools
import os
import signal
import threading
import unittest

import numpy as np
import palpate
from bodies import bar, measured, model

TIP = (60.0, 10.0, 20.0)


class Stop(Exception):
    pass


def wrong(shape):
    """Arrays that are none of finite real numbers (n, 3) or (3,)."""
    good = np.ones(shape)
    yield from (good.astype(complex), good.astype(str), good.astype(object), good > 0, None, "soft", object(), {}, 1.0)
    yield from (good[..., :2], good[None], np.ones(()), np.ones((2, 0)), [[1, 2], [3]], [1, [2], 3], b"\0" * 24)
    for value, place in itertools.product((np.nan, np.inf, -np.inf), (0, -1)):
        bad = good.copy()
        bad.flat[place] = value
        yield bad


def laid_out(array):
    """The same numbers in every layout."""
    wide = np.zeros((*array.shape[:-1], 2 * array.shape[-1]))
    wide[..., ::2] = array
    constant = array.copy()
    constant.flags.writeable = False
    unaligned = np.frombuffer(b"\0" + array.tobytes(), dtype=np.uint8)[1:].view(array.dtype).reshape(array.shape)
    yield from (array.tolist(), np.asfortranarray(array), wide[..., ::2], array[::-1].copy()[::-1], constant, unaligned)
    yield from (array.astype(">f8"), array.astype(np.longdouble), array.astype(np.float32), array.astype(int))


class Closes:
    """Becomes an array by way of code that closes the body meanwhile."""

    def __init__(self, body):
        self.body = body

    def __array__(self, *_, **__):
        self.body.close()
        return np.array([0.0, 0.0, -0.05])


class BadInput(unittest.TestCase):
    def refused(self, call, *given):
        with self.assertRaises((palpate.InvalidInput, TypeError)):
            call(*given)

    def test_arrays_that_are_no_points(self):
        m, body = model(), palpate.Body(model())
        hand = body.touch(TIP)
        for array in wrong((4, 3)):
            self.refused(palpate.Surface, array, [[0, 1, 2]])
            self.refused(palpate.Mesh, array, [[0, 1, 2, 3]])
            self.refused(setattr, m, "stiffness", array)
            self.refused(body.drag_and_step, [hand] * 4, array, 0.1, 1e-3)
        for array in wrong((3,)):
            self.refused(body.push, hand, array)
            self.refused(body.drag, hand, array, 0.1)
            self.refused(body.touch, array)
            self.refused(body.set_gravity, array)
        body.step(1e-3)

    def test_rows_that_name_no_point(self):
        corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        for place in (4, -1, 2**31, 2**40, -(2**63)):
            self.refused(palpate.Surface, corners, [[0, 1, place]])
            self.refused(palpate.Mesh, corners, [[0, 1, 2, place]])
        for rows in ([[0.0, 1, 2]], [[0, 1]], [0, 1, 2], [[0, 1, 2, 3, 0]], np.zeros((1, 3), complex), "abc"):
            self.refused(palpate.Mesh, corners, rows)
        body = palpate.Body(model())
        for contact in (-1, 0, 8, 2**31 - 1, -(2**31), 2**40, 1.5, None):
            self.refused(body.push, contact, TIP)
            self.refused(body.force, contact)
            self.refused(body.release, contact)
            self.refused(body.drag_and_step, [contact], [TIP], 0.1, 1e-3)

    def test_any_layout_is_read_right(self):
        m = model()
        vertices = np.round(bar().vertices)
        stiffness = np.ceil(m.stiffness)  # float32 and int hold these
        for given in laid_out(vertices):
            np.testing.assert_array_equal(palpate.Surface(given, bar().triangles).vertices, vertices)
        for given in laid_out(stiffness):
            m.stiffness = given
            np.testing.assert_array_equal(m.stiffness, stiffness)
        for rows in (bar().triangles.astype(kind) for kind in ("i1", "u2", ">i4", "i8", "u8")):
            for given in (rows, np.asfortranarray(rows), rows[::-1][::-1]):
                np.testing.assert_array_equal(palpate.Surface(vertices, given).triangles, bar().triangles)

    def test_views_of_what_is_gone(self):
        body, s, m = palpate.Body(model()), measured(), model()
        views = [body.skin, body.triangles, body.positions, s.positions, s.sigma, s.contact_forces, s.surface.vertices]
        views += [m.stiffness, m.links, m.centers, m.held, m.surface.vertices]
        found = palpate.identify(m, s, particles=10, threads=1)
        views += [found.posterior.draws, found.posterior.weights, found.model.stiffness]
        kept = [view.copy() for view in views]
        body.close()
        del body, s, m, found
        gc.collect()
        for view, copy in zip(views, kept):
            np.testing.assert_array_equal(view, copy)

    def test_a_body_closed_within_its_own_call(self):
        body = palpate.Body(model())
        hand = body.touch(TIP)
        body.push(hand, Closes(body))
        self.assertTrue(body.closed)
        self.refused_as_closed(body)

    def test_a_body_closed_while_it_steps(self):
        body = palpate.Body(model())
        stepper = threading.Thread(target=body.step, args=(1e-3, 2000))
        stepper.start()
        body.close()
        stepper.join()
        self.refused_as_closed(body)

    def refused_as_closed(self, body):
        with self.assertRaisesRegex(ValueError, "closed"):
            body.step(1e-3)

    def test_exceptions_of_callbacks(self):
        def stop(*_, **__):
            raise Stop

        for work in (
            lambda: palpate.mesh(bar(), edge_length=14.0, progress=stop),
            lambda: palpate.identify(model(), measured(), particles=10, threads=2, progress=stop),
            lambda: palpate.probe(model(), probes=2, progress=stop),
        ):
            with self.assertRaises(Stop):
                work()
        palpate.effect("stops", {"k": ("N/mm^3", 1.0)})(stop)
        with self.assertRaises(Stop):
            palpate.simulate(model().with_effect("stops", k=1.0), measured(), threads=2)

    def test_ctrl_c_in_a_fit(self):
        def press(*_):
            os.kill(os.getpid(), signal.SIGINT)

        for threads in (1, 2):
            with self.assertRaises(KeyboardInterrupt):
                palpate.identify(model(), measured(), particles=1000, threads=threads, progress=press)

    def test_a_fork_goes_on(self):
        body = palpate.Body(model())
        child = os.fork()
        if child == 0:
            worked = False
            try:
                body.step(1e-3)
                palpate.identify(model(), measured(), particles=10, threads=2)
                worked = True
            finally:
                os._exit(0 if worked else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        body.step(1e-3)


if __name__ == "__main__":
    unittest.main()
