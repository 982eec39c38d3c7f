# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the echoes of a candidate with a reference, as `tubefoot compare` does, without tubefoot.

    compare.py SUITE RESULTS      a benchmark suite (v1, v2 or v3) and a folder of results
    compare.py REFERENCE CANDIDATE   two files of echoes: netCDF, or NumPy's .npy with the dimensions ping, beam, sample

The result of the scene NAME is NAME.npy, NAME.nc, NAME/energy.npy or NAME/echoes.nc. Derivatives are NAME-gradient.npy or
NAME/gradient.npy. Target strengths are NAME.csv or NAME/strength.csv. For a suite, the program prints which scenes agree, and which measures exceed their limits. The program needs
NumPy, and netCDF4 for netCDF files. Exit status: 0 all scenes agree; 3 some scenes differ; 2 the files cannot be compared."""
import argparse
import json
import pathlib
import sys

from .echoes import Refused, errors_of, sensors_of
from .judge import compare_suite, print_report
from .submission import OPTIONAL, REQUIRED, read_description, submission


def text_of(value):
    return json.dumps(value, indent=2, default=lambda number: number.item())


def print_errors(result):
    print(f"{result['name']}: {result['pings']} pings x {result['beams']} beams x {result['samples']} samples")
    for key in ("l1_error", "rms_db_error", "energy_ratio", "empty_where_lit", "lit_bins", "lit_where_shadow", "shadow_bins",
                "first_return", "within_bound"):
        measures = result[key].items() if isinstance(result[key], dict) else [("", result[key])]
        for part, value in measures:
            print(f"  {(key + ' ' + part).strip():<38} {value if value is None else format(value, '.6g')}")
    for place in result["worst_bins"]:
        print("  worst bin: ping {ping}, beam {beam}, sample {sample} at {slant_range_m:.3f} m: {candidate_j:.4g} J/m2 "
              "for {reference_j:.4g} J/m2, {error_db:+.3g} dB".format(**place))


def compare_files(reference, candidate, as_json):
    (references, hash_r), (candidates, hash_c) = sensors_of(reference), sensors_of(candidate)
    if hash_r and hash_c and hash_r != hash_c:
        raise Refused(f"scene_hash is {hash_c}, but the reference has {hash_r}: compute the same scene")
    if len(references) == len(candidates) == 1:  # their names may differ
        candidates = dict(zip(references, candidates.values()))
    if missing := set(references) - set(candidates):
        raise Refused(f"{candidate}: no sensor {', '.join(sorted(missing))}")
    results = [errors_of(name, echoes, candidates[name]) for name, echoes in references.items()]
    if as_json:
        print(text_of({"sensors": results}))
        return
    for result in results:
        print_errors(result)


def run(options):
    if not pathlib.Path(options.reference).is_dir():
        for option, given in (("--relative", options.relative), ("--describe", options.describe)):
            if given:
                raise Refused(f"{option} needs the folder of a suite, but {options.reference} is a file")
        compare_files(options.reference, options.candidate, options.json)
        return 0
    description = options.describe and read_description(pathlib.Path(options.describe))
    report = compare_suite(pathlib.Path(options.reference), pathlib.Path(options.candidate), options.relative)
    if description:
        print(text_of(submission(report, description, options.relative)))
    elif options.json:
        print(text_of(report))
    else:
        print_report(report)
    return 3 if any(entry.get("agrees") is False for entry in report["scenes"]) else 0


def main():
    parser = argparse.ArgumentParser(prog="compare.py", description="Compare the echoes of a candidate with a reference.",
                                     formatter_class=argparse.RawDescriptionHelpFormatter, epilog=__doc__.split("\n\n", 1)[1])
    parser.add_argument("reference", help="folder of a benchmark suite, or file of echoes")
    parser.add_argument("candidate", help="folder of results, or file of echoes")
    parser.add_argument("--json", action="store_true", help="print all measures, named as tubefoot compare names them")
    parser.add_argument("--relative", action="store_true", help="for a suite: accept energies in any one unit")
    parser.add_argument("--describe", metavar="FILE",
                        help="for a suite: print an entry of the results folder instead. FILE is a JSON object with the keys "
                        f"{', '.join(REQUIRED)}, and optionally {', '.join(OPTIONAL)}")
    try:
        sys.exit(run(parser.parse_args()))
    except Refused as refused:
        print(refused, file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
