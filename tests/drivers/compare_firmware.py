#!/usr/bin/env python3
"""Holds two Grbl controllers against each other, or records what one answers.

  compare_firmware.py A B                 prints where B answers otherwise than A
  compare_firmware.py A                   prints where A answers otherwise than recorded
  compare_firmware.py A --record FILE     writes the dialogues with the answers of A

A and B are tcp:HOST:PORT, a path of a serial port or pty (115200 baud), or exec:COMMAND for a
program that talks on its standard input and output: a simulated machine, a firmware built for a
PC, or a board on the bench that nothing is mounted to (the dialogues move and fire!). Exit
status 1: there are differences.
"""

import argparse
import os
import re
import select
import shlex
import socket
import subprocess
import sys
import termios
import time
import tty
from pathlib import Path

SETTINGS = """$0=10 $1=25 $2=0 $3=0 $4=0 $5=0 $6=0 $10=1 $11=0.010 $12=0.002 $13=0 $20=0 $21=0 $22=0
$23=0 $24=25 $25=500 $26=250 $27=1 $30=1000 $31=0 $32=1 $100=250 $101=250 $102=250 $110=6000
$111=6000 $112=500 $120=500 $121=500 $122=50 $130=600 $131=400 $132=50""".split()
QUIET_S = 0.12


