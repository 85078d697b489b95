#!/usr/bin/env python3
"""How long a daemon with a full store takes from its process's start to its first 200 of /readyz, killed in the midst of
work, its database's pages gone from memory. Usage: start_test.py LEAFCUTTER
LEAFCUTTER_STORED_JOBS=100000: as many jobs; 2000 if not given. Prints each start."""
import hashlib
import http.client
import json
import os
import sqlite3
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

import daemon
from cuts_test import PARAMS, PLATE
from daemon import Daemon, free_port

JOBS = int(os.environ.get("LEAFCUTTER_STORED_JOBS", "2000"))
QUEUED = JOBS // 10
STARTS = 5
SHA = hashlib.sha256(PLATE).hexdigest()


def fill(database):
    """Jobs as a workshop has them after years: most are done, with a package each, a tenth waits."""
    store = sqlite3.connect(database)
    store.execute("PRAGMA synchronous = OFF")
    rows = range(JOBS)
    store.executemany(
        "INSERT INTO job(id, name, state, created_ms, updated_ms, file_name, file_bytes, file_sha256, params, summary, place) "
        "VALUES(?, ?, ?, ?, ?, 'plate.off', ?, ?, '{}', '{}', ?)",
        ((f"j_{i:012}", f"job {i}", "queued" if i >= JOBS - QUEUED else "done", i, i, len(PLATE), SHA, i << 20) for i in rows))
    done = range(JOBS - QUEUED)
    store.executemany("INSERT INTO artifact(job, position, path, bytes, sha256, media_type) VALUES(?, ?, ?, ?, ?, 'text/plain')",
                      ((f"j_{i:012}", k, f"part-{k}.svg", 1000, hashlib.sha256(b"%d" % k).hexdigest())
                       for i in done for k in range(10)))
    store.executemany("INSERT INTO sheet(job, number, material, program_sha256, estimated_s, cut) VALUES(?, 1, 'paper', ?, 60, 1)",
                      ((f"j_{i:012}", SHA) for i in done))
    store.executemany("INSERT INTO event(at_ms, type, subject, job, note) VALUES(?, 'job', ?, ?, 'computing -> ready')",
                      ((i, f"j_{i:012}", f"j_{i:012}") for i in rows))
    store.execute("INSERT INTO setting(key, value) VALUES('queue.paused', 'inventory')")
    store.commit()
    store.close()


def forget_pages(state):
    """The kernel keeps nothing of it: the disk is read again."""
    for file in state.glob("leafcutter.db*"):
        handle = os.open(file, os.O_RDONLY)
        os.fsync(handle)
        os.posix_fadvise(handle, 0, 0, os.POSIX_FADV_DONTNEED)
        os.close(handle)


class Start(unittest.TestCase):
    def start(self, state, port):
        """The seconds to the first 200 of /readyz."""
        begun = time.monotonic()
        process = subprocess.Popen([daemon.BINARY, "serve", "--state", str(state), "--listen", f"127.0.0.1:{port}"],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.daemon = Daemon.__new__(Daemon)
        self.daemon.port, self.daemon.process = port, process
        while True:
            self.assertIsNone(process.poll(), "it ended")
            link = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
            try:
                link.request("GET", "/readyz")
                if link.getresponse().status == 200:
                    return time.monotonic() - begun
            except ConnectionError:
                pass
            finally:
                link.close()
            self.assertLess(time.monotonic() - begun, 60)

    def load(self):
        """Several who submit without an end; what was acknowledged."""
        kept = []

        def submit(worker):
            for number in range(100000):
                body = {"blob": SHA, "file_name": "plate.off", "name": f"{worker}/{number}", "params": PARAMS}
                try:
                    status, answer = self.daemon.call("POST", "/api/v1/jobs", json.dumps(body),
                                                      {"Content-Type": "application/json"})
                except (OSError, http.client.HTTPException):
                    return
                if status == 201:
                    kept.append(json.loads(answer)["id"])

        workers = [threading.Thread(target=submit, args=(worker,)) for worker in range(8)]
        for worker in workers:
            worker.start()
        return kept, workers

    def test_a_killed_daemon_with_a_full_store_serves_soon(self):
        with tempfile.TemporaryDirectory() as folder:
            state, port = Path(folder) / "state", free_port()
            self.start(state, port)
            self.assertEqual(self.daemon.call("PUT", f"/api/v1/blobs/{SHA}", PLATE)[0], 201)
            self.assertEqual(self.daemon.stop(), 0)
            fill(state / "leafcutter.db")
            took, acknowledged = [], []
            for _ in range(STARTS):
                forget_pages(state)
                took.append(self.start(state, port))
                for job in acknowledged:
                    self.assertEqual(self.daemon.call("GET", f"/api/v1/jobs/{job}")[0], 200)
                acknowledged, workers = self.load()
                deadline = time.monotonic() + 60
                while len(acknowledged) < 200:
                    self.assertLess(time.monotonic(), deadline)
                    time.sleep(0.01)
                self.daemon.kill()
                for worker in workers:
                    worker.join()
            size = (state / "leafcutter.db").stat().st_size >> 20
            print(f"{JOBS} jobs, {size} MB: ready after {', '.join(f'{each:.2f}' for each in took)} s")


if __name__ == "__main__":
    unittest.main()
