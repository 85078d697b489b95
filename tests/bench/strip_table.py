#!/usr/bin/env python3
"""Weaves public meshes in several materials and rewrites strips.md: strips, pieces, marks, lengths, weight, time.

usage: strip_table.py LEAFCUTTER SHARED [-o FILE] [--jobs N] [--nesting S]

Every figure is read from the files of a package woven for it. Exit status 77 (skipped) where the shared data isn't
there.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

MATERIALS = ["paper-160-white", "card-300", "veneer-0.6", "felt-1"]
EIGHT = {"foliation.mode": "pants", "foliation.weights": "[1,1,0.17]"}
# Name of the row, mesh, settings.
ROWS = [
    ("eight-7k, about 350 quads (paper's Table 2)", "eight-7k.off", {**EIGHT, "grid.strip_width_mm": 17.3}),
    ("eight-7k, about 5140 quads (paper's Table 2)", "eight-7k.off", {**EIGHT, "grid.strip_width_mm": 4.5}),
    ("hand-6-boundaries", "hand-6-boundaries.obj", {}),
    ("cat-7-boundaries", "cat-7-boundaries.obj", {}),
    ("face-gu", "face-gu.off", {}),
    ("bunny, pillowcase", "bunny.off", {"foliation.mode": "sphere-pillowcase"}),
    ("kitten-106k", "kitten-106k.obj", {}),
    ("fertility", "fertility.off", {}),
]


def weave(arguments, mesh, material, settings):
    with tempfile.TemporaryDirectory() as scratch:
        command = [arguments.leafcutter, "weave", str(Path(arguments.shared) / "data/meshes" / mesh), "-o", f"{scratch}/p",
                   "--set", f"nesting.time_s={arguments.nesting}"]
        for name, value in {**settings, "material.warp": material, "material.weft": material}.items():
            command += ["--set", f"{name}={value}"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            return {"error": done.stderr.strip().splitlines()[-1:]}
        read = lambda name: json.loads(Path(scratch, "p", name).read_text(encoding="utf-8"))
        report, strips = read("report.json"), read("strips.json")
    print(f"  {mesh} {material}", file=sys.stderr, flush=True)
    return {"report": report, "marks": sum(len(piece["marks"]) for piece in strips["pieces"])}


def row(name, material, result):
    if "error" in result:
        return f"| {name} | {material} | refused: {' '.join(result['error'])} |" + " |" * 9
    report = result["report"]
    bill = report["bill"]
    total = lambda key: sum(line[key] for line in bill)
    strips = report["strips"]
    quads = sum(cylinder["rows"] * cylinder["cols"] for cylinder in report["foliation"]["cylinders"])
    return (f"| {name} | {material} | {quads} | {strips['count']} | {strips['pieces']} | {result['marks']} | "
            f"{total('sheets')} | {total('cut_mm') / 1000:.1f} | {total('engrave_mm') / 1000:.1f} | "
            f"{total('weight_g'):.1f} | {total('machine_s') / 60:.0f} | "
            f"{report['certificate']['largest_deviation_relative']:.1e} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("leafcutter")
    parser.add_argument("shared")
    parser.add_argument("-o", "--output", default=Path(__file__).with_name("strips.md"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--nesting", type=float, default=2.0)
    arguments = parser.parse_args()
    if not (Path(arguments.shared) / "data/meshes").is_dir():
        print("no shared meshes: skipped", file=sys.stderr)
        return 77
    jobs = [(name, mesh, material, settings) for name, mesh, settings in ROWS for material in MATERIALS]
    with ThreadPoolExecutor(arguments.jobs) as pool:
        results = list(pool.map(lambda job: weave(arguments, job[1], job[2], job[3]), jobs))
    lines = ["# Strips, marks, weight and time", "",
             "Written by `strip_table.py`. Longest side 300 mm, strips of 10 mm where nothing else is said; lengths in metres, time "
             "in minutes by the planner's own estimate.", "",
             "| model | material | quads | strips | pieces | marks | sheets | cut m | engrave m | weight g | time min | certificate |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    lines += [row(name, material, result) for (name, _, material, _), result in zip(jobs, results)]
    Path(arguments.output).write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
