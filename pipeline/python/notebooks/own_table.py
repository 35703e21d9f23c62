# %% [markdown]
# # Bring your own table
#
# A table as a lab keeps it, in centimetres and grams, becomes a measurement set of arrays; a skeleton is fitted to it with
# and without its weight. What should be seen: without gravity the model does not move where no mass hangs, and is too
# soft to make up for it; with its weight it follows.

# %%
import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import palpate

samples = Path(os.environ.get("PALPATE_SAMPLES", "samples"))
file = samples.parent / "pipeline/python/notebooks/beam_in_the_lab.csv"
table = np.genfromtxt(file, delimiter=",", names=True, skip_header=2)
print(table.dtype.names)

# %% [markdown]
# To mm and N: one place where units change. Six trials, three markers; an empty cell is a missing reading.

# %%
trials = len(table)
columns = [[f"m{marker}_{axis}_cm" for axis in "xyz"] for marker in range(3)]
positions = np.array([[[row[name] for name in names] for names in columns] for row in table]) * 10
forces = np.zeros((trials, 3))
forces[:, 2] = -table["mass_g"] * 1e-3 * 9.81
measured = palpate.Set.from_arrays(
    palpate.Surface.read(samples / "dragonskin-beam/rest.stl"),
    {"box": {"min": [-100.5, -1, -1], "max": [-99.5, 31, 31]}},
    markers=[[-1.26, 14.98, 35.43], [-0.14, -5.70, 23.97], [0.30, 36.24, 6.47]],  # balls on pins of 5 to 6 mm
    anchors=[[0, 15, 30], [0, 0, 24], [0, 30, 6]],
    positions=positions,
    points=np.tile([0, 15, 30], (trials, 1)),
    forces=forces,
    radius=15,
    noise=0.5,
    density=1070,
    young=0.264,
    poisson=0.499,
    name="beam",
)
print(palpate.check(measured))

# %%
start = palpate.skeleton(measured, edge_length=14, spheres=10)
models = {
    "nothing added": palpate.identify(start, measured, parameters="uniform", particles=60),
    "with its weight": palpate.identify(
        start.with_effect("gravity", gx=0, gy=0, gz=-9810), measured, parameters="uniform", particles=60
    ),
}
compared = {name: palpate.compare(found, measured, reference=False) for name, found in models.items()}
for name, comparison in compared.items():
    print(f"{name}: {comparison.rms:.2f} mm rms")

# %%
drop = np.nanmean(measured.positions[:, :, 2] - measured.markers[:, 2], axis=1)
plt.plot(table["mass_g"], drop, "ko", label="measured")
for name, comparison in compared.items():
    modelled = np.nanmean(comparison.predicted[:, :, 2] - measured.markers[:, 2], axis=1)
    plt.plot(table["mass_g"], modelled, "-x", label=f"model, {name}: {comparison.rms:.1f} mm rms")
plt.xlabel("mass at the tip [g]")
plt.ylabel("height of the markers over rest [mm]")
plt.legend()
plt.show()
