#!/usr/bin/env python3
"""The daemon on a disk whose Nth write or sync fails: what it acknowledged before is there after a start on a sound
disk, and what it could not write it did not acknowledge. Usage: disk_test.py LEAFCUTTER LIBRARY
LEAFCUTTER_FAULTS=60 tries every N up to 60."""
import collections
import hashlib
import os
import signal
import sys
import tempfile
import unittest

LIBRARY = sys.argv.pop(2) if len(sys.argv) > 2 else "build/release/tests/api/libdisk_faults.so"

from crash_test import Died, World  # noqa: E402
from cuts_test import PARAMS, PLATE  # noqa: E402

MOST = int(os.environ.get("LEAFCUTTER_FAULTS", "0"))
SHORT = (2, 9, 17)
SHA = hashlib.sha256(PLATE).hexdigest()


class Disk(unittest.TestCase):
    def start(self, world, fault, path):
        os.environ.update(LD_PRELOAD=LIBRARY, LEAFCUTTER_FAULT=fault, LEAFCUTTER_FAULT_PATH=path)
        try:
            return world.start()
        finally:
            for name in ("LD_PRELOAD", "LEAFCUTTER_FAULT", "LEAFCUTTER_FAULT_PATH"):
                del os.environ[name]

    def work(self, world):
        """What is acknowledged of some uploads, jobs and changes; and how others were refused."""
        refusals = collections.Counter()
        world.ask("PUT", f"/blobs/{SHA}", PLATE)
        for number in range(6):
            name = f"job-{number}"
            status, job = world.ask("POST", "/jobs", {"blob": SHA, "file_name": "plate.off", "name": name, "params": PARAMS})
            if status == 201:
                world.acknowledged[name] = job["id"]
                if number % 2 == 0:
                    ended = world.wait(f"/jobs/{job['id']}", lambda job: job["state"] not in ("queued", "computing")
                                       or not world.ask("GET", "/readyz")[1]["database"])
                    refusals["job failed"] += ended["state"] == "failed"
            else:
                self.assertIn(status, (422, 503, 507), job)
                refusals[job["code"]] += 1
            world.ask("POST", "/queue/resume", {})
        self.assertEqual(world.ask("GET", "/jobs")[0], 200)  # Reading goes on.
        return refusals

    def survives(self, fault, path):
        """Whether the fault was felt."""
        with tempfile.TemporaryDirectory() as folder:
            world = World(folder)
            refusals = collections.Counter()
            felt = False
            try:
                if self.start(world, fault, path):
                    try:
                        refusals = self.work(world)
                        felt = refusals.total() > 0 or not world.ask("GET", "/readyz")[1]["database"]
                    except Died:
                        self.fail(f"{fault} of {path}: the daemon died")
                    world.daemon.process.send_signal(signal.SIGTERM)
                    world.daemon.process.wait(timeout=20)
                else:
                    felt = True
                world.end()
                self.assertTrue(world.start(), f"{fault} of {path}: it does not start again")
                self.assertTrue(world.ask("GET", "/readyz")[1]["database"])
                world.check()
            finally:
                world.end()
            return felt

    def test_a_disk_that_fails_loses_nothing_that_was_acknowledged(self):
        felt = collections.Counter()
        tried = 0
        for kind, path in (("sync:{}:EIO", "leafcutter.db"), ("write:{}:EIO", "leafcutter.db"),
                           ("write:{}:ENOSPC", "leafcutter.db"), ("write:{}:ENOSPC!", "leafcutter.db"),
                           ("sync:{}:EIO", "blobs"), ("write:{}:ENOSPC", "blobs")):
            for number in range(1, MOST + 1) if MOST else SHORT:
                with self.subTest(kind=kind, path=path, number=number):
                    tried += 1
                    felt[kind, path] += self.survives(kind.format(number), path)
            self.assertGreater(felt[kind, path], 0, f"{kind} of {path} is never felt")
        print(f"{tried} failing disks, {sum(felt.values())} of them felt")


if __name__ == "__main__":
    unittest.main()
