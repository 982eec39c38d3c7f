// SPDX-License-Identifier: GPL-3.0-or-later
// The sonar picture: every pixel of the canvas asks which cell it shows, so that zooming is only another
// question.

const radians = Math.PI / 180;
const farRange = facts.firstRange + facts.samples * facts.rangeStep;

/// Borders between beams, degrees: half-way between their axes.
const beamBorders = (() => {
  const a = facts.beamAngles, n = a.length;
  if (n < 2) return [a[0] - 0.5, a[0] + 0.5];
  const inner = a.slice(1).map((v, k) => (v + a[k]) / 2);
  return [2 * a[0] - inner[0], ...inner, 2 * a[n - 1] - inner[n - 2]];
})();

/// Layouts: the box of the plane that all of it takes, which cell is at (u, v), the outline of a cell, and, where
/// pings lie side by side, two corners of one.
const layouts = {
  /// u: beam, v: slant range.
  beams(ping) {
    return {
      box: [0, facts.beams, facts.firstRange, farRange],
      cell: (u, v) => inPing(ping(), Math.floor(u), v),
      outline(cell) {
        const { beam, sample } = placeOf(cell);
        return rectangle(beam, beam + 1, rangeOf(sample), rangeOf(sample + 1));
      },
      axes: { across: { title: "beam", whole: true }, up: { title: "slant range, m" } },
    };
  },
  /// u: metres to starboard, v: metres ahead (or up towards the sonar, for fans across the track).
  fan(ping) {
    const down = facts.acrossTrack ? -1 : 1, low = beamBorders[0], high = beamBorders[beamBorders.length - 1];
    const rising = high > low ? 1 : -1;
    const at = (angle, range) => [range * Math.sin(angle * radians), down * range * Math.cos(angle * radians)];
    const corners = [];
    for (let k = 0; k <= 32; ++k)
      for (const range of [facts.firstRange, farRange]) corners.push(at(low + (high - low) * k / 32, range));
    const us = corners.map((c) => c[0]), vs = corners.map((c) => c[1]);
    return {
      box: [Math.min(...us), Math.max(...us), Math.min(...vs), Math.max(...vs)],
      equal: true,
      cell(u, v) {
        const seen = Math.atan2(u, down * v) / radians;
        // A fan all around may begin below -180 degrees.
        const angle = seen - 360 * Math.round((seen - (low + high) / 2) / 360);
        let from = 0, to = facts.beams;
        if ((angle - low) * rising < 0 || (high - angle) * rising <= 0) return -1;
        while (to - from > 1) {
          const middle = (from + to) >> 1;
          if ((angle - beamBorders[middle]) * rising >= 0) from = middle; else to = middle;
        }
        return inPing(ping(), from, Math.hypot(u, v));
      },
      outline(cell) {
        const { beam, sample } = placeOf(cell);
        return [[beam, sample], [beam + 1, sample], [beam + 1, sample + 1], [beam, sample + 1]]
          .map(([b, s]) => at(beamBorders[b], rangeOf(s)));
      },
      axes: facts.acrossTrack
        ? { across: { title: "across track, m (starboard to the right)" }, up: { title: "below the sonar, m", text: (v, step) => tickText(0 - v, step) } }
        : { across: { title: "to starboard, m" }, up: { title: "ahead, m" } },
    };
  },
  /// u: slant range, port negative; v: ping.
  waterfall() {
    const pings = facts.pings.length;
    return {
      box: [-farRange, farRange, 0, pings],
      line: (ping) => [[-farRange, ping], [farRange, ping + 1]],
      cell: (u, v) => inPing(Math.floor(v), u < 0 ? 0 : 1, Math.abs(u)),
      outline(cell) {
        const { ping, beam, sample } = placeOf(cell), side = beam === 0 ? -1 : 1;
        return rectangle(side * rangeOf(sample), side * rangeOf(sample + 1), ping, ping + 1);
      },
      axes: { across: { title: "slant range, m (port - starboard)", text: (v, step) => tickText(Math.abs(v), step) },
        up: { title: "ping", whole: true, text: pingText } },
    };
  },
  /// u: ping, v: slant range downwards.
  echogram() {
    return {
      box: [0, facts.pings.length, -farRange, -facts.firstRange],
      line: (ping) => [[ping, -facts.firstRange], [ping + 1, -farRange]],
      cell: (u, v) => inPing(Math.floor(u), 0, -v),
      outline(cell) {
        const { ping, sample } = placeOf(cell);
        return rectangle(ping, ping + 1, -rangeOf(sample), -rangeOf(sample + 1));
      },
      axes: { across: { title: "ping", whole: true, text: pingText },
        up: { title: "slant range, m", text: (v, step) => tickText(Math.abs(v), step) } },
    };
  },
};

