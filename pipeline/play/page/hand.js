// Where a pointer meets the body, and which points keys can choose.
'use strict';

/// The ray through a place in a picture of so many pixels: where it begins and its direction.
function rayAt(camera, x, y, width, height) {
  const R = camera.turned, P = camera.projection(width / height);
  const seen = [(2 * x / width - 1) / P[0], (1 - 2 * y / height) / P[5], -1];
  const inSpace = (v) => [0, 1, 2].map((k) => R[3 * k] * v[0] + R[3 * k + 1] * v[1] + R[3 * k + 2] * v[2]);
  return {from: plus3(camera.target, inSpace([0, 0, camera.distance])), along: inSpace(seen)};
}

/// Where a ray first meets the skin: {triangle, shares of its corners, t along the ray}, or null. [Moeller, Trumbore]
function meet(ray, points, triangles) {
  let best = null;
  const {from, along} = ray;
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i], b = 3 * triangles[i + 1], c = 3 * triangles[i + 2];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const px = along[1] * vz - along[2] * vy, py = along[2] * vx - along[0] * vz, pz = along[0] * vy - along[1] * vx;
    const det = ux * px + uy * py + uz * pz;
    if (Math.abs(det) < 1e-300) continue;
    const sx = from[0] - points[a], sy = from[1] - points[a + 1], sz = from[2] - points[a + 2];
    const v = (sx * px + sy * py + sz * pz) / det;
    if (v < 0 || v > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const w = (along[0] * qx + along[1] * qy + along[2] * qz) / det;
    if (w < 0 || v + w > 1) continue;
    const t = (vx * qx + vy * qy + vz * qz) / det;
    if (t > 0 && (!best || t < best.t)) best = {triangle: i / 3, shares: [1 - v - w, v, w], t};
  }
  return best;
}

/// A point of a triangle by the shares of its corners.
function pointIn(points, triangles, {triangle, shares}) {
  return shares.reduce((sum, share, c) => plus3(sum, row3(points, triangles[3 * triangle + c]), share), [0, 0, 0]);
}

/// The outward normal of the skin round a vertex.
function normalAt(points, triangles, vertex) {
  let normal = [0, 0, 0];
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [triangles[i], triangles[i + 1], triangles[i + 2]];
    if (a !== vertex && b !== vertex && c !== vertex) continue;
    const A = row3(points, a);
    normal = plus3(normal, cross3(minus3(row3(points, b), A), minus3(row3(points, c), A)));
  }
  return unit3(normal);
}

/// So many vertices, each as far as possible from those before it; the first is the furthest from `from`.
function spreadVertices(points, from, count) {
  const n = points.length / 3, chosen = [];
  const nearest = Float64Array.from({length: n}, (_, v) => length3(minus3(row3(points, v), from)));
  while (chosen.length < Math.min(count, n)) {
    let best = 0;
    for (let v = 1; v < n; ++v) if (nearest[v] > nearest[best]) best = v;
    const at = row3(points, best);
    if (chosen.length === 0) nearest.fill(Infinity);
    chosen.push(best);
    for (let v = 0; v < n; ++v) nearest[v] = Math.min(nearest[v], length3(minus3(row3(points, v), at)));
  }
  return chosen;
}
