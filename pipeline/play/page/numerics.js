// The runtime, compiled to WebAssembly: what it takes and gives as JavaScript's own numbers and texts.
'use strict';

/// Bytes behind a block of the page in gzip and base64.
async function unpacked(id) {
  const base64 = document.getElementById(id).textContent;
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

class Numerics {
  static async start(wasmBinary) { return new Numerics(await palpateModule({wasmBinary})); }
  constructor(wasm) { this.wasm = wasm; }

  message() { return this.wasm.UTF8ToString(this.wasm._play_message()); }
  /// A number that a call gives; throws where it failed.
  told(number) {
    if (number < 0) throw new Error(this.message());
    return number;
  }
  /// So many doubles that a call hands out; throws where it failed. A copy: they hold until the next call.
  doubles(pointer, count) {
    if (!pointer) throw new Error(this.message());
    return this.wasm.HEAPF64.slice(pointer / 8, pointer / 8 + count);
  }
  /// A call with a text, given in memory of the module.
  withText(text, call) {
    const size = this.wasm.lengthBytesUTF8(text) + 1, pointer = this.wasm._malloc(size);
    this.wasm.stringToUTF8(text, pointer, size);
    try { return this.told(call(pointer)); } finally { this.wasm._free(pointer); }
  }

  readModel(json) { return this.withText(JSON.stringify(json), this.wasm._play_read_model); }
  readSet(json) { return this.withText(JSON.stringify(json), this.wasm._play_read_set); }
  start(model, effects, gravity, pressure, anew) {
    this.told(this.wasm._play_start(model, effects, ...gravity, pressure, anew ? 1 : 0));
    this.spheres = this.wasm._play_spheres();
    this.vertices = this.wasm._play_vertices();
  }
  triangles() {
    const at = this.wasm._play_triangle_corners() / 4;
    return this.wasm.HEAP32.slice(at, at + 3 * this.wasm._play_triangles());
  }
  /// As the skin stands; holds until the next call.
  skin() {
    const at = this.wasm._play_skin() / 4;
    return this.wasm.HEAPF32.subarray(at, at + 3 * this.vertices);
  }
  shape() { return this.doubles(this.wasm._play_shape(), 3 * this.vertices); }
  centres() { return this.doubles(this.wasm._play_centres(), 3 * this.spheres); }

  advance(h) { this.told(this.wasm._play_advance(h)); }
  equilibrium() { return this.told(this.wasm._play_equilibrium()); }
  reset() { this.wasm._play_reset(); }

  touch(rest, radius) { return this.told(this.wasm._play_touch(...rest, radius)); }
  release(touch) { this.told(this.wasm._play_release(touch)); }
  push(touch, force) { this.told(this.wasm._play_push(touch, ...force)); }
  bear(touch, force) { this.told(this.wasm._play_bear(touch, ...force)); }
  drag(touch, to, stiffness) { this.told(this.wasm._play_drag(touch, ...to, stiffness)); }
  at(touch) {
    const n = this.doubles(this.wasm._play_at(touch), 13);
    return {force: [...n.slice(0, 3)], place: [...n.slice(3, 6)], rest: [...n.slice(6, 9)], radius: n[9], borne: [...n.slice(10)]};
  }
  placeBall(radius, at) { this.told(this.wasm._play_place_ball(radius, ...at)); }
  liftBall() { this.wasm._play_lift_ball(); }
  ballForce() { return [...this.doubles(this.wasm._play_ball_force(), 3)]; }
  /// d place / d force (3 x 3, symmetric) [mm/N], or null where the body is not stable as it stands.
  compliance(touch) {
    const pointer = this.wasm._play_compliance(touch);
    return pointer ? this.doubles(pointer, 9) : null;
  }

  addActuator(actuator) { return this.withText(JSON.stringify(actuator), this.wasm._play_add_actuator); }
  drive(actuator, value) { this.told(this.wasm._play_drive(actuator, value)); }
  tension(tendon) { return this.doubles(this.wasm._play_tension(tendon), 1)[0]; }

  judge(model, effects, set) { return this.told(this.wasm._play_judge(model, effects, set)); }
  judgeState(r) {
    const [squares, coordinates, whole, state] = this.doubles(this.wasm._play_judge_state(r), 4);
    return {squares, coordinates, whole: whole === 1, state};
  }
  markers(set, count) { return this.doubles(this.wasm._play_markers(set), 3 * count); }
}

/// A number with three digits and its unit.
function inUnit(value, unit) {
  if (!Number.isFinite(value)) return '–';
  if (value !== 0 && Math.abs(value) < 5e-4) return `${value.toExponential(1)} ${unit}`;
  return `${+value.toPrecision(3)} ${unit}`;
}
