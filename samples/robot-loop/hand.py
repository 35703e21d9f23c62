"""A hand in a process of its own: drags the skin that serve.py keeps alive along a line and back, for a second.

    python3 samples/robot-loop/hand.py /tmp/organ.sock  0 0 40  0 0 -8     # socket, a point near the skin, the way [mm]
"""

import math
import socket
import statistics
import struct
import sys
import time

ASK = struct.Struct("<Q3d")  # the question's number, 0 to take hold; where the hand is [mm]
ANSWER = struct.Struct("<QQ3d3d")  # the question's number; steps so far; where the skin is [mm]; force on the hand [N]


class Hand:
    """Takes hold near `point` [mm]; `start` is where that is. Needs nothing but Python."""

    def __init__(self, path, point):
        self._line, self._number = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM), -1
        self._line.settimeout(5.0)
        self._line.bind("")  # a name of Linux's choice, to be answered to
        self._line.connect(path)
        self.start, _ = self.go(point)

    def go(self, place):
        """To `place` (3) [mm]; where the skin is (3) [mm], and the force on the hand (3) [N]."""
        self._number += 1
        self._line.send(ASK.pack(self._number, *place))
        number = None
        while number != self._number:  # an answer that came too late is not this one's
            number, self.tick, *numbers = ANSWER.unpack(self._line.recv(ANSWER.size))
        return numbers[:3], numbers[3:]

    def close(self):
        self._line.close()


def main(path, point, way, turns=1000, period=1e-3):
    hand, seconds, began = Hand(path, point), [], time.monotonic()
    print("time,fx,fy,fz")
    for turn in range(turns):
        time.sleep(max(0.0, began + turn * period - time.monotonic()))
        share = 0.5 - 0.5 * math.cos(2 * math.pi * turn / turns)  # of the way, in and out
        asked = time.monotonic()
        _, force = hand.go([s + share * w for s, w in zip(hand.start, way)])
        seconds.append(time.monotonic() - asked)
        print(f"{asked - began:.4f}," + ",".join(f"{f:.6g}" for f in force))
    shares = statistics.quantiles(seconds, n=100)
    middle, most, worst = (f"{1e6 * s:.0f} us" for s in (shares[49], shares[98], max(seconds)))
    print(f"{turns} turns, there and back in {middle}; 99 in 100 in {most}; the slowest in {worst}", file=sys.stderr)


if __name__ == "__main__":
    if len(sys.argv) != 8:
        sys.exit("hand.py SOCKET  X Y Z  DX DY DZ")
    try:
        main(sys.argv[1], [float(x) for x in sys.argv[2:5]], [float(x) for x in sys.argv[5:]])
    except (OSError, ValueError) as error:
        sys.exit(f"hand.py: {sys.argv[1]}: {error}; is serve.py running on it?")
