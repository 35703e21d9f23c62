// A small WebGL 2 renderer: coloured surfaces, their edges, and glyphs (balls, tubes, discs, arrows) between two points each.
'use strict';

const surfaceVertexShader = `#version 300 es
in vec3 position, colour;
uniform mat4 view, projection;
out vec3 seen, tint;
void main() {
  vec4 p = view * vec4(position, 1.);
  seen = p.xyz; tint = colour;
  gl_Position = projection * p;
}`;
// A glyph stands from start to end; its unit mesh reaches from 0 to 1 along z.
const glyphVertexShader = `#version 300 es
in vec3 position, start, end, colour, colourEnd;
in float radius;
uniform mat4 view, projection;
out vec3 seen, tint;
void main() {
  vec3 along = end - start;
  vec3 axis = normalize(along + vec3(0., 0., 1e-12));
  vec3 side = normalize(cross(abs(axis.z) < .9 ? vec3(0., 0., 1.) : vec3(1., 0., 0.), axis));
  vec4 p = view * vec4(start + along * position.z + radius * (side * position.x + cross(axis, side) * position.y), 1.);
  seen = p.xyz; tint = mix(colour, colourEnd, position.z);
  gl_Position = projection * p;
}`;
// Lit from the eye; the normal is that of the facet.
const fragmentShader = `#version 300 es
precision highp float;
in vec3 seen, tint;
uniform float opacity, shading;
out vec4 shown;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));  // of a line it may be no number
  float light = shading > 0. ? .45 + .55 * abs(dot(normal, normalize(seen))) : 1.;
  shown = vec4(tint * light * opacity, opacity);
}`;

function programOf(gl, vertexText) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertexText], [gl.FRAGMENT_SHADER, fragmentShader]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

/// A mesh from rings of [radius, height], each of so many corners.
function turned(rings, corners) {
  const points = [], triangles = [];
  rings.forEach(([r, z], i) => {
    for (let c = 0; c < corners; ++c) {
      const angle = 2 * Math.PI * c / corners;
      points.push(r * Math.cos(angle), r * Math.sin(angle), z);
      if (i === 0) continue;
      const here = i * corners + c, next = i * corners + (c + 1) % corners;
      triangles.push(here - corners, next - corners, here, here, next - corners, next);
    }
  });
  return {points: new Float32Array(points), triangles: new Uint32Array(triangles)};
}
const arc = (steps) => Array.from({length: steps + 1}, (_, i) => {
  const angle = Math.PI * i / steps;
  return [Math.sin(angle), 0.5 - 0.5 * Math.cos(angle)];
});
const glyphShapes = {
  ball: turned(arc(10), 18),
  tube: turned([[0, 0], [1, 0], [1, 1], [0, 1]], 10),
  disc: turned([[0, 0], [1, 0], [1, 1], [0, 1]], 48),
  arrow: turned([[0, 0], [1, 0], [1, 0.72], [2.6, 0.72], [0, 1]], 10),
};

const ballAt = (center, radius, colour) => ({
  start: [center[0], center[1], center[2] - radius], end: [center[0], center[1], center[2] + radius], radius, colour});

function edgesOf(triangles) {
  const seen = new Set(), edges = [];
  for (let i = 0; i < triangles.length; ++i) {
    const a = triangles[i], b = triangles[i % 3 === 2 ? i - 2 : i + 1];
    const key = Math.min(a, b) * 4294967296 + Math.max(a, b);
    if (!seen.has(key)) { seen.add(key); edges.push(a, b); }
  }
  return new Uint32Array(edges);
}

