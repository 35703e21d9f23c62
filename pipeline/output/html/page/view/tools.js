// Tools as they are drawn: balls and punches, meshes where they stand, grips as the patch of the skin that they move.
'use strict';

class Tools {
  /// The run's tools have an `origin` and, of a mesh, its `surface` about it at rest or, of a grip, its `patch`:
  /// triangles of the skin. One that is neither is a ball or a punch, and tells its radius in each state.
  constructor(scene, run, {rest, size}) {
    Object.assign(this, {scene, rest, size, ofName: new Map(run.tools.map((tool) => [tool.name, tool]))});
    for (const tool of run.tools) {
      if (tool.surface) tool.mesh = scene.mesh(tool.surface.triangles);
      if (tool.patch) tool.mesh = scene.mesh(tool.patch);
    }
    for (const one of run.states.flatMap((s) => s.tools)) {
      const tool = this.ofName.get(one.name);
      one.grips = Boolean(tool?.patch?.length);
      if (one.grips) {
        one.moved = one.moved.map((v) => v ?? 0);  // what is left free is not known
        one.at ??= plus3(tool.origin, one.moved);
      }
    }
  }
  isSolid(tool) { return Boolean(tool.at && (tool.radius || (this.ofName.get(tool.name)?.surface && !tool.turned.includes(null)))); }
  isDrawn(tool) { return tool.grips || this.isSolid(tool); }
  /// The corners of a mesh where it stands in a state.
  corners({name, place, turned}) {
    const {surface: {points}, origin} = this.ofName.get(name), result = new Float32Array(points.length);
    for (let p = 0; p < points.length / 3; ++p) result.set(plus3(place, turned3(minus3(point3(points, p), origin), turned)), 3 * p);
    return result;
  }
  /// The centre of what a grip holds, on the body with its vertices at `points`; the mean over the patch's area at rest,
  /// so that it moves as a rigid patch does.
  center(patch, points) {
    let sum = [0, 0, 0], areas = 0;
    for (let t = 0; t < patch.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => point3(this.rest, patch[t + k]));
      const area = length3(cross3(minus3(b, a), minus3(c, a)));
      for (let k = 0; k < 3; ++k) sum = plus3(sum, point3(points, patch[t + k]), area / 3);
      areas += area;
    }
    return times3(sum, 1 / (areas || 1));
  }
  /// How a tool has moved from rest, as an arrow's ends: a grip by the centre of what it holds. `points`: the body's
  /// vertices now.
  motion(tool, points) {
    const {patch, origin} = this.ofName.get(tool.name);
    return tool.grips ? {start: this.center(patch, this.rest), end: this.center(patch, points)} : {start: origin, end: tool.place};
  }
  /// A motion's arrows: none where it is too short to be seen.
  motionArrows({start, end}, colour) {
    const length = length3(minus3(end, start));
    return length > 0.004 * this.size ? [{start, end, radius: Math.min(0.009 * this.size, 0.1 * length), colour}] : [];
  }
  /// The body at rest, but for what grips hold: that is moved with them.
  gripped(tools) {
    const points = Float32Array.from(this.rest);
    for (const {name, place, turned} of tools.filter((t) => t.grips)) {
      const {patch, origin} = this.ofName.get(name);
      for (const v of new Set(patch)) points.set(plus3(place, turned3(minus3(point3(this.rest, v), origin), turned)), 3 * v);
    }
    return points;
  }
  /// How far a tool reaches from its place along a force: to where it presses.
  reach(tool, force) {
    if (tool.radius) return tool.axis ? 0 : tool.radius;
    if (tool.grips || !this.isSolid(tool)) return 0;
    const corners = this.corners(tool), along = unit3(force);
    return largestOf(Array.from({length: corners.length / 3}, (_, c) => dot3(minus3(point3(corners, c), tool.place), along)));
  }
  /// A box round the tools of a state as well. `tools`: as loads.js places them.
  hold(box, tools) {
    for (const tool of tools.filter((t) => this.isSolid(t))) {
      if (!tool.radius) box.hold(this.corners(tool));
      for (const side of [-1, 1]) box.hold(tool.place.map((v) => v + side * (tool.radius ?? 0)));
    }
  }
  /// `skin`: its vertices now. Gives what the pointer can be told of them.
  draw(tools, skin, colour) {
    const {scene, size} = this, drawn = tools.filter((t) => this.isDrawn(t));
    for (const tool of drawn) {
      const {name, place, radius, axis} = tool, {mesh} = this.ofName.get(name) ?? {};
      if (tool.grips) {
        scene.glyphs('arrow', this.motionArrows(this.motion(tool, skin), colour));
        scene.surface(skin, colour, 0.45, mesh);
        scene.wires(skin, colour, mesh);
      } else if (!radius) {
        scene.surface(this.corners(tool), colour, 0.4, mesh);
      } else if (axis) {
        scene.glyphs('disc', [{start: place, end: plus3(place, axis, -0.03 * size), radius, colour}], 0.5);
      } else {
        scene.glyphs('ball', [ballAt(place, radius, colour)], 0.5);
      }
    }
    return drawn.map((t) => ({at: t.place, text: t.grips ? `${t.name}, moved by ${short(length3(t.moved))} mm` : t.name}));
  }
  /// What the key says of them.
  words() {
    const all = [...this.ofName.values()], many = all.filter((t) => t.triangles_left_out);
    return `tool${all.some((t) => t.patch?.length) ? '; where one grips, what it holds, and an arrow of its motion' : ''}${
      many.length ? `; not drawn, for its many triangles: ${many.map((t) => t.name).join(', ')}` : ''}`;
  }
}
