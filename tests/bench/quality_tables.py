#!/usr/bin/env python3
"""Weaves the public meshes and rewrites the tables of quality.md: what the goals ask for and what is measured.

usage: quality_tables.py LEAFCUTTER SHARED [-o FILE] [--only SECTION…] [--jobs N] [--timeout S]

Sections: goals, paper, face, doubling, meshes. Those not asked for stay as they are in the file. Every figure is
read from report.json of a package woven for it; nothing is typed in but goals and what the paper and others report.
Exit status 77 (skipped) where the shared data isn't there.
"""
import argparse
import cmath
import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

LONGEST_SIDE_MM = 300.0  # What the weaver scales to.
MESHES = {".off", ".obj", ".ply", ".stl"}
EIGHT = "eight-7k.off"
CONFORMING = {"grid.junctions": "conforming"}
INDEPENDENT = {"grid.junctions": "independent"}

# The paper's Table 2: (rows, cols), angle max and avg, distance max and avg %, area avg %.
PAPER_EIGHT = {
    "low": {"L": ((9, 18), 40.7, 2.45, 2.1, 0.567, 5.34), "R": ((9, 18), 39.5, 2.27, 3.14, 0.566, 4.99),
            "M": ((13, 2), 29.6, 7.05, 1.91, 0.682, 2.79)},
    "high": {"L": ((65, 35), 43.5, 0.59, 0.349, 0.0507, 2.14), "R": ((65, 35), 43.5, 0.548, 0.208, 0.0499, 1.65),
             "M": ((10, 59), 54.0, 0.814, 1.19, 0.0452, 3.73)},
}
PAPER_FACE = {("uniform", 15, 16): (34.2, 3.08, 6.52, 0.578, 6.49), ("uniform", 45, 48): (34.5, 0.93, 1.43, 0.0769, 2.71),
              ("curvature", 45, 48): (50.0, 1.31, 1.52, 0.124, 2.76),
              ("curvature-area", 45, 48): (47.5, 0.905, 0.503, 0.09, 1.93)}


class Refused(Exception):
    """A weave that ended with an error."""


class Weaver:
    """Weaves meshes, each with the same settings once."""

    def __init__(self, arguments):
        self.arguments = arguments
        self.folder = Path(arguments.shared) / "data/meshes"
        self.pool = ThreadPoolExecutor(arguments.jobs)
        self.scratch = tempfile.TemporaryDirectory()
        self.reports = {}
        self.lock = threading.Lock()

    def path_of(self, mesh):
        """Of a public mesh; with "@n" behind its name, subdivided n times."""
        name, _, times = mesh.partition("@")
        if not times:
            return self.folder / name
        path = Path(self.scratch.name) / f"{Path(name).stem}-{times}.off"
        if not path.exists():
            positions, triangles = read_off(self.folder / name)
            for _ in range(int(times)):
                positions, triangles = loop_subdivided(positions, triangles)
            write_off(path, positions, triangles)
        return path

    def begin(self, mesh, settings):
        key = (mesh, tuple(sorted((name, json.dumps(value)) for name, value in settings.items())))
        with self.lock:
            if key not in self.reports:
                self.reports[key] = self.pool.submit(self._weave, mesh, dict(settings))
            return self.reports[key]

    def report(self, mesh, settings):
        return self.begin(mesh, settings).result()

    def _weave(self, mesh, settings):
        settings = {"nesting.time_s": 0.01, **settings}
        with tempfile.TemporaryDirectory() as scratch:
            command = [self.arguments.leafcutter, "weave", str(self.path_of(mesh)), "-o", f"{scratch}/package", "--json"]
            for name, value in settings.items():
                command += ["--set", f"{name}={value if isinstance(value, str) else json.dumps(value)}"]
            with open(f"{scratch}/errors", "w+", encoding="utf-8") as errors:
                process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True)
                try:
                    status = process.wait(self.arguments.timeout)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
                    raise Refused(f"no end after {self.arguments.timeout:.0f} s") from None
            if status != 0:
                last = (Path(scratch) / "errors").read_text(encoding="utf-8").strip().splitlines()[-1:]
                try:
                    raise Refused(json.loads(last[0])["error"])
                except (ValueError, KeyError, IndexError):
                    raise Refused(f"exit {status}: {last}") from None
            print(f"  {mesh} {settings}", file=sys.stderr, flush=True)
            return json.loads(Path(scratch, "package/report.json").read_text(encoding="utf-8"))

    def width_for(self, mesh, quads):
        """The strip width in mm at which squares cover the surface with so many quads."""
        said = subprocess.run([self.arguments.leafcutter, "inspect", str(self.path_of(mesh))], capture_output=True, text=True,
                              check=True)
        facts = json.loads(said.stdout)
        box = facts["bounding_box"]
        scale = LONGEST_SIDE_MM / max(high - low for low, high in zip(box["min"], box["max"]))
        return scale * math.sqrt(sum(part["area"] for part in facts["parts"]) / quads)