class Scene {
  /// `triangles` of the body's surface. Throws where the browser has no WebGL 2.
  constructor(canvas, triangles) {
    // Kept after drawing, so that the page prints what is shown.
    const gl = canvas.getContext('webgl2', {antialias: true, preserveDrawingBuffer: true});
    if (!gl) throw new Error('no WebGL 2');
    this.gl = gl;
    this.surfaceProgram = programOf(gl, surfaceVertexShader);
    this.glyphProgram = programOf(gl, glyphVertexShader);
    this.body = this.mesh(triangles);
    this.shapes = {};
    for (const [name, shape] of Object.entries(glyphShapes)) {
      this.shapes[name] = {points: this.buffer(shape.points), triangles: this.indices(shape.triangles)};
    }
    this.scratch = {};
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);  // a patch that is drawn on the surface shows
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }
  buffer(data) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, data, this.gl.STATIC_DRAW);
    return buffer;
  }
  indices(data) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, data, gl.STATIC_DRAW);
    return {buffer, count: data.length};
  }
  /// Triangles that can be drawn, once for all.
  mesh(triangles) {
    return {triangles: this.indices(new Uint32Array(triangles)), edges: this.indices(edgesOf(triangles))};
  }
  attribute(program, name, size, divisor, data, buffer) {
    const gl = this.gl, at = gl.getAttribLocation(program, name);
    buffer ??= this.scratch[name] ??= gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    if (data) gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
    gl.vertexAttribDivisor(at, divisor);
  }
  begin(camera, width, height) {
    const gl = this.gl;
    if (gl.canvas.width !== width || gl.canvas.height !== height) Object.assign(gl.canvas, {width, height});
    gl.viewport(0, 0, width, height);
    gl.clearColor(...(this.paper ?? [1, 1, 1]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.view = camera.view();
    this.projection = camera.projection(width / height);
  }
  use(program, opacity, shading) {
    const gl = this.gl;
    gl.useProgram(program);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, 'view'), false, this.view);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, 'projection'), false, this.projection);
    gl.uniform1f(gl.getUniformLocation(program, 'opacity'), opacity);
    gl.uniform1f(gl.getUniformLocation(program, 'shading'), shading);
  }
  /// Draws with blending and without hiding what lies behind, back sides first.
  blended(opacity, draw) {
    const gl = this.gl;
    if (opacity >= 1) return draw();
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    gl.enable(gl.CULL_FACE);
    for (const side of [gl.FRONT, gl.BACK]) { gl.cullFace(side); draw(); }
    gl.disable(gl.CULL_FACE);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
  /// points: three numbers a vertex; colours: likewise, or one for all.
  vertices(points, colours) {
    const gl = this.gl, program = this.surfaceProgram, at = gl.getAttribLocation(program, 'colour');
    this.attribute(program, 'position', 3, 0, points);
    if (colours.length === 3) {
      gl.disableVertexAttribArray(at);
      gl.vertexAttrib3fv(at, colours);
    } else {
      this.attribute(program, 'colour', 3, 0, colours);
    }
  }
  surface(points, colours, opacity, mesh = this.body) {
    const gl = this.gl;
    if (opacity <= 0 || points.length === 0) return;
    this.use(this.surfaceProgram, opacity, 1);
    this.vertices(points, colours);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles.buffer);
    this.blended(opacity, () => gl.drawElements(gl.TRIANGLES, mesh.triangles.count, gl.UNSIGNED_INT, 0));
  }
  wires(points, colour, mesh = this.body) {
    const gl = this.gl;
    this.use(this.surfaceProgram, 1, 0);
    this.vertices(points, colour);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.edges.buffer);
    gl.drawElements(gl.LINES, mesh.edges.count, gl.UNSIGNED_INT, 0);
  }
  /// glyphs: [{start, end, radius, colour, colourEnd}]; shape: 'ball', 'tube', 'disc' or 'arrow'.
  glyphs(shape, glyphs, opacity = 1) {
    if (glyphs.length === 0) return;
    const gl = this.gl, program = this.glyphProgram, {points, triangles} = this.shapes[shape];
    const flat = (pick) => new Float32Array(glyphs.flatMap(pick));
    this.use(program, opacity, 1);
    this.attribute(program, 'position', 3, 0, null, points);
    this.attribute(program, 'start', 3, 1, flat((g) => g.start));
    this.attribute(program, 'end', 3, 1, flat((g) => g.end));
    this.attribute(program, 'colour', 3, 1, flat((g) => g.colour));
    this.attribute(program, 'colourEnd', 3, 1, flat((g) => g.colourEnd ?? g.colour));
    this.attribute(program, 'radius', 1, 1, flat((g) => g.radius));
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangles.buffer);
    this.blended(opacity,
      () => gl.drawElementsInstanced(gl.TRIANGLES, triangles.count, gl.UNSIGNED_INT, 0, glyphs.length));
    // the surface's own attributes go with the vertex, not with the instance
    for (const name of ['position', 'colour']) gl.vertexAttribDivisor(gl.getAttribLocation(program, name), 0);
  }
}
