# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes an entry of the results folder from a report and a description of the run."""
import json

from .echoes import Refused

# Required keys of the description, with their meanings.
REQUIRED = {"engine": "name of the engine", "engine_version": "its version or commit", "submitted_by": "who ran it",
            "date": "day of the run, YYYY-MM-DD", "machine": "processor, cores, memory and operating system",
            "how": "commands or settings by which others repeat the run"}
OPTIONAL = {"url": "page of the engine", "licence": "its licence", "seconds": "run time of all scenes", "remarks": "any text"}


def read_description(file):
    try:
        content = json.loads(file.read_text())
    except (OSError, ValueError) as error:
        raise Refused(f"{file}: cannot read the description of the run: {error}") from error
    if not isinstance(content, dict):
        raise Refused(f"{file}: expected an object with the keys {', '.join(REQUIRED)}")
    for key, meaning in REQUIRED.items():
        if not isinstance(content.get(key), str) or not content[key].strip():
            raise Refused(f"{file}: no text '{key}' ({meaning}): add it")
    if unknown := content.keys() - REQUIRED.keys() - OPTIONAL.keys():
        raise Refused(f"{file}: unknown key '{min(unknown)}': the keys are {', '.join([*REQUIRED, *OPTIONAL])}")
    return content


def submission(report, description, relative):
    """An entry of the results folder: the description, and the figures of the report by scene."""
    scenes = {}
    for entry in report["scenes"]:
        kept = {"agrees": entry["agrees"]} if "agrees" in entry else {}
        if "refused" in entry:
            kept["refused"] = entry["refused"]
        else:
            kept |= {key: digits(entry["errors"][key]) for key in ("l1_error", "energy_ratio_db") if "errors" in entry}
            kept["measures"] = {name: {"value": digits(measure["value"]), "standard_error": digits(measure["standard_error"]),
                                       "limit": measure["limit"], "kept": measure["kept"]}
                                for name, measure in entry.get("measures", {}).items()}
        scenes[entry["scene"]] = kept
    return {**description, "suite": report["suite"], "relative": relative, "removed_from_other_scenes": report["taken_off"],
            "missing": report["missing"], "scenes": scenes}


def digits(value):
    """Four digits, so that entries do not change with the last bits of a library."""
    return None if value is None else float(f"{float(value):.4g}")
