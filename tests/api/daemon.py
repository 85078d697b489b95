"""A daemon under test, on the loopback interface alone."""
import http.client
import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

from api_schema import problem_of

sys.path.append(str(Path(__file__).parents[1] / "support"))
from loopback import free_port  # noqa: E402, F401

BINARY = sys.argv.pop(1) if len(sys.argv) > 1 else "build/release/leafcutter"
SQUARE = b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"


class Daemon:
    def __init__(self, state, port, *options, address="127.0.0.1"):
        self.port = port
        self.process = subprocess.Popen(
            [BINARY, "serve", "--state", str(state), "--listen", f"{address}:{port}", *options],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        line = self.process.stdout.readline()
        if "http://" not in line:
            raise AssertionError(f"the daemon did not start: {line!r}")

    def exchange(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            connection.request(method, path, body, headers or {})
            answer = connection.getresponse()
            content = answer.read()
            problem = problem_of(method, path, answer.status, answer.headers, content)
            if problem:
                raise AssertionError(problem)
            return answer.status, answer.headers, content
        finally:
            connection.close()

    def call(self, method, path, body=None, headers=None):
        status, _, answer = self.exchange(method, path, body, headers)
        return status, answer

    def events(self):
        return Events(self.port)

    def rss_mb(self):
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", status).group(1)) / 1024

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(timeout=20)
        self.process.stdout.close()
        return status


class Events:
    """The live events from now on: the opening snapshot has been read."""

    def __init__(self, port):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
        self.connection.request("GET", "/api/v1/events")
        self.stream = self.connection.getresponse()
        self.until(lambda kind, data: kind == "snapshot")

    def until(self, condition, seconds=10.0):
        """The data of the first event that fits; none if the time is over before."""
        deadline = time.monotonic() + seconds
        kind = ""
        while time.monotonic() < deadline:
            line = self.stream.readline().decode().rstrip("\n")
            if line.startswith("event: "):
                kind = line[len("event: "):]
            elif line.startswith("data: "):
                data = json.loads(line[len("data: "):])
                if condition(kind, data):
                    return data
        return None

    def ended(self):
        """The daemon closes the stream; a timeout is an error."""
        try:
            while self.stream.readline():
                pass
        except (http.client.HTTPException, ConnectionError):
            return True
        return True

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.connection.close()


def form(key, name, params=None):
    boundary = "b" + key
    fields = f"--{boundary}\r\nContent-Disposition: form-data; name=\"name\"\r\n\r\n{name}\r\n"
    if params is not None:
        fields += (f"--{boundary}\r\nContent-Disposition: form-data; name=\"params\"\r\n\r\n"
                   f"{json.dumps(params)}\r\n")
    fields += f"--{boundary}\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"s.off\"\r\n\r\n"
    body = fields.encode() + SQUARE + f"\r\n--{boundary}--\r\n".encode()
    return body, {"Content-Type": f"multipart/form-data; boundary={boundary}", "Idempotency-Key": key}
