// The model in the hand: controls, time, and what is told of force, stiffness and error.
'use strict';

const frameTime = 1 / 60;  // of a step [s]

class Player {
  constructor(data, numerics) {
    Object.assign(this, {data, numerics});
    this.at = (id) => document.getElementById(id);
    const first = data.models[0].text;
    data.models.forEach((model, i) => {
      model.text = i === 0 ? first : Object.fromEntries(
        Object.entries({...first, ...model.text}).filter(([, value]) => value !== null));
      numerics.readModel(model.text);
    });
    data.sets.forEach((set) => numerics.readSet(set));
    this.judge = new Judge(numerics, data);

    this.rest = Float32Array.from(first.skin.vertices.flat());
    this.triangles = Int32Array.from(first.skin.triangles.flat());
    const low = [Infinity, Infinity, Infinity], high = low.map((v) => -v);
    this.rest.forEach((v, i) => { low[i % 3] = Math.min(low[i % 3], v); high[i % 3] = Math.max(high[i % 3], v); });
    this.camera = new Camera(low, high);
    this.camera.distance *= 1.2;  // room to pull
    this.size = this.camera.size;
    this.colours = new Float32Array(this.rest.length);
    this.pinned = [];        // touches that go on pulling
    this.loads = [];         // touches of the probe that is replayed
    this.hand = null;        // {touch, from, target}: what is held now
    this.strongest = 1e-9;   // force that has been seen [N]
    this.wake();

    const held = first.spheres.filter((s) => s.held).map((s) => s.center);
    const support = held.length ? times3(held.reduce((a, b) => plus3(a, b), [0, 0, 0]), 1 / held.length) : low;
    this.points = spreadVertices(this.rest, support, 24);
    this.chosen = {model: data.models.length - 1, off: new Set(), probe: -1, point: -1};
  }

  // --- What is chosen --------------------------------------------------------------------------------------------
  get model() { return this.data.models[this.chosen.model]; }
  isOn(effect) { return effect.played && !this.chosen.off.has(effect.name); }
  /// A bit for each effect that is on.
  get effects() { return this.model.effects.reduce((bits, e, i) => bits + (this.isOn(e) ? 2 ** i : 0), 0); }
  /// The number of the set as it is understood with the faults of the measurement that are on.
  get set() {
    const faults = this.model.effects.filter((e) => e.fault && this.isOn(e)).map((e) => e.name);
    return this.model.sets ? this.model.sets[faults.join(',')] : -1;
  }
  get state() { return this.chosen.probe < 0 ? null : this.data.sets[this.set].states[this.chosen.probe]; }

  /// Takes up what is chosen; `anew`: from rest, with the probe's loads, else from where the body stands.
  restart(anew) {
    const set = this.set < 0 ? null : this.data.sets[this.set], state = this.state;
    const known = [state?.gravity, set?.gravity].find((g) => g && g.every((v) => v !== null));
    this.numerics.start(this.chosen.model, this.effects, known ?? [0, 0, 0], state?.pressure ?? 0, anew);
    if (anew) {
      Object.assign(this, {hand: null, pinned: [], loads: [], motionless: false});
      for (const [x, y, z, fx, fy, fz, radius] of state?.contacts ?? []) {
        if (fx === 0 && fy === 0 && fz === 0) continue;
        const touch = this.numerics.touch([x, y, z], radius);
        this.numerics.push(touch, [fx, fy, fz]);
        this.loads.push(touch);
      }
    }
    if (anew) this.high = 0;
    if (this.set >= 0) this.verdict = this.judge.begin(this.chosen.model, this.effects, this.set);
    this.wake();
    this.tellChoice();
  }
  chooseModel(model) {
    this.chosen.model = model;
    this.restart(false);
  }
  switchEffect(name, on) {
    if (on) this.chosen.off.delete(name); else this.chosen.off.add(name);
    this.restart(false);
  }
  chooseProbe(probe) {
    this.chosen.probe = probe;
    this.restart(true);
    if (this.still || probe < 0) this.settle();
  }

