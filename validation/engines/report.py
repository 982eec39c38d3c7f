# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of what was found in each engine, held against what is known to be wrong in it."""
import importlib
import math
import shutil

VERDICTS = ("found", "found, size off", "missed", "nothing to find", "found although 0")


def verdict(known, finding):
    """One of VERDICTS."""
    if finding is None:
        return "nothing to find" if known["may"] or known["size"] == 0 else "missed"
    if known["size"] == 0:
        return "found although 0"
    if known["size"] is None:
        return "found"
    off = abs(finding["size"] - known["size"])
    return "found" if off <= max(known["within"] * abs(known["size"]), 3 * finding["error"]) else "found, size off"


# One mistake may bear either name.
ALIKE = {"sample-shift": {"half-sample"}, "half-sample": {"sample-shift"}}


def matched(result):
    """(known, its finding or None) of each, and findings that nothing known explains."""
    findings = list(result["own"]["findings"])
    pairs = []
    for known in result["known"]:
        names = {known["fault"]} | ALIKE.get(known["fault"], set())
        finding = next((f for f in findings if f["fault"] in names), None)
        if finding:
            findings.remove(finding)
        pairs.append((known, finding))
    return pairs, findings


def number(value):
    if value is None:
        return "-"
    return f"{value:.0f}" if abs(value) >= 100 or value == int(value) else f"{value:+.2g}" if abs(value) < 0.1 else f"{value:+.2f}"


def said(finding):
    if finding is None:
        return "-"
    error = f" +- {finding['error']:.2g}" if finding["error"] else ""
    return f"`{finding['fault']}` {number(finding['size'])}{error}" if finding["unit"] else f"`{finding['fault']}`"


def count(results):
    """How many known faults got each verdict, and how many findings nothing explains."""
    counts, unexplained = dict.fromkeys(VERDICTS, 0), 0
    for scenes in results.values():
        for result in scenes.values():
            pairs, others = matched(result)
            unexplained += len(others)
            for known, finding in pairs:
                counts[verdict(known, finding)] += 1
    return counts, unexplained


def decibel(value):
    return f"{value:+.1f} dB" if value is not None and math.isfinite(value) else "-"


def section(name, scenes, shown):
    engine = importlib.import_module(name)
    about = engine.__doc__.strip().split("\n\n", 1)
    version = next(iter(scenes.values())).get("version")
    lines = [f"## {engine.TITLE}", "", about[0].replace("\n", " "), "", about[1].replace("\n", " ") if len(about) > 1 else "", ""]
    lines += [f"Version: {version}.", ""] if version else []
    lines += ["```text", f"validation/engines/run.py build/release/tubefoot build/release/tubefoot_hurried_rays.so out/engines --engine {name}",
              "```", ""]
    lines += ["| scene | L1 | by sampling | RMS | missing echoes | echoes in shadows | overlap of shadows | L1 as energies | range dependence as energies |",
              "|---|---|---|---|---|---|---|---|---|"]
    for scene, result in scenes.items():
        own, joules = result["own"], result.get("joules")
        sampling = f"{100 * own['ideal']['explains']:.0f} %" if "ideal" in own else "-"
        lines.append(f"| {scene} | {own['l1_error']:.3g} | {sampling} | {own['rms_db_error']:.2f} dB | {own['empty_where_lit']} of {own['lit_bins']} | "
                     f"{own['lit_where_shadow']} of {own['shadow_bins']} | {own['shadow_overlap']:.3f} | "
                     + (f"{joules['l1_error']:.3g} | r^{joules['fit']['range_exponent']:+.2f} |" if joules else "- | - |"))
    lines += ["", f"Imported with `{next(iter(scenes.values()))['import']['options']}`. Warnings of `tubefoot import` against the reference in these units:", "",
              "| scene | warnings |", "|---|---|"]
    lines += [f"| {scene} | {'; '.join(result['import']['said']) or 'nothing'} |" for scene, result in scenes.items()]
    lines += ["", "| scene | known by construction | size | finding | |", "|---|---|---|---|---|"]
    for scene, result in scenes.items():
        pairs, others = matched(result)
        for known, finding in pairs:
            if finding is None and known["may"]:
                continue
            why = f": {known['why']}" if known["why"] else ""
            lines.append(f"| {scene} | `{known['fault']}`{why} | {number(known['size'])} {known['unit'] if known['size'] is not None else ''} | "
                         f"{said(finding)} | {verdict(known, finding)} |")
        for finding in others:
            lines.append(f"| {scene} | nothing | | {said(finding)}: {finding['words']} | **not explained** |")
    if shown in scenes:
        lines += ["", f"![reference in the units of the engine, picture of the engine, and their ratio](pictures/engine-{name.replace('_', '-')}.png)"]
    return lines + [""]


def write_page(page, template, results, folder, shown):
    template = template.read_text()
    counts, unexplained = count(results)
    table = ["| verdict | known faults |", "|---|---|"] + [f"| {name} | {counts[name]} |" for name in VERDICTS]
    table += [f"| finding without a known cause | {unexplained} |", ""]
    body = []
    for name, scenes in results.items():
        body += section(name, scenes, shown)
        picture = folder / shown / name / "own.png"
        if picture.exists():
            shutil.copy(picture, page.parent / "pictures" / f"engine-{name.replace('_', '-')}.png")
    page.write_text(template.replace("@VERDICTS@", "\n".join(table)).replace("@ENGINES@", "\n".join(body).rstrip()))
