// What was found to be missing, drawn in the body: gravity, fibres, a lump, a wall, a soft clamp, swapped markers.
'use strict';

const foundColour = [0.69, 0.23, 0.55];

/// Glyphs of the findings: {shape, glyph, opacity, text} each. `body`: its middle, its size, and the spheres' places with
/// what of them is held.
function findingGlyphs(findings, body) {
  const {middle, size, spheres, held} = body, glyphs = [];
  const along = (from, direction, length) => from.map((v, i) => v + length * direction[i]);
  const unit = (v) => v.map((c) => c / (Math.hypot(...v) || 1));
  const add = (shape, start, end, radius, text, opacity = 1) =>
    glyphs.push({shape, glyph: {start, end, radius, colour: foundColour}, opacity, text});
  for (const found of findings) {
    const text = found.words;
    if (found.kind === 'arrow' && Math.hypot(...found.vector) > 0) {
      const down = unit(found.vector), start = along(middle, down, 0.12 * size);
      add('arrow', start, along(start, down, 0.25 * size), 0.012 * size, text);
    } else if (found.kind === 'axis') {
      const n = unit(found.vector);
      for (const sign of [1, -1]) add('arrow', middle, along(middle, n, sign * 0.3 * size), 0.008 * size, text);
    } else if (found.kind === 'ball') {
      const r = found.radius, [x, y, z] = found.center;
      add('ball', [x, y, z - r], [x, y, z + r], r, text, 0.55);
      if (found.vector) add('arrow', found.center, along(found.center, unit(found.vector), 0.25 * size), 0.012 * size, '');
    } else if (found.kind === 'plane') {
      const n = unit(found.vector), height = n.reduce((sum, c, i) => sum + c * middle[i], 0) - found.offset;
      const foot = along(middle, n, -height);
      add('tube', along(foot, n, -0.004 * size), foot, 0.35 * size, text, 0.35);
    } else if (found.kind === 'springs') {
      const places = spheres.filter((_, i) => held[i]);
      const step = Math.max(1, Math.ceil(places.length / 6));
      for (let i = 0; i < places.length; i += step) zigzag(places[i], i === 0 ? text : '');
    }
  }
  /// A spring from a place that is held, away from the body.
  function zigzag(from, text) {
    const away = unit(from.map((v, i) => v - middle[i])), axis = Math.abs(away[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
    const side = unit([away[1] * axis[2] - away[2] * axis[1], away[2] * axis[0] - away[0] * axis[2],
      away[0] * axis[1] - away[1] * axis[0]]);
    let last = from;
    for (let turn = 1; turn <= 7; ++turn) {
      const out = turn === 7 ? 0 : (turn % 2 ? 1 : -1) * 0.02 * size;
      const next = along(along(from, away, 0.02 * turn * size), side, out);
      add('tube', last, next, 0.004 * size, turn === 4 ? text : '');
      last = next;
    }
  }
  return glyphs;
}

/// The vertex of a surface that lies nearest to a place.
function nearestVertex(points, place) {
  let best = 0, least = Infinity;
  for (let v = 0; v < points.length / 3; ++v) {
    const d = (points[3 * v] - place[0]) ** 2 + (points[3 * v + 1] - place[1]) ** 2 + (points[3 * v + 2] - place[2]) ** 2;
    if (d < least) { least = d; best = v; }
  }
  return best;
}
