// Choosing on the body by mouse, finger and keys, and what the view shows of it.
'use strict';

const heldColour = [0.2, 0.55, 0.45], bodyColour = [0.72, 0.75, 0.78], thereColour = [0.55, 0.59, 0.63], markerColour = [0.1, 0.1, 0.12];

class Picker {
  constructor(data) {
    this.data = data;
    this.at = (id) => document.getElementById(id);
    this.points = decoded(data.surface.points);
    this.triangles = decoded(data.surface.triangles);
    this.setup = new Setup(data, this.points, this.triangles);
    this.size = this.setup.size;
    this.camera = new Camera(new Box().hold(this.points), 1.3, 1.25);
    this.choices = spreadVertices(this.points, this.camera.middle, 60);  // what keys can choose
    this.chosen = -1;
    this.scene = new Scene(this.at('canvas'), this.triangles);
    this.colours = new Float32Array(this.points.length);
    this.listen();
    this.changed();
  }
  get mode() { return new FormData(this.at('controls')).get('mode'); }

  listen() {
    const {at} = this, canvas = at('canvas'), rounded = (v) => +v.toPrecision(2);
    at('name').textContent = `Set up ${this.data.name}`;
    at('key-set').hidden = !this.setup.addsToSet;
    const sides = this.setup.high.map((h, c) => h - this.setup.low[c]);
    at('axis').value = sides.indexOf(Math.max(...sides));
    at('ball-radius').value = rounded(0.1 * this.size);
    at('probe-radius').value = rounded(0.04 * this.size);
    // A third of the pressure that probes of a simulation keep below, so that levels have room.
    at('force').value = rounded(0.1 * this.data.young * Math.PI * (+at('probe-radius').value) ** 2);
    const along = [['into the body', 'in'], ['out of the body', 'out'],
      ...['x', 'y', 'z'].flatMap((axis, c) => [1, -1].map((sign) => [`${sign > 0 ? '+' : '−'}${axis}`, `${c},${sign}`]))];
    at('direction').replaceChildren(...along.map(([text, value]) => new Option(text, value)));
    at('file').replaceChildren(...this.setup.files().map((f, i) => new Option(f.name, i)));
    at('notes').replaceChildren(...this.data.notes.map((note) => Object.assign(document.createElement('li'), {textContent: note})));
    at('controls').addEventListener('submit', (e) => e.preventDefault());
    at('modes').addEventListener('change', () => this.showMode());
    at('file').addEventListener('change', () => this.showFile());
    const buttons = {undo: () => this.setup.undo(), spread: () => this.setup.spreadMarkers(Math.min(500, Math.max(1, Math.round(+at('count').value) || 1)))};
    for (const [id, does] of Object.entries(buttons)) at(id).addEventListener('click', () => { does(); this.changed(); });
    at('copy').addEventListener('click', () => this.copy());
    at('save').addEventListener('click', () => this.save(this.setup.files()[+at('file').value]));
    at('save-all').addEventListener('click', () => this.setup.files().forEach((file) => this.save(file)));
    steer(canvas, this.camera, {
      draw: () => this.draw(), move: () => {}, play: () => {},
      hint: (x, y) => canvas.classList.toggle('over', this.mode !== 'turn' && this.under(x, y) !== null),
      grab: (x, y) => this.grab(x, y), pull: (x, y) => this.stretch(x, y), letGo: () => { this.stretched = null; },
      key: (e) => this.key(e)});
    new ResizeObserver(() => this.draw()).observe(canvas);
    this.showMode();
  }
  showMode() {
    const {mode} = this;
    const how = {ball: 'All material inside a ball is held; go on dragging to set its radius.',
      end: 'All material from there to the nearer end along that axis is held.', probe: 'A force at that point: a probe for each level.',
      marker: 'A point whose position you measure.', turn: 'The whole view turns the body.'};
    this.at('how').textContent = how[mode];
    for (const part of document.querySelectorAll('[data-for]')) part.hidden = part.dataset.for !== mode;
    this.draw();
  }

