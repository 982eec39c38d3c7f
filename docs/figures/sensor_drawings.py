# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry of each kind of sensor, with the scene keys as labels. Angles and lengths are not to scale."""
import math

from sheet import (BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, RED, Sheet, polar, towards)

WIDTH, HEIGHT = 700, 336
LEFT, TOP, GAP, TALL = 14, 34, 16, 288  # margins of the two panels, and their height
BLUES = [BLUE, "#5fa8d8"]


def two_panels(left, right, wide):
    """A sheet with two panels; returns it with the left border of the second one."""
    sheet = Sheet(WIDTH, HEIGHT)
    x = LEFT + wide + GAP
    sheet.panel(LEFT, TOP, wide, TALL, left)
    sheet.panel(x, TOP, WIDTH - LEFT - x, TALL, right)
    return sheet, x


def sonar(sheet, at):
    sheet.dot(at, 5, INK, "white")


def along(sheet, start, end, words, colour=INK, below=False):
    """A dimension along a line that may slope, with its words along it."""
    turn = math.atan2(end[1] - start[1], end[0] - start[0])
    middle, off = towards(start, end, 0.5), -14 if below else 6
    sheet.arrow(start, end, colour, 1.2, both=True)
    sheet.text((middle[0] + off * math.sin(turn), middle[1] - off * math.cos(turn)), words, "middle", colour,
               key=True, turn=math.degrees(turn))


def shifted(point, angle_deg, by):
    """A point moved perpendicular to a direction, to its left."""
    return polar(point, by, angle_deg + 90)


def seabed(sheet, x, wide, floor):
    sheet.seabed([(x + 1, floor), (x + wide - 1, floor)], TOP + TALL - 1)


def fan_from_the_side(sheet, x, wide, at, near, far, first, last, floor):
    """A sector from `first` down to `last` degrees, cut by the seabed, with its axis and the horizontal."""
    sheet.wedge(at, 0, near, last, first, BLUE, "none", opacity=0.07)
    sheet.wedge(at, near, far, last, first, BLUE, "none", opacity=0.26)
    for angle in (first, last):
        sheet.line([at, polar(at, far, angle)], BLUE, 1.4)
    for radius in (near, far):
        sheet.arc(at, radius, last, first, BLUE, 1.4)
    sheet.line([at, polar(at, far + 12, (first + last) / 2)], INK, 1, "8 3 2 3")
    seabed(sheet, x, wide, floor)
    sheet.line([at, (x + wide - 8, at[1])], FAINT, 1, "5 4")
    sheet.text((x + wide - 10, at[1] - 6), "horizontal", "end", FAINT, size=11)
    sonar(sheet, at)


def section_ahead(sheet, x, wide, near_key, far_key, far_from_sonar=True, height_key="vertical_deg"):
    """A fan that looks ahead, from the side, with its keys."""
    at, near, far = (x + 40, TOP + 44), 0.3 * wide, 0.8 * wide
    first, last, floor = -14, -42, TOP + 0.53 * wide + 20
    fan_from_the_side(sheet, x, wide, at, near, far, first, last, floor)
    axis = (first + last) / 2
    sheet.angle(at, 0.74 * wide, 0, axis, INK, both=False)
    place = polar(at, 0.74 * wide - 8, -7)
    sheet.key((place[0], place[1] + 4), "tilt_deg", "end")
    sheet.angle(at, 0.46 * wide, first, last, ORANGE)
    place = polar(at, 0.46 * wide + 8, -38)
    sheet.key((place[0], place[1] + 4), height_key, colour=ORANGE)
    def mark(begin, end, words, off):
        along(sheet, shifted(begin, last, -off), shifted(end, last, -off), words, below=True)
    start, end = polar(at, near, last), polar(at, far, last)
    mark(at, start, near_key, 12)
    mark(at if far_from_sonar else start, end, far_key, 40 if far_from_sonar else 12)
    sheet.text((x + 8, at[1] - 14), "sonar", size=12)
    sheet.text((x + wide - 8, TOP + TALL - 10), "seabed", "end", size=12)


