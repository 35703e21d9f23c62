// What is chosen on a body: where it is held, where it is pressed, where it is read; and the files that say so.
'use strict';

const inCommas = (a) => a.map((v) => String(+v.toPrecision(6))).join(', ');

class Setup {
  /// `data`: as pick_page.cpp writes it; `points`, `triangles`: of its surface [mm].
  constructor(data, points, triangles) {
    Object.assign(this, {data, points, triangles});
    const all = new Box().hold(points);
    this.low = all.low;
    this.high = all.high;
    this.size = Math.max(...this.high.map((h, c) => h - this.low[c]));
    this.supports = data.supports.map((s) => structuredClone(s));
    this.given = this.supports.length;  // the first of them, which are not undone
    this.probes = [];
    this.markers = [];
    this.order = [];  // lists, in the order in which something came into them
  }
  /// Of a set, whose states and markers stay.
  get addsToSet() { return this.data.kind === 'set'; }

  add(list, one) {
    this[list].push(one);
    this.order.push(list);
  }
  remove(list, i) {
    this[list].splice(i, 1);
    if (list === 'supports' && i < this.given) return void --this.given;
    const last = this.order.lastIndexOf(list);
    if (last >= 0) this.order.splice(last, 1);
  }
  undo() {
    const list = this.order.at(-1);
    if (list) this.remove(list, this[list].length - 1);
  }
  addBall(center, radius) { this.add('supports', {sphere: {center, radius}}); }
  /// Everything from the point on to the nearer end of the body along an axis (0, 1, 2).
  addEnd(point, axis) {
    const room = 0.02 * this.size, min = this.low.map((v) => v - room), max = this.high.map((v) => v + room);
    const length = this.high[axis] - this.low[axis], isLow = point[axis] - this.low[axis] < 0.5 * length;
    // A point on the very end holds the twentieth of the length that a bare mesh is held by.
    const depth = Math.max(isLow ? point[axis] - this.low[axis] : this.high[axis] - point[axis], 0.05 * length);
    if (isLow) max[axis] = this.low[axis] + depth;
    else min[axis] = this.high[axis] - depth;
    this.add('supports', {box: {min, max}});
  }
  addProbe(at, force, radius) { this.add('probes', {at, force, radius}); }
  addMarker(at) {
    const taken = new Set([...this.data.markers, ...this.markers].map((m) => m.name));
    let number = 1;
    while (taken.has(`m${number}`)) ++number;
    this.add('markers', {name: `m${number}`, at});
  }
  /// So many markers over what is free, each as far as possible from those that are there.
  spreadMarkers(count) {
    const free = [...this.points.keys()].filter((i) => i % 3 === 0 && !this.holds(row3(this.points, i / 3)));
    const nearest = free.map((i) => [...this.data.markers, ...this.markers].reduce(
      (least, m) => Math.min(least, length3(minus3(row3(this.points, i / 3), m.at))), Infinity));
    for (let n = 0; n < count && n < free.length; ++n) {
      const best = nearest.reduce((b, d, i) => d > nearest[b] ? i : b, 0);
      if (!(nearest[best] > 0)) return;
      const at = row3(this.points, free[best] / 3);
      this.addMarker(at);
      free.forEach((i, k) => { nearest[k] = Math.min(nearest[k], length3(minus3(row3(this.points, i / 3), at))); });
    }
  }

