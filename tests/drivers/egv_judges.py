#!/usr/bin/env python3
"""Has EGV files of ours read by a program that nobody of us wrote, and compares what it would cut with the G-code they
were made from. Usage: egv_judges.py LEAFCUTTER MEERK40T [--whisperer WHISPERER] [PROGRAM.gcode ...]

LEAFCUTTER is the binary, MEERK40T a checkout of github.com/meerk40t/meerk40t, whose parser of LHYMICRO-GL is the judge.
WHISPERER is one of K40-Whisperer, which has no parser: it encodes the same lines, must come out as near to them, and
its speed codes are held against ours. Without programs, some are made up: slopes of every kind, tiny steps, arcs, long jobs, many speeds.

Every vertex must be met exactly, at the step that is nearest to it; between two of them every lit step must lie within
one step of the line; nothing dark may be lit. Exit status 1 if not."""
import argparse
import bisect
import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

STEP_MM = 25.4 / 1000


def made_up():
    rng = random.Random(7)
    fan = [f"G0 X100 Y100 S0\nG1 X{100 + 80 * math.cos(i * 0.05):.3f} Y{100 + 80 * math.sin(i * 0.05):.3f} S500 F1200\n" for i in range(126)]
    walk = ["G0 X150 Y100 S0\n"]
    x, y = 150.0, 100.0
    for _ in range(3000):
        x = min(max(x + rng.uniform(-3, 3), 1), 300)
        y = min(max(y + rng.uniform(-3, 3), 1), 200)
        walk.append(f"G1 X{x:.3f} Y{y:.3f} S500 F{rng.choice((600, 1200, 3000))}\n")
    tiny = ["G0 X50 Y50 S0\n"] + [f"G1 X{50 + 0.011 * i:.3f} Y{50 + 0.5 * math.sin(i * 0.1):.3f} S300 F900\n" for i in range(2000)]
    arcs = ["G0 X30 Y60 S0\nG2 X70 Y60 I20 J0 S500 F1800\nG3 X30 Y60 I-20 J0\nG0 X200 Y150 S0\nG2 X200 Y150 I-15 J-7 F2400 S100\n"]
    dashes = [f"G0 X{10 + i % 50 * 5} Y{10 + i // 50 * 5} S0\nG1 X{12.345 + i % 50 * 5:.3f} Y{10.987 + i // 50 * 5:.3f} S500 F4800\n" for i in range(1500)]
    for name, lines in (("fan", fan), ("walk", walk), ("tiny", tiny), ("arcs", arcs), ("dashes", dashes)):
        yield name, "G21\nG90\nM4 S0\n" + "".join(lines) + "M5 S0\nG0 X0 Y0 S0\n"


def steps(point_mm, height_mm):
    """Of the board: right of and below the home corner."""
    return point_mm[0] / STEP_MM, (height_mm - point_mm[1]) / STEP_MM


def arc_points(start, end, centre, clockwise):
    radius = math.dist(start, centre)
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    b = math.atan2(end[1] - centre[1], end[0] - centre[0])
    turn = (a - b if clockwise else b - a) % (2 * math.pi) or 2 * math.pi
    count = max(2, int(turn * radius / 0.005))
    sign = -1 if clockwise else 1
    return [(centre[0] + radius * math.cos(a + sign * turn * i / count), centre[1] + radius * math.sin(a + sign * turn * i / count))
            for i in range(1, count)] + [end]


def wanted(gcode, height_mm):
    """The lit lines of a program, in steps: chains of points, with the ends of its lines marked."""
    at, lit, power, mode, chains = (0.0, 0.0), False, 0.0, 0, []
    for line in gcode.splitlines():
        words = {}
        for word in line.split(";")[0].split():
            words.setdefault(word[0], []).append(float(word[1:]))
        if any(m in (3, 4) for m in words.get("M", [])):
            lit = True
        if any(m == 5 for m in words.get("M", [])):
            lit = False
        power = words.get("S", [power])[-1]
        mode = next((int(g) for g in words.get("G", []) if g in (0, 1, 2, 3)), mode)
        if "X" not in words and "Y" not in words:
            continue
        end = words.get("X", [at[0]])[0], words.get("Y", [at[1]])[0]
        if mode == 0 or not lit or power <= 0:
            chains.append([])
        else:
            centre = at[0] + words.get("I", [0])[0], at[1] + words.get("J", [0])[0]
            points = arc_points(at, end, centre, mode == 2) if mode in (2, 3) else [end]
            if not chains or not chains[-1]:
                chains.append([(steps(at, height_mm), True)])
            chains[-1] += [(steps(p, height_mm), p == end) for p in points]
        at = end
    return [chain for chain in chains if len(chain) > 1]


