// Put at the end of a report by browser_test.py: uses the page as a reader would, and leaves what happened in the title.
(async () => {
  const failures = [], expect = (holds, what) => { if (!holds) failures.push(what); };
  const at = (id) => document.getElementById(id);
  // The page draws at once before it is printed, and after: no waiting for frames, which headless browsers skip; nor for
  // transitions, which a reader who wants little motion does not get.
  const drawn = () => { for (const when of ['beforeprint', 'afterprint']) dispatchEvent(new Event(when)); };
  const canvas = at('canvas'), picture = () => { drawn(); return canvas.toDataURL(); };
  const choose = (id, value, event) => {
    at(id)[at(id).type === 'checkbox' ? 'checked' : 'value'] = value;
    at(id).dispatchEvent(new Event(event, {bubbles: true}));
    drawn();
  };
  const press = (key, more = {}) => {
    canvas.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true, ...more}));
    drawn();
  };
  try {
    if (document.readyState !== 'complete') await new Promise((resolve) => addEventListener('load', resolve));
    expect(matchMedia('(prefers-reduced-motion: reduce)').matches, 'the browser is not asked for little motion');
    drawn();
    // something is drawn: neither white nor of one colour
    const flat = document.createElement('canvas');
    flat.width = canvas.width; flat.height = canvas.height;
    flat.getContext('2d').drawImage(canvas, 0, 0);
    const pixels = new Uint32Array(flat.getContext('2d').getImageData(0, 0, flat.width, flat.height).data.buffer);
    expect(new Set(pixels).size > 100, 'the view shows fewer than 100 colours');
    expect(pixels.filter((p) => p !== 0xffffffff).length > 0.02 * pixels.length, 'the view is almost empty');

    // first what is delivered, said where a print-out has it; what a run does not have is not offered
    const last = at('step').options.length - 1, isOffered = (id) => !at(id).closest('label').hidden;
    const isMarked = isOffered('show-markers'), error = isMarked ? /rms error .*\smm/ : /N measured/;
    expect(+at('step').value === last, 'the page does not open at the last step');
    expect(!at('told').closest('#controls'), 'a print-out has no caption');
    expect(error.test(at('told').textContent), 'the error is not told');
    expect(at('colour').options[0].text === (isMarked ? 'error [mm]' : 'displacement [mm]'), `the first colour is ${at('colour').options[0].text}`);
    for (const {text} of at('colour').options) expect(!/[*_]|sd.mean/.test(text), `${text} is no name for people`);
    expect(isMarked || at('series').hidden, 'there is a motion of markers without markers');
    // the key has a colour for each
    const keys = [...at('key').children].filter((item) => !item.hidden).map((item) => getComputedStyle(item.firstChild).backgroundColor);
    expect(keys.length > 1 && new Set(keys).size === keys.length, `the key has the colours ${keys.join(', ')}`);

    // a tool that is moved is said to be drawn, or not to be
    if (isOffered('show-tools')) {
      const key = at('key-tool').textContent, {tools} = JSON.parse(at('run-data').textContent);
      expect(tools.some((t) => t.patch) === /grips/.test(key), `the key says of grips: ${key}`);
      for (const tool of tools) expect(Boolean(tool.triangles_left_out) === new RegExp(`not drawn.*${tool.name}`).test(key), `the key says of ${tool.name}: ${key}`);
    }

    // every control changes the picture or says why not
    let before = picture();
    const changes = (what) => { const now = picture(); expect(now !== before, `${what} changes nothing`); before = now; };
    const other = at('state').value === '0' ? '1' : String(+at('state').value - 1), told = at('told').textContent;
    choose('state', other, 'change'); changes('another probe');
    expect(at('told').textContent !== told, 'the words stay the same for another probe');
    for (let i = 1; i < at('colour').options.length; ++i) { choose('colour', String(i), 'input'); }
    changes('colouring by stiffness');
    choose('colour', '0', 'input'); before = picture();
    expect(at('what').textContent.includes('['), 'the legend has no unit');
    for (const id of ['show-spheres', 'show-links', 'show-markers', 'show-tools'].filter(isOffered)) { choose(id, false, 'input'); changes(id); }
    choose('opacity', '1', 'input'); changes('the opacity of the skin');
    choose('magnify', '3', 'input');
    if (last > 0) {
      choose('step', '0', 'change');
      expect(at('told').textContent.includes('Model: nothing added'), 'the step is not told');
      expect(at('found').textContent.startsWith('Not in this model: '), 'what the step lacks is not told');
      choose('opacity', '0.35', 'input'); before = picture();
      const isDrawn = /Gravity/.test(at('found').textContent);  // what has no place is said alone
      if (isDrawn) expect(!at('key-found').hidden, 'the key says nothing of what was found');
      choose('show-findings', false, 'input');
      expect(at('key-found').hidden, 'the key names what is not drawn');
      expect(at('found').hidden, 'what was found cannot be hidden');
      if (isDrawn) changes('what was found, in the first step,');
      dispatchEvent(new Event('beforeprint'));
      expect(at('told').textContent.includes('Model: with'), 'another step than the last is printed');
      drawn();
      expect(at('told').textContent.includes('Model: nothing added'), 'printing changes the step');
      choose('step', String(last), 'change');
      expect(at('told').textContent.includes('Model: with'), 'the step is not told');
    }
    before = picture();
    press('ArrowLeft'); changes('an arrow key');
    press('+'); changes('plus');
    press('ArrowUp', {shiftKey: true}); changes('shift and an arrow key');
    const slider = at('frame').value;
    press('.'); expect(at('frame').value !== slider, 'a full stop goes to no other state');
    press(' '); expect(at('play').getAttribute('aria-pressed') === 'true', 'the space bar does not play');
    press(' ');
    // how a marker moves: along another axis the curve is another one, and a click shows a state
    const plot = at('series-plot'), curve = () => plot.querySelector('polyline').getAttribute('points');
    if (!at('series').hidden) {
      expect(plot.querySelectorAll('polyline').length === at('step').options.length, 'not each model has a curve');
      const inAll = curve();
      choose('series-axis', '2', 'change');
      expect(curve() !== inAll, 'the curve is the same along z as in magnitude');
      // a state in which the marker was not read has no point: which one is another state, the point itself says
      const shown = at('state').value, dot = [...plot.querySelectorAll('circle')].find((one) => one.dataset.state !== shown);
      expect(dot, 'no other state has a measured point');
      dot?.dispatchEvent(new MouseEvent('click', {bubbles: true}));
      drawn();
      expect(at('state').value === dot?.dataset.state, 'a click on a measured point does not show its state');
      expect(/measured .*\smm/.test(at('series-told').textContent), 'the motion is not told');
    }
    // any number's density can be chosen, as by the keys of a list
    const number = at('density-of');
    if (number) {
      number.selectedIndex = 1;
      number.dispatchEvent(new Event('input', {bubbles: true}));
      const name = number.value.replace(' ●', '');
      expect(at('density').querySelector('svg')?.getAttribute('aria-label').startsWith(`${name}: `), `the density of ${name} is not shown`);
    }
    // nothing sticks out, each control has a name, sections can be reached
    expect(document.documentElement.scrollWidth <= innerWidth, `the page is ${document.documentElement.scrollWidth} px wide in ${innerWidth}`);
    for (const control of document.querySelectorAll('select, input, button')) {
      expect(control.labels?.length || control.ariaLabel || control.getAttribute('aria-label') || control.textContent, `${control.id} has no name`);
    }
    for (const link of document.querySelectorAll('nav a')) expect(document.querySelector(link.getAttribute('href')), `${link.href} leads nowhere`);
  } catch (error) {
    failures.push(`${error}`);
  }
  document.title = `tested: ${failures.length ? failures.join('; ') : 'fine'}`;
})();
