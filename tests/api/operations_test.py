#!/usr/bin/env python3
"""The daemon as a service: configuration, logs, metrics, webhooks, graceful stops. Usage:
operations_test.py LEAFCUTTER"""
import hashlib
import hmac
import http.server
import json
import queue
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

from daemon import BINARY, SQUARE, Daemon, form, free_port

AS_JSON = {"Content-Type": "application/json"}
QUICK = {"nesting": {"time_s": 0.5}}
SECRET = "a secret of the workshop"


class Configured:
    """A daemon with a configuration, its log kept."""

    def __init__(self, folder, text, environment=None):
        config = Path(folder) / "leafcutter.toml"
        config.write_text(text)
        self.log_path = Path(folder) / "log"
        self.log = self.log_path.open("ab")
        port = free_port()
        self.process = subprocess.Popen(
            [BINARY, "serve", "--config", str(config), "--state", str(Path(folder) / "state"),
             "--listen", f"127.0.0.1:{port}"],
            stdout=subprocess.PIPE, stderr=self.log, text=True, env=environment)
        if "http://" not in self.process.stdout.readline():
            raise AssertionError(self.log_path.read_text())
        self.port = port

    exchange = Daemon.exchange
    call = Daemon.call

    def stop(self, signals=1):
        for _ in range(signals):
            self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(timeout=30)
        self.process.stdout.close()
        self.log.close()
        return status

    def get(self, path):
        return json.loads(self.call("GET", path)[1])


def until(look, seconds=20.0):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        found = look()
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError("it never happened")


class Configuration(unittest.TestCase):
    def test_what_is_wrong_is_told_by_line(self):
        cases = [("listen = '127.0.0.1:0'\nlisten_on = 1\n", ":2: listen_on: there is no such key"),
                 ("\n\nhttp_workers = 0\n", ":3: http_workers: must be 1 to 256"),
                 ("stop_policy = 'never'\n", ":1: stop_policy"),
                 ("log_format = 'xml'\n", ":1: log_format"),
                 ("[[device]]\nid = 'a'\nuri = 'sim:grbl'\nspeed = 3\n", ":4: device.speed: there is no such key"),
                 ("[[webhook]]\nurl = 'http://x/'\nsecret = 'short'\n", ":1: webhook.secret"),
                 ("[[webhook]]\nurl = 'file:///etc/passwd'\nsecret = '0123456789abcdef'\n", ":1: webhook.url"),
                 ("listen = \n", ":1: ")]
        for text, wanted in cases:
            with self.subTest(text=text), tempfile.TemporaryDirectory() as folder:
                config = Path(folder) / "c.toml"
                config.write_text(text)
                answer = subprocess.run([BINARY, "serve", "--config", str(config), "--state", folder],
                                        capture_output=True, text=True, timeout=20)
                self.assertEqual(answer.returncode, 2, answer.stderr)
                self.assertIn(wanted, answer.stderr)


class Told(unittest.TestCase):
    def test_every_json_log_line_is_an_object_whatever_clients_send(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, "log_format = 'json'\n")
            daemon.call("DELETE", "/api/v1/jobs/%22%7D%5C%ff%0A")
            daemon.stop()
            lines = daemon.log_path.read_bytes().splitlines()
            self.assertGreater(len(lines), 2)
            for line in lines:
                self.assertEqual(set(json.loads(line)), {"time", "level", "message"})

    def test_metrics_are_well_formed_and_count(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, "")
            try:
                for _ in range(3):
                    daemon.call("GET", "/api/v1/jobs/none")
                daemon.call("POST", "/api/v1/jobs", *form("counted", "counted", QUICK))
                lines = daemon.call("GET", "/metrics")[1].decode().splitlines()
            finally:
                daemon.stop()
        values = {}
        for line in lines:
            if not line.startswith("#"):
                self.assertRegex(line, r'^[a-z_]+(\{([a-z]+="[^"]*",?)+\})? [0-9.e+-]+$')
                name, value = line.rsplit(" ", 1)
                self.assertNotIn(name, values)
                values[name] = float(value)
        self.assertEqual(values['leafcutter_http_requests_total{method="GET",class="4xx"}'], 3)
        self.assertEqual(values['leafcutter_http_request_seconds_bucket{method="POST",le="+Inf"}'], 1)
        self.assertGreater(values["leafcutter_commit_seconds_count"], 0)
        self.assertEqual(sum(v for k, v in values.items() if k.startswith("leafcutter_jobs{")), 1)
        self.assertIn('leafcutter_queue_age_seconds{queue="jobs"}', values)
        self.assertGreater(values["process_resident_memory_bytes"], 1e6)

    def test_the_service_manager_hears_when_it_is_ready_and_when_it_stops(self):
        with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            manager.bind(f"{folder}/notify")
            manager.settimeout(20)
            daemon = Configured(folder, "", {"NOTIFY_SOCKET": f"{folder}/notify", "PATH": "/usr/bin:/bin"})
            self.assertEqual(manager.recv(100), b"READY=1")
            daemon.stop()
            self.assertEqual(manager.recv(100), b"STOPPING=1")


