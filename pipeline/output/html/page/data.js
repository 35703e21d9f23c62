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

/// What the page carries of tools at rest.
function decodedTools(tools) {
  return tools.map((tool) => ({...tool, patch: decoded(tool.patch),
    surface: tool.surface && {points: decoded(tool.surface.points), triangles: decoded(tool.surface.triangles)}}));
}

function readRun(json) {
  const run = JSON.parse(json);
  run.surface = {points: decoded(run.surface.points), triangles: decoded(run.surface.triangles)};
  run.spheres = {centers: decoded(run.spheres.centers), radii: decoded(run.spheres.radii), held: run.spheres.held};
  run.links = decoded(run.links);
  run.tools = decodedTools(run.tools);
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
const lengthsOf = (vectors) => Array.from({length: vectors.length / 3}, (_, i) => norm3(vectors, i));
const largestOf = (values) => values.reduce((a, b) => Math.max(a, b), 0);

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

/// Where a surface faces at a vertex, of any length: the sum of its triangles' normals there.
function outwardAt(points, triangles, vertex) {
  const sum = [0, 0, 0];
  for (let t = 0; t < triangles.length; t += 3) {
    if (triangles[t] !== vertex && triangles[t + 1] !== vertex && triangles[t + 2] !== vertex) continue;
    const [a, b, c] = [0, 1, 2].map((k) => point3(points, triangles[t + k]));
    const u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
    for (let i = 0; i < 3; ++i) sum[i] += u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
  }
  return sum;
}

const short = (v) => (Number.isFinite(v) ? `${+v.toPrecision(3)}` : '–');
/// The measured force of a tool along the axes that were read [N], and the model's along the same.
const measuredForce = (tool) => Math.hypot(...tool.measured.map((f) => f ?? 0));
const modelledForce = (tool, force) => Math.hypot(...force.modelled.filter((_, c) => tool.measured[c] !== null));

/// What states are called in lists: probe and time, the force that acts, and whether it was held out.
function titlesOf(states) {
  const timed = states.some((s) => s.time !== 0), pressed = states.some((s) => s.loads.length || s.tools.some((t) => t.measured));
  const forceIn = (s) => {
    const forces = [...s.loads.map((l) => Math.hypot(l[3], l[4], l[5])), ...s.tools.filter((t) => t.measured).map(measuredForce)];
    return forces.length ? `${short(forces.reduce((a, b) => a + b))} N` : s.tools.length ? 'force not read' : 'no force';
  };
  return states.map((s) => [`${s.probe}${timed ? ` at ${+s.time.toPrecision(4)} s` : ''}`, ...(pressed ? [forceIn(s)] : []),
    ...(s.held_out ? ['held out'] : [])].join(', '));
}

/// How far a model is off in a state, by what was read: positions of markers, forces of tools.
function errorWords(now, answer) {
  const forces = now.tools.filter((t) => t.measured).map((tool) => {
    const force = answer.tool_forces.find((f) => f.name === tool.name);
    return `${tool.name} ${short(measuredForce(tool))} N measured${force ? `, ${short(modelledForce(tool, force))} N modelled` : ''}`;
  });
  return [...(answer.markers.id.length ? [`rms error ${short(answer.rms)}\u00a0mm per coordinate, largest distance ${short(answer.largest)}\u00a0mm`] : []),
    ...forces].join('; ') || 'nothing was read';
}
