// The three-dimensional view: what is shown of a run, and the controls.
'use strict';

function startView() {
  const at = (id) => document.getElementById(id);
  const run = readRun(at('run-data').textContent);
  const rest = run.surface.points, body = rest.length ? rest : run.spheres.centers;
  const room = new Box().hold(body), size = room.size(), middle = room.middle(), reach = 0.25 * size;
  let scene;
  try {
    scene = new Scene(at('canvas'), run.surface.triangles);
  } catch (error) {
    at('canvas').hidden = at('controls').hidden = true;
    at('no-view').hidden = false;
    return;
  }

  // Errors of every step and state, once.
  for (const step of run.steps) {
    for (const state of step.states) {
      state.lengths = state.markers.id.map((_, i) => norm3(state.markers.error, i));
      Object.assign(state, errorsOf(state.markers));
    }
  }
  const every = (pick) => run.steps.flatMap((step) => step.states.flatMap(pick));
  const largest = (values) => values.reduce((a, b) => Math.max(a, b), 0);
  const lengths = (vectors) => Array.from({length: vectors.length / 3}, (_, i) => norm3(vectors, i));
  const furthest = largest([...every((s) => lengths(s.skin.length ? s.skin : s.spheres)), ...every((s) => lengths(s.markers.measured))]);
  const worst = largest(every((s) => s.lengths));
  const strongest = largest(run.states.flatMap((s) => s.loads.map((l) => Math.hypot(l[3], l[4], l[5]))));

  // What can be seen in colour: of the state, or of the links.
  const quantities = [
    {name: 'error [mm]', words: 'distance from model to measurement; between markers the mean of the nearest four, grey where none is near', scale: 'one'},
    {name: 'displacement [mm]', words: 'how far the model moves', scale: 'one'},
    ...run.steps[run.steps.length - 1].quantities.map((q) => ({name: q.name, links: true, logarithmic: true,
      words: q.name.includes('sd/mean') ? 'uncertainty of the links: standard deviation over mean' : 'stiffness of the links'})),
  ];
  const ofLinks = (step, quantity) => run.steps[step].quantities.find((q) => q.name === quantity.name)?.values ?? [];

  const count = run.states.length;
  const timed = run.states.some((s) => s.time !== 0), pressed = run.states.some((s) => s.loads.length);
  const force = (s) => +s.loads.reduce((sum, l) => sum + Math.hypot(l[3], l[4], l[5]), 0).toPrecision(3);
  const titles = run.states.map((s) => [`${s.probe}${timed ? ` at ${+s.time.toPrecision(4)} s` : ''}`,
    ...(pressed ? [s.loads.length ? `${force(s)} N` : 'no force'] : []), ...(s.held_out ? ['held out'] : [])].join(', '));
  const fill = (select, texts) => select.replaceChildren(...texts.map((t, i) => new Option(t, i)));
  fill(at('state'), titles);
  fill(at('step'), run.steps.map((s) => s.name));
  fill(at('colour'), quantities.map((q) => q.name));
  at('step-label').hidden = run.steps.length < 2;
  at('findings-label').hidden = !run.exchanged.length && !run.steps.some((s) => s.findings.length);
  at('measured-label').hidden = !run.states.some((s) => s.measured);
  at('frame').max = count * run.steps.length - 1;
  const round = (v) => +v.toPrecision(2);
  at('magnify').value = furthest > 0 && furthest < 0.03 * size ? round(0.1 * size / furthest) : 1;
  at('lengthen').value = worst > 0 ? Math.max(1, round(0.12 * size / worst)) : 1;
  // Loads sit on the body as it is bent: they move with the skin's vertex nearest to them.
  for (const state of run.states) {
    state.loads = state.loads.map((load) => Object.assign(load, {vertex: rest.length ? nearestVertex(rest, load) : -1}));
  }
  /// A load's arrow: it ends at the body where it pushes, and begins there where it pulls.
  const arrowOf = (load, skin, magnify) => {
    const [x, y, z, ...force] = load, moved = skin && skin.length && load.vertex >= 0 ? point3(skin, load.vertex) : [0, 0, 0];
    const length = 0.22 * size * Math.hypot(...force) / strongest, unit = force.map((f) => f / (Math.hypot(...force) || 1));
    const tip = [x, y, z].map((v, i) => v + (magnify ?? 0) * moved[i]), pushes = unit.reduce((sum, u, i) => sum + u * (tip[i] - middle[i]), 0) < 0;
    const other = tip.map((v, i) => v + (pushes ? -1 : 1) * length * unit[i]);
    return {start: pushes ? other : tip, end: pushes ? tip : other};
  };
  // The picture holds the body at rest and, as far as it is magnified now, all that it does.
  const box = new Box().hold(body), moves = +at('magnify').value;
  run.steps[0].states.forEach((answer, i) => run.states[i].loads.forEach((load) => {
    const {start, end} = arrowOf(load, answer.skin, moves);
    box.hold(start).hold(end);
  }));
  for (const step of run.steps) {
    step.found = findingGlyphs(step.findings, {middle, size, held: run.spheres.held,
      spheres: Array.from(run.spheres.radii, (_, i) => point3(run.spheres.centers, i))});
    for (const {glyph, shape} of step.found) if (shape !== 'tube') box.hold(glyph.start).hold(glyph.end);
  }
  box.hold(run.spheres.centers, null, 0, run.spheres.radii);
  run.states.forEach((s) => s.measured && box.hold(rest, s.measured, moves));
  run.steps[0].states.forEach((s) => { box.hold(rest, s.skin, moves); box.hold(run.spheres.centers, s.spheres, moves, run.spheres.radii); });
  const camera = new Camera(box, at('canvas').clientWidth / at('canvas').clientHeight || 1);

  // First the state that goes most wrong, which is what the page is about.
  const first = run.steps[0].states.reduce((best, s, i, all) => (s.rms > (all[best].rms || 0) ? i : best), 0);

  const farthest = run.steps[0].states[first];
  const worstMarker = farthest.markers.id[farthest.lengths.indexOf(largest(farthest.lengths))];
  const series = new SeriesChart(run, titles, worstMarker, (state) => show(shown.step, state));

  const isDark = matchMedia('(prefers-color-scheme: dark)');
  let onPaper = false;
  isDark.addEventListener('change', () => requestDraw());

  let shown = {step: 0, state: first}, before = shown, began = -1e9, playing = 0, drawn = {glyphs: []}, pointed = null;
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
  const transition = still ? 0 : 300;  // [ms]

  /// Vectors of a step and state on the way from the ones shown before.
  function between(pick, share) {
    const a = pick(run.steps[before.step].states[before.state]), b = pick(run.steps[shown.step].states[shown.state]);
    if (share >= 1 || a.length !== b.length) return b;
    return b.map((v, i) => (1 - share) * a[i] + share * v);
  }
  const added = (points, vectors, factor) => points.map((p, i) => p + factor * (vectors[i] || 0));
  const ball = (center, radius, colour) => ({
    start: [center[0], center[1], center[2] - radius], end: [center[0], center[1], center[2] + radius], radius, colour});

  function scaleOf(quantity) {
    const all = at('span').value === 'all', here = run.steps[shown.step].states[shown.state];
    if (quantity.links) {
      const steps = all ? run.steps.map((_, i) => i) : [shown.step];
      return new Scale(steps.flatMap((i) => Array.from(ofLinks(i, quantity))), true);
    }
    if (quantity.name.startsWith('error')) return new Scale(all ? [worst] : here.lengths, false);
    return new Scale(all ? [furthest] : lengths(here.skin.length ? here.skin : here.spheres), false);
  }

  /// Numbers of the state at the vertices of the skin, the spheres and the markers.
  function valuesOf(quantity, state) {
    if (!quantity.name.startsWith('error')) {
      return {skin: lengths(state.skin), spheres: lengths(state.spheres),
        markers: state.lengths.map((_, i) => Math.hypot(...[0, 1, 2].map((c) =>
          state.markers.measured[3 * i + c] - state.markers.error[3 * i + c])))};
    }
    const measured = run.states[shown.state].measured;
    state.onSkin ??= measured ? lengths(measured.map((v, i) => v - state.skin[i])) : spread(state.markers, state.lengths, rest, reach);
    state.onSpheres ??= spread(state.markers, state.lengths, run.spheres.centers, reach);
    return {skin: state.onSkin, spheres: state.onSpheres, markers: state.lengths};
  }

  function draw() {
    const share = transition ? Math.min(1, (performance.now() - began) / transition) : 1;
    const magnify = +at('magnify').value || 0, quantity = quantities[+at('colour').value], scale = scaleOf(quantity);
    const state = run.steps[shown.step].states[shown.state], now = run.states[shown.state], markers = state.markers;
    const values = quantity.links ? null : valuesOf(quantity, state);
    const area = at('canvas').getBoundingClientRect(), dots = Math.min(devicePixelRatio || 1, 2);
    const dark = isDark.matches && !onPaper, ink = dark ? [0.9, 0.92, 0.94] : measuredColour;
    scene.paper = dark ? [0.078, 0.094, 0.114] : [1, 1, 1];
    scene.begin(camera, Math.round(area.width * dots), Math.round(area.height * dots));

    const spheres = added(run.spheres.centers, between((s) => s.spheres, share), magnify);
    const skin = added(rest, between((s) => s.skin, share), magnify);
    drawn = {glyphs: []};
    if (at('show-links').checked) {
      const stiffness = quantity.links ? ofLinks(shown.step, quantity) : null;
      scene.glyphs('tube', Array.from({length: run.links.length / 2}, (_, l) => {
        const [a, b] = [run.links[2 * l], run.links[2 * l + 1]];
        const glyph = {start: point3(spheres, a), end: point3(spheres, b), radius: 0.005 * size,
          colour: scale.colour(stiffness ? stiffness[l] : values.spheres[a]),
          colourEnd: scale.colour(stiffness ? stiffness[l] : values.spheres[b])};
        if (stiffness) drawn.glyphs.push({at: glyph.start.map((v, i) => (v + glyph.end[i]) / 2), text: `link ${l}: ${(stiffness[l] ?? NaN).toPrecision(3)} (${quantity.name})`});
        return glyph;
      }));
    }
    if (at('show-markers').checked) {
      const modelled = Array.from(markers.rest, (r, i) => r + magnify * (markers.measured[i] - markers.error[i]));
      scene.glyphs('ball', markers.id.map((id, i) => {
        const place = point3(modelled, i);
        drawn.glyphs.push({at: place, marker: id, text: `marker ${id}: ${state.lengths[i].toPrecision(3)} mm off`});
        return ball(place, 0.009 * size, values ? scale.colour(values.markers[i]) : unknownColour);
      }));
    }
    if (at('show-errors').checked) {
      const lengthen = +at('lengthen').value || 0, arrows = [];
      markers.id.forEach((_, i) => {
        const error = between((s) => s.markers.error, share);
        const start = [0, 1, 2].map((c) => markers.rest[3 * i + c] + magnify * (markers.measured[3 * i + c] - markers.error[3 * i + c]));
        const end = start.map((v, c) => v + lengthen * error[3 * i + c]);
        const length = Math.hypot(...end.map((v, c) => v - start[c]));
        if (length > 0.004 * size) arrows.push({start, end, radius: Math.min(0.004 * size, 0.06 * length), colour: ink});
      });
      scene.glyphs('arrow', arrows);
    }
    if (at('show-positions').checked) {
      const measured = added(Array.from(markers.rest), markers.measured, magnify);
      scene.glyphs('ball', markers.id.map((id, i) => {
        drawn.glyphs.push({at: point3(measured, i), marker: id, text: `marker ${id}, as measured`});
        return ball(point3(measured, i), 0.0055 * size, ink);
      }));
    }
    if (at('show-findings').checked) drawFindings(now, markers, magnify);
    if (at('show-loads').checked) {
      const bent = between((s) => s.skin, share);
      scene.glyphs('arrow', now.loads.map((load) => ({...arrowOf(load, bent, magnify), radius: 0.009 * size, colour: loadColour})));
    }
    if (at('show-measured').checked && now.measured) scene.wires(added(rest, now.measured, magnify), wireColour);
    if (at('show-spheres').checked) {
      scene.glyphs('ball', Array.from(run.spheres.radii, (radius, i) => ball(point3(spheres, i), radius,
        run.spheres.held[i] ? loadColour : values ? scale.colour(values.spheres[i]) : unknownColour)), 0.22);
    }
    const colours = new Float32Array(rest.length);
    for (let v = 0; v < rest.length / 3; ++v) colours.set(values ? scale.colour(values.skin[v]) : unknownColour, 3 * v);
    scene.surface(skin, colours, +at('opacity').value);
    tell(quantity, scale, state);
    if (share < 1) requestDraw();
  }

  /// What was found by the step that is shown, and markers of this state that look swapped.
  function drawFindings(now, markers, magnify) {
    for (const {shape, glyph, opacity, text} of run.steps[shown.step].found) {
      scene.glyphs(shape, [glyph], opacity);
      if (text) drawn.glyphs.push({at: glyph.start.map((v, i) => (v + glyph.end[i]) / 2), text});
    }
    const here = (one) => one.probe === now.probe && Math.abs(one.time - now.time) < 1e-9;
    for (const pair of run.exchanged.filter(here)) {
      const places = pair.markers.map((id) => markers.id.indexOf(id)).filter((i) => i >= 0)
        .map((i) => [0, 1, 2].map((c) => markers.rest[3 * i + c] + magnify * markers.measured[3 * i + c]));
      if (places.length < 2) continue;
      scene.glyphs('tube', [{start: places[0], end: places[1], radius: 0.004 * size, colour: foundColour}]);
      drawn.glyphs.push({at: places[0].map((v, i) => (v + places[1][i]) / 2), text: `markers ${pair.markers.join(' and ')} look swapped`});
    }
  }

  function tell(quantity, scale, state) {
    const number = (v) => (Number.isFinite(v) ? `${+v.toPrecision(3)}` : '–');
    at('low').textContent = number(scale.low);
    at('high').textContent = number(scale.high);
    at('gradient').style.background = gradient;
    at('what').textContent = `${quantity.name}${quantity.logarithmic ? ', logarithmic' : ''}: ${quantity.words}`;
    const model = run.steps.length > 1 ? `Model: ${run.steps[shown.step].name}. ` : '';
    at('told').textContent = `${model}Probe ${titles[shown.state]}: rms error ${number(state.rms)} mm per coordinate, largest distance ${number(state.largest)} mm.`;
    const found = run.steps[shown.step].findings.map((f) => f.words);
    at('found').hidden = !found.length || !at('show-findings').checked;
    at('found').replaceChildren(document.createElement('i'), found.join(' '));
    at('frame').value = shown.step * count + shown.state;
    at('frame').setAttribute('aria-valuetext', at('told').textContent);
    at('state').value = shown.state;
    at('step').value = shown.step;
  }

  let asked = false;
  function requestDraw() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; draw(); });
  }
  function show(step, state) {
    before = shown;
    shown = {step, state};
    began = performance.now();
    series.show(state);
    requestDraw();
  }
  function goTo(frame) {
    const all = count * run.steps.length, f = ((frame % all) + all) % all;
    show(Math.floor(f / count), f % count);
  }
  const frame = () => shown.step * count + shown.state;
  function play(on) {
    clearInterval(playing);
    playing = on ? setInterval(() => goTo(frame() + 1), 900) : 0;
    at('play').textContent = on ? '⏸ Pause' : '▶ Play';
    at('play').setAttribute('aria-pressed', String(on));
  }

  at('controls').addEventListener('submit', (e) => e.preventDefault());
  at('controls').addEventListener('input', requestDraw);
  at('state').addEventListener('change', () => show(shown.step, +at('state').value));
  at('step').addEventListener('change', () => show(+at('step').value, shown.state));
  at('frame').addEventListener('input', () => goTo(+at('frame').value));
  at('play').addEventListener('click', () => play(!playing));
  steer(at('canvas'), camera, {draw: requestDraw, move: (by) => goTo(frame() + by), play: () => play(!playing),
    hint: (x, y) => { pointed = hint(at('hint'), camera, drawn.glyphs, at('canvas'), x, y); }});
  at('canvas').addEventListener('click', () => { if (pointed?.marker !== undefined) series.chooseMarker(pointed.marker); });
  new ResizeObserver(requestDraw).observe(at('canvas'));
  addEventListener('beforeprint', () => { onPaper = true; draw(); });
  addEventListener('afterprint', () => { onPaper = false; requestDraw(); });
  series.show(first);
  requestDraw();
}

/// Tells what lies nearest to the pointer, and gives it; null where nothing does.
function hint(box, camera, glyphs, canvas, x, y) {
  let best = 14, found = null;
  for (const glyph of glyphs) {
    const [px, py] = camera.project(glyph.at, canvas.clientWidth, canvas.clientHeight);
    const distance = Math.hypot(px - x, py - y);
    if (distance < best) { best = distance; found = glyph; }
  }
  box.hidden = !found;
  if (found) {
    box.textContent = found.text;
    box.style.left = `${Math.min(x + 12, canvas.clientWidth - 150)}px`;
    box.style.top = `${y + 12}px`;
  }
  return found;
}

document.addEventListener('DOMContentLoaded', startView);
