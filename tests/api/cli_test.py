#!/usr/bin/env python3
"""The command line against a running daemon. Usage: cli_test.py LEAFCUTTER"""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import daemon
from cuts_test import PLATE
from daemon import Daemon, free_port

SETS = ["--set", "scale.longest_side_mm=120", "--set", "grid.rows=4", "--set", "grid.cols=4",
        "--set", "nesting.time_s=0.1"]


class CommandLine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.home = Path(cls.folder.name)
        cls.daemon = Daemon(cls.home / "state", free_port())
        (cls.home / "plate.off").write_bytes(PLATE)
        (cls.home / "broken.off").write_bytes(b"OFF\n1 1 0\n0 0 0\n3 0 1 2\n")
        cls.log = cls.home / "state/burns/cli.jsonl"
        machine = json.dumps({"name": "laser", "uri": f"sim:grbl?speed=400&burn={cls.log}"})
        status, _ = cls.daemon.call("PUT", "/api/v1/devices/laser", machine, {"Content-Type": "application/json"})
        assert status == 201, status

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        cls.folder.cleanup()
        assert status == 0, status

    def run_it(self, *words, status=0, text=None, url=None):
        environment = {**os.environ, "LEAFCUTTER_URL": url or f"http://127.0.0.1:{self.daemon.port}"}
        done = subprocess.run([daemon.BINARY, *words], capture_output=True, text=True, timeout=60, input=text,
                              env=environment, cwd=self.home)
        self.assertEqual(done.returncode, status, done.stderr + done.stdout)
        if status:
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        return done.stdout

    def json(self, *words, **more):
        return json.loads(self.run_it("--json", *words, **more))

    def test_a_model_goes_from_file_to_burnt_sheets(self):
        job = self.json("submit", "plate.off", *SETS, "--name", "from a shell", "--wait")
        self.assertEqual((job["name"], job["state"]), ("from a shell", "ready"))
        self.assertIn("from a shell", self.run_it("jobs"))
        self.assertEqual(self.json("jobs", "show", job["id"])["id"], job["id"])
        listed = self.json("jobs", "--state", "ready")["jobs"]
        self.assertIn(job["id"], [each["id"] for each in listed])
        machines = self.json("devices", "--daemon")["devices"]
        self.assertIn("laser", [each["id"] for each in machines])
        self.assertIn("laser", self.run_it("devices", "--daemon"))
        cut = self.json("cuts", "add", job["id"], "--device", "laser")
        self.run_it("cuts", "start", cut["id"], status=2)  # Nobody said that the bed is clear.
        for sheet in job["sheets"]:
            cut = self.json("cuts", "start", cut["id"], "--bed-clear", "--wait")
            wanted = "done" if sheet is job["sheets"][-1] else "awaiting-sheet"
            self.assertEqual(cut["state"], wanted)
        self.assertGreater(len(self.log.read_text().splitlines()), 100)
        self.assertEqual(self.json("cuts", "show", cut["id"])["state"], "done")
        self.assertIn(cut["id"], self.run_it("cuts"))
        self.assertEqual(self.json("jobs", "show", job["id"])["state"], "done")

    def test_the_queue_is_led_from_the_shell(self):
        self.run_it("jobs", "pause", "--reason", "lunch")
        try:
            jobs = [self.json("submit", "plate.off", "--name", name)["id"] for name in "abc"]
            self.run_it("jobs", "move", jobs[2], "1")
            queue = self.json("jobs", "queue")
            self.assertEqual((queue["reason"], [each["name"] for each in queue["next"]]), ("lunch", list("cab")))
            self.run_it("jobs", "priority", jobs[1], "7")
            self.assertEqual(self.json("jobs", "queue")["next"][0]["name"], "b")
            self.assertEqual(self.json("jobs", "cancel", jobs[0])["state"], "cancelled")
            tried = self.json("jobs", "retry", jobs[0], "--cause", "wrong one")
            self.assertEqual((tried["state"], tried["retry_cause"]), ("queued", "wrong one"))
            for job in jobs:
                self.run_it("jobs", "cancel", job)
                self.run_it("jobs", "remove", job)
                self.run_it("jobs", "show", job, status=1)
        finally:
            self.run_it("jobs", "resume")

    def test_what_fails_says_so_with_its_exit_status(self):
        self.run_it("submit", "none.off", status=2)
        self.run_it("submit", "broken.off", "--wait", status=2)
        self.run_it("submit", "plate.off", "--set", "grid.rows=-1", status=2)
        self.run_it("cuts", "show", "c_none", status=1)
        self.run_it("jobs", status=1, url=f"http://127.0.0.1:{free_port()}")
        self.run_it("jobs", status=2, url="ftp://nowhere")

    def test_health_and_backups(self):
        self.assertEqual(self.run_it("health"), "ready\n")
        self.assertTrue(self.json("health")["database"])
        self.run_it("health", status=1, url=f"http://127.0.0.1:{free_port()}")
        made = self.run_it("backup").strip()
        self.assertTrue((self.home / "state/backups" / made).exists())
        self.assertIn(made, [each["name"] for each in self.json("backup", "--list")["backups"]])
        self.assertIn(made, self.run_it("backup", "--list"))

    def test_shelves_go_out_and_come_in_as_json(self):
        sheet = {"id": "drawer", "material": "paper-160-blue", "width_mm": 210, "height_mm": 297, "quantity": 4}
        felt = {**self.json("materials", "list")["materials"][0], "id": "house-paper", "name": "House paper"}
        preset = {"id": "narrow", "name": "Narrow", "params": {"grid": {"strip_width_mm": 6}}}
        for shelf, entry in (("stock", sheet), ("materials", {**felt, "origin": "own"}), ("presets", preset)):
            with self.subTest(shelf=shelf):
                self.run_it(shelf, "import", "-", text=json.dumps({shelf: [entry]}))
                self.assertIn(entry["id"], self.run_it(shelf, "list"))
                self.run_it(shelf, "export", f"{shelf}.json")
                kept = json.loads((self.home / f"{shelf}.json").read_text())
                self.assertEqual(kept, json.loads(self.run_it(shelf, "export")))
                self.assertEqual(self.daemon.call("DELETE", f"/api/v1/{shelf}/{entry['id']}")[0], 204)
                self.assertNotIn(entry["id"], self.run_it(shelf, "list"))
                self.run_it(shelf, "import", f"{shelf}.json")
                self.assertIn(entry["id"], self.run_it(shelf, "list"))
                self.run_it(shelf, "import", "plate.off", status=2)

    def test_test_cards_come_with_and_without_a_daemon(self):
        job = self.json("test-card", "kerf", "--material", "plywood-0.8", "--cells", "5")
        self.assertEqual((job["state"], job["summary"]["test"]), ("ready", "kerf"))
        self.run_it("test-card", "power", "--material", "plywood-0.8", "--power-percent", "10", "90", "--powers", "3",
                    "-o", "card")
        report = json.loads((self.home / "card/report.json").read_text())
        self.assertEqual((report["test"]["power_percent"], report["test"]["powers"]), ([10, 90], 3))
        self.assertIn("M5 S0", (self.home / "card/sheets/sheet-001.gcode").read_text())
        self.run_it("test-card", "power", "--material", "gold", "-o", "card", status=2)
        self.run_it("test-card", "power", "--material", "gold", status=2)


if __name__ == "__main__":
    unittest.main()
