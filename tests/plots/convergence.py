#!/usr/bin/env python3
"""Plots how errors fall as edges are halved, from what the convergence test records.

usage: convergence.py TEST_CONVERGENCE [-o FILE.svg] [--csv FILE.csv]

TEST_CONVERGENCE is the test's binary. Tori are compared with closed forms, the eight level with level. The dashed line
is second order. Needs nothing but Python.
"""
import argparse
import csv
import json
import math
import subprocess
import tempfile
from pathlib import Path

WIDE, HIGH, LEFT, RIGHT, TOP, BOTTOM = 560, 400, 60, 170, 20, 45
COLOURS = ["#1b4f9c", "#c0392b", "#27864a", "#8e44ad", "#d68910", "#117a8b", "#7b4a12", "#444444"]


def recorded(binary):
    """Errors by name, coarsest first."""
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "out.json"
        subprocess.run([binary, f"--gtest_output=json:{out}"], check=True, stdout=subprocess.DEVNULL)
        suites = json.loads(out.read_text())["testsuites"]
    series = {}
    for test in suites[0]["testsuite"]:
        surface = "torus" if "Tori" in test["name"] else "eight"
        for name, value in test.items():
            words = value.split() if isinstance(value, str) else []
            if len(words) > 2 and all(is_number(word) for word in words):
                series[f"{surface}: {name.replace('_', ' ')}"] = [float(word) for word in words]
    return series


def is_number(word):
    try:
        return float(word) > 0.0
    except ValueError:
        return False


def svg(series):
    values = [value for errors in series.values() for value in errors]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    halvings = max(len(errors) for errors in series.values()) - 1

    def place(halving, error):
        x = LEFT + (WIDE - LEFT - RIGHT) * (0.05 + 0.9 * halving / halvings)
        return x, TOP + (HIGH - TOP - BOTTOM) * (high - math.log10(error)) / (high - low)

    def path(points, style):
        corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        return f'<polyline points="{corners}" fill="none" {style}/>'

    def text(x, y, words, anchor="middle"):
        return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}</text>'

    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDE} {HIGH}" font-family="sans-serif" '
             f'font-size="12"><rect width="{WIDE}" height="{HIGH}" fill="white"/>']
    for power in range(low, high + 1):
        _, y = place(0, 10.0 ** power)
        parts.append(path([(LEFT, y), (WIDE - RIGHT, y)], 'stroke="#ddd"'))
        parts.append(text(LEFT - 6, y + 4, f"1e{power}", "end"))
    for halving in range(halvings + 1):
        parts.append(text(place(halving, 1.0)[0], HIGH - BOTTOM + 18, f"1/{2 ** halving}"))
    parts.append(text(0.5 * (LEFT + WIDE - RIGHT), HIGH - 8, "edge length"))
    top = max(errors[0] for errors in series.values())
    second = [(k, top * 0.25 ** k) for k in range(halvings + 1) if top * 0.25 ** k >= 10.0 ** low]
    parts.append(path([place(*p) for p in second], 'stroke="#888" stroke-dasharray="5 4"'))
    for row, (name, errors) in enumerate(series.items()):
        colour = COLOURS[row % len(COLOURS)]
        points = [place(k, error) for k, error in enumerate(errors)]
        parts.append(path(points, f'stroke="{colour}" stroke-width="1.6"'))
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points]
        order = math.log2(errors[0] / errors[-1]) / (len(errors) - 1)
        x, y = WIDE - RIGHT + 10, TOP + 14 + 18 * row
        parts.append(f'<circle cx="{x}" cy="{y - 4}" r="4" fill="{colour}"/>')
        parts.append(text(x + 10, y, f"{name} ({order:.2f})", "start"))
    return "\n".join(parts) + "\n</svg>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("test")
    parser.add_argument("-o", "--out", type=Path, default=Path("convergence.svg"))
    parser.add_argument("--csv", type=Path)
    arguments = parser.parse_args()
    series = recorded(arguments.test)
    arguments.out.write_text(svg(series))
    if arguments.csv:
        with arguments.csv.open("w", newline="") as file:
            csv.writer(file).writerows([name, *errors] for name, errors in series.items())
    for name, errors in series.items():
        print(f"{name:18s} " + "  ".join(f"{error:.3e}" for error in errors))


if __name__ == "__main__":
    main()