class Listener:
    """A program that webhooks call; answers what it is told to, 200 otherwise."""

    def __init__(self):
        self.calls = queue.Queue()
        self.answers = []
        outer = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                status = outer.answers.pop(0) if outer.answers else 200
                self.send_response(status)
                if status == 302:
                    self.send_header("Location", "/elsewhere")
                self.send_header("Content-Length", "0")
                self.end_headers()
                outer.calls.put((status, self.path, self.headers, body))

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.thread = threading.Thread(target=self.server.serve_forever)
        self.thread.start()

    def url(self):
        return f"http://localhost:{self.server.server_port}/hook"

    def stop(self):
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()


class Webhooks(unittest.TestCase):
    def setUp(self):
        self.listener = Listener()
        self.addCleanup(self.listener.stop)

    def config(self, private="true"):
        return f"[[webhook]]\nurl = '{self.listener.url()}'\nsecret = '{SECRET}'\nallow_private = {private}\n"

    def taken(self):
        status, path, headers, body = self.listener.calls.get(timeout=20)
        self.assertEqual(path, "/hook")
        signed = headers["X-Leafcutter-Timestamp"].encode() + b"." + body
        code = hmac.new(SECRET.encode(), signed, hashlib.sha256).hexdigest()
        self.assertEqual(headers["X-Leafcutter-Signature"], "sha256=" + code)
        return status, json.loads(body)

    def test_every_change_is_told_in_order_signed_and_again_after_a_failure(self):
        self.listener.answers = [500, 302]
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, self.config())
            try:
                job = json.loads(daemon.call("POST", "/api/v1/jobs", *form("hooked", "hooked", QUICK))[1])["id"]
                told = [self.taken() for _ in range(5)]
            finally:
                daemon.stop()
        self.assertEqual([status for status, _ in told[:3]], [500, 302, 200])
        self.assertEqual([told[0][1]["seq"]] * 3, [body["seq"] for _, body in told[:3]])
        bodies = [body for status, body in told if status == 200]
        self.assertEqual({body["job"] for body in bodies}, {job})
        self.assertEqual([body["seq"] for body in bodies], sorted({body["seq"] for body in bodies}))
        self.assertTrue(bodies[-1]["change"].endswith("ready"), bodies)

    def test_what_happened_while_it_was_stopped_is_told_later_and_nothing_twice(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, self.config())
            daemon.call("POST", "/api/v1/jobs", *form("one", "one", QUICK))
            first = [self.taken()[1]["seq"] for _ in range(3)]
            daemon.stop()
            daemon = Configured(folder, "")
            job = json.loads(daemon.call("POST", "/api/v1/jobs", *form("two", "two", QUICK))[1])["id"]
            until(lambda: daemon.get(f"/api/v1/jobs/{job}")["state"] == "ready")
            daemon.stop()
            daemon = Configured(folder, self.config())
            try:
                second = [self.taken()[1]["seq"] for _ in range(3)]
            finally:
                daemon.stop()
            self.assertEqual(second, [first[-1] + 1 + i for i in range(3)])

    def test_private_addresses_are_not_called_unless_allowed(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, self.config("false"))
            try:
                daemon.call("POST", "/api/v1/jobs", *form("private", "private", QUICK))
                until(lambda: b'leafcutter_webhook_failures{webhook="1"} 0' not in daemon.call("GET", "/metrics")[1])
            finally:
                daemon.stop()
            self.assertTrue(self.listener.calls.empty())
            self.assertIn("private network", daemon.log_path.read_text())