  // --- The hand --------------------------------------------------------------------------------------------------
  /// Takes hold of the skin where it lies at `rest` when nothing acts.
  take(rest, normal) {
    this.letGo();
    const touch = this.numerics.touch(rest, Math.max(0, +this.at('radius').value || 0));
    const {place} = this.numerics.at(touch), C = this.numerics.compliance(touch);
    // A spring five times as stiff as the body there: the point follows, and the force stays what the body bears.
    const softness = C ? (C[0] + C[4] + C[8]) / 3 : 0;
    this.hand = {touch, from: place, target: place, normal, spring: softness > 0 ? 5 / softness : 1};
    this.numerics.drag(touch, place, this.hand.spring);
    this.wake();
  }
  pull(to) {
    if (!this.hand) return;
    this.hand.target = to;
    this.numerics.drag(this.hand.touch, to, this.hand.spring);
    this.wake();
  }
  /// Takes hold with a force that stays as it is [N].
  press(rest, normal, force, radius) {
    this.letGo();
    const touch = this.numerics.touch(rest, radius);
    this.hand = {touch, from: this.numerics.at(touch).place, target: null, normal};
    this.numerics.push(touch, force);
    this.wake();
  }
  letGo() {
    if (!this.hand) return;
    if (this.at('hold').checked) {
      if (this.hand.target) this.numerics.push(this.hand.touch, this.numerics.at(this.hand.touch).force);
      this.pinned.push(this.hand.touch);
    } else {
      this.numerics.release(this.hand.touch);
    }
    this.hand = null;
    this.wake();
  }
  letAllGo() {
    if (this.hand) this.numerics.release(this.hand.touch);
    for (const touch of this.pinned) this.numerics.release(touch);
    Object.assign(this, {hand: null, pinned: []});
    this.wake();
  }
  get touches() { return [...this.loads, ...this.pinned, ...(this.hand ? [this.hand.touch] : [])]; }
  /// What acts now, as `palpate simulate` takes it.
  probesTable() {
    const rows = this.touches.map((t) => this.numerics.at(t))
      .map(({force, rest, radius}) => ['1', '0', ...rest, ...force, radius].join(','));
    return ['probe,time,x,y,z,fx,fy,fz,radius', ...rows].join('\n') + '\n';
  }

  // --- Time ------------------------------------------------------------------------------------------------------
  wake() { this.quiet = 0; }
  /// To where all forces balance.
  settle() {
    this.attempt(() => this.numerics.equilibrium());
    this.wake();
  }
  /// Runs what may find no answer: the body stays where it was then, and the page says so.
  attempt(run) {
    try {
      run();
      this.at('trouble').hidden = true;
      return true;
    } catch (error) {
      this.at('trouble').textContent = error.message;
      this.at('trouble').hidden = false;
      return false;
    }
  }
  /// One step on.
  step() {
    const before = this.centres ?? this.numerics.centres();
    const moved = this.attempt(() => (this.motionless ? this.numerics.equilibrium() : this.numerics.advance(frameTime)));
    if (!moved && !this.motionless && this.numerics.message().includes('mass')) this.motionless = true;
    // Too hard a pull: the hand gives way until the body bears it.
    if (!moved && this.hand?.target) {
      const {place} = this.numerics.at(this.hand.touch);
      this.pull(times3(plus3(place, this.hand.target), 0.5));
    }
    this.centres = this.numerics.centres();
    let furthest = 0;
    for (let i = 0; i < before.length; ++i) furthest = Math.max(furthest, Math.abs(this.centres[i] - before[i]));
    this.quiet = furthest > 2e-6 * this.size ? 0 : this.quiet + 1;
  }
  get moving() { return this.quiet < 20; }
  /// A frame: time goes on by as many steps as have passed, errors are found in what is left of it.
  frame(now) {
    const passed = Math.min(0.05, (now - (this.last ?? now)) / 1000 || frameTime);
    this.last = now;
    if (this.moving) {
      this.owed = Math.min(3 * frameTime, (this.owed ?? 0) + passed);
      while (this.owed >= 0.75 * frameTime) { this.step(); this.owed -= frameTime; }
      this.changed = true;
    }
    if (this.judge.work(this.hand ? 2 : 8)) this.tellErrors();
    if (this.changed) { this.changed = false; this.draw(); this.tell(now); }
    else if (this.unspoken && now - this.spoke > 1200) this.tell(now);
  }

