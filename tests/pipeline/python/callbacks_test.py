"""Progress, messages, and what ends long work: a callback that raises, Ctrl-C. What comes after works as before."""

import contextlib
import logging
import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np
import palpate
from bodies import SAMPLES, bar_file, measured, model, model_file, set_folder


class Stop(Exception):
    pass


class Callbacks(unittest.TestCase):
    def identified(self, **how):
        return palpate.identify(model(), measured(), particles=40, threads=1, **how).model.stiffness

    def test_progress_tells_what_and_how_much(self):
        told = []
        quiet = self.identified()
        np.testing.assert_array_equal(self.identified(progress=lambda *what: told.append(what)), quiet)
        self.assertIn("particles", {what for what, _ in told})
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction in told))

    def test_what_progress_raises_ends_the_work(self):
        before = self.identified()
        calls = []

        def stop(what, fraction):
            calls.append(what)
            if len(calls) == 3:
                raise Stop("enough")

        with tempfile.TemporaryDirectory() as folder:
            for work in (
                lambda: self.identified(progress=stop),
                lambda: palpate.mesh(bar_file(), edge_length=14.0, progress=stop),
                lambda: palpate.run(bar_file(), Path(folder) / "run", edge_length=14.0, spheres=6, progress=stop),
                lambda: palpate.probe(model(), Path(folder) / "set", probes=2, hide="gravity", progress=stop),
            ):
                calls.clear()
                with self.assertRaisesRegex(Stop, "enough"):
                    work()
                self.assertEqual(len(calls), 3)
            self.assertFalse((Path(folder) / "set").exists())  # whole or not at all
            self.assertFalse((Path(folder) / "run" / "identify").exists())
        np.testing.assert_array_equal(self.identified(), before)

    def test_a_bar_is_shown_and_taken_away(self):
        with tempfile.TemporaryFile("w+") as out, contextlib.redirect_stderr(out):
            palpate.mesh(bar_file(), edge_length=14.0, progress=True)

    def test_messages_are_logged(self):
        with self.assertLogs("palpate", logging.INFO) as logged:
            palpate.mesh(bar_file(), edge_length=14.0)
        self.assertTrue(any("0.1 MPa" in line for line in logged.output), logged.output)

    def test_nothing_is_printed(self):
        code = f"import palpate; palpate.mesh({str(bar_file())!r}, edge_length=14.0)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def interrupted(self, work):
        """Seconds from Ctrl-C, which comes while the work goes on, to its exception."""
        import time

        began, pressed = threading.Event(), []

        def press():
            began.wait(60)
            pressed.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

        hand = threading.Thread(target=press)
        hand.start()
        try:
            with self.assertRaises(KeyboardInterrupt):
                work(lambda what, fraction: began.set())
        finally:
            began.set()
            hand.join()
        return time.monotonic() - pressed[0]

    def test_ctrl_c_ends_a_long_fit(self):
        before = self.identified()
        self.interrupted(lambda tell: palpate.identify(model_file(), set_folder(), particles=200_000, progress=tell))
        np.testing.assert_array_equal(self.identified(), before)

    def test_ctrl_c_while_a_child_process_works(self):
        organ = SAMPLES / "organ" / "organ.stl"
        self.interrupted(lambda tell: palpate.mesh(organ, edge_length=1.5, progress=tell))

    def test_ctrl_c_in_a_diagnosis(self):
        self.interrupted(lambda tell: palpate.diagnose(model_file(), set_folder(), edge_length=2.5, progress=tell))


if __name__ == "__main__":
    unittest.main()
