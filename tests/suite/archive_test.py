#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the archive of the benchmark suite: archive_test.py PROGRAM

The archive has the same bytes twice, contains a whole suite, and has the metadata that DataCite 4 requires."""
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOOL, REFERENCE = ROOT / "tools" / "benchmark_archive", ROOT / "validation" / "reference"
RESOURCE_TYPES = {"Dataset", "Collection", "Software", "Model", "Other"}  # some of the controlled list, resourceTypeGeneral


def lacking(metadata):
    """The mandatory properties of DataCite 4 (https://schema.datacite.org) that metadata lack. A repository adds the identifier."""
    rules = {
        "creators": lambda v: bool(v) and all(c.get("name", "").strip() for c in v),
        "titles": lambda v: bool(v) and all(t.get("title", "").strip() for t in v),
        "publisher": lambda v: bool(v.get("name", "").strip()),
        "publicationYear": lambda v: isinstance(v, int) and 1000 <= v <= 9999,
        "types": lambda v: v.get("resourceTypeGeneral") in RESOURCE_TYPES and bool(v.get("resourceType", "").strip()),
        "schemaVersion": lambda v: v == "http://datacite.org/schema/kernel-4"}
    return [name for name, holds in rules.items() if name not in metadata or not holds(metadata[name])]


def cff(text):
    return dict(re.findall(r"^([\w-]+): \"?([^\"\n]*?)\"?$", text, re.M))


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True)


def main(program):
    published = json.loads((REFERENCE / "datacite.json").read_text())
    assert not lacking(published), lacking(published)
    for name in ("creators", "titles", "publisher", "publicationYear", "types", "schemaVersion"):
        assert lacking({key: value for key, value in published.items() if key != name}) == [name]
    citation = cff((REFERENCE / "CITATION.cff").read_text())
    assert citation["cff-version"] == "1.2.0" and citation["message"] and citation["type"] == "dataset", citation
    assert citation["title"] == published["titles"][0]["title"] and citation["version"] == published["version"], citation
    assert citation["license"] == published["rightsList"][0]["rightsIdentifier"], citation
    doi = "10.5281/zenodo.1234567"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for wrong in ("https://doi.org/10.5281/zenodo.1", "10.5281", "doi"):
            refused = run(TOOL, program, folder / "no", "--doi", wrong, "--scenes", "grazing")
            assert refused.returncode == 1 and "expected a DOI" in refused.stderr and not (folder / "no").exists(), refused
        for number in ("first", "second"):
            done = run(TOOL, program, folder / number, "--doi", doi, "--scenes", "grazing")
            assert done.returncode == 0, done.stderr
        names = sorted(os.listdir(folder / "first"))
        stem = f"tubefoot-benchmark-suite-{published['version']}"
        assert names == [f"{stem}.datacite.json", f"{stem}.zip", f"{stem}.zip.sha256"], names
        for name in names:
            assert (folder / "first" / name).read_bytes() == (folder / "second" / name).read_bytes(), name
        archive = folder / "first" / f"{stem}.zip"
        assert (folder / "first" / names[2]).read_text().split()[0] == hashlib.sha256(archive.read_bytes()).hexdigest()
        outside = json.loads((folder / "first" / names[0]).read_text())
        assert outside["doi"] == doi and outside["sizes"] == [f"{archive.stat().st_size} bytes"], outside
        with zipfile.ZipFile(archive) as zipped:
            assert zipped.testzip() is None
            assert all(name.startswith(stem + "/") and ".." not in name for name in zipped.namelist())
            zipped.extractall(folder / "out")
        suite = folder / "out" / stem
        inside = json.loads((suite / "datacite.json").read_text())
        assert not lacking(inside) and inside["doi"] == doi, inside
        assert cff((suite / "CITATION.cff").read_text())["doi"] == doi
        for name in ("LICENSE", "ERRATA.md", "README.md", "compare.py", "tubefoot_suite/__main__.py", "scenes/grazing/scene.json",
                     "answers/grazing/energy.npy"):
            assert (suite / name).is_file(), name
        assert not list(suite.rglob(".*")), list(suite.rglob(".*"))
        for part in (suite, suite / "answers"):
            summed = subprocess.run(["sha256sum", "-c", "--quiet", "SHA256SUMS"], cwd=part, capture_output=True, text=True)
            assert summed.returncode == 0, summed.stdout
        checked = run(sys.executable, suite / "compare.py", suite, suite / "answers")
        assert checked.returncode == 0 and "differs in: nothing" in checked.stdout, checked
        assert not list(suite.rglob("__pycache__"))
    print("archive: passed")


if __name__ == "__main__":
    try:
        import numpy  # noqa: F401  compare.py needs it
    except ImportError:
        print("skipped: NumPy is not installed (Debian: python3-numpy)")
        sys.exit(77)
    main(sys.argv[1])