  /// Is a point held by a support that the page knows the shape of?
  holds(x) {
    return this.supports.some(({box, sphere, plane}) => {
      if (sphere) return length3(minus3(x, sphere.center)) <= sphere.radius;
      if (box) return x.every((v, c) => v >= box.min[c] && v <= box.max[c]);
      return plane && Math.abs(dot3(minus3(x, plane.point), unit3(plane.normal))) <= plane.within;
    });
  }
  /// Share of the surface's area that is held, by the middles of triangles, or of sixteen parts where these are few.
  heldShare() {
    const steps = this.triangles.length > 60000 ? 1 : 4;
    let held = 0, whole = 0;
    for (let t = 0; t < this.triangles.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => row3(this.points, this.triangles[t + k]));
      const area = length3(cross3(minus3(b, a), minus3(c, a)));
      whole += area;
      for (let i = 0; i < steps; ++i) for (let j = 0; j < steps - i; ++j) for (const third of i + j < steps - 1 ? [1, 2] : [1]) {
        const v = (i + third / 3) / steps, w = (j + third / 3) / steps;
        if (this.holds(plus3(plus3(times3(a, 1 - v - w), b, v), c, w))) held += area / (steps * steps);
      }
    }
    return whole > 0 ? held / whole : 0;
  }

  /// What does not go together, in sentences.
  warnings() {
    const list = [], share = this.heldShare();
    if (!this.supports.length && !this.addsToSet)
      list.push('Nothing is chosen to hold the body: it is then held over 5 % of its length at the low end of its longest axis.');
    else if (this.supports.every((s) => s.box || s.sphere || s.plane) && share === 0) list.push('The supports hold nothing of the surface.');
    if (share > 0.5) list.push(`The supports hold ${Math.round(100 * share)} % of the surface.`);
    this.probes.forEach((p, i) => { if (this.holds(p.at)) list.push(`Probe ${this.numberOf(i)} presses on what is held.`); });
    const stuck = this.markers.filter((m) => this.holds(m.at)).map((m) => m.name);
    if (stuck.length) list.push(`Marker${stuck.length > 1 ? 's' : ''} ${stuck.join(', ')} on what is held would not move.`);
    return list;
  }
  /// A probe's number: after those of the set, and after the unloaded state 0.
  numberOf(i) { return (this.data.states.reduce((most, s) => Math.max(most, s.probe), 0)) + 1 + i; }

  supportLines() {
    return this.supports.map(({box, sphere, plane, line}) => {
      if (sphere) return `  - sphere: {center: [${inCommas(sphere.center)}], radius: ${inCommas([sphere.radius])}}`;
      if (box) return `  - box: {min: [${inCommas(box.min)}], max: [${inCommas(box.max)}]}`;
      if (plane) return `  - plane: {point: [${inCommas(plane.point)}], normal: [${inCommas(plane.normal)}], within: ${inCommas([plane.within])}}`;
      return line;
    }).map((l) => `${l}\n`).join('');
  }
  supportsYaml() { return this.supports.length ? `supports:\n${this.supportLines()}` : ''; }
  probesCsv() {
    const cells = (v) => inCommas(v).replaceAll(', ', ',');
    const first = this.addsToSet ? '' : 'probe,time,x,y,z,fx,fy,fz,radius\n0,0,' + cells(row3(this.points, 0)) + ',0,0,0,0\n';
    return first + this.probes.map((p, i) => `${this.numberOf(i)},0,${cells([...p.at, ...p.force, p.radius])}\n`).join('');
  }
  markersCsv() {
    return (this.addsToSet ? '' : 'marker,x,y,z\n') +
      this.markers.map((m) => `${m.name},${inCommas(m.at).replaceAll(', ', ',')}\n`).join('');
  }
  /// A row for each reading that is to be taken.
  positionsCsv() {
    const states = [0, ...this.probes.map((_, i) => this.numberOf(i))];
    return 'probe,time,marker,x,y,z\n' + states.flatMap((s) => this.markers.map((m) => `${s},0,${m.name},,,\n`)).join('');
  }
  setYaml() {
    return `format: palpate-measurements/1\nname: ${JSON.stringify(this.data.name)}\nunits: {length: mm, force: N, time: s}\n` +
      `rest_surface: rest.stl\n${this.supportsYaml()}# noise: {position: 0.05}   # 1 sigma [mm]; what is not known is estimated\n`;
  }
  caseYaml() {
    return `format: palpate-case/1\nname: ${JSON.stringify(this.data.name)}\n${this.data.body}${this.supportsYaml()}`;
  }
  /// The surface in mm, as a binary STL.
  restStl() {
    const count = this.triangles.length / 3, view = new DataView(new ArrayBuffer(84 + 50 * count));
    view.setUint32(80, count, true);
    for (let t = 0, at = 84; t < count; ++t, at += 50) {
      const corners = [0, 1, 2].map((k) => row3(this.points, this.triangles[3 * t + k]));
      const normal = unit3(cross3(minus3(corners[1], corners[0]), minus3(corners[2], corners[0])));
      [normal, ...corners].flat().forEach((v, i) => view.setFloat32(at + 4 * i, v, true));
    }
    return view;
  }
  /// Names, contents (texts or bytes) and what to do with them.
  files() {
    if (this.addsToSet) return [
      {name: 'supports.yaml', content: this.supportsYaml(), what: 'In the place of "supports" in set.yaml; in mm: convert where its units are others.'},
      {name: 'probes.csv', content: this.probesCsv(), what: 'Rows to add to probes.csv; in mm and N: convert where the units of set.yaml are others.'},
      {name: 'markers.csv', content: this.markersCsv(), what: 'Rows to add to markers.csv; in mm: convert where the units of set.yaml are others.'}];
    const ofSet = 'For a measurement set: all five into one folder, then fill in positions.csv.';
    return [
      this.data.kind === 'case' ? {name: 'supports.yaml', content: this.supportsYaml(), what: 'In the place of "supports" in case.yaml.'}
        : {name: 'case.yaml', content: this.caseYaml(), what: 'Beside the mesh: palpate run case.yaml. Finite elements choose probes and markers by themselves.'},
      {name: 'set.yaml', content: this.setYaml(), what: ofSet},
      {name: 'probes.csv', content: this.probesCsv(), what: ofSet},
      {name: 'markers.csv', content: this.markersCsv(), what: ofSet},
      {name: 'positions.csv', content: this.positionsCsv(), what: ofSet},
      {name: 'rest.stl', content: this.restStl(), what: ofSet}];
  }
}
