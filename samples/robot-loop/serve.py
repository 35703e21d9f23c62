"""Keeps a model alive at 1 kHz behind a UNIX datagram socket: where hands are comes in, what they feel goes out.

    python3 samples/robot-loop/serve.py runs/organ/identify/model.json /tmp/organ.sock     # Ctrl-C ends it
"""

import os
import select
import signal
import socket
import struct
import sys
import time

import palpate
from hand import ANSWER, ASK

RATE = 1000.0  # [1/s]
STIFFNESS = 0.5  # of the spring from a hand to the skin [N/mm]
RADIUS = 2.0  # of skin that a hand holds [mm]
SILENCE = 500  # steps after which a hand is let go: its process has ended, or hangs
LATE = 0.02  # made up for by steps without a pause; what is lost beyond is lost [s]


def serve(model, path):
    body, door = palpate.Body(model, damping_ratio=0.5), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    hands = {}  # by address: contact, the step at which it last spoke
    door.bind(path)
    door.setblocking(False)
    tick, due = 0, time.monotonic()
    try:
        while True:
            if select.select([door], [], [], max(0.0, due - time.monotonic()))[0]:
                answer(door, body, hands, tick)
            now = time.monotonic()
            if now < due:
                continue
            body.step(1 / RATE)
            tick, due = tick + 1, max(due + 1 / RATE, now - LATE)
            for address in [a for a, (_, spoke) in hands.items() if tick - spoke > SILENCE]:
                body.release(hands.pop(address)[0])
    finally:
        door.close()
        os.unlink(path)


def answer(door, body, hands, tick):
    """One hand's question. Its answer is the force of the last step: at most 1 ms old, and not waited for."""
    try:
        question, address = door.recvfrom(ASK.size)
        number, *place = ASK.unpack(question)
        if not address:
            raise OSError("a hand without a name cannot be answered; bind its socket")
        contact = hands[address][0] if address in hands else body.touch(place, RADIUS)
        hands[address] = contact, tick
        if number > 0:  # the first one only takes hold
            body.drag(contact, place, STIFFNESS)
        door.sendto(ANSWER.pack(number, tick, *body.place(contact), *-body.force(contact)), address)
    except (palpate.InvalidInput, OSError, struct.error) as error:  # of that hand: the others' loop goes on
        print(f"serve.py: {error}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("serve.py MODEL SOCKET")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    try:
        serve(*sys.argv[1:])
    except (palpate.Error, OSError) as error:
        sys.exit(f"serve.py: {error}")
    except KeyboardInterrupt:
        pass