const pingText = (v) => facts.pings[v] ? String(facts.pings[v].number) : "";
const rangeOf = (sample) => facts.firstRange + sample * facts.rangeStep;
const rectangle = (u0, u1, v0, v1) => [[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
function inPing(ping, beam, range) {
  const sample = Math.floor((range - facts.firstRange) / facts.rangeStep);
  if (beam < 0 || beam >= facts.beams || sample < 0 || sample >= facts.samples || !(ping >= 0 && ping < facts.pings.length)) return -1;
  return cellOf(ping, beam, sample);
}

/// All of a layout, or what has echoes where that is less than half of it: the rest is open water.
function boxOfEchoes({ box, outline }) {
  const lo = [Infinity, Infinity], hi = [-Infinity, -Infinity];
  // The nearest and the farthest echo of each beam hold all between them.
  for (let first = 0; first < arrays.cellEnergy.length; first += facts.samples) {
    const beam = arrays.cellEnergy.subarray(first, first + facts.samples), heard = (energy) => energy > 0;
    const near = beam.findIndex(heard);
    if (near < 0) continue;
    for (const cell of [first + near, first + beam.findLastIndex(heard)])
      for (const corner of outline(cell))
        for (const k of [0, 1]) {
          lo[k] = Math.min(lo[k], corner[k]);
          hi[k] = Math.max(hi[k], corner[k]);
        }
  }
  const small = (hi[0] - lo[0]) * (hi[1] - lo[1]) < 0.5 * (box[1] - box[0]) * (box[3] - box[2]);
  if (!small || hi[0] < lo[0]) return box;
  const spare = [0, 1].map((k) => 0.06 * (hi[k] - lo[k]));
  return [lo[0] - spare[0], hi[0] + spare[0], lo[1] - spare[1], hi[1] + spare[1]]
    .map((v, k) => k % 2 ? Math.min(v, box[k]) : Math.max(v, box[k]));
}

/// `colourOf`: of a cell, null where there is none; `legend`: draws the scale; `moved`: called where what is
/// shown has been zoomed or moved.
class Picture {
  constructor(canvas, { clicked, colourOf = echoColour, legend = drawPictureLegend, moved = () => {} }) {
    Object.assign(this, { canvas, colourOf, legend, moved, context: canvas.getContext("2d"), lit: [], chosen: null, ping: 0, line: null, labels: [] });
    let down = null, way = 0;
    canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); down = e; way = 0; });
    canvas.addEventListener("pointermove", (e) => {
      if (!down) return;
      way += Math.hypot(e.clientX - down.clientX, e.clientY - down.clientY);
      if (way > 3) this.pan(e.clientX - down.clientX, e.clientY - down.clientY);
      down = e;
    });
    canvas.addEventListener("pointerup", (e) => {
      if (down && way <= 3 && e.button === 0) clicked(this.cellAt(e.offsetX, e.offsetY));
      down = null;
    });
    canvas.addEventListener("pointercancel", () => { down = null; });
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      this.zoom(Math.exp(Math.sign(e.deltaY) * Math.min(Math.abs(e.deltaY), 120) * 0.0025), e.offsetX, e.offsetY);
    }, { passive: false });
    canvas.addEventListener("dblclick", () => this.showAll());
  }

  layOut(name) {
    this.layout = layouts[name](() => this.ping);
    this.layout.box = boxOfEchoes(this.layout);
    this.showAll();
  }
  showAll() { this.show(null); }
  show(window_) {
    this.window = window_;
    this.moved(window_);
    this.draw();
  }

  /// The plot's rectangle and the part of the plane that it shows.
  frame() {
    const plot = { x: 66, y: 12, width: Math.max(this.canvas.clientWidth - 148, 20), height: Math.max(this.canvas.clientHeight - 54, 20) };
    let window_ = this.window;
    if (!window_) {
      let [u0, u1, v0, v1] = this.layout.box;
      if (this.layout.equal) {
        const scale = Math.max((u1 - u0) / plot.width, (v1 - v0) / plot.height) * 1.02, u = (u0 + u1) / 2, v = (v0 + v1) / 2;
        [u0, u1, v0, v1] = [u - scale * plot.width / 2, u + scale * plot.width / 2, v - scale * plot.height / 2, v + scale * plot.height / 2];
      }
      window_ = [u0, u1, v0, v1];
    }
    const [u0, u1, v0, v1] = window_;
    return { plot, window_, perU: plot.width / (u1 - u0), perV: plot.height / (v1 - v0) };
  }
  toPlane(x, y) {
    const { plot, window_, perU, perV } = this.frame();
    return [window_[0] + (x - plot.x) / perU, window_[3] - (y - plot.y) / perV];
  }
  toCanvas([u, v]) {
    const { plot, window_, perU, perV } = this.frame();
    return [plot.x + (u - window_[0]) * perU, plot.y + (window_[3] - v) * perV];
  }
  /// -1 beside the picture.
  cellAt(x, y) {
    const { plot } = this.frame();
    if (x < plot.x || y < plot.y || x >= plot.x + plot.width || y >= plot.y + plot.height) return -1;
    return this.layout.cell(...this.toPlane(x, y));
  }
  /// Middle of a cell on the canvas, CSS pixels.
  onCanvas(cell) {
    const corners = this.layout.outline(cell).map((p) => this.toCanvas(p));
    return [0, 1].map((k) => corners.reduce((sum, c) => sum + c[k], 0) / 4);
  }

  zoom(factor, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2) {
    const [u, v] = this.toPlane(x, y), { window_ } = this.frame(), [u0, u1, v0, v1] = this.layout.box;
    const next = [u, u, v, v].map((c, k) => c + (window_[k] - c) * factor);
    const share = Math.max((next[1] - next[0]) / (u1 - u0), (next[3] - next[2]) / (v1 - v0));
    if (share < 1e-4) return;
    this.show(share > 20 ? null : next);
  }
  pan(dx, dy) {
    const { window_, perU, perV } = this.frame();
    this.show(window_.map((c, k) => k < 2 ? c - dx / perU : c + dy / perV));
  }

  light(cells, chosen) {
    Object.assign(this, { lit: cells, chosen });
    this.draw();
  }

  draw() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => { this.asked = 0; this.drawNow(); });
  }

  drawNow() {
    const { canvas, context } = this, ratio = window.devicePixelRatio || 1;
    const width = Math.max(Math.round(canvas.clientWidth * ratio), 1), height = Math.max(Math.round(canvas.clientHeight * ratio), 1);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    const { plot, window_, perU, perV } = this.frame();
    const columns = Math.round(plot.width * ratio), rows = Math.round(plot.height * ratio);
    const image = context.createImageData(columns, rows);
    const [dark, beyond] = ["--no-echo", "--beyond"].map((name) => cssColour(name).map((v) => 255 * v));
    for (let y = 0; y < rows; ++y) {
      const v = window_[3] - (y + 0.5) / ratio / perV;
      for (let x = 0; x < columns; ++x) {
        const cell = this.layout.cell(window_[0] + (x + 0.5) / ratio / perU, v);
        if (cell < 0) continue;
        const colour = this.colourOf(cell) || (arrays.cellEnergy[cell] > 0 || !isBeyond(cell) ? dark : beyond), at = 4 * (y * columns + x);
        [image.data[at], image.data[at + 1], image.data[at + 2]] = colour;
        image.data[at + 3] = 255;
      }
    }
    context.putImageData(image, Math.round(plot.x * ratio), Math.round(plot.y * ratio));
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawLit(plot);
    const axes = this.layout.axes, labels = new Labels(context, canvas.clientWidth, canvas.clientHeight);
    drawAxes(context, plot, {
      across: { ...axes.across, low: window_[0], high: window_[1], at: (u) => this.toCanvas([u, 0])[0] },
      up: { ...axes.up, low: window_[2], high: window_[3], at: (v) => this.toCanvas([0, v])[1] },
    }, labels);
    this.legend(context, plot.x + plot.width + 16, plot.y + 20, Math.min(plot.height - 20, 220), labels);
    this.labels = labels.boxes;
  }

  drawLit(plot) {
    const { context } = this;
    context.save();
    context.beginPath();
    context.rect(plot.x, plot.y, plot.width, plot.height);
    context.clip();
    context.fillStyle = context.strokeStyle = rgb(highlight);
    if (this.line !== null && this.layout.line) {
      const [[x0, y0], [x1, y1]] = this.layout.line(this.line).map((p) => this.toCanvas(p));
      context.lineWidth = 1.5;
      context.strokeRect(Math.min(x0, x1) - 1, Math.min(y0, y1) - 1, Math.max(Math.abs(x1 - x0), 1) + 2, Math.max(Math.abs(y1 - y0), 1) + 2);
    }
    for (const cell of this.lit) {
      const corners = this.layout.outline(cell).map((p) => this.toCanvas(p)), xs = corners.map((c) => c[0]), ys = corners.map((c) => c[1]);
      const x0 = Math.min(...xs), x1 = Math.max(...xs), y0 = Math.min(...ys), y1 = Math.max(...ys);
      // Never too small to be seen.
      if (x1 - x0 < 2 || y1 - y0 < 2) {
        const w = Math.max(x1 - x0, 2), h = Math.max(y1 - y0, 2);
        context.fillRect((x0 + x1 - w) / 2, (y0 + y1 - h) / 2, w, h);
      } else {
        context.beginPath();
        for (const corner of corners) context.lineTo(...corner);
        context.closePath();
        context.fill();
      }
    }
    if (this.chosen !== null) {
      const [x, y] = this.onCanvas(this.chosen);
      context.lineWidth = 2;
      context.strokeStyle = "#fff";
      context.strokeRect(x - 7, y - 7, 14, 14);
      context.strokeStyle = rgb(highlight);
      context.strokeRect(x - 9, y - 9, 18, 18);
    }
    context.restore();
  }
}

