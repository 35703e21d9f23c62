# %% [markdown]
# # Plan an experiment
#
# How many probes, read by how many markers, does a campaign need? Finite elements play the body, the readings get the
# camera's noise, the skeleton is fitted to each campaign, and all are judged by the same other probes, read without noise.
# What should be seen: the error falls with both, until what is left is the skeleton's own coarseness; two probes that twelve
# markers read tell as much as four that four markers read.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np
import palpate

bar = f"{os.environ.get('PALPATE_SAMPLES', 'samples')}/plan/bar.stl"
how = {"law": "linear", "edge_length": 12}
judges = palpate.probe(bar, probes=10, markers=60, seed=99, **how)
start = palpate.skeleton(bar, edge_length=12, spheres=10)

# %%
probes, markers = (2, 4, 8), (4, 12, 36)
errors = np.zeros((len(markers), len(probes)))
for i, m in enumerate(markers):
    for j, p in enumerate(probes):
        campaign = palpate.probe(bar, probes=p, markers=m, noise=0.05, seed=7, **how)
        fitted = palpate.identify(start, campaign, particles=50)
        errors[i, j] = palpate.compare(fitted, judges, reference=False).rms
        print(f"{p} probes, {m} markers: {errors[i, j]:.3f} mm rms on probes that it has not seen")

# %%
for m, row in zip(markers, errors):
    plt.plot(probes, row, "-o", label=f"{m} markers")
plt.xlabel("probes")
plt.ylabel("rms error on other probes [mm]")
plt.ylim(bottom=0)
plt.legend()
plt.show()
