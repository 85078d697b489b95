#!/usr/bin/env python3
"""Writes a few small valid inputs as seeds for one fuzzer. Usage: make_seeds.py FUZZER DIR"""
import io
import json
import struct
import sys
import zipfile
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


PROGRAM = "; a sheet\nG21\nG90\nG0 X10 Y10 S0\nM4 S0\nG1 X20 Y10 S500 F1200\nG1 X20 Y20\nG2 X10 Y10 I-5 J-5\nG0 X1.5 S0\nM5 S0\nG0 X0 Y0\n"
EGV = ("Document type : LHYMICRO-GL file\nFile version: 1.0.01\nCopyright: Unknown\nCreator-Software: another\n\n%0%0%0%0%\n"
       "IBzzzvRzzzvS1P\nICV1752241021000191NLBS1EDz139Rz139Tz|aMaU@NSECV2352371006000223CBabNRBS1EDaUFNSE-\n")


def packet(text):
    payload = text.encode().ljust(30, b"F")
    crc = 0
    for byte in payload:
        for _ in range(8):
            mix = (crc ^ byte) & 1
            crc = crc >> 1 ^ (0x8C if mix else 0)
            byte >>= 1
    return b"\xa6\x00" + payload + b"\xa6" + bytes([crc])


def numbered(lines, first=0):
    for number, line in enumerate(lines, first):
        line = f"N{number} {line}"
        check = 0
        for byte in line.encode():
            check ^= byte
        yield f"{line}*{check}\n"


def replies():
    """A byte that chooses the family, then what its controller says; byte 1 lets 0.1 s pass."""
    yield (b"\0\r\nGrbl 1.1h ['$' for help]\r\n\1[VER:1.1h.20190825:]\r\n[OPT:V,15,128]\r\nok\r\n\1$32=1\r\n$30=1000\r\nok\r\n\1"
           b"<Idle|MPos:0.000,0.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>\r\n\1ok\r\nok\r\n\1<Run|WPos:1,2,3|FS:600,100|Ov:100,100,100>\r\n"
           b"\1error:20\r\n\1ALARM:1\r\n[MSG:Reset to continue]\r\n\1Grbl 1.1h\r\n")
    yield (b"\1start\necho:Marlin 2.1.2\n\1FIRMWARE_NAME:Marlin 2.1.2 SOURCE_CODE_URL:x\nCap:EMERGENCY_PARSER:1\nok\n\1ok\n\1ok\n\1"
           b"X:1.00 Y:2.00 Z:0.00 E:0.00 Count X:80 Y:160 Z:0\nok\n\1ok N3 P15 B3\n\1Error:checksum mismatch, Last Line: 6\nResend: 7\n\1"
           b"echo:busy: processing\n\1wait\nlc9\nok\n\1echo:Unknown command: \"M4\"\n\1Error:Printer halted. kill() called!\n")
    yield (b"\2Smoothie\r\nok\r\n\1FIRMWARE_NAME:Smoothieware, FIRMWARE_URL:x, X-GRBL_MODE:0\nok\n\1ok\n\1ok C: X:1.0 Y:2.0 Z:0.0\n\1"
           b"<Run|MPos:1.0,2.0,0.0|WPos:1.0,2.0,0.0|F:600.0,600.0,100.0>\n\1rs N4\n\1ok WCS: X:1 Y:1\n\1!!\n\1HALTED, M999 or $X to exit HALT state\n")
    yield b"\3" + b"\1".join(b"\xff" + bytes([status]) + b"\x6f\x08\x13\x00" for status in (206, 206, 238, 206, 207, 206, 236, 206, 239, 0))


def machines():
    yield b"\0" + PROGRAM.encode() + b"\1?\1!\1~\1$$\n$#\n$G\n$I\n\1$J=G91X5F600\n\1\x85\1\x90\x91\x99\1$H\n\1$C\n$X\n$30=500\n\x18\1G10L2P1X1\n"
    lines = list(numbered(["M110 N0"])) + list(numbered(["M115", "M114", "M113 S1", "M118 lc3", *PROGRAM.splitlines()[1:], "M400", "G28 X Y"], 1))
    yield b"\1" + "\1".join(lines).encode() + b"\1M410\n\1N3 G1*9\n\1M112\n"
    yield b"\2" + "\1".join(lines).encode() + b"\1?\1fire 10 200\n\1M221 S50\n\1!\1~\1\x18\1M999\n\1$X\n$H\n"
    body = "ICV1752241021000191NRBS1EDz139Rz139UTz|aMaFNSE"
    data = [packet("I"), packet("IPP")] + [packet(body[i:i + 30]) for i in range(0, len(body), 30)] + [packet("PN"), packet("PN")]
    yield b"\3" + b"\xa0\1".join(data) + b"\xa0"


