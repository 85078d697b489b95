#!/usr/bin/env python3
"""Draws a package's foliations: cylinders in colours, leaves of F dark blue, leaves of F* red, the critical graph black,
singular points yellow. What lies behind the surface is hidden.

usage: draw_package.py PACKAGE… [-o FOLDER] [--size PIXELS] [--family both|weft|warp|none] [--stride N]
                       [--heat distance|angle|area|region|planarity|shear]

With --heat the quads instead, each in the colour of its figure in quality.json: from dark blue for 0 by green to yellow
for what one quad of fifty is above; red above three times that.

Writes FOLDER/PACKAGE.png: six views along the surface's principal axes, both ways. Needs numpy.
"""
import argparse
import colorsys
import json
import struct
import zlib
from pathlib import Path

import numpy as np

HEATS = {"distance": "distance_percent", "angle": "corner_deviation_deg", "area": "area_percent", "region": "region_percent",
         "planarity": "planarity_percent", "shear": "shear_deg"}
# Dark blue, teal, green, yellow: lightness grows all the way, so that a grey print tells as much.
RAMP = np.array([[48, 18, 89], [42, 82, 140], [33, 145, 140], [94, 201, 98], [253, 231, 37]], float)
FAR_OUT = (200, 30, 30)
FINER = 2  # Drawn this many times larger, then averaged: smooth lines.
BLUE, RED, BLACK, YELLOW = (20, 40, 130), (190, 30, 30), (0, 0, 0), (255, 220, 0)
TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
         "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
         "double": "f8", "float64": "f8"}


def read_ply(path):
    """Vertices with all their properties, and triangles."""
    data = path.read_bytes()
    head, body = data.split(b"end_header\n", 1)
    elements, binary = [], False
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "format":
            binary = words[1] == "binary_little_endian"
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(words[1:])
    vertices, faces = elements[0], elements[1]
    names = [name for _, name in vertices[2]]
    if binary:
        kind = np.dtype([(name, "<" + TYPES[type_name]) for type_name, name in vertices[2]])
        table = np.frombuffer(body, kind, vertices[1])
        count, index = (TYPES[t] for t in faces[2][0][1:3])
        side = np.dtype([("n", "<" + count), ("v", "<" + index, 3)])
        triangles = np.frombuffer(body, side, faces[1], vertices[1] * kind.itemsize)["v"].astype(int)
        return {name: table[name].astype(float) for name in names}, triangles
    lines = body.decode().splitlines()
    table = np.array([line.split() for line in lines[:vertices[1]]], dtype=float)
    triangles = np.array([line.split()[1:4] for line in lines[vertices[1]:vertices[1] + faces[1]]], dtype=int)
    return {name: table[:, i] for i, name in enumerate(names)}, triangles


def read_quads(path):
    """Vertices and quads of quads.obj."""
    lines = [line.split() for line in path.read_text().splitlines()]
    return (np.array([words[1:4] for words in lines if words[0] == "v"], dtype=float),
            np.array([words[1:5] for words in lines if words[0] == "f"], dtype=int) - 1)


def heat_colours(values):
    """A colour for each value and what the yellow end stands for."""
    top = max(float(np.quantile(values, 0.98)), 1e-12)
    place = np.clip(values / top, 0, 1) * (len(RAMP) - 1)
    low = np.minimum(place.astype(int), len(RAMP) - 2)
    share = (place - low)[:, None]
    colours = RAMP[low] * (1 - share) + RAMP[low + 1] * share
    colours[values > 3 * top] = FAR_OUT
    return colours, top


def write_png(path, picture):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    high, wide, _ = picture.shape
    rows = b"".join(b"\0" + row.tobytes() for row in picture)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", wide, high, 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b""))


def cylinder_colours(count):
    """Pale, neighbours far apart in hue."""
    return np.array([[255 * c for c in colorsys.hsv_to_rgb((0.61803 * k + 0.08) % 1.0, 0.33, 0.97)]
                     for k in range(max(count, 1))])


