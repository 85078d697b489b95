"""What the tests cut, and what the beams of the simulated machines did of it."""
import hashlib
import json
import math
import re
import sys
from collections import Counter, defaultdict
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "support"))
from flat_mesh import plate  # noqa: E402

PLATE = plate(4, 3)
SHA = hashlib.sha256(PLATE).hexdigest()


def params(side=60.0):
    return {"scale": {"longest_side_mm": side}, "grid": {"rows": 3, "cols": 3}, "nesting": {"time_s": 0.05}}


def burns_of_program(gcode):
    """Where a program goes with the beam on: millimetres, and how often it ends at which point."""
    at, motion, power, on, total, ends = [0.0, 0.0], 0, 0.0, False, 0.0, Counter()
    for line in gcode.split("\n"):
        words = re.findall(r"([A-Z])(-?[\d.]+)", re.sub(r"\(.*?\)|;.*", "", line))
        to = list(at)
        for letter, text in words:
            value = float(text)
            if letter == "G" and value in (0, 1):
                motion = int(value)
            elif letter == "M" and value in (3, 4, 5):
                on = value != 5
            elif letter == "S":
                power = value
            elif letter in "XY":
                to["XY".index(letter)] = value
        if to != at:
            if motion == 1 and on and power > 0:
                total += math.dist(at, to)
                ends[round(to[0], 3), round(to[1], 3)] += 1
            at = to
    return total, ends


def burn_of_program(gcode):
    return burns_of_program(gcode)[0]


def burnt_pieces(log):
    for line in log.read_text().splitlines() if log.exists() else []:
        piece = json.loads(line) if line.endswith("}") else {"s": 0}
        if piece["s"] > 0 and (piece["x0"], piece["y0"]) != (piece["x1"], piece["y1"]):
            yield piece


def burnt(log):
    return sum(math.dist((piece["x0"], piece["y0"]), (piece["x1"], piece["y1"])) for piece in burnt_pieces(log))


class Targets:
    """Points where programs end a burn, and how often each may be reached; machines round to a micron or two."""
    NEAR_MM = 0.004

    def __init__(self):
        self.cells = defaultdict(list)

    def add(self, ends):
        for at, times in ends.items():
            self.cells[self.cell(at)].append([at, times])

    @staticmethod
    def cell(at):
        return tuple(math.floor(100 * part) for part in at)

    def near(self, at):
        x, y = self.cell(at)
        return [entry for i in (x - 1, x, x + 1) for j in (y - 1, y, y + 1) for entry in self.cells.get((i, j), [])
                if math.dist(entry[0], at) < self.NEAR_MM]

    def count(self, log):
        """Counts down by what was burnt; returns the points that the beam reached once too often."""
        twice = []
        for piece in burnt_pieces(log):
            at = (piece["x1"], piece["y1"])
            if math.dist((piece["x0"], piece["y0"]), at) < self.NEAR_MM:
                continue  # A motion was written in two, and its last crumb starts where it has counted as there.
            found = self.near(at)
            left = [entry for entry in found if entry[1] > 0]
            if left:  # Ends of different jobs may lie as near as that to each other.
                min(left, key=lambda entry: math.dist(entry[0], at))[1] -= 1
            elif found:  # Otherwise it was stopped there, in the middle of a line.
                twice.append(at)
        return twice

    def missing(self):
        return [at for cell in self.cells.values() for at, times in cell if times > 0]