def fan_from_above(sheet, at, colours, count, half, near, far):
    """A fan of `count` beams; beam k has colours[k % len(colours)]."""
    step = 2 * half / count
    for k in range(count):
        first = 90 + half - k * step
        sheet.wedge(at, near, far, first - step, first, colours[k % len(colours)], "white", 0.8, 0.5)
        sheet.wedge(at, 0, near, first - step, first, colours[k % len(colours)], "none", 0, 0.08)
    for k in range(1, 6):
        sheet.arc(at, near + (far - near) * k / 6, 90 - half, 90 + half, "white", 0.8)
    for angle in (90 - half, 90 + half):
        sheet.line([at, polar(at, far, angle)], BLUE, 1.2)
    for radius in (near, far):
        sheet.arc(at, radius, 90 - half, 90 + half, BLUE, 1.2)
    sheet.line([at, polar(at, far + 12, 90)], INK, 1, "8 3 2 3")
    sonar(sheet, at)


def pointing(sheet, label, target, words, anchor="start", key=True, colour=INK):
    """Words with a thin line from below or above them to what they name."""
    rises = target[1] > label[1]
    lean = {"start": 14, "middle": 0, "end": -14}[anchor]
    sheet.line([(label[0] + lean, label[1] + (5 if rises else -12)), target], FAINT, 0.9)
    sheet.dot(target, 2, FAINT)
    sheet.text(label, words, anchor, colour, key=key, size=13 if key else 12)


def didson():
    wide = 400
    sheet, x = two_panels("Vertical section", "From above", wide)
    section_ahead(sheet, LEFT, wide, "window_start_m", "window_length_m", far_from_sonar=False)
    right = WIDTH - LEFT
    at = ((x + right) / 2, TOP + TALL - 50)
    colours = [BLUE, ORANGE, GREEN]
    fan_from_above(sheet, at, colours, 12, 34, 66, 190)
    sheet.angle(at, 48, 124, 56, INK)
    pointing(sheet, (right - 6, at[1] + 4), polar(at, 48, 66), "horizontal_deg", "end")
    sheet.text((x + 6, TOP + 22), "port: beam 0", size=12)
    sheet.line([(x + 40, TOP + 27), polar(at, 180, 121.5)], FAINT, 0.9)
    sheet.key((right - 6, TOP + 22), "beams - 1", "end")
    sheet.line([(right - 40, TOP + 27), polar(at, 180, 58.5)], FAINT, 0.9)
    pointing(sheet, (x + 6, at[1] - 40), polar(at, 118, 121), "samples")
    sheet.key((x + 8, TOP + TALL - 12), "cycles = 3")
    for k, colour in enumerate(colours):
        sheet.rectangle(x + 104 + 44 * k, TOP + TALL - 22, 12, 12, colour)
        sheet.text((x + 121 + 44 * k, TOP + TALL - 12), f"{k}", size=12)
    return sheet.svg()


def imaging():
    wide = 386
    sheet, x = two_panels("Vertical section", "From above", wide)
    section_ahead(sheet, LEFT, wide, "range_min_m", "range_max_m")
    right = WIDTH - LEFT
    at = ((x + right) / 2, TOP + TALL - 74)
    fan_from_above(sheet, at, BLUES, 16, 52, 46, 154)
    sheet.angle(at, 32, 142, 38, INK)
    pointing(sheet, (right - 30, at[1] + 22), polar(at, 32, 50), "horizontal_deg", "end")
    sheet.text((x + 6, TOP + 46), "port: beam 0", size=12)
    sheet.line([(x + 26, TOP + 51), polar(at, 146, 140)], FAINT, 0.9)
    sheet.key((right - 6, TOP + 46), "beams - 1", "end")
    sheet.line([(right - 22, TOP + 51), polar(at, 146, 40)], FAINT, 0.9)
    pointing(sheet, (x + 6, at[1] + 2), polar(at, 100, 138), "samples")
    sheet.text((x + 6, TOP + TALL - 26), "beams of equal width:", size=12)
    sheet.key((x + 6, TOP + TALL - 10), 'spacing = "angle"')
    return sheet.svg()