def read_off(path):
    words = path.read_text(encoding="utf-8").split()
    vertices, faces = int(words[1]), int(words[2])
    numbers = list(map(float, words[4:4 + 3 * vertices]))
    rest = list(map(int, words[4 + 3 * vertices:4 + 3 * vertices + 4 * faces]))
    return ([tuple(numbers[i:i + 3]) for i in range(0, len(numbers), 3)],
            [tuple(rest[i + 1:i + 4]) for i in range(0, len(rest), 4)])


def write_off(path, positions, triangles):
    lines = ["OFF", f"{len(positions)} {len(triangles)} 0", *("%.12g %.12g %.12g" % point for point in positions),
             *("3 %d %d %d" % triangle for triangle in triangles)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def weighted(*terms):
    """The sum of (weight, point)."""
    return tuple(sum(weight * point[k] for weight, point in terms) for k in range(3))


def loop_subdivided(positions, triangles):
    """Loop's rule (1987): four triangles for each, tending to a smooth surface; its edges to smooth curves."""
    opposite, around = {}, [set() for _ in positions]
    for triangle in triangles:
        for a, b, c in (triangle, triangle[1:] + triangle[:1], triangle[2:] + triangle[:2]):
            opposite.setdefault((min(a, b), max(a, b)), []).append(c)
            around[a].add(b)
            around[b].add(a)
    along = {}
    for (a, b), apexes in opposite.items():
        if len(apexes) == 1:
            along.setdefault(a, []).append(b)
            along.setdefault(b, []).append(a)
    moved = []
    for vertex, ring in enumerate(around):
        ring = along.get(vertex, ring)
        count = len(ring)
        share = 0.125 if vertex in along else (0.625 - (0.375 + 0.25 * math.cos(2 * math.pi / count)) ** 2) / count
        moved.append(weighted((1 - count * share, positions[vertex]), *((share, positions[other]) for other in ring)))
    middle = {}
    for (a, b), apexes in opposite.items():
        middle[a, b] = middle[b, a] = len(moved)
        inside = len(apexes) == 2
        ends = [(0.375 if inside else 0.5, positions[end]) for end in (a, b)]
        moved.append(weighted(*ends, *((0.125, positions[apex]) for apex in apexes if inside)))
    finer = []
    for a, b, c in triangles:
        ab, bc, ca = middle[a, b], middle[b, c], middle[c, a]
        finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return moved, finer


def overall(report):
    return report["quality"]["overall"]


def number(value, digits=3):
    """Significant digits, without an exponent."""
    if value == 0:
        return "0"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    text = f"{value:.{min(decimals, 6)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def over_bound(quality):
    """Corner deviation over the least there can be, both over the vertices inside."""
    bound = quality["angle_deviation_bound_deg"]["avg"]
    return quality["angle_deviation_interior_deg"]["avg"] / bound if bound > 1e-9 else 1.0


def table(columns, rows):
    lines = ["| " + " | ".join(columns) + " |", "|" + " --- |" * len(columns)]
    return "\n".join(lines + ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows]) + "\n"


def goal_rows(what, get, goals):
    """One row of the goals: `get` gives a list of (name, value), or raises Refused."""
    try:
        values = get()
    except Refused as refused:
        return [[what, "; ".join(f"{name} ≤ {number(goal)}" for name, goal in goals), f"refused: {refused}", "no"]]
    measured = "; ".join(f"{name} {number(value)}" for (name, _), value in zip(goals, values))
    met = all(value <= goal for (_, goal), value in zip(goals, values))
    missed = [name for (name, goal), value in zip(goals, values) if not value <= goal]
    return [[what, "; ".join(f"{name} ≤ {number(goal)}" for name, goal in goals), measured,
             "yes" if met else "no: " + ", ".join(missed)]]


# ---------------------------------------------------------------- eight, as the paper has it