  // --- What is seen ----------------------------------------------------------------------------------------------
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
    this.strongest = Math.max(this.strongest, ...contacts.map((c) => length3(c.force)));
    scene.glyphs('arrow', forceArrows(contacts, this.strongest, camera));
    if (this.hand) {
      const {place} = this.numerics.at(this.hand.touch);
      scene.glyphs('ball', [ballAt(place, 0.012 * size, loadColour)]);
      if (this.hand.target && length3(minus3(this.hand.target, place)) > 1e-9) {
        scene.glyphs('tube', [{start: place, end: this.hand.target, radius: 0.002 * size, colour: measuredColour}]);
      }
    } else if (this.chosen.point >= 0) {
      scene.glyphs('ball', [ballAt(row3(skin, this.points[this.chosen.point]), 0.012 * size, loadColour)]);
    }
    if (errors && this.at('show-markers').checked) this.drawMarkers(errors);
    const skeleton = this.at('show-skeleton').checked;
    if (skeleton) this.drawSkeleton();
    if (this.at('show-skin').checked) scene.surface(skin, this.colours, skeleton || errors ? 0.5 : 1);
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

  // --- What is told ----------------------------------------------------------------------------------------------
  /// Force, way and stiffness at the hand.
  feel() {
    if (!this.hand) return null;
    const {force, place} = this.numerics.at(this.hand.touch), strength = length3(force);
    const C = this.numerics.compliance(this.hand.touch);
    const along = strength > 1e-7 ? unit3(force) : this.hand.normal;
    return {strength, moved: length3(minus3(place, this.hand.from)), stiffness: C ? 1 / along3(C, along) : NaN,
      words: strength > 1e-7 ? 'stiffness along the pull' : 'stiffness across the skin'};
  }
  tell(now) {
    if (!this.hand || now - (this.felt ?? 0) > (this.feelEvery ?? 90)) {
      const begin = performance.now(), feel = this.feel();
      this.felt = now;
      this.feelEvery = Math.max(90, 20 * (performance.now() - begin));  // a twentieth of the time at most
      this.at('force').textContent = inUnit(feel?.strength ?? 0, 'N');
      this.at('moved').textContent = inUnit(feel?.moved ?? 0, 'mm');
      this.at('stiffness').textContent = feel ? inUnit(feel.stiffness, 'N/mm') : '–';
      this.at('along').textContent = feel?.words ?? 'stiffness there';
      this.unspoken = now - (this.spoke ?? 0) <= 1200;  // what is spoken changes no faster than it can be heard
      if (!this.unspoken) {
        this.spoke = now;
        this.at('spoken').textContent = feel ? `Force ${inUnit(feel.strength, 'newton')}, moved ${inUnit(feel.moved,
          'millimetres')}, stiffness ${inUnit(feel.stiffness, 'newton per millimetre')}.` : 'Nothing is held.';
      }
    }
    const errors = this.markerErrors();
    if (errors) {
      const worst = errors.lengths.reduce((a, b) => (b > a ? b : a), 0);
      this.at('told').textContent = `Off by ${inUnit(errors.rms, 'mm')} rms, ${inUnit(worst, 'mm')} at most` +
        `${this.hand || this.pinned.length ? ', pulled besides' : ''}. Dark: measured; light: the model.`;
    } else if (this.set >= 0) {
      this.at('told').textContent = this.state ? 'Nothing was read in this state.' : 'Choose one: its forces act, and the measured markers are drawn.';
    }
  }
  tellChoice() {
    this.at('model').value = this.chosen.model;
    this.at('about').textContent = this.model.about;
    this.at('about').hidden = !this.model.about;
    this.at('probe').value = this.chosen.probe;
    this.at('switches').replaceChildren(...this.model.effects.map((effect) => this.switchOf(effect)));
    this.at('effects').hidden = this.model.effects.length === 0;
    this.at('alone').hidden = this.data.models.length < 2 || this.set < 0;
    this.tellErrors();
    this.changed = true;
    this.tellLink();
  }
  switchOf(effect) {
    const label = document.createElement('label'), box = document.createElement('input');
    label.className = 'switch';
    Object.assign(box, {type: 'checkbox', id: `effect-${effect.name}`, checked: this.isOn(effect), disabled: !effect.played});
    box.setAttribute('role', 'switch');
    box.addEventListener('change', () => {
      this.switchEffect(effect.name, box.checked);
      this.at(`effect-${effect.name}`)?.focus();
    });
    const words = document.createElement('span'), small = document.createElement('small');
    const many = effect.numbers.length > 6;  // a gain for each probe, say
    const numbers = (many ? `${effect.numbers.slice(0, 6).join(', ')}, …` : effect.numbers.join(', ')).replaceAll('^2', '²');
    small.textContent = `${effect.meaning} ${numbers}${effect.played ? '' : '. Not played here'}`;
    words.append(effect.fault ? `${effect.name} (of the measurement)` : effect.name, small);
    label.append(box, words);
    return label;
  }
  /// Bars: the ladder as it was told, and what the model in the hand comes to.
  tellErrors() {
    const shown = this.set >= 0;
    this.at('errors').hidden = this.at('replay').hidden = this.at('markers-label').hidden = !shown;
    if (!shown) return;
    const off = this.model.effects.filter((e) => e.played && !this.isOn(e)).map((e) => e.name);
    const {verdict} = this, told = this.data.models.filter((m) => m.told);
    const bars = told.map((m) => ({name: m.name, rms: m.told.rms_mm}));
    const name = `In the hand${off.length ? `, without ${off.join(', ')}` : ''}`;
    bars.push({name, rms: verdict.done ? verdict.rms : NaN, now: true});
    const largest = Math.max(...bars.map((b) => b.rms || 0)) || 1;
    this.at('bars').replaceChildren(...bars.map(({name: text, rms, now}) => {
      const row = document.createElement('div'), words = document.createElement('span');
      const value = document.createElement('b'), bar = document.createElement('i');
      row.className = now ? 'bar now' : 'bar';
      words.textContent = text;
      value.textContent = inUnit(rms, 'mm');
      bar.style.width = `${100 * Math.min(1, (rms || 0) / largest)}%`;
      row.append(words, value, bar);
      return row;
    }));
    const part = this.judge.heldOut.size ? 'rms over the probes that were fitted' : 'rms over all measured coordinates';
    const unseen = Number.isFinite(verdict.heldOutRms) ? `; ${inUnit(verdict.heldOutRms, 'mm')} on those held out` : '';
    this.at('judged').textContent = verdict.trouble ? `Not found: ${verdict.trouble}`
      : verdict.whole ? `${part}${unseen}${verdict.lowered ? `; ${verdict.lowered} loads lowered to what it bears` : ''}.`
      : `${verdict.done} of ${verdict.of || '…'} states played.`;
  }