def multibeam():
    wide = 424
    sheet, x0 = two_panels("Across the track, from behind", "From above", wide)
    at, floor = (LEFT + wide / 2, TOP + 42), TOP + 218
    high = floor - at[1]
    count, swath = 11, 84
    step = swath / (count - 1)

    def met(angle):  # where a ray from straight down meets the seabed
        return at[0] + high * math.tan(math.radians(angle)), floor
    axes = [-swath / 2 + k * step for k in range(count)]
    for k, axis in enumerate(axes):
        sheet.polygon([at, met(axis - step / 2), met(axis + step / 2)], BLUES[k % 2], "white", 0.7, 0.36)
    seabed(sheet, LEFT, wide, floor)
    for axis in (axes[0], axes[-1]):
        sheet.line([at, met(axis)], INK, 1, "8 3 2 3")
    for axis in axes:
        sheet.dot(met(axis), 3.4, RED, "white")
    sheet.angle(at, 86, -90 + axes[0], -90 + axes[-1], INK)
    sheet.key((at[0], at[1] + 82), "swath_deg", "middle")
    edge = axes[-3]
    sheet.angle(at, 158, -90 + edge - step / 2, -90 + edge + step / 2, ORANGE)
    pointing(sheet, (LEFT + wide - 6, TOP + 118), polar(at, 158, -90 + edge), "beam_across_deg", "end", colour=ORANGE)
    sheet.arc(at, 26, -136, -44, GREEN, 1.8)
    pointing(sheet, (LEFT + 118, TOP + 40), polar(at, 26, -134), "range_min_m", "middle", colour=GREEN)
    sheet.arc(at, 236, -136, -44, GREEN, 1.6, "5 4")
    sheet.key((at[0] + 112, TOP + TALL - 10), "range_max_m", colour=GREEN)
    pointing(sheet, (LEFT + 8, floor + 44), met(axes[1]), "sounding on the beam axis", key=False)
    sheet.text((LEFT + 8, floor - 40), "port: beam 0", size=12)
    sheet.key((LEFT + wide - 6, floor - 40), "beams - 1", "end")
    sonar(sheet, at)
    x1 = WIDTH - LEFT
    middle, y = (x0 + x1) / 2, TOP + 128
    sheet.arrow((middle, TOP + TALL - 56), (middle, TOP + 20), INK, 1.4)
    sheet.text((middle + 8, TOP + 28), "track", size=12)
    w = (x1 - x0 - 16) / count
    for k in range(count):
        x = x0 + 8 + w * k
        tall = 13 + 0.8 * abs(k - (count - 1) / 2) ** 1.9
        sheet.polygon([(x, y - tall), (x + w, y - tall), (x + w, y + tall), (x, y + tall)], BLUES[k % 2], "white",
                      0.8, 0.5)
    sonar(sheet, (middle, y))
    for sign in (-1, 1):
        sheet.line([(middle, y), (x1 - 8, y + 30 * sign)], ORANGE, 1.2)
    sheet.angle((middle, y), 78, -15.5, 15.5, ORANGE)
    pointing(sheet, (x1 - 6, y + 66), (middle + 80, y + 14), "along_track_deg", "end", colour=ORANGE)
    sheet.text((x0 + 8, TOP + TALL - 40), "footprints of the beams", size=12)
    sheet.text((x0 + 8, TOP + TALL - 25), "on a level seabed", size=12)
    return sheet.svg()