  under(x, y) {
    const canvas = this.at('canvas'), ray = rayAt(this.camera, x, y, canvas.clientWidth, canvas.clientHeight);
    const hit = meet(ray, this.points, this.triangles);
    return hit && {...hit, ray};
  }
  grab(x, y) {
    if (this.mode === 'turn') return false;
    const hit = this.under(x, y);
    if (!hit) return false;
    const corners = [0, 1, 2].map((c) => row3(this.points, this.triangles[3 * hit.triangle + c]));
    const normal = unit3(cross3(minus3(corners[1], corners[0]), minus3(corners[2], corners[0])));
    this.place(pointIn(this.points, this.triangles, hit), normal);
    if (this.mode === 'ball') this.stretched = {t: hit.t, x, y, ball: this.setup.supports.at(-1).sphere};
    return true;
  }
  /// The ball that was just placed reaches to the pointer, once that has left the place of the click.
  stretch(x, y) {
    const held = this.stretched, click = 6;  // pixels
    if (!held || Math.hypot(x - held.x, y - held.y) < click) return;
    const canvas = this.at('canvas'), ray = rayAt(this.camera, x, y, canvas.clientWidth, canvas.clientHeight);
    held.ball.radius = +length3(minus3(plus3(ray.from, ray.along, held.t), held.ball.center)).toPrecision(3);
    this.changed();
  }
  place(point, normal) {
    const {setup, at} = this, where = point.map((v) => +v.toPrecision(6)), number = (id) => Math.max(0, +at(id).value || 0);
    if (this.mode === 'ball') setup.addBall(where, number('ball-radius'));
    if (this.mode === 'end') setup.addEnd(where, +at('axis').value);
    if (this.mode === 'marker') setup.addMarker(where);
    if (this.mode === 'probe') {
      const to = at('direction').value, [axis, sign] = to.split(',').map(Number);
      const unit = to === 'in' ? times3(normal, -1) : to === 'out' ? normal : [0, 1, 2].map((c) => c === axis ? sign : 0);
      const levels = Math.min(9, Math.max(1, Math.round(number('levels'))));
      for (let l = 1; l <= levels; ++l) setup.addProbe(where, times3(unit, number('force') * l / levels).map((v) => +v.toPrecision(4)), number('probe-radius'));
    }
    this.changed();
    const [x, y, z] = where.map((v) => +v.toPrecision(3));
    at('spoken').textContent = `Placed at ${x}, ${y}, ${z} millimetres.`;
  }
  key(e) {
    const next = {n: 1, N: 1, p: -1, P: -1}[e.key], count = this.choices.length;
    if (next) {
      this.chosen = (Math.max(this.chosen, next > 0 ? -1 : 0) + next + count) % count;
      const [x, y, z] = row3(this.points, this.choices[this.chosen]).map((v) => +v.toPrecision(3));
      this.at('spoken').textContent = `Point ${this.chosen + 1} of ${count}, at ${x}, ${y}, ${z}; Enter places there.`;
      this.draw();
    } else if (e.key === 'Enter' && this.mode !== 'turn') {
      if (this.chosen < 0) this.chosen = 0;
      const vertex = this.choices[this.chosen];
      this.place(row3(this.points, vertex), normalAt(this.points, this.triangles, vertex));
    } else {
      return false;
    }
    return true;
  }

  /// A row of a list: what it is, its numbers, and a button that takes it away. `groups`: [name, numbers] each, where
  /// numbers are {name, get, set}.
  row(list, i, title, groups) {
    const item = document.createElement('li'), head = document.createElement('b'), away = document.createElement('button');
    head.textContent = title;
    away.type = 'button';
    away.textContent = 'Remove';
    away.setAttribute('aria-label', `Remove ${title}`);
    away.addEventListener('click', () => { this.setup.remove(list, i); this.changed(); });
    head.append(away);
    item.append(head);
    for (const [group, numbers] of groups) {
      item.append(Object.assign(document.createElement('span'), {textContent: group}), ...numbers.map(({name, get, set}) => {
        const input = Object.assign(document.createElement('input'), {type: 'number', step: 'any', value: +get().toPrecision(4)});
        input.setAttribute('aria-label', `${title}: ${name}`);
        input.addEventListener('change', () => { if (Number.isFinite(input.valueAsNumber)) set(input.valueAsNumber); this.changed(); });
        return input;
      }));
    }
    return item;
  }
  showLists() {
    const vector = (v, what) => [what, ['x', 'y', 'z'].map((axis, c) => ({name: `${what} ${axis}`, get: () => v[c], set: (n) => { v[c] = n; }}))];
    const field = (o, key, what) => [what, [{name: what, get: () => o[key], set: (n) => { o[key] = Math.max(0, n); }}]];
    const {setup, at} = this;
    at('supports').replaceChildren(...setup.supports.map((s, i) => {
      if (s.sphere) return this.row('supports', i, `Ball ${i + 1}`, [vector(s.sphere.center, 'centre'), field(s.sphere, 'radius', 'radius')]);
      if (s.box) return this.row('supports', i, `Box ${i + 1}`, [vector(s.box.min, 'from'), vector(s.box.max, 'to')]);
      if (s.plane) return this.row('supports', i, `Plane ${i + 1}`, [vector(s.plane.point, 'point'), vector(s.plane.normal, 'normal'), field(s.plane, 'within', 'within')]);
      return this.row('supports', i, `Points ${i + 1}`, []);
    }));
    at('probes').replaceChildren(...setup.probes.map((p, i) =>
      this.row('probes', i, `Probe ${setup.numberOf(i)}`, [vector(p.at, 'at'), vector(p.force, 'force'), field(p, 'radius', 'radius')])));
    at('markers').replaceChildren(...setup.markers.map((m, i) => this.row('markers', i, m.name, [vector(m.at, 'at')])));
    const beside = setup.supports.some((s) => s.line) ? ', beside what points hold' : '';
    at('held').textContent = setup.supports.length ? `${+(100 * setup.heldShare()).toPrecision(2)} % of the surface is held${beside}.` : '';
    at('warnings').replaceChildren(...setup.warnings().map((text) => Object.assign(document.createElement('li'), {textContent: text})));
  }
  showFile() {
    const {name, content, what} = this.setup.files()[+this.at('file').value];
    this.at('what').textContent = what;
    this.at('text').value = typeof content === 'string' ? content : `${name}: ${this.triangles.length / 3} triangles, ${content.byteLength} bytes.`;
    this.at('copy').disabled = typeof content !== 'string';
  }
  async copy() {
    const {name, content} = this.setup.files()[+this.at('file').value];
    let done = true;
    try { await navigator.clipboard.writeText(content); } catch { done = false; }
    if (!done) this.at('text').select();
    this.at('copied').textContent = done ? `${name} is on the clipboard.` : 'The browser does not let a page copy; the text is selected.';
  }
  save({name, content}) {
    const link = Object.assign(document.createElement('a'), {download: name, href: URL.createObjectURL(new Blob([content]))});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    this.at('copied').textContent = `${name} was handed to the browser's downloads.`;
  }