def eight_weights(weaver, mesh=EIGHT):
    """The paper's proportions: 1 for the cylinders around the handles, 0.17 for the one between."""
    report = weaver.report(mesh, {**INDEPENDENT, "foliation.weights": [1.0, 1.0, 1.0]})
    edges = report["foliation"]["graph"]["edges"]
    between = [edge["from"] != edge["to"] for edge in edges]
    if sum(between) != 1:
        raise Refused(f"the pants graph of {mesh} isn't a pair of glasses: {edges}")
    return [0.17 if middle else 1.0 for middle in between]


def eight_conforming(weaver, quads, mesh=EIGHT):
    return overall(weaver.report(mesh, {
        **CONFORMING, "foliation.weights": eight_weights(weaver, mesh),
        "grid.strip_width_mm": weaver.width_for(mesh, quads)}))


def nearest_to_square(counts, cylinder):
    """(rows, cols) in the order in which cells of the cylinder are nearer to squares."""
    aim = math.log(cylinder["modulus"])
    return min((counts, counts[::-1]), key=lambda order: abs(math.log(order[0] / order[1]) - aim))


def eight_independent(weaver, resolution):
    """Per cylinder its name, grid and quality, and the overall quality."""
    weights = eight_weights(weaver)
    settings = {**INDEPENDENT, "foliation.weights": weights}
    plain = weaver.report(EIGHT, settings)
    names, grids = [], []
    for cylinder in plain["foliation"]["cylinders"]:
        name = "M" if weights[cylinder["graph_edge"]] != 1.0 else ("L" if "L" not in names else "R")
        names.append(name)
        grids.append(nearest_to_square(PAPER_EIGHT[resolution][name][0], cylinder))
    report = weaver.report(EIGHT, {
        **settings, "grid.parity": "any", "grid.cylinders": [{"rows": rows, "cols": cols} for rows, cols in grids]})
    return list(zip(names, grids, report["quality"]["cylinders"])), overall(report)


def figures(quality):
    return [number(quality["angle_deviation_deg"]["max"]), number(quality["angle_deviation_deg"]["avg"]),
            number(quality["angle_deviation_bound_deg"]["avg"]), number(over_bound(quality)),
            number(quality["crossing_angle_deviation_deg"]["avg"]), number(quality["surface_distance_percent"]["max"]),
            number(quality["surface_distance_percent"]["avg"]), number(quality["area_distortion_percent"]["avg"])]


FIGURES = ["angle max", "avg", "bound", "÷ bound", "crossing avg", "distance max %", "avg %", "area avg %"]


def paper_figures(values):
    angle_max, angle, distance_max, distance, area = values
    return [number(angle_max), number(angle), "", "", "", number(distance_max), number(distance), number(area)]


def section_paper(weaver):
    rows = []
    for resolution, cylinders in PAPER_EIGHT.items():
        for name, (grid, *values) in cylinders.items():
            rows.append([f"paper, {resolution}, {name}", f"{grid[0]} × {grid[1]}", *paper_figures(values)])
        cells = {name: grid[0] * grid[1] for name, (grid, *_) in cylinders.items()}
        mean = [sum(cells[name] * cylinders[name][k] for name in cells) / sum(cells.values()) for k in range(1, 6)]
        mean[0] = max(values[1] for values in cylinders.values())
        mean[2] = max(values[3] for values in cylinders.values())
        rows.append([f"paper, {resolution}, all", sum(cells.values()), *paper_figures(mean)])
        try:
            own, whole = eight_independent(weaver, resolution)
            rows += [[f"ours, {resolution}, {name}", f"{grid[0]} × {grid[1]}", *figures(quality)] for name, grid, quality in own]
            rows.append([f"ours, {resolution}, all", whole["quads"], *figures(whole)])
        except Refused as refused:
            rows.append([f"ours, {resolution}", f"refused: {refused}", *[""] * len(FIGURES)])
    return ("`eight-7k.off`, weights 1, 1, 0.17, independent junctions, the paper's three grids in the order (rows × "
            "columns) nearest to squares. The paper's average corner deviation lies below what its own formula can give "
            "on leaves that turn as these do (column \"bound\"): so the formula, the bound and the crossing angle.\n\n" +
            table(["what", "grid", *FIGURES], rows))


# ---------------------------------------------------------------- disks

def face_grid(weaver, mesh, counts):
    report = weaver.report(mesh, {})
    return nearest_to_square(counts, report["foliation"]["cylinders"][0])