def two_sided(sheet, wide, at, floor, first, last, far):
    """The two fans of a sidescan from behind, with the seabed."""
    for sign in (1, -1):
        angles = [-first, -last] if sign > 0 else [-180 + last, -180 + first]
        sheet.wedge(at, 26, far, min(angles), max(angles), BLUE, BLUE, 1.3, 0.26)
    seabed(sheet, LEFT, wide, floor)
    for sign in (1, -1):
        sheet.arc(at, far, *((-last, -first) if sign > 0 else (-180 + first, -180 + last)), BLUE, 1, "5 4")
    sheet.line([(LEFT + 6, at[1]), (LEFT + wide - 6, at[1])], FAINT, 1, "5 4")
    sheet.text((LEFT + 8, at[1] - 6), "horizontal", colour=FAINT, size=11)
    sheet.text((LEFT + 8, TOP + 20), "beam 0: port", size=12)
    sheet.text((LEFT + wide - 8, TOP + 20), "beam 1: starboard", "end", size=12)


def sidescan():
    wide = 424
    sheet, x0 = two_panels("Across the track, from behind", "From above", wide)
    at, floor = (LEFT + wide / 2, TOP + 78), TOP + 206
    two_sided(sheet, wide, at, floor, 10, 72, 196)
    sheet.angle(at, 132, 0, -10, INK, both=False)
    pointing(sheet, (LEFT + wide - 6, at[1] - 24), polar(at, 132, -4), "depression_min_deg", "end")
    sheet.angle(at, 92, 0, -72, ORANGE, both=False)
    sheet.key((at[0] + 74, at[1] + 84), "depression_max_deg", colour=ORANGE)
    sheet.arc(at, 26, -180 + 10, -180 + 72, GREEN, 2)
    pointing(sheet, (at[0] - 40, at[1] - 30), polar(at, 26, -168), "range_min_m", "end", colour=GREEN)
    pointing(sheet, (LEFT + 8, floor + 62), polar(at, 196, -180 + 50), "range_max_m", colour=GREEN)
    pointing(sheet, (LEFT + wide - 8, floor + 40), (at[0], floor + 2), "no beam straight down", "end", key=False)
    sonar(sheet, at)
    x1 = WIDTH - LEFT
    middle, y = (x0 + x1) / 2, TOP + 138
    sheet.arrow((middle, TOP + TALL - 50), (middle, TOP + 20), INK, 1.4)
    sheet.text((middle + 8, TOP + 28), "track", size=12)
    for k in range(-2, 3):
        for side in (0, 180):
            sheet.wedge((middle, y + 26 * k), 16, 104, side - 5, side + 5, BLUE, BLUE, 0.8, 0.34 if k == 0 else 0.1)
    sheet.arrow((middle + 96, y + 9), (middle + 96, y - 9), ORANGE, 1.2, both=True)
    pointing(sheet, (x1 - 4, y - 76), (middle + 97, y - 4), "along_track_deg", "end", colour=ORANGE)
    sheet.arrow((x0 + 16, y), (x0 + 16, y - 26), INK, 1.2, both=True)
    sheet.line([(x0 + 16, y - 13), (x0 + 24, y + 98)], FAINT, 0.8)
    sheet.text((x0 + 6, y + 112), "distance between pings:", size=12)
    sheet.text((x0 + 6, y + 127), "speed times", size=12)
    sheet.key((x0 + 86, y + 127), "ping_interval_s")
    sonar(sheet, (middle, y))
    return sheet.svg()


