// What the view shows of a body in the hand.
'use strict';

/// viridis without its darkest fifth, in steps, so that thousands of vertices are coloured in no time.
const palette = Array.from({length: 256}, (_, i) => colourOf(0.2 + 0.8 * i / 255)).flat();
const paletteGradient = `linear-gradient(to right, ${Array.from({length: 9}, (_, i) =>
  `rgb(${colourOf(0.2 + 0.1 * i).map((c) => Math.round(255 * c))})`)})`;

/// Errors of markers at the vertices of the skin: means of the four nearest, weighted by the inverse square of the
/// distance at rest; NaN further than `reach` from any [mm].
class SkinErrors {
  constructor(rest, markers, reach) {
    this.near = Array.from({length: rest.length / 3}, (_, v) => {
      const all = markers.map((m, i) => [i, length3(minus3(row3(rest, v), m))]).sort((a, b) => a[1] - b[1]).slice(0, 4);
      return all.length && all[0][1] <= reach ? all.map(([i, d]) => [i, 1 / (d * d + 1e-12)]) : [];
    });
  }
  /// `errors`: of each marker, NaN where it was not read.
  at(errors) {
    return Float32Array.from(this.near, (near) => {
      let sum = 0, weights = 0;
      for (const [i, w] of near) if (Number.isFinite(errors[i])) { sum += w * errors[i]; weights += w; }
      return weights > 0 ? sum / weights : NaN;
    });
  }
}

/// How far apart two lists of as many points are, point by point.
function distances(points, others) {
  const result = new Float32Array(points.length / 3);
  for (let v = 0, i = 0; v < result.length; ++v, i += 3) {
    const x = points[i] - others[i], y = points[i + 1] - others[i + 1], z = points[i + 2] - others[i + 2];
    result[v] = Math.sqrt(x * x + y * y + z * z);
  }
  return result;
}

/// The next of 1, 2, 5, 10, ... that is not below a value.
function roundUp(value) {
  if (!(value > 0)) return 1;
  const ten = 10 ** Math.floor(Math.log10(value));
  return ten * [1, 2, 5, 10].find((f) => f * ten >= value * 0.999999);
}

/// Colours of vertices by values, and the scale that they are on.
function coloured(values, high, colours) {
  for (let v = 0; v < values.length; ++v) {
    if (!Number.isFinite(values[v])) { colours.set(unknownColour, 3 * v); continue; }
    const at = 3 * Math.min(255, Math.max(0, Math.round(255 * values[v] / high)));
    colours[3 * v] = palette[at];
    colours[3 * v + 1] = palette[at + 1];
    colours[3 * v + 2] = palette[at + 2];
  }
  return colours;
}

/// Arrows of forces: [{force, place}], `strongest` being as long as a sixth of the body [N].
function forceArrows(contacts, strongest, camera) {
  return contacts.filter((c) => length3(c.force) > 1e-9).map(({force, place}) => {
    const unit = unit3(force), length = camera.size * (0.04 + 0.13 * Math.min(1, length3(force) / strongest));
    const inwards = dot3(unit, minus3(place, camera.middle)) < 0;
    return {start: inwards ? plus3(place, unit, -length) : place, end: inwards ? place : plus3(place, unit, length),
      radius: 0.008 * camera.size, colour: loadColour};
  });
}
