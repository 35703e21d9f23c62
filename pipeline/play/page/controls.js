// Mouse, fingers and keys on the model, and the page's player.
'use strict';

class HandledPlayer extends ToldPlayer {
  listen() {
    const {at} = this, fill = (select, rows) => select.replaceChildren(...rows.map(([text, value]) => new Option(text, value)));
    const canvas = at('canvas');
    at('name').textContent = this.data.name;
    fill(at('model'), this.data.models.map((m, i) => [m.name, i]));
    at('model-label').hidden = this.data.models.length < 2;
    const states = this.data.sets[0]?.states ?? [];
    const unloaded = (s) => s.contacts.every((c) => c[3] === 0 && c[4] === 0 && c[5] === 0)
      && (s.settings ?? []).every(([, value]) => value === 0);
    fill(at('probe'), [['none', -1], ...states.map((s, i) => [
      `${s.probe} at ${+s.time.toPrecision(4)} s${unloaded(s) ? ', unloaded' : ''}${this.judge.heldOut.has(s.probe) ? ', held out' : ''}`, i])]);
    fill(at('point'), [['none', -1], ...this.points.map((v, i) => [
      `${i + 1} (${row3(this.rest, v).map((x) => (Math.abs(x) < 1e-9 ? 0 : +x.toPrecision(3))).join(', ')})`, i])]);
    fill(at('colour'), [['displacement', 'displacement'], ...(states.length ? [['error', 'error']] : [])]);
    at('gradient').style.background = paletteGradient;
    at('radius').value = +(0.03 * this.size).toPrecision(1);
    at('notes').replaceChildren(...this.data.notes.map((note) => {
      const item = document.createElement('li');
      item.textContent = note;
      return item;
    }));

    at('drives').hidden = !this.actuators.length;
    at('sliders').replaceChildren(...this.actuators.map((actuator, i) => this.sliderOf(actuator, i)));

    at('controls').addEventListener('submit', (e) => e.preventDefault());
    at('controls').addEventListener('input', () => { this.changed = true; this.tellLink(); });
    at('colour').addEventListener('change', () => { this.high = 0; });
    at('model').addEventListener('change', () => this.chooseModel(+at('model').value));
    at('probe').addEventListener('change', () => this.chooseProbe(+at('probe').value));
    at('point').addEventListener('change', () => this.choosePoint(+at('point').value));
    at('press').addEventListener('change', () => this.pressPoint());
    const buttons = {'let-go': () => this.letAllGo(), settle: () => this.settle(), reset: () => this.chooseProbe(this.chosen.probe),
      'copy-link': () => this.copy(`${location.href.split('#')[0]}${this.link()}`, 'The link'),
      'copy-probes': () => this.copy(this.probesTable(), 'probes.csv of what acts now')};
    for (const [id, does] of Object.entries(buttons)) at(id).addEventListener('click', does);
    steer(canvas, this.camera, {
      draw: () => { this.changed = true; this.tellLink(); }, move: () => {}, play: () => {},
      hint: (x, y) => canvas.classList.toggle('over', this.under(x, y) !== null),
      grab: (x, y) => this.grab(x, y), pull: (x, y) => this.pullTo(x, y),
      letGo: () => { this.letGo(); canvas.classList.remove('held'); this.tellLink(); }, key: (e) => this.key(e)});
    addEventListener('hashchange', () => { if (location.hash !== this.link()) this.follow(location.hash); });
    new ResizeObserver(() => { this.changed = true; }).observe(canvas);
  }
  sliderOf({name, low, high}, i) {
    const label = document.createElement('label'), slider = document.createElement('input'), told = document.createElement('output');
    label.className = 'slider';
    Object.assign(slider, {type: 'range', id: `drive-${i}`, min: low, max: high, step: (high - low) / 200, value: 0});
    slider.setAttribute('aria-label', name);
    slider.addEventListener('input', () => this.drive(i, +slider.value));
    told.id = `driven-${i}`;
    label.append(name, slider, told);
    return label;
  }
  under(x, y) {
    const canvas = this.at('canvas'), ray = rayAt(this.camera, x, y, canvas.clientWidth, canvas.clientHeight);
    const hit = this.skin ? meet(ray, this.skin, this.triangles) : null;
    return hit && {...hit, ray};
  }
  grab(x, y) {
    const hit = this.under(x, y);
    if (!hit) return false;
    const corners = [0, 1, 2].map((c) => row3(this.skin, this.triangles[3 * hit.triangle + c]));
    const normal = unit3(cross3(minus3(corners[1], corners[0]), minus3(corners[2], corners[0])));
    const taken = this.attempt(() => (this.at('with').value === 'ball'
      ? this.takeBall(pointIn(this.skin, this.triangles, hit), normal) : this.take(pointIn(this.rest, this.triangles, hit), normal)));
    if (!taken) return false;
    this.hand.t = hit.t;
    this.hand.aside = minus3(this.hand.from, plus3(hit.ray.from, hit.ray.along, hit.t));
    this.at('canvas').classList.add('held');
    return true;
  }
  /// The hand follows the pointer in a plane before the eye.
  pullTo(x, y) {
    if (!this.hand?.t) return;
    const canvas = this.at('canvas'), ray = rayAt(this.camera, x, y, canvas.clientWidth, canvas.clientHeight);
    this.pull(plus3(plus3(ray.from, ray.along, this.hand.t), this.hand.aside));
  }
  choosePoint(point) {
    this.letGo();
    this.chosen.point = point;
    this.at('point').value = point;
    this.changed = true;
    this.at('spoken').textContent = point < 0 ? 'No point is chosen.'
      : `Point ${point + 1} of ${this.points.length} is chosen; Enter takes hold of it.`;
  }
  /// A dead force at the chosen point, along the skin's normal.
  pressPoint() {
    if (this.chosen.point < 0) this.choosePoint(0);
    const vertex = this.points[this.chosen.point], force = +this.at('press').value || 0;
    const normal = normalAt(this.skin ?? this.rest, this.triangles, vertex);
    this.attempt(() => this.press(row3(this.rest, vertex), normal, times3(normal, force), Math.max(0, +this.at('radius').value || 0)));
    this.tellLink();
  }
  /// Keys on the view; false: the camera may have it.
  key(e) {
    const next = {n: 1, N: 1, p: -1, P: -1}[e.key], count = this.points.length;
    if (next) {
      this.choosePoint((Math.max(this.chosen.point, next > 0 ? -1 : 0) + next + count) % count);
    } else if (e.key === 'Enter') {
      if (this.hand) this.letGo();
      else if (this.chosen.point >= 0) {
        const vertex = this.points[this.chosen.point];
        const normal = normalAt(this.skin ?? this.rest, this.triangles, vertex);
        this.attempt(() => (this.at('with').value === 'ball' ? this.takeBall(row3(this.skin, vertex), normal)
          : this.take(row3(this.rest, vertex), normal)));
      } else this.choosePoint(0);
    } else if (e.key === 'Escape') {
      this.letAllGo();
    } else if (this.hand?.target) {
      const steps = {ArrowRight: [1, 0, 0], ArrowLeft: [-1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0],
        PageUp: [0, 0, -1], PageDown: [0, 0, 1]}[e.key];
      if (!steps) return false;
      const R = this.camera.turned, way = (e.shiftKey ? 0.002 : 0.01) * this.size;
      this.pull(plus3(this.hand.target, [0, 1, 2].map((k) => dot3([R[3 * k], R[3 * k + 1], R[3 * k + 2]], steps)), way));
    } else {
      return false;
    }
    return true;
  }
  async copy(text, what) {
    let done = true;
    try { await navigator.clipboard.writeText(text); } catch { done = false; }
    this.at('copied').textContent = done ? `${what} is on the clipboard.` : text;
  }

  begin() {
    this.scene = new Scene(this.at('canvas'), this.triangles);
    this.still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.listen();
    const set = this.data.sets[Math.max(0, this.set)];
    if (set) this.skinErrors = new SkinErrors(this.rest, set.markers.map((m) => m.slice(1, 4)), 0.25 * this.size);
    this.follow(location.hash);
    const loop = (now) => { this.frame(now); requestAnimationFrame(loop); };
    requestAnimationFrame(loop);
    return this;
  }
}

/// The page's player, for whoever wants to script it.
const player = (async () => {
  try {
    const [data, wasm] = await Promise.all([unpacked('play-data'), unpacked('play-module')]);
    return new HandledPlayer(JSON.parse(new TextDecoder().decode(data)), await Numerics.start(wasm)).begin();
  } catch (error) {
    const trouble = document.getElementById('trouble');
    trouble.textContent = `This page needs WebGL 2, WebAssembly and gzip streams, as browsers have them since 2023: ${error.message}`;
    trouble.hidden = false;
    throw error;
  }
})();
