#!/usr/bin/env python3
"""Several nodes on one PostgreSQL, and what can happen to them. Usage: fleet_test.py LEAFCUTTER
The short run is for every day; LEAFCUTTER_FLEET_LONG=1 takes 2 api, 4 workers, 4 stations and 1,000 jobs."""
import hashlib
import json
import math
import os
import random
import re
import signal
import statistics
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path

from world import BINARIES, Fleet, namespaced, wait  # First: it knows where the next one is.
from flat_mesh import plate

LONG = bool(os.environ.get("LEAFCUTTER_FLEET_LONG"))
FINAL = ("done", "aborted", "failed", "interrupted")
PLATE = plate(4, 3)
SHA = hashlib.sha256(PLATE).hexdigest()


def params(side=60.0):
    return {"scale": {"longest_side_mm": side}, "grid": {"rows": 3, "cols": 3}, "nesting": {"time_s": 0.05}}


def burn_of_program(gcode):
    """Millimetres that a program burns: moves with the beam on."""
    at, motion, power, on, total = [0.0, 0.0], 0, 0.0, False, 0.0
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
            total += math.dist(at, to) if motion == 1 and on and power > 0 else 0.0
            at = to
    return total


def burnt(log):
    total = 0.0
    for line in log.read_text().splitlines() if log.exists() else []:
        piece = json.loads(line) if line.endswith("}") else {"s": 0}
        if piece.get("s", 0) > 0:
            total += math.dist((piece["x0"], piece["y0"]), (piece["x1"], piece["y1"]))
    return total


class Events(threading.Thread):
    """What a node's stream tells, with the time of its arrival."""

    def __init__(self, node):
        super().__init__(daemon=True)
        self.node, self.seen, self.seqs = node, {}, []
        self.open = threading.Event()
        self.start()
        assert self.open.wait(10)

    def run(self):
        import http.client
        connection = http.client.HTTPConnection(self.node.address, self.node.port, timeout=60)
        connection.request("GET", "/api/v1/events", headers=self.node.fleet.auth)
        stream = connection.getresponse()
        try:
            while True:
                line = stream.readline().decode()
                if not line:
                    return
                if line.startswith("data: "):
                    data = json.loads(line[6:])
                    if data.get("type") == "snapshot":
                        self.open.set()
                    elif "seq" in data:
                        self.seqs.append(data["seq"])
                        self.seen.setdefault((data["type"], data["id"]), time.monotonic())
        except (OSError, http.client.HTTPException, ValueError):
            return


class FleetCase(unittest.TestCase):
    def setUp(self):
        self.fleet = Fleet(sys.argv_binary)
        self.addCleanup(self.fleet.end)

    def populate(self, apis=1, workers=1, stations=1, **station):
        for kind, count in (("api", apis), ("worker", workers), ("station", stations)):
            for number in range(count):
                self.fleet.add(f"{kind}{number}", kind, **(station if kind == "station" else {}))
        self.api = self.fleet.nodes["api0"]
        self.fleet.log_in(self.api)
        status, _ = self.api.call("PUT", f"/blobs/{SHA}", PLATE)
        self.assertIn(status, (201, 204))

    def submit(self, name, side=60.0, api=None):
        status, job = (api or self.api).call("POST", "/jobs", {"blob": SHA, "file_name": "plate.off", "name": name,
                                                               "params": params(side)}, {"Idempotency-Key": name})
        self.assertEqual(status, 201, job)
        return job["id"]

    def job(self, job, node=None):
        return (node or self.api).call("GET", f"/jobs/{job}")[1]

    def ready(self, job, seconds=40.0):
        found = wait(lambda: self.job(job), lambda job: job.get("state") not in (None, "queued", "computing"), seconds)
        self.assertEqual(found["state"], "ready", found["error"])
        return found

    def cut(self, job, station):
        status, cut = self.api.call("POST", f"/jobs/{job}/cuts", {"device": self.fleet.nodes[station].device})
        self.assertEqual(status, 201, cut)
        return cut["id"]

    def cut_is(self, cut, *states, seconds=40.0):
        return wait(lambda: self.api.call("GET", f"/cuts/{cut}")[1], lambda cut: cut.get("state") in states, seconds)

    def is_burning(self, cut):
        wait(lambda: self.api.call("GET", f"/cuts/{cut}")[1], lambda cut: cut["progress"]["burnt_mm"] > 20.0)

    def program_mm(self, job, only=None):
        sheets = self.job(job)["sheets"]
        programs = [self.api.call("GET", f"/jobs/{job}/artifacts/sheets/sheet-{sheet['id']:03}.gcode")[1]
                    for sheet in sheets if only in (None, sheet["id"])]
        return sum(burn_of_program(program.decode()) for program in programs)

    def burnt_once(self, station, jobs):
        """The beam burnt the programs of these jobs, each once."""
        wanted = sum(self.program_mm(job) for job in jobs)
        self.assertGreater(wanted, 0.0)
        self.assertAlmostEqual(burnt(self.fleet.nodes[station].burns) / wanted, 1.0, delta=0.01)


