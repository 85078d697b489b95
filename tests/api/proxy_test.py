#!/usr/bin/env python3
"""The proxy of server/operations.md, word for word, in front of a daemon: TLS, sessions, live events, uploads.
Usage: proxy_test.py LEAFCUTTER. Needs nginx and openssl; ends with 77 without them."""
import hashlib
import http.client
import json
import re
import shutil
import ssl
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from auth_test import PASSWORD, user_command
from daemon import Daemon, free_port

GUIDE = Path(__file__).parents[2] / "server/operations.md"
NAME = "cutter.example"
AS_JSON = {"Content-Type": "application/json"}


def documented():
    """The two halves of the example: the daemon's configuration and the proxy's."""
    block = GUIDE.read_text().split("## TLS")[1].split("```")[1]
    toml, nginx = block.split("# nginx\n")
    return toml.replace("# leafcutter.toml\n", ""), nginx


class Proxy:
    def __init__(self, folder, port, daemon_port):
        folder = Path(folder)
        self.certificate = folder / "cutter.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={NAME}",
                        "-addext", f"subjectAltName=DNS:{NAME}", "-keyout", str(folder / "cutter.key"),
                        "-out", str(self.certificate)], check=True, capture_output=True)
        server = documented()[1]
        for old, new in (("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"), ("127.0.0.1:8080", f"127.0.0.1:{daemon_port}"),
                         ("/etc/ssl/cutter.pem", str(self.certificate)), ("/etc/ssl/cutter.key", str(folder / "cutter.key"))):
            assert server.count(old) == 1, old
            server = server.replace(old, new)
        config = folder / "nginx.conf"
        # The daemon's state folder is its own: what nginx keeps lies beside it.
        temporary = "".join(f"{kind}_temp_path {folder}/{kind};\n" for kind in
                            ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        config.write_text(f"daemon off; pid {folder}/nginx.pid; error_log {folder}/nginx.log;\n"
                          f"events {{}}\nhttp {{ access_log off;\n{temporary}{server}}}\n")
        self.port = port
        self.process = subprocess.Popen(["nginx", "-p", str(folder), "-c", str(config), "-e", str(folder / "nginx.log")],
                                        stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 10
        while time.monotonic() < deadline:
            try:
                link = self.link()
                link.connect()
                link.close()
                return
            except OSError:
                time.sleep(0.05)
        raise AssertionError((folder / "nginx.log").read_text())

    def link(self):
        trust = ssl.create_default_context(cafile=str(self.certificate))
        trust.check_hostname = False  # It is reached by number; the certificate itself is checked.
        return http.client.HTTPSConnection("127.0.0.1", self.port, context=trust, timeout=20,
                                           source_address=("127.0.0.2", 0))  # A caller is no proxy.

    def ask(self, method, path, body=None, headers=None):
        link = self.link()
        try:
            link.request(method, path, body, {"Host": NAME, **(headers or {})})
            answer = link.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            link.close()

    def stop(self):
        self.process.terminate()
        self.process.wait(timeout=10)


class BehindTheProxy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        state = f"{cls.folder.name}/state"
        user_command(state, "add", "ann")
        cls.key = user_command(state, "key", "ann", "--role", "operator").stdout.strip()
        config = Path(cls.folder.name) / "leafcutter.toml"
        config.write_text(re.sub(r"^listen.*\n", "", documented()[0], flags=re.M))
        cls.daemon = Daemon(state, free_port(), "--config", str(config))
        cls.proxy = Proxy(cls.folder.name, free_port(), cls.daemon.port)

    @classmethod
    def tearDownClass(cls):
        cls.proxy.stop()
        status = cls.daemon.stop()
        cls.folder.cleanup()
        assert status == 0, status

    def test_a_page_logs_in_safely_and_acts(self):
        self.assertEqual(self.proxy.ask("GET", "/api/v1/jobs")[0], 401)
        page = {"Origin": f"https://{NAME}", **AS_JSON}
        status, headers, answer = self.proxy.ask("POST", "/api/v1/session",
                                                 json.dumps({"user": "ann", "password": PASSWORD}), page)
        self.assertEqual(status, 200, answer)
        self.assertIn("Secure", headers["Set-Cookie"])
        mine = {**page, "Cookie": headers["Set-Cookie"].split(";")[0], "X-CSRF-Token": json.loads(answer)["csrf_token"]}
        self.assertEqual(self.proxy.ask("POST", "/api/v1/queue/pause", '{"reason": "tls"}', mine)[0], 200)
        foreign = {**mine, "Origin": "https://evil.example"}
        self.assertEqual(self.proxy.ask("POST", "/api/v1/queue/resume", "{}", foreign)[0], 403)
        self.assertEqual(self.proxy.ask("POST", "/api/v1/queue/resume", "{}", mine)[0], 200)
        self.assertEqual(self.proxy.ask("GET", "/api/v1/session", None, {"Host": "other.example"})[0], 421)

    def test_live_events_come_at_once(self):
        link = self.proxy.link()
        link.request("GET", "/api/v1/events", headers={"Host": NAME, "Authorization": f"Bearer {self.key}"})
        stream = link.getresponse()
        self.assertEqual(stream.status, 200)
        while not stream.readline().startswith(b"event: snapshot"):
            pass
        bearer = {"Authorization": f"Bearer {self.key}", **AS_JSON}
        self.assertEqual(self.proxy.ask("POST", "/api/v1/queue/pause", '{"reason": "live"}', bearer)[0], 200)
        while not (line := stream.readline()).startswith(b"event: queue"):
            self.assertNotEqual(line, b"")
        link.close()

    def test_a_large_upload_passes(self):
        body = bytes(range(256)) * 4096 * 20
        path = "/api/v1/blobs/" + hashlib.sha256(body).hexdigest()
        self.assertEqual(self.proxy.ask("PUT", path, body, {"Authorization": f"Bearer {self.key}"})[0], 201)

    def test_what_a_caller_says_of_itself_is_not_believed(self):
        guess = json.dumps({"user": "ann", "password": "guess number one"})
        self.proxy.ask("POST", "/api/v1/session", guess, {"X-Forwarded-For": "203.0.113.5", **AS_JSON})
        admin = user_session(self)
        entries = json.loads(self.proxy.ask("GET", "/api/v1/audit?limit=200", None, admin)[2])["entries"]
        self.assertEqual({entry["remote"] for entry in entries if entry["status"] == 401}, {"127.0.0.2"})


def user_session(test):
    body = json.dumps({"user": "ann", "password": PASSWORD})
    _, headers, answer = test.proxy.ask("POST", "/api/v1/session", body, AS_JSON)
    return {"Cookie": headers["Set-Cookie"].split(";")[0], "X-CSRF-Token": json.loads(answer)["csrf_token"]}


if __name__ == "__main__":
    if not shutil.which("nginx") or not shutil.which("openssl"):
        print("nginx or openssl is missing")
        sys.exit(77)
    unittest.main()