  // --- A link ----------------------------------------------------------------------------------------------------
  link() {
    const {chosen, camera} = this, round = (v) => +v.toPrecision(5), state = this.state;
    const pulled = [...this.pinned, ...(this.hand ? [this.hand.touch] : [])].slice(0, 1).map((t) => this.numerics.at(t))[0];
    return inHash.write({
      model: chosen.model, off: [...chosen.off].join(','), probe: state ? chosen.probe : '',
      colour: this.at('colour').value, radius: this.at('radius').value,
      skeleton: this.at('show-skeleton').checked ? 1 : '',
      view: [...camera.turned, ...camera.target, camera.distance].map(round).join(','),
      pull: pulled ? [...pulled.rest, ...pulled.force, pulled.radius].map(round).join(',') : '',
    });
  }
  tellLink() {
    clearTimeout(this.linking);
    this.linking = setTimeout(() => history.replaceState(null, '', this.link()), 300);
  }
  /// Takes up what a link tells; what it does not tell, or wrongly, stays as it is.
  follow(hash) {
    const told = inHash.read(hash), {chosen, camera} = this;
    const index = (text, count) => (text !== undefined && +text >= 0 && +text < count ? Math.floor(+text) : null);
    chosen.model = index(told.model, this.data.models.length) ?? chosen.model;
    if (told.off !== undefined) chosen.off = new Set(told.off.split(',').filter(Boolean));
    else if (told.model !== undefined) chosen.off = new Set();
    if (this.set >= 0) chosen.probe = index(told.probe, this.data.sets[this.set].states.length) ?? chosen.probe;
    if ([...this.at('colour').options].some((o) => o.value === told.colour)) this.at('colour').value = told.colour;
    if (told.radius !== undefined && +told.radius >= 0) this.at('radius').value = told.radius;
    this.at('show-skeleton').checked = told.skeleton === '1';
    const view = inHash.numbers(told.view, 13), pull = inHash.numbers(told.pull, 7);
    if (view) Object.assign(camera, {turned: view.slice(0, 9), target: view.slice(9, 12), distance: view[12]});
    this.restart(true);
    this.settle();
    if (pull) this.press(pull.slice(0, 3), unit3(pull.slice(3, 6)), pull.slice(3, 6), Math.max(0, pull[6]));
  }

