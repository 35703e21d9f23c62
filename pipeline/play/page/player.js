// The model in the hand: what is chosen, what holds it, time. What is seen and told of it stands in seen.js and told.js,
// the page's player in controls.js.
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
    const box = new Box().hold(this.rest), canvas = this.at('canvas'), roomToPull = 1.5;
    this.camera = new Camera(box, canvas.clientWidth / canvas.clientHeight || 1, roomToPull);
    Object.assign(this, {size: box.size(), middle: box.middle()});
    this.colours = new Float32Array(this.rest.length);
    this.pinned = [];        // touches that go on pulling
    this.loads = [];         // touches of the probe that is replayed
    this.hand = null;        // {touch, from, target}, or with a ball {ball, from, target}: what is held now
    this.ball = null;        // {radius, at}: a ball that presses, in the hand or left where it was
    this.strongest = 1e-9;   // force that has been seen [N]
    this.actuators = data.actuators.map((actuator, i) => ({...actuator, of: i})).filter((actuator) => actuator.kind);
    this.asked = this.actuators.map(() => 0);   // where each shall be
    this.driven = this.actuators.map(() => 0);  // where it is
    this.wake();

    const held = first.spheres.filter((s) => s.held).map((s) => s.center);
    const support = held.length ? times3(held.reduce((a, b) => plus3(a, b), [0, 0, 0]), 1 / held.length) : box.low;
    this.points = spreadVertices(this.rest, support, 24);
    this.chosen = {model: data.models.length - 1, off: new Set(), probe: -1, point: -1};
  }

  // --- What is chosen --------------------------------------------------------------------------------------------
  get model() { return this.data.models[this.chosen.model]; }
  isOn(effect) { return effect.played && !this.chosen.off.has(effect.name); }
  /// A bit for each effect that is on.
  get effects() { return this.model.effects.reduce((bits, e, i) => bits + (this.isOn(e) ? 2 ** i : 0), 0); }
  /// The number of the set as it is understood with those effects that are on.
  setWith(effects) {
    return this.model.sets ? this.model.sets[effects.filter((e) => this.isOn(e)).map((e) => e.name).join(',')] : -1;
  }
  /// With the faults of the measurement.
  get set() { return this.setWith(this.model.effects.filter((e) => e.fault)); }
  /// With loads that have crept until they were read.
  get state() {
    const set = this.setWith(this.model.effects.filter((e) => e.fault || e.creeps));
    return this.chosen.probe < 0 ? null : this.data.sets[set].states[this.chosen.probe];
  }

  /// What the probe sets each actuator to; without one 0.
  get settings() {
    const settings = new Map(this.state?.settings ?? []);
    return this.actuators.map((actuator) => settings.get(actuator.of) ?? 0);
  }

  /// Takes up what is chosen; `anew`: from rest, with the probe's loads, else from where the body stands.
  restart(anew) {
    const set = this.set < 0 ? null : this.data.sets[this.set], state = this.state;
    const known = [state?.gravity, set?.gravity].find((g) => g && g.every((v) => v !== null));
    this.numerics.start(this.chosen.model, this.effects, known ?? [0, 0, 0], state?.pressure ?? 0, anew);
    if (anew) Object.assign(this, {hand: null, ball: null, pinned: [], loads: [], motionless: false});
    const acting = (state?.contacts ?? []).filter((contact) => contact.slice(3, 6).some((f) => f !== 0));
    if (acting.length !== this.loads.length) {
      for (const touch of this.loads) this.numerics.release(touch);
      this.loads = acting.map(([x, y, z, , , , radius]) => this.numerics.touch([x, y, z], radius));
    }
    acting.forEach((contact, i) => this.numerics.bear(this.loads[i], contact.slice(3, 6)));
    if (anew) Object.assign(this, {high: 0, driven: this.actuators.map(() => 0)});
    this.actuators.forEach((actuator, i) => {
      this.numerics.addActuator(actuator);
      this.numerics.drive(i, this.driven[i]);
    });
    if (this.set >= 0 && this.data.judged) this.verdict = this.judge.begin(this.chosen.model, this.effects, this.set);
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
    this.asked = this.settings;
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
    if (!this.hand.ball) this.numerics.drag(this.hand.touch, to, this.hand.spring);
    this.wake();
  }
  /// Brings a ball up to the skin where it stands.
  takeBall(place, normal) {
    this.letGo();
    const radius = +this.at('radius').value > 0 ? +this.at('radius').value : 0.03 * this.size;
    const at = plus3(place, normal, radius);
    this.numerics.placeBall(radius, at);
    this.ball = {radius, at};
    this.hand = {ball: this.ball, from: at, target: at, normal};
    this.wake();
  }
  /// The ball follows the hand, by what it may go in a step.
  moveBall() {
    if (!this.hand?.ball) return;
    const {ball, target} = this.hand, way = minus3(target, ball.at), most = 0.2 * ball.radius;
    if (length3(way) === 0) return;
    ball.at = length3(way) > most ? plus3(ball.at, unit3(way), most) : target;
    this.numerics.placeBall(ball.radius, ball.at);
    this.wake();
  }
  liftBall() {
    if (this.ball) this.numerics.liftBall();
    this.ball = null;
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
    if (this.hand.ball) {
      if (!this.at('hold').checked) this.liftBall();
    } else if (this.at('hold').checked) {
      if (this.hand.target) this.numerics.push(this.hand.touch, this.numerics.at(this.hand.touch).force);
      this.pinned.push(this.hand.touch);
    } else {
      this.numerics.release(this.hand.touch);
    }
    this.hand = null;
    this.wake();
  }
  letAllGo() {
    if (this.hand && !this.hand.ball) this.numerics.release(this.hand.touch);
    this.liftBall();
    for (const touch of this.pinned) this.numerics.release(touch);
    Object.assign(this, {hand: null, pinned: []});
    this.wake();
  }
  // --- Actuators ---------------------------------------------------------------------------------------------------
  drive(i, value) {
    this.asked[i] = value;
    this.wake();
    if (this.still) this.settle();
  }
  /// Each on its way to where it shall be, by that share of its range at most; false where all are there.
  driveOn(share) {
    const before = this.driven;
    this.driven = before.map((value, i) => {
      const most = share * (this.actuators[i].high - this.actuators[i].low), way = this.asked[i] - value;
      return Math.abs(way) > most ? value + Math.sign(way) * most : this.asked[i];
    });
    this.driven.forEach((value, i) => { if (value !== before[i]) this.numerics.drive(i, value); });
    return this.driven.some((value, i) => value !== before[i]);
  }
  /// The body does not bear it: back to what it bore, and no further.
  driveBack(to) {
    this.driven = to;
    this.asked = [...to];
    to.forEach((value, i) => this.numerics.drive(i, value));
    this.tellActuators();
  }
  get touches() { return [...this.loads, ...this.pinned, ...(this.hand && !this.hand.ball ? [this.hand.touch] : [])]; }
  /// What acts now, as `palpate simulate` takes it.
  probesTable() {
    const rows = this.touches.map((t) => this.numerics.at(t))
      .map(({borne, rest, radius}) => ['1', '0', ...rest, ...borne, radius].join(','));
    return ['probe,time,x,y,z,fx,fy,fz,radius', ...rows].join('\n') + '\n';
  }

  // --- Time ------------------------------------------------------------------------------------------------------
  wake() { this.quiet = 0; }
  /// To where all forces balance.
  settle() {
    for (let driving = true; driving;) {
      const before = this.driven;
      driving = this.driveOn(0.1);
      if (!this.attempt(() => this.balance())) {
        if (driving) this.driveBack(before);
        break;
      }
    }
    this.wake();
  }
  /// Under strong actuators Newton's method may not end, for the tangent is not exact: then as time goes on.
  balance() {
    try {
      this.numerics.equilibrium();
    } catch (error) {
      if (this.motionless || this.driven.every((value) => value === 0)) throw error;
      for (let i = 0, still = 0; i < 600 && still < 20; ++i) still = this.goOn() ? 0 : still + 1;
    }
  }
  /// A step of time; does the body move?
  goOn() {
    const before = this.numerics.centres();
    this.numerics.advance(frameTime);
    return this.movedFrom(before);
  }
  /// Are spheres elsewhere, by more than is seen?
  movedFrom(before) {
    this.centres = this.numerics.centres();
    return this.centres.some((x, i) => Math.abs(x - before[i]) > 2e-6 * this.size);
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
    this.moveBall();
    const bore = this.driven, driving = this.driveOn(1 / 30);  // half a second from end to end
    const moved = this.attempt(() => (this.motionless ? this.numerics.equilibrium() : this.numerics.advance(frameTime)));
    if (!moved && !this.motionless && this.numerics.message().includes('mass')) this.motionless = true;
    // Too hard a pull: the actuators or the hand give way until the body bears it.
    if (!moved && driving) {
      this.driveBack(bore);
    } else if (!moved && this.hand?.ball) {
      this.pull(plus3(this.hand.ball.at, this.hand.normal, 0.2 * this.hand.ball.radius));
    } else if (!moved && this.hand?.target) {
      const {place} = this.numerics.at(this.hand.touch);
      this.pull(times3(plus3(place, this.hand.target), 0.5));
    }
    this.quiet = this.movedFrom(before) || driving ? 0 : this.quiet + 1;
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
}
