// Vectors of three numbers, and matrices.
'use strict';

const plus3 = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const minus3 = (a, b) => plus3(a, b, -1);
const times3 = (a, factor) => a.map((v) => factor * v);
const dot3 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross3 = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length3 = (a) => Math.hypot(...a);
const unit3 = (a) => times3(a, 1 / (length3(a) || 1));
const row3 = (a, i) => [a[3 * i], a[3 * i + 1], a[3 * i + 2]];

/// n . C n for a 3 x 3 matrix.
const along3 = (C, n) => dot3(n, [0, 1, 2].map((r) => dot3([C[r], C[r + 3], C[r + 6]], n)));

/// A vector turned by a rotation vector [rad], by Rodrigues' formula.
function turned3(v, rotation) {
  const angle = length3(rotation), n = unit3(rotation);
  return plus3(plus3(times3(v, Math.cos(angle)), cross3(n, v), Math.sin(angle)), n, (1 - Math.cos(angle)) * dot3(n, v));
}