  // --- Controls --------------------------------------------------------------------------------------------------
  listen() {
    const {at} = this, fill = (select, rows) => select.replaceChildren(...rows.map(([text, value]) => new Option(text, value)));
    const canvas = at('canvas');
    at('name').textContent = this.data.name;
    fill(at('model'), this.data.models.map((m, i) => [m.name, i]));
    at('model-label').hidden = this.data.models.length < 2;
    const states = this.data.sets[0]?.states ?? [];
    const unloaded = (s) => s.contacts.every((c) => c[3] === 0 && c[4] === 0 && c[5] === 0);
    fill(at('probe'), [['none', -1], ...states.map((s, i) => [
      `${s.probe} at ${+s.time.toPrecision(4)} s${unloaded(s) ? ', unloaded' : ''}${this.judge.heldOut.has(s.probe) ? ', held out' : ''}`, i])]);
    fill(at('point'), [['none', -1], ...this.points.map((v, i) => [
      `${i + 1} (${row3(this.rest, v).map((x) => +x.toPrecision(3)).join(', ')})`, i])]);
    fill(at('colour'), [['displacement', 'displacement'], ...(states.length ? [['error', 'error']] : [])]);
    at('gradient').style.background = paletteGradient;
    at('radius').value = +(0.03 * this.size).toPrecision(1);
    at('notes').replaceChildren(...this.data.notes.map((note) => {
      const item = document.createElement('li');
      item.textContent = note;
      return item;
    }));

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
    const taken = this.attempt(() => this.take(pointIn(this.rest, this.triangles, hit), normal));
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
        this.attempt(() => this.take(row3(this.rest, vertex), normalAt(this.skin ?? this.rest, this.triangles, vertex)));
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
    return new Player(JSON.parse(new TextDecoder().decode(data)), await Numerics.start(wasm)).begin();
  } catch (error) {
    const trouble = document.getElementById('trouble');
    trouble.textContent = `This page needs WebGL 2, WebAssembly and gzip streams, as browsers have them since 2023: ${error.message}`;
    trouble.hidden = false;
    throw error;
  }
})();
