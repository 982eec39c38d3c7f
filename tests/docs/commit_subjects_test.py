#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the subjects of commits since the rules of CONTRIBUTING.md apply: commit_subjects_test.py [--self-test]

A subject has at most 72 characters, begins with an imperative verb in upper case, has no full stop at its end, and names no
branch. Merges are not checked. Exit code 77 means skipped: there is no git, or the first commit is not in this clone.
"""
import pathlib
import re
import subprocess
import sys

FIRST = "e760b3a4"  # the last commit without the rules
LONGEST = 72
# Words that begin a subject that is not imperative: past tense, third person, gerunds, articles, prefixes of a part.
NOT_IMPERATIVE = re.compile(
    r"(?:\w+(?:ed|ing)|(?:Add|Allow|Build|Change|Check|Correct|Fix|Make|Move|Read|Remove|Rename|Test|Update|Use|Write|Reject|State|Keep)e?s"
    r"|The|A|An|This|That|These|All|Each|Every|No|Some|\w+:)$")
IMPERATIVE = {"Bring", "Embed", "Feed", "Need", "Seed", "Shed", "Speed", "Spring", "String", "Swing"}


def fault(subject):
    """The fault of a subject in words, or None."""
    first = subject.split(" ")[0]
    if len(subject) > LONGEST:
        return f"{len(subject)} characters, {LONGEST} is the limit"
    if not re.match(r"[A-Z]", first):
        return "begins with a lower-case letter"
    if first not in IMPERATIVE and NOT_IMPERATIVE.match(first):
        return f"'{first}' is not an imperative verb"
    if subject.endswith("."):
        return "ends with a full stop"
    if re.search(r"\b(?:branch|origin/|refs/|wip|WIP)", subject):
        return "names a branch"
    return None


def self_test():
    for subject in ("Read KMALL files", "Seed the fuzzers with limits", "Follow rays in layered water for a time"):
        assert fault(subject) is None, subject
    for subject in ("x" * 73, "Added a file", "Fixes a leak", "docs: new page", "read files", "Fix a leak.", "Merge branch a", "The file is read"):
        assert fault(subject), subject


def main():
    self_test()
    if sys.argv[1:] == ["--self-test"]:
        return 0
    root = pathlib.Path(__file__).resolve().parents[2]
    git = ["git", "-c", f"safe.directory={root}", "-C", str(root)]
    try:
        subprocess.run([*git, "merge-base", "--is-ancestor", FIRST, "HEAD"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        print(f"skipped: commit {FIRST} is not in the history of this folder")
        return 77
    log = subprocess.run([*git, "log", "--no-merges", "--format=%h %s", f"{FIRST}..HEAD"], check=True, capture_output=True, text=True)
    commits = [line.split(" ", 1) for line in log.stdout.splitlines()]
    wrong = [f"{commit}: {fault(subject)}: {subject}" for commit, subject in commits if fault(subject)]
    print("\n".join(wrong) or f"{len(commits)} subjects are as CONTRIBUTING.md says")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
