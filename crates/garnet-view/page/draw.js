// Meshes on the screen, by WebGL 2: clay under the lamps of `garnet render`, heat maps, wireframes.

// Software pays for each number that goes from corners to pixels: how open the surface is goes as
// the length of its normal, and plain surfaces have no level.
const SURFACE_VERTEX = `
uniform mat4 view, projection;
in vec3 position;
in vec4 normal;
out vec3 facing;
#ifdef HEAT
in float value;
out float level;
flat out float kind;
#endif
void main() {
  facing = mat3(view) * normal.xyz * normal.w;
#ifdef HEAT
  level = kind = value;
#endif
  gl_Position = projection * (view * vec4(position, 1.0));
}`;

// Lines of sight count as parallel, squares and roots stand for the curve of sRGB: both are hardly
// seen, and software draws twice as fast.
const SURFACE_FRAGMENT = `
precision highp float;
uniform vec3 color, notFinite, up;
uniform bool hasKinds;
uniform sampler2D heat;
in vec3 facing;
#ifdef HEAT
in float level;
flat in float kind;
#endif
out vec4 pixel;
const vec3 KEY = vec3(-0.661, 0.601, 0.450);
const vec3 HALFWAY = vec3(-0.388, 0.353, 0.851);
const vec3 FILL = vec3(0.799, 0.050, 0.599);
const vec3 RIM = vec3(0.350, 0.549, -0.759);
void main() {
  float openness = length(facing);
  vec3 n = facing / openness;
  vec3 coat = color;
#ifdef HEAT
  // Kinds do not blend into each other: a face has that of one corner.
  float along = hasKinds ? kind : level;
  vec3 shown = texture(heat, vec2(along * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
  coat = along < -0.01 ? notFinite : shown * shown;
#endif
  if (!gl_FrontFacing) {
    n = -n;
    coat *= 0.42;
  }
  vec3 sky = mix(vec3(0.12, 0.11, 0.10), vec3(0.30, 0.32, 0.36), 0.5 + 0.5 * dot(n, up));
  float grazing = 1.0 - max(n.z, 0.0);
  vec3 lamps = vec3(0.98, 0.95, 0.90) * max((dot(n, KEY) + 0.05) / 1.05, 0.0)
    + vec3(0.12, 0.13, 0.15) * max(dot(n, FILL), 0.0)
    + vec3(0.34, 0.35, 0.38) * grazing * grazing * grazing * clamp(dot(n, RIM) + 0.4, 0.0, 1.0);
  float crease = mix(0.45, 1.0, openness);
  vec3 light = sky * openness + lamps * crease;
#ifdef HEAT
  light = 1.0 + 0.55 * (light - 1.0);
  float sheen = 0.0;
#else
  float shine = max(dot(n, HALFWAY), 0.0);
  float squared = shine * shine;
  float fourth = squared * squared;
  float sheen = 0.085 * crease * fourth * fourth * fourth * squared;
#endif
  pixel = vec4(sqrt(coat * light + sheen), 1.0);
}`;

const LINE_VERTEX = `
uniform mat4 view, projection;
in vec3 position;
void main() { gl_Position = projection * view * vec4(position, 1.0); }`;

const LINE_FRAGMENT = `
precision mediump float;
uniform vec4 color;
out vec4 pixel;
void main() { pixel = color; }`;

/** Where the shaders find what belongs to a vertex. */
const ATTRIBUTES = ["position", "normal", "value"];

/** What stands for a value that is not finite; all others are from 0 to 1. */
const NO_LEVEL = -8;

/** The channels of `#rrggbb`, from 0 to 1. */
function channels(color) {
  return [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);
}

function linear(color) {
  return channels(color).map((channel) => channel ** 2);
}

