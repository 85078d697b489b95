#!/usr/bin/env python3
"""Cuts that end early and are finished: the daemon killed, an abort, a stop; against a simulated
machine in a process of its own, which outlives the daemon. Usage: finish_test.py LEAFCUTTER"""
import hashlib
import json
import math
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import daemon as daemons
from cuts_test import FINAL, PARAMS, PLATE
from daemon import Daemon, free_port


class Laser:
    """A simulated machine that any daemon can open."""

    def __init__(self, folder, speed):
        self.port = folder / "laser"
        self.log = folder / "laser.jsonl"
        self.process = subprocess.Popen(
            [daemons.BINARY, "simulate", "grbl", "--pty", str(self.port), "--burn", str(self.log),
             "--speed", str(speed)], stdout=subprocess.PIPE, text=True)
        self.uri = self.process.stdout.readline().strip()

    def burnt_mm(self):
        pieces = [json.loads(line) for line in self.log.read_text().splitlines()]
        return sum(math.hypot(p["x1"] - p["x0"], p["y1"] - p["y0"]) for p in pieces if p["s"] > 0)

    def stop(self):
        self.process.terminate()
        self.process.wait()
        self.process.stdout.close()


class Finish(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.state = Path(self.folder.name) / "state"
        self.laser = Laser(Path(self.folder.name), 4)
        self.addCleanup(self.laser.stop)
        self.daemon = Daemon(self.state, free_port())
        sha = hashlib.sha256(PLATE).hexdigest()
        self.daemon.call("PUT", f"/api/v1/blobs/{sha}", PLATE)
        self.ask("PUT", "/devices/laser", {"name": "laser", "uri": self.laser.uri, "auto_start": False})
        self.job = self.ask("POST", "/jobs", {"blob": sha, "name": "plate.off", "params": PARAMS})[1]
        self.wait(f"/jobs/{self.job['id']}", lambda job: job["state"] == "ready")
        report = self.get(f"/jobs/{self.job['id']}/artifacts/report.json")
        self.planned = next(s["burn_mm"] for s in report["cut"]["sheets"] if s["sheet"] == 1)

    def tearDown(self):
        self.daemon.stop()

    def ask(self, method, path, body=None):
        head = {"Content-Type": "application/json"} if body is not None else {}
        text = json.dumps(body) if body is not None else None
        status, _, answer = self.daemon.exchange(method, "/api/v1" + path, text, head)
        return status, json.loads(answer) if answer else None

    def get(self, path):
        return self.ask("GET", path)[1]

    def wait(self, path, condition, seconds=30.0):
        deadline = time.monotonic() + seconds
        while not condition(thing := self.get(path)):
            self.assertLess(time.monotonic(), deadline, f"{path} stays {thing}")
            time.sleep(0.02)
        return thing

    def machine_is(self, state):
        self.wait("/devices/laser", lambda device: device["status"]["state"] == state)

    def fire(self, path):
        cut = self.wait(path, lambda cut: "start" in cut["actions"])
        said = {"program_sha256": cut["program_sha256"], "bed_clear": True}
        self.assertEqual(self.ask("POST", path + "/start", said)[0], 202)

    def burning(self, part):
        status, cut = self.ask("POST", f"/jobs/{self.job['id']}/cuts", {"device": "laser", "sheets": [1]})
        self.assertEqual(status, 201, cut)
        path = f"/cuts/{cut['id']}"
        self.fire(path)
        live = self.wait(path, lambda cut: cut["progress"]["burnt_mm"] > part * self.planned)
        self.assertAlmostEqual(live["progress"]["burn_mm"], self.planned, delta=1)
        return path

    def finish(self, path, **said):
        status, rest = self.ask("POST", path + "/finish", {"material_in_place": True, **said})
        self.assertEqual(status, 201, rest)
        self.assertEqual((rest["rest_of"], rest["state"]), (path.split("/")[-1], "waiting"))
        again = self.ask("POST", path + "/finish", {"material_in_place": True, **said})
        self.assertEqual((again[0], again[1]["code"]), (409, "not-now"))
        path = f"/cuts/{rest['id']}"
        self.fire(path)
        over = self.wait(path, lambda cut: cut["state"] in FINAL)
        self.assertEqual(over["state"], "done", over["reason"])
        # Burnt twice less what is not burnt at all; both are seams of at most a millimetre.
        time.sleep(0.2)
        self.assertAlmostEqual(self.laser.burnt_mm(), self.planned, delta=1.0)

    def test_the_rest_after_the_daemon_was_killed(self):
        path = self.burning(0.05)  # Early: its last lines are so long that few hold half of it.
        self.daemon.kill()
        deadline = time.monotonic() + 30
        while not self.laser.burnt_mm():  # Its log is written when it stands: having done all it had been sent.
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.1)
        burnt = self.laser.burnt_mm()
        self.daemon = Daemon(self.state, free_port())
        cut = self.get(path)
        self.assertEqual(cut["state"], "interrupted")
        self.assertLessEqual(cut["beam"]["least_mm"], burnt + 0.5)
        self.assertGreaterEqual(cut["beam"]["most_mm"], burnt - 0.5)
        self.assertAlmostEqual(cut["beam"]["total_mm"], self.planned, delta=1)
        status, problem = self.ask("POST", path + "/finish", {"material_in_place": True, "homed": True})
        self.assertEqual((status, problem["code"]), (409, "device-not-ready"))
        time.sleep(1.0)
        self.assertEqual(self.laser.burnt_mm(), burnt)  # Nothing by itself.
        self.ask("POST", "/devices/laser/commands", {"command": "reset"})
        self.machine_is("idle")
        # Where the machine stands tells the rest.
        cut = self.wait(path, lambda cut: cut["beam"]["certain"])
        self.assertAlmostEqual(cut["beam"]["burnt_mm"], burnt, delta=0.5)
        self.assertTrue(cut["beam"]["position_kept"])
        self.assertEqual(cut["actions"], ["finish"], cut)
        self.finish(path)

    def test_the_rest_after_an_abort_and_after_a_stop(self):
        path = self.burning(0.2)
        self.assertEqual(self.ask("POST", path + "/abort")[0], 202)
        cut = self.wait(path, lambda cut: cut["state"] in FINAL)
        self.assertEqual(cut["state"], "aborted")
        self.assertTrue(cut["beam"]["certain"] and cut["beam"]["position_kept"], cut["beam"])
        self.assertAlmostEqual(cut["beam"]["burnt_mm"], self.laser.burnt_mm(), delta=0.5)
        status, problem = self.ask("POST", path + "/finish", {})
        self.assertEqual((status, problem["code"]), (422, "bad-field"))
        status, rest = self.ask("POST", path + "/finish", {"material_in_place": True})
        self.assertEqual(status, 201, rest)
        path = f"/cuts/{rest['id']}"
        self.fire(path)
        self.wait(path, lambda cut: cut["progress"]["burnt_mm"] > 0.2 * self.planned)
        self.ask("POST", "/devices/laser/commands", {"command": "stop"})
        cut = self.wait(path, lambda cut: cut["state"] in FINAL)
        self.assertTrue(cut["beam"]["certain"], cut["beam"])
        self.assertFalse(cut["beam"]["position_kept"])
        self.machine_is("alarm")
        self.ask("POST", "/devices/laser/commands", {"command": "unlock"})
        self.machine_is("idle")
        status, problem = self.ask("POST", path + "/finish", {"material_in_place": True})
        self.assertEqual((status, problem["code"]), (422, "bad-field"))
        self.finish(path, homed=True)


if __name__ == "__main__":
    unittest.main()