def face(weaver, mesh, spacing, counts):
    rows, cols = face_grid(weaver, mesh, counts)
    return overall(weaver.report(mesh, {"grid.rows": rows, "grid.cols": cols, "grid.spacing": spacing, "grid.parity": "any"}))


DISKS = [("face-gu.off", (15, 16)), ("face-gu.off", (45, 48)), ("nefertiti.off", (15, 16)), ("nefertiti.off", (45, 48))]


def section_face(weaver):
    rows = []
    for mesh, counts in DISKS:
        for spacing in ("uniform", "curvature", "curvature-area"):
            paper = PAPER_FACE.get((spacing, *counts))
            if mesh == "face-gu.off" and paper:
                rows.append([f"paper's face, {spacing}", f"{counts[0]} × {counts[1]}", *paper_figures(paper), "", ""])
            try:
                quality = face(weaver, mesh, spacing, counts)
                even = face(weaver, mesh, "uniform", counts)
                change = [f"{100 * (quality['surface_distance_percent'][key] / even['surface_distance_percent'][key] - 1):+.1f} %"
                          for key in ("max", "avg")]
                rows.append([f"{mesh}, {spacing}", f"{counts[0]} × {counts[1]}", *figures(quality), *change])
            except Refused as refused:
                rows.append([f"{mesh}, {spacing}", f"refused: {refused}", *[""] * (len(FIGURES) + 2)])
    return ("Disks. Angles of the four corners are in \"angle max\" and \"avg\"; \"÷ bound\" is of vertices inside. The last two "
            "columns compare with uniform spacing at the same grid.\n\n" +
            table(["what", "grid", *FIGURES, "max against uniform", "avg"], rows))


# ---------------------------------------------------------------- doubling

def doubled(weaver, mesh, settings, first, second):
    one = overall(weaver.report(mesh, {**settings, **first}))
    two = overall(weaver.report(mesh, {**settings, **second}))
    return one, two, one["surface_distance_percent"]["avg"] / max(two["surface_distance_percent"]["avg"], 1e-300)


def doubling_cases(weaver):
    """(what, a function that gives the qualities of a grid and of the doubled one, and how much nearer it is)."""
    cases = []
    for mesh, counts in [("face-gu.off", (15, 16)), ("nefertiti.off", (15, 16)), ("saddle.off", (10, 10)),
                         ("cylinder.off", (4, 8)), ("torus.off", (6, 18)), ("torus.off@1", (12, 36))]:
        def fixed(mesh=mesh, counts=counts):
            rows, cols = face_grid(weaver, mesh, counts)
            return doubled(weaver, mesh, {}, {"grid.rows": rows, "grid.cols": cols},
                           {"grid.rows": 2 * rows, "grid.cols": 2 * cols})
        cases.append((f"{mesh}, {counts[0]} × {counts[1]}", fixed))
    for mesh, settings, quads in [(EIGHT, CONFORMING, 350), (f"{EIGHT}@2", CONFORMING, 700), ("fertility.off", CONFORMING, 500),
                                  ("hand-6-boundaries.obj", {**CONFORMING, "foliation.mode": "one-form"}, 800)]:
        def wide(mesh=mesh, settings=settings, quads=quads):
            width = weaver.width_for(mesh, quads)
            return doubled(weaver, mesh, settings, {"grid.strip_width_mm": width}, {"grid.strip_width_mm": width / 2})
        cases.append((f"{mesh}, {quads} quads wished, strips half as wide", wide))
    return cases


def section_doubling(weaver):
    rows = []
    for what, run in doubling_cases(weaver):
        try:
            one, two, ratio = run()
            rows.append([what, one["quads"], two["quads"], number(one["surface_distance_percent"]["avg"]),
                         number(two["surface_distance_percent"]["avg"]), number(ratio), "yes" if ratio >= 3 else "no"])
        except Refused as refused:
            rows.append([what, "", "", "", "", f"refused: {refused}", "no"])
    return ("Rows and columns twice as many: the average distance is to fall to a third or less. (It falls to a quarter until quads "
            "are as small as the triangles of the mesh; so the doubled grids still have some triangles for each quad. "
            "\"@2\": subdivided twice by Loop's rule.)\n\n" +
            table(["what", "quads", "then", "distance avg %", "then", "÷", "≥ 3"], rows))


# ---------------------------------------------------------------- goals

def even_cells(weaver, mesh):
    plain = overall(weaver.report(mesh, CONFORMING))
    even = overall(weaver.report(mesh, {**CONFORMING, "grid.even_cells": True}))
    return [even["cell_area_variation"], even["angle_deviation_deg"]["avg"] / plain["angle_deviation_deg"]["avg"]]


