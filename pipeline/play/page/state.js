// What is chosen, as a link holds it; and the error on all probes, told while it is found.
'use strict';

/// Of a model's error on a set: sums over the states that it was fitted to, and over those held out.
class Verdict {
  constructor() { this.fitted = [0, 0]; this.heldOut = [0, 0]; this.done = 0; this.of = 0; this.lowered = 0; }
  add(judged, isHeldOut) {
    const sum = isHeldOut ? this.heldOut : this.fitted;
    sum[0] += judged.squares;
    sum[1] += judged.coordinates;
    this.lowered += judged.whole ? 0 : 1;
    this.done += 1;
  }
  static rms([squares, count]) { return count > 0 ? Math.sqrt(squares / count) : NaN; }
  get rms() { return Verdict.rms(this.fitted); }
  get heldOutRms() { return Verdict.rms(this.heldOut); }
  get allRms() { return Verdict.rms([this.fitted[0] + this.heldOut[0], this.fitted[1] + this.heldOut[1]]); }
  get whole() { return this.of > 0 && this.done === this.of; }
}

/// Judges models on sets a few milliseconds at a time; what was judged once is remembered.
class Judge {
  constructor(numerics, data) {
    this.numerics = numerics;
    this.data = data;
    this.known = new Map();
    // Where every probe was held out in turn, the steps are fitted to all.
    const probes = new Set((data.sets[0]?.states ?? []).filter((s) => s.readings.length).map((s) => s.probe));
    this.heldOut = new Set(data.held_out.length < probes.size ? data.held_out : []);
  }
  /// The verdict on a model, to be continued by `work`.
  begin(model, effects, set) {
    const key = `${model} ${effects} ${set}`;
    this.asked = {key, model, effects, set};
    if (!this.known.has(key)) this.known.set(key, new Verdict());
    return this.known.get(key);
  }
  /// Goes on for so long [ms]; true where something was added.
  work(budget) {
    const {key, model, effects, set} = this.asked ?? {};
    const verdict = this.known.get(key);
    if (!verdict || verdict.trouble || verdict.whole) return false;
    try {
      if (this.at !== key) {  // another one was begun meanwhile
        Object.assign(verdict, new Verdict());
        verdict.of = this.numerics.judge(model, effects, set);
        this.at = key;
      }
      const until = performance.now() + budget;
      do {
        const judged = this.numerics.judgeState(verdict.done);
        verdict.add(judged, this.heldOut.has(this.data.sets[set].states[judged.state].probe));
      } while (!verdict.whole && performance.now() < until);
    } catch (error) {
      verdict.trouble = error.message;
    }
    return true;
  }
}

/// What is chosen as the part of an address behind '#', and back.
const inHash = {
  write(chosen) {
    const parts = new URLSearchParams();
    for (const [key, value] of Object.entries(chosen)) {
      if (value !== undefined && value !== null && value !== '') parts.set(key, value);
    }
    return `#${parts}`;
  },
  read(hash) { return Object.fromEntries(new URLSearchParams(hash.replace(/^#/, ''))); },
  numbers(text, count) {
    const numbers = (text ?? '').split(',').map(Number);
    return numbers.length === count && numbers.every(Number.isFinite) ? numbers : null;
  },
};
