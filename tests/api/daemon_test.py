#!/usr/bin/env python3
"""The daemon from outside, on the loopback interface alone: killed again and again, run twice, and
attacked. Usage: daemon_test.py LEAFCUTTER"""
import http.client
import json
import os
import re
import socket
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

from daemon import BINARY, Daemon, form, free_port


class Killed(unittest.TestCase):
    def test_nothing_acknowledged_is_lost(self):
        """Posts from four threads while the daemon dies five times; every answer must hold afterwards,
        and a repeated key must find its job."""
        with tempfile.TemporaryDirectory() as folder:
            acknowledged = {}
            lock = threading.Lock()

            def post(daemon, prefix):
                for number in range(1000):
                    key = f"{prefix}-{number}"
                    try:
                        status, answer = daemon.call("POST", "/api/v1/jobs", *form(key, key))
                    except (OSError, http.client.HTTPException):
                        return
                    if status == 201:
                        with lock:
                            acknowledged[key] = json.loads(answer)["id"]

            for life in range(5):
                daemon = Daemon(folder, free_port())
                posters = [threading.Thread(target=post, args=(daemon, f"l{life}t{i}")) for i in range(4)]
                for poster in posters:
                    poster.start()
                time.sleep(0.3 + 0.17 * life)
                daemon.kill()
                for poster in posters:
                    poster.join()
            self.assertGreater(len(acknowledged), 20)
            daemon = Daemon(folder, free_port())
            try:
                for key, job in acknowledged.items():
                    status, answer = daemon.call("GET", f"/api/v1/jobs/{job}")
                    self.assertEqual(status, 200, key)
                    self.assertEqual(json.loads(answer)["name"], key)
                key, job = next(iter(acknowledged.items()))
                status, answer = daemon.call("POST", "/api/v1/jobs", *form(key, key))
                self.assertEqual((status, json.loads(answer)["id"]), (201, job))
                self.assertEqual(os.listdir(Path(folder) / "blobs" / "incoming"), [])
            finally:
                self.assertEqual(daemon.stop(), 0)


class CutShort(unittest.TestCase):
    def cut_in_mid_beam(self, daemon):
        body, headers = form("cut", "cut")
        job = json.loads(daemon.call("POST", "/api/v1/jobs", body, headers)[1])["id"]
        self.wait(daemon, f"/api/v1/jobs/{job}", lambda job: job["state"] == "ready")
        status, answer = daemon.call("POST", f"/api/v1/jobs/{job}/cuts", '{"device": "sim"}',
                                     {"Content-Type": "application/json"})
        self.assertEqual(status, 201, answer)
        path = "/api/v1/cuts/" + json.loads(answer)["id"]
        cut = self.wait(daemon, path, lambda cut: "start" in cut["actions"])
        consent = {"program_sha256": "0" * 64, "bed_clear": True}
        as_json = {"Content-Type": "application/json"}
        self.assertEqual(daemon.call("POST", path + "/start", json.dumps(consent), as_json)[0], 409)
        consent["program_sha256"] = cut["program_sha256"]
        self.assertEqual(daemon.call("POST", path + "/start", json.dumps(consent), as_json)[0], 202)
        self.wait(daemon, path, lambda cut: cut["progress"]["lines_acknowledged"] > 5)
        return path

    def wait(self, daemon, path, condition):
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline:
            thing = json.loads(daemon.call("GET", path)[1])
            if condition(thing):
                return thing
            time.sleep(0.05)
        self.fail(f"{path} stays {thing}")

    def test_a_cut_in_mid_beam_is_interrupted_by_death_and_by_a_stop(self):
        for end in (Daemon.kill, Daemon.stop):
            with self.subTest(end=end.__name__), tempfile.TemporaryDirectory() as folder:
                daemon = Daemon(folder, free_port())
                path = self.cut_in_mid_beam(daemon)
                end(daemon)
                daemon = Daemon(folder, free_port())
                try:
                    cut = json.loads(daemon.call("GET", path)[1])
                    self.assertEqual((cut["state"], cut["actions"]), ("interrupted", ["finish"]))
                    self.assertIn("cut this sheet again", cut["reason"])
                finally:
                    daemon.stop()


