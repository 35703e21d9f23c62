# %% [markdown]
# # The first ladder
#
# A silicone beam was measured under three loads. A run fits a model to it, says what the model lacks, adds it, and tells
# the error before and after. What should be seen: gravity is missing, and with it the error falls to a quarter.

# %%
import os

import matplotlib.pyplot as plt
import palpate

samples = os.environ.get("PALPATE_SAMPLES", "samples")
run = palpate.run(f"{samples}/dragonskin-beam/case.yaml", "dragonskin-beam-run", edge_length=12)
print(run.diagnosis)
steps = run.ladder.steps
plt.bar([" + ".join(step["effects"]) or "nothing added" for step in steps], run.ladder.rms, width=0.4)
plt.ylabel("rms error of the model [mm]")
plt.title(f"A measured beam: {run.diagnosis.verdict}, {', '.join(run.diagnosis.explanation)}")
plt.show()
