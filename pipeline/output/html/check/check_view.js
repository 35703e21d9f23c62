// The picture that a check opens with: mesh, supports, markers, loads.
'use strict';

const heldColour = [0.2, 0.55, 0.45], gripColour = [0.48, 0.37, 0.66], bodyColour = [0.72, 0.75, 0.78], toolColour = [0.16, 0.44, 0.59];

function readCheck(json) {
  const data = JSON.parse(json);
  for (const key of ['points', 'triangles']) data.surface[key] = decoded(data.surface[key]);
  data.markers.rest = decoded(data.markers.rest);
  data.tools = decodedTools(data.tools);
  // What is left free is drawn as it is at rest: before any fit nobody knows it.
  for (const tool of data.states.flatMap((s) => s.tools)) {
    for (const key of ['moved', 'turned']) tool[key] = tool[key].map((v) => v ?? 0);
    tool.at ??= plus3(data.tools.find((t) => t.name === tool.name).origin, tool.moved);
  }
  for (const state of data.states) state.moved = decoded(state.moved);
  return data;
}

function startCheck() {
  const at = (id) => document.getElementById(id);
  const data = readCheck(at('check-data').textContent);
  const points = data.surface.points, markers = data.markers, states = data.states;
  const room = new Box().hold(points), size = room.size(), middle = room.middle();
  let scene;
  try {
    scene = new Scene(at('canvas'), data.surface.triangles);
  } catch (error) {
    at('canvas').hidden = at('controls').hidden = true;
    at('no-view').hidden = false;
    return;
  }
  const body = {rest: points, middle, size}, still = new Float32Array(points.length);
  const tools = new Tools(scene, data, body), loads = new Loads(data, body, tools);
  const furthest = largestOf(states.map((s) => largestOf(Array.from({length: s.moved.length / 3}, (_, i) => norm3(s.moved, i) || 0))));

  const colours = ['supports', ...(data.parts.length ? ['how well its stiffness would be determined'] : []), 'one colour'];
  const fill = (select, texts) => select.replaceChildren(...texts.map((t, i) => new Option(t, i)));
  fill(at('colour'), colours);
  fill(at('state'), states.length ? states.map((s) => s.name) : ['at rest']);
  at('frame').max = Math.max(states.length - 1, 0);
  at('magnify').value = furthest > 0 && furthest < 0.03 * size ? +(0.1 * size / furthest).toPrecision(2) : 1;
  // What the set has none of is neither in the key nor to be chosen.
  const moves = furthest > 0, loaded = states.some((s) => s.loads.length || s.tools.length);
  at('key-held').hidden = !data.surface.held.length;
  at('key-force').hidden = !states.some((s) => s.loads.length);
  at('key-marker').hidden = at('offer-markers').hidden = !markers.names.length;
  at('offer-positions').hidden = !moves;
  at('of-motion').hidden = !moves && !data.tools.length;
  at('offer-loads').hidden = !loaded && !data.tendons.length;
  at('offer-all').hidden = !loaded || states.length < 2;
  at('steps').hidden = at('of-state').hidden = states.length < 2;
  at('key-grip').hidden = !data.surface.gripped.length;
  at('key-tool').hidden = !data.tools.length && !data.tendons.length;
  at('key-tool').lastChild.textContent = [...(data.tools.length ? [tools.words()] : []), ...(data.tendons.length ? ['tendon'] : [])].join('; ');
  at('key-odd').hidden = !markers.odd.length && !states.some((s) => s.odd.length);

  const box = new Box().hold(points).hold(markers.rest);
  for (const state of states) {
    const placed = loads.tools(state, still, +at('magnify').value);
    tools.hold(box, placed);
    box.hold(tools.gripped(placed));
    for (const {start, end} of loads.arrows(state, placed, still)) box.hold(start).hold(end);
  }
  const camera = new Camera(box, at('canvas').clientWidth / at('canvas').clientHeight || 1);

  const colourOfVertex = new Float32Array(points.length);
  function colourSkin() {
    const by = colours[+at('colour').value], sds = data.parts.map((p) => p.sd);
    const high = largestOf(sds) || 1;
    for (let v = 0; v < points.length / 3; ++v) {
      const part = data.surface.part[v];
      colourOfVertex.set(by === 'supports' ? bodyColour : by === 'one colour' || part === undefined ? unknownColour
        : colourOf(1 - sds[part] / high), 3 * v);
    }
    if (by === 'supports') {
      for (const v of data.surface.held) colourOfVertex.set(heldColour, 3 * v);
      for (const v of data.surface.gripped) colourOfVertex.set(gripColour, 3 * v);
    }
    at('legend').hidden = !by.startsWith('how');
    at('gradient').style.background = gradient;
    at('low').textContent = `not determined (sd of ln ${high.toPrecision(2)})`;
    at('high').textContent = 'well determined';
  }

  const isDark = matchMedia('(prefers-color-scheme: dark)');
  let onPaper = false, shown = Math.max(0, states.findIndex((s) => s.loads.length || s.tools.length)), playing = 0, drawn = {glyphs: []};
  isDark.addEventListener('change', () => requestDraw());

  function draw() {
    const area = at('canvas').getBoundingClientRect(), dots = Math.min(devicePixelRatio || 1, 2);
    const dark = isDark.matches && !onPaper, ink = dark ? [0.9, 0.92, 0.94] : measuredColour;
    scene.paper = dark ? [0.078, 0.094, 0.114] : [1, 1, 1];
    scene.begin(camera, Math.round(area.width * dots), Math.round(area.height * dots));
    drawn = {glyphs: []};
    const state = states[shown], magnify = +at('magnify').value || 0, count = markers.rest.length / 3;
    const radius = Math.min(0.009, 0.12 / Math.sqrt(count + 1)) * size;
    const isOdd = (m) => markers.odd.includes(m) || (state && state.odd.includes(m));
    if (at('show-markers').checked) {
      scene.glyphs('ball', Array.from({length: count}, (_, m) => ballAt(point3(markers.rest, m), isOdd(m) ? 1.7 * radius : radius, isOdd(m) ? foundColour : ink)));
    }
    for (let m = 0; m < count; ++m) drawn.glyphs.push({at: point3(markers.rest, m), text: `marker ${markers.names[m]}${isOdd(m) ? ', looks off' : ''}`});
    if (state && at('show-positions').checked) {
      const arrows = [], balls = [];
      for (let m = 0; m < count; ++m) {
        const moved = point3(state.moved, m);
        if (moved.some((v) => !Number.isFinite(v))) continue;
        const start = point3(markers.rest, m), end = start.map((v, i) => v + magnify * moved[i]);
        const length = Math.hypot(...moved) * magnify;
        if (length > 0.006 * size) arrows.push({start, end, radius: Math.min(0.35 * radius, 0.06 * length), colour: isOdd(m) ? foundColour : ink});
        else balls.push(ballAt(end, 0.6 * radius, ink));
      }
      scene.glyphs('arrow', arrows);
      scene.glyphs('ball', balls);
    }
    const all = at('show-all').checked;
    if (at('show-loads').checked || all) {
      for (const s of all ? states : state ? [state] : []) {
        const placed = loads.tools(s, still, magnify), skin = tools.gripped(placed);
        scene.glyphs('arrow', loads.arrows(s, placed, still).map((arrow) => ({...arrow, radius: 0.009 * size, colour: loadColour})));
        scene.glyphs('arrow', placed.flatMap((tool) => tools.motionArrows(tools.motion(tool, skin), toolColour)));
        drawn.glyphs.push(...s.loads.map(({place, force}) => ({at: place, text: `${length3(force).toPrecision(3)} N, ${s.name}`})),
          ...placed.map((t) => ({at: t.place, text: `${t.name} moved by ${short(length3(t.moved))} mm, ${s.name}`})));
      }
      scene.glyphs('tube', data.tendons.flatMap((path) => path.slice(1).map((end, i) => ({start: path[i], end, radius: 0.005 * size, colour: toolColour}))));
    }
    if (at('show-edges').checked) scene.wires(points, wireColour);
    scene.surface(points, colourOfVertex, +at('opacity').value);
    if (state && (at('show-loads').checked || all)) {
      const placed = loads.tools(state, still, magnify);
      tools.draw(placed, tools.gripped(placed), toolColour);
    }
    at('told').textContent = state ? `${state.name}: ${state.words}` : 'The body at rest.';
    at('frame').value = at('state').value = shown;
  }
  let asked = false;
  function requestDraw() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; draw(); });
  }
  const show = (s) => { const n = Math.max(states.length, 1); shown = ((s % n) + n) % n; requestDraw(); };
  function play(on) {
    clearInterval(playing);
    playing = on ? setInterval(() => show(shown + 1), 900) : 0;
    at('play').textContent = on ? '⏸ Pause' : '▶ Play';
    at('play').setAttribute('aria-pressed', String(on));
  }
  at('controls').addEventListener('submit', (e) => e.preventDefault());
  at('controls').addEventListener('input', () => { colourSkin(); requestDraw(); });
  at('state').addEventListener('change', () => show(+at('state').value));
  at('frame').addEventListener('input', () => show(+at('frame').value));
  at('play').addEventListener('click', () => play(!playing));
  steer(at('canvas'), camera, {draw: requestDraw, move: (by) => show(shown + by), play: () => play(!playing),
    hint: (x, y) => tellNearest(at('hint'), camera, drawn.glyphs, at('canvas'), x, y)});
  new ResizeObserver(requestDraw).observe(at('canvas'));
  addEventListener('beforeprint', () => { onPaper = true; draw(); });
  addEventListener('afterprint', () => { onPaper = false; draw(); });
  colourSkin();
  requestDraw();
}

document.addEventListener('DOMContentLoaded', startCheck);