function program(gl, vertex, fragment, define = "") {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\n${define}${text}`);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  ATTRIBUTES.forEach((name, place) => gl.bindAttribLocation(made, place, name));
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) {
    throw new Error(`the shaders do not run here: ${gl.getProgramInfoLog(made)}`);
  }
  const places = {};
  for (let index = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); index-- > 0;) {
    const { name } = gl.getActiveUniform(made, index);
    places[name] = gl.getUniformLocation(made, name);
  }
  return { made, places };
}

/** Each edge of triangles once `[edge][2]`. */
function edgesOf(corners, numVertices) {
  const seen = new Set();
  const edges = [];
  for (let corner = 0; corner < corners.length; corner++) {
    const next = corner % 3 === 2 ? corner - 2 : corner + 1;
    const [a, b] = [corners[corner], corners[next]];
    const key = Math.min(a, b) * numVertices + Math.max(a, b);
    if (a !== b && !seen.has(key)) {
      seen.add(key);
      edges.push(a, b);
    }
  }
  return new Uint32Array(edges);
}

/** Whether each edge is that of two triangles that run along it in opposite ways: of what is closed,
 *  the back is never seen. */
function isClosed(corners, numVertices) {
  const open = new Set();
  for (let corner = 0; corner < corners.length; corner++) {
    const next = corner % 3 === 2 ? corner - 2 : corner + 1;
    const [a, b] = [corners[corner], corners[next]];
    if (!open.delete(b * numVertices + a)) {
      open.add(a * numVertices + b);
    }
  }
  return open.size === 0;
}

/** A mesh as the graphics card has it. */
class Shape {
  constructor(gl, mesh, topology) {
    this.gl = gl;
    this.mesh = mesh;
    this.corners = topology.corners;
    topology.isClosed ??= isClosed(topology.corners, mesh.vertices);
    this.isClosed = topology.isClosed;
    this.positions = new Float32Array(3 * mesh.vertices);
    this.sums = new Float32Array(7 * mesh.vertices);
    this.normals = new Int16Array(4 * mesh.vertices);
    this.levels = new Float32Array(mesh.vertices);
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    this.buffers = ATTRIBUTES.map((_, place) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(place);
      const [size, kind] = [[3, gl.FLOAT], [4, gl.SHORT], [1, gl.FLOAT]][place];
      gl.vertexAttribPointer(place, size, kind, kind === gl.SHORT, 0, 0);
      return buffer;
    });
    this.triangles = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, this.corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    this.load(2, this.levels);
  }

  /** Moves the vertices to a frame. */
  show(frame) {
    const at = Math.min(frame, this.mesh.origins.length - 1);
    if (at === this.frame) {
      return;
    }
    this.frame = at;
    const { codes, step, origins } = this.mesh;
    const first = at * this.positions.length;
    for (let place = 0; place < this.positions.length; place++) {
      this.positions[place] = origins[at][place % 3] + step * codes[first + place];
    }
    this.bend();
    this.load(0, this.positions);
    this.load(1, this.normals);
  }

  /** Normals of the vertices, and how open the surface is: creases lie lower than their
   *  neighbors. */
  bend() {
    const { corners, positions: p, sums, normals } = this;
    sums.fill(0);
    for (let corner = 0; corner < corners.length; corner += 3) {
      const [a, b, c] = [corners[corner], corners[corner + 1], corners[corner + 2]];
      const [i, j, k] = [3 * a, 3 * b, 3 * c];
      const [ux, uy, uz] = [p[j] - p[i], p[j + 1] - p[i + 1], p[j + 2] - p[i + 2]];
      const [vx, vy, vz] = [p[k] - p[i], p[k + 1] - p[i + 1], p[k + 2] - p[i + 2]];
      const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      const perimeter = Math.hypot(ux, uy, uz) + Math.hypot(vx, vy, vz)
        + Math.hypot(ux - vx, uy - vy, uz - vz);
      for (let turn = 0; turn < 3; turn++) {
        const [own, one, two] = turn === 0 ? [i, j, k] : turn === 1 ? [j, k, i] : [k, i, j];
        const sum = own / 3 * 7;
        sums[sum] += nx;
        sums[sum + 1] += ny;
        sums[sum + 2] += nz;
        sums[sum + 3] += p[one] + p[two] - 2 * p[own];
        sums[sum + 4] += p[one + 1] + p[two + 1] - 2 * p[own + 1];
        sums[sum + 5] += p[one + 2] + p[two + 2] - 2 * p[own + 2];
        sums[sum + 6] += perimeter;
      }
    }
    for (let vertex = 0; vertex < normals.length / 4; vertex++) {
      const sum = 7 * vertex;
      const length = Math.hypot(sums[sum], sums[sum + 1], sums[sum + 2]) || 1;
      let hollow = 0;
      for (let axis = 0; axis < 3; axis++) {
        const coordinate = sums[sum + axis] / length;
        normals[4 * vertex + axis] = 32767 * coordinate;
        hollow += coordinate * sums[sum + 3 + axis];
      }
      const depth = 1.5 * hollow / (sums[sum + 6] || 1);
      normals[4 * vertex + 3] = 32767 * Math.max(0.3, Math.min(1, 1 - 2 * depth));
    }
  }

  /** Takes the levels of a coloring; whether the mesh has it. */
  color(coloring, range) {
    const values = this.mesh.values.find((found) => found.coloring === coloring);
    if (!values) {
      return false;
    }
    const shown = [coloring, this.frame, range.low, range.high].join();
    if (shown !== this.shown) {
      this.shown = shown;
      for (let vertex = 0; vertex < this.levels.length; vertex++) {
        const value = valueAt(values, this.frame, vertex, this.levels.length);
        const level = (value - range.low) / (range.high - range.low);
        this.levels[vertex] = Number.isNaN(value) ? NO_LEVEL : Math.max(0, Math.min(1, level));
      }
      this.load(2, this.levels);
    }
    return true;
  }

  /** The edges, made when they are first drawn. */
  lines() {
    if (!this.edges) {
      const { gl } = this;
      const edges = edgesOf(this.corners, this.mesh.vertices);
      this.edges = { buffer: gl.createBuffer(), count: edges.length };
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.edges.buffer);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, edges, gl.STATIC_DRAW);
    }
    return this.edges;
  }

  load(place, numbers) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[place]);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
  }
}

/** A value of a mesh in a frame; not a number where it is not finite. */
function valueAt(values, frame, vertex, numVertices) {
  const code = values.codes[Math.min(frame, values.frames - 1) * numVertices + vertex];
  return code === NOT_FINITE ? NaN : values.low + values.step * code;
}

/** Draws meshes into panes of a canvas. */
class Painter {
  constructor(canvas, scene) {
    const gl = canvas.getContext("webgl2", { antialias: false });
    if (!gl) {
      throw new Error("this browser has no WebGL 2, which this page draws with");
    }
    this.gl = gl;
    this.scene = scene;
    this.plain = program(gl, SURFACE_VERTEX, SURFACE_FRAGMENT);
    this.heat = program(gl, SURFACE_VERTEX, SURFACE_FRAGMENT, "#define HEAT\n");
    this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.shapes = scene.meshes.map((mesh) => new Shape(gl, mesh, scene.topologies[mesh.topology]));
    this.heats = scene.colorings.map((coloring) => this.table(coloring.colors));
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    // The picture stays opaque.
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ZERO, gl.ONE);
    gl.polygonOffset(1, 2);
  }

  table(colors) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, ramp(colors));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /** Begins a picture, with smooth edges or without. */
  begin(isSmooth) {
    const { gl } = this;
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    this.target = isSmooth ? this.smooth(width, height) : null;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.scissor(0, 0, width, height);
    gl.clearColor(...channels(this.scene.background), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** Puts a picture on the screen. */
  end() {
    const { gl } = this;
    if (this.target) {
      const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
      gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
      gl.scissor(0, 0, width, height);
      gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    }
  }

  /** Tells how many milliseconds it takes until what was drawn is there, of a picture at a time. */
  time(tell) {
    if (this.isTiming) {
      return;
    }
    this.isTiming = true;
    const { gl } = this;
    const [start, fence] = [performance.now(), gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0)];
    gl.flush();
    const look = () => {
      if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) {
        setTimeout(look, 1);
        return;
      }
      gl.deleteSync(fence);
      this.isTiming = false;
      tell(performance.now() - start);
    };
    setTimeout(look, 1);
  }

  /** A place to draw with several samples a pixel. */
  smooth(width, height) {
    const { gl } = this;
    this.samples ??= {
      framebuffer: gl.createFramebuffer(),
      count: Math.min(4, gl.getParameter(gl.MAX_SAMPLES)),
      layers: [[gl.COLOR_ATTACHMENT0, gl.RGBA8], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]]
        .map(([place, format]) => ({ place, format, buffer: gl.createRenderbuffer() })),
    };
    const { framebuffer, count, layers, size } = this.samples;
    if (size !== `${width} ${height}`) {
      this.samples.size = `${width} ${height}`;
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
      for (const { place, format, buffer } of layers) {
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorageMultisample(gl.RENDERBUFFER, count, format, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
      }
    }
    return framebuffer;
  }

  /** Draws meshes in a pane, `[left, bottom, width, height]` in pixels. */
  draw(pane, meshes, [view, projection], { frame, coloring, isWireframe }) {
    const { gl } = this;
    gl.viewport(...pane);
    gl.scissor(...pane);
    gl.bindTexture(gl.TEXTURE_2D, this.heats[coloring] ?? null);
    if (isWireframe) {
      gl.enable(gl.POLYGON_OFFSET_FILL);
    }
    for (const index of meshes) {
      const shape = this.shapes[index];
      shape.show(frame);
      const found = this.scene.colorings[coloring];
      const { made, places } = shape.color(coloring, found) ? this.heat : this.plain;
      gl.useProgram(made);
      gl.uniformMatrix4fv(places.view, false, view);
      gl.uniformMatrix4fv(places.projection, false, projection);
      gl.uniform3f(places.up, view[4], view[5], view[6]);
      gl.uniform3fv(places.color, linear(shape.mesh.color));
      gl.uniform3fv(places.notFinite, linear(this.scene.notFinite));
      gl.uniform1i(places.hasKinds, found?.kinds.length > 0);
      gl[shape.isClosed ? "enable" : "disable"](gl.CULL_FACE);
      gl.bindVertexArray(shape.array);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, shape.triangles);
      gl.drawElements(gl.TRIANGLES, shape.corners.length, gl.UNSIGNED_INT, 0);
    }
    if (isWireframe) {
      gl.disable(gl.POLYGON_OFFSET_FILL);
      this.drawLines(meshes, view, projection);
    }
    gl.bindVertexArray(null);
  }

  drawLines(meshes, view, projection) {
    const { gl } = this;
    const { made, places } = this.line;
    gl.useProgram(made);
    gl.enable(gl.BLEND);
    gl.uniformMatrix4fv(places.view, false, view);
    gl.uniformMatrix4fv(places.projection, false, projection);
    gl.uniform4f(places.color, ...channels(this.scene.wire), 0.4);
    for (const index of meshes) {
      const shape = this.shapes[index];
      gl.bindVertexArray(shape.array);
      const { buffer, count } = shape.lines();
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
      gl.drawElements(gl.LINES, count, gl.UNSIGNED_INT, 0);
    }
    gl.disable(gl.BLEND);
  }
}

/** The 256 colors of a scale between its control points, as bytes `[color][4]`. */
function ramp(colors) {
  const points = colors.map(channels);
  const bytes = new Uint8Array(1024);
  for (let step = 0; step < 256; step++) {
    const along = step / 255 * (points.length - 1);
    const first = Math.min(Math.floor(along), points.length - 2);
    for (let channel = 0; channel < 3; channel++) {
      const [from, to] = [points[first][channel], points[first + 1][channel]];
      bytes[4 * step + channel] = Math.round(255 * (from + (along - first) * (to - from)));
    }
    bytes[4 * step + 3] = 255;
  }
  return bytes;
}