def axes_of(points):
    """Right-handed: longest, middle and shortest extent."""
    _, _, frame = np.linalg.svd(points[::max(1, len(points) // 20000)] - points.mean(0), full_matrices=False)
    frame[2] = np.cross(frame[0], frame[1])
    return frame


def views_of(frame):
    long, middle, short = frame
    tilt = (short + 0.6 * middle + 0.45 * long) / np.linalg.norm([1.0, 0.6, 0.45])
    for up, toward in [(middle, short), (middle, -short), (short, middle), (short, -middle), (middle, tilt),
                       (middle, -tilt)]:
        up = up - up @ toward * toward
        up /= np.linalg.norm(up)
        yield np.array([np.cross(up, toward), up, toward])


class Canvas:
    """One view. Pixel rows run upwards until the picture is taken; larger depth is nearer."""

    def __init__(self, size, view, points):
        self.size = size * FINER
        self.view = view
        turned = points @ view.T
        self.middle = 0.5 * (turned.min(0) + turned.max(0))
        self.scale = 0.94 * self.size / np.ptp(turned[:, :2], axis=0).max()
        self.depth = np.full(self.size * self.size, -np.inf)
        self.colour = np.full((self.size * self.size, 3), 255.0)

    def project(self, points):
        return (np.asarray(points, float) @ self.view.T - self.middle) * self.scale + 0.5 * self.size * np.array([1, 1, 0])

    def surface(self, points, triangles, colours):
        corners = self.project(points)[triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        light = normal @ [0.25, 0.35, 0.9] / (np.linalg.norm(normal, axis=1) + 1e-30)
        shade = np.where(normal[:, 2] > 0, 0.62 + 0.38 * np.clip(light, 0, 1), 0.45)[:, None]
        low = np.floor(corners[:, :, :2].min(1)).astype(int)
        span = (np.ceil(corners[:, :, :2].max(1)).astype(int) - low).max(1) + 1
        size = 2
        while span.size and size < 2 * span.max():
            chosen = np.flatnonzero((span <= size) & (span > size // 2 if size > 2 else True))
            for part in np.array_split(chosen, len(chosen) * size * size // 4_000_000 + 1):
                self._fill(corners[part], low[part], size, (colours * shade)[part])
            size *= 2

    def _fill(self, corners, low, size, colours):
        step = np.arange(size) + 0.5
        x = low[:, 0, None, None] + step[None, None, :]
        y = low[:, 1, None, None] + step[None, :, None]
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (corners[:, k].T[:, :, None, None] for k in range(3))
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        area = np.where(np.abs(area) < 1e-12, np.nan, area)
        u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
        v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
        w = 1 - u - v
        inside = (u >= -1e-9) & (v >= -1e-9) & (w >= -1e-9) & (x > 0) & (x < self.size) & (y > 0) & (y < self.size)
        which = np.nonzero(inside)
        depth = (u * az + v * bz + w * cz)[which]
        pixel = (np.broadcast_to(y, inside.shape)[which].astype(int) * self.size +
                 np.broadcast_to(x, inside.shape)[which].astype(int))
        np.maximum.at(self.depth, pixel, depth)
        nearest = depth >= self.depth[pixel]
        self.colour[pixel[nearest]] = colours[which[0][nearest]]

    def _dots(self, points, radius, colour, margin):
        """Discs about projected points, where the surface isn't `margin` pixels nearer."""
        reach = np.arange(-int(radius), int(radius) + 1)
        dx, dy = (d.ravel() for d in np.meshgrid(reach, reach))
        near = dx * dx + dy * dy <= radius * radius
        x, y = points[:, 0].astype(int), points[:, 1].astype(int)
        inside = (x >= 0) & (x < self.size) & (y >= 0) & (y < self.size)
        x, y, z = x[inside], y[inside], points[inside, 2]
        seen = z >= self.depth[y * self.size + x] - margin
        x, y = x[seen, None] + dx[near], y[seen, None] + dy[near]
        inside = (x >= 0) & (x < self.size) & (y >= 0) & (y < self.size)
        self.colour[y[inside] * self.size + x[inside]] = colour

    def line(self, points, closed, radius, colour):
        points = self.project(points)
        if closed:
            points = np.concatenate([points, points[:1]])
        steps = np.maximum(1, np.ceil(np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1) * 1.5)).astype(int)
        segment = np.repeat(np.arange(len(steps)), steps)
        share = (np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps)) / np.repeat(steps, steps)
        dense = points[segment] * (1 - share[:, None]) + points[segment + 1] * share[:, None]
        self._dots(dense, radius, colour, 4 * FINER)

    def point(self, position, radius, colour):
        self._dots(self.project([position]), radius * 1.35, BLACK, 8 * FINER)
        self._dots(self.project([position]), radius, colour, 8 * FINER)

    def picture(self):
        size = self.size // FINER
        fine = self.colour.reshape(size, FINER, size, FINER, 3).mean((1, 3))
        return np.clip(fine[::-1], 0, 255).astype(np.uint8)


def face_cylinders(cylinder, triangles):
    """A triangle's cylinder is that of most of its corners: those on a critical leaf belong to several."""
    a, b, c = cylinder[triangles].T
    return np.where(b == c, b, a).astype(int)


def without_blank_rows(picture):
    drawn = np.flatnonzero((picture < 255).any((1, 2)))
    return picture[max(drawn[0] - 10, 0):drawn[-1] + 11] if drawn.size else picture


def draw_foliation(canvas, package, arguments, vertices, triangles):
    leaves = json.loads((package / "leaves.json").read_text())
    points = np.stack([vertices[k] for k in "xyz"], 1)
    cylinder = vertices.get("cylinder", np.zeros(len(points)))
    palette = cylinder_colours(int(cylinder.max()) + 1)
    canvas.surface(points, triangles, palette[np.maximum(face_cylinders(cylinder, triangles), 0)])
    for leaf in leaves["leaves"][::arguments.stride]:
        if arguments.family in ("both", leaf["family"]):
            canvas.line(leaf["points"], leaf["closed"], 0.5 * FINER, BLUE if leaf["family"] == "weft" else RED)
    for curve in leaves.get("critical_graph", []):
        canvas.line(curve["points"], False, 1.25 * FINER, BLACK)
    for singular in leaves.get("singularities", []):
        canvas.point(singular["position"], 3.0 * FINER, YELLOW)


def draw_heat(canvas, package, arguments):
    points, quads = read_quads(package / "quads.obj")
    name = HEATS[arguments.heat]
    values = np.abs(json.loads((package / "quality.json").read_text())["per_quad"][name])
    colours, top = heat_colours(values)
    canvas.surface(points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), np.concatenate([colours, colours]))
    return f"{name}: yellow from {top:.3g}, largest {values.max():.3g}, mean {values.mean():.3g}"


def draw(package, arguments):
    vertices, triangles = read_ply(package / "surface.ply")
    points = np.stack([vertices[k] for k in "xyz"], 1)
    pictures, legend = [], ""
    for view in views_of(axes_of(points)):
        canvas = Canvas(arguments.size, view, points)
        if arguments.heat:
            legend = draw_heat(canvas, package, arguments)
        else:
            draw_foliation(canvas, package, arguments, vertices, triangles)
        pictures.append(canvas.picture())
    rows = [np.concatenate(pictures[i:i + 3], 1) for i in (0, 3)]
    return np.concatenate([without_blank_rows(row) for row in rows]), legend


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("packages", nargs="+", type=Path)
    parser.add_argument("-o", "--out", type=Path, default=Path("."))
    parser.add_argument("--size", type=int, default=500, help="of one view")
    parser.add_argument("--family", choices=["both", "weft", "warp", "none"], default="both")
    parser.add_argument("--heat", choices=sorted(HEATS))
    parser.add_argument("--stride", type=int, default=1, help="every so many leaves")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for package in arguments.packages:
        kind = f"-{arguments.heat}" if arguments.heat else ""
        out = arguments.out / f"{package.resolve().name}{kind}.png"
        picture, legend = draw(package, arguments)
        write_png(out, picture)
        print(out, legend)


if __name__ == "__main__":
    main()
