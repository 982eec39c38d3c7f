#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the results folder: the page shows the entries, the entries satisfy the schema, and violations are found."""
import copy
import json
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "validation" / "results"))
import page  # noqa: E402

SCHEMA = json.loads(page.SCHEMA.read_text())
ENTRY = {"engine": "e", "engine_version": "1", "submitted_by": "a", "date": "2026-11-30", "machine": "m", "how": "h",
         "suite": {"version": "3.0", "set": "debug"}, "relative": False,
         "removed_from_other_scenes": {"gain_db": 3.0, "range_exponent": 0.0}, "missing": ["gradient"],
         "scenes": {"grazing": {"agrees": False, "l1_error": 0.5, "energy_ratio_db": None, "measures": {
             "coarse_l1": {"value": 0.3, "standard_error": 0.0, "limit": 0.05, "kept": False}}}}}


def changed(change):
    entry = copy.deepcopy(ENTRY)
    change(entry)
    return entry


def test_faults_are_found():
    assert not list(page.faults_of_entry(ENTRY, SCHEMA))
    for change, expected in [
            (lambda e: e.pop("machine"), "no key 'machine'"),
            (lambda e: e.update(engine=" "), "does not match"),
            (lambda e: e.update(engine=3), "expected string"),
            (lambda e: e.update(score=1), "unknown key 'score'"),
            (lambda e: e.update(date="30.11.2026"), "does not match"),
            (lambda e: e.update(url="https://a.b/) [x](javascript:y"), "does not match"),
            (lambda e: e["suite"].update(set="both"), "expected one of debug, validation"),
            (lambda e: e["suite"].update(set="validation"), "a validation set has a seed"),
            (lambda e: e["suite"].update(seed="s"), "a validation set has a seed"),
            (lambda e: e.update(missing=[1]), "missing[0]: expected string"),
            (lambda e: e["scenes"]["grazing"]["measures"]["coarse_l1"].update(value="0.3"), "expected number or null"),
            (lambda e: e["scenes"]["grazing"]["measures"]["coarse_l1"].update(value=True), "expected number or null"),
            (lambda e: e["scenes"]["grazing"]["measures"]["coarse_l1"].pop("limit"), "no key 'limit'")]:
        found = list(page.faults_of_entry(changed(change), SCHEMA))
        assert any(expected in fault for fault in found), (expected, found)


def test_files_are_named():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "cut.json").write_text("{")
        (folder / "list.json").write_text("[]")
        (folder / "good.json").write_text(json.dumps(ENTRY))
        entries, wrong = page.read_entries(folder)
        assert entries == [ENTRY] and len(wrong) == 2, wrong
        assert wrong[0].startswith("cut.json: not JSON") and wrong[1] == "list.json: expected an object", wrong


def test_page_shows_each_scene_without_a_score():
    text = page.page([ENTRY, changed(lambda e: e.update(engine="other | *engine*"))])
    assert "## grazing" in text and "| **+0.3** |" in text and "`gradient`" in text
    assert "other \\| \\*engine\\*" in text
    assert "score" not in text.replace("no total score", "")


def test_page_shows_errors_of_energies_only_in_their_unit():
    def row(entry):
        return next(line for line in page.page([entry]).split("\n") if line.startswith("| e 1 |"))
    assert row(ENTRY).endswith("| **+0.3** | 0.5 |  |")
    assert row(changed(lambda e: e.update(relative=True))).endswith("| **+0.3** |  |  |")
    assert "| J/m²; +3.0 dB and r^+0.00 removed |" in page.page([ENTRY])
    assert "| own |" in page.page([changed(lambda e: e.update(relative=True, removed_from_other_scenes=None))])


def test_page_is_of_the_entries():
    entries, wrong = page.read_entries()
    assert not wrong, wrong
    assert page.PAGE.read_text() == page.page(entries), "run validation/results/page.py"


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"{name}: passed")
