// A marker through the states of a set: how it was measured to move, and how each model of the ladder moves it.
'use strict';

const seriesColours = ['var(--soft)', 'var(--amber)', 'var(--blue)', '#8a5fb0', '#3c9a76'];

/// How a marker moves along an axis (0, 1, 2) or in all (3) [mm], over the times of a probe that has several, else over
/// all states in order: {overTime, states, x, measured, models}; `states` are numbers of the run's. A model's value is
/// NaN where its step set the reading aside.
function seriesOf(run, marker, axis, shown) {
  const {probe} = run.states[shown], all = run.states.map((_, s) => s);
  const ofProbe = all.filter((s) => run.states[s].probe === probe), overTime = ofProbe.length > 2;
  const rowIn = (step, s) => step.states[s].markers.id.indexOf(marker), raw = run.steps[0];
  const states = (overTime ? ofProbe : all).filter((s) => rowIn(raw, s) >= 0);
  const along = (v) => (axis < 3 ? v[axis] : Math.hypot(...v));
  const measured = (s) => point3(raw.states[s].markers.measured, rowIn(raw, s));
  const modelled = (step, s) => {
    const row = rowIn(step, s), error = row < 0 ? [NaN, NaN, NaN] : point3(step.states[s].markers.error, row);
    return measured(s).map((v, c) => v - error[c]);
  };
  return {overTime, states, x: states.map((s) => (overTime ? run.states[s].time : s)),
    measured: states.map((s) => along(measured(s))),
    models: run.steps.map((step) => ({name: step.name, values: states.map((s) => along(modelled(step, s)))}))};
}

/// A step of 1, 2 or 5 times a power of ten that cuts a range in about `parts`.
function niceStep(range, parts) {
  const ten = 10 ** Math.floor(Math.log10(range / parts || 1));
  return ten * [1, 2, 5, 10].find((f) => f * ten >= range / parts);
}

/// A series as the inside of an SVG; `titles` name the states, `shown` is the one that the view shows.
function seriesDrawing(series, run, titles, shown) {
  const left = 76, right = 628, top = 10, bottom = 152;
  const values = [...series.measured, ...series.models.flatMap((m) => m.values.filter(Number.isFinite))];
  const low = Math.min(0, ...values), most = Math.max(0, ...values), step = niceStep(most - low || 1, 4);
  const floor = Math.floor(low / step) * step, ceiling = Math.ceil(most / step) * step || step;
  const first = Math.min(...series.x), span = Math.max(...series.x) - first || 1;
  const px = (x) => +(left + (right - left) * (x - first) / span).toFixed(1);
  const py = (y) => +(bottom - (bottom - top) * (y - floor) / (ceiling - floor)).toFixed(1);
  const text = (x, y, words, anchor = 'middle') => `<text x="${x}" y="${y}" text-anchor="${anchor}">${words}</text>`;
  const parts = [text((left + right) / 2, bottom + 34, series.overTime ? 'time [s]' : 'probe')];
  for (let y = floor; y <= ceiling + step / 2; y += step) {
    parts.push(`<line x1="${left}" x2="${right}" y1="${py(y)}" y2="${py(y)}" class="grid"/>`,
      text(left - 6, py(y) + 4, `${+y.toPrecision(6)}${y > ceiling - step / 2 ? ' mm' : ''}`, 'end'));
  }
  if (series.overTime) {
    const apart = niceStep(span, 6);
    for (let x = Math.ceil(first / apart) * apart; x <= first + span * (1 + 1e-9); x += apart)
      parts.push(text(px(x), bottom + 16, +x.toPrecision(6)));
  } else {
    // The first state of each probe, as far as there is room.
    let free = -Infinity;
    series.states.forEach((s, i) => {
      const isFirst = i === 0 || run.states[s].probe !== run.states[series.states[i - 1]].probe;
      if (!isFirst || px(s) < free) return;
      parts.push(text(px(s), bottom + 16, run.states[s].probe));
      free = px(s) + 24;
    });
  }
  const here = series.states.indexOf(shown);
  if (here >= 0) parts.push(`<line x1="${px(series.x[here])}" x2="${px(series.x[here])}" y1="${top}" y2="${bottom}" class="here"/>`);
  series.models.forEach((model, m) => {
    const points = model.values.map((y, i) => (Number.isFinite(y) ? `${px(series.x[i])},${py(y)}` : '')).join(' ');
    parts.push(`<polyline points="${points}" fill="none" stroke-width="2" stroke="${seriesColours[m % seriesColours.length]}"/>`);
  });
  series.measured.forEach((y, i) => parts.push(`<circle cx="${px(series.x[i])}" cy="${py(y)}" r="3.5" class="measured" data-state="${
    series.states[i]}"><title>probe ${titles[series.states[i]]}: ${y.toPrecision(3)} mm measured</title></circle>`));
  return parts.join('');
}

/// The chart below the body, of one marker: what it tells is redrawn with the state and the step that are shown.
class SeriesChart {
  /// `worst`: the marker to begin with; `choose(state)` shows a state.
  constructor(run, titles, worst, choose) {
    this.at = (id) => document.getElementById(id);
    Object.assign(this, {run, titles, shown: 0});
    const ids = [...new Set(run.steps[0].states.flatMap((s) => Array.from(s.markers.id)))].sort((a, b) => a - b);
    this.at('series').hidden = run.states.length < 2 || !ids.length;
    this.at('series-marker').replaceChildren(...ids.map((id) => new Option(id, id)));
    this.at('series-marker').value = worst;
    this.at('series-axis').replaceChildren(...['x', 'y', 'z', 'magnitude'].map((name, i) => new Option(name, i)));
    this.at('series-axis').value = 3;
    this.at('series-key').append(...run.steps.map((step, m) => {
      const key = document.createElement('span'), line = document.createElement('i');
      line.style.background = seriesColours[m % seriesColours.length];
      key.append(line, step.name);
      return key;
    }));
    for (const id of ['series-marker', 'series-axis']) this.at(id).addEventListener('change', () => this.show(this.shown));
    this.at('series-plot').addEventListener('click', (e) => { if (e.target.dataset?.state) choose(+e.target.dataset.state); });
  }
  chooseMarker(marker) {
    this.at('series-marker').value = marker;
    this.show(this.shown);
  }
  show(state) {
    this.shown = state;
    if (this.at('series').hidden) return;
    const marker = +this.at('series-marker').value, axis = +this.at('series-axis').value;
    const series = seriesOf(this.run, marker, axis, state);
    this.at('series-plot').innerHTML = seriesDrawing(series, this.run, this.titles, state);
    const here = series.states.indexOf(state), number = (v) => (Number.isFinite(v) ? `${+v.toPrecision(3)}\u00a0mm` : '–');
    this.at('series-plot').setAttribute('aria-label', `Motion of marker ${marker}, measured and by each model, over ${series.overTime ? 'time' : 'the probes'}`);
    this.at('series-told').textContent = here < 0 ? `Marker ${marker} was not read in probe ${this.titles[state]}.`
      : `Probe ${this.titles[state]}: measured ${number(series.measured[here])}; ${series.models.map((m) => `${m.name} ${number(m.values[here])}`).join(', ')}.`;
  }
}
