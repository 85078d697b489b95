#!/usr/bin/env python3
"""Writes a few small valid meshes of one format as seeds for its fuzzer. Usage: make_seeds.py FORMAT DIR"""
import struct
import sys
from pathlib import Path

POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
TETRAHEDRON = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
MIXED = [(0, 1, 4, 2), (0, 3, 1), (2, 4, 3, 0, 1)]
MESHES = {"tetrahedron": TETRAHEDRON, "mixed": MIXED, "triangle": TETRAHEDRON[:1]}


def text_points():
    return "".join("%g %g %g\n" % p for p in POINTS)


def obj(faces):
    lines = "".join("v %g %g %g\n" % p for p in POINTS)
    yield (lines + "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in faces)).encode()
    yield (lines + "vn 0 0 1\n" + "".join("f " + " ".join("%d//1" % (i - len(POINTS)) for i in f) + " \\\n\n" for f in faces)).encode()


def off(faces):
    body = "".join("%d %s\n" % (len(f), " ".join(map(str, f))) for f in faces)
    yield ("OFF\n%d %d 0\n" % (len(POINTS), len(faces)) + text_points() + body).encode()
    yield ("COFF # colours\r\n%d %d\r\n" % (len(POINTS), len(faces)) + text_points().replace("\n", " 255 0 0 255\r\n") + body).encode()


def ply(faces):
    def header(encoding, count, index):
        return (f"ply\nformat {encoding} 1.0\ncomment seed\nelement vertex {len(POINTS)}\nproperty float x\nproperty double y\n"
                f"property short z\nelement face {len(faces)}\nproperty list {count} {index} vertex_indices\nend_header\n").encode()
    body = "".join("%d %s\n" % (len(f), " ".join(map(str, f))) for f in faces)
    yield header("ascii", "uchar", "int") + text_points().encode() + body.encode()
    for encoding, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        data = b"".join(struct.pack(order + "fdh", *p) for p in POINTS)
        data += b"".join(struct.pack(order + "B%dH" % len(f), len(f), *f) for f in faces)
        yield header(encoding, "uchar", "ushort") + data


def stl(faces):
    triangles = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    text = "solid seed\n"
    data = b"seed".ljust(80) + struct.pack("<I", len(triangles))
    for t in triangles:
        text += "facet normal 0 0 1\nouter loop\n" + "".join("vertex %g %g %g\n" % POINTS[i] for i in t) + "endloop\nendfacet\n"
        data += struct.pack("<12fH", 0, 0, 1, *(c for i in t for c in POINTS[i]), 0)
    yield (text + "endsolid seed\n").encode()
    yield data


def main():
    name, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for mesh, faces in MESHES.items():
        for number, seed in enumerate({"obj": obj, "off": off, "ply": ply, "stl": stl}[name](faces)):
            (folder / f"{mesh}-{number}.{name}").write_bytes(seed)


if __name__ == "__main__":
    main()