class OctoPrint(unittest.TestCase):
    """What PrusaSlicer, Cura and their like send."""

    def upload(self, daemon, name, more=b""):
        body = (b'--b\r\nContent-Disposition: form-data; name="path"\r\n\r\n\r\n' + more
                + f'--b\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n'.encode()
                + b"Content-Type: application/octet-stream\r\n\r\n" + SQUARE + b"\r\n--b--\r\n")
        status, headers, answer = daemon.exchange("POST", "/api/files/local", body,
                                                  {"Content-Type": "multipart/form-data; boundary=b"})
        return status, headers, json.loads(answer)

    def test_a_mesh_becomes_a_job_and_nothing_starts(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, "")
            try:
                self.assertTrue(daemon.get("/api/version")["text"].startswith("OctoPrint"))
                wants_print = b'--b\r\nContent-Disposition: form-data; name="print"\r\n\r\ntrue\r\n'
                status, headers, answer = self.upload(daemon, "square.off", wants_print)
                self.assertEqual((status, answer["done"], answer["effectivePrint"]), (201, True, False))
                path = headers["Location"].split(str(daemon.port), 1)[1]
                self.assertEqual(daemon.get(path)["name"], "square.off")
                self.assertEqual(daemon.get("/api/v1/cuts")["cuts"], [])
                status, _, answer = self.upload(daemon, "square.gcode")
                self.assertEqual((status, answer["code"]), (415, "not-a-mesh"))
            finally:
                daemon.stop()


class Stops(unittest.TestCase):
    def cutting(self, daemon):
        job = json.loads(daemon.call("POST", "/api/v1/jobs", *form("cut", "cut", QUICK))[1])["id"]
        until(lambda: daemon.get(f"/api/v1/jobs/{job}")["state"] == "ready")
        answer = daemon.call("POST", f"/api/v1/jobs/{job}/cuts", '{"device": "sim"}', AS_JSON)[1]
        path = "/api/v1/cuts/" + json.loads(answer)["id"]
        cut = until(lambda: (c := daemon.get(path)) and "start" in c["actions"] and c)
        consent = json.dumps({"program_sha256": cut["program_sha256"], "bed_clear": True})
        self.assertEqual(daemon.call("POST", path + "/start", consent, AS_JSON)[0], 202)
        until(lambda: daemon.get(path)["progress"]["lines_acknowledged"] > 3)
        return path

    def ends_as(self, policy):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, f"stop_policy = '{policy}'\n")
            path = self.cutting(daemon)
            if policy == "finish":
                daemon.process.send_signal(signal.SIGTERM)
                until(lambda: daemon.get(path)["state"] == "cutting")
                self.assertEqual(daemon.call("POST", path + "/pause")[0], 202)
                until(lambda: daemon.get(path)["state"] == "paused")
                self.assertEqual(daemon.call("POST", path + "/abort")[0], 202)
                self.assertEqual(daemon.process.wait(timeout=30), 0)
                daemon.process.stdout.close()
                daemon.log.close()
            else:
                self.assertEqual(daemon.stop(), 0)
            daemon = Configured(folder, "")
            try:
                return daemon.get(path)
            finally:
                daemon.stop()

    def test_a_second_signal_ends_it_at_once(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Configured(folder, "stop_policy = 'finish'\n")
            path = self.cutting(daemon)
            daemon.process.send_signal(signal.SIGTERM)
            until(lambda: "stopping" in daemon.log_path.read_text())
            self.assertEqual(daemon.get(path)["state"], "cutting")
            self.assertEqual(daemon.stop(), -signal.SIGTERM)

    def test_pause_leaves_a_cut_that_can_be_finished(self):
        cut = self.ends_as("pause")
        self.assertEqual((cut["state"], cut["actions"]), ("interrupted", ["finish"]))

    def test_abort_ends_the_cut(self):
        self.assertEqual(self.ends_as("abort")["state"], "aborted")

    def test_finish_goes_on_until_the_sheet_ends_and_can_still_be_stopped(self):
        self.assertEqual(self.ends_as("finish")["state"], "aborted")


if __name__ == "__main__":
    unittest.main()