class Endpoint:
    def __init__(self, address):
        self.name = address
        self.process = None
        if address.startswith("tcp:"):
            _, host, port = address.split(":")
            self.socket = socket.create_connection((host, int(port)))
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.reader = self.writer = self.socket.fileno()
        elif address.startswith("exec:"):
            self.process = subprocess.Popen(
                shlex.split(address[5:]), stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            self.reader = self.process.stdout.fileno()
            self.writer = self.process.stdin.fileno()
        else:
            self.reader = self.writer = os.open(address, os.O_RDWR | os.O_NOCTTY)
            tty.setraw(self.reader)
            speed = termios.tcgetattr(self.reader)
            speed[4] = speed[5] = termios.B115200
            termios.tcsetattr(self.reader, termios.TCSANOW, speed)
        self.rest = ""

    def send(self, data):
        while data:
            data = data[os.write(self.writer, data):]

    def listen(self, seconds, until_quiet=False):
        """Lines that come within the time; `until_quiet`: ends when nothing came for a while."""
        lines, end = [], time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            ready, _, _ = select.select([self.reader], [], [], left)
            if not ready:
                break
            chunk = os.read(self.reader, 65536)
            if not chunk:
                raise SystemExit(f"{self.name}: has closed the link")
            self.rest += chunk.decode("latin-1")
            *whole, self.rest = re.split(r"[\r\n]+", self.rest)
            lines += [line for line in whole if line]
            if until_quiet:
                end = time.monotonic() + QUIET_S
        return lines

    def ask(self, line, seconds=5.0):
        self.send(line.encode("latin-1") + b"\n")
        answers, end = [], time.monotonic() + seconds
        while time.monotonic() < end:
            answers += self.listen(0.02)
            if any(a == "ok" or a.startswith("error:") for a in answers):
                return answers
        raise SystemExit(f"{self.name}: no answer to {line}")

    def reset(self):
        self.send(b"\x18")
        self.listen(2.0, until_quiet=True)
        self.listen(0.3)

    def prepare(self):
        """At 0,0,0 with the settings and offsets that every dialogue begins with."""
        self.listen(0.2)
        self.reset()
        self.ask("$X")
        for line in SETTINGS + ["$N0=", "$N1=", "$I="]:
            self.ask(line)
        self.send(b"$RST=#\n")
        self.listen(1.0)  # It writes for long before it answers, and is reset then.
        self.ask("$X")
        self.ask("G21G90G94G53G0X0Y0Z0")
        self.ask("G4P0.05", 60.0)
        self.reset()


def read_dialogues(text):
    """[(name, [(directive, argument, [recorded answers])])], and the head of the file."""
    head, dialogues = [], []
    for line in text.splitlines():
        if line.startswith("== "):
            dialogues.append((line[3:], []))
        elif not dialogues:
            head.append(line)
        elif line.startswith("< "):
            dialogues[-1][1][-1][2].append(line[2:])
        elif line.strip():
            directive, _, argument = line.partition(" ")
            dialogues[-1][1].append((directive, argument, []))
    return head, dialogues


def play(endpoint, steps):
    endpoint.prepare()
    answers = []
    for directive, argument, _ in steps:
        if directive == "wait":
            answers.append(endpoint.listen(float(argument)))
            continue
        data = argument.encode("latin-1") + b"\n" if directive == ">" else (
            argument.encode("latin-1").decode("unicode_escape").encode("latin-1"))
        endpoint.send(data)
        answers.append(endpoint.listen(QUIET_S, until_quiet=True))
    endpoint.reset()
    return answers


def split_status(line):
    state, *fields = line.strip("<>").split("|")
    return state, [(name, [float(x) for x in value.split(",")] if name not in ("A", "Pn") else value)
                   for name, _, value in (field.partition(":") for field in fields)]


def same(a, b):
    """Equal, but for what depends on the moment at which a moving machine was asked."""
    if a == b:
        return True
    if not (a.startswith("<") and b.startswith("<")):
        return False
    (state, fields), (other_state, others) = split_status(a), split_status(b)
    if state != other_state or [n for n, _ in fields] != [n for n, _ in others]:
        return False
    moving = state.split(":")[0] in ("Run", "Jog") or state.endswith(":1")
    stopped_somewhere = state in ("Hold:0", "Door:0")
    for (name, values), (_, other_values) in zip(fields, others):
        fleeting = (moving and name in ("MPos", "WPos", "FS", "F", "Bf")) or (
            stopped_somewhere and name in ("MPos", "WPos"))
        slack = 1e9 if fleeting else 0.0041
        slack = max(slack, 1.01) if name == "FS" else slack
        if isinstance(values, str) or isinstance(other_values, str):
            if values != other_values:
                return False
        elif any(abs(x - y) > slack for x, y in zip(values, other_values)):
            return False
    return True


def compare(name, steps, ours, theirs):
    differences = 0
    for (directive, argument, _), a, b in zip(steps, ours, theirs):
        if len(a) != len(b) or not all(same(x, y) for x, y in zip(a, b)):
            differences += 1
            print(f"{name}: {directive} {argument}\n    - {' / '.join(a)}\n    + {' / '.join(b)}")
    return differences


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("endpoints", nargs="+", metavar="ENDPOINT")
    parser.add_argument("--dialogues", default=Path(__file__).with_name("grbl_dialogues.txt"))
    parser.add_argument("--only", help="only the dialogue of this name")
    parser.add_argument("--record", metavar="FILE", help="writes the answers of the one endpoint")
    options = parser.parse_args()
    endpoints = [Endpoint(address) for address in options.endpoints]
    head, dialogues = read_dialogues(Path(options.dialogues).read_text(encoding="latin-1"))
    differences, exchanges, recorded = 0, 0, head[:]
    for name, steps in dialogues:
        if options.only and name != options.only:
            continue
        played = [play(endpoint, steps) for endpoint in endpoints]
        exchanges += len(steps)
        if options.record:
            recorded += [f"== {name}"]
            for (directive, argument, _), answers in zip(steps, played[0]):
                recorded += [f"{directive} {argument}".rstrip()] + [f"< {a}" for a in answers]
            recorded += [""]
        else:
            before = [answers for _, _, answers in steps] if len(played) == 1 else played[0]
            differences += compare(name, steps, before, played[-1])
    if options.record:
        Path(options.record).write_text("\n".join(recorded), encoding="latin-1")
    print(f"{exchanges} exchanges, {differences} answered differently")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