def interferometric():
    wide = 404
    sheet, x0 = two_panels("Across the track, from behind", "Receiver pair of one side", wide)
    at, floor = (LEFT + wide / 2, TOP + 84), TOP + 222
    two_sided(sheet, wide, at, floor, 8, 76, 188)
    for tilt in (-30, -150):
        sheet.line([at, polar(at, 150, tilt)], PURPLE, 1.4, "8 3 2 3")
        up, down = polar(at, 17, tilt + 90), polar(at, 17, tilt - 90)
        sheet.line([up, down], PURPLE, 2)
        for end in (up, down):
            sheet.dot(end, 4, PURPLE, "white")
    sheet.angle(at, 78, 0, -30, PURPLE, both=False)
    sheet.key((LEFT + wide - 5, at[1] - 8), "receiver_pair_tilt_deg", "end", PURPLE)
    pointing(sheet, (at[0] + 24, at[1] - 40), polar(at, 17, 60), "receiver pair", key=False)
    cell = polar(at, 150, -180 + 58)
    sheet.wedge(at, 146, 154, -180 + 8, -180 + 66, ORANGE, "none", opacity=0.6)
    pointing(sheet, (LEFT + 8, floor + 40), (cell[0] - 6, cell[1] + 2), "range bin", key=False)
    sheet.text((LEFT + 8, floor + 56), "The phase gives the angle of its echo.", size=12)
    sonar(sheet, at)
    x1 = WIDTH - LEFT
    centre = (x0 + 92, TOP + 104)
    up, down = polar(centre, 62, 60), polar(centre, 62, -120)
    sheet.line([up, down], INK, 3)
    sheet.line([centre, polar(centre, 140, -30)], PURPLE, 1.4, "8 3 2 3")
    sheet.line([centre, (x1 - 6, centre[1])], FAINT, 1, "5 4")
    sheet.angle(centre, 96, 0, -30, PURPLE, both=False)
    sheet.key((x1 - 4, centre[1] + 93), "receiver_pair_tilt_deg", "end", PURPLE)
    arrival = -62
    front = polar(centre, 150, arrival)
    away = polar((0, 0), 1, arrival)
    feet = []
    for end in (up, down):
        reach = (front[0] - end[0]) * away[0] + (front[1] - end[1]) * away[1]
        feet.append(polar(end, reach, arrival))
        sheet.line([feet[-1], end], BLUE, 1.2)
        sheet.head(polar(end, 6, arrival), arrival + 180, BLUE)
        sheet.dot(end, 5.5, PURPLE, "white")
    sheet.line([polar(feet[0], 22, arrival + 90), polar(feet[1], 22, arrival - 90)], BLUE, 1.6, "5 4")
    sonar(sheet, centre)
    sheet.text((up[0] + 10, up[1] - 2), "upper receiver", size=12)
    sheet.text((down[0] - 2, down[1] + 24), "lower receiver", "middle", size=12)
    pointing(sheet, (x0 + 6, centre[1] - 50), centre, "transmitter", key=False)
    sheet.arrow(polar(up, 16, 150), polar(down, 16, 150), INK, 1.2, both=True)
    sheet.key((x0 + 4, centre[1] + 20), "baseline_m")
    sheet.text((x1 - 8, TOP + TALL - 26), "plane wave", "end", BLUE, 12)
    sheet.text((x1 - 8, TOP + TALL - 11), "from the seabed", "end", BLUE, 12)
    return sheet.svg()


