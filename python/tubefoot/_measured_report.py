# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of the comparison of a measured with a simulated water column. Part of :mod:`tubefoot.measured`."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _measured_study as _study
from ._errors import UsageError
from ._measured_echoes import library
from ._measured_figures import BLOCK_DEG, decibels

LIST = ".tubefoot-files"  # names of the files that tubefoot wrote, one per line


def check_folder(folder: str, inputs: Sequence[str]) -> None:
    """Rejects a folder with files that tubefoot did not write, and the folder of an input file."""
    if os.path.exists(folder) and not os.path.isdir(folder):
        raise UsageError(f"{folder} is not a folder: choose another folder with -o")
    names = set(os.listdir(folder)) if os.path.isdir(folder) else set()
    ours = set()
    if LIST in names:
        with open(os.path.join(folder, LIST), encoding="utf-8") as file:
            ours = {LIST, *file.read().splitlines()}
    if names - ours:
        raise UsageError(f"{folder} contains {sorted(names - ours)[0]!r}, which tubefoot did not write: choose another folder "
                         "with -o, or remove the file")
    for name in inputs:
        place = name if os.path.isdir(name) else os.path.dirname(os.path.abspath(name))
        if os.path.realpath(place) == os.path.realpath(folder):
            raise UsageError(f"{folder} contains the input file {name}, which the comparison would remove: choose another "
                             "folder with -o")


