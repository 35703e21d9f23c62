"""The sample of a control loop between processes: a server in one, hands in this one."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
import palpate
from bodies import SAMPLES, model, model_file

sys.path.insert(0, str(SAMPLES / "robot-loop"))
from hand import ASK, Hand  # noqa: E402

SERVE, HAND = SAMPLES / "robot-loop" / "serve.py", SAMPLES / "robot-loop" / "hand.py"
TIP = (60.0, 10.0, 20.0)
WAY = np.array([0.0, 0.0, -2.0])


class RobotLoop(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.socket = str(Path(kept.name) / "hand.sock")
        self.server = subprocess.Popen(
            [sys.executable, SERVE, model_file(), self.socket], stderr=subprocess.PIPE, text=True
        )
        self.addCleanup(self.server.stderr.close)
        self.addCleanup(self.server.wait)
        self.addCleanup(self.server.kill)
        last = time.monotonic() + 60
        while not os.path.exists(self.socket) and self.server.poll() is None and time.monotonic() < last:
            time.sleep(0.01)
        self.assertTrue(os.path.exists(self.socket), "the server does not listen")

    def hand(self):
        hand = Hand(self.socket, TIP)
        self.addCleanup(hand.close)
        return hand

    def ended(self):
        self.server.send_signal(signal.SIGTERM)
        _, told = self.server.communicate(timeout=60)
        self.assertEqual(self.server.returncode, 0)
        self.assertFalse(os.path.exists(self.socket))
        return told

    def held(self, hand, target, steps):
        """Skin and force after a hand has been held at `target` for so many of the server's steps."""
        skin, force = hand.go(target)
        last = hand.tick + steps
        while hand.tick < last:
            time.sleep(1e-3)  # a step; a question more often than that learns nothing
            skin, force = hand.go(target)
        return np.array(skin), np.array(force)

    def settled(self, hand):
        """Skin and force once they no longer change."""
        target = hand.start + WAY
        last = np.full(3, np.inf)
        for _ in range(600):  # a minute at 1 kHz
            skin, force = self.held(hand, target, 100)
            if np.abs(force - last).max() < 1e-5 * np.abs(force).max():
                return skin, force
            last = force
        self.fail(f"the force still changes, from {last} to {force} N")

    def test_forces_are_the_model_s(self):
        hand = self.hand()
        skin, force = self.settled(hand)
        body = palpate.Body(model(), damping_ratio=0.5)
        contact = body.touch(TIP, 2.0)
        np.testing.assert_array_equal(hand.start, body.place(contact))
        body.drag(contact, hand.start + WAY, 0.5)
        body.equilibrium()
        atol = 1e-3 * np.linalg.norm(force)  # what damping leaves when a force changes by 1e-5 of itself in 0.1 s
        np.testing.assert_allclose(force, -body.force(contact), atol=atol)
        np.testing.assert_allclose(force, -0.5 * (hand.start + WAY - skin), atol=atol)
        self.assertGreater(force[2], 0)  # pressed down, it presses back
        self.assertEqual(self.ended(), "")

    def test_a_hand_s_nonsense_is_its_own(self):
        hand, other = self.hand(), self.hand()
        hand._line.send(b"hello")
        hand._line.send(ASK.pack(1, np.nan, 0, 0))
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as nameless:
            nameless.sendto(ASK.pack(0, *TIP), self.socket)
        other.go(other.start)
        told = self.ended()
        self.assertIn("unpack requires a buffer of 32 bytes", told)
        self.assertIn("finite", told)
        self.assertIn("bind its socket", told)

    def test_a_silent_hand_is_let_go(self):
        first, second = self.hand(), self.hand()
        pressed, _ = self.held(second, second.start + WAY, 50)
        second.close()
        way = np.linalg.norm(pressed - first.start)
        for _ in range(300):  # 3 s; it is let go after half a second
            skin, _ = self.held(first, first.start, 10)
            if np.linalg.norm(skin - first.start) < 0.05 * way:
                break
        else:
            self.fail(f"the skin stays at {skin}, it was at {first.start}")
        self.assertEqual(self.ended(), "")

    def test_a_second_of_the_sample(self):
        done = subprocess.run(
            [sys.executable, HAND, self.socket, *map(str, (*TIP, *WAY))], capture_output=True, text=True, check=True
        )
        felt = np.array([[float(cell) for cell in line.split(",")] for line in done.stdout.splitlines()[1:]])
        self.assertEqual(felt.shape, (1000, 4))
        middle, ends = np.abs(felt[400:600, 3]).mean(), np.abs(felt[[0, -1], 3]).max()
        self.assertGreater(middle, 2 * ends)
        self.assertRegex(done.stderr, "1000 turns, there and back in [0-9]+ us")
        self.ended()

    def test_what_is_not_there_is_told(self):
        self.ended()
        for words in ([SERVE], [HAND], [SERVE, "none.json", self.socket], [HAND, self.socket, *map(str, (*TIP, *WAY))]):
            done = subprocess.run([sys.executable, *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("is serve.py running on it?", done.stderr)


if __name__ == "__main__":
    unittest.main()
