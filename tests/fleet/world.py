"""A fleet under test: PostgreSQL, nodes in network namespaces of their own, and the faults between
them. Where namespaces are not permitted all share the loopback interface, and there are no
partitions."""
import http.client
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "support"))
from loopback import free_port  # noqa: E402

BINARIES = Path("/usr/lib/postgresql/15/bin")
KEY = "a key that all nodes of the test know"
PASSWORD = "a long enough password"


def namespaced():
    """Runs this very program again in a network of its own; whether it is in one now."""
    if os.environ.get("LEAFCUTTER_FLEET_NET"):
        return os.environ["LEAFCUTTER_FLEET_NET"] == "own"
    permitted = os.geteuid() == 0 and all(shutil.which(tool) for tool in ("ip", "unshare", "nsenter"))
    permitted = permitted and subprocess.run(["unshare", "-n", "ip", "link", "set", "lo", "up"],
                                             stderr=subprocess.DEVNULL).returncode == 0
    print("network namespaces" if permitted else
          "no network namespaces here: all nodes on the loopback interface, no partitions", file=sys.stderr)
    os.environ["LEAFCUTTER_FLEET_NET"] = "own" if permitted else "shared"
    enter = ["unshare", "-n"] if permitted else []
    os.execvp((enter + [sys.executable])[0], enter + [sys.executable] + sys.argv)


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


class Postgres:
    def __init__(self, folder, address, port):
        self.data, self.address, self.port = folder / "pg", address, port
        self.as_user = (["setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"]
                        if os.geteuid() == 0 else [])
        folder.chmod(0o777)
        self.tool("initdb", "-A", "trust", "-U", "leafcutter", "-E", "UTF8", "--locale=C")
        with open(self.data / "pg_hba.conf", "a") as rules:
            rules.write("host all all 0.0.0.0/0 trust\n")
        self.start()

    def tool(self, name, *arguments):
        return subprocess.run([*self.as_user, BINARIES / name, "-D", self.data, *arguments], cwd="/",
                              check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def start(self):
        self.tool("pg_ctl", "-w", "-l", str(self.data) + ".log", "-o",
                  f"-c listen_addresses={self.address} -c port={self.port} -c max_connections=200 "
                  f"-k {self.data}", "start")

    def kill(self):
        """As kill -9 would end it."""
        self.tool("pg_ctl", "-m", "immediate", "stop")

    @property
    def uri(self):
        return f"postgresql://leafcutter@{self.address}:{self.port}/postgres"


class Node:
    """One process of one role, on a host of its own."""

    def __init__(self, fleet, name, role, number, **options):
        self.fleet, self.name, self.role = fleet, name, role
        self.state = fleet.folder / name
        self.options, self.skew = options, options.get("skew")
        self.process = None
        self.enter = []
        self.address, self.port = "127.0.0.1", free_port()
        self.link = f"v{number}"
        if fleet.namespaces:
            self.address, self.port = f"10.77.0.{number}", 8080
            self.host = subprocess.Popen(["unshare", "-n", "sleep", "infinity"])
            self.enter = ["nsenter", "-t", str(self.host.pid), "-n"]
            self.wire()
        self.state.mkdir()
        self.write_config()
        self.start()

    def wire(self):
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.host.pid}/ns/net") == own:
            time.sleep(0.01)
        run("ip", "link", "add", self.link, "type", "veth", "peer", "name", "eth0", "netns", str(self.host.pid))
        run("ip", "link", "set", self.link, "master", "hub", "up")
        run(*self.enter, "ip", "addr", "add", f"{self.address}/24", "dev", "eth0")
        run(*self.enter, "ip", "link", "set", "eth0", "up")
        run(*self.enter, "ip", "link", "set", "lo", "up")

    @property
    def burns(self):
        return self.fleet.folder / f"{self.name}.jsonl"

    def write_config(self):
        text = f"""
store = "{self.fleet.postgres.uri}"
role = "{self.role}"
node = "{self.name}"
fleet_key = "{KEY}"
lease_s = {self.fleet.lease_s}
threads_per_job = 1
"""
        if self.role == "station":
            self.device = f"laser-{self.name}"
            text += f"""
[[device]]
id = "{self.device}"
uri = "sim:grbl?speed={self.options.get('speed', 200)}&burn={self.burns}"
auto_start = {str(self.options.get('auto_start', True)).lower()}
bed_mm = [600, 400]
"""
        (self.state / "config.toml").write_text(text)

    def start(self):
        skewed = ["faketime", "-f", self.skew] if self.skew and shutil.which("faketime") else []
        environment = {**os.environ, "FAKETIME_DONT_FAKE_MONOTONIC": "1"}
        self.log = open(self.fleet.folder / f"{self.name}.log", "a")
        self.process = subprocess.Popen(
            [*self.enter, *skewed, self.fleet.binary, "serve", "--config", self.state / "config.toml", "--state",
             self.state / "state", "--listen", f"{self.address}:{self.port}"],
            stdout=subprocess.PIPE, stderr=self.log, text=True, env=environment)
        line = self.process.stdout.readline()
        assert "http://" in line, f"{self.name} did not start: {line!r}\n" + self.words()

    def words(self):
        return Path(self.fleet.folder / f"{self.name}.log").read_text()[-2000:]

    def signal(self, number):
        self.process.send_signal(number)

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def partition(self):
        run("ip", "link", "set", self.link, "down")

    def heal(self):
        run("ip", "link", "set", self.link, "up")

    def call(self, method, path, body=None, headers=None, timeout=20):
        connection = http.client.HTTPConnection(self.address, self.port, timeout=timeout)
        text = body if isinstance(body, (bytes, type(None))) else json.dumps(body)
        kind = {} if isinstance(body, (bytes, type(None))) else {"Content-Type": "application/json"}
        try:
            connection.request(method, "/api/v1" + path, text, {**kind, **self.fleet.auth, **(headers or {})})
            answer = connection.getresponse()
            content = answer.read()
            return answer.status, json.loads(content) if content[:1] in (b"{", b"[") else content
        finally:
            connection.close()


