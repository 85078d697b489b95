#!/usr/bin/env python3
"""Weaves the public meshes and lets the independent package checker judge every package.

usage: check_packages.py LEAFCUTTER SHARED [--all | --files NAME…] [--mode MODE] [--set A.B=VALUE]…
                         [--junctions KIND] [--quads N…] [--advised] [--third] [--two] [--timeout S]
                         [--markdown FILE] [--keep DIR]

Without --all or --files a quick selection with one mesh of each kind; --all takes every mesh there is. --quads
weaves each with strips so wide that about N quads result, --third once more with strips a third as wide, --two runs two at a time.

Cylinders are woven one by one, as one with --junctions conforming. Then the valences of the quad mesh must be what the
singular points ask for, and strips too wide for the topology may be refused: that is counted apart, and
with --advised the width that the refusal names must do. Prints a table, as Markdown to a file if wished; exit status 1 if
anything is at fault, 77 (skipped) where the shared data isn't there.
"""
import argparse
import dataclasses
import json
import os
import re
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
           "wanted", "quads", "irregular", "seams", "s", "MB", "faults", "first warning"]
TOO_COARSE = {"strips-too-wide", "too-few-rows"}
LONGEST_SIDE_MM = 300.0  # What the weaver scales to.


@dataclasses.dataclass
class Outcome:
    name: str
    settings: list
    wanted: int = 0   # Quads; 0: as many as the settings give.
    refusal: str = ""
    seconds: float = 0.0
    peak_mb: float = 0.0
    report: dict = dataclasses.field(default_factory=dict)
    faults: list = dataclasses.field(default_factory=list)
    irregular: dict = dataclasses.field(default_factory=dict)  # Valence: number of interior vertices.
    seams: int = 0


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


def said_at_last(said):
    """The error that a run with --json ended with: (code, message)."""
    last = said.splitlines()[-1] if said else ""
    try:
        error = json.loads(last)
        return error["code"], error["error"]
    except (ValueError, KeyError, TypeError):
        return "", last


def setting_of(settings, key, default):
    return next((float(setting.split("=", 1)[1]) for setting in reversed(settings) if setting.startswith(key + "=")), default)


def width_for(arguments, mesh, settings, quads):
    """The strip width in mm at which squares cover the surface with so many quads."""
    inspected = subprocess.run([arguments.leafcutter, "inspect", str(mesh)], capture_output=True, text=True, check=True)
    facts = json.loads(inspected.stdout)
    box = facts["bounding_box"]
    side = max(high - low for low, high in zip(box["min"], box["max"]))
    scale = setting_of(settings, "scale.longest_side_mm", LONGEST_SIDE_MM) / side
    return scale * (sum(part["area"] for part in facts["parts"]) / quads) ** 0.5


