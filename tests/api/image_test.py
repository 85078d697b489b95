#!/usr/bin/env python3
"""The container image at work: its daemon, as the user and with the command that the image names, computes a job and
cuts it. Usage: image_test.py LEAFCUTTER. Needs root, buildah and an image: LEAFCUTTER_IMAGE, which
docker/build_image.sh --bootstrap makes; ends with 77 without."""
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
import unittest
import urllib.request

from cuts_test import PARAMS, PLATE
from daemon import free_port

IMAGE = os.environ.get("LEAFCUTTER_IMAGE", "")


def buildah(*words, **more):
    return subprocess.run(["buildah", *words], capture_output=True, text=True, check=True, timeout=120, **more).stdout.strip()


class Image(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.container = buildah("from", IMAGE)
        cls.port = free_port()
        cls.config = json.loads(buildah("inspect", "--type", "image", IMAGE))["Docker"]["config"]
        command = [word.replace("8080", str(cls.port)) for word in cls.config["Cmd"]]
        cls.process = subprocess.Popen(["buildah", "run", "--isolation", "chroot", cls.container, "--", *command],
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        cls.process.stdout.readline()

    @classmethod
    def tearDownClass(cls):
        cls.process.terminate()
        cls.process.wait(timeout=30)
        cls.process.stdout.close()
        buildah("rm", cls.container)

    def inside(self, *words):
        return subprocess.run(["buildah", "run", "--isolation", "chroot", self.container, "--", *words],
                              capture_output=True, text=True, timeout=60)

    def ask(self, method, path, body=None, kind="application/json"):
        data = body if isinstance(body, bytes) or body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}/api/v1{path}", data, {"Content-Type": kind},
                                         method=method)
        with urllib.request.urlopen(request, timeout=30) as answer:
            text = answer.read()
            return json.loads(text) if text else None

    def wait(self, path, condition, seconds=60):
        deadline = time.monotonic() + seconds
        while not condition(thing := self.ask("GET", path)):
            self.assertLess(time.monotonic(), deadline, thing)
            time.sleep(0.1)
        return thing

    def test_it_runs_as_nobody_special_and_knows_its_health(self):
        self.assertEqual(self.config["User"], "leafcutter")
        self.assertNotEqual(self.inside("id", "-u").stdout.strip(), "0")
        self.assertEqual(self.config["Healthcheck"]["Test"], ["CMD", "leafcutter", "health"])
        url = f"http://127.0.0.1:{self.port}"
        self.assertEqual(self.inside("leafcutter", "health", "--url", url).stdout, "ready\n")
        self.assertEqual(self.inside("leafcutter", "health", "--url", f"http://127.0.0.1:{free_port()}").returncode, 1)

    def test_a_job_is_computed_and_cut(self):
        sha = hashlib.sha256(PLATE).hexdigest()
        self.ask("PUT", f"/blobs/{sha}", PLATE, "application/octet-stream")
        job = self.ask("POST", "/jobs", {"blob": sha, "file_name": "plate.off", "name": "plate", "params": PARAMS})
        job = self.wait(f"/jobs/{job['id']}", lambda job: job["state"] not in ("queued", "computing"))
        self.assertEqual(job["state"], "ready", job["error"])
        self.ask("PUT", "/devices/laser", {"name": "laser", "uri": "sim:grbl?speed=400", "auto_start": False})
        path = f"/cuts/{self.ask('POST', '/jobs/' + job['id'] + '/cuts', {'device': 'laser'})['id']}"
        for call in ("start", "confirm-sheet"):
            cut = self.wait(path, lambda cut: call in cut["actions"])
            self.ask("POST", f"{path}/{call}", {"program_sha256": cut["program_sha256"], "bed_clear": True})
        self.assertEqual(self.wait(path, lambda cut: cut["state"] not in ("armed", "cutting", "awaiting-sheet"))["state"],
                         "done")
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/", timeout=30) as page:
            self.assertIn(b"<html", page.read())


if __name__ == "__main__":
    if not IMAGE or not shutil.which("buildah") or os.geteuid() != 0:
        print("LEAFCUTTER_IMAGE names no image, or there is no buildah")
        sys.exit(77)
    unittest.main()