def judged(egv, checkout):
    """The lit lines that MeerK40t sees in the file."""
    sys.path.insert(0, str(checkout))
    from meerk40t.lihuiyu.parser import LihuiyuParser
    parser, chains, last = LihuiyuParser(), [], [None]

    def position(p):
        if p is None:
            return
        x0, y0, x1, y1 = p
        if parser.program_mode and parser.laser and (x0, y0) != (x1, y1):
            if last[0] != (x0, y0):
                chains.append([(x0, y0)])
            chains[-1].append((x1, y1))
            last[0] = (x1, y1)
        elif (x0, y0) != (x1, y1):
            last[0] = None

    parser.position = position
    parser.header_write(egv)
    return chains


HEAD = b"Document type : LHYMICRO-GL file\nFile version: 1.0.01\nCopyright: Unknown\nCreator-Software: K40-Whisperer\n\n%0%0%0%0%\nI"


def whispered(chain, checkout):
    """A lit line from its own beginning, as K40-Whisperer encodes it: a file."""
    sys.path.insert(0, str(checkout))
    from egv import egv
    out = bytearray()
    encoder = egv(target=out.append)
    encoder.make_egv_data([[round(x) / 1000, -round(y) / 1000, 0] for (x, y), _ in chain], Feed=20.0, board_name="LASER-M2")
    return HEAD + bytes(out)


def moved_to_origin(chain):
    x0, y0 = round(chain[0][0][0]), round(chain[0][0][1])
    return [((x - x0, y - y0), is_end) for (x, y), is_end in chain]


def as_whisperer(chains, options):
    """How near K40-Whisperer comes to the same lines: lit steps, largest deviation, ends missed."""
    lit, worst, missed = 0, 0.0, 0
    for chain in map(moved_to_origin, chains):
        seen = judged(whispered(chain, options.whisperer), options.meerk40t)
        lit += sum(len(Runs(part)) for part in seen)
        off, lost = compare(seen[0], chain)
        worst, missed = max(worst, off), missed + lost
    return lit, worst, missed


def code_numbers(code):
    """Letters and numbers of a speed code, three digits each."""
    return re.findall("[A-Z]|[0-9]{3}|[0-9]", code)


def speed_codes_differ(options):
    """By more than the step that K40-Whisperer rounds up now and then."""
    sys.path.insert(0, str(options.whisperer))
    from LaserSpeed import LaserSpeed
    wrong = 0
    for board in ("M2", "B1", "B2", "A"):
        for speed in (10, 11, 12.5, 20, 25, 30, 45, 60, 80, 100, 126):
            theirs = code_numbers(LaserSpeed.get_code_from_speed(speed, 0, board=board))
            egv = encoded(f"G21\nG90\nM4 S0\nG1 X50 Y30 S500 F{speed * 60}\nM5 S0\n", options, board)
            ours = [code_numbers(found) for found in re.findall("C?V[0-9]+C?", egv.decode("latin-1").split("%")[-1])]
            near = [len(code) == len(theirs) and all(a == b or (a.isdigit() and b.isdigit() and abs(int(a) - int(b)) <= 1)
                                                     for a, b in zip(code, theirs)) for code in ours]
            if not any(near):
                wrong += 1
                print(f"speed {speed} mm/s on {board}: ours {ours}, K40-Whisperer's {theirs}")
    print(f"speed codes: {wrong} of 44 differ from K40-Whisperer's")
    return wrong


def apart(p, q):
    """In steps of the axis that is farther off: a board has no finer ones."""
    return max(abs(p[0] - q[0]), abs(p[1] - q[1]))


def off_line(p, a, b):
    length = math.dist(a, b)
    if length == 0:
        return apart(p, a)
    t = max(0.0, min(1.0, ((p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])) / length ** 2))
    return apart(p, (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])))