class Fleet:
    def __init__(self, binary, lease_s=3):
        self.namespaces = namespaced()
        self.binary, self.lease_s, self.auth, self.nodes = binary, lease_s, {}, {}
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = Path(self.temporary.name)
        address = "127.0.0.1"
        if self.namespaces:
            address = "10.77.0.1"
            run("ip", "link", "set", "lo", "up")
            run("ip", "link", "add", "hub", "type", "bridge")
            run("ip", "addr", "add", f"{address}/24", "dev", "hub")
            run("ip", "link", "set", "hub", "up")
        self.postgres = Postgres(self.folder, address, free_port())
        subprocess.run([binary, "user", "add", "anna", "--role", "admin", "--store", self.postgres.uri,
                        "--state", self.folder / "keys"], input=PASSWORD + "\n", text=True, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def add(self, name, role, **options):
        self.nodes[name] = Node(self, name, role, 10 + len(self.nodes), **options)
        return self.nodes[name]

    def log_in(self, node):
        connection = http.client.HTTPConnection(node.address, node.port, timeout=20)
        connection.request("POST", "/api/v1/session", json.dumps({"user": "anna", "password": PASSWORD}),
                           {"Content-Type": "application/json"})
        answer = connection.getresponse()
        session = json.loads(answer.read())
        cookie = answer.headers["Set-Cookie"].split(";")[0]
        connection.close()
        self.auth = {"Cookie": cookie, "X-CSRF-Token": session["csrf_token"]}
        status, key = node.call("POST", "/keys", {"label": "test", "role": "admin", "may_fire": True})
        assert status == 201, key
        self.auth = {"Authorization": "Bearer " + key["key"]}

    def end(self):
        for node in self.nodes.values():
            if node.process.poll() is None:
                node.signal(signal.SIGCONT)
                node.kill()
            node.log.close()
            if self.namespaces:
                node.host.kill()
                node.host.wait()
        try:
            self.postgres.kill()
        except subprocess.CalledProcessError:
            pass  # The test left it dead.
        if self.namespaces:
            run("ip", "link", "del", "hub")
        self.temporary.cleanup()


def wait(what, condition, seconds=40.0):
    deadline = time.monotonic() + seconds
    seen = None
    while time.monotonic() < deadline:
        try:
            seen = what()
            if condition(seen):
                return seen
        except (OSError, http.client.HTTPException):
            pass
        time.sleep(0.05)
    raise AssertionError(f"waited in vain; it is {json.dumps(seen)[:1500] if not isinstance(seen, bytes) else seen}")


def burnt_segments(log):
    """How often each cut segment was burnt, in order of the log."""
    pieces = []
    for line in log.read_text().splitlines() if log.exists() else []:
        piece = json.loads(line) if line.endswith("}") else {"s": 0}
        if piece.get("s", 0) > 0:
            pieces.append(tuple(round(piece[side], 3) for side in ("x0", "y0", "x1", "y1")))
    return pieces