const echoColour = (cell) => pictureColour(arrays.cellEnergy[cell]);
const candidateColour = (cell) => pictureColour(arrays.candidateEnergy[cell]);
const differenceColour = (cell) => ratioColour(arrays.cellEnergy[cell], arrays.candidateEnergy[cell]);

/// A bar of 256 colours with numbers at equal steps from its top to its bottom.
function drawBar(context, x, y, height, labels, { table, title, numbers }) {
  for (let k = 0; k < height; ++k) {
    context.fillStyle = rgb(table[Math.round(255 * (1 - k / height))]);
    context.fillRect(x, y + k, 12, 1.5);
  }
  context.fillStyle = css("--faint");
  labels.put(title, x - 4, y - 14, { align: "left" });
  numbers.forEach((text, k) => labels.put(text, x + 17, y + k * height / (numbers.length - 1), { align: "left" }));
}
function drawPictureLegend(context, x, y, height, labels) {
  const numbers = [0, 1, 2, 3, 4, 5].map((k) => (pictureTopDb - k * pictureRangeDb / 5).toFixed(0));
  drawBar(context, x, y, height, labels, { table: pictureTable, title: "dB re 1 J/m2", numbers });
}
function drawRatioLegend(context, x, y, height, labels) {
  const numbers = [1, 0.5, 0, -0.5, -1].map((part) => String(part * ratioRangeDb));
  drawBar(context, x, y, height, labels, { table: ratioTable, title: "dB", numbers });
}
