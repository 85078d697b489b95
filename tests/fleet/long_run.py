"""The long run: 2 api, 4 workers, 4 stations, LEAFCUTTER_FLEET_JOBS jobs, and all that can happen to
hosts, networks and the database meanwhile."""
import http.client
import os
import random
import signal
import statistics
import sys
import threading
import time
import unittest
from collections import Counter

from beam import PLATE, SHA, Targets, burns_of_program, burnt, params
from case import Events, FleetCase
from world import wait

FINAL = ("done", "aborted", "failed", "interrupted")
SKEW = {"api1": "+1h", "worker0": "+1y", "worker1": "-1y", "station0": "-1y", "station1": "+1y"}


class Faults(threading.Thread):
    """One after the other, until it is ended."""

    def __init__(self, fleet):
        super().__init__(daemon=True)
        self.fleet, self.stopped, self.counts, self.random = fleet, threading.Event(), Counter(), random.Random(1)
        self.error = None
        self.start()

    def end(self):
        self.stopped.set()
        self.join()
        if self.error:
            raise self.error

    def run(self):
        kinds = [self.freeze, self.kill, self.freeze, self.kill, self.kill_database, self.freeze_database]
        if self.fleet.namespaces:
            kinds += 2 * [self.partition] + 2 * [self.lose]
        try:
            while not self.stopped.wait(1.0):
                kind = self.random.choice(kinds)
                node = self.random.choice(list(self.fleet.nodes.values()))
                self.counts[kind.__name__] += 1
                kind(node)
        except Exception as error:  # pylint: disable=broad-except; end() tells it.
            self.error = error

    def freeze(self, node):
        node.signal(signal.SIGSTOP)
        self.stopped.wait(2.0 * self.fleet.lease_s)
        node.signal(signal.SIGCONT)

    def kill(self, node):
        node.kill()
        node.start()

    def partition(self, node):
        node.partition()
        self.stopped.wait(1.5 * self.fleet.lease_s)
        node.heal()

    def lose(self, node):
        node.lose_packets(20)
        self.stopped.wait(1.5 * self.fleet.lease_s)
        node.lose_packets(0)

    def kill_database(self, _):
        self.fleet.postgres.kill()
        self.stopped.wait(1.0)
        self.fleet.postgres.start()

    def freeze_database(self, _):
        self.fleet.postgres.signal(signal.SIGSTOP)
        self.stopped.wait(1.5 * self.fleet.lease_s)
        self.fleet.postgres.signal(signal.SIGCONT)


