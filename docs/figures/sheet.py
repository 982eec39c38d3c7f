# SPDX-License-Identifier: GPL-3.0-or-later
"""A sheet of SVG: lines, polygons, wedges, angles, dimensions and texts in pixels, x to the right and y down."""
import html
import math

INK, FAINT, GRID = "#1f2a36", "#5b6875", "#d5dbe1"
WATER, SAND, SAND_EDGE, SHADOW = "#eaf3fa", "#e2d2a4", "#9a8450", "#59636e"
BLUE, ORANGE, GREEN, PURPLE, RED = "#0072b2", "#d55e00", "#009e73", "#7b3fa0", "#b3203a"
STEEL = "#8d9dae"
FONT = "DejaVu Sans, Verdana, Helvetica, Arial, sans-serif"
MONO = "DejaVu Sans Mono, Menlo, Consolas, monospace"


def polar(centre, radius, degrees):
    """A point at a distance; angles count counter-clockwise from the right."""
    angle = math.radians(degrees)
    return centre[0] + radius * math.cos(angle), centre[1] - radius * math.sin(angle)


def towards(a, b, share):
    return tuple(p + (q - p) * share for p, q in zip(a, b))


class Sheet:
    def __init__(self, width, height, size=13):
        self.width, self.height, self.size, self.rows, self.texts = width, height, size, [], []

    def add(self, element):
        self.rows.append(element)

    def polygon(self, points, fill="none", line="none", thick=1.0, opacity=1.0, dashes=""):
        self.add(f'<polygon points="{" ".join(f"{x:.2f},{y:.2f}" for x, y in points)}" fill="{fill}" '
                 f'fill-opacity="{opacity:g}" stroke="{line}" stroke-width="{thick:g}" stroke-linejoin="round"'
                 + (f' stroke-dasharray="{dashes}"' if dashes else "") + "/>")

    def line(self, points, colour=INK, thick=1.2, dashes="", opacity=1.0):
        self.add(f'<polyline points="{" ".join(f"{x:.2f},{y:.2f}" for x, y in points)}" fill="none" '
                 f'stroke="{colour}" stroke-width="{thick:g}" stroke-linejoin="round"'
                 + (f' stroke-dasharray="{dashes}"' if dashes else "")
                 + (f' stroke-opacity="{opacity:g}"' if opacity < 1 else "") + "/>")

    def rectangle(self, x, y, width, height, fill="none", line="none", thick=1.0):
        self.add(f'<rect x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}" fill="{fill}" '
                 f'stroke="{line}" stroke-width="{thick:g}"/>')

    def dot(self, at, radius=3.0, fill=INK, line="none"):
        self.add(f'<circle cx="{at[0]:.2f}" cy="{at[1]:.2f}" r="{radius:g}" fill="{fill}" stroke="{line}"/>')

    def picture(self, x, y, width, height, png_uri):
        self.add(f'<image x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}" '
                 f'preserveAspectRatio="none" href="{png_uri}"/>')

    def text(self, at, words, anchor="start", colour=INK, size=None, bold=False, key=False, turn=0, halo=True):
        """Words on a base line. `key`: the name of a scene key, in a typewriter face. Texts are drawn last."""
        size = size or self.size
        style = f'font-family="{MONO}" ' if key else ""
        style += 'font-weight="bold" ' if bold else ""
        style += f'transform="rotate({turn:g} {at[0]:.2f} {at[1]:.2f})" ' if turn else ""
        style += 'stroke="white" stroke-width="3.5" stroke-linejoin="round" paint-order="stroke" ' if halo else ""
        self.texts.append(f'<text x="{at[0]:.2f}" y="{at[1]:.2f}" text-anchor="{anchor}" font-size="{size - key:g}" '
                          f'fill="{colour}" {style}>{html.escape(words, quote=False)}</text>')

    def key(self, at, words, anchor="start", colour=INK, **more):
        self.text(at, words, anchor, colour, key=True, **more)

    def arc(self, centre, radius, first, last, colour=INK, thick=1.2, dashes=""):
        """Part of a circle, counter-clockwise from `first` to `last` degrees."""
        steps = max(2, int(abs(last - first) / 2))
        self.line([polar(centre, radius, first + (last - first) * k / steps) for k in range(steps + 1)], colour,
                  thick, dashes)

    def wedge(self, centre, near, far, first, last, fill, line="none", thick=1.0, opacity=1.0, dashes=""):
        steps = max(2, int(abs(last - first) / 2))
        angles = [first + (last - first) * k / steps for k in range(steps + 1)]
        outer = [polar(centre, far, a) for a in angles]
        inner = [polar(centre, near, a) for a in reversed(angles)] if near > 0 else [centre]
        self.polygon(outer + inner, fill, line, thick, opacity, dashes)

    def arrow(self, start, end, colour=INK, thick=1.4, both=False, dashes=""):
        self.line([start, end], colour, thick, dashes)
        ends = [(start, end)] + ([(end, start)] if both else [])
        for tail, tip in ends:
            self.head(tip, math.degrees(math.atan2(tail[1] - tip[1], tip[0] - tail[0])), colour, 7 + thick)

    def head(self, tip, degrees, colour, size=8.0):
        """The head of an arrow that points in a direction."""
        self.polygon([tip, polar(tip, size, degrees + 180 - 20), polar(tip, size, degrees + 180 + 20)], colour)

    def angle(self, centre, radius, first, last, colour=INK, thick=1.4, both=True):
        """An arc with heads: from `first` to `last` degrees, counter-clockwise if last > first."""
        self.arc(centre, radius, first, last, colour, thick)
        turn = 90 if last > first else -90
        lean = math.degrees(4 / radius) * (1 if last > first else -1)
        self.head(polar(centre, radius, last), last + turn - lean, colour)
        if both:
            self.head(polar(centre, radius, first), first - turn + lean, colour)

    def dimension(self, start, end, words, colour=INK, offset=(0, -6), anchor="middle", key=True):
        """A length with heads at both ends and words at its middle."""
        self.arrow(start, end, colour, 1.2, both=True)
        middle = towards(start, end, 0.5)
        self.text((middle[0] + offset[0], middle[1] + offset[1]), words, anchor, colour, key=key)

    def leader(self, label_at, target, words, anchor="start", colour=INK, key=False, bend=None):
        """Words with a thin line to what they name."""
        self.line([label_at] + ([bend] if bend else []) + [target], FAINT, 0.9)
        self.dot(target, 2, FAINT)
        gap = {"start": 5, "end": -5, "middle": 0}[anchor]
        drop = 4 if anchor != "middle" else (-5 if target[1] > label_at[1] else 14)
        self.text((label_at[0] + gap, label_at[1] + drop), words, anchor, colour, key=key)

    def panel(self, x, y, width, height, title, fill=WATER):
        self.rectangle(x, y, width, height, fill, GRID)
        self.text((x, y - 8), title, bold=True, halo=False)

    def seabed(self, points, bottom):
        """Sand below a line of points, down to `bottom`."""
        self.polygon(list(points) + [(points[-1][0], bottom), (points[0][0], bottom)], SAND)
        self.line(points, SAND_EDGE, 1.6)

    def svg(self):
        return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
                f'viewBox="0 0 {self.width} {self.height}" font-family="{FONT}" font-size="{self.size}" fill="{INK}">\n'
                f'<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(self.rows + self.texts) + "\n</svg>\n")