def scanning():
    wide = 328
    sheet, x0 = two_panels("From above", "Vertical section of one step", wide)
    at = (LEFT + wide / 2, TOP + 152)
    near, far = 22, 118
    for k in range(-10, 11):
        angle = 90 - 12 * k
        sheet.line([polar(at, near, angle), polar(at, far, angle)], "#9fb9cc", 0.9)
    sheet.arc(at, far, -30, 210, FAINT, 1)
    sheet.arc(at, near, 0, 360, FAINT, 1)
    sheet.wedge(at, near, far, 54 - 10, 54 + 10, BLUE, BLUE, 1, 0.34)
    sheet.line([at, (at[0], at[1] - far - 12)], INK, 1, "8 3 2 3")
    sheet.text((at[0] - 6, at[1] - far - 6), "ahead", "end", size=12)
    sheet.angle(at, far - 22, 44, 64, ORANGE)
    pointing(sheet, (LEFT + wide - 4, TOP + 20), polar(at, far - 20, 54), "beam_horizontal_deg", "end", colour=ORANGE)
    sheet.angle(at, far + 7, 18, 6, INK, both=False)
    sheet.key((LEFT + wide - 4, at[1] + 8), "step_deg", "end")
    sheet.angle(at, 56, 210, -30, GREEN)
    sheet.key((at[0], at[1] + 46), "scan_deg", "middle", GREEN)
    pointing(sheet, (LEFT + 8, at[1] + 96), polar(at, far - 4, 210), "step 0", key=False)
    sheet.angle(at, far + 12, 160, 128, INK, both=False)
    sheet.text((LEFT + 8, TOP + 24), "the head turns", size=12)
    sheet.text((LEFT + 8, TOP + 39), "clockwise", size=12)
    sheet.key((LEFT + 8, TOP + TALL - 10), "step_interval_s")
    sheet.text((LEFT + 134, TOP + TALL - 10), "between transmissions", size=12)
    sonar(sheet, at)
    right = WIDTH - LEFT
    at, near, far, floor = (x0 + 40, TOP + 96), 50, 250, TOP + 226
    fan_from_the_side(sheet, x0, right - x0, at, near, far, 6, -34, floor)
    sheet.angle(at, 200, 0, -14, INK, both=False)
    sheet.key((at[0] + 206, at[1] + 28), "tilt_deg")
    sheet.angle(at, 130, 6, -34, ORANGE)
    sheet.key((polar(at, 138, -30)[0], polar(at, 138, -30)[1]), "beam_vertical_deg", colour=ORANGE)
    along(sheet, shifted(at, -34, -12), shifted(polar(at, near, -34), -34, -12), "")
    sheet.key((x0 + 6, at[1] + 68), "range_min_m")
    along(sheet, shifted(at, 6, 14), shifted(polar(at, far, 6), 6, 14), "range_max_m")
    sheet.text((x0 + 8, TOP + TALL - 10), "seabed", size=12)
    return sheet.svg()


def echosounder():
    wide = 328
    sheet, x0 = two_panels("Vertical section", "Echogram", wide)
    at, floor = (LEFT + wide / 2 - 10, TOP + 46), TOP + 222
    sheet.wedge(at, 26, 240, -90 - 33, -90 + 33, BLUE, "none", opacity=0.10)
    sheet.wedge(at, 26, 240, -90 - 11, -90 + 11, BLUE, "none", opacity=0.32)
    for half, colour in ((33, FAINT), (11, BLUE)):
        for sign in (-1, 1):
            sheet.line([at, polar(at, 236, -90 + half * sign)], colour, 1.2, "" if half == 11 else "5 4")
    ground = [(x, floor + 7 * math.sin(x / 26)) for x in range(LEFT + 1, LEFT + wide, 4)]
    sheet.seabed(ground + [(LEFT + wide - 1, ground[-1][1])], TOP + TALL - 1)
    sheet.angle(at, 140, -101, -79, ORANGE)
    pointing(sheet, (LEFT + wide - 8, TOP + 84), polar(at, 140, -82), "beam_deg", "end", colour=ORANGE)
    sheet.text((LEFT + wide - 8, TOP + 68), "width at -3 dB:", "end", size=12)
    sheet.angle(at, 100, -123, -57, GREEN)
    sheet.key((polar(at, 100, -123)[0] - 8, polar(at, 100, -123)[1] + 2), "sector_deg", "end", GREEN)
    sheet.line([at, (at[0], floor + 16)], INK, 1, "8 3 2 3")
    pointing(sheet, (LEFT + 8, floor + 52), (at[0], floor + 4), "detected bottom: on the beam axis", key=False)
    sheet.arrow((LEFT + 26, at[1]), (LEFT + 26, at[1] + 26), INK, 1.2, both=True)
    sheet.line([(LEFT + 20, at[1]), at], FAINT, 0.8, "3 3")
    sheet.line([(LEFT + 20, at[1] + 26), (at[0], at[1] + 26)], FAINT, 0.8, "3 3")
    sheet.key((LEFT + 34, at[1] + 18), "range_min_m")
    sonar(sheet, at)
    x, y, across, tall = x0 + 40, TOP + 34, 274, 204
    sheet.rectangle(x, y, across, tall, "#0d1233", FAINT)
    columns, line = 40, []
    for k in range(columns):
        left = x + across * k / columns
        top = y + 128 + 16 * math.sin(k / 5) - 26 * math.exp(-((k - 24) / 4) ** 2)
        for deep in range(0, 40, 4):
            shade = math.exp(-deep / 14)
            red, green, blue = (int(5 + shade * d) for d in (240, 200, 140))
            sheet.rectangle(left, top + deep, across / columns + 0.3, 4.3, f"rgb({red},{green},{blue})")
        line.append((left + across / columns / 2, top + 4))
    sheet.line(line, "#20c0ff", 2)
    sheet.text((x + across / 2, y + tall + 20), "ping", "middle", size=12)
    sheet.text((x - 14, y + tall / 2), "range", "middle", size=12, turn=-90)
    sheet.key((x0 + 6, y - 8), "range_min_m")
    sheet.key((x0 + 6, y + tall + 20), "range_max_m")
    sheet.line([(x + 116, y + 50), line[21]], "#20c0ff", 0.9)
    sheet.text((x + 20, y + 44), "detected bottom", colour="white", size=12, halo=False)
    return sheet.svg()


