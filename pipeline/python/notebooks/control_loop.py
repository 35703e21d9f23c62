# %% [markdown]
# # The model in a control loop
#
# A robot holds the tip of a soft bar by a spring and is to lead it along a circle, which it does not reach by going there
# itself: the bar pulls back. A controller corrects where the hand goes by what the model feels. What should be seen: without
# correction the tip stays behind, with it the tip follows the circle after one turn, and the loop runs far faster than 1 kHz.

# %%
import os
import time

import matplotlib.pyplot as plt
import numpy as np
import palpate

bar = f"{os.environ.get('PALPATE_SAMPLES', 'samples')}/plan/bar.stl"
model = palpate.skeleton(bar, edge_length=12, spheres=10)
surface = model.surface.vertices
tip = surface[np.argmax(surface[:, 0] + 0.01 * surface[:, 2])]

# %%
h, turns, period = 1e-3, 2, 1.0  # [s]
times = np.arange(0, turns * period, h)
angle = 2 * np.pi * times / period
circle = 2.0 * np.column_stack([np.zeros_like(times), np.sin(angle), np.cos(angle) - 1])  # [mm]
stiffness = 0.05  # of the robot's spring [N/mm]


def lead(gain):
    """How the tip moves, and what the hand feels, with an integral controller of that gain [1/s]."""
    moved, forces = np.empty_like(circle), np.empty_like(circle)
    with palpate.Body(model, damping_ratio=0.5) as body:
        hand = body.touch(tip, 3.0)
        start, correction = body.place(hand), np.zeros(3)
        began = time.perf_counter()
        for k, wanted in enumerate(circle):
            body.drag(hand, start + wanted + correction, stiffness)
            body.step(h)
            moved[k], forces[k] = body.place(hand) - start, body.force(hand)
            correction += gain * h * (wanted - moved[k])
        seconds = time.perf_counter() - began
    print(f"gain {gain:g} 1/s: {seconds / len(circle) * 1e6:.0f} us a turn of the loop")
    return moved, forces


runs = {"without correction": lead(0.0), "with correction": lead(40.0)}

# %%
figure, (plane, force) = plt.subplots(1, 2, figsize=(10, 4.5))
plane.plot(*circle[:, 1:].T, "k--", label="wanted")
for name, (moved, forces) in runs.items():
    plane.plot(*moved[:, 1:].T, label=name)
    force.plot(times, np.linalg.norm(forces, axis=1), label=name)
plane.set(xlabel="y [mm]", ylabel="z [mm]", aspect="equal")
force.set(xlabel="time [s]", ylabel="force on the hand [N]")
plane.legend()
plt.tight_layout()
plt.show()
