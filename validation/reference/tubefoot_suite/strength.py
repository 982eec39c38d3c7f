# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads tables of target strength, and compares them with Kirchhoff values and with published boundary elements.

A table is a CSV file with the columns azimuth_deg, frequency_hz and target_strength_db, and optionally others. The answers also
have target_strength_bound_db, the certified bound of the Kirchhoff value, and compared_strength_db, the published value or an
empty cell."""
import csv

import numpy as np

from .echoes import Refused

KEYS = "azimuth_deg", "frequency_hz"
LEVEL, BOUND, PUBLISHED = "target_strength_db", "target_strength_bound_db", "compared_strength_db"
ANGLE_DIGITS = 6
SHARE = 0.9  # of the aspects that must be within the limit, because nulls have no significant digits


def number(file, line, row, column, optional=False):
    text = (row.get(column) or "").strip()
    if optional and text in ("", "inf"):  # no value, or no bound
        return float(text or "nan")
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise Refused(f"{file}:{line}: '{column}' is '{text}', but a finite number was expected: target strengths are in dB re 1 m2")
    return value


def table_in(file, further=()):
    """Values by azimuth and frequency: the target strength, and optional further columns."""
    try:
        with open(file, newline="", encoding="utf-8-sig") as text:
            lines = [(place, line) for place, line in enumerate(text, 1) if not line.startswith("#")]
    except (OSError, UnicodeDecodeError) as error:
        raise Refused(f"{file}: cannot read the file: {error}") from error
    rows = csv.DictReader(line for _, line in lines)
    if missing := {*KEYS, LEVEL, *further} - set(rows.fieldnames or ()):
        raise Refused(f"{file}: no column '{min(missing)}': expected a header with the columns {', '.join((*KEYS, LEVEL))}")
    table = {}
    for row in rows:
        line = lines[rows.line_num - 1][0]
        if row.get("elevation_deg") and number(file, line, row, "elevation_deg") != 0:
            continue
        key = tuple(round(number(file, line, row, column), ANGLE_DIGITS) for column in KEYS)
        if key in table:
            raise Refused(f"{file}:{line}: second value for azimuth {key[0]:g} and {key[1]:g} Hz: remove one of the rows")
        table[key] = (number(file, line, row, LEVEL), *(number(file, line, row, column, True) for column in further))
    return table


def of_aspects(file, table, scene):
    """The rows of a table for all frequencies and azimuths of a scene, with the dimensions frequency, azimuth, column."""
    try:
        return np.array([[table[round(azimuth, ANGLE_DIGITS), round(hertz, ANGLE_DIGITS)] for azimuth in scene["azimuths_deg"]]
                         for hertz in scene["frequencies_hz"]])
    except KeyError as error:
        azimuth, hertz = error.args[0]
        raise Refused(f"{file}: no row for azimuth {azimuth:g} and {hertz:g} Hz: write one row for each azimuth and frequency of "
                      "scene.json") from error


def nine_tenths(differences):
    """The absolute difference that nine tenths of the aspects of each frequency do not exceed: the largest over the frequencies."""
    found = [np.sort(np.abs(row[np.isfinite(row)])) for row in differences]
    return max((float(row[int(np.ceil(SHARE * row.size)) - 1]) for row in found if row.size), default=np.nan)


def result_file(results, name):
    return next((file for file in (results / f"{name}.csv", results / name / "strength.csv") if file.exists()), None)


def strength_entry(pack, results, name, scene):
    """The report on the table of a scene. Returns None without a result."""
    file, answer = result_file(results, name), pack / "answers" / name / "strength.csv"
    if file is None:
        return None
    theirs = of_aspects(file, table_in(file), scene)[..., 0]
    kirchhoff, bound, published = np.moveaxis(of_aspects(answer, table_in(answer, (BOUND, PUBLISHED)), scene), -1, 0)
    excess = np.maximum(np.abs(theirs - kirchhoff) - bound, 0)
    differences = {"kirchhoff_db": excess, "boundary_db": theirs - published}
    measures = {measure: (nine_tenths(differences[measure]), limit) for measure, limit in scene["limits"].items()}
    measures = {measure: {"value": value if np.isfinite(value) else None, "standard_error": 0.0, "limit": limit,
                          "kept": bool(value <= limit)} for measure, (value, limit) in measures.items()}
    aspects = [{"azimuth_deg": azimuth, "frequency_hz": hertz, LEVEL: theirs[f, a], "kirchhoff_db": kirchhoff[f, a],
                "kirchhoff_bound_db": either(bound[f, a]), "boundary_elements_db": either(published[f, a]),
                "minus_kirchhoff_db": theirs[f, a] - kirchhoff[f, a],
                "minus_boundary_elements_db": either(theirs[f, a] - published[f, a]),
                "kirchhoff_minus_boundary_elements_db": either(kirchhoff[f, a] - published[f, a])}
               for f, hertz in enumerate(scene["frequencies_hz"]) for a, azimuth in enumerate(scene["azimuths_deg"])]
    # A method agrees with one of the two references, because these differ by the error of the Kirchhoff approximation.
    return {"scene": name, "tests": scene["tests"], "measures": measures, "aspects": aspects,
            "level_db": {"kirchhoff": float(np.median(theirs - kirchhoff)), "boundary_elements": median(theirs - published)},
            "agrees": any(measure["kept"] for measure in measures.values())}


def either(value):
    return float(value) if np.isfinite(value) else None


def median(values):
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else None
