// SPDX-License-Identifier: GPL-3.0-or-later
// Axes of the picture.

/// About `wanted` round numbers from low to high.
function roundTicks(low, high, wanted) {
  const rough = (high - low) / Math.max(wanted, 1), ten = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * ten).find((s) => s >= rough * 0.999) || rough;
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push(k * step);
  return ticks;
}

const tickText = (value, step) => value.toFixed(Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));

/// Texts of a canvas: one that would touch another, or leave the canvas, is left out. Those that must be there
/// come first.
class Labels {
  constructor(context, width, height) {
    Object.assign(this, { context, width, height, boxes: [] });
    context.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    context.textBaseline = "middle";
  }
  /// `align`: which end of the text is at x; y is its middle. `up`: turned to read upwards.
  put(text, x, y, { align = "center", up = false } = {}) {
    if (!text) return;
    const { context } = this, wide = context.measureText(text).width, high = 13;
    const left = { left: 0, center: wide / 2, right: wide }[align];
    const box = up ? [x - high / 2, y - wide / 2, x + high / 2, y + wide / 2] : [x - left, y - high / 2, x - left + wide, y + high / 2];
    if (box[0] < 0 || box[1] < 0 || box[2] > this.width || box[3] > this.height) return;
    if (this.boxes.some((o) => box[0] < o[2] + 3 && o[0] < box[2] + 3 && box[1] < o[3] && o[1] < box[3])) return;
    this.boxes.push(box);
    context.save();
    context.translate(x, y);
    if (up) context.rotate(-Math.PI / 2);
    context.textAlign = up ? "center" : align;
    context.fillText(text, 0, 0);
    context.restore();
  }
}

/// Draws ticks and titles about the plot. `axes`: across and up, each {title, low, high, at(value), whole,
/// text(value)}; at() gives the place on the canvas.
function drawAxes(context, plot, axes, labels) {
  const ink = css("--faint");
  context.fillStyle = context.strokeStyle = ink;
  context.lineWidth = 1;
  context.strokeRect(plot.x - 0.5, plot.y - 0.5, plot.width + 1, plot.height + 1);
  labels.put(axes.across.title, plot.x + plot.width / 2, plot.y + plot.height + 28);
  labels.put(axes.up.title, plot.x - 52, plot.y + plot.height / 2, { up: true });
  for (const [name, axis] of Object.entries(axes)) {
    const across = name === "across";
    let ticks = roundTicks(Math.min(axis.low, axis.high), Math.max(axis.low, axis.high), across ? plot.width / 70 : plot.height / 45);
    if (axis.whole) ticks = ticks.filter(Number.isInteger);
    const step = ticks.length > 1 ? ticks[1] - ticks[0] : 1;
    for (const tick of ticks) {
      const at = axis.at(axis.whole ? tick + 0.5 : tick), text = axis.text ? axis.text(tick, step) : tickText(tick, step);
      if (across && at >= plot.x - 1 && at <= plot.x + plot.width + 1) {
        context.fillRect(Math.round(at), plot.y + plot.height, 1, 4);
        labels.put(text, at, plot.y + plot.height + 12);
      } else if (!across && at >= plot.y - 1 && at <= plot.y + plot.height + 1) {
        context.fillRect(plot.x - 4, Math.round(at), 4, 1);
        labels.put(text, plot.x - 6, at, { align: "right" });
      }
    }
  }
}
