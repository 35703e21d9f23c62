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
    for (const id of ['canvas', 'controls', 'told', 'key']) at(id).hidden = true;
    at('no-view').hidden = false;
    return;
  }

  // Errors of every step and state, once. Where forces alone were read, no marker has any.
  const last = run.steps.length - 1, isMarked = run.steps.some((step) => step.states.some((s) => s.markers.id.length));
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
  const allTools = run.states.flatMap((s) => s.tools), felt = allTools.filter((t) => t.measured);
  const strongest = largest([...run.states.flatMap((s) => s.loads.map((l) => Math.hypot(l[3], l[4], l[5]))), ...felt.map(measuredForce)]) || 1;

  // What can be seen in colour: of the state, or of the links.
  const quantities = [
    ...(isMarked ? [{name: 'error', unit: 'mm', ofMarkers: true, words: 'distance from model to measurement; between markers the mean of the nearest four, grey where none is near'}] : []),
    {name: 'displacement', unit: 'mm', words: 'how far the model moves'},
    ...run.steps[last].quantities.map((q) => ({name: q.name, unit: q.unit, links: true, logarithmic: true,
      words: q.relative ? 'uncertainty of the links, standard deviation over mean' : 'of the links'})),
  ];
  const withUnit = (q) => `${q.name}${q.unit ? ` [${q.unit}]` : ''}`;
  const ofLinks = (step, quantity) => run.steps[step].quantities.find((q) => q.name === quantity.name)?.values ?? [];

  const count = run.states.length;
  const titles = titlesOf(run.states);
  const fill = (select, texts) => select.replaceChildren(...texts.map((t, i) => new Option(t, i)));
  fill(at('state'), titles);
  fill(at('step'), run.steps.map((s) => s.name));
  fill(at('colour'), quantities.map(withUnit));
  at('step-label').hidden = run.steps.length < 2;
  // What a run does not have, it does not offer.
  const has = {markers: isMarked, errors: isMarked, positions: isMarked, lengthen: isMarked,
    loads: felt.length || run.states.some((s) => s.loads.length), tools: allTools.some((t) => t.at && t.radius),
    findings: run.exchanged.length || run.steps[last].findings.length, measured: run.states.some((s) => s.measured)};
  for (const [name, there] of Object.entries(has)) at(`${name}-label`).hidden = !there;
  if (!run.states.some((s) => s.loads.length)) at('key-load').lastChild.textContent = 'force of the tool, as measured';
  at('frame').max = count * run.steps.length - 1;
  // Tools are as large as they are: what they press in is drawn so, too.
  at('magnify').value = !has.tools && furthest > 0 && furthest < 0.03 * size ? +(0.1 * size / furthest).toPrecision(2) : 1;
  at('lengthen').value = 1;

  /// Does a force push the body there, rather than pull at it? By the body at rest: the answer stays, however it bends.
  const pushes = (force, place, vertex) => {
    const outward = vertex >= 0 ? outwardAt(rest, run.surface.triangles, vertex) : place.map((v, i) => v - middle[i]);
    return force.reduce((sum, f, i) => sum + f * outward[i], 0) < 0;
  };
  const vertexAt = (place) => (rest.length ? nearestVertex(rest, place) : -1);
  for (const state of run.states) {
    state.loads = state.loads.map(([x, y, z, ...force]) => {
      const place = [x, y, z], vertex = vertexAt(place);
      return {place, force, vertex, pushes: pushes(force, place, vertex)};
    });
    for (const tool of state.tools) {
      tool.force = tool.measured?.map((f) => f ?? 0);
      tool.pushes = tool.at && tool.force && pushes(tool.force, tool.at, vertexAt(tool.at));
    }
  }
  /// A force's arrow: it ends at the body where it pushes, and begins there where it pulls.
  const arrowOf = (tip, {force, pushes}) => {
    const length = 0.22 * size * Math.hypot(...force) / strongest, unit = force.map((f) => f / (Math.hypot(...force) || 1));
    const other = tip.map((v, i) => v + (pushes ? -1 : 1) * length * unit[i]);
    return {start: pushes ? other : tip, end: pushes ? tip : other};
  };
  /// Of a load, which sits on the body as it is bent: it moves with the skin's vertex nearest to it.
  const loadArrow = (load, skin, magnify) => {
    const moved = skin && skin.length && load.vertex >= 0 ? point3(skin, load.vertex) : [0, 0, 0];
    return arrowOf(load.place.map((v, i) => v + (magnify ?? 0) * moved[i]), load);
  };
  /// Where a tool is: as far as displacements are magnified, it goes with the skin that it touches.
  const placeOf = (tool, skin, magnify) => {
    if (magnify === 1 || !rest.length) return tool.at;
    const moved = point3(skin, nearestVertex(rest.map((p, i) => p + skin[i]), tool.at));
    return tool.at.map((v, i) => v + (magnify - 1) * moved[i]);
  };
  /// Of a tool's force: a ball presses where it reaches furthest.
  const toolArrow = (tool, place) => {
    const reach = tool.axis ? 0 : (tool.radius ?? 0) / (Math.hypot(...tool.force) || 1);
    return arrowOf(place.map((v, i) => v + reach * tool.force[i]), tool);
  };
  // The picture holds the body at rest and, as far as it is magnified now, all that it does.
  const box = new Box().hold(body), moves = +at('magnify').value;
  run.steps[last].states.forEach((answer, i) => {
    const arrows = run.states[i].loads.map((load) => loadArrow(load, answer.skin, moves));
    for (const tool of run.states[i].tools.filter((t) => t.at)) {
      const place = placeOf(tool, answer.skin, moves);
      for (const side of [-1, 1]) box.hold(place.map((v) => v + side * (tool.radius ?? 0)));
      if (tool.force) arrows.push(toolArrow(tool, place));
    }
    for (const {start, end} of arrows) box.hold(start).hold(end);
  });
  // What was found is drawn in every step: faintly where the step does not have it yet.
  const found = run.steps[last].findings.flatMap((finding) => findingGlyphs([finding], {middle, size, held: run.spheres.held,
    spheres: Array.from(run.spheres.radii, (_, i) => point3(run.spheres.centers, i))}).map((one) => ({...one, effect: finding.effect})));
  for (const {glyph, shape} of found) if (shape !== 'tube') box.hold(glyph.start).hold(glyph.end);
  box.hold(run.spheres.centers, null, 0, run.spheres.radii);
  run.states.forEach((s) => s.measured && box.hold(rest, s.measured, moves));
  run.steps[last].states.forEach((s) => { box.hold(rest, s.skin, moves); box.hold(run.spheres.centers, s.spheres, moves, run.spheres.radii); });
  const camera = new Camera(box, at('canvas').clientWidth / at('canvas').clientHeight || 1);

  // First the state that goes most wrong with nothing added: there it shows what was added. Where forces alone were
  // read, the one with the largest.
  const most = (values) => Math.max(values.indexOf(largest(values)), 0);
  const first = most(isMarked ? run.steps[0].states.map((s) => s.rms || 0)
    : felt.length ? run.states.map((s) => largest(s.tools.filter((t) => t.measured).map(measuredForce)))
      : run.steps[last].states.map((s) => largest(lengths(s.skin.length ? s.skin : s.spheres))));
  const {markers: read, lengths: off} = run.steps[0].states[first];
  const series = new SeriesChart(run, titles, read.id[most(off)], (state) => show(shown.step, state));

  const isDark = matchMedia('(prefers-color-scheme: dark)');
  let onPaper = false;
  isDark.addEventListener('change', () => requestDraw());

  // The step that is delivered comes first, and is printed.
  let shown = {step: last, state: first}, before = shown, began = -1e9, playing = 0, drawn = {glyphs: []}, pointed = null;
  const stepNow = () => (onPaper ? last : shown.step);
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
  const transition = still ? 0 : 300;  // [ms]

  /// Vectors of a step and state on the way from the ones shown before.
  function between(pick, share) {
    const a = pick(run.steps[before.step].states[before.state]), b = pick(run.steps[stepNow()].states[shown.state]);
    if (share >= 1 || a.length !== b.length) return b;
    return b.map((v, i) => (1 - share) * a[i] + share * v);
  }
  const added = (points, vectors, factor) => points.map((p, i) => p + factor * (vectors[i] || 0));
  const ball = (center, radius, colour) => ({
    start: [center[0], center[1], center[2] - radius], end: [center[0], center[1], center[2] + radius], radius, colour});

  function scaleOf(quantity) {
    const all = at('span').value === 'all', here = run.steps[stepNow()].states[shown.state];
    if (quantity.links) {
      const steps = all ? run.steps.map((_, i) => i) : [stepNow()];
      return new Scale(steps.flatMap((i) => Array.from(ofLinks(i, quantity))), true);
    }
    if (quantity.ofMarkers) return new Scale(all ? [worst] : here.lengths, false);
    return new Scale(all ? [furthest] : lengths(here.skin.length ? here.skin : here.spheres), false);
  }

  /// Numbers of the state at the vertices of the skin, the spheres and the markers.
  function valuesOf(quantity, state) {
    if (!quantity.ofMarkers) {
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
    const share = transition && !onPaper ? Math.min(1, (performance.now() - began) / transition) : 1;
    const magnify = +at('magnify').value || 0, quantity = quantities[+at('colour').value], scale = scaleOf(quantity);
    const state = run.steps[stepNow()].states[shown.state], now = run.states[shown.state], markers = state.markers;
    const values = quantity.links ? null : valuesOf(quantity, state);
    const area = at('canvas').getBoundingClientRect(), dots = Math.min(devicePixelRatio || 1, 2);
    const dark = isDark.matches && !onPaper, colour = viewColours(dark);
    scene.paper = dark ? [0.078, 0.094, 0.114] : [1, 1, 1];
    scene.begin(camera, Math.round(area.width * dots), Math.round(area.height * dots));

    const spheres = added(run.spheres.centers, between((s) => s.spheres, share), magnify);
    const bent = between((s) => s.skin, share), skin = added(rest, bent, magnify);
    drawn = {glyphs: []};
    if (at('show-links').checked) {
      const stiffness = quantity.links ? ofLinks(stepNow(), quantity) : null;
      scene.glyphs('tube', Array.from({length: run.links.length / 2}, (_, l) => {
        const [a, b] = [run.links[2 * l], run.links[2 * l + 1]];
        const glyph = {start: point3(spheres, a), end: point3(spheres, b), radius: 0.005 * size,
          colour: scale.colour(stiffness ? stiffness[l] : values.spheres[a]),
          colourEnd: scale.colour(stiffness ? stiffness[l] : values.spheres[b])};
        if (stiffness) drawn.glyphs.push({at: glyph.start.map((v, i) => (v + glyph.end[i]) / 2), text: `link ${l}: ${quantity.name} ${short(stiffness[l])} ${quantity.unit}`});
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
    const isPlaced = at('show-positions').checked, dot = 0.0105 * size;
    if (at('show-errors').checked) {
      const lengthen = (magnify || 1) * (+at('lengthen').value || 0), arrows = [], error = between((s) => s.markers.error, share);
      markers.id.forEach((_, i) => {
        const start = [0, 1, 2].map((c) => markers.rest[3 * i + c] + magnify * (markers.measured[3 * i + c] - markers.error[3 * i + c]));
        const whole = lengthen * norm3(error, i), length = whole > 2 * dot && isPlaced ? whole - dot : whole;  // up to the dot
        const end = start.map((v, c) => v + length / (whole || 1) * lengthen * error[3 * i + c]);
        if (length > 0.004 * size) arrows.push({start, end, radius: Math.min(0.004 * size, 0.06 * length), colour: colour.error});
      });
      scene.glyphs('arrow', arrows);
    }
    if (isPlaced) {
      const measured = added(Array.from(markers.rest), markers.measured, magnify);
      scene.glyphs('ball', markers.id.map((id, i) => {
        drawn.glyphs.push({at: point3(measured, i), marker: id, text: `marker ${id}, as measured`});
        return ball(point3(measured, i), dot, colour.measured);
      }));
    }
    const tools = now.tools.filter((t) => t.at).map((tool) => ({...tool, place: placeOf(tool, bent, magnify)}));
    if (at('show-loads').checked) drawLoads(now, tools, bent, magnify, colour.load);
    if (at('show-measured').checked && now.measured) scene.wires(added(rest, now.measured, magnify), colour.shape);
    if (at('show-spheres').checked) {
      for (const held of [0, 1]) {
        const ones = Array.from(run.spheres.radii, (_, i) => i).filter((i) => Boolean(run.spheres.held[i]) === Boolean(held));
        scene.glyphs('ball', ones.map((i) => ball(point3(spheres, i), run.spheres.radii[i],
          held ? colour.held : values ? scale.colour(values.spheres[i]) : unknownColour)), held ? 0.65 : 0.22);
      }
    }
    if (at('show-findings').checked) drawFindings(now, markers, magnify);
    const colours = new Float32Array(rest.length);
    for (let v = 0; v < rest.length / 3; ++v) colours.set(values ? scale.colour(values.skin[v]) : unknownColour, 3 * v);
    scene.surface(skin, colours, +at('opacity').value);
    if (at('show-tools').checked) drawTools(tools, colour.tool);
    tell(quantity, scale, state);
    tellColours(now, colour);
    if (share < 1) requestDraw();
  }

  /// Forces, those of tools as they were measured.
  function drawLoads(now, tools, skin, magnify, colour) {
    const arrows = [...now.loads.map((load) => loadArrow(load, skin, magnify)), ...tools.filter((t) => t.force).map((t) => toolArrow(t, t.place))];
    scene.glyphs('arrow', arrows.map((arrow) => ({...arrow, radius: 0.009 * size, colour})));
  }
  function drawTools(tools, colour) {
    for (const {name, place, radius, axis} of tools.filter((t) => t.radius)) {
      drawn.glyphs.push({at: place, text: name});
      if (axis) scene.glyphs('tube', [{start: place, end: place.map((v, i) => v - 0.03 * size * axis[i]), radius, colour}], 0.5);
      else scene.glyphs('ball', [ball(place, radius, colour)], 0.5);
    }
  }

  /// Does the step that is shown have an effect in it?
  const isKnown = (effect) => run.steps[stepNow()].findings.some((f) => f.effect === effect);
  /// What was found to be missing, and markers of this state that look swapped.
  function drawFindings(now, markers, magnify) {
    for (const {shape, glyph, opacity, text, effect} of found) {
      scene.glyphs(shape, [glyph], (isKnown(effect) ? 1 : 0.45) * opacity);
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
    at('low').textContent = short(scale.low);
    at('high').textContent = short(scale.high);
    at('gradient').style.background = gradient;
    at('what').textContent = `${withUnit(quantity)}${quantity.logarithmic ? ', logarithmic' : ''}: ${quantity.words}`;
    const step = run.steps[stepNow()], now = run.states[shown.state];
    const overall = isMarked || !Number.isFinite(step.forces_rms) ? '' : ` Over all states the rms error of the tools' forces is ${short(step.forces_rms)} N.`;
    at('told').textContent = `${last > 0 ? `Model: ${step.name}. ` : ''}Probe ${titles[shown.state]}: ${errorWords(now, state)}.${overall}`;
    const words = run.steps[last].findings.map((f) => `${isKnown(f.effect) ? '' : 'Not in this model: '}${f.words}`);
    at('found').hidden = !words.length || !at('show-findings').checked;
    at('found').textContent = words.join(' ');
    at('frame').value = shown.step * count + shown.state;
    at('frame').setAttribute('aria-valuetext', at('told').textContent);
    at('state').value = shown.state;
    at('step').value = shown.step;
  }

  /// The key: what is drawn now, each in its colour.
  function tellColours(now, colour) {
    for (const [name, rgb] of Object.entries(colour)) at('view').style.setProperty(`--${name}`, `rgb(${rgb.map((c) => Math.round(255 * c))})`);
    const isOn = (name) => has[name] && at(`show-${name}`).checked;
    const there = {measured: isOn('positions'), error: isOn('errors'), load: isOn('loads'), tool: isOn('tools'),
      held: run.spheres.held.some(Boolean) && at('show-spheres').checked, shape: now.measured && isOn('measured'), found: isOn('findings')};
    for (const [name, is] of Object.entries(there)) at(`key-${name}`).hidden = !is;
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
  addEventListener('afterprint', () => { onPaper = false; draw(); });
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
