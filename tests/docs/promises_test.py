#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every promise of promises.md (for users: docs/limits.md) names tests, and they exist: promises_test.py BUILD_FOLDER"""

import fnmatch
import pathlib
import re
import subprocess
import sys

page = pathlib.Path(__file__).with_name("promises.md")
build = pathlib.Path(sys.argv[1])
listing = subprocess.run(["ctest", "-N"], cwd=build, capture_output=True, text=True, check=True).stdout
tests = re.findall(r"^ +Test +#\d+: (.+)$", listing, re.MULTILINE)
for program in build.glob("tests/*_tests"):
    suite = ""
    listing = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
    for line in listing.splitlines():
        name = line.split("  #")[0].rstrip()
        if line.startswith("  "):
            tests.append(suite + name.strip())
        else:
            suite = name
assert len(tests) > 1000, tests

promises, wrong = 0, []
in_table = False
for line in page.read_text().splitlines():
    if line.startswith("| promise | test |"):
        in_table = True
    elif not line.startswith("|"):
        in_table = False
    elif in_table and not line.startswith("|---"):
        promise, names = [cell.strip() for cell in line.strip("|").rsplit("|", 1)]
        patterns = re.findall(r"`([^`]+)`", names)
        if not patterns:
            wrong.append(f"no test shows: {promise}")
        wrong += [f"no test is called {p}: {promise}" for p in patterns if not fnmatch.filter(tests, p)]
        promises += 1

print(f"{promises} promises, {len(tests)} tests")
print("\n".join(wrong))
sys.exit(1 if wrong or promises < 20 else 0)
