// A camera that turns round the body; matrices are in columns, as WebGL takes them.
'use strict';

const timesMatrix = (a, b) => Array.from({length: 9}, (_, i) => {
  const row = i % 3, column = 3 * Math.floor(i / 3);
  return a[row] * b[column] + a[row + 3] * b[column + 1] + a[row + 6] * b[column + 2];
});
const aboutX = (t) => [1, 0, 0, 0, Math.cos(t), Math.sin(t), 0, -Math.sin(t), Math.cos(t)];
const aboutY = (t) => [Math.cos(t), 0, -Math.sin(t), 0, 1, 0, Math.sin(t), 0, Math.cos(t)];

/// A box round points.
class Box {
  low = [Infinity, Infinity, Infinity];
  high = [-Infinity, -Infinity, -Infinity];
  /// Points, or balls where radii are given, moved by so many times their vectors.
  hold(points, vectors, times, radii) {
    points.forEach((p, i) => {
      const at = p + (vectors && vectors.length ? times * vectors[i] : 0), radius = radii ? radii[Math.floor(i / 3)] : 0;
      this.low[i % 3] = Math.min(this.low[i % 3], at - radius);
      this.high[i % 3] = Math.max(this.high[i % 3], at + radius);
    });
    return this;
  }
  middle() { return this.high.map((h, i) => (h + this.low[i]) / 2); }
  size() { return Math.hypot(...this.high.map((h, i) => h - this.low[i])) || 1; }
}

const tangent = Math.tan(0.3);  // of half the angle that is seen

class Camera {
  /// Looks at a box from a little above its broader side, z upwards, so that a picture of that aspect (width over
  /// height) holds all of it; from `room` times as far.
  constructor(box, aspect, room = 1) {
    const {low, high} = box;
    this.size = box.size();
    this.middle = box.middle();
    const alongX = high[0] - low[0] >= high[1] - low[1];
    const right = alongX ? [1, 0, 0] : [0, 1, 0], up = [0, 0, 1], front = alongX ? [0, -1, 0] : [1, 0, 0];
    this.home = timesMatrix(aboutX(0.4), timesMatrix(aboutY(-0.5), [0, 1, 2].flatMap((k) => [right[k], up[k], front[k]])));
    const narrow = Math.min(1, aspect) / tangent, fills = 0.93;
    this.enough = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const at = this.middle.map((m, i) => (corner >> i & 1 ? high[i] : low[i]) - m);
      const [x, y, z] = [0, 1, 2].map((row) => at.reduce((sum, v, i) => sum + this.home[3 * i + row] * v, 0));
      this.enough = Math.max(this.enough, z + narrow * Math.max(Math.abs(x) / aspect, Math.abs(y)) / fills);
    }
    this.enough *= room;
    this.reset();
  }
  reset() {
    this.turned = this.home;
    this.target = [...this.middle];
    this.distance = this.enough || 1;
  }
  turn(dx, dy) { this.turned = timesMatrix(aboutX(dy), timesMatrix(aboutY(dx), this.turned)); }
  zoom(factor) { this.distance = Math.min(Math.max(this.distance * factor, 0.05 * this.size), 20 * this.size); }
  /// By shares of the picture's height.
  pan(dx, dy) {
    const R = this.turned, reach = 0.62 * this.distance;
    for (let k = 0; k < 3; ++k) this.target[k] -= reach * (dx * R[3 * k] - dy * R[3 * k + 1]);
  }
  view() {
    const R = this.turned, t = this.target;
    const moved = [0, 1, 2].map((row) => -(R[row] * t[0] + R[row + 3] * t[1] + R[row + 6] * t[2]));
    return [R[0], R[1], R[2], 0, R[3], R[4], R[5], 0, R[6], R[7], R[8], 0, moved[0], moved[1],
      moved[2] - this.distance, 1];
  }
  projection(aspect) {
    const near = 0.01 * this.distance, far = this.distance + 4 * this.size;
    const f = 1 / tangent, narrow = Math.min(1, aspect);  // a narrow picture shows as much across
    return [f * narrow / aspect, 0, 0, 0, 0, f * narrow, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
      2 * far * near / (near - far), 0];
  }
  /// Where a point is in a picture of so many pixels: [x, y, depth].
  project(point, width, height) {
    const times = (m, v) => [0, 1, 2, 3].map((r) => m[r] * v[0] + m[r + 4] * v[1] + m[r + 8] * v[2] + m[r + 12] * v[3]);
    const c = times(this.projection(width / height), times(this.view(), [...point, 1]));
    return [(c[0] / c[3] + 1) * width / 2, (1 - c[1] / c[3]) * height / 2, c[3]];
  }
}