def against_uniform(weaver, mesh, counts):
    even = face(weaver, mesh, "uniform", counts)["surface_distance_percent"]
    graded = face(weaver, mesh, "curvature-area", counts)["surface_distance_percent"]
    return [100 * (graded["max"] / even["max"] - 1), 100 * (graded["avg"] / even["avg"] - 1)]


def eight_goal(weaver, quads, mesh=EIGHT):
    quality = eight_conforming(weaver, quads, mesh)
    return [quality["crossing_angle_deviation_deg"]["avg"], over_bound(quality), quality["angle_deviation_deg"]["max"],
            quality["surface_distance_percent"]["avg"], quality["area_distortion_percent"]["avg"]]


def face_goal(weaver, counts, mesh="face-gu.off"):
    quality = face(weaver, mesh, "uniform", counts)
    return [over_bound(quality), quality["surface_distance_percent"]["avg"], quality["area_distortion_percent"]["avg"]]


def hand_goal(weaver):
    quality = overall(weaver.report("hand-6-boundaries.obj", {
        **CONFORMING, "foliation.mode": "one-form",
        "grid.strip_width_mm": weaver.width_for("hand-6-boundaries.obj", 3100)}))
    return [quality["surface_distance_percent"]["avg"], quality["area_distortion_percent"]["avg"]]


def doubling_goal(weaver):
    return [max(1.0 / run()[2] for _, run in doubling_cases(weaver))]


def ideal_crossing(quads, points):
    """Average crossing angle deviation of a grid of exact squares of w^(2/3), three prongs at a grid point each."""
    radius2 = quads / points / (1.5 * math.pi)  # Of the disc that one point's share fills, in cells.

    def image(w, near):
        angle = cmath.phase(w)
        angle += 2 * math.pi * round((near - angle) / (2 * math.pi))
        return abs(w) ** (2 / 3) * cmath.exp(2j / 3 * angle)

    reach = math.ceil(math.sqrt(radius2))
    total = 0.0
    for w in (complex(i, j) for i in range(-reach, reach + 1) for j in range(-reach, reach + 1)):
        if 0 < abs(w) ** 2 <= radius2:
            near = cmath.phase(w)
            weft = image(w + 1, near) - image(w - 1, near)
            warp = image(w + 1j, near) - image(w - 1j, near)
            total += 1.5 * abs(math.degrees(cmath.phase(warp / weft)) - 90)  # Three half-planes are one and a half.
    return points * total / quads


def section_goals(weaver):
    eight = ["crossing avg °", "avg ÷ bound", "max °", "distance avg %", "area avg %"]
    rows = []
    for quads, limits in [(350, (0.6, 1.06, 36, 0.55, 2)), (5140, (0.12, 1.04, 36, 0.036, 0.45))]:
        rows += goal_rows(f"{EIGHT}, weights 1, 1, 0.17, about {quads} quads", lambda n=quads: eight_goal(weaver, n),
                          list(zip(eight, limits)))
        rows += goal_rows("the same, its surface smoothed to 112,000 triangles (Loop, twice)",
                          lambda n=quads: eight_goal(weaver, n, f"{EIGHT}@2"), list(zip(eight, limits)))
    for counts, limits in [((15, 16), (1.08, 0.40, 2.8)), ((45, 48), (1.08, 0.048, 1.1))]:
        goals = list(zip(["avg ÷ bound", "distance avg %", "area avg %"], limits))
        rows += goal_rows(f"face-gu.off {counts[0]} × {counts[1]}, corners apart", lambda c=counts: face_goal(weaver, c), goals)
        rows += goal_rows("the same, its surface smoothed (Loop, twice)", lambda c=counts: face_goal(weaver, c, "face-gu.off@2"),
                          goals)
    rows += goal_rows("hand-6-boundaries.obj, one-form, about 3,100 quads", lambda: hand_goal(weaver),
                      [("distance avg %", 0.12), ("area avg %", 0.5)])
    for mesh, counts in DISKS:
        rows += goal_rows(f"{mesh} {counts[0]} × {counts[1]}, curvature-area against uniform",
                          lambda m=mesh, c=counts: against_uniform(weaver, m, c),
                          [("distance max change %", -45), ("avg change %", 2)])
    for mesh, limit in [(EIGHT, 0.40), ("fertility.off", 0.70)]:
        rows += goal_rows(f"{mesh}, even cells, strips of 10 mm", lambda m=mesh: even_cells(weaver, m),
                          [("area CV", limit), ("average angle ÷ without", 1.0)])
    rows += goal_rows("doubling rows and columns, the worst of the shapes below", lambda: doubling_goal(weaver),
                      [("distance avg left", 1 / 3)])
    return table(["what", "goal", "measured", "met"], rows) + (
        "\nOn a mesh of 7,000 triangles 5,140 quads are as large as the triangles: what is measured there is how two sets of "
        "facets miss each other, not how well leaves are followed. The rows of the smoothed surface show the latter.\n"
        f"\nNear a three-prong point chords of an exact conformal grid do not cross at right angles: with four of them at grid "
        f"points, a grid of exact squares has a crossing angle of about {ideal_crossing(350, 4):.2f}° on average at 350 quads "
        f"and of {ideal_crossing(5140, 4):.2f}° at 5140.\n")


