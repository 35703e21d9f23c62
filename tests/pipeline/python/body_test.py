"""The model, alive."""

import gc
import subprocess
import sys
import unittest

import numpy as np
import palpate
from bodies import model, model_file

TIP = (60.0, 10.0, 20.0)
ADRIFT = 1e-6  # share that steps leave of an equilibrium: their tolerance


class Bodies(unittest.TestCase):
    def test_force_is_stiffness_times_way(self):
        body = palpate.Body(model())
        hand = body.touch(TIP, 3.0)
        place = body.place(hand)
        body.drag(hand, place + (0, 0, -2), 0.05)
        body.equilibrium()
        spring = 0.05 * (place + (0, 0, -2) - body.place(hand))
        np.testing.assert_allclose(body.force(hand), spring, rtol=1e-12, atol=1e-12)
        self.assertLess(body.place(hand)[2], place[2])
        body.release(hand)
        body.equilibrium()
        rest = model().centers
        np.testing.assert_allclose(body.positions, rest, atol=ADRIFT * np.abs(rest).max())

    def test_steps_come_to_the_equilibrium(self):
        body, at_once = palpate.Body(model_file(), damping_ratio=1.0), palpate.Body(model_file())
        for one in (body, at_once):
            one.push(one.touch(TIP, 3.0), np.array([0, 0, -0.05]))
        at_once.equilibrium()
        body.step(0.05, 100)
        np.testing.assert_allclose(body.positions, at_once.positions, atol=1e-3)  # of 60 mm: what damping leaves

    def test_one_call_a_turn(self):
        turn, calls = palpate.Body(model()), palpate.Body(model())
        hands = [turn.touch(TIP), turn.touch((60, 10, 0))]
        self.assertEqual(hands, [calls.touch(TIP), calls.touch((60, 10, 0))])
        to = np.array([[61.0, 10, 19], [60, 11, 0]])
        for _ in range(5):
            forces = turn.drag_and_step(hands, to, 0.1, 1e-3)
            for hand, target in zip(hands, to):
                calls.drag(hand, target, 0.1)
            calls.step(1e-3)
            np.testing.assert_array_equal(forces, [calls.force(hand) for hand in hands])
        np.testing.assert_array_equal(turn.positions, calls.positions)
        with self.assertRaisesRegex(palpate.InvalidInput, "to: has 1 rows, must have one for each of the 2"):
            turn.drag_and_step(hands, to[:1], 0.1, 1e-3)

    def test_explicit_steps_keep_energy_without_damping(self):
        body = palpate.Body(model(), damping_ratio=0.0)
        body.push(body.touch(TIP), (0, 0, -0.02))
        body.equilibrium()
        body.release(0)
        total = sum(body.energy)
        h = 0.2 * body.stable_step
        body.step_explicit(h, 200)
        self.assertAlmostEqual(sum(body.energy), total, delta=0.01 * total)  # (0.2)^2 / 4 of it, at second order

    def test_skin_is_a_view_that_follows(self):
        body = palpate.Body(model())
        skin = body.skin
        before = skin.copy()
        body.push(body.touch(TIP), (0, 0, -0.05))
        body.equilibrium()
        self.assertEqual(body.skin.ctypes.data, skin.ctypes.data)
        self.assertGreater(np.abs(skin - before).max(), 0.01)
        self.assertEqual(skin.dtype, np.float32)
        self.assertLess(body.triangles.max(), len(skin))
        with self.assertRaises(ValueError):
            skin[0] = 0

    def test_used_after_close(self):
        with palpate.Body(model()) as body:
            skin = body.skin
            self.assertFalse(body.closed)
        self.assertTrue(body.closed)
        for call in (
            lambda: body.step(1e-3), lambda: body.skin, lambda: body.positions, lambda: body.touch(TIP),
            lambda: body.energy, body.equilibrium, body.reset, lambda: body.drag_and_step([], np.zeros((0, 3)), 1, 1),
        ):  # fmt: skip
            with self.assertRaisesRegex(ValueError, "closed"):
                call()
        self.assertIn("closed", repr(body))
        del body
        gc.collect()
        self.assertTrue(np.isfinite(skin).all())  # its memory lasts

    def test_what_cannot_be_is_refused(self):
        body = palpate.Body(model())
        hand = body.touch(TIP)
        for call, words in (
            (lambda: body.push(hand, (0, 0, np.nan)), "force: .*finite"),
            (lambda: body.push(hand, np.array([0, np.inf, 0])), "force: .*finite"),
            (lambda: body.push(hand, (0, 0)), r"force: .*shape \(3,\)"),
            (lambda: body.push(hand, "up"), "force: .*real numbers"),
            (lambda: body.push(7, (0, 0, 1)), "contact 7 is not in use"),
            (lambda: body.drag(hand, TIP, 0.0), "must be above 0"),
            (lambda: body.step(0.0), "must be above 0"),
            (lambda: body.step(1e-3, -1), "steps: is -1, must be at least 0"),
            (lambda: body.step(float("nan")), "must be above 0"),
            (lambda: palpate.Body(model(), contacts=65), "0 to 64"),
            (lambda: palpate.Body(model(), damping_ratio=-1.0), "damping_ratio"),
        ):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                call()
        body.step(1e-3)

    def test_vectors_of_any_layout(self):
        results = []
        wide = np.zeros(6)
        wide[::2] = (0, 0, -0.05)
        for force in ((0, 0, -0.05), [0, 0, -0.05], np.array([0, 0, -0.05]), wide[::2], wide[::2].astype(">f8")):
            body = palpate.Body(model())
            body.push(body.touch(TIP), force)
            body.step(1e-3)
            results.append(body.positions.copy())
        for result in results[1:]:
            np.testing.assert_array_equal(result, results[0])

    def test_left_open_at_the_end(self):
        code = (
            f"import palpate; body = palpate.Body({str(model_file())!r}); skin = body.skin; "
            "palpate.effect('bed', {'k': ('N/mm^3', 1.0)})(lambda X, x, k: (0.0, x * 0, [[0] * 3] * 3))"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
