// The three-dimensional view: what is shown of a run, and the controls.
'use strict';

function startView() {
  const at = (id) => document.getElementById(id);
  const run = readRun(at('run-data').textContent);
  const rest = run.surface.points, room = new Box().hold(rest.length ? rest : run.spheres.centers);
  const body = {rest, middle: room.middle(), size: room.size()};
  let scene;
  try {
    scene = new Scene(at('canvas'), run.surface.triangles);
  } catch (error) {
    for (const id of ['canvas', 'controls', 'told', 'key']) at(id).hidden = true;
    at('no-view').hidden = false;
    return;
  }
  const count = run.states.length, last = run.steps.length - 1, titles = titlesOf(run.states);
  const quantities = new Quantities(run, body), tools = new Tools(scene, run, body), loads = new Loads(run, body, tools);
  const allTools = run.states.flatMap((s) => s.tools), {isMarked, furthest} = quantities;

  const fill = (select, texts) => select.replaceChildren(...texts.map((t, i) => new Option(t, i)));
  fill(at('state'), titles);
  fill(at('step'), run.steps.map((s) => s.name));
  fill(at('colour'), quantities.list.map(withUnit));
  at('step-label').hidden = run.steps.length < 2;
  // What a run does not have, it does not offer.
  const has = {markers: isMarked, errors: isMarked, positions: isMarked, lengthen: isMarked,
    loads: loads.felt.length || loads.hasForces, tools: run.tools.some((t) => t.triangles_left_out) || allTools.some((t) => tools.isDrawn(t)),
    findings: run.exchanged.length || run.steps[last].findings.length, measured: run.states.some((s) => s.measured)};
  for (const [name, there] of Object.entries(has)) at(`${name}-label`).hidden = !there;
  const isOn = (name) => (has[name] ?? true) && at(`show-${name}`).checked;
  if (!loads.hasForces) at('key-load').lastChild.textContent = 'force of the tool, as measured';
  at('key-tool').lastChild.textContent = tools.words();
  if (run.steps[last].findings.some((f) => f.undetermined?.length))
    at('key-found').lastChild.textContent = 'found to be missing; dashed: not determined along that line, ± one standard deviation';
  at('frame').max = count * run.steps.length - 1;
  // Tools are as large as they are: what they press in is drawn so, too.
  const isPressed = allTools.some((t) => tools.isSolid(t));
  at('magnify').value = !isPressed && furthest > 0 && furthest < 0.03 * body.size ? +(0.1 * body.size / furthest).toPrecision(2) : 1;
  at('lengthen').value = 1;

  const drawing = new Drawing(scene, run, body, loads, tools, isOn);
  const camera = new Camera(drawing.box(+at('magnify').value), at('canvas').clientWidth / at('canvas').clientHeight || 1);

  // First the state that goes most wrong with nothing added: there it shows what was added. Where forces alone were
  // read, the one with the largest.
  const most = (values) => Math.max(values.indexOf(largestOf(values)), 0);
  const first = most(isMarked ? run.steps[0].states.map((s) => s.rms || 0)
    : loads.felt.length ? run.states.map((s) => largestOf(s.tools.filter((t) => t.measured).map(measuredForce)))
      : run.steps[last].states.map((s) => largestOf(quantities.moved(s))));
  const {markers: read, lengths: off} = run.steps[0].states[first];
  const series = new SeriesChart(run, titles, read.id[most(off)], (state) => show(shown.step, state));

  const isDark = matchMedia('(prefers-color-scheme: dark)');
  let onPaper = false;
  isDark.addEventListener('change', () => requestDraw());

  // The step that is delivered comes first, and is printed.
  let shown = {step: last, state: first}, before = shown, began = -1e9, playing = 0, told = [], pointed = null;
  const stepNow = () => (onPaper ? last : shown.step);
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
  const transition = still ? 0 : 300;  // [ms]

  /// Vectors of a step and state on the way from the ones shown before.
  function between(pick, share) {
    const a = pick(run.steps[before.step].states[before.state]), b = pick(run.steps[stepNow()].states[shown.state]);
    if (share >= 1 || a.length !== b.length) return b;
    return b.map((v, i) => (1 - share) * a[i] + share * v);
  }
  function draw() {
    const share = transition && !onPaper ? Math.min(1, (performance.now() - began) / transition) : 1;
    const step = stepNow(), answer = run.steps[step].states[shown.state], now = run.states[shown.state];
    const quantity = quantities.list[+at('colour').value], scale = quantities.scale(quantity, step, answer, at('span').value === 'all');
    const area = at('canvas').getBoundingClientRect(), dots = Math.min(devicePixelRatio || 1, 2);
    const dark = isDark.matches && !onPaper, colour = viewColours(dark);
    scene.paper = dark ? [0.078, 0.094, 0.114] : [1, 1, 1];
    scene.begin(camera, Math.round(area.width * dots), Math.round(area.height * dots));
    told = drawing.draw({step, now, answer, quantity, scale, values: quantities.values(quantity, shown.state, answer),
      stiffness: quantity.links ? quantities.ofLinks(step, quantity) : null, skin: between((s) => s.skin, share),
      spheres: between((s) => s.spheres, share), error: between((s) => s.markers.error, share)},
    {colour, magnify: +at('magnify').value || 0, lengthen: +at('lengthen').value || 0, opacity: +at('opacity').value});
    tell(quantity, scale, answer);
    tellColours(now, colour);
    if (share < 1) requestDraw();
  }

  function tell(quantity, scale, answer) {
    at('low').textContent = short(scale.low);
    at('high').textContent = short(scale.high);
    at('gradient').style.background = gradient;
    at('what').textContent = `${withUnit(quantity)}${quantity.logarithmic ? ', logarithmic' : ''}: ${quantity.words}`;
    const step = run.steps[stepNow()], now = run.states[shown.state];
    const overall = isMarked || !Number.isFinite(step.forces_rms) ? '' : ` Over all states the rms error of the tools' forces is ${short(step.forces_rms)} N.`;
    at('told').textContent = `${last > 0 ? `Model: ${step.name}. ` : ''}Probe ${titles[shown.state]}: ${errorWords(now, answer)}.${overall}`;
    const words = run.steps[last].findings.map((f) => `${drawing.has(stepNow(), f.effect) ? '' : 'Not in this model: '}${f.words}`);
    at('found').hidden = !words.length || !isOn('findings');
    at('found').textContent = words.join(' ');
    at('frame').value = shown.step * count + shown.state;
    at('frame').setAttribute('aria-valuetext', at('told').textContent);
    at('state').value = shown.state;
    at('step').value = shown.step;
  }
  /// The key: what is drawn now, each in its colour.
  function tellColours(now, colour) {
    for (const [name, rgb] of Object.entries(colour)) at('view').style.setProperty(`--${name}`, `rgb(${rgb.map((c) => Math.round(255 * c))})`);
    const there = {measured: isOn('positions'), error: isOn('errors'), load: isOn('loads'), tool: isOn('tools'),
      held: run.spheres.held.some(Boolean) && isOn('spheres'), shape: now.measured && isOn('measured'), found: isOn('findings') && drawing.drawsFindings(now),
      softer: isOn('findings') && run.steps[last].findings.some(isSofter)};
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
    hint: (x, y) => { pointed = tellNearest(at('hint'), camera, told, at('canvas'), x, y); }});
  at('canvas').addEventListener('click', () => { if (pointed?.marker !== undefined) series.chooseMarker(pointed.marker); });
  new ResizeObserver(requestDraw).observe(at('canvas'));
  addEventListener('beforeprint', () => { onPaper = true; draw(); });
  addEventListener('afterprint', () => { onPaper = false; draw(); });
  series.show(first);
  requestDraw();
}

document.addEventListener('DOMContentLoaded', startView);