def array():
    wide = 320
    sheet, x0 = two_panels("From above", "Vertical section", wide)
    at = (LEFT + wide / 2, TOP + TALL - 76)
    sheet.wedge(at, 60, 196, 90 - 30, 90 + 30, BLUE, BLUE, 1.3, 0.2)
    for angle in (60, 120):
        sheet.line([at, polar(at, 196, angle)], BLUE, 1.3)
    sheet.line([at, polar(at, 208, 90)], INK, 1, "8 3 2 3")
    sheet.angle(at, 88, 120, 60, INK)
    sheet.key((at[0] + 50, at[1] - 76), "horizontal_deg")
    spacing, count = 17, 13
    receivers = [(at[0] + spacing * (k - (count - 1) / 2), at[1] + 28) for k in range(count)]
    sheet.line([receivers[0], receivers[-1]], FAINT, 1)
    for place in receivers:
        sheet.dot(place, 4.2, PURPLE, "white")
    point = polar(at, 158, 104)
    sheet.dot(point, 4, RED, "white")
    sheet.arrow(at, towards(at, point, 0.97), RED, 1.2)
    sheet.arrow(point, towards(point, receivers[10], 0.97), PURPLE, 1.2)
    sheet.text((point[0] - 8, point[1] - 8), "scatterer", "end", size=12)
    sheet.line([(receivers[3][0], at[1] + 34), (receivers[3][0], at[1] + 46)], INK, 1)
    sheet.line([(receivers[4][0], at[1] + 34), (receivers[4][0], at[1] + 46)], INK, 1)
    pointing(sheet, (LEFT + 8, at[1] + 66), ((receivers[3][0] + receivers[4][0]) / 2, at[1] + 42), "receiver_spacing_m")
    pointing(sheet, (LEFT + wide - 6, at[1] + 66), receivers[-1], "receivers", "end", colour=PURPLE)
    sheet.text((LEFT + 8, at[1] - 26), "transmitter at", size=12)
    pointing(sheet, (LEFT + 8, at[1] - 10), at, "lever_arm_m")
    sonar(sheet, at)
    section_ahead(sheet, x0, WIDTH - LEFT - x0, "range_min_m", "range_max_m")
    return sheet.svg()
