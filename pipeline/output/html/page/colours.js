// Colours that colour-blind readers can distinguish too, and in print.
'use strict';

/// Nine points of viridis (van der Walt & Smith 2015).
const viridis = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
  [92, 200, 99], [170, 220, 50], [253, 231, 37]];
const unknownColour = [0.72, 0.72, 0.72], loadColour = [0.84, 0.37, 0], measuredColour = [0.1, 0.1, 0.12], wireColour = [0.5, 0.52, 0.56];

/// What each thing in the view of a run is drawn in: in the picture, in its key, and in the chart below. Body, spheres,
/// links and markers of the model have the colours of a scale instead.
const viewColours = (dark) => ({
  measured: dark ? [1, 0.44, 0.5] : [0.83, 0.05, 0.2], error: dark ? [0.9, 0.92, 0.94] : measuredColour,
  load: dark ? [1, 0.6, 0.2] : loadColour, held: dark ? [0.32, 0.74, 0.62] : [0.14, 0.62, 0.48],
  tool: dark ? [0.45, 0.72, 0.95] : [0.2, 0.55, 0.85], shape: wireColour, found: foundColour,
  softer: softerColour});

/// [r, g, b] in 0..1 of a share in 0..1; grey where there is none.
function colourOf(share) {
  if (!Number.isFinite(share)) return unknownColour;
  const at = Math.min(Math.max(share, 0), 1) * (viridis.length - 1);
  const below = Math.min(Math.floor(at), viridis.length - 2), t = at - below;
  return viridis[below].map((c, i) => ((1 - t) * c + t * viridis[below + 1][i]) / 255);
}

const gradient = `linear-gradient(to right, ${viridis.map((c) => `rgb(${c})`).join(',')})`;

/// Where a value lies between two others, by ratio or by difference.
class Scale {
  constructor(values, logarithmic) {
    const usable = values.filter((v) => Number.isFinite(v) && (!logarithmic || v > 0));
    this.logarithmic = logarithmic;
    this.high = usable.reduce((a, b) => Math.max(a, b), logarithmic ? 1e-300 : 0) || 1;
    this.low = logarithmic ? usable.reduce((a, b) => Math.min(a, b), this.high) : 0;
  }
  share(value) {
    if (!this.logarithmic) return value / this.high;
    return this.high > this.low ? Math.log(value / this.low) / Math.log(this.high / this.low) : 0.5;
  }
  colour(value) { return colourOf(this.share(value)); }
}
