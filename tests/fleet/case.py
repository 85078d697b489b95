"""What the tests of a fleet share: its client, its listeners, and how its nodes are begun."""
import http.client
import json
import sys
import threading
import time
import unittest

from beam import PLATE, SHA, burn_of_program, burnt, params
from world import Fleet, wait


class Events(threading.Thread):
    """What a node's stream tells, with the time of its arrival; goes on after a break."""

    def __init__(self, node):
        super().__init__(daemon=True)
        self.node, self.seen, self.seqs = node, {}, []
        self.open = threading.Event()
        self.start()
        assert self.open.wait(10)

    def run(self):
        while True:
            try:
                self.listen()
            except (OSError, http.client.HTTPException, ValueError):
                pass
            time.sleep(0.2)

    def listen(self):
        connection = http.client.HTTPConnection(self.node.address, self.node.port, timeout=20)
        last = {"Last-Event-ID": str(self.seqs[-1])} if self.seqs else {}
        try:
            connection.request("GET", "/api/v1/events", headers={**self.node.fleet.auth, **last})
            stream = connection.getresponse()
            while line := stream.readline().decode():
                if line.startswith("data: "):
                    self.take(json.loads(line[6:]))
        finally:
            connection.close()

    def take(self, data):
        if data.get("type") == "snapshot":
            self.open.set()
        elif "seq" in data:
            self.seqs.append(data["seq"])
            self.seen.setdefault((data["type"], data["id"]), time.monotonic())


class FleetCase(unittest.TestCase):
    def setUp(self):
        self.fleet = Fleet(sys.argv_binary)
        self.addCleanup(self.fleet.end)

    def populate(self, apis=1, workers=1, stations=1, api=None, **station):
        options = {"api": api or {}, "worker": {}, "station": station}
        for kind, count in (("api", apis), ("worker", workers), ("station", stations)):
            for number in range(count):
                self.fleet.add(f"{kind}{number}", kind, **options[kind])
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
