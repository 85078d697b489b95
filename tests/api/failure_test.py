#!/usr/bin/env python3
"""The store's rows of the failure matrix: disk full, foreign locks, damage, jumping clocks, two
daemons, uploads that break off, and jobs that break their process.
Usage: failure_test.py LEAFCUTTER"""
import collections
import concurrent.futures
import fcntl
import hashlib
import json
import os
import random
import resource
import shutil
import socket
import sqlite3
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import daemon
from crash_test import World
from cuts_test import PARAMS, PLATE
from daemon import Daemon, free_port
from finish_test import Laser

SHA = hashlib.sha256(PLATE).hexdigest()
FLIPS = int(os.environ.get("LEAFCUTTER_FLIPS", "8"))


class FailureTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.world = World(self.folder.name)

    def tearDown(self):
        self.world.end()
        self.folder.cleanup()

    def submit(self, name="plate", expected=201, params=None):
        self.world.ask("PUT", f"/blobs/{SHA}", PLATE)
        status, job = self.world.ask("POST", "/jobs", {"blob": SHA, "file_name": "plate.off", "name": name,
                                                    "params": params or PARAMS})
        self.assertEqual(status, expected, job)
        return job

    def ended(self, job):
        return self.world.wait(f"/jobs/{job['id']}", lambda job: job["state"] not in ("queued", "computing"))

    def test_a_full_disk_is_said_before_anything_is_taken_and_passes(self):
        state = self.world.state
        state.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16m", "tmpfs", str(state)],
                                               stderr=subprocess.DEVNULL).returncode:
            self.skipTest("needs the right to mount")
        try:
            self.assertTrue(self.world.start())
            first = self.ended(self.submit("first"))
            filler = state / "filler"
            with filler.open("wb", buffering=0) as out:  # A buffer would be written again on closing.
                try:
                    while True:
                        out.write(bytes(65536))
                except OSError:
                    pass
            other = PLATE + b"\n"
            status, answer = self.world.ask("PUT", "/blobs/" + hashlib.sha256(other).hexdigest(), other)
            self.assertEqual((status, answer["code"]), (507, "disk"))
            status, answer = self.world.ask("GET", "/readyz")
            self.assertEqual((status, answer["disk"]), (503, False))
            self.assertEqual(self.world.ask("GET", "/jobs/" + first["id"])[0], 200)
            # Small changes go on in the room that is reserved, or are refused; nothing breaks.
            for number in range(200):
                status, answer = self.world.ask("POST", "/queue/pause", {"reason": "x" * 900})
                self.assertIn(status, (200, 507), answer)
            filler.unlink()
            self.assertEqual(self.world.ask("POST", "/queue/resume", {})[0], 200)
            self.assertEqual(self.ended(self.submit("second"))["state"], "ready")
        finally:
            self.world.end()
            self.world.daemon = None
            subprocess.run(["umount", str(state)], check=True)

    def test_a_foreign_lock_is_busy_and_passes(self):
        self.assertTrue(self.world.start())
        self.submit("before")
        foreign = sqlite3.connect(self.world.state / "leafcutter.db", isolation_level=None)
        foreign.execute("BEGIN IMMEDIATE")
        status, answer = self.world.ask("POST", "/queue/pause", {"reason": "locked"})
        self.assertEqual((status, answer["code"]), (503, "store-busy"))
        self.assertEqual(self.world.ask("GET", "/jobs")[0], 200)
        foreign.execute("ROLLBACK")
        foreign.close()
        self.assertEqual(self.world.ask("POST", "/queue/pause", {"reason": "free"})[0], 200)

    def test_any_damage_is_rescued_or_shown_and_never_crashes(self):
        self.assertTrue(self.world.start())
        job = self.ended(self.submit("kept"))
        self.assertEqual(self.world.ask("POST", "/backups", {})[0], 201)
        right = self.world.ask("GET", "/jobs/" + job["id"])[1]
        self.world.daemon.stop()
        whole = Path(self.folder.name) / "whole"
        shutil.copytree(self.world.state, whole)
        chance = random.Random(1)
        ends = collections.Counter()
        for number in range(FLIPS):
            shutil.rmtree(self.world.state)
            shutil.copytree(whole, self.world.state)
            backups = ("whole", "none", "rotten")[number % 3]
            if backups == "none":
                shutil.rmtree(self.world.state / "backups")
            elif backups == "rotten":
                for each in (self.world.state / "backups").glob("*.db"):
                    self.rot(each, 1, chance)
            self.rot(self.world.state / "leafcutter.db", chance.choice((1, 20, 400)), chance)
            if not self.world.start():
                # With accounts that can't be read nobody may be let in.
                self.assertNotEqual(backups, "whole", f"flips {number}")
                ends["refused to start"] += 1
                continue
            ready = self.world.ask("GET", "/readyz")[1]
            status, shown = self.world.ask("GET", "/jobs/" + job["id"])
            if backups == "whole":
                self.assertFalse(ready["read_only"], ready)
                self.assertEqual((status, shown), (200, right), f"flips {number}")
                self.assertEqual(len(list(self.world.state.glob("*.corrupt-*"))), 1)
                ends["restored, and right"] += 1
            else:
                self.assertIn(status, (200, 404, 500, 503))
                self.assertTrue(ready["read_only"], ready)
                self.assertNotEqual(ready["trouble"], "")
                self.assertEqual(self.world.ask("POST", "/queue/pause", {})[0], 503)
                ends["read only, and said so"] += 1
            self.world.daemon.kill()
        self.world.daemon = None
        print(f"{FLIPS} damaged databases: {dict(ends)}")

    def rot(self, file, flips, chance):
        """Bits that turn as a disk turns them: nobody wrote the file."""
        left = file.stat()
        data = bytearray(file.read_bytes())
        places = chance.sample(range(len(data) * 8), flips)
        for place in places:
            data[place // 8] ^= 1 << place % 8
        file.write_bytes(data)
        os.utime(file, ns=(left.st_atime_ns, left.st_mtime_ns))

    def test_two_daemons_on_one_folder_or_port(self):
        self.assertTrue(self.world.start())
        for state, port in ((self.world.state, free_port()),
                            (Path(self.folder.name) / "other", self.world.port)):
            begun = time.monotonic()
            second = subprocess.run(
                [daemon.BINARY, "serve", "--state", str(state), "--listen", f"127.0.0.1:{port}"],
                capture_output=True, text=True, timeout=20)
            self.assertNotEqual(second.returncode, 0)
            self.assertLess(time.monotonic() - begun, 15)
            self.assertNotEqual(second.stderr.strip(), "")
        self.assertEqual(self.world.ask("GET", "/healthz")[0], 200)

    def test_two_daemons_on_one_machine(self):
        laser = Laser(Path(self.folder.name), 4)
        self.addCleanup(laser.stop)
        machine = {"name": "laser", "uri": laser.uri}
        self.assertTrue(self.world.start())
        self.world.ask("PUT", "/devices/laser", machine)
        self.world.wait("/devices/laser", lambda device: device["status"]["state"] == "idle")
        other = World(Path(self.folder.name) / "other")
        other.state.parent.mkdir()
        self.addCleanup(other.end)
        self.assertTrue(other.start())
        other.ask("PUT", "/devices/laser", machine)
        refused = other.wait("/devices/laser", lambda device: device["status"]["message"] != "")
        self.assertEqual(refused["status"]["state"], "disconnected")
        self.assertIn("close that one first", refused["status"]["message"])
        mine = self.world.ask("GET", "/devices/laser")[1]["status"]
        self.assertEqual(mine["state"], "idle")
        # It is free when the first one is gone, and then one daemon has it again.
        self.world.daemon.stop()
        self.world.daemon = None
        other.ask("POST", "/devices/laser/commands", {"command": "reset"})
        other.wait("/devices/laser", lambda device: device["status"]["state"] == "idle")

    def test_an_upload_that_breaks_off_leaves_nothing(self):
        self.assertTrue(self.world.start())
        body = bytes(300000)
        sha = hashlib.sha256(body).hexdigest()
        for sent in (0, 1, 65536, 131072, 299999):
            with socket.create_connection(("127.0.0.1", self.world.port)) as link:
                link.sendall(f"PUT /api/v1/blobs/{sha} HTTP/1.1\r\nHost: 127.0.0.1\r\n"
                             f"Content-Length: {len(body)}\r\n\r\n".encode() + body[:sent])
        incoming = self.world.state / "blobs/incoming"
        deadline = time.monotonic() + 20
        while list(incoming.iterdir()) and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertEqual(list(incoming.iterdir()), [])
        self.assertEqual(self.world.ask("PUT", f"/blobs/{sha}", body)[0], 201)
        self.assertEqual(self.world.ask("GET", "/jobs")[1]["jobs"], [])

    def test_a_job_that_breaks_its_process_ends_as_a_dead_letter(self):
        self.assertTrue(self.world.start("compute.child:1"))  # In every child.
        job = self.submit("poison")
        dead = self.ended(job)
        self.assertEqual((dead["state"], dead["error"]["code"], dead["attempt"]), ("failed", "poison-job", 3))
        listed = self.world.ask("GET", "/jobs?dead_letters=true")[1]["jobs"]
        self.assertEqual([each["id"] for each in listed], [job["id"]])
        self.assertEqual(self.world.ask("GET", "/queue")[1]["dead_letters"], 1)
        self.world.daemon.kill()
        self.assertTrue(self.world.start())  # Whatever it was is mended.
        status, _ = self.world.ask("POST", f"/jobs/{job['id']}/retry", {"cause": "mended"})
        self.assertEqual(status, 202)
        self.assertEqual(self.ended(job)["state"], "ready")

    def test_a_hundred_senders_of_one_key_make_one_job(self):
        self.assertTrue(self.world.start())
        self.world.ask("PUT", f"/blobs/{SHA}", PLATE)
        self.world.ask("POST", "/queue/pause", {})
        wish = {"blob": SHA, "file_name": "plate.off", "name": "once", "params": PARAMS}
        with concurrent.futures.ThreadPoolExecutor(100) as senders:
            answers = list(senders.map(
                lambda _: self.world.ask("POST", "/jobs", wish, {"Idempotency-Key": "the one"}), range(100)))
        self.assertEqual({status for status, _ in answers}, {201})
        self.assertEqual(len({job["id"] for _, job in answers}), 1)
        self.assertEqual(len(self.world.ask("GET", "/jobs")[1]["jobs"]), 1)

    def test_hostile_meshes_fail_their_own_jobs(self):
        config = Path(self.folder.name) / "small.toml"
        config.write_text("job_memory_mb = 300\ncompute_workers = 2\nthreads_per_job = 1\n")
        self.world.daemon = Daemon(self.world.state, self.world.port, "--config", str(config))
        many = b"OFF\n4000000000 4000000000 0\n0 0 0\n3 0 1 2\n"
        ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n"
        stl = bytes(80) + (2**32 - 1).to_bytes(4, "little") + bytes(50)
        side = 700  # A mesh that is as large as it says: half a million vertices.
        points = b"".join(b"%d %d 0\n" % (i % side, i // side) for i in range(side * side))
        corners = (row * side + column for row in range(side - 1) for column in range(side - 1))
        faces = b"".join(b"3 %d %d %d\n3 %d %d %d\n" % (a, a + 1, a + side + 1, a, a + side + 1, a + side) for a in corners)
        large = b"OFF\n%d %d 0\n" % (side * side, 2 * (side - 1) ** 2) + points + faces
        ends = {}
        for name, mesh in (("many.off", many), ("ply.ply", ply), ("stl.stl", stl), ("include.obj", b"mtllib /etc/passwd\n"),
                           ("noise.off", random.Random(3).randbytes(5000)), ("nul.obj", b"v 0 0 \0\n" * 1000),
                           ("deep.obj", b"f " + b"1 " * 500000 + b"\n"), ("large.off", large)):
            sha = hashlib.sha256(mesh).hexdigest()
            self.world.ask("PUT", f"/blobs/{sha}", mesh)
            ends[name] = self.world.ask("POST", "/jobs", {"blob": sha, "file_name": name, "name": name})[1]
        good = self.submit("good")
        self.assertEqual(self.ended(good)["state"], "ready")
        for name, job in ends.items():
            failed = self.ended(job)
            wanted = ("budget", "memory-budget") if name == "large.off" else ("bad-file", failed["error"]["code"])
            self.assertEqual((failed["error"]["kind"], failed["error"]["code"], failed["attempt"]), (*wanted, 1), name)
        self.assertLess(self.world.daemon.rss_mb(), 100)

    def test_a_job_beyond_its_memory_fails_alone(self):
        config = Path(self.folder.name) / "small.toml"
        config.write_text("job_memory_mb = 70\ncompute_workers = 1\nthreads_per_job = 1\n")
        self.world.daemon = Daemon(self.world.state, self.world.port, "--config", str(config))
        failed = self.ended(self.submit("large"))
        self.assertEqual((failed["error"]["kind"], failed["error"]["code"]), ("budget", "memory-budget"))
        self.assertEqual(self.world.ask("GET", "/healthz")[0], 200)

    def test_clocks_that_jump_disturb_nothing(self):
        library = next(Path("/usr/lib").glob("*/faketime/libfaketimeMT.so.1"), None)
        if library is None:
            self.skipTest("needs libfaketime")
        clock = Path(self.folder.name) / "clock"
        clock.write_text("+0")
        os.environ.update(LD_PRELOAD=str(library), FAKETIME_TIMESTAMP_FILE=str(clock),
                          FAKETIME_NO_CACHE="1", FAKETIME_DONT_FAKE_MONOTONIC="1")
        try:
            self.assertTrue(self.world.start())
        finally:
            for name in ("LD_PRELOAD", "FAKETIME_TIMESTAMP_FILE", "FAKETIME_NO_CACHE",
                         "FAKETIME_DONT_FAKE_MONOTONIC"):
                del os.environ[name]
        for jump in ("+365d", "-365d", "+1h"):
            clock.write_text(jump)
            self.assertEqual(self.ended(self.submit("at " + jump))["state"], "ready")
        names = [job["name"] for job in self.world.ask("GET", "/jobs")[1]["jobs"]]
        self.assertEqual(names, ["at +1h", "at -365d", "at +365d"])  # Order is that of events.


    def test_nobody_reads_the_log_and_nothing_waits(self):
        reading, writing = os.pipe()
        fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 8192)
        process = subprocess.Popen([daemon.BINARY, "serve", "--state", str(self.world.state), "--listen",
                                    f"127.0.0.1:{self.world.port}"], stdout=subprocess.PIPE, stderr=writing, text=True)
        os.close(writing)
        process.stdout.readline()
        self.world.daemon = Daemon.__new__(Daemon)
        self.world.daemon.port, self.world.daemon.process = self.world.port, process
        for number in range(30):
            self.ended(self.submit(f"loud {number}"))
        self.assertEqual(self.world.ask("POST", "/devices/sim/commands", {"command": "stop"})[0], 202)
        os.set_blocking(reading, False)
        lines = os.read(reading, 1 << 20).splitlines()
        self.assertGreater(len(lines), 5)
        self.world.daemon.stop()
        rest = os.read(reading, 1 << 20).splitlines()
        os.close(reading)
        self.assertTrue(any(b"lines lost: nobody read them" in line for line in rest), rest)

    def test_more_connections_than_files_leave_the_daemon_alive(self):
        def few_files():
            resource.setrlimit(resource.RLIMIT_NOFILE, (96, 96))

        process = subprocess.Popen([daemon.BINARY, "serve", "--state", str(self.world.state), "--listen",
                                    f"127.0.0.1:{self.world.port}"], stdout=subprocess.PIPE,
                                   stderr=subprocess.DEVNULL, text=True, preexec_fn=few_files)
        process.stdout.readline()
        self.world.daemon = Daemon.__new__(Daemon)
        self.world.daemon.port, self.world.daemon.process = self.world.port, process
        self.submit("before")
        crowd = []
        for _ in range(300):
            link = socket.create_connection(("127.0.0.1", self.world.port))
            link.sendall(b"GET / HTTP/1.1\r\nHost: local")
            crowd.append(link)
        # What works for machines and jobs has kept its files.
        self.assertEqual(self.world.ask("POST", "/devices/sim/commands", {"command": "stop"})[0], 202)
        self.assertEqual(self.ended(self.submit("meanwhile"))["state"], "ready")
        for link in crowd:
            link.close()
        self.assertEqual(self.ended(self.submit("after"))["state"], "ready")
        self.assertEqual(self.world.daemon.stop(), 0)
        self.world.daemon = None

    def test_a_machine_that_is_pulled_out_interrupts_its_cut_and_nothing_goes_on_by_itself(self):
        laser = Laser(Path(self.folder.name), 4)
        self.assertTrue(self.world.start())
        self.world.ask("PUT", "/devices/laser", {"name": "laser", "uri": laser.uri, "auto_start": True})
        job = self.ended(self.submit("pulled"))
        cut = self.world.ask("POST", f"/jobs/{job['id']}/cuts", {"device": "laser"})[1]
        self.world.wait(f"/cuts/{cut['id']}", lambda cut: cut["progress"]["lines_acknowledged"] > 10)
        laser.stop()
        over = self.world.wait(f"/cuts/{cut['id']}", lambda cut: cut["state"] not in ("cutting", "paused"))
        self.assertEqual((over["state"], over["actions"]), ("interrupted", ["finish"]))
        self.assertGreater(over["beam"]["most_mm"], 0)
        again = Laser(Path(self.folder.name), 4)
        self.addCleanup(again.stop)
        self.world.ask("POST", "/devices/laser/commands", {"command": "reset"})
        self.world.wait("/devices/laser", lambda device: device["status"]["state"] != "disconnected")
        waiting = self.world.ask("GET", "/cuts/" + cut["id"])[1]
        self.assertEqual(waiting["state"], "interrupted")


if __name__ == "__main__":
    unittest.main()
