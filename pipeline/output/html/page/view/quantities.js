// What of a run can be seen in colour: numbers of its states, and stiffnesses of its links.
'use strict';

const withUnit = (quantity) => `${quantity.name}${quantity.unit ? ` [${quantity.unit}]` : ''}`;

class Quantities {
  /// Where forces alone were read, no marker has an error. `body`: {rest, size}; an error is spread from markers as far
  /// as a quarter of the size.
  constructor(run, body) {
    const {steps} = run, every = (pick) => steps.flatMap((step) => step.states.flatMap(pick));
    Object.assign(this, {run, rest: body.rest, reach: 0.25 * body.size});
    this.isMarked = every((state) => state.markers.id.length).some(Boolean);
    for (const state of every((s) => s)) {
      state.lengths = state.markers.id.map((_, i) => norm3(state.markers.error, i));
      Object.assign(state, errorsOf(state.markers));
    }
    this.furthest = largestOf([...every((s) => this.moved(s)), ...every((s) => lengthsOf(s.markers.measured))]);
    this.worst = largestOf(every((s) => s.lengths));
    this.list = [
      ...(this.isMarked ? [{name: 'error', unit: 'mm', ofMarkers: true, words: 'distance from model to measurement; between markers the mean of the nearest four, grey where none is near'}] : []),
      {name: 'displacement', unit: 'mm', words: 'how far the model moves'},
      ...steps[steps.length - 1].quantities.map((q) => ({name: q.name, unit: q.unit, links: true, logarithmic: true,
        words: q.relative ? 'uncertainty of the links, standard deviation over mean' : 'of the links'})),
    ];
  }
  /// How far the model moves in a state [mm]: its skin, or where it has none its spheres.
  moved(answer) { return lengthsOf(answer.skin.length ? answer.skin : answer.spheres); }
  ofLinks(step, quantity) {
    return this.run.steps[step].quantities.find((q) => q.name === quantity.name)?.values ?? [];
  }
  /// Over all steps and states, or those of one.
  scale(quantity, step, answer, isOfAll) {
    if (quantity.links) {
      const steps = isOfAll ? this.run.steps.map((_, i) => i) : [step];
      return new Scale(steps.flatMap((i) => Array.from(this.ofLinks(i, quantity))), true);
    }
    if (quantity.ofMarkers) return new Scale(isOfAll ? [this.worst] : answer.lengths, false);
    return new Scale(isOfAll ? [this.furthest] : this.moved(answer), false);
  }
  /// Numbers of a state at the vertices of the skin, the spheres and the markers; null for one of the links.
  values(quantity, state, answer) {
    if (quantity.links) return null;
    const {markers, lengths} = answer;
    if (!quantity.ofMarkers) {
      return {skin: lengthsOf(answer.skin), spheres: lengthsOf(answer.spheres),
        markers: lengthsOf(markers.measured.map((v, i) => v - markers.error[i]))};
    }
    const {measured} = this.run.states[state];
    answer.onSkin ??= measured ? lengthsOf(measured.map((v, i) => v - answer.skin[i])) : spread(markers, lengths, this.rest, this.reach);
    answer.onSpheres ??= spread(markers, lengths, this.run.spheres.centers, this.reach);
    return {skin: answer.onSkin, spheres: answer.onSpheres, markers: lengths};
  }
}
