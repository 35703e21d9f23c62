// The run's numbers as the page carries them: arrays of 32-bit numbers, or 16-bit ones with a scale, in base64.
'use strict';

function decoded(array) {
  if (!array) return null;
  const bytes = Uint8Array.from(atob(array.data), (c) => c.charCodeAt(0));
  switch (array.type) {
    case 'f32': return new Float32Array(bytes.buffer);
    case 'i32': return new Int32Array(bytes.buffer);
    default: return Float32Array.from(new Int16Array(bytes.buffer), (v) => v * array.scale);
  }
}

function readRun(json) {
  const run = JSON.parse(json);
  run.surface = {points: decoded(run.surface.points), triangles: decoded(run.surface.triangles)};
  run.spheres = {centers: decoded(run.spheres.centers), radii: decoded(run.spheres.radii), held: run.spheres.held};
  run.links = decoded(run.links);
  for (const state of run.states) state.measured = decoded(state.measured);
  for (const step of run.steps) {
    for (const quantity of step.quantities) quantity.values = decoded(quantity.values);
    for (const state of step.states) {
      state.skin = decoded(state.skin);
      state.spheres = decoded(state.spheres);
      for (const key of ['rest', 'measured', 'error']) state.markers[key] = decoded(state.markers[key]);
    }
  }
  return run;
}

const norm3 = (a, i) => Math.hypot(a[3 * i], a[3 * i + 1], a[3 * i + 2]);
const point3 = (a, i) => [a[3 * i], a[3 * i + 1], a[3 * i + 2]];

/// Rms over measured coordinates and largest length of a state's errors [mm].
function errorsOf(markers) {
  let squares = 0, count = 0, largest = 0;
  markers.id.forEach((_, i) => {
    squares += norm3(markers.error, i) ** 2;
    count += markers.coordinates[i];  // an unread one has the error 0
    largest = Math.max(largest, norm3(markers.error, i));
  });
  return {rms: Math.sqrt(squares / count), largest};
}

/// A marker value at other points: mean of the four nearest markers, weighted by the inverse square of the distance;
/// NaN where no marker is within reach [mm].
function spread(markers, values, points, reach) {
  const count = markers.id.length, result = new Float32Array(points.length / 3).fill(NaN);
  if (count === 0) return result;
  for (let p = 0; p < result.length; ++p) {
    const near = [];
    for (let m = 0; m < count; ++m) {
      const d = (points[3 * p] - markers.rest[3 * m]) ** 2 + (points[3 * p + 1] - markers.rest[3 * m + 1]) ** 2 +
        (points[3 * p + 2] - markers.rest[3 * m + 2]) ** 2;
      if (near.length < 4 || d < near[near.length - 1][0]) {
        near.push([d, values[m]]);
        near.sort((a, b) => a[0] - b[0]);
        if (near.length > 4) near.pop();
      }
    }
    if (near[0][0] > reach ** 2) continue;
    let sum = 0, weights = 0;
    for (const [d, v] of near) { const w = 1 / (d + 1e-12); sum += w * v; weights += w; }
    result[p] = sum / weights;
  }
  return result;
}
