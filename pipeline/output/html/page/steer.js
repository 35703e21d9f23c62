// Mouse, touch and keyboard on the view.
'use strict';

/// Drag turns, shift or the right button or two fingers shift, wheel and pinch zoom. Where `does.grab` takes hold of
/// something, that pointer pulls at it until it lets go; keys that `does.key` knows are its own.
function steer(canvas, camera, does) {
  const pointers = new Map();
  let holds = null;  // the pointer that pulls
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, gap: Math.hypot(a.x - b.x, a.y - b.y)};
  };
  const place = (e) => ({x: e.offsetX, y: e.offsetY});
  canvas.addEventListener('pointerdown', (e) => {
    canvas.setPointerCapture(e.pointerId);
    const {x, y} = place(e);
    if (holds === null && pointers.size === 0 && !e.shiftKey && e.button === 0 && does.grab?.(x, y)) holds = e.pointerId;
    else pointers.set(e.pointerId, {x, y});
  });
  canvas.addEventListener('pointermove', (e) => {
    const last = pointers.get(e.pointerId), here = place(e), height = canvas.clientHeight;
    if (e.pointerId === holds) return does.pull(here.x, here.y);
    if (!last) return does.hint(here.x, here.y);
    const pinch = pointers.size === 2 ? spread() : null;
    pointers.set(e.pointerId, here);
    if (pinch) {
      const now = spread();
      camera.pan((now.x - pinch.x) / height, (now.y - pinch.y) / height);
      camera.zoom(pinch.gap / (now.gap || 1));
    } else if (e.shiftKey || e.buttons === 2) {
      camera.pan((here.x - last.x) / height, (here.y - last.y) / height);
    } else {
      camera.turn((here.x - last.x) / 150, (here.y - last.y) / 150);
    }
    does.draw();
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (e) => {
    pointers.delete(e.pointerId);
    if (e.pointerId === holds) { holds = null; does.letGo(); }
  });
  canvas.addEventListener('contextmenu', (e) => e.preventDefault());
  canvas.addEventListener('wheel', (e) => {
    if (document.activeElement !== canvas && !e.ctrlKey && !does.grab) return;  // the page scrolls until the view is chosen
    e.preventDefault();
    camera.zoom(Math.exp(e.deltaY / 600));
    does.draw();
  }, {passive: false});

  const turns = {ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.12], ArrowDown: [0, 0.12]};
  canvas.addEventListener('keydown', (e) => {
    const turn = turns[e.key];
    if (does.key?.(e)) return e.preventDefault();
    if (turn && e.shiftKey) camera.pan(turn[0] / 3, turn[1] / 3);
    else if (turn) camera.turn(...turn);
    else if (e.key === '+' || e.key === '=') camera.zoom(0.9);
    else if (e.key === '-') camera.zoom(1.1);
    else if (e.key === '0' || e.key === 'Home') camera.reset();
    else if (e.key === ',' || e.key === '.') does.move(e.key === '.' ? 1 : -1);
    else if (e.key === ' ') does.play();
    else return;
    e.preventDefault();
    does.draw();
  });
}

/// Tells what lies nearest to the pointer, of glyphs {at, text}, and gives it; null where nothing does.
function tellNearest(box, camera, glyphs, canvas, x, y) {
  let best = 14, found = null;  // pixels
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