def write(comparison: _study.Comparison, measured: str, simulated: str, folder: str) -> None:
    """Writes the table, the report, the fitted material and the pictures. Earlier files of a comparison are removed."""
    check_folder(folder, (measured, simulated))
    pictures = _pictures(comparison)
    os.makedirs(folder, exist_ok=True)
    for name in os.listdir(folder):
        os.remove(os.path.join(folder, name))
    known = bool(comparison.material) and "strength_db" in comparison.material[0]
    seabed = _study.seabed_table(comparison.material) if known else []
    names = ["table.csv", "fitted_material.csv", "report.md", *(["seabed_table.csv"] if seabed else []),
             *(name for name, _ in pictures)]
    with open(os.path.join(folder, LIST), "w", encoding="utf-8") as file:
        file.write("\n".join(names) + "\n")
    _write_csv(os.path.join(folder, "table.csv"), _study.COLUMNS, comparison.rows)
    columns = list(comparison.material[0]) if comparison.material else ["mode", "sector", "frequency_khz", "grazing_deg",
                                                                        "ratio_db", "ratio_low_db", "ratio_high_db"]
    _write_csv(os.path.join(folder, "fitted_material.csv"), columns, comparison.material)
    if seabed:
        with open(os.path.join(folder, "seabed_table.csv"), "w", encoding="utf-8") as file:
            file.write("# Grazing angle in degrees, backscattering strength in dB. The level of the sonar is not calibrated.\n")
            file.writelines(f"{angle:g}, {level:.3f}\n" for angle, level in seabed)
    with open(os.path.join(folder, "report.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(_report(comparison, measured, simulated, [name for name, _ in pictures])) + "\n")
    for name, figure in pictures:
        figure.savefig(os.path.join(folder, name), dpi=110, metadata={"Software": None})


def _number(value: Any) -> str:
    if not isinstance(value, float):
        return str(value)
    return f"{value:.6g}" if np.isfinite(value) else ""


def _safe(text: str) -> str:
    """Text of a CSV file that a spreadsheet must not evaluate (docs/output-files.md)."""
    return "'" + text if text[:1] in "=+-@" and not re.fullmatch(r"-?[0-9.e+-]*", text) else text


def _write_csv(name: str, columns: Sequence[str], rows: Sequence[dict[str, Any]]) -> None:
    with open(name, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(columns)
        table.writerows([_safe(_number(row[column])) for column in columns] for row in rows)


def _described(row: dict[str, Any]) -> str:
    where = "" if row["sector"] == "" else f" sector {row['sector']}"
    angle = "" if np.isnan(row["angle_from_deg"]) else f" {row['angle_from_deg']:g}-{row['angle_to_deg']:g}°"
    return f"{row['quantity']}, {row['mode']}{where}{angle}"


def _with_interval(row: dict[str, Any], side: str) -> str:
    value, low, high = (row[side + end] for end in ("", "_low", "_high"))
    if np.isnan(value):
        return ""
    return f"{value:.3g}" + (f" ({low:.3g} to {high:.3g})" if np.isfinite(low) and np.isfinite(high) else "")


def summary(comparison: _study.Comparison) -> list[str]:
    """Returns the lines that the command prints."""
    predicted = [row for row in comparison.rows if row["kind"] == "predicted"]
    known = [row for row in predicted if row["overlap"]]
    differ = [row for row in known if row["overlap"] == "no"]
    lines = [f"{len(comparison.rows)} figures, of which {len(predicted)} are predicted; {comparison.resamples} resamples, seed "
             f"{comparison.seed}",
             f"the 95 % intervals overlap for {len(known) - len(differ)} of {len(known)} predicted figures with both intervals"]
    if len(known) < len(predicted):
        lines.append(f"{len(predicted) - len(known)} predicted figures have no interval, for example because there are too few "
                     "pings")
    counts: dict[str, list[str]] = {}
    for row in differ:
        counts.setdefault(row["quantity"], []).append(_described(row).split(", ", 1)[1])
    for quantity, rows in counts.items():
        total = sum(row["quantity"] == quantity for row in known)
        lines.append(f"{quantity}: {len(rows)} of {total} do not overlap: {'; '.join(rows[:3])}{'; ...' if len(rows) > 3 else ''}")
    return lines + [f"note: {note}" for note in comparison.notes]


def _report(comparison: _study.Comparison, measured: str, simulated: str, pictures: Sequence[str]) -> list[str]:
    lines = ["# Measured and simulated water column", "",
             f"This report compares {os.path.basename(os.path.normpath(measured))} (measured) with "
             f"{os.path.basename(os.path.normpath(simulated))} (simulated). "
             "The same estimators process both files. Values in parentheses are 95 % intervals of a bootstrap with "
             f"{comparison.resamples} resamples and the seed {comparison.seed}. The bootstrap resamples blocks of at least "
             f"{BLOCK_DEG:g} degrees of neighbouring beams of one ping, sector and side.", "",
             "Fitted figures come from the measured file. Predicted figures do not.", "", "## Summary", ""]
    lines += [f"- {line}" for line in summary(comparison)] + ["", "## What does not agree", ""]
    differ = [row for row in comparison.rows if row["overlap"] == "no" and row["kind"] == "predicted"]
    lines += [f"- {_described(row)}: measured {_with_interval(row, 'measured')} {row['unit']}, simulated "
              f"{_with_interval(row, 'simulated')} {row['unit']}" for row in differ] or ["All intervals overlap."]
    for quantity, meaning in _study.QUANTITIES.items():
        rows = [row for row in comparison.rows if row["quantity"] == quantity]
        if not rows:
            continue
        lines += ["", f"## {quantity}", "", f"{meaning}. Unit: {rows[0]['unit']}. This figure is {rows[0]['kind']}.", "",
                  "| mode | sector | frequency (kHz) | angle (degrees) | measured | simulated | overlap |",
                  "|---|---|---|---|---|---|---|"]
        for row in rows:
            angle = "" if np.isnan(row["angle_from_deg"]) else f"{row['angle_from_deg']:g} to {row['angle_to_deg']:g}"
            lines.append(f"| {row['mode']} | {row['sector']} | {_number(row['frequency_khz'])} | {angle} | "
                         f"{_with_interval(row, 'measured')} | {_with_interval(row, 'simulated')} | {row['overlap']} |")
    lines += ["", "## Pictures", ""]
    lines += [f"![{name.removesuffix('.png')}]({name})" for name in pictures]
    return lines


def _pictures(comparison: _study.Comparison) -> list[tuple[str, Any]]:
    figure_class = library("matplotlib.figure", "the report").Figure
    out = []
    for mode in comparison.fans:
        word = re.sub(r"[^A-Za-z0-9_.-]", "_", mode)
        out.append((f"{word}-fan.png", _fan(figure_class, mode, comparison.fans[mode])))
        curves = {key: value for key, value in comparison.curves.items() if key[0] == mode}
        if curves:
            out.append((f"{word}-extent.png", _extent(figure_class, curves)))
        rows = [row for row in comparison.material if row["mode"] == mode]
        if rows:
            out.append((f"{word}-response.png", _response(figure_class, mode, rows)))
    return out


def _fan(figure_class: Any, mode: str, fan: dict[str, Any]) -> Any:
    """Draws the first ping of both files, starboard against depth, in decibels relative to the largest energy of each."""
    figure = figure_class(figsize=(14, 5), layout="constrained")
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    order = np.argsort(fan["angle"])
    theta = np.radians(fan["angle"][order])[:, None]
    near = fan["range"] > 1
    starboard, depth = fan["range"][near] * np.sin(theta), fan["range"][near] * np.cos(theta)
    for axis, side in zip(axes, ("measured", "simulated")):
        energy = fan[side][order][:, near]
        level = decibels(energy / max(energy.max(), 1e-300))
        image = axis.pcolormesh(starboard, depth, np.maximum(np.nan_to_num(level, nan=-60), -60), vmin=-60, vmax=0,
                                shading="gouraud", rasterized=True)
        axis.set(title=f"{mode}, {side}", xlabel="starboard (m)", ylabel="depth below the sonar (m)", aspect="equal")
    axes[0].invert_yaxis()
    figure.colorbar(image, ax=axes, label="dB relative to the largest energy beyond 1 m")
    return figure


def _extent(figure_class: Any, curves: dict[Any, dict[str, np.ndarray]]) -> Any:
    columns = min(3, len(curves))
    rows = -(-len(curves) // columns)
    figure = figure_class(figsize=(4.5 * columns, 3.2 * rows), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns, sharex=True, sharey=True)).ravel()
    for axis, ((mode, sector, low, high), curve) in zip(axes, curves.items()):
        for side, colour in (("measured", "C0"), ("simulated", "C1")):
            axis.plot(curve["x"], decibels(curve[side]), colour, label=side)
            ends = [decibels(np.maximum(curve[side + end], 1e-5)) for end in ("_low", "_high")]
            axis.fill_between(curve["x"], *ends, color=colour, alpha=0.25, linewidth=0)
        for level in (-3, -10):
            axis.axhline(level, color="0.7", linewidth=0.8)
        axis.set(title=f"{mode}, sector {sector}, {low:g}-{high:g}°", ylim=(-45, 3))
        axis.title.set_fontsize(9)
    for axis in axes[len(curves):]:
        axis.set_axis_off()
    axes[0].legend()
    figure.supxlabel("(r - R) / |dR/dθ| (degrees)")
    figure.supylabel("dB relative to the peak")
    return figure


def _response(figure_class: Any, mode: str, rows: Sequence[dict[str, Any]]) -> Any:
    figure = figure_class(figsize=(7, 4), layout="constrained")
    axis = figure.subplots()
    for k, sector in enumerate(sorted({row["sector"] for row in rows})):
        mine = [row for row in rows if row["sector"] == sector]
        grazing = [row["grazing_deg"] for row in mine]
        axis.plot(grazing, [row["ratio_db"] for row in mine], f"C{k}.-",
                  label=f"sector {sector}, {mine[0]['frequency_khz']:g} kHz")
        axis.fill_between(grazing, [row["ratio_low_db"] for row in mine], [row["ratio_high_db"] for row in mine], color=f"C{k}",
                          alpha=0.2, linewidth=0)
    axis.set(title=f"{mode}: echo energy, measured over simulated", xlabel="grazing angle (degrees)",
             ylabel="dB, with the unknown calibration")
    axis.legend()
    axis.grid(True, color="0.9")
    return figure
