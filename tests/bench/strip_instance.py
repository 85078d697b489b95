#!/usr/bin/env python3
"""Prints a strip packing instance of random bent bands, as woven strips are: strip_instance.py COUNT TURN SEED

Bands are 8 to 14 wide and 120 to 500 long; arcs, S shapes and spirals that turn by up to TURN radians.
"""

import json
import math
import random
import sys


def band(rng, turn):
    length = rng.uniform(120, 500)
    half = rng.uniform(8, 14) / 2
    total = rng.uniform(0.1, turn)
    kind = rng.choice(["arc", "s", "spiral"])
    steps = max(8, int(length / 16))
    x = y = 0.0
    angle = 0.0
    left, right = [], []
    for i in range(steps + 1):
        left.append([x - half * math.sin(angle), y + half * math.cos(angle)])
        right.append([x + half * math.sin(angle), y - half * math.cos(angle)])
        share = (i + 0.5) / steps
        bend = {"arc": 1.0, "s": math.copysign(1.0, 0.5 - share), "spiral": 2.0 * share}[kind]
        angle += total / steps * bend
        x += length / steps * math.cos(angle)
        y += length / steps * math.sin(angle)
    ring = right + left[::-1]
    return [[round(px, 4), round(py, 4)] for px, py in ring + ring[:1]]


def main():
    count, turn, seed = int(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
    rng = random.Random(seed)
    items = [{"id": i, "demand": 1, "shape": {"type": "simple_polygon", "data": band(rng, turn)}} for i in range(count)]
    json.dump({"name": f"strips{count}_{turn:g}", "items": items, "strip_height": 600.0}, sys.stdout)


if __name__ == "__main__":
    main()
