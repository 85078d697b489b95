"""A fleet under test: PostgreSQL, nodes in network namespaces of their own, and the faults between
them. Where namespaces are not permitted all share the loopback interface, and there are no
partitions."""
import http.client
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BINARIES = Path("/usr/lib/postgresql/15/bin")
FAKETIME = next(Path("/usr/lib").glob("*/faketime/libfaketime.so.1"), None)
KEY = "a key that all nodes of the test know"
PASSWORD = "a long enough password"


def namespaced():
    """Runs this very program again in a network of its own; whether it is in one now."""
    if os.environ.get("LEAFCUTTER_FLEET_NET"):
        return os.environ["LEAFCUTTER_FLEET_NET"] == "own"
    permitted = os.geteuid() == 0 and all(shutil.which(tool) for tool in ("ip", "nft", "unshare", "nsenter"))
    permitted = permitted and subprocess.run(["unshare", "-n", "ip", "link", "set", "lo", "up"],
                                             stderr=subprocess.DEVNULL).returncode == 0
    print("network namespaces" if permitted else
          "no network namespaces here: all nodes on the loopback interface, no partitions", file=sys.stderr)
    os.environ["LEAFCUTTER_FLEET_NET"] = "own" if permitted else "shared"
    enter = ["unshare", "-n"] if permitted else []
    os.execvp((enter + [sys.executable])[0], enter + [sys.executable] + sys.argv)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def call(at, method, path, body=None, headers=None, timeout=20):
    """`at`: address and port. The status, and the answer's JSON or bytes."""
    connection = http.client.HTTPConnection(*at, timeout=timeout)
    text = body if isinstance(body, (bytes, type(None))) else json.dumps(body)
    kind = {} if isinstance(body, (bytes, type(None))) else {"Content-Type": "application/json"}
    try:
        connection.request(method, "/api/v1" + path, text, {**kind, **(headers or {})})
        answer = connection.getresponse()
        content = answer.read()
        return answer.status, json.loads(content) if content[:1] in (b"{", b"[") else content
    finally:
        connection.close()


def log_in(at):
    """Headers with a key that may do everything."""
    connection = http.client.HTTPConnection(*at, timeout=20)
    connection.request("POST", "/api/v1/session", json.dumps({"user": "anna", "password": PASSWORD}),
                       {"Content-Type": "application/json"})
    answer = connection.getresponse()
    session = json.loads(answer.read())
    cookie = answer.headers["Set-Cookie"].split(";")[0]
    connection.close()
    headers = {"Cookie": cookie, "X-CSRF-Token": session["csrf_token"]}
    status, key = call(at, "POST", "/keys", {"label": "test", "role": "admin", "may_fire": True}, headers)
    assert status == 201, key
    return {"Authorization": "Bearer " + key["key"]}


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

    def signal(self, number):
        """To the server and all that it has begun."""
        server = (self.data / "postmaster.pid").read_text().split("\n")[0]
        own = Path(f"/proc/{server}/task/{server}/children").read_text().split()
        for process in [server, *own]:
            try:
                os.kill(int(process), number)
            except ProcessLookupError:  # It has ended meanwhile.
                pass

    def ask(self, sql):
        """The first column of the first row."""
        return subprocess.run([BINARIES / "psql", "-XAtqc", sql, self.uri], check=True, capture_output=True,
                              text=True).stdout.strip()

    @property
    def uri(self):
        return f"postgresql://leafcutter@{self.address}:{self.port}/postgres"


class Machine:
    """A simulated laser beside its station: nothing that happens to that process happens to this one."""

    def __init__(self, enter, binary, burns, speed):
        self.process = subprocess.Popen([*enter, binary, "simulate", "grbl", "--tcp", "0", "--burn", burns, "--speed",
                                         str(speed), "--width", "600", "--height", "400"],
                                        stdout=subprocess.PIPE, text=True)
        self.uri = self.process.stdout.readline().strip()

    def end(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()


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
        self.machine = (Machine(self.enter, fleet.binary, self.burns, options.get("speed", 200))
                        if role == "station" else None)
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
uri = "{self.machine.uri}"
auto_start = {str(self.options.get('auto_start', True)).lower()}
bed_mm = [600, 400]
"""
        (self.state / "config.toml").write_text(text + self.options.get("config", ""))

    def start(self):
        # Without the wrapper of that name: a signal is for the node itself.
        skewed = ({"LD_PRELOAD": str(FAKETIME), "FAKETIME": self.skew, "FAKETIME_DONT_FAKE_MONOTONIC": "1"}
                  if self.skew and FAKETIME else {})
        with open(self.fleet.folder / f"{self.name}.log", "a") as log:
            self.process = subprocess.Popen(
                [*self.enter, self.fleet.binary, "serve", "--config", self.state / "config.toml", "--state",
                 self.state / "state", "--listen", f"{self.address}:{self.port}"],
                stdout=subprocess.PIPE, stderr=log, text=True, env={**os.environ, **skewed})
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

    def lose_packets(self, percent):
        """Of those that come in."""
        rules = "flush ruleset"
        if percent > 0:
            rules += (f"\nadd table inet loss\nadd chain inet loss in {{ type filter hook input priority 0; }}\n"
                      f'add rule inet loss in iifname "eth0" numgen random mod 100 < {percent} drop')
        subprocess.run([*self.enter, "nft", "-f", "-"], input=rules + "\n", text=True, check=True)

    def call(self, method, path, body=None, headers=None, timeout=20):
        return call((self.address, self.port), method, path, body, {**self.fleet.auth, **(headers or {})}, timeout)


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
        self.auth = log_in((node.address, node.port))

    def end(self):
        for node in self.nodes.values():
            if node.process.poll() is None:
                node.signal(signal.SIGCONT)
                node.kill()
            if node.machine:
                node.machine.end()
            if self.namespaces:
                node.host.kill()
                node.host.wait()
        try:
            self.postgres.kill()
        except subprocess.CalledProcessError:
            pass  # The test left it dead.
        if self.namespaces:
            run("ip", "link", "del", "hub")
        if os.environ.get("LEAFCUTTER_FLEET_KEEP"):
            shutil.copytree(self.folder, os.environ["LEAFCUTTER_FLEET_KEEP"], dirs_exist_ok=True,
                            ignore=shutil.ignore_patterns("pg", "blobs"))
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

