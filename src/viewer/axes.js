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

/// Draws ticks and titles about the plot. `axes`: across and up, each {title, low, high, at(value), whole,
/// text(value)}; at() gives the place on the canvas.
function drawAxes(context, plot, axes) {
  const ink = css("--faint");
  context.fillStyle = context.strokeStyle = ink;
  context.lineWidth = 1;
  context.font = "11px system-ui, 'DejaVu Sans', sans-serif";
  context.strokeRect(plot.x - 0.5, plot.y - 0.5, plot.width + 1, plot.height + 1);
  for (const [name, axis] of Object.entries(axes)) {
    const across = name === "across";
    let ticks = roundTicks(Math.min(axis.low, axis.high), Math.max(axis.low, axis.high), across ? plot.width / 70 : plot.height / 45);
    if (axis.whole) ticks = ticks.filter(Number.isInteger);
    const step = ticks.length > 1 ? ticks[1] - ticks[0] : 1;
    context.textAlign = across ? "center" : "right";
    context.textBaseline = across ? "top" : "middle";
    for (const tick of ticks) {
      const at = axis.at(axis.whole ? tick + 0.5 : tick), text = axis.text ? axis.text(tick, step) : tickText(tick, step);
      if (across && at >= plot.x - 1 && at <= plot.x + plot.width + 1) {
        context.fillRect(Math.round(at), plot.y + plot.height, 1, 4);
        context.fillText(text, at, plot.y + plot.height + 6);
      } else if (!across && at >= plot.y - 1 && at <= plot.y + plot.height + 1) {
        context.fillRect(plot.x - 4, Math.round(at), 4, 1);
        context.fillText(text, plot.x - 6, at);
      }
    }
  }
  context.textAlign = "center";
  context.textBaseline = "bottom";
  context.fillText(axes.across.title, plot.x + plot.width / 2, plot.y + plot.height + 34);
  context.save();
  context.translate(plot.x - 42, plot.y + plot.height / 2);
  context.rotate(-Math.PI / 2);
  context.textBaseline = "middle";
  context.fillText(axes.up.title, 0, 0);
  context.restore();
}
