#!/usr/bin/env python3
"""The daemon killed before and after every step that has to survive it, and at random times under
load. Nothing acknowledged may be lost, and no segment be burnt twice.
Usage: crash_test.py LEAFCUTTER
LEAFCUTTER_CRASH_POINTS=all takes every point, LEAFCUTTER_KILLS=500 so many random kills."""
import hashlib
import http.client
import json
import os
import random
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

import daemon
from cuts_test import PARAMS, PLATE
from daemon import Daemon, free_port

POINTS = ["commit.before", "commit.after", "blob.before-rename", "blob.after-rename",
          "compute.before-result", "begin-sheet.before-intent", "backup.before-rename",
          "backup.after-rename", "migrate.before-commit", "migrate.after-commit",
          "seal.before-rename", "seal.after-rename"]
SHORT = [("commit.before", 9), ("commit.after", 14), ("blob.after-rename", 3),
         ("compute.before-result", 1), ("begin-sheet.before-intent", 1), ("backup.before-rename", 1),
         ("migrate.before-commit", 3), ("migrate.after-commit", 2)]
JOBS = 2
GONE = (ConnectionError, http.client.HTTPException, OSError)


class Died(Exception):
    """The daemon is gone."""


class World:
    """What a client that retries knows: what was acknowledged, whatever became of the daemon."""

    def __init__(self, folder):
        self.state = Path(folder) / "state"
        self.port = free_port()
        self.runs = 0
        self.acknowledged = {}   # Name of a job: its id.
        self.begun = set()       # Cuts that were once seen begun.
        self.daemon = None
        self.restart_s = []

    def start(self, crash=None):
        """False: it died while it started, as it was told to."""
        self.runs += 1
        for log in list((self.state / "burns").glob("run-*.jsonl")):
            log.rename(log.with_name(f"until-{self.runs}-{log.name}"))
        environment = dict(os.environ)
        if crash:
            environment["LEAFCUTTER_CRASH"] = crash
        begun = time.monotonic()
        process = subprocess.Popen(
            [daemon.BINARY, "serve", "--state", str(self.state), "--listen", f"127.0.0.1:{self.port}"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment)
        line = process.stdout.readline()
        if "http://" not in line:
            process.wait()
            process.stdout.close()
            return False
        self.restart_s.append(time.monotonic() - begun)
        self.daemon = Daemon.__new__(Daemon)
        self.daemon.port, self.daemon.process = self.port, process
        return True

    def ask(self, method, path, body=None, headers=None):
        try:
            status, answer = self.daemon.call(
                method, "/api/v1" + path, body if isinstance(body, (bytes, type(None))) else json.dumps(body),
                {**({} if isinstance(body, (bytes, type(None))) else {"Content-Type": "application/json"}),
                 **(headers or {})})
        except GONE as error:
            raise Died() from error
        return status, json.loads(answer) if answer[:1] in (b"{", b"[") else answer

    def wait(self, path, condition, seconds=30.0):
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            thing = self.ask("GET", path)[1]
            if condition(thing):
                return thing
            time.sleep(0.02)
        raise AssertionError(f"{path} stays {thing}")

    def computed(self, job):
        return self.wait(f"/jobs/{job}", lambda job: job["state"] not in ("queued", "computing"))

    def log(self):
        return self.state / "burns" / f"run-{self.runs}.jsonl"

    def play(self):
        """All that a workshop wants, as far as it is not done yet."""
        status, answer = self.ask("PUT", "/devices/laser", {
            "name": "laser", "uri": f"sim:grbl?speed=400&burn={self.log()}", "auto_start": True})
        # A cut that waited may have begun by itself, on the machine as it was.
        assert status in (200, 201) or answer["code"] == "refused", answer
        # A cut that ended early needs somebody's word before the next one goes by itself.
        self.ask("POST", "/devices/laser/commands", {"command": "reset"})
        sha = hashlib.sha256(PLATE).hexdigest()
        self.ask("PUT", f"/blobs/{sha}", PLATE)
        for number in range(JOBS):
            name = f"plate-{number}"
            params = {**PARAMS, "scale": {"longest_side_mm": 60 + 7 * number}}
            status, job = self.ask("POST", "/jobs", {"blob": sha, "file_name": "plate.off", "name": name, "params": params},
                                   {"Idempotency-Key": name})
            assert status == 201, job
            assert self.acknowledged.setdefault(name, job["id"]) == job["id"], "accepted twice"
        for name, job in self.acknowledged.items():
            ready = self.computed(job)
            if ready["dead_letter"]:  # Three daemons died while it was computed: somebody says it was not the job.
                self.ask("POST", f"/jobs/{job}/retry", {"cause": "the daemon was killed"})
                ready = self.computed(job)
            assert ready["state"] in ("ready", "done"), ready["error"]
            if not ready["cuts"]:
                status, cut = self.ask("POST", f"/jobs/{job}/cuts", {"device": "laser"})
                assert status == 201, cut
        self.ask("POST", "/backups", {})
        for cut in self.ask("GET", "/cuts")[1]["cuts"]:
            self.wait(f"/cuts/{cut['id']}",
                      lambda cut: cut["state"] in ("done", "failed", "aborted", "interrupted"))

    def check(self):
        """Right after a start: what was acknowledged is there, once, and its log has no gap."""
        jobs = self.ask("GET", "/jobs?limit=200")[1]["jobs"]
        ids = [job["id"] for job in jobs]
        for name, job in self.acknowledged.items():
            assert ids.count(job) == 1, f"{name} is there {ids.count(job)} times"
        assert len({job["name"] for job in jobs}) == len(jobs), "a job was accepted twice"
        for job in jobs:
            if job["state"] in ("ready", "done"):
                for artifact in self.ask("GET", f"/jobs/{job['id']}/artifacts")[1]["artifacts"]:
                    sha = artifact["sha256"]
                    blob = self.state / "blobs" / sha[:2] / sha
                    assert hashlib.sha256(blob.read_bytes()).hexdigest() == sha, artifact["path"]
        for cut in self.ask("GET", "/cuts")[1]["cuts"]:
            assert cut["state"] not in ("cutting", "paused"), cut
        assert not list((self.state / "blobs/incoming").iterdir()), "a file is left over"

    def burnt_once(self):
        """No segment in the logs of two runs."""
        seen = {}
        for log in sorted((self.state / "burns").glob("*.jsonl")):
            for line in log.read_text().splitlines():
                piece = json.loads(line) if line.endswith("}") else {"s": 0}
                if piece["s"] > 0:
                    key = tuple(round(piece[side], 3) for side in ("x0", "y0", "x1", "y1"))
                    assert seen.setdefault(key, log) == log, f"{key} was burnt twice"
        return len(seen)

    def end(self):
        if self.daemon and self.daemon.process.poll() is None:
            self.daemon.kill()
        elif self.daemon:
            self.daemon.process.stdout.close()


def old_database(folder):
    """A state folder as the first version left it: every migration is still to come."""
    source = (Path(__file__).parents[2] / "server/store/sqlite/schema.cpp").read_text()
    first = source.split('R"sql(')[1].split(')sql"')[0]
    import sqlite3
    (Path(folder) / "state").mkdir()
    base = sqlite3.connect(Path(folder) / "state/leafcutter.db")
    base.executescript(first + "PRAGMA user_version = 1;")
    base.execute("INSERT INTO job(id, name, state, created_ms, updated_ms, file_name, file_bytes, "
                 "file_sha256, params) VALUES('j_old', 'old', 'cancelled', 1, 1, 'a', 1, 'x', '{}')")
    base.commit()
    base.close()


class CrashTest(unittest.TestCase):
    def through(self, crash):
        """Whether the point was reached."""
        with tempfile.TemporaryDirectory() as folder:
            world = World(folder)
            if crash.startswith("migrate"):
                old_database(folder)
                world.acknowledged["old"] = "j_old"
            died = False
            try:
                if not world.start(crash):
                    died = True
                else:
                    try:
                        if "old" not in world.acknowledged:
                            world.play()
                    except Died:
                        died = True
                    world.end()
                self.assertTrue(world.start(), "it does not start again")
                world.check()
                world.acknowledged.pop("old", None)
                world.play()
                world.check()
                self.assertGreater(world.burnt_once(), 0)
            finally:
                world.end()
            return died

    def test_every_step_survives_a_kill_before_and_after_it(self):
        if os.environ.get("LEAFCUTTER_CRASH_POINTS") == "all":
            plan = [(point, n) for point in POINTS for n in range(1, 60)]
        else:
            plan = SHORT
        missed, reached = set(), 0
        for point, count in plan:
            if point in missed:
                continue
            with self.subTest(point=point, count=count):
                if self.through(f"{point}:{count}"):
                    reached += 1
                else:
                    missed.add(point)
                    self.assertGreater(count, 1, f"{point} is never reached")
        print(f"{reached} kills at named points")

    def test_kills_at_random_times_lose_and_burn_nothing_twice(self):
        kills = int(os.environ.get("LEAFCUTTER_KILLS", "4"))
        chance = random.Random(8)
        done, restarts = 0, []
        while done < kills:
            with tempfile.TemporaryDirectory() as folder:
                world = World(folder)
                try:
                    for _ in range(min(10, kills - done)):
                        self.assertTrue(world.start())
                        world.check()
                        killer = threading.Timer(chance.uniform(0.02, 2.0), world.daemon.process.kill)
                        killer.start()
                        try:
                            world.play()
                        except Died:
                            pass
                        killer.join()
                        world.daemon.process.wait()
                        world.daemon.process.stdout.close()
                        done += 1
                    self.assertTrue(world.start())
                    world.check()
                    world.burnt_once()
                    restarts += world.restart_s
                finally:
                    world.end()
        print(f"{done} random kills; the slowest start took {max(restarts):.2f} s")


if __name__ == "__main__":
    unittest.main()