class Runs:
    """Runs of steps, by the number of steps since the start."""

    def __init__(self, chain):
        self.corners, self.counts = chain, [0]
        for (x0, y0), (x1, y1) in zip(chain, chain[1:]):
            self.counts.append(self.counts[-1] + int(max(abs(x1 - x0), abs(y1 - y0))))

    def __len__(self):
        return self.counts[-1]

    def at(self, count):
        i = max(bisect.bisect_left(self.counts, count), 1)
        (x0, y0), (x1, y1) = self.corners[i - 1:i + 1]
        part = (count - self.counts[i - 1]) / (self.counts[i] - self.counts[i - 1])
        return x0 + (x1 - x0) * part, y0 + (y1 - y0) * part

    def between(self, begin, end):
        """Places that are farthest off a straight line if any is: the ends of runs."""
        inner = self.corners[bisect.bisect_right(self.counts, begin):bisect.bisect_left(self.counts, end)]
        return [self.at(begin)] + inner + [self.at(end)]


def compare(chain, want):
    """Walks the lit runs along the wanted lines, between the steps next to their ends. Returns the largest deviation in
    steps and how many ends were missed."""
    path, worst, missed, at = Runs(chain), 0.0, 0, 0
    ends = [(round(x), round(y)) for (x, y), _ in want]
    for a, b in zip(ends, ends[1:]):
        begin, at = at, min(at + max(abs(b[0] - a[0]), abs(b[1] - a[1])), len(path))
        missed += apart(path.at(at), b) > 1e-9
        worst = max([worst] + [off_line(p, a, b) for p in path.between(begin, at)])
    return worst, missed + (len(path) - at)


def nearest(chain, want):
    """For arcs, whose chords are of our choice: the largest distance of any corner from the wanted points."""
    points, worst, at = [p for p, _ in want], 0.0, 0
    for p in chain:
        near = range(max(at - 200, 0), min(at + 2000, len(points)))
        at = min(near, key=lambda i: apart(p, points[i]))
        worst = max(worst, apart(p, points[at]))
    return worst


def encoded(gcode, options, board="M2"):
    with tempfile.TemporaryDirectory() as folder:
        program, egv = Path(folder, "program.gcode"), Path(folder, "program.egv")
        program.write_text(gcode)
        uri = f"lihuiyu:usb?board={board}&width={options.width}&height={options.height}"
        subprocess.run([options.leafcutter, "send", program, "--device", uri, "--egv", egv], check=True)
        return egv.read_bytes()


def judge(name, gcode, options):
    data = encoded(gcode, options)
    want, have = wanted(gcode, options.height), judged(data, options.meerk40t)
    arcs = any(not is_end for chain in want for _, is_end in chain)
    results = [(nearest(h, w), 0) if arcs else compare(h, w) for h, w in zip(have, want)]
    worst, missed = max(r[0] for r in results), sum(r[1] for r in results) + abs(len(want) - len(have))
    lit = sum(len(Runs(chain)) for chain in have)
    most = 1.5 if arcs else 1.0  # A chord leaves its arc by half a step more.
    print(f"{name}: {len(data)} bytes, {len(have)} of {len(want)} chains, {lit} lit steps, off by {worst:.3f} steps at most, "
          f"{missed} ends missed", flush=True)
    good = worst <= most and missed == 0
    if options.whisperer and not arcs:
        steps_lit, off, lost = as_whisperer(want, options)
        print(f"  K40-Whisperer's: {steps_lit} lit steps, off by {off:.3f} steps at most, {lost} ends missed", flush=True)
        good = good and steps_lit == lit and off <= most and lost == 0
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("leafcutter", type=Path)
    parser.add_argument("meerk40t", type=Path)
    parser.add_argument("--whisperer", type=Path, help="a checkout of K40-Whisperer")
    parser.add_argument("programs", type=Path, nargs="*")
    parser.add_argument("--width", type=float, default=310.0, help="of the bed in mm")
    parser.add_argument("--height", type=float, default=210.0)
    options = parser.parse_args()
    programs = [(p.name, p.read_text()) for p in options.programs] or list(made_up())
    results = [judge(name, gcode, options) for name, gcode in programs]
    differ = speed_codes_differ(options) if options.whisperer else 0
    return 0 if all(results) and differ == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
