#!/usr/bin/env python3
"""Several nodes on one PostgreSQL, and what can happen to them. Usage: fleet_test.py LEAFCUTTER
The short run is for every day; LEAFCUTTER_FLEET_LONG=1 adds that of long_run.py."""
import http.server
import json
import signal
import sys
import threading
import time
import unittest

from beam import burnt
from case import Events, FleetCase
from long_run import LongTest  # noqa: F401, a test of this program too
from world import BINARIES, namespaced, wait


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
        before = burnt(station.burns)
        self.assertGreater(before, 20.0)
        station.start()
        wait(lambda: {node["id"]: node["state"] for node in self.api.call("GET", "/fleet")[1]["nodes"]},
             lambda states: states["station0"] == "active")
        time.sleep(self.fleet.lease_s)
        self.assertEqual(self.api.call("GET", f"/cuts/{cut}")[1]["state"], "interrupted")
        self.assertEqual(burnt(station.burns), before)


class Receiver(http.server.ThreadingHTTPServer):
    """Of a webhook: the deliveries, in the order of their arrival."""
    daemon_threads = True

    def __init__(self, address):
        self.deliveries = []
        receiver = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                receiver.deliveries.append((int(self.headers["X-Leafcutter-Delivery"]), body["id"], body["change"]))
                self.send_response(204)
                self.end_headers()

            def log_message(self, *_):
                pass

        super().__init__((address, 0), Handler)
        threading.Thread(target=self.serve_forever, daemon=True).start()

    @property
    def config(self):
        address, port = self.server_address
        return (f'[[webhook]]\nurl = "http://{address}:{port}/hook"\nsecret = "a secret of the hook"\n'
                'events = ["job"]\nallow_private = true\n')


class DutiesTest(FleetCase):
    def duty(self, name, node=None):
        duties = (node or self.api).call("GET", "/fleet")[1]["duties"]
        return next((duty["node"] for duty in duties if name in duty["duty"] and duty["held"]), None)

    def test_two_api_nodes_with_one_webhook_tell_each_event_once(self):
        receiver = Receiver(self.fleet.postgres.address)
        self.addCleanup(receiver.server_close)
        self.addCleanup(receiver.shutdown)
        self.populate(apis=2, stations=0, api={"config": receiver.config})
        first = wait(lambda: self.duty("webhook"), lambda node: node)
        self.assertIn(wait(lambda: self.duty("housekeeping"), lambda node: node), ("api0", "api1"))
        jobs = [self.submit(f"plate-{number}", 60 + number) for number in range(3)]
        for job in jobs:
            self.ready(job)
        told = lambda job: [change for _, id, change in receiver.deliveries if id == job]
        for job in jobs:
            wait(lambda: told(job), lambda changes: "computing -> ready" in changes)
        ids = [delivery for delivery, _, _ in receiver.deliveries]
        self.assertEqual(ids, sorted(set(ids)))
        # The one that tells dies: the other one goes on, and leaves nothing out.
        self.fleet.nodes[first].kill()
        self.api = next(node for node in self.fleet.nodes.values() if node.role == "api" and node.name != first)
        last = self.submit("plate-last")
        wait(lambda: told(last), lambda changes: "computing -> ready" in changes)
        self.assertEqual(self.duty("webhook"), self.api.name)
        job_events = int(self.fleet.postgres.ask("SELECT count(*) FROM event WHERE type = 'job'"))
        self.assertEqual(len({delivery for delivery, _, _ in receiver.deliveries}), job_events)

    def test_a_sheet_framed_at_a_station_is_framed_everywhere(self):
        self.populate(apis=2, auto_start=False)
        cut = self.cut(self.ready(self.submit("plate"))["id"], "station0")
        framed = lambda node: [step["done"] for step in node.call("GET", f"/cuts/{cut}")[1]["steps"]
                               if step["step"] == "frame"]
        self.assertEqual(framed(self.api), [False])
        device = self.fleet.nodes["station0"].device
        wait(lambda: self.api.call("GET", f"/devices/{device}")[1]["status"]["state"], lambda state: state == "idle")
        self.assertEqual(self.api.call("POST", f"/devices/{device}/commands", {"command": "frame"})[0], 202)
        for name in ("api0", "api1", "station0"):
            wait(lambda: framed(self.fleet.nodes[name]), lambda done: done == [True])


if __name__ == "__main__":
    if not (BINARIES / "initdb").exists():
        print("PostgreSQL 15 is not installed")
        sys.exit(77)
    namespaced()
    sys.argv_binary = sys.argv.pop(1) if len(sys.argv) > 1 else "build/release/leafcutter"
    unittest.main()
