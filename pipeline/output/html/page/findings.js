// What was found to be missing, drawn in the body: gravity, fibres, a lump, a wall, a soft clamp, swapped markers.
'use strict';

const foundColour = [0.69, 0.23, 0.55], softerColour = [0.95, 0.66, 0.83];
const isSofter = (found) => found.ratio < 1;

/// Glyphs of the findings: {shape, glyph, opacity, text} each. `body`: its middle, its size, and the spheres' places and
/// radii with what of them is held.
function findingGlyphs(findings, body) {
  const {middle, size, spheres, radii, held} = body, glyphs = [];
  const add = (shape, start, end, radius, text, opacity = 1, colour = foundColour) =>
    glyphs.push({shape, glyph: {start, end, radius, colour}, opacity, text});
  /// A dashed line through a place along an axis, from one length to another.
  const dashes = (place, axis, low, high, text) => {
    const count = Math.max(3, Math.round((high - low) / (0.035 * size))), pitch = (high - low) / (count - 0.4);
    for (let i = 0; i < count; ++i) {
      const from = low + i * pitch;
      add('tube', plus3(place, axis, from), plus3(place, axis, from + 0.6 * pitch), 0.005 * size, i === count >> 1 ? text : '');
    }
  };
  /// A spring from a place, away from the body.
  const spring = (from, away, text) => {
    const side = unit3(cross3(away, Math.abs(away[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    let last = from;
    for (let turn = 1; turn <= 7; ++turn) {
      const out = turn === 7 ? 0 : (turn % 2 ? 1 : -1) * 0.02 * size;
      const next = plus3(plus3(from, away, 0.02 * turn * size), side, out);
      add('tube', last, next, 0.004 * size, turn === 4 ? text : '');
      last = next;
    }
  };
  for (const found of findings) {
    const text = found.words;
    if (found.kind === 'arrow' && length3(found.vector) > 0) {
      const down = unit3(found.vector), start = plus3(middle, down, 0.12 * size), end = plus3(start, down, 0.25 * size);
      add('arrow', start, end, 0.012 * size, text);
      // to the arrow's scale; it ends at half the body's size, as a deviation may be as long as it likes
      const scale = 0.25 * size / length3(found.vector), most = 0.5 * size;
      for (const {axis, value, sd} of found.undetermined ?? []) {
        dashes(end, axis, Math.max(scale * (value - sd), -most), Math.min(scale * (value + sd), most), `Not determined along this line. ${text}`);
      }
    } else if (found.kind === 'axis') {
      const n = unit3(found.vector);
      for (const sign of [1, -1]) add('arrow', middle, plus3(middle, n, sign * 0.3 * size), 0.008 * size, text);
    } else if (found.kind === 'ball') {
      const r = found.radius, [x, y, z] = found.center;
      add('ball', [x, y, z - r], [x, y, z + r], r, text, 0.55, isSofter(found) ? softerColour : foundColour);
      if (found.vector) add('arrow', found.center, plus3(found.center, unit3(found.vector), 0.25 * size), 0.012 * size, '');
    } else if (found.kind === 'plane') {
      // a disc below the sphere that comes nearest to the wall
      const n = unit3(found.vector), heights = spheres.map((center) => dot3(n, center) - found.offset);
      const gaps = heights.map((height, i) => Math.abs(height) - radii[i]), nearest = gaps.indexOf(Math.min(...gaps));
      const foot = plus3(spheres[nearest], n, -heights[nearest]);
      add('disc', plus3(foot, n, -0.004 * size), foot, 0.3 * size, text, 0.35);
    } else if (found.kind === 'springs') {
      // out of the spheres that are held, from their surface
      const ends = spheres.map((_, i) => i).filter((i) => held[i]), step = Math.max(1, Math.ceil(ends.length / 6));
      for (let e = 0; e < ends.length; e += step) {
        const center = spheres[ends[e]], away = unit3(minus3(center, middle));
        spring(plus3(center, away, radii[ends[e]]), away, e === 0 ? text : '');
      }
    }
  }
  return glyphs;
}

/// A box round a glyph too: its ends are round, across its axis. An arrow's head is wider than its shaft.
function holdGlyph(box, {shape, glyph: {start, end, radius}}) {
  const n = unit3(minus3(end, start)), wide = shape === 'arrow' ? 2.6 * radius : radius;
  const out = n.map((c) => wide * Math.sqrt(Math.max(0, 1 - c * c)));
  for (const place of [start, end]) box.hold(minus3(place, out)).hold(plus3(place, out));
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
