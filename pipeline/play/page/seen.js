// What is seen of the model in the hand.
'use strict';

class SeenPlayer extends Player {
  draw() {
    const canvas = this.at('canvas'), box = canvas.getBoundingClientRect(), dots = Math.min(devicePixelRatio || 1, 2);
    if (box.width === 0) return;
    const {scene, camera, size} = this, skin = this.numerics.skin().slice();
    this.skin = skin;
    scene.begin(camera, Math.round(box.width * dots), Math.round(box.height * dots));

    const errors = this.markerErrors();
    const byError = this.at('colour').value === 'error' && errors;
    const values = byError ? this.skinErrors.at(errors.lengths) : distances(skin, this.rest);
    let furthest = 0;
    for (const value of values) if (value > furthest) furthest = value;
    // Errors keep their scale, that they may be seen to fall; displacements theirs for as long as it does.
    const least = byError ? 1e-3 * size : 0.02 * size;
    if (furthest > this.high || !(this.high > 0) || (!byError && furthest < 0.3 * this.high)) this.high = roundUp(Math.max(furthest, least));
    const {high} = this;
    coloured(values, high, this.colours);

    const contacts = this.touches.map((t) => this.numerics.at(t));
    if (this.ball) {
      const force = this.numerics.ballForce();
      contacts.push({force, place: plus3(this.ball.at, unit3(force), this.ball.radius)});
      scene.glyphs('ball', [ballAt(this.ball.at, this.ball.radius, loadColour)], 0.6);
    }
    this.strongest = Math.max(this.strongest, ...contacts.map((c) => length3(c.force)));
    scene.glyphs('arrow', forceArrows(contacts, this.strongest, camera));
    if (this.hand && !this.hand.ball) {
      const {place} = this.numerics.at(this.hand.touch);
      scene.glyphs('ball', [ballAt(place, 0.012 * size, loadColour)]);
      if (this.hand.target && length3(minus3(this.hand.target, place)) > 1e-9) {
        scene.glyphs('tube', [{start: place, end: this.hand.target, radius: 0.002 * size, colour: measuredColour}]);
      }
    } else if (this.chosen.point >= 0) {
      scene.glyphs('ball', [ballAt(row3(skin, this.points[this.chosen.point]), 0.012 * size, loadColour)]);
    }
    if (errors && this.at('show-markers').checked) this.drawMarkers(errors);
    if (this.at('show-findings').checked) this.drawFindings();
    const skeleton = this.at('show-skeleton').checked;
    if (skeleton) this.drawSkeleton();
    const within = skeleton || errors || (this.at('show-findings').checked && this.findings.length > 0);
    if (this.at('show-skin').checked) scene.surface(skin, this.colours, within ? 0.5 : 1);
    this.at('high').textContent = inUnit(high, 'mm');
    this.at('what').textContent = byError ? 'error of this probe, spread between markers' : 'displacement from rest';
  }
  drawMarkers(errors) {
    const {scene, size} = this, measured = [], modelled = [], gaps = [];
    errors.rows.forEach(({marker, read, model}) => {
      measured.push(ballAt(read, 0.008 * size, measuredColour));
      modelled.push(ballAt(model, 0.006 * size, [0.92, 0.92, 0.95]));
      if (length3(minus3(read, model)) > 1e-3 * size)
        gaps.push({start: model, end: read, radius: 0.002 * size, colour: measuredColour});
    });
    scene.glyphs('ball', measured);
    scene.glyphs('ball', modelled);
    scene.glyphs('tube', gaps);
  }
  /// What the model's effects are, where they can be drawn, and the force or change that no effect is named for.
  get findings() {
    const off = (name) => this.model.effects.some((e) => e.name === name && !this.isOn(e));
    return this.model.findings.filter((f) => f.kind !== 'words' && !off(f.effect));
  }
  /// Gravity, fibres and lumps go with the sphere nearest to them; walls and clamps stay.
  drawFindings() {
    const {spheres} = this.model.text, at = Float32Array.from(spheres.flatMap((s) => s.center));
    const body = {middle: this.middle, size: this.size, spheres: spheres.map((s) => s.center),
      radii: spheres.map((s) => s.radius), held: spheres.map((s) => s.held)};
    for (const found of this.findings) {
      const moves = this.centres && !['plane', 'springs'].includes(found.kind);
      const near = moves ? nearestVertex(at, found.center ?? body.middle) : -1;
      const by = moves ? minus3(row3(this.centres, near), row3(at, near)) : [0, 0, 0];
      for (const {shape, glyph, opacity} of findingGlyphs([found], body))
        this.scene.glyphs(shape, [{...glyph, start: plus3(glyph.start, by), end: plus3(glyph.end, by)}], opacity);
    }
    // Markers that look swapped in the probe that is replayed.
    const {state} = this, here = (pair) => pair.probe === state?.probe && pair.time === state?.time;
    for (const {markers} of this.data.exchanged.filter(here)) {
      const [start, end] = markers.map((m) => state.readings.find(([marker]) => marker === m)?.slice(1));
      if (start && end) this.scene.glyphs('tube', [{start, end, radius: 0.004 * this.size, colour: foundColour}]);
    }
  }
  drawSkeleton() {
    const {scene, size, centres} = this, text = this.model.text;
    if (!centres) return;
    scene.glyphs('tube', text.links.map((l) => ({start: row3(centres, l.a), end: row3(centres, l.b), radius: 0.005 * size,
      colour: wireColour})));
    scene.glyphs('ball', text.spheres.map((s, i) => ballAt(row3(centres, i), s.radius, s.held ? loadColour : wireColour)), 0.3);
  }

  /// Of the probe that is chosen: where markers were read and where the model has them now; null without one.
  markerErrors() {
    const state = this.state;
    if (!state || state.readings.length === 0) return null;
    const markers = this.data.sets[this.set].markers, now = this.numerics.markers(this.set, markers.length);
    const errors = {rows: [], lengths: new Float32Array(markers.length).fill(NaN), squares: 0, coordinates: 0};
    for (const [marker, ...position] of state.readings) {
      const model = row3(now, marker), read = position.map((x, c) => x ?? model[c]);
      const squares = length3(minus3(read, model)) ** 2;
      errors.rows.push({marker, read, model});
      errors.lengths[marker] = Math.sqrt(squares);
      errors.squares += squares;
      errors.coordinates += position.filter((x) => x !== null).length;
    }
    errors.rms = Math.sqrt(errors.squares / errors.coordinates);
    return errors;
  }
}
