#!/usr/bin/env python3
"""docker/compose.fleet.yaml as it stands, without a container engine: every service's own command and environment,
on a host of its own with the names, folders and ports that the file gives it. Usage: compose_test.py LEAFCUTTER"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import yaml

from beam import PLATE, SHA, params
from world import BINARIES, PASSWORD, Postgres, call, log_in, namespaced, run, wait

FILE = Path(__file__).parents[2] / "docker" / "compose.fleet.yaml"
VARIABLES = {"LEAFCUTTER_FLEET_KEY": "a key that is long enough", "LEAFCUTTER_DB_PASSWORD": "secret"}


def interpolated(text):
    """As compose does it: ${NAME:?} from the environment, $$ for a dollar."""
    return re.sub(r"\$(?:\$|\{(\w+):\?\})", lambda found: VARIABLES[found[1]] if found[1] else "$", text)


class Host:
    """A network, a /tmp, an /etc/hosts and the volumes of one service."""

    def __init__(self, folder, name, service, number):
        self.folder, self.name, self.service = folder / name, name, service
        self.address = f"10.78.0.{number}"
        self.process = None
        self.pause = subprocess.Popen(["unshare", "-n", "-m", "sleep", "infinity"])
        self.enter = ["nsenter", "-t", str(self.pause.pid), "-n", "-m"]
        own = os.readlink("/proc/self/ns/net")
        wait(lambda: os.readlink(f"/proc/{self.pause.pid}/ns/net"), lambda net: net != own)
        link = f"c{number}"
        run("ip", "link", "add", link, "type", "veth", "peer", "name", "eth0", "netns", str(self.pause.pid))
        run("ip", "link", "set", link, "master", "hub", "up")
        for words in (f"addr add {self.address}/24 dev eth0", "link set eth0 up", "link set lo up"):
            run(*self.enter, "ip", *words.split())

    def environment(self):
        values = {name: interpolated(value) for name, value in self.service["environment"].items()}
        return {"PATH": f"/proc/self/fd/{self.programs}:/usr/bin:/bin", "HOME": "/var/lib/leafcutter", **values}

    def run(self, *command, **options):
        return subprocess.run([*self.enter, *command], env=self.environment(), pass_fds=[self.programs], check=True,
                              stdout=subprocess.DEVNULL, **options)

    def start(self, programs, hosts):
        """`programs`: an open folder, since those hosts see another /tmp."""
        self.programs = programs
        for name in ("state", "tmp"):
            (self.folder / name).mkdir(parents=True)
        run(*self.enter, "sh", "-ec", f"mkdir -p /var/lib/leafcutter; mount --bind {hosts} /etc/hosts; "
            f"mount --bind {self.folder}/state /var/lib/leafcutter; mount --bind {self.folder}/tmp /tmp")
        with open(self.folder / "log", "w") as log:
            self.process = subprocess.Popen([*self.enter, *map(interpolated, self.service["entrypoint"])],
                                            env=self.environment(), stdout=log, stderr=log, pass_fds=[programs],
                                            start_new_session=True)

    def end(self):
        if self.process:
            subprocess.run(["pkill", "-KILL", "-s", str(self.process.pid)], check=False)
            self.process.wait()
        self.pause.kill()
        self.pause.wait()


class ComposeTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.file = yaml.safe_load(FILE.read_text())
        self.services = self.file["services"]

    def begin(self):
        run("ip", "link", "set", "lo", "up")
        run("ip", "link", "add", "hub", "type", "bridge")
        run("ip", "addr", "add", "10.78.0.1/24", "dev", "hub")
        run("ip", "link", "set", "hub", "up")
        database = self.services["db"]["environment"]
        self.postgres = Postgres(self.folder, "10.78.0.1", 5432)
        self.addCleanup(self.postgres.kill)
        self.postgres.ask(f"CREATE DATABASE {database['POSTGRES_USER']}")
        self.nodes = {name: Host(self.folder, name, service, 10 + number)
                      for number, (name, service) in enumerate(self.services.items()) if name != "db"}
        for node in self.nodes.values():
            self.addCleanup(node.end)
        hosts = self.folder / "hosts"
        hosts.write_text("127.0.0.1 localhost\n10.78.0.1 db\n" +
                         "".join(f"{node.address} {name}\n" for name, node in self.nodes.items()))
        (self.folder / "bin").mkdir()
        shutil.copy(sys.argv_binary, self.folder / "bin" / "leafcutter")
        programs = os.open(self.folder / "bin", os.O_PATH)
        self.addCleanup(os.close, programs)
        for node in self.nodes.values():
            node.start(programs, hosts)

    def add_user(self):
        """The command of the file's head, on the api node."""
        words = re.search(r"exec api (leafcutter user add .*)", FILE.read_text())[1].replace("NAME", "anna").split()
        self.nodes["api"].run(*words, input=PASSWORD + "\n", text=True)

    def test_the_fleet_of_the_file_computes_and_cuts(self):
        self.begin()
        self.add_user()
        try:
            self.work()
        except AssertionError:
            for name, node in self.nodes.items():
                print(f"--- {name}\n{(node.folder / 'log').read_text()[-1500:]}", file=sys.stderr)
            raise

    def work(self):
        api = (self.nodes["api"].address, 8080)
        self.assertEqual([interpolated(port) for port in self.services["api"]["ports"]], ["127.0.0.1:8080:8080"])
        auth = wait(lambda: log_in(api), lambda auth: auth)
        nodes = wait(lambda: call(api, "GET", "/fleet", headers=auth)[1]["nodes"],
                     lambda nodes: len(nodes) == len(self.services) - 1)
        self.assertEqual(sorted((node["id"], node["role"], node["state"]) for node in nodes),
                         sorted((name, service["environment"]["ROLE"], "active")
                                for name, service in self.services.items() if name != "db"))
        self.assertIn(call(api, "PUT", f"/blobs/{SHA}", PLATE, auth)[0], (201, 204))
        status, job = call(api, "POST", "/jobs", {"blob": SHA, "file_name": "plate.off", "params": params()}, auth)
        self.assertEqual(status, 201, job)
        wait(lambda: call(api, "GET", f"/jobs/{job['id']}", headers=auth)[1], lambda job: job["state"] == "ready")
        devices = wait(lambda: call(api, "GET", "/devices", headers=auth)[1]["devices"],
                       lambda devices: all(device["status"]["state"] == "idle" for device in devices
                                           if device["station"]))
        machines = {device["id"]: device["station"] for device in devices if device["station"]}
        self.assertEqual(machines, {"laser-1": "station-1", "laser-2": "station-2"})
        for machine in machines:
            status, cut = call(api, "POST", f"/jobs/{job['id']}/cuts", {"device": machine, "sheets": [1]}, auth)
            self.assertEqual(status, 201, cut)
            path = f"/cuts/{cut['id']}"
            ready = wait(lambda: call(api, "GET", path, headers=auth)[1], lambda cut: "start" in cut["actions"])
            status, answer = call(api, "POST", f"{path}/start", {"program_sha256": ready["program_sha256"],
                                                                 "bed_clear": True}, auth)
            self.assertEqual(status, 202, answer)
            wait(lambda: call(api, "GET", path, headers=auth)[1], lambda cut: cut["state"] == "cutting")

    def test_every_volume_and_dependency_is_declared(self):
        declared = set(self.file["volumes"])
        used = {volume.split(":")[0] for service in self.services.values() for volume in service.get("volumes", [])}
        self.assertEqual(used, declared)
        for name, service in self.services.items():
            for needed in service.get("depends_on", {}):
                self.assertIn(needed, self.services, name)
        roles = [service["environment"]["ROLE"] for name, service in self.services.items() if name != "db"]
        self.assertEqual(sorted(roles), ["api", "station", "station", "worker", "worker"])
        image = (FILE.parent / "Dockerfile").read_text()
        self.assertIn("/var/lib/leafcutter", re.search(r"VOLUME (.*)", image)[1])


if __name__ == "__main__":
    if not (BINARIES / "initdb").exists() or not namespaced():
        print("needs PostgreSQL 15 and network namespaces")
        sys.exit(77)
    sys.argv_binary = str(Path(sys.argv.pop(1) if len(sys.argv) > 1 else "build/release/leafcutter").resolve())
    unittest.main()
