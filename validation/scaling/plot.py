# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts of measured figures as SVG: points joined by lines over linear or logarithmic axes."""
import math
from xml.sax.saxutils import escape

COLOURS = ["#0b6fa4", "#c8501e", "#2c8a4b", "#7b4ba0", "#8a6d1f", "#555555", "#c2185b"]
INK, FAINT = "#223344", "#d5dde3"
LEFT, RIGHT, TOP, BOTTOM = 66, 14, 34, 46


def label(value):
    """A number as people write it on an axis."""
    if value == 0:
        return "0"
    power = math.floor(math.log10(abs(value)) + 1e-9)
    if -3 <= power < 5:
        return f"{value:.10g}"
    mantissa = value / 10**power
    return (f"{mantissa:.3g} x " if abs(mantissa - 1) > 1e-9 else "") + f"1e{power}"


class Axis:
    """From values to pixels."""
    def __init__(self, values, log, first, last, low=None, high=None):
        self.log, self.first, self.last = log, first, last
        self.whole = all(v is None or float(v).is_integer() for v in values)
        values = [v for v in values if v is not None and (v > 0 or not log)]
        self.low, self.high = (min(values) if low is None else low), (max(values) if high is None else high)
        if log:
            self.low, self.high = self.low / 1.25, self.high * 1.25
        elif low is None or high is None:
            margin = 0.05 * (self.high - self.low or 1)
            self.low, self.high = self.low - (margin if low is None else 0), self.high + (margin if high is None else 0)

    def place(self, value):
        low, high, value = ((math.log10(v) for v in (self.low, self.high, value)) if self.log
                            else (self.low, self.high, value))
        return self.first + (value - low) / (high - low) * (self.last - self.first)

    def ticks(self):
        if self.log:
            powers = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
            for steps in ((1,), (1, 3), (1, 2, 5)):
                found = [s * 10.0**p for p in powers for s in steps if self.low <= s * 10.0**p <= self.high]
                if len(found) >= 3:
                    break
            return found
        step = 10**math.floor(math.log10((self.high - self.low) / 4))
        step = max(1, step) if self.whole else step
        step = next(s * step for s in (1, 2, 2.5, 5, 10) if (self.high - self.low) / (s * step) <= 6)
        first = math.ceil(self.low / step - 1e-9)
        return [round(k * step, 12) for k in range(first, math.floor(self.high / step + 1e-9) + 1)]


def drawn(points):
    """What is left of a line's points when no more can be seen: of each pixel across, the lowest and highest."""
    columns = {}
    for point in points:
        columns.setdefault(round(point[0]), []).append(point)
    kept = []
    for column in columns.values():
        ends = {id(p): p for p in (column[0], min(column, key=lambda p: p[1]), max(column, key=lambda p: p[1]), column[-1])}
        kept += sorted(ends.values(), key=column.index)
    return kept


def panel(title, x_words, y_words, lines, log=(False, False), limits=(None, None, None, None), size=(430, 300),
          corner="left"):
    """(SVG of one chart, its size). `lines`: {name: ([x...], [y...]) or ([x...], [y...], style)}; a style is a
    set of "points", "dashes", "thin"; by default points are joined and marked. `limits`: of x, then of y."""
    width, height = size
    curves = {name: (c + ({"points", "line"},))[:3] for name, c in lines.items()}
    x = Axis([v for c in curves.values() for v in c[0]], log[0], LEFT, width - RIGHT, *limits[:2])
    y = Axis([v for c in curves.values() for v in c[1]], log[1], height - BOTTOM, TOP, *limits[2:])
    rows = [f'<text x="{LEFT}" y="18" font-weight="bold">{escape(title)}</text>',
            f'<text x="{(LEFT + width - RIGHT) / 2}" y="{height - 8}" text-anchor="middle">{escape(x_words)}</text>',
            f'<text transform="translate(13,{(TOP + height - BOTTOM) / 2}) rotate(-90)" '
            f'text-anchor="middle">{escape(y_words)}</text>']
    for value in x.ticks():
        p = x.place(value)
        rows.append(f'<line x1="{p:.1f}" x2="{p:.1f}" y1="{TOP}" y2="{height - BOTTOM}" stroke="{FAINT}"/>'
                    f'<text x="{p:.1f}" y="{height - BOTTOM + 15}" text-anchor="middle">{label(value)}</text>')
    for value in y.ticks():
        p = y.place(value)
        rows.append(f'<line x1="{LEFT}" x2="{width - RIGHT}" y1="{p:.1f}" y2="{p:.1f}" stroke="{FAINT}"/>'
                    f'<text x="{LEFT - 5}" y="{p + 4:.1f}" text-anchor="end">{label(value)}</text>')
    rows.append(f'<rect x="{LEFT}" y="{TOP}" width="{width - LEFT - RIGHT}" height="{height - TOP - BOTTOM}" '
                f'fill="none" stroke="{INK}"/>')
    longest = max((len(name) for name in curves), default=0) * 6.1 + 34
    legend_x = LEFT + 8 if corner.endswith("left") else width - RIGHT - longest
    legend_y = height - BOTTOM - 15 * len(curves) + 3 if corner.startswith("low") else TOP + 18
    legend = [f'<rect x="{legend_x - 4}" y="{legend_y - 13}" width="{longest}" height="{15 * len(curves) + 4}" '
              'fill="white" fill-opacity="0.8"/>']
    for k, (name, (xs, ys, style)) in enumerate(curves.items()):
        colour = COLOURS[k % len(COLOURS)]
        at = [(x.place(a), y.place(b)) for a, b in zip(xs, ys) if b is not None and (b > 0 or not log[1])]
        thick, dashes = (1 if "thin" in style else 1.8), ("5,4" if "dashes" in style else "")
        stroke = f'stroke="{colour}" stroke-width="{thick}" stroke-dasharray="{dashes}"'
        if "line" in style:
            rows.append(f'<polyline points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in drawn(at))}" fill="none" {stroke}/>')
        if "points" in style:
            rows += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="2.8" fill="{colour}"/>' for a, b in at]
        row = legend_y + 15 * k
        if "line" in style:
            legend.append(f'<line x1="{legend_x}" x2="{legend_x + 20}" y1="{row - 4}" y2="{row - 4}" {stroke}/>')
        if "points" in style:
            legend.append(f'<circle cx="{legend_x + 10}" cy="{row - 4}" r="2.8" fill="{colour}"/>')
        legend.append(f'<text x="{legend_x + 26}" y="{row}">{escape(name)}</text>')
    return "\n".join(rows + legend), size


def sheet(path, panels, columns=2):
    """Writes panels of one size beside and below each other."""
    width, height = panels[0][1]
    rows = math.ceil(len(panels) / columns)
    placed = [f'<g transform="translate({k % columns * width},{k // columns * height})">\n{text}\n</g>'
              for k, (text, _) in enumerate(panels)]
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{min(columns, len(panels)) * width}" '
                    f'height="{rows * height}" font-family="DejaVu Sans, sans-serif" font-size="11" fill="{INK}">\n'
                    '<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(placed) + "\n</svg>\n")