def program():
    yield PROGRAM.encode()
    yield EGV.encode()
    yield b"G20 G91\nM3 S1\nG1X1Y-1F10\nG3X1Y1R2\nM30\n"


def sheet():
    yield PROGRAM.encode()
    yield "".join(f"G0 X{x} Y{x} S0\nG1 X{x + 9} S50 F900\nG1 Y{x + 9}\nG1 X{x}\nG1 Y{x}\n" for x in (0, 20, 20)).encode()


def names():
    for text in ("usb?bus=1&address=4&board=B2&width=400&height=300&x=5&down=9&dpi=1016&slope=0.92", "usb?port=1-2.3", "tcp://[::1]:23?down=50",
                 "burn=x&speed=0&fault=crc:3", "drop-ok:12", "garble-ok:3", "crc-always:2", "sim:grbl?speed=1", "grbl:/dev/ttyUSB0?baud=250000"):
        yield text.encode()


def instance():
    square = {"type": "simple_polygon", "data": [[0, 0], [3, 0], [3, 2], [0, 2], [0, 0]]}
    item = {"id": 0, "demand": 2, "allowed_orientations": [0, 180], "shape": square}
    yield json.dumps({"name": "seed", "items": [item], "strip_height": 10}).encode()
    yield json.dumps({"name": "seed", "items": [item], "bins": [{"id": 0, "cost": 1, "stock": 2, "shape": square}]}).encode()


def params():
    yield json.dumps({"scale": {"longest_side_mm": 300}, "foliation": {"mode": "pants", "pants": "reeb", "weights": [1, 2]},
                      "grid": {"rows": 4, "cols": 5, "junctions": "conforming"}, "weave": {"pattern": [[0, 1], [1, 0]]},
                      "fit": {"clearance_mm": 0.2, "labels": True}, "nesting": {"time_s": 1, "rotation": "0,180"},
                      "output": {"dialect": "marlin"}}).encode()


def package():
    piece = {"id": "W1.1", "strip": "W1", "first_cell": 0, "cell_count": 1, "left": [[0, 0], [5, 0]], "right": [[0, 9], [5, 9]], "bend": ["ac"],
             "outline": [[0, 0], [5, 0], [5, 9], [0, 9]], "marks": [{"kind": "score", "path": [[1, 1], [2, 2]]},
                                                                    {"kind": "engrave", "text": "W1.1", "at": [1, 1], "angle_deg": 0, "height_mm": 3}]}
    strip = {"id": "W1", "family": "weft", "cylinders": [0], "closed": False, "quads": [0], "pieces": ["W1.1"]}
    yield json.dumps({"format": "leafcutter-strips/1", "strips": [strip], "pieces": [piece]}).encode()
    yield json.dumps({"format": "leafcutter-layout/1", "density_percent": 50, "unplaced": [],
                      "sheets": [{"id": 1, "material": "paper-160", "family": "weft", "width_mm": 600, "height_mm": 400,
                                  "placements": [{"piece": "W1.1", "x_mm": 1.5, "y_mm": 2.5, "rotation_deg": 90, "mirrored": False}]}]}).encode()
    yield json.dumps({"format": "leafcutter-report/1", "input": {"file": "a.off", "vertices": 3, "faces": 1, "scale": 1}, "params": {},
                      "materials": [], "machine": {}}).encode()


def archive():
    for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        file = io.BytesIO()
        with zipfile.ZipFile(file, "w", method) as package_file:
            package_file.writestr("eight/report.json", "{}" * 40)
            package_file.writestr("eight/strips.json", "[]")
        yield file.getvalue()
    yield (b"\x20--cut\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"a.off\"\r\n\r\nOFF\r\n--cut\r\n"
           b"Content-Disposition: form-data; name=\"params\"\r\n\r\n{}\r\n--cut--\r\n")


def main():
    name, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    meshes = {"obj": obj, "off": off, "ply": ply, "stl": stl}
    for mesh, faces in MESHES.items() if name in meshes else ():
        for number, seed in enumerate(meshes[name](faces)):
            (folder / f"{mesh}-{number}.{name}").write_bytes(seed)
    others = (replies, machines, program, sheet, names, instance, params, package, archive)
    for make in (make for make in others if make.__name__ == name):
        for number, seed in enumerate(make()):
            (folder / f"{name}-{number}").write_bytes(seed)


if __name__ == "__main__":
    main()
