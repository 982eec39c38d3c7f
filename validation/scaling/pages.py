# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of what was measured and predicted, and its figures."""
import concurrent.futures

import numpy

import plot
from cost import exponent
from dealing import Costs, Dealing, correlation, predict, resampled

PINGS, RANKS, BLOCK, SEED = 100000, (1, 10, 100, 1000), 20, 1
# Of a cluster: what no machine by itself tells.
LINK_BYTES_S, DISK_BYTES_S = 1.25e9, 1e9

SERIES = {  # name: (title, x axis, row -> x, what a second's worth is counted in)
    "seen": ("Footprints seen", "footprints per ping", lambda row: row["footprints"]),
    "outside": ("Facets outside the fan", "facets of the scene", lambda row: row["facets"]),
    "hidden": ("Facets in the fan, hidden", "hidden facets", lambda row: row["value"]),
    "beams": ("Beams in the same fan", "beams", lambda row: row["value"]),
    "samples": ("Range samples", "samples", lambda row: row["value"]),
    "orders": ("Order of paths (shallow water)", "order", lambda row: row["value"]),
}


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head),
                      *("| " + " | ".join(map(str, row)) + " |" for row in rows)]) + "\n"


def number(value, digits=3):
    if value == 0 or abs(value) >= 1000:
        return f"{value:.0f}"
    return f"{float(f'{value:.{digits}g}'):g}"


def cost_part(measured, figures):
    panels, text, summary = [], [], []
    for name, (title, words, x_of) in SERIES.items():
        rows = measured[name]
        x, seconds = [x_of(row) for row in rows], [row["seconds"] for row in rows]
        milli = {"ping": seconds, "visibility": [r["visibility"] for r in rows], "echo": [r["echo"] for r in rows]}
        panels.append(plot.panel(title, words, "ms per ping", {key: (x, [1000 * s for s in found]) for key, found in milli.items()},
                                 log=(name != "orders", True),
                                 limits=(None, None, None, 3000 * max(seconds))))
        orders = name == "orders"  # of which a power law says nothing
        summary.append([title, f"{number(x[0])} to {number(x[-1])}", f"{number(1000 * seconds[0])} to {number(1000 * seconds[-1])}",
                        "-" if orders else number(exponent(x[:3], seconds[:3]), 2),
                        "-" if orders else number(exponent(x, seconds), 2),
                        number(1e6 * (seconds[-1] - seconds[-2]) / (x[-1] - x[-2]))])
        text += [f"### {title}\n", table(
            [words, "facets of the scene", "footprints", "images", "visibility, ms", "echo, ms", "ping, ms"],
            [[number(a), row["facets"], f"{row['footprints']:.0f}", f"{row['images']:.0f}", number(1000 * row["visibility"]),
              number(1000 * row["echo"]), number(1000 * row["seconds"])] for a, row in zip(x, rows)])]
    plot.sheet(figures / "scaling-cost.svg", panels)
    return "\n".join([table(["varied", "over", "ms per ping", "exponent of the first three values", "of the last three values",
                             "us per additional unit, at the end"], summary), *text])


def costs_of(row, lead, ranks, cluster):
    message, byte = lead["message"], lead["byte"]
    link = 1 / LINK_BYTES_S if cluster else 0
    settings = row["settings"]
    launch = max(0.0, settings["2 ranks, 1 thread each"]["wall"] - settings["2 ranks, 1 thread each"]["total"])
    return Costs(load=row["load"] + (row["scene_bytes"] * ranks / DISK_BYTES_S if cluster else 0),
                 result=message + row["sent_bytes"] * (byte + link), request=message, write=row["write"],
                 finish=row["write_fixed"],
                 launch=launch if ranks > 1 else 0)


def worked(row):
    return numpy.array(row["pings"]) + max(0.0, row["besides"])


def check_part(found, lead):
    rows = []
    for name, row in found.items():
        one, two = (row["settings"][s] for s in ("1 process, 1 thread", "2 ranks, 1 thread each"))
        threads = row["settings"]["1 process, 2 threads"]
        predicted = [Dealing(worked(row), ranks, 1, costs_of(row, lead, ranks, False)).end for ranks in (1, 2)]
        rows.append([name, len(row["pings"]), number(one["simulation"]), number(predicted[0]), number(two["simulation"]),
                     number(predicted[1]), number(one["simulation"] / 2 / two["simulation"], 2),
                     number(one["simulation"] / 2 / threads["simulation"], 2),
                     number(predicted[0] / 2 / predicted[1], 2), number(one["total"] / 2 / two["total"], 2),
                     number(one["processor"]), number(two["processor"])])
    return table(["scene", "pings", "1 rank, s", "predicted", "2 ranks, s", "predicted", "efficiency", "of 2 threads",
                  "predicted", "of the whole run", "processor s, 1 rank", "2 ranks"], rows)


def scene_predictions(row, lead):
    """[(ranks, as it is, files beside the simulation, ranks keep and write their own)]."""
    seconds = resampled(worked(row), PINGS, BLOCK, SEED)
    found = []
    for ranks in RANKS:
        costs = costs_of(row, lead, ranks, True)
        now = predict(seconds, ranks, 1, costs)
        before = now["parts"]["launch and load"]
        beside = before + max(now["simulation"], costs.write * PINGS) + costs.finish
        costs.result = lead["message"]
        own = before + costs.write * PINGS / ranks + costs.finish
        own += Dealing(seconds, ranks, 1, costs).end if ranks > 1 else now["simulation"]
        found.append((ranks, now, beside, own))
    return found