class Stopped(unittest.TestCase):
    def test_a_stop_ends_every_stream_and_puts_running_jobs_back_in_the_queue(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Daemon(folder, free_port())
            body, headers = form("long", "long", {"nesting": {"time_s": 120}})
            path = "/api/v1/jobs/" + json.loads(daemon.call("POST", "/api/v1/jobs", body, headers)[1])["id"]
            with daemon.events() as events:
                self.await_state(daemon, path, "computing")
                begin = time.monotonic()
                self.assertEqual(daemon.stop(), 0)
                self.assertLess(time.monotonic() - begin, 5)
                self.assertTrue(events.ended())
            daemon = Daemon(folder, free_port())
            try:
                self.await_state(daemon, path, "computing")
                self.assertEqual(daemon.call("DELETE", path)[0], 200)
                self.await_state(daemon, path, "cancelled")
            finally:
                self.assertEqual(daemon.stop(), 0)

    def await_state(self, daemon, path, state):
        deadline = time.monotonic() + 10
        while json.loads(daemon.call("GET", path)[1])["state"] != state:
            self.assertLess(time.monotonic(), deadline, state)
            time.sleep(0.02)


class Twice(unittest.TestCase):
    def refused(self, state, port):
        begin = time.monotonic()
        second = subprocess.run([BINARY, "serve", "--state", state, "--listen", f"127.0.0.1:{port}"],
                                capture_output=True, text=True, timeout=20)
        self.assertEqual(second.returncode, 1)
        self.assertLess(time.monotonic() - begin, 5)
        return second.stderr

    def test_a_second_daemon_is_refused_the_state_and_the_port(self):
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as other:
            daemon = Daemon(folder, free_port())
            try:
                self.assertIn("belongs to a daemon", self.refused(folder, free_port()))
                self.assertIn("cannot listen", self.refused(other, daemon.port))
            finally:
                daemon.stop()

    def test_an_address_that_is_not_loopback_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            answer = subprocess.run([BINARY, "serve", "--state", folder, "--listen", "0.0.0.0:0"],
                                    capture_output=True, text=True, timeout=20)
            self.assertEqual(answer.returncode, 2)
            self.assertIn("loopback", answer.stderr)


class Attacked(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.daemon = Daemon(cls.folder.name, free_port())

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        cls.folder.cleanup()
        assert status == 0, status

    def tearDown(self):
        self.assertEqual(self.daemon.call("GET", "/healthz")[0], 200)
        self.assertLess(self.daemon.rss_mb(), 150)

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.daemon.port), timeout=10)

    def status_of(self, head, body=b""):
        with self.connect() as client:
            try:
                client.sendall(head + body)
            except OSError:
                pass
            answer = client.makefile("rb").readline()
            return int(answer.split()[1]) if answer else 0

    def head(self, *lines, target="GET / HTTP/1.1"):
        return "\r\n".join([target, "Host: localhost", *lines, "", ""]).encode()

    def test_hostile_heads_are_refused(self):
        post = "POST /api/v1/jobs HTTP/1.1"
        many = ",".join(f"{i}-{i + 1}" for i in range(400))
        self.assertEqual(self.status_of(self.head("Transfer-Encoding: chunked", target=post)), 411)
        self.assertEqual(self.status_of(self.head("Content-Encoding: gzip", "Content-Length: 9", target=post),
                                        b"123456789"), 415)
        self.assertEqual(self.status_of(self.head("Content-Length: 1", "Content-Length: 2", target=post)), 400)
        self.assertEqual(self.status_of(self.head(f"Range: bytes={many}")), 416)
        self.assertEqual(self.status_of(self.head("REMOTE_ADDR: 1.1.1.1")), 400)
        self.assertEqual(self.status_of(b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"), 421)
        self.assertEqual(self.status_of(self.head("Content-Length: 99999999999", target=post)), 413)

    def test_endless_heads_are_cut(self):
        self.assertEqual(self.status_of(b"GET / HTTP/1.1\r\nX: " + b"a" * 400_000), 431)
        self.assertEqual(self.status_of(b"GET / HTTP/1.1\r\n" + b"X: a\r\n" * 5000), 431)

    def test_deep_json_is_refused(self):
        deep = b'{"a":' * 100 + b"1" + b"}" * 100
        status, answer = self.daemon.call("POST", "/api/v1/jobs", deep, {"Content-Type": "application/json"})
        self.assertEqual((status, json.loads(answer)["code"]), (400, "bad-json"))

    def test_slow_heads_cost_the_others_nothing(self):
        drips = []
        for _ in range(200):
            client = self.connect()
            client.sendall(b"GET / HTTP/1.1\r\nHo")
            drips.append(client)
        self.assertEqual(self.daemon.call("GET", "/healthz")[0], 200)
        for client in drips:
            client.close()

    def test_two_hundred_listeners_hear_of_one_job(self):
        listeners = []
        for _ in range(200):
            client = self.connect()
            client.sendall(self.head(target="GET /api/v1/events HTTP/1.1"))
            listeners.append(client)
        self.assertEqual(self.daemon.call("GET", "/healthz")[0], 200)
        status, answer = self.daemon.call("POST", "/api/v1/jobs", *form("heard", "heard"))
        self.assertEqual(status, 201)
        job = json.loads(answer)["id"].encode()
        for client in listeners:
            heard = b""
            while b"event: job" not in heard or job not in heard:
                piece = client.recv(65536)
                self.assertTrue(piece)
                heard += piece
            client.close()

    def test_events_are_replayed_without_a_gap(self):
        for number in range(5):
            self.daemon.call("POST", "/api/v1/jobs", *form(f"replay{number}", "replay"))
        with self.connect() as client:
            client.sendall(self.head("Last-Event-ID: 0", target="GET /api/v1/events HTTP/1.1"))
            heard = b""
            while len(re.findall(rb"id: (\d+)", heard)) < 10:
                heard += client.recv(65536)
            numbers = [int(n) for n in re.findall(rb"\nid: (\d+)\n", heard)]
            self.assertEqual(numbers, list(range(1, len(numbers) + 1)))

    def test_an_upload_cut_off_leaves_nothing(self):
        body, headers = form("cutoff", "cutoff")
        before = self.daemon.call("GET", "/api/v1/jobs?limit=200")[1].count(b"cutoff")
        with self.connect() as client:
            client.sendall(self.head(f"Content-Type: {headers['Content-Type']}",
                                     f"Content-Length: {len(body) + 1000}",
                                     target="POST /api/v1/jobs HTTP/1.1") + body[:-20])
        # The daemon may take the upload up only now: empty once says nothing, empty for a while does.
        deadline = time.monotonic() + 20
        incoming = Path(self.folder.name) / "blobs" / "incoming"
        empty_looks = 0
        while empty_looks < 20 and time.monotonic() < deadline:
            empty_looks = 0 if os.listdir(incoming) else empty_looks + 1
            time.sleep(0.05)
        self.assertEqual(empty_looks, 20)
        self.assertEqual(self.daemon.call("GET", "/api/v1/jobs?limit=200")[1].count(b"cutoff"), before)


if __name__ == "__main__":
    unittest.main()
