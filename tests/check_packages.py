#!/usr/bin/env python3
"""Weaves the public meshes and lets the independent package checker judge every package.

usage: check_packages.py LEAFCUTTER SHARED [--all] [--keep DIR]

Without --all a quick selection at the default strip width; with it every mesh of Euler characteristic
0 or more, at the default width and at a third of it. Prints a table; exit status 1 if anything is at fault,
77 (skipped) where the shared data isn't there.
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

QUICK = ["flat-square.off", "cylinder.off", "torus.off", "face-gu.off", "nefertiti.off", "knot.obj"]
ALL = QUICK + ["girl-face-slit.obj", "camelhead.off", "demosthenes.obj", "saddle.off", "hand-open-wrist.obj",
               "rocker-arm.obj", "kitten-106k.obj"]
WIDTHS = {"default": [], "third": ["--set", "grid.strip_width_mm=3.3333333"]}
KERF_AND_SPACING = ["--kerf", "0.1", "--spacing", "1"]


def weave_and_check(arguments, mesh, options, out):
    begun = time.monotonic()
    woven = subprocess.run([arguments.leafcutter, "weave", str(mesh), "-o", str(out), *options],
                           capture_output=True, text=True)
    seconds = time.monotonic() - begun
    if woven.returncode != 0:
        return seconds, None, [f"weave: exit {woven.returncode}: {woven.stderr.strip()}"]
    checked = subprocess.run(
        ["/usr/bin/python3", str(Path(arguments.shared) / "tools/check_package.py"), str(out), str(mesh), "--json",
         *KERF_AND_SPACING], capture_output=True, text=True)
    try:
        report = json.loads(checked.stdout[:checked.stdout.rindex("}") + 1])
    except ValueError:
        return seconds, None, [f"checker: {checked.stderr.strip()[-300:]}"]
    return seconds, report, report["fails"]


def row(mesh, width, seconds, report, faults):
    if report is None:
        return f"{mesh:22s} {width:8s} {seconds:6.1f} s  FAULT"
    best = report["quality"]["overall"]
    density = sum(s["density"] for s in report["layout"]) / len(report["layout"])
    return (f"{mesh:22s} {width:8s} {seconds:6.1f} s {best['quads']:7d} quads  angle {best['angle_avg']:6.2f} "
            f"cross {best['cross_avg']:5.2f}  dist {best['dist_avg']:.4f} %  area {best['area_avg']:5.2f} %  "
            f"coverage {report['coverage_percent']:6.2f} %  sheets {len(report['layout']):3d} at {density:4.1f} %  "
            f"{len(faults)} faults")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("leafcutter")
    parser.add_argument("shared")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    meshes = Path(arguments.shared) / "data/meshes"
    if not meshes.is_dir():
        print("no shared data here: skipped")
        sys.exit(77)
    at_fault = 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = arguments.keep or Path(scratch)
        for name in ALL if arguments.all else QUICK:
            for width, options in WIDTHS.items() if arguments.all else [("default", [])]:
                out = folder / f"{Path(name).stem}-{width}"
                seconds, report, faults = weave_and_check(arguments, meshes / name, options, out)
                print(row(name, width, seconds, report, faults), flush=True)
                for fault in faults[:5]:
                    print(f"    {fault}")
                at_fault += bool(faults)
    print(f"{at_fault} packages at fault")
    sys.exit(1 if at_fault else 0)


if __name__ == "__main__":
    main()
