// A state of a run, drawn: the body as a step has it, its spheres and links, markers and their errors, forces, tools, and
// what was found.
'use strict';

class Drawing {
  /// `body`: {rest, middle, size}. `isOn` says whether a thing is to be shown.
  constructor(scene, run, body, loads, tools, isOn) {
    Object.assign(this, {scene, run, ...body, loads, tools, isOn});
    // What was found is drawn in every step: faintly where the step does not have it yet.
    const spheres = Array.from(run.spheres.radii, (_, i) => point3(run.spheres.centers, i));
    this.found = run.steps[run.steps.length - 1].findings.flatMap((finding) =>
      findingGlyphs([finding], {middle: this.middle, size: this.size, spheres, radii: run.spheres.radii, held: run.spheres.held})
        .map((one) => ({...one, effect: finding.effect})));
  }
  /// Does a step have an effect in it?
  has(step, effect) { return this.run.steps[step].findings.some((f) => f.effect === effect); }
  /// Has anything that was found a place in the picture of this state?
  drawsFindings(now) { return this.found.length > 0 || this.exchangedIn(now).length > 0; }
  exchangedIn(now) { return this.run.exchanged.filter((one) => one.probe === now.probe && Math.abs(one.time - now.time) < 1e-9); }
  /// The box of the body at rest and, magnified so, of all that the last step does.
  box(magnify) {
    const {run, rest, loads} = this, {centers, radii} = run.spheres;
    const box = new Box().hold(rest.length ? rest : centers).hold(centers, null, 0, radii);
    run.steps[run.steps.length - 1].states.forEach((answer, i) => {
      const now = run.states[i], tools = loads.tools(now, answer.skin, magnify);
      this.tools.hold(box, tools);
      for (const {start, end} of loads.arrows(now, tools, answer.skin, magnify)) box.hold(start).hold(end);
      if (now.measured) box.hold(rest, now.measured, magnify);
      box.hold(rest, answer.skin, magnify).hold(centers, answer.spheres, magnify, radii);
    });
    for (const one of this.found) holdGlyph(box, one);
    return box;
  }
  /// `seen`: {step, now, answer, values, stiffness, scale, quantity, skin, spheres, error}: the run's state and the step's
  /// answer to it; numbers of the state, or of the links, on a scale; displacements and errors on the way from what was
  /// shown before. `look`: {colour, magnify, lengthen, opacity}. Gives what the pointer can be told: [{at, text, marker}].
  draw(seen, look) {
    const {scene, rest, isOn} = this, {now} = seen, {colour, magnify} = look;
    const added = (points, vectors) => points.map((p, i) => p + magnify * (vectors[i] || 0));
    const spheres = added(this.run.spheres.centers, seen.spheres), skin = added(rest, seen.skin);
    this.told = [];
    if (isOn('links')) this.drawLinks(seen, spheres);
    this.drawMarkers(seen, look);
    const tools = this.loads.tools(now, seen.skin, magnify);
    if (isOn('loads')) {
      scene.glyphs('arrow', this.loads.arrows(now, tools, seen.skin, magnify).map((arrow) => ({...arrow, radius: 0.009 * this.size, colour: colour.load})));
    }
    if (isOn('measured') && now.measured) scene.wires(added(rest, now.measured), colour.shape);
    if (isOn('spheres')) this.drawSpheres(seen, spheres, colour.held);
    if (isOn('findings')) this.drawFindings(seen, magnify);
    const colours = new Float32Array(rest.length);
    for (let v = 0; v < rest.length / 3; ++v) colours.set(seen.values ? seen.scale.colour(seen.values.skin[v]) : unknownColour, 3 * v);
    scene.surface(skin, colours, look.opacity);
    if (isOn('tools')) this.told.push(...this.tools.draw(tools, skin, colour.tool));
    return this.told;
  }
  drawLinks({stiffness, values, scale, quantity}, spheres) {
    const {links} = this.run;
    this.scene.glyphs('tube', Array.from({length: links.length / 2}, (_, l) => {
      const [a, b] = [links[2 * l], links[2 * l + 1]], start = point3(spheres, a), end = point3(spheres, b);
      if (stiffness) this.told.push({at: times3(plus3(start, end), 0.5), text: `link ${l}: ${quantity.name} ${short(stiffness[l])} ${quantity.unit}`});
      return {start, end, radius: 0.005 * this.size, colour: scale.colour(stiffness ? stiffness[l] : values.spheres[a]),
        colourEnd: scale.colour(stiffness ? stiffness[l] : values.spheres[b])};
    }));
  }
  drawSpheres({values, scale}, spheres, heldColour) {
    const {radii, held} = this.run.spheres, all = Array.from(radii, (_, i) => i);
    for (const isHeld of [false, true]) {
      this.scene.glyphs('ball', all.filter((i) => Boolean(held[i]) === isHeld).map((i) => ballAt(point3(spheres, i), radii[i],
        isHeld ? heldColour : values ? scale.colour(values.spheres[i]) : unknownColour)), isHeld ? 0.65 : 0.22);
    }
  }
  /// Markers of the model, as they were measured, and arrows from the ones to the others.
  drawMarkers({answer, values, scale, error}, {colour, magnify, lengthen}) {
    const {scene, size, isOn} = this, {markers} = answer, dot = 0.0105 * size;
    const measured = (i) => plus3(point3(markers.rest, i), point3(markers.measured, i), magnify);
    const modelled = (i) => plus3(measured(i), point3(markers.error, i), -magnify);
    if (isOn('markers')) {
      scene.glyphs('ball', markers.id.map((id, i) => {
        this.told.push({at: modelled(i), marker: id, text: `marker ${id}: ${answer.lengths[i].toPrecision(3)} mm off`});
        return ballAt(modelled(i), 0.009 * size, values ? scale.colour(values.markers[i]) : unknownColour);
      }));
    }
    if (isOn('errors')) {
      const times = (magnify || 1) * lengthen, arrows = [];
      markers.id.forEach((_, i) => {
        const whole = times * norm3(error, i), length = whole > 2 * dot && isOn('positions') ? whole - dot : whole;  // up to the dot
        if (length <= 0.004 * size) return;
        const start = modelled(i), end = plus3(start, point3(error, i), length / whole * times);
        arrows.push({start, end, radius: Math.min(0.004 * size, 0.06 * length), colour: colour.error});
      });
      scene.glyphs('arrow', arrows);
    }
    if (isOn('positions')) {
      scene.glyphs('ball', markers.id.map((id, i) => {
        this.told.push({at: measured(i), marker: id, text: `marker ${id}, as measured`});
        return ballAt(measured(i), dot, colour.measured);
      }));
    }
  }
  /// What was found to be missing, and markers of this state that look swapped.
  drawFindings({step, now, answer: {markers}}, magnify) {
    for (const {shape, glyph, opacity, text, effect} of this.found) {
      this.scene.glyphs(shape, [glyph], (this.has(step, effect) ? 1 : 0.45) * opacity);
      if (text) this.told.push({at: times3(plus3(glyph.start, glyph.end), 0.5), text});
    }
    for (const pair of this.exchangedIn(now)) {
      const places = pair.markers.map((id) => markers.id.indexOf(id)).filter((i) => i >= 0)
        .map((i) => plus3(point3(markers.rest, i), point3(markers.measured, i), magnify));
      if (places.length < 2) continue;
      const [start, end] = places;
      this.scene.glyphs('tube', [{start, end, radius: 0.004 * this.size, colour: foundColour}]);
      this.told.push({at: times3(plus3(start, end), 0.5), text: `markers ${pair.markers.join(' and ')} look swapped`});
    }
  }
}