def dealing_part(found, lead, figures):
    shape = []
    for name, row in found.items():
        pings = numpy.array(row["pings"])
        shape.append([name, len(pings), number(1000 * pings.mean()), number(pings.std() / pings.mean(), 2),
                      number(pings.max() / pings.mean(), 2), number(correlation(pings), 2),
                      number(row["store_bytes"] / 1000), number(row["sent_bytes"] / 1000), number(1e6 * costs_of(row, lead, 2, True).result),
                      number(row["load"]), number(1000 * row["write"])])
    text = [table(["scene", "pings", "mean, ms", "deviation / mean", "largest / mean", "correlation of adjacent pings", "kB per ping", "kB sent",
                   "us of rank 0 per ping", "load, s", "writing, ms per ping"], shape)]
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        predicted = dict(zip(found, pool.map(scene_predictions, found.values(), [lead] * len(found))))
    rows, panels = [], []
    for name, cases in predicted.items():
        alone = cases[0][1]["total"]
        for ranks, now, beside, own in cases:
            parts = now["parts"]
            others = {key: seconds for key, seconds in parts.items() if key != "pings"}
            limit = max(others, key=others.get) if ranks > 1 else "-"
            rows.append([name, ranks, number(now["total"], 4), number(alone / now["total"]), number(alone / now["total"] / ranks, 2),
                         *(number(max(0.0, round(seconds, 2))) for seconds in parts.values()), f"{100 * now['lead_busy']:.0f} %",
                         limit, *(number(alone / other / ranks, 2) if ranks > 1 else "-" for other in (beside, own))])
    text.append(table(["scene", "ranks", "total, s", "speed-up", "efficiency", *(f"{key}, s" for key in cases[0][1]["parts"]),
                       "rank 0 busy", "largest loss", "efficiency, files during the simulation",
                       "efficiency, each rank writes its own files"], rows))
    share = {name: (numpy.arange(len(row["pings"])) / (len(row["pings"]) - 1),
                    numpy.sort(row["pings"]) / numpy.mean(row["pings"]), {"line"}) for name, row in found.items()}
    panels.append(plot.panel("Seconds of pings, relative to their mean", "share of faster pings", "relative to the mean", share))
    for title, which in (("Predicted efficiency", None), ("..., files during the simulation", 2), ("..., each rank writes its own files", 3)):
        panels.append(plot.panel(title, "ranks", "efficiency", {
            name: (RANKS, [1, *(cases[0][1]["total"] / case[0] / (case[which] if which else case[1]["total"]) for case in cases[1:])])
            for name, cases in predicted.items()}, log=(True, False), limits=(None, None, 0, 1.05), corner="lowleft"))
    plot.sheet(figures / "scaling-dealing.svg", panels)
    return "\n".join(text)


def page(measured, figures):
    lead = measured["lead"]
    return "\n".join([
        "# Cost of pings and scaling of runs: measurements", "",
        "`make scaling` writes this page; [validation/performance.md](../validation/performance.md) explains it. Load average of the machine at the start",
        f"and at the end of the measurements: {measured['load_average'][0]:.1f} and {measured['load_average'][1]:.1f}, on "
        f"{measured['cores']} cores. Seconds of pings are the minimum of {measured['rounds']} interleaved rounds.", "",
        *(["**The load of the machine was larger than its number of cores**: seconds of two ranks, of rank 0, of writing and of",
           "distributed pings are too large by different factors. Repeat the measurement on an idle machine.", ""]
          if max(measured["load_average"]) > measured["cores"] + 1 else []),
        "## A ping", "", cost_part(measured["cost"], figures),
        "## One and two ranks", "",
        "Seconds of the simulation (minimum of the rounds), and the predictions of the simulated distribution of pings. Efficiency is the",
        "time of one rank divided by twice the time of two ranks. Processor seconds are those of the whole run with all ranks.", "",
        check_part(measured["ranks"], lead),
        "## Rank 0", "",
        "The main thread of rank 0 receives pings and answers requests. It sleeps for a millisecond if there are no messages.", "",
        table(["bytes per ping", "bytes sent", "pings from other ranks", "sleeps", "processor s"],
              [[run["bytes"], number(run["sent"]), number(run["results"]), number(run["sleeps"]), number(run["seconds"])] for run in lead["runs"]]),
        f"The best fit is {1e3 * lead['once']:.0f} ms per run, {1e6 * lead['message']:.0f} us per ping, "
        f"{1e9 * lead['byte']:.2f} ns per sent byte and {1e6 * lead['sleep']:.0f} us per sleep.", "",
        f"## Distribution of {PINGS} pings", "",
        f"Each rank has one thread. Pings are blocks of {BLOCK} adjacent pings, drawn from the measured pings (seed {SEED}). Two values are",
        f"assumed: a link of {LINK_BYTES_S / 1e9:g} GB/s to rank 0, and a shared disk with {DISK_BYTES_S / 1e9:g} GB/s while all ranks load.", "",
        dealing_part(measured["ranks"], lead, figures)]) + "\n"
