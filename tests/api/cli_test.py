#!/usr/bin/env python3
"""The command line against a running daemon. Usage: cli_test.py LEAFCUTTER"""
import json
import os
import pty
import subprocess
import tempfile
import time
import unittest
import zipfile
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

    def until(self, look):
        deadline = time.monotonic() + 30
        while not (found := look()):
            self.assertLess(time.monotonic(), deadline)
        return found

    def cut_until(self, cut, condition):
        return self.until(lambda: condition(now := self.json("cuts", "show", cut)) and now)

    def test_the_rest_of_a_cut_is_finished_from_the_shell(self):
        self.assertEqual(self.json("devices", "put", "slow", "sim:grbl?speed=4", "--bed", "500", "300")["bed_mm"], [500, 300])
        job = self.json("submit", "plate.off", *SETS, "--wait")
        cut = self.json("cuts", "add", job["id"], "--device", "slow", "--sheet", "1")["id"]
        self.cut_until(cut, lambda cut: "start" in cut["actions"])
        self.run_it("cuts", "start", cut, "--bed-clear")
        self.cut_until(cut, lambda cut: cut["progress"]["lines_acknowledged"] > 30)
        self.run_it("devices", "override", "slow", "--feed", "120")
        self.run_it("cuts", "pause", cut)
        self.cut_until(cut, lambda cut: cut["state"] == "paused")
        self.run_it("cuts", "abort", cut)
        over = self.cut_until(cut, lambda cut: "finish" in cut["actions"])
        self.assertEqual(over["state"], "aborted")
        self.run_it("cuts", "finish", cut, status=2)  # Nobody looked at the sheet.
        self.run_it("devices", "home", "slow")
        rest = self.json("cuts", "finish", cut, "--material-in-place", "--homed", "--burnt-mm",
                         str(round(over["beam"]["burnt_mm"], 2)))
        self.assertEqual((rest["rest_of"], rest["state"]), (cut, "waiting"))
        self.cut_until(rest["id"], lambda cut: "start" in cut["actions"])
        self.assertEqual(self.json("cuts", "start", rest["id"], "--bed-clear", "--wait")["state"], "done")
        self.assertIn("slow", self.run_it("devices", "show", "slow"))
        self.run_it("devices", "remove", "slow")
        self.run_it("devices", "show", "slow", status=1)

    def test_machines_are_driven_from_the_shell(self):
        self.run_it("devices", "put", "bench", "sim:grbl", "--name", "Bench")
        at = lambda: self.json("devices", "show", "bench")["status"]["work_position_mm"][:2]  # noqa: E731
        self.until(lambda: self.json("devices", "show", "bench")["status"]["state"] == "idle")
        self.run_it("devices", "home", "bench")
        self.until(lambda: at() == [0, 0])
        self.run_it("devices", "jog", "bench", "--dx", "5", "--dy", "3", "--feed", "3000")
        self.until(lambda: at() == [5, 3])
        for word in ("hold", "resume", "stop", "reset", "unlock"):
            self.assertEqual(self.json("devices", word, "bench"), {})
        self.run_it("devices", "console", "bench", "$$")
        self.run_it("devices", "console", "bench", "!", status=2)
        self.run_it("devices", "override", "bench", status=2)
        self.run_it("devices", "remove", "bench")

    def test_jobs_are_made_of_jobs_and_fetched_from_the_shell(self):
        job = self.json("submit", "plate.off", *SETS, "--wait")["id"]
        pieces = self.json("jobs", "recut", job, "W1", "--wait")
        self.assertEqual((pieces["state"], pieces["recut_of"]), ("ready", job))
        self.run_it("jobs", "recut", job, "W99", status=2)
        again = self.json("jobs", "recompute", job, *SETS, "--set", "grid.rows=3", "--wait")
        self.assertEqual((again["state"], again["params"]["grid"]["rows"]), ("ready", 3))
        self.assertEqual(self.json("jobs", "download", job, "-o", "job.zip"), {"file": "job.zip"})
        with zipfile.ZipFile(self.home / "job.zip") as package:
            self.assertIsNone(package.testzip())
            self.assertIn("report.json", package.namelist())
        self.run_it("jobs", "download", "j_none", "-o", "none.zip", status=1)
        self.assertEqual(sorted(self.home.glob("none.zip*")), [])

    def test_progress_is_a_line_on_a_terminal_and_objects_with_json(self):
        environment = {**os.environ, "LEAFCUTTER_URL": f"http://127.0.0.1:{self.daemon.port}"}
        submit = [daemon.BINARY, "submit", "plate.off", *SETS, "--set", "nesting.time_s=1", "--wait"]
        quiet = subprocess.run(submit, capture_output=True, text=True, timeout=60, env=environment, cwd=self.home)
        self.assertEqual((quiet.returncode, quiet.stderr), (0, ""))
        lines = subprocess.run([*submit, "--json"], capture_output=True, text=True, timeout=60, env=environment,
                               cwd=self.home).stderr.splitlines()
        told = [json.loads(line) for line in lines]
        self.assertTrue(told)
        for each in told:
            self.assertEqual(set(each) & {"stage", "fraction"}, {"stage", "fraction"}, each)
        terminal, other = pty.openpty()
        process = subprocess.Popen(submit, stdout=subprocess.DEVNULL, stderr=other, env=environment, cwd=self.home)
        os.close(other)
        shown = b""
        try:
            while part := os.read(terminal, 4096):
                shown += part
        except OSError:  # The terminal is closed.
            pass
        os.close(terminal)
        self.assertEqual(process.wait(), 0)
        self.assertIn(b"%", shown)
        self.assertIn(b"\r", shown)

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