@unittest.skipUnless(os.environ.get("LEAFCUTTER_FLEET_LONG"), "LEAFCUTTER_FLEET_LONG is not set")
class LongTest(FleetCase):
    def test_a_thousand_jobs_through_every_fault(self):
        count = int(os.environ.get("LEAFCUTTER_FLEET_JOBS", "1000"))
        for kind, nodes, options in (("api", 2, {}), ("worker", 4, {}), ("station", 4, {"speed": 100})):
            for number in range(nodes):
                name = f"{kind}{number}"
                self.fleet.add(name, kind, skew=SKEW.get(name), **options)
        self.apis = [self.fleet.nodes["api0"], self.fleet.nodes["api1"]]
        self.api = self.apis[0]
        self.fleet.log_in(self.api)
        self.assertIn(self.api.call("PUT", f"/blobs/{SHA}", PLATE)[0], (201, 204))
        events = Events(self.fleet.nodes["api1"])
        faults = Faults(self.fleet)
        begun = time.monotonic()
        sent = {}
        acknowledged = {f"plate-{number}": self.send(f"plate-{number}", 40 + 0.02 * number, sent)
                        for number in range(count)}
        print(f"{count} jobs accepted in {time.monotonic() - begun:.1f} s", file=sys.stderr)
        self.drive(list(acknowledged.values()))
        faults.end()
        time.sleep(2 * self.fleet.lease_s)  # Whoever was out of sight says what became of its cut.
        self.drive(list(acknowledged.values()))
        wait(lambda: self.newest(), lambda newest: events.seqs[-1] >= newest)
        self.account(acknowledged)
        self.assertEqual(events.seqs, list(range(events.seqs[0], events.seqs[-1] + 1)))
        delays = [events.seen["job", job] - sent[name] for name, job in acknowledged.items()]
        print(f"{len(events.seqs)} events without a gap; from a job's first request to its event at the other api node: "
              f"median {1e3 * statistics.median(delays):.0f} ms, longest {max(delays):.1f} s\n"
              f"all over after {time.monotonic() - begun:.0f} s; faults: {dict(faults.counts)}", file=sys.stderr)

    def ask(self, method, path, *rest):
        """Whichever api node answers, the one that did last first."""
        for _ in self.apis:
            try:
                status, answer = self.apis[0].call(method, path, *rest, timeout=5)
                if status != 503:
                    return status, answer
            except (OSError, http.client.HTTPException):
                pass
            self.apis.append(self.apis.pop(0))
        return 503, {}

    def send(self, name, side, sent):
        sent[name] = time.monotonic()
        job = {"blob": SHA, "file_name": "plate.off", "name": name, "params": params(side)}
        return wait(lambda: self.ask("POST", "/jobs", job, {"Idempotency-Key": name}),
                    lambda answer: answer[0] == 201, 120)[1]["id"]

    def newest(self):
        return int(self.fleet.postgres.ask("SELECT last FROM event_counter"))

    def all_of(self, kind):
        found, cursor = [], ""
        while cursor is not None:
            status, page = self.ask("GET", f"/{kind}?limit=200{cursor and f'&cursor={cursor}'}")
            if status != 200:
                return None
            found += page[kind]
            cursor = page["next_cursor"]
        return {each["id"]: each for each in found}

    def drive(self, ids):
        """Every tenth job is cut; until all of them have ended."""
        wanted = {job: f"laser-station{number % 4}" for number, job in enumerate(ids[::10])}
        deadline = time.monotonic() + 40 * 60
        open_jobs, open_cuts, stuck = ids, [], {}
        while time.monotonic() < deadline:
            time.sleep(2.0)
            jobs, cuts = self.all_of("jobs"), self.all_of("cuts")
            if jobs is None or cuts is None:
                continue
            for job, device in wanted.items():
                if jobs[job]["state"] == "ready" and not jobs[job]["cuts"]:
                    self.ask("POST", f"/jobs/{job}/cuts", {"device": device}, {"Idempotency-Key": f"cut-{job}"})
            open_jobs = [job for job in jobs.values() if job["state"] in ("queued", "computing")]
            open_cuts = [cut for cut in cuts.values() if cut["state"] not in FINAL]
            if not open_jobs and not open_cuts and {cut["job"] for cut in cuts.values()} == set(wanted):
                return
            stuck = self.look_at_machines(open_cuts, stuck)
        raise AssertionError(f"{len(open_jobs)} jobs and {len(open_cuts)} cuts do not end: "
                             f"{open_jobs[:3]}, {open_cuts[:3]}")

    def look_at_machines(self, open_cuts, stuck):
        """An operator comes by where cuts wait and nothing has moved since the last look."""
        status, answer = self.ask("GET", "/devices")
        waiting = {cut["device"] for cut in open_cuts if cut["state"] in ("waiting", "awaiting-sheet")}
        busy = {cut["device"] for cut in open_cuts if cut["state"] in ("armed", "cutting", "paused")}
        now = {}
        for device in answer["devices"] if status == 200 else []:
            if device["id"] in waiting - busy and device["cut"] is None:
                now[device["id"]] = stuck.get(device["id"], 0) + 1
                if now[device["id"]] >= 3:
                    self.ask("POST", f"/devices/{device['id']}/commands", {"command": "reset"})
                    now[device["id"]] = 0
        return now

    def account(self, acknowledged):
        jobs, cuts = self.all_of("jobs"), self.all_of("cuts")
        self.assertEqual([name for name, job in acknowledged.items() if job not in jobs], [])
        self.assertEqual(len(jobs), len(acknowledged))
        for node in self.fleet.nodes.values():
            if node.role == "station":
                self.check_beam(node, [cut for cut in cuts.values() if cut["device"] == node.device])
        print(f"jobs {dict(Counter(job['state'] for job in jobs.values()))}, "
              f"cuts {dict(Counter(cut['state'] for cut in cuts.values()))}", file=sys.stderr)

    def check_beam(self, node, cuts):
        """What it says it has done is burnt, and nothing is burnt twice."""
        self.assertEqual(len({cut["job"] for cut in cuts}), len(cuts))
        done, all_of_them, done_mm = Targets(), Targets(), 0.0
        for cut in cuts:
            for sheet in cut["sheets"]:
                program = self.ask("GET", f"/jobs/{cut['job']}/artifacts/sheets/sheet-{sheet:03}.gcode")[1]
                millimetres, ends = burns_of_program(program.decode())
                all_of_them.add(ends)
                if cut["state"] == "done":
                    done.add(ends)
                    done_mm += millimetres
        self.assertEqual(all_of_them.count(node.burns), [], node.name)
        done.count(node.burns)
        self.assertEqual(done.missing(), [], node.name)
        self.assertGreater(burnt(node.burns), 0.99 * done_mm, node.name)
