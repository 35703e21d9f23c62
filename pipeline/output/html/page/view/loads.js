// Forces and tools of a run's states: where they are in the picture of the body.
'use strict';

class Loads {
  /// `body`: {rest, middle, size}; `ofTools`: the run's Tools. Of the states' loads and tools it keeps whether they push.
  constructor(run, body, ofTools) {
    Object.assign(this, {run, ofTools, ...body});
    const tools = run.states.flatMap((s) => s.tools);
    this.felt = tools.filter((t) => t.measured);
    this.hasForces = run.states.some((s) => s.loads.length);
    this.strongest = largestOf([...run.states.flatMap((s) => s.loads.map((l) => length3(l.slice(3)))), ...this.felt.map(measuredForce)]) || 1;
    for (const state of run.states) {
      state.loads = state.loads.map(([x, y, z, ...force]) => {
        const place = [x, y, z], vertex = this.vertexAt(place);
        return {place, force, vertex, pushes: this.pushes(force, place, vertex)};
      });
    }
    for (const tool of tools) {
      tool.force = tool.measured?.map((f) => f ?? 0);
      // a grip's force begins where its motion ends
      tool.pushes = tool.at && tool.force && !tool.grips && this.pushes(tool.force, tool.at, this.vertexAt(tool.at));
    }
  }
  vertexAt(place) { return this.rest.length ? nearestVertex(this.rest, place) : -1; }
  /// Does a force push the body there, rather than pull at it? By the body at rest: the answer stays, however it bends.
  pushes(force, place, vertex) {
    const outward = vertex >= 0 ? outwardAt(this.rest, this.run.surface.triangles, vertex) : minus3(place, this.middle);
    return dot3(force, outward) < 0;
  }
  /// A force's arrow: it ends at the body where it pushes, and begins there where it pulls.
  arrow(tip, {force, pushes}) {
    const other = plus3(tip, unit3(force), (pushes ? -1 : 1) * 0.22 * this.size * length3(force) / this.strongest);
    return {start: pushes ? other : tip, end: pushes ? tip : other};
  }
  /// Of a load, which sits on the body as it is bent: it moves with the skin's vertex nearest to it.
  loadArrow(load, skin, magnify) {
    const moved = skin && skin.length && load.vertex >= 0 ? point3(skin, load.vertex) : [0, 0, 0];
    return this.arrow(plus3(load.place, moved, magnify ?? 0), load);
  }
  /// Of a tool's force: it ends where the tool presses.
  toolArrow(tool) { return this.arrow(plus3(tool.place, unit3(tool.force), this.ofTools.reach(tool, tool.force)), tool); }
  /// The tools of a state that are somewhere, with their `place`: as far as displacements are magnified, a grip moves by
  /// so much more, and any other one goes with the skin that it touches.
  tools(state, skin, magnify) {
    const place = (tool) => {
      if (tool.grips) return plus3(tool.at, tool.moved, magnify - 1);
      if (magnify === 1 || !this.rest.length) return tool.at;
      return plus3(tool.at, point3(skin, nearestVertex(this.rest.map((p, i) => p + skin[i]), tool.at)), magnify - 1);
    };
    return state.tools.filter((t) => t.at).map((tool) => ({...tool, place: place(tool)}));
  }
  /// Arrows of all forces in a state, those of tools as they were measured. `tools`: as above.
  arrows(state, tools, skin, magnify) {
    return [...state.loads.map((load) => this.loadArrow(load, skin, magnify)), ...tools.filter((t) => t.force).map((t) => this.toolArrow(t))];
  }
}