class FleetTest(FleetCase):
    def test_any_api_node_answers_for_all(self):
        self.populate(apis=2, auto_start=False)
        other = self.fleet.nodes["api1"]
        events = Events(other)
        job = self.submit("plate")
        ready = self.ready(job)
        self.assertEqual(self.job(job, other)["summary"], ready["summary"])
        # Files come from where they are, by their digest.
        status, package = other.call("GET", f"/jobs/{job}/package.zip")
        self.assertEqual((status, package[:2]), (200, b"PK"))
        wait(lambda: list(events.seen), lambda seen: ("job", job) in seen)
        cut = self.cut(job, "station0")
        for action in ("start", "confirm-sheet"):
            shown = wait(lambda: other.call("GET", f"/cuts/{cut}")[1], lambda cut: action in cut["actions"])
            status, answer = other.call("POST", f"/cuts/{cut}/{action}", {"program_sha256": shown["program_sha256"],
                                                                         "bed_clear": True})
            self.assertEqual(status, 202, answer)
        self.cut_is(cut, "done")
        self.burnt_once("station0", [job])
        devices = {device["id"]: device for device in other.call("GET", "/devices")[1]["devices"]}
        self.assertEqual(devices["laser-station0"]["station"], "station0")
        self.assertEqual(devices["laser-station0"]["status"]["state"], "idle")
        fleet = other.call("GET", "/fleet")[1]
        self.assertEqual({node["id"]: node["role"] for node in fleet["nodes"]},
                         {"api0": "api", "api1": "api", "worker0": "worker", "station0": "station"})
        self.assertTrue(all(node["state"] == "active" for node in fleet["nodes"]), fleet)
        self.assertEqual([lease["station"] for lease in fleet["machine_leases"]], ["station0"])
        self.assertEqual(sorted(events.seqs), list(range(events.seqs[0], events.seqs[0] + len(events.seqs))))

    def test_a_paused_station_begins_nothing(self):
        self.populate()
        job = self.submit("plate")
        self.ready(job)
        self.assertEqual(self.api.call("POST", "/fleet/station0/drain")[0], 202)
        state = lambda: {node["id"]: node["state"] for node in self.api.call("GET", "/fleet")[1]["nodes"]}
        wait(state, lambda states: states["station0"] == "drained")
        cut = self.cut(job, "station0")
        time.sleep(2 * self.fleet.lease_s)
        self.assertEqual(self.api.call("GET", f"/cuts/{cut}")[1]["state"], "waiting")
        self.assertEqual(self.api.call("POST", "/fleet/station0/resume")[0], 202)
        self.cut_is(cut, "done")
        self.assertEqual(self.api.call("POST", "/fleet/nobody/pause")[0], 404)

    def test_a_frozen_worker_loses_its_jobs_and_its_late_word_counts_nothing(self):
        self.populate(workers=2)
        for name in ("worker0", "worker1"):
            self.fleet.nodes[name].signal(signal.SIGSTOP)
        jobs = [self.submit(f"plate-{number}", 60 + number) for number in range(6)]
        zombie = self.fleet.nodes["worker0"]
        zombie.signal(signal.SIGCONT)
        wait(lambda: self.api.call("GET", "/fleet")[1]["claims"], lambda claims: claims)
        zombie.signal(signal.SIGSTOP)
        self.fleet.nodes["worker1"].signal(signal.SIGCONT)
        for job in jobs:
            self.ready(job, 60)
        zombie.signal(signal.SIGCONT)
        time.sleep(1.0)
        for job in jobs:
            self.assertEqual(self.job(job)["state"], "ready")

    def test_a_cut_goes_on_without_the_database_and_is_told_afterwards(self):
        self.populate(speed=5)
        first, second = (self.submit(f"plate-{number}", 130 + number) for number in range(2))
        self.ready(first)
        self.ready(second)
        cut = self.cut(first, "station0")
        later = self.cut(second, "station0")
        station = self.fleet.nodes["station0"]
        self.cut_is(cut, "cutting")
        self.is_burning(cut)
        self.fleet.postgres.kill()
        time.sleep(2 * self.fleet.lease_s)
        self.fleet.postgres.start()
        self.cut_is(cut, "done", seconds=60)
        self.cut_is(later, "done", seconds=60)
        self.burnt_once("station0", [first, second])

    def test_a_station_cut_off_finishes_what_it_has_and_begins_nothing(self):
        if not namespaced():
            self.skipTest("needs network namespaces")
        self.populate(speed=5)
        first, second = (self.submit(f"plate-{number}", 130 + number) for number in range(2))
        self.ready(first)
        self.ready(second)
        cut, later = self.cut(first, "station0"), self.cut(second, "station0")
        station = self.fleet.nodes["station0"]
        self.cut_is(cut, "cutting")
        self.is_burning(cut)
        station.partition()
        self.cut_is(cut, "interrupted", seconds=60)
        status, answer = self.api.call("POST", f"/cuts/{cut}/abort")
        self.assertIn(status, (409, 503), answer)
        sheet = self.program_mm(first, 1)
        wait(lambda: burnt(station.burns), lambda mm: mm > 0.99 * sheet, seconds=60)
        time.sleep(2.0)
        self.assertLess(burnt(station.burns), 1.01 * sheet)  # Neither sheet nor cut has begun.
        self.assertEqual(self.api.call("GET", f"/cuts/{later}")[1]["state"], "waiting")
        station.heal()
        self.cut_is(cut, "done", seconds=60)
        self.cut_is(later, "done", seconds=60)
        self.burnt_once("station0", [first, second])

    def test_a_killed_station_leaves_its_cut_interrupted_for_ever(self):
        self.populate(speed=5)
        job = self.submit("plate", 130)
        self.ready(job)
        cut = self.cut(job, "station0")
        station = self.fleet.nodes["station0"]
        self.cut_is(cut, "cutting")
        self.is_burning(cut)
        station.kill()
        self.cut_is(cut, "interrupted", seconds=60)
        station.start()  # Its simulated machine begins a new log.
        wait(lambda: {node["id"]: node["state"] for node in self.api.call("GET", "/fleet")[1]["nodes"]},
             lambda states: states["station0"] == "active")
        time.sleep(self.fleet.lease_s)
        self.assertEqual(self.api.call("GET", f"/cuts/{cut}")[1]["state"], "interrupted")
        self.assertEqual(burnt(station.burns), 0.0)


