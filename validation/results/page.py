#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the page of results from the entries: page.py [--check]

Each file in `entries` must satisfy schema.json. The page has one table per scene, in which engines are sorted by name. There is no
single score. --check compares the page with the entries instead. Exit status: 1 for an invalid entry or an outdated page."""
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
PAGE, ENTRIES, SCHEMA = HERE.parent / "results.md", HERE / "entries", HERE / "schema.json"
TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "number": (int, float), "null": type(None)}
KEYWORDS = {"$schema", "$id", "title", "description", "type", "enum", "pattern", "required", "properties", "additionalProperties",
            "items"}


def faults(value, schema, where="entry"):
    """Yields the places where a value violates a schema. Only the keywords of schema.json are known."""
    if unknown := schema.keys() - KEYWORDS:
        raise ValueError(f"schema.json: unknown keyword {min(unknown)}")
    if "type" in schema:
        types = [schema["type"]] if isinstance(schema["type"], str) else schema["type"]
        if not any(isinstance(value, TYPES[t]) and not (t == "number" and isinstance(value, bool)) for t in types):
            yield f"{where}: expected {' or '.join(types)}"
            return
    if "enum" in schema and value not in schema["enum"]:
        yield f"{where}: expected one of {', '.join(schema['enum'])}"
    if "pattern" in schema and not re.search(schema["pattern"], value):
        yield f"{where}: '{value}' does not match {schema['pattern']}"
    if isinstance(value, list):
        for k, item in enumerate(value):
            yield from faults(item, schema.get("items", {}), f"{where}[{k}]")
    if isinstance(value, dict):
        for key in schema.get("required", []):
            if key not in value:
                yield f"{where}: no key '{key}'"
        known, others = schema.get("properties", {}), schema.get("additionalProperties", True)
        for key, item in value.items():
            if key in known:
                yield from faults(item, known[key], f"{where}.{key}")
            elif others is False:
                yield f"{where}: unknown key '{key}'"
            elif isinstance(others, dict):
                yield from faults(item, others, f"{where}.{key}")


def faults_of_entry(entry, schema):
    yield from faults(entry, schema)
    if isinstance(suite := entry.get("suite"), dict) and (suite.get("set") == "validation") != ("seed" in suite):
        yield "entry.suite: a validation set has a seed, and the debug set has none"


def cell(text):
    """Text in a table: no line breaks, no bars, no markup."""
    return re.sub(r"([|`*_<>\[\]\\])", r"\\\1", " ".join(str(text).split()))


def figure(measure):
    value = "unknown" if measure["value"] is None else f"{measure['value']:+.3g}"
    return value if measure["kept"] else f"**{value}**"


def unit(entry):
    """Unit of the energies, and what range-law has shown and compare.py has removed from the other scenes."""
    removed = entry["removed_from_other_scenes"]
    return ("own" if entry["relative"] else "J/m²") + (
        f"; {removed['gain_db']:+.1f} dB and r^{removed['range_exponent']:+.2f} removed" if removed else "")


def page(entries):
    lines = ["# Results of engines on the benchmark suite", "",
             "This page shows how engines solve the scenes of the [benchmark suite](reference/v3/README.md), for users who choose an "
             "engine and for developers.",
             "The script `validation/results/page.py` writes it from the entries. The [rules](results/README.md) explain how to submit "
             "results.", "",
             "Each scene tests one property, and there is no total score. Bold figures exceed the limit. The abbreviation *debug* marks "
             "scenes whose answers were known, and *validation* marks scenes that were drawn for the test.", "",
             "If an engine writes energies in its own unit, the columns *L1 error* and *energy in dB* are empty. A wrong gain or power "
             "of range in `range-law` is removed from its other scenes before they are judged.", "",
             "A target strength agrees if one of its two figures is within its limit: `kirchhoff_db` for the Kirchhoff "
             "approximation, or `boundary_db` for boundary elements.", "", "## Entries", "",
             "| engine | version | suite | set | unit of energy | who ran it | date | machine | scenes without result |",
             "|---|---|---|---|---|---|---|---|---|"]
    for entry in entries:
        name = f"[{cell(entry['engine'])}]({entry['url']})" if "url" in entry else cell(entry["engine"])
        mode = entry["suite"]["set"] + (f", seed '{cell(entry['suite']['seed'])}'" if "seed" in entry["suite"] else "")
        lines.append(f"| {name} | {cell(entry['engine_version'])} | {entry['suite']['version']} | {mode} | {unit(entry)} | "
                     f"{cell(entry['submitted_by'])} | {entry['date']} | {cell(entry['machine'])} | "
                     f"{', '.join(f'`{cell(scene)}`' for scene in entry['missing']) or 'none'} |")
    lines += ["", "The files in `validation/results/entries` contain the commands of each run, and further remarks.", ""]
    scenes = list(dict.fromkeys(scene for entry in entries for scene in entry["scenes"]))
    for scene in sorted(scenes):
        found = [(entry, entry["scenes"][scene]) for entry in entries if scene in entry["scenes"]]
        measures = list(dict.fromkeys(name for _, result in found for name in result.get("measures", {})))
        limits = {name: result["measures"][name]["limit"] for _, result in found for name in measures
                  if name in result.get("measures", {})}
        lines += [f"## {cell(scene)}", "",
                  "| engine | suite, set | " + " | ".join([*(f"{cell(name)} (limit {limits[name]:g})" for name in measures), "L1 error",
                                                           "energy in dB"]) + " |",
                  "|---|---|" + "---|" * (len(measures) + 2)]
        for entry, result in found:
            row = [f"{cell(entry['engine'])} {cell(entry['engine_version'])}", f"{entry['suite']['version']} {entry['suite']['set']}"]
            if "refused" in result:
                row += [f"not comparable: {cell(result['refused'])}"] + [""] * (len(measures) + 1)
            else:
                row += [figure(result["measures"][name]) if name in result["measures"] else "" for name in measures]
                row += ["" if result.get(key) is None or entry["relative"] else f"{result[key]:.3g}" for key in ("l1_error", "energy_ratio_db")]
            lines.append("| " + " | ".join(row) + " |")
        lines.append("")
    return "\n".join(lines)


def read_entries(folder=ENTRIES):
    schema, entries, wrong = json.loads(SCHEMA.read_text()), [], []
    for file in sorted(folder.glob("*.json")):
        try:
            entry = json.loads(file.read_text())
        except ValueError as error:
            wrong.append(f"{file.name}: not JSON: {error}")
            continue
        new = [f"{file.name}: {fault}" for fault in faults_of_entry(entry, schema)] if isinstance(entry, dict) else [
            f"{file.name}: expected an object"]
        wrong += new
        if not new:
            entries.append(entry)
    entries.sort(key=lambda entry: (entry["engine"].lower(), entry["engine_version"], entry["suite"]["version"], entry["suite"]["set"]))
    return entries, wrong


def main():
    entries, wrong = read_entries()
    text = page(entries)
    if sys.argv[1:] == ["--check"]:
        if not wrong and PAGE.read_text() != text:
            wrong.append(f"{PAGE.name} does not show the entries: run validation/results/page.py")
    elif sys.argv[1:]:
        sys.exit(__doc__)
    elif not wrong:
        PAGE.write_text(text)
        print(f"wrote {PAGE}")
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
