// Put at the end of the page of a check of a set with tools by browser_test.py: leaves what happened in the title.
(async () => {
  const failures = [], expect = (holds, what) => { if (!holds) failures.push(what); };
  const at = (id) => document.getElementById(id);
  // The page draws at once before it is printed, and after: no waiting for frames, which headless browsers skip.
  const picture = () => { for (const when of ['beforeprint', 'afterprint']) dispatchEvent(new Event(when)); return at('canvas').toDataURL(); };
  const choose = (id, value, event) => {
    at(id)[at(id).type === 'checkbox' ? 'checked' : 'value'] = value;
    at(id).dispatchEvent(new Event(event, {bubbles: true}));
  };
  try {
    if (document.readyState !== 'complete') await new Promise((resolve) => addEventListener('load', resolve));
    const data = JSON.parse(at('check-data').textContent), last = data.states.length - 1;
    expect(data.tools.length > 0, 'the set has no tool');
    const key = at('key-tool').textContent;
    expect(!at('key-tool').hidden && data.tools.some((t) => t.patch) === /grips/.test(key), `the key says of tools: ${key}`);
    expect(at('key-marker').hidden === !data.markers.names.length, 'the key does not agree with the markers of the set');
    expect(at('key-force').hidden === !data.states.some((s) => s.loads.length), 'the key does not agree with the forces of the set');
    let before = picture();
    const changes = (what) => { const now = picture(); expect(now !== before, `${what} changes nothing`); before = now; };
    choose('state', String(last), 'change'); changes('another state');
    expect(/moved by/.test(at('told').textContent), `of a tool is told: ${at('told').textContent}`);
    choose('show-loads', false, 'input'); changes('hiding loads and tools');
    choose('show-all', true, 'input'); changes('loads of all states');
    for (const id of ['show-markers', 'show-positions'].filter(() => data.markers.names.length)) { choose(id, false, 'input'); changes(id); }
    expect(document.documentElement.scrollWidth <= innerWidth, `the page is ${document.documentElement.scrollWidth} px wide in ${innerWidth}`);
  } catch (error) {
    failures.push(`${error}`);
  }
  document.title = `tested: ${failures.length ? failures.join('; ') : 'fine'}`;
})();