class Faults(threading.Thread):
    """One after the other, until it is stopped."""

    def __init__(self, fleet):
        super().__init__(daemon=True)
        self.fleet, self.stopped, self.log, self.random = fleet, threading.Event(), [], random.Random(1)
        self.start()

    def run(self):
        while not self.stopped.wait(1.0):
            kind = self.random.choice(["freeze", "kill", "partition", "database", "loss"])
            nodes = list(self.fleet.nodes.values())
            # One api node is the client's; the others may die.
            node = self.random.choice([node for node in nodes if node.name != "api0"])
            self.log.append((kind, node.name))
            if kind == "freeze":
                node.signal(signal.SIGSTOP)
                self.stopped.wait(2.0 * self.fleet.lease_s)
                node.signal(signal.SIGCONT)
            elif kind == "kill" and node.role != "station":
                node.kill()
                node.start()
            elif kind == "partition" and self.fleet.namespaces:
                node.partition()
                self.stopped.wait(1.5 * self.fleet.lease_s)
                node.heal()
            elif kind == "loss" and self.fleet.namespaces:
                subprocess.run(["tc", "qdisc", "add", "dev", node.link, "root", "netem", "loss", "20%"],
                               stderr=subprocess.DEVNULL)
                self.stopped.wait(3.0)
                subprocess.run(["tc", "qdisc", "del", "dev", node.link, "root"], stderr=subprocess.DEVNULL)
            elif kind == "database" and len([entry for entry in self.log if entry[0] == "database"]) % 4 == 1:
                self.fleet.postgres.kill()
                time.sleep(1.0)
                self.fleet.postgres.start()