def valence_faults(report, structure):
    """What is wrong with a mesh that goes on from cylinder to cylinder: a point with p prongs has 2 p edges, two such
    points may share a vertex, everything else has four."""
    found = {int(valence): count for valence, count in structure["irregular_interior_valences"].items()}
    wanted = {}
    for point in report["foliation"]["singularities"]:
        wanted[2 * point["prongs"]] = wanted.get(2 * point["prongs"], 0) + 1
    faults = [f"valence {valence} inside" for valence in found if valence % 2 == 1]
    index = {sign: sum((valence - 4) // 2 * count for valence, count in wanted.items() if (valence - 4) * sign > 0)
             for sign in (-1, 1)}
    own = {sign: sum((valence - 4) // 2 * count for valence, count in found.items() if (valence - 4) * sign > 0)
           for sign in (-1, 1)}
    if own != index or sum(found.values()) > sum(wanted.values()):
        faults.append(f"irregular vertices {found}, singular points ask for {wanted}")
    holes = len(report["foliation"]["punctures"])
    if structure["euler"] != report["topology"]["euler"] - holes:
        faults.append(f"Euler characteristic {structure['euler']} of the quads, {report['topology']['euler']} of the "
                      f"surface with {holes} holes opened")
    return faults


def judge(arguments, mesh, out, outcome):
    outcome.report = json.loads((out / "report.json").read_text())
    outcome.seams = len(json.loads((out / "weave.json").read_text())["seams"])
    checked = subprocess.run(
        ["/usr/bin/python3", str(Path(arguments.shared) / "tools/check_package.py"), str(out), str(mesh), "--json",
         *KERF_AND_SPACING], capture_output=True, text=True)
    try:
        judged = json.loads(checked.stdout[:checked.stdout.rindex("}") + 1])
    except ValueError:
        outcome.faults.append(f"checker: {checked.stderr.strip()[-300:]}")
        return
    outcome.faults += judged["fails"]
    if arguments.junctions == "conforming":
        outcome.irregular = judged["structure"]["irregular_interior_valences"]
        outcome.faults += valence_faults(outcome.report, judged["structure"])


def weave_and_check(arguments, mesh, case, out):
    settings = list(case.settings)
    outcome = Outcome(mesh.name, settings, case.quads)
    if case.quads:
        settings.append(f"grid.strip_width_mm={width_for(arguments, mesh, settings, case.quads):.6f}")
    for advised in (False, True):
        options = [word for setting in settings for word in ("--set", setting)]
        status, said, seconds, peak_mb = run_measured(
            [arguments.leafcutter, "weave", str(mesh), "-o", str(out), "--json", *options], arguments.timeout)
        outcome.seconds += seconds
        outcome.peak_mb = max(outcome.peak_mb, peak_mb)
        if status == 0:
            judge(arguments, mesh, out, outcome)
            return outcome
        code, message = said_at_last(said)
        if status != 2 or code not in TOO_COARSE or arguments.junctions != "conforming" or advised:
            outcome.faults = [f"weave: no end after {arguments.timeout} s" if status is None else
                              f"weave: exit {status}: {code}: {message}"]
            return outcome
        outcome.refusal = f"{code}: {message}"
        width = re.search(r"at most ([0-9.e+-]+) mm", message)
        if not width:
            outcome.faults = [f"refused without a width that does: {message}"]
            return outcome
        if not arguments.advised:
            return outcome
        settings.append(f"grid.strip_width_mm={width.group(1)}")
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
    wanted = str(outcome.wanted) if outcome.wanted else ""
    if not report:
        blank = [""] * (COLUMNS.index("wanted") - 1)
        said = outcome.faults[0] if outcome.faults else outcome.refusal
        return [outcome.name, *blank, wanted, "" if outcome.faults else "refused", "", "", *last, said[:200]]
    foliation = report["foliation"]
    worst = {key: max((cylinder[key] for cylinder in foliation["cylinders"]), default=0.0)
             for key in ("flux_mismatch", "conformal_gap")}
    spread = foliation["cell_spread"]
    warning = outcome.refusal[:160] or (report["warnings"][0][:110] if report["warnings"] else "")
    return [outcome.name, str(report["topology"]["genus"]), str(report["topology"]["boundary_loops"]), foliation["mode"],
            prongs_of(foliation), str(len(foliation["cylinders"])), str(len(foliation["punctures"])),
            f"{foliation['energy']:.6g}", f"{worst['flux_mismatch']:.1e}", f"{100 * worst['conformal_gap']:.2f} %",
            f"{spread['largest_edge']:.2f}", f"{spread['variation']:.2f}",
            f"{report['surface']['removed_area_percent']:.2f} %", wanted, str(report["quality"]["overall"]["quads"]),
            " ".join(f"{count}x{valence}" for valence, count in sorted(outcome.irregular.items())) or "-",
            str(outcome.seams), *last, warning]


def plain_table(rows):
    widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip() for row in rows)


def markdown_table(rows):
    lines = ["| " + " | ".join(text.replace("|", "\\|") for text in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + " --- |" * len(COLUMNS), *lines[1:]]) + "\n"


@dataclasses.dataclass
class Case:
    name: str
    settings: list
    quads: int = 0


def selection(arguments, folder):
    if arguments.all:
        named = [(path.name, []) for path in sorted(folder.iterdir()) if path.suffix in MESHES]
    else:
        named = [(name, []) for name in arguments.files] if arguments.files else QUICK
    mode = [f"foliation.mode={arguments.mode}"] if arguments.mode else []
    base = [f"grid.junctions={arguments.junctions}", *arguments.set]
    cases = [Case(name, [*base, *own, *mode], quads) for name, own in named for quads in arguments.quads or [0]]
    if arguments.third:
        cases += [Case(case.name, [*case.settings, "grid.strip_width_mm=3.3333333"]) for case in cases if not case.quads]
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
    parser.add_argument("--quads", type=int, nargs="+", default=[])
    parser.add_argument("--advised", action="store_true")
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
        running = [pool.submit(weave_and_check, arguments, folder / case.name, case,
                               kept / f"{Path(case.name).stem}-{case.quads or number}")
                   for number, case in enumerate(selection(arguments, folder))]
        for task in running:
            outcome = task.result()
            outcomes.append(outcome)
            refused = f"  refused: {outcome.refusal}" if outcome.refusal else ""
            print(f"{outcome.name:24s} {outcome.wanted or '':>6} {outcome.seconds:6.1f} s  {len(outcome.faults)} faults{refused}",
                  flush=True)
            for fault in outcome.faults[:5]:
                print(f"    {fault}", flush=True)
    rows = [COLUMNS, *(cells(outcome) for outcome in outcomes)]
    print(plain_table(rows))
    if arguments.markdown:
        arguments.markdown.write_text(markdown_table(rows))
    at_fault = sum(bool(outcome.faults) for outcome in outcomes)
    refused = sum(bool(outcome.refusal) for outcome in outcomes)
    print(f"{at_fault} of {len(outcomes)} packages at fault" + (f", {refused} refused as too coarse" if refused else ""))
    sys.exit(1 if at_fault else 0)


if __name__ == "__main__":
    main()
