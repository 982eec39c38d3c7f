// SPDX-License-Identifier: GPL-3.0-or-later
// The scene in WebGL: all footprints of what is shown are one draw call; numbers drawn instead of colours tell
// which one is under the mouse.

/// Triangles of polygons given by their numbers of corners, and where each polygon's triangles begin.
function triangles(counts) {
  let total = 0;
  for (const n of counts) total += 3 * (n - 2);
  const index = new Uint32Array(total), first = new Uint32Array(counts.length + 1);
  let corner = 0, at = 0;
  for (let p = 0; p < counts.length; ++p) {
    for (let k = 1; k + 1 < counts[p]; ++k) {
      index[at++] = corner;
      index[at++] = corner + k;
      index[at++] = corner + k + 1;
    }
    corner += counts[p];
    first[p + 1] = at;
  }
  return { index, first };
}

const shapes = {
  ...triangles(arrays.shapeCorners),
  corner: starts(arrays.shapeCorners),  // by piece
  piece: starts(arrays.pieces),         // by footprint
};

class Scene {
  constructor(canvas, orbit) {
    this.canvas = canvas;
    this.orbit = orbit;
    this.lit = new Set();
    this.shown = { footprints: true, shadows: true, mesh: true, tubes: false };
    this.pings = [0, facts.pings.length];
    this.litBeam = null;
    this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!this.gl) return;
    this.build();
    canvas.addEventListener("webglcontextlost", (e) => e.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => { this.build(); this.colour(this.scale); this.light([...this.lit]); });
  }

  build() {
    const { gl } = this;
    this.programs = Object.fromEntries(Object.entries(shaderSources).map(([k, v]) => [k, makeProgram(gl, v)]));
    const buffer = (target, data, usage = gl.STATIC_DRAW) => {
      const b = gl.createBuffer();
      gl.bindBuffer(target, b);
      gl.bufferData(target, data, usage);
      return b;
    };
    const places = (points, index, usage) => {
      const vertices = gl.createVertexArray();
      gl.bindVertexArray(vertices);
      const points_ = buffer(gl.ARRAY_BUFFER, points, usage);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
      if (index) buffer(gl.ELEMENT_ARRAY_BUFFER, index);
      return { vertices, points: points_, count: index ? index.length : points.length / 3 };
    };
    const owner = new Uint32Array(arrays.shapePoints.length / 3);
    for (let f = 0; f < footprintCount; ++f)
      owner.fill(f, shapes.corner[shapes.piece[f]], shapes.corner[shapes.piece[f + 1]]);
    this.footprints = places(arrays.shapePoints, shapes.index);
    buffer(gl.ARRAY_BUFFER, owner);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribIPointer(1, 1, gl.UNSIGNED_INT, 0, 0);
    const shadows = triangles(arrays.shadowCorners);
    this.shadowFirst = starts(facts.pings.map((p) => p.shadows)).map((polygon) => shadows.first[polygon]);
    this.shadows = places(arrays.shadowPoints, shadows.index);
    this.mesh = places(arrays.meshPoints, arrays.meshFacets);
    this.tubes = places(arrays.tubePoints, tubeLines());
    this.outline = places(new Float32Array(0), null, gl.DYNAMIC_DRAW);
    this.track = places(new Float32Array(facts.pings.flatMap((p) => p.sensor)));
    gl.bindVertexArray(null);

    const texture = () => {
      const t = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, t);
      for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
      return t;
    };
    this.textures = { levels: texture(), colours: texture(), marks: texture(), numbers: texture() };
    this.pickFrame = gl.createFramebuffer();
    this.pickDepth = gl.createRenderbuffer();
    this.marks = new Uint8Array(tableWidth * this.tableHeight());
    this.sendMarks();
  }

  tableHeight() { return Math.max(Math.ceil(footprintCount / tableWidth), 1); }

  colour(scale) {
    this.scale = scale;
    if (!this.gl) return;
    const { gl } = this, levels = new Float32Array(tableWidth * this.tableHeight());
    levels.set(scale.level);
    gl.bindTexture(gl.TEXTURE_2D, this.textures.levels);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, tableWidth, this.tableHeight(), 0, gl.RED, gl.FLOAT, levels);
    gl.bindTexture(gl.TEXTURE_2D, this.textures.colours);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(scale.table.flat()));
    this.draw();
  }

  sendMarks() {
    const { gl } = this;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.bindTexture(gl.TEXTURE_2D, this.textures.marks);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8UI, tableWidth, this.tableHeight(), 0, gl.RED_INTEGER, gl.UNSIGNED_BYTE, this.marks);
  }

  /// `tubes`: where they lie in the arrays of tubes, to be drawn too.
  light(footprints, tubes = []) {
    for (const f of this.lit) this.marks && (this.marks[f] = 0);
    this.lit = new Set(footprints);
    this.litTubes = tubes;
    if (!this.gl) return;
    for (const f of footprints) this.marks[f] = 1;
    this.sendMarks();
    const { gl } = this, lines = outlines(footprints);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.outline.points);
    gl.bufferData(gl.ARRAY_BUFFER, lines, gl.DYNAMIC_DRAW);
    this.outline.count = lines.length / 3;
    this.draw();
  }

  /// Draws before the browser paints next; many calls make one picture.
  draw() {
    if (!this.gl || this.asked) return;
    this.asked = requestAnimationFrame(() => { this.asked = 0; this.drawNow(); });
  }

  fit() {
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(Math.round(this.canvas.clientWidth * ratio), 1), height = Math.max(Math.round(this.canvas.clientHeight * ratio), 1);
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
  }

  use(name, view) {
    const { gl } = this, { program, at } = this.programs[name];
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.view, false, view);
    return at;
  }

  drawFootprints() {
    const { gl } = this, first = firstFootprint[this.pings[0]], end = firstFootprint[this.pings[1]];
    const from = shapes.first[shapes.piece[first]], to = shapes.first[shapes.piece[end]];
    gl.bindVertexArray(this.footprints.vertices);
    if (to > from) gl.drawElements(gl.TRIANGLES, to - from, gl.UNSIGNED_INT, 4 * from);
  }

  /// What may hide footprints lies behind them by a hair: on the same facets they win.
  drawGround(plain) {
    const { gl, shown } = this;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    if (shown.mesh) {
      gl.polygonOffset(2, 4);
      plain(this.mesh, gl.TRIANGLES, "--mesh", 1, 0.55);
    }
    if (shown.shadows) {
      gl.polygonOffset(1, 2);
      const from = this.shadowFirst[this.pings[0]];
      plain(this.shadows, gl.TRIANGLES, "--shadow", 1, 0.25, from, this.shadowFirst[this.pings[1]] - from);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  drawNow() {
    const { gl, shown } = this;
    this.fit();
    const view = this.orbit.matrix();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(...cssColour("--water"), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    if (shown.footprints) {
      const at = this.use("footprints", view);
      ["levels", "colours", "marks"].forEach((name, unit_) => {
        gl.activeTexture(gl.TEXTURE0 + unit_);
        gl.bindTexture(gl.TEXTURE_2D, this.textures[name]);
        gl.uniform1i(at[name], unit_);
      });
      gl.activeTexture(gl.TEXTURE0);
      gl.uniform1i(at.someLit, this.lit.size > 0);
      gl.uniform3fv(at.litColour, highlight.map((v) => v / 255));
      gl.uniform3fv(at.faintColour, cssColour("--water"));
      this.drawFootprints();
    }
    const at = this.use("plain", view);
    const plain = (thing, kind, colour, alpha, shading, from = 0, count = thing.count - from) => {
      if (count <= 0) return;
      gl.uniform4f(at.colour, ...(typeof colour === "string" ? cssColour(colour) : colour), alpha);
      gl.uniform1f(at.shading, shading);
      gl.bindVertexArray(thing.vertices);
      if (thing === this.outline || thing === this.track) gl.drawArrays(kind, from, count);
      else gl.drawElements(kind, count, gl.UNSIGNED_INT, 4 * from);
    };
    this.drawGround(plain);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);  // the canvas stays opaque
    if (shown.tubes) {
      const from = linesATube * firstTube[this.pings[0]], count = linesATube * firstTube[this.pings[1]] - from;
      plain(this.tubes, gl.LINES, "--tube", Math.min(Math.max(150 / count, 0.06), 0.6) + 0.1, 0, from, count);
    }
    if (facts.pings.length > 1) plain(this.track, gl.LINE_STRIP, "--tube", 0.9, 0);
    gl.disable(gl.DEPTH_TEST);
    const lit = highlight.map((v) => v / 255);
    for (const tube of this.litTubes)
      if (tube * linesATube < this.tubes.count) plain(this.tubes, gl.LINES, lit, 0.6, 0, linesATube * tube, linesATube);
    if (shown.footprints) plain(this.outline, gl.LINES, lit, 1, 0);
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }

  /// The footprint at a place of the canvas in CSS pixels, or null.
  pick(x, y) {
    const { gl } = this;
    if (!gl || !this.shown.footprints) return null;
    this.fit();
    const { width, height } = this.canvas, ratio = width / this.canvas.clientWidth;
    gl.bindTexture(gl.TEXTURE_2D, this.textures.numbers);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.pickDepth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.pickFrame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.textures.numbers, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.pickDepth);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    const view = this.orbit.matrix();
    this.use("numbers", view);
    this.drawFootprints();
    const at = this.use("plain", view);
    this.drawGround((thing, kind, colour, alpha, shading, from = 0, count = thing.count - from) => {
      if (count <= 0) return;
      gl.uniform4f(at.colour, 0, 0, 0, 0);
      gl.uniform1f(at.shading, 0);
      gl.bindVertexArray(thing.vertices);
      gl.drawElements(kind, count, gl.UNSIGNED_INT, 4 * from);
    });
    // The nearest of the pixels about the place that shows one: small footprints are hard to hit.
    const reach = Math.round(2 * ratio), side = 2 * reach + 1, bytes = new Uint8Array(4 * side * side);
    const px = Math.floor(x * ratio), py = height - 1 - Math.floor(y * ratio);
    gl.readPixels(px - reach, py - reach, side, side, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.bindVertexArray(null);
    let best = null, least = Infinity;
    for (let k = 0; k < side * side; ++k) {
      const number = bytes[4 * k] + 256 * (bytes[4 * k + 1] + 256 * (bytes[4 * k + 2] + 256 * bytes[4 * k + 3]));
      const away = Math.hypot(k % side - reach, Math.floor(k / side) - reach);
      if (number > 0 && away < least) [best, least] = [number - 1, away];
    }
    return best;
  }

  /// Where a place is on the canvas in CSS pixels; null behind the eye.
  onCanvas(place) {
    const p = projected(this.orbit.matrix(), place);
    return p && [(p[0] + 1) / 2 * this.canvas.clientWidth, (1 - p[1]) / 2 * this.canvas.clientHeight];
  }
}

const firstFootprint = firstOfPings((f) => arrays.ping[f], footprintCount);
const firstTube = firstOfPings((t) => arrays.tubeOwner[2 * t], arrays.tubeOwner.length / 2);
const linesATube = 16;  // vertices: four edges from the apex, four at the end

function tubeLines() {
  const lines = [0, 1, 0, 2, 0, 3, 0, 4, 1, 2, 2, 3, 3, 4, 4, 1], count = arrays.tubeOwner.length / 2;
  const index = new Uint32Array(linesATube * count);
  for (let t = 0; t < count; ++t) lines.forEach((corner, k) => { index[linesATube * t + k] = 5 * t + corner; });
  return index;
}

/// Edges of footprints' pieces as pairs of places; of very many footprints the first.
function outlines(footprints) {
  const lines = [], points = arrays.shapePoints;
  for (const f of footprints) {
    if (lines.length > 1e6) break;
    for (let p = shapes.piece[f]; p < shapes.piece[f + 1]; ++p)
      for (let c = shapes.corner[p], end = shapes.corner[p + 1]; c < end; ++c)
        for (const at of [c, c + 1 < end ? c + 1 : shapes.corner[p]]) lines.push(...points.subarray(3 * at, 3 * at + 3));
  }
  return new Float32Array(lines);
}

/// Corners of footprints, x, y, z one after another.
function cornersOf(footprints) {
  const points = [];
  for (const f of footprints)
    for (let c = shapes.corner[shapes.piece[f]]; c < shapes.corner[shapes.piece[f + 1]]; ++c)
      points.push(...arrays.shapePoints.subarray(3 * c, 3 * c + 3));
  return points;
}