# ---------------------------------------------------------------- every mesh

def section_meshes(weaver):
    names = [path.name for path in sorted(weaver.folder.iterdir()) if path.suffix in MESHES]
    running = [(name, weaver.begin(name, CONFORMING)) for name in names]
    rows = []
    for name, task in running:
        try:
            quality = overall(task.result())
        except Refused as refused:
            rows.append([name, "", *[""] * 9, f"refused: {refused}"])
            continue
        report = task.result()
        two_sided = quality["two_sided_diagonal_percent"]["both"]
        singular = {}
        for point in report["foliation"]["singularities"]:
            singular[point["prongs"]] = singular.get(point["prongs"], 0) + 1
        rows.append([name, f"{report['foliation']['mode']}, {len(report['foliation']['cylinders'])} parts", quality["quads"],
                     f"{number(quality['angle_deviation_deg']['avg'])} / {number(quality['angle_deviation_deg']['max'])}",
                     number(quality["angle_deviation_bound_deg"]["avg"]),
                     number(quality["crossing_angle_deviation_deg"]["avg"]),
                     f"{number(quality['surface_distance_percent']['avg'])} / {number(quality['surface_distance_percent']['max'])}",
                     f"{number(two_sided['avg'])} / {number(two_sided['max'])}",
                     number(quality["area_distortion_percent"]["avg"]), number(quality["cell_area_variation"]),
                     f"{number(report['surface']['removed_area_percent'])} %", ""])
    return ("Strips of 10 mm on models 300 mm long, joined across critical leaves, nothing else set. Distance in % of the leaves "
            "(average / largest), and two-sided in % of the bounding box's diagonal (mean / Hausdorff).\n\n" +
            table(["mesh", "mode", "quads", "angle avg / max", "bound", "crossing avg", "distance %", "two-sided %", "area %", "CV",
                   "removed", "remarks"], rows))


SECTIONS = {"goals": ("Goals", section_goals), "paper": ("Beside the paper's Table 2: Eight", section_paper),
            "face": ("Spacing on disks", section_face), "doubling": ("Doubling", section_doubling),
            "meshes": ("Every mesh", section_meshes)}
HEAD = "# Quality\n\nWritten by `quality_tables.py` (target `quality_tables`). Definitions: `geometry/quads/quality.h`.\n"


def earlier_sections(path):
    """The sections of the file as it is, by their names."""
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return {name: body for name, body in re.findall(r"<!-- begin (\w+) -->\n(.*?)<!-- end \1 -->\n", text, re.S)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("leafcutter")
    parser.add_argument("shared")
    parser.add_argument("-o", "--out", type=Path, default=Path(__file__).with_name("quality.md"))
    parser.add_argument("--only", nargs="+", choices=list(SECTIONS), default=list(SECTIONS))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=600.0)
    arguments = parser.parse_args()
    weaver = Weaver(arguments)
    if not weaver.folder.is_dir():
        print("no shared data here: skipped")
        sys.exit(77)
    bodies = earlier_sections(arguments.out)
    for name in arguments.only:
        title, write = SECTIONS[name]
        bodies[name] = f"## {title}\n\n{write(weaver)}"
        print(f"{name}: done", file=sys.stderr, flush=True)
    whole = HEAD + "".join(f"\n<!-- begin {name} -->\n{bodies[name]}<!-- end {name} -->\n" for name in SECTIONS if name in bodies)
    arguments.out.write_text(whole, encoding="utf-8")
    print(arguments.out)


if __name__ == "__main__":
    main()