@unittest.skipUnless(LONG, "LEAFCUTTER_FLEET_LONG is not set")
class LongTest(FleetCase):
    def test_a_thousand_jobs_through_every_fault(self):
        count = int(os.environ.get("LEAFCUTTER_FLEET_JOBS", "1000"))
        for number in range(2):
            self.fleet.add(f"api{number}", "api")
        for number in range(4):
            self.fleet.add(f"worker{number}", "worker", skew=("+1y", "-1y", None, None)[number])
            self.fleet.add(f"station{number}", "station", speed=400)
        self.api = self.fleet.nodes["api0"]
        self.fleet.log_in(self.api)
        self.assertIn(self.api.call("PUT", f"/blobs/{SHA}", PLATE)[0], (201, 204))
        events = Events(self.fleet.nodes["api1"])
        faults = Faults(self.fleet)
        acknowledged, sent, begun = {}, {}, time.monotonic()
        for number in range(count):
            name = f"plate-{number}"

            def once(name=name, number=number):
                sent[name] = time.monotonic()
                status, job = self.api.call("POST", "/jobs", {"blob": SHA, "file_name": "plate.off", "name": name,
                                                              "params": params(40 + 0.02 * number)},
                                            {"Idempotency-Key": name})
                return status, job
            acknowledged[name] = wait(once, lambda answer: answer[0] == 201, 120)[1]["id"]
        print(f"{count} jobs accepted in {time.monotonic() - begun:.1f} s", file=sys.stderr)
        jobs, cuts = self.drive(acknowledged, count)
        faults.stopped.set()
        faults.join()
        self.account(acknowledged, jobs, cuts, events, sent)
        print(f"all over after {time.monotonic() - begun:.0f} s; faults: "
              f"{ {kind: sum(1 for entry in faults.log if entry[0] == kind) for kind in {e[0] for e in faults.log}} }",
              file=sys.stderr)

    def all_of(self, kind):
        found, cursor = [], ""
        while cursor is not None:
            page = self.api.call("GET", f"/{kind}?limit=200{cursor and '&cursor=' + cursor}")[1]
            found += page[kind]
            cursor = page["next_cursor"]
        return {each["id"]: each for each in found}

    def drive(self, acknowledged, count):
        """Every tenth job is cut; until all of them have ended."""
        wanted = {job: number % 4 for number, job in enumerate(list(acknowledged.values())[::10])}
        deadline = time.monotonic() + 40 * 60
        while time.monotonic() < deadline:
            try:
                jobs, cuts = self.all_of("jobs"), self.all_of("cuts")
                for job, station in wanted.items():
                    if jobs[job]["state"] == "ready" and not jobs[job]["cuts"]:
                        self.cut(job, f"station{station}")
                for node in self.fleet.nodes.values():
                    if node.role == "station":  # Somebody looks at a machine that waits for a word.
                        self.api.call("POST", f"/devices/{node.device}/commands", {"command": "reset"})
                open_jobs = [job for job in jobs.values() if job["state"] in ("queued", "computing")]
                open_cuts = [cut for cut in cuts.values() if cut["state"] not in FINAL]
                if not open_jobs and not open_cuts and len(cuts) >= len(wanted):
                    return jobs, cuts
            except (OSError, AssertionError, KeyError, TypeError):
                pass
            time.sleep(2.0)
        raise AssertionError(f"{len(open_jobs)} jobs and {len(open_cuts)} cuts do not end")

    def account(self, acknowledged, jobs, cuts, events, sent):
        lost = [name for name, job in acknowledged.items() if job not in jobs]
        self.assertEqual(lost, [])
        self.assertEqual(len(jobs), len(acknowledged))
        states = {state: sum(1 for job in jobs.values() if job["state"] == state)
                  for state in {job["state"] for job in jobs.values()}}
        ended = {state: sum(1 for cut in cuts.values() if cut["state"] == state)
                 for state in {cut["state"] for cut in cuts.values()}}
        for node in self.fleet.nodes.values():
            if node.role != "station":
                continue
            mine = [cut for cut in cuts.values() if cut["device"] == node.device]
            done = sum(self.program_mm(cut["job"]) for cut in mine if cut["state"] == "done")
            most = sum(self.program_mm(cut["job"]) for cut in mine)
            self.assertGreater(burnt(node.burns), 0.99 * done, node.name)
            self.assertLess(burnt(node.burns), 1.01 * most, node.name)
        delays = [events.seen[("job", job)] - sent[name] for name, job in acknowledged.items()
                  if ("job", job) in events.seen]
        print(f"jobs {states}, cuts {ended}; from a request at one api node to the event at the other: "
              f"median {1e3 * statistics.median(delays):.0f} ms of {len(delays)}", file=sys.stderr)


if __name__ == "__main__":
    if not (BINARIES / "initdb").exists():
        print("PostgreSQL 15 is not installed")
        sys.exit(77)
    namespaced()
    sys.argv_binary = sys.argv.pop(1) if len(sys.argv) > 1 else "build/release/leafcutter"
    unittest.main()
