#!/usr/bin/env python3
"""Weaves the public meshes and lets the independent package checker judge every package.

usage: check_packages.py LEAFCUTTER SHARED [--all | --files NAME…] [--mode MODE] [--set A.B=VALUE]…
                         [--junctions KIND] [--third] [--two] [--timeout S] [--markdown FILE] [--keep DIR]

Without --all or --files a quick selection with one mesh of each kind; --all takes every mesh there is. --third
weaves each once more with strips a third as wide, --two runs two at a time. Cylinders are woven one by one,
as one with --junctions conforming. Prints a table, as Markdown to a file if wished; exit status 1 if anything is at fault,
77 (skipped) where the shared data isn't there.
"""
import argparse
import dataclasses
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# A file and what is set for it: a rectangle, rings, a torus; pants, one-form, limbs with holes, a pillowcase.
QUICK = [("flat-square.off", []), ("cylinder.off", []), ("torus.off", []), ("face-gu.off", []), ("nefertiti.off", []),
         ("knot.obj", []), ("fertility.off", []), ("hand-6-boundaries.obj", ["foliation.mode=one-form"]),
         ("hand-closed.obj", []), ("spot.obj", ["foliation.mode=sphere-pillowcase"])]
MESHES = {".off", ".obj", ".ply", ".stl"}
KERF_AND_SPACING = ["--kerf", "0.1", "--spacing", "1"]
COLUMNS = ["file", "genus", "bounds", "mode", "sing.", "cyl.", "holes", "energy", "flux", "gap", "largest", "CV", "removed",
           "quads", "s", "MB", "faults", "first warning"]


@dataclasses.dataclass
class Outcome:
    name: str
    settings: list
    seconds: float = 0.0
    peak_mb: float = 0.0
    report: dict = dataclasses.field(default_factory=dict)
    faults: list = dataclasses.field(default_factory=list)


def run_measured(command, timeout):
    """(exit status, stderr, seconds, peak MB); exit status None where time was up."""
    begun = time.monotonic()
    with tempfile.TemporaryFile("w+") as errors:
        # A session of its own, so that a child of it is ended with it.
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True)
        late = threading.Event()

        def stop():
            late.set()
            os.killpg(process.pid, signal.SIGKILL)

        timer = threading.Timer(timeout, stop)
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)  # Waited for: Popen needn't.
        errors.seek(0)
        said = errors.read().strip()
    seconds = time.monotonic() - begun
    return None if late.is_set() else process.returncode, said, seconds, usage.ru_maxrss / 1024.0


def weave_and_check(arguments, mesh, settings, out):
    outcome = Outcome(mesh.name, settings)
    options = [word for setting in settings for word in ("--set", setting)]
    status, said, outcome.seconds, outcome.peak_mb = run_measured(
        [arguments.leafcutter, "weave", str(mesh), "-o", str(out), *options], arguments.timeout)
    if status != 0:
        outcome.faults = [f"weave: no end after {arguments.timeout} s" if status is None else f"weave: exit {status}: {said}"]
        return outcome
    outcome.report = json.loads((out / "report.json").read_text())
    checked = subprocess.run(
        ["/usr/bin/python3", str(Path(arguments.shared) / "tools/check_package.py"), str(out), str(mesh), "--json",
         *KERF_AND_SPACING], capture_output=True, text=True)
    try:
        outcome.faults = json.loads(checked.stdout[:checked.stdout.rindex("}") + 1])["fails"]
    except ValueError:
        outcome.faults = [f"checker: {checked.stderr.strip()[-300:]}"]
    return outcome


def prongs_of(foliation):
    counts = {}
    for point in foliation["singularities"]:
        counts[point["prongs"]] = counts.get(point["prongs"], 0) + 1
    return " ".join(f"{count}x{prongs}" for prongs, count in sorted(counts.items())) or "-"


def cells(outcome):
    """The row of a package, one text per column."""
    last = [f"{outcome.seconds:.1f}", f"{outcome.peak_mb:.0f}", str(len(outcome.faults))]
    report = outcome.report
    if not report:
        return [outcome.name] + [""] * (len(COLUMNS) - 5) + last + [outcome.faults[0][:160]]
    foliation = report["foliation"]
    worst = {key: max((cylinder[key] for cylinder in foliation["cylinders"]), default=0.0)
             for key in ("flux_mismatch", "conformal_gap")}
    spread = foliation["cell_spread"]
    warning = report["warnings"][0][:110] if report["warnings"] else ""
    return [outcome.name, str(report["topology"]["genus"]), str(report["topology"]["boundary_loops"]), foliation["mode"],
            prongs_of(foliation), str(len(foliation["cylinders"])), str(len(foliation["punctures"])),
            f"{foliation['energy']:.6g}", f"{worst['flux_mismatch']:.1e}", f"{100 * worst['conformal_gap']:.2f} %",
            f"{spread['largest_edge']:.2f}", f"{spread['variation']:.2f}",
            f"{report['surface']['removed_area_percent']:.2f} %", str(report["quality"]["overall"]["quads"]), *last, warning]


def plain_table(rows):
    widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip() for row in rows)


def markdown_table(rows):
    lines = ["| " + " | ".join(text.replace("|", "\\|") for text in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + " --- |" * len(COLUMNS), *lines[1:]]) + "\n"


def selection(arguments, folder):
    if arguments.all:
        named = [(path.name, []) for path in sorted(folder.iterdir()) if path.suffix in MESHES]
    else:
        named = [(name, []) for name in arguments.files] if arguments.files else QUICK
    mode = [f"foliation.mode={arguments.mode}"] if arguments.mode else []
    base = [f"grid.junctions={arguments.junctions}", *arguments.set]
    cases = [(name, [*base, *own, *mode]) for name, own in named]
    if arguments.third:
        cases += [(name, [*settings, "grid.strip_width_mm=3.3333333"]) for name, settings in cases]
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("leafcutter")
    parser.add_argument("shared")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--files", nargs="+", default=[])
    parser.add_argument("--mode")
    parser.add_argument("--junctions", choices=["conforming", "independent"], default="independent")
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--third", action="store_true")
    parser.add_argument("--two", action="store_true")
    parser.add_argument("--timeout", type=float, default=600.0)
    parser.add_argument("--markdown", type=Path)
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    folder = Path(arguments.shared) / "data/meshes"
    if not folder.is_dir():
        print("no shared data here: skipped")
        sys.exit(77)
    outcomes = []
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(2 if arguments.two else 1) as pool:
        kept = arguments.keep or Path(scratch)
        running = [pool.submit(weave_and_check, arguments, folder / name, settings, kept / f"{Path(name).stem}-{number}")
                   for number, (name, settings) in enumerate(selection(arguments, folder))]
        for task in running:
            outcome = task.result()
            outcomes.append(outcome)
            print(f"{outcome.name:24s} {outcome.seconds:6.1f} s  {len(outcome.faults)} faults", flush=True)
            for fault in outcome.faults[:5]:
                print(f"    {fault}", flush=True)
    rows = [COLUMNS, *(cells(outcome) for outcome in outcomes)]
    print(plain_table(rows))
    if arguments.markdown:
        arguments.markdown.write_text(markdown_table(rows))
    at_fault = sum(bool(outcome.faults) for outcome in outcomes)
    print(f"{at_fault} of {len(outcomes)} packages at fault")
    sys.exit(1 if at_fault else 0)


if __name__ == "__main__":
    main()