  changed() {
    this.showLists();
    this.showFile();
    const held = new Set(this.data.surface.held);
    for (let v = 0; v < this.points.length / 3; ++v)
      this.colours.set(this.setup.holds(row3(this.points, v)) || (held.has(v) && this.setup.supports.some((s) => s.line)) ? heldColour : bodyColour, 3 * v);
    this.draw();
  }
  draw() {
    if (this.asked || !this.setup) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.render(); });
  }
  render() {
    const {scene, setup, camera} = this, canvas = this.at('canvas'), dots = Math.min(devicePixelRatio || 1, 2);
    const ball = (at, radius, colour) => ({start: plus3(at, [0, 0, -radius]), end: plus3(at, [0, 0, radius]), radius, colour});
    scene.begin(camera, Math.round(canvas.clientWidth * dots), Math.round(canvas.clientHeight * dots));
    const loads = (list, colour) => list.filter((p) => length3(p.force) > 0).map((p) => {
      const unit = unit3(p.force), length = 0.16 * this.size, inwards = dot3(unit, minus3(p.at, camera.middle)) < 0;
      return {start: inwards ? plus3(p.at, unit, -length) : p.at, end: inwards ? p.at : plus3(p.at, unit, length), radius: 0.007 * this.size, colour};
    });
    scene.glyphs('arrow', [...loads(this.data.states, thereColour), ...loads(setup.probes, loadColour)]);
    scene.glyphs('ball', [...this.data.markers.map((m) => ball(m.at, 0.009 * this.size, thereColour)),
      ...setup.markers.map((m) => ball(m.at, 0.011 * this.size, markerColour)),
      ...(this.chosen >= 0 ? [ball(row3(this.points, this.choices[this.chosen]), 0.016 * this.size, foundColour)] : [])]);
    scene.surface(this.points, this.colours, 1);
    scene.glyphs('tube', setup.supports.filter((s) => s.box).flatMap(({box}) => this.edges(box)));
    scene.glyphs('ball', setup.supports.filter((s) => s.sphere).map(({sphere}) => ball(sphere.center, sphere.radius, heldColour)), 0.3);
  }
  /// The edges of a box.
  edges({min, max}) {
    const corner = (bits) => [0, 1, 2].map((c) => bits >> c & 1 ? max[c] : min[c]);
    return [0, 1, 2].flatMap((c) => [0, 1, 2, 3].map((k) => {
      const low = (k & ((1 << c) - 1)) | ((k >> c) << (c + 1));
      return {start: corner(low), end: corner(low | 1 << c), radius: 0.003 * this.size, colour: heldColour};
    }));
  }
}

/// The page's picker, for whoever wants to script it.
const picker = (() => {
  try {
    return new Picker(JSON.parse(document.getElementById('pick-data').textContent));
  } catch (error) {
    const trouble = document.getElementById('trouble');
    trouble.textContent = `This page needs WebGL 2, as browsers have it since 2022: ${error.message}`;
    trouble.hidden = false;
    throw error;
  }
})();
