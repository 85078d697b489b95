#!/usr/bin/env python3
"""Cuts, machines, jobs and artifacts through the API of the real daemon, with simulated machines.
Usage: cuts_test.py LEAFCUTTER"""
import hashlib
import io
import json
import math
import tempfile
import time
import unittest
import zipfile
from pathlib import Path

from daemon import Daemon, free_port
from flat_mesh import plate

FINAL = ("done", "aborted", "failed", "interrupted")


PLATE = plate()
# Two sheets of about a minute each: at speed 1 one is always caught in mid-beam.
PARAMS = {"scale": {"longest_side_mm": 120}, "grid": {"rows": 4, "cols": 4}, "nesting": {"time_s": 0.1}}


class Served(unittest.TestCase):
    """One daemon for all tests of a class; every test puts its own machine."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.daemon = Daemon(Path(cls.folder.name) / "state", free_port())
        sha = hashlib.sha256(PLATE).hexdigest()
        status, _ = cls.daemon.call("PUT", f"/api/v1/blobs/{sha}", PLATE)
        assert status == 201, status
        cls.blob = sha
        cls.job = cls.ready_job(cls.post_job())

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        cls.folder.cleanup()
        assert status == 0, status

    @classmethod
    def ask(cls, method, path, body=None, headers=None):
        """Status, headers and the answer's JSON, or its bytes if it is none."""
        head = {"Content-Type": "application/json"} if body is not None else {}
        text = json.dumps(body) if body is not None else None
        status, headers, answer = cls.daemon.exchange(method, "/api/v1" + path, text, {**head, **(headers or {})})
        kind = headers.get("Content-Type", "")
        return status, headers, json.loads(answer) if "json" in kind else answer

    @classmethod
    def get(cls, path):
        return cls.ask("GET", path)[2]

    @classmethod
    def post_job(cls, **fields):
        status, _, job = cls.ask("POST", "/jobs", {"blob": cls.blob, "name": "plate.off", "params": PARAMS, **fields})
        assert status == 201, job
        return job

    @classmethod
    def ready_job(cls, job):
        return cls.wait(f"/jobs/{job['id']}", lambda job: job["state"] not in ("queued", "computing"))

    @classmethod
    def wait(cls, path, condition, seconds=15.0):
        deadline = time.monotonic() + seconds
        while True:
            thing = cls.get(path)
            if condition(thing):
                return thing
            assert time.monotonic() < deadline, f"{path} stays {thing}"
            time.sleep(0.02)

    def assert_problem(self, answer, status, code, pointer=None):
        self.assertEqual((answer[0], answer[2].get("code")), (status, code), answer[2])
        self.assertEqual(answer[1]["Content-Type"], "application/problem+json")
        self.assertEqual(answer[2]["status"], status)
        if pointer:
            self.assertIn(pointer, [error["pointer"] for error in answer[2].get("errors", [])], answer[2])


class Machine:
    """A simulated machine of the daemon, and what its beam burnt."""

    def __init__(self, test, name, speed, auto_start=False, more="", kind="grbl", rests="idle"):
        self.test = test
        self.path = f"/devices/{name}"
        self.name = name
        self.log = Path(test.folder.name) / "state/burns" / f"{name}.jsonl"
        self.fields = {"name": name, "uri": f"sim:{kind}?speed={speed}&burn={self.log}{more}", "auto_start": auto_start}
        status, _, answer = test.ask("PUT", self.path, self.fields)
        test.assertIn(status, (200, 201), answer)
        self.until(rests)

    def until(self, state):
        return self.test.wait(self.path, lambda device: device["status"]["state"] == state)

    def command(self, name, **fields):
        return self.test.ask("POST", self.path + "/commands", {"command": name, **fields})

    def burnt_mm(self):
        """The way of the beam up to the last time the machine stood still."""
        pieces = [json.loads(line) for line in self.log.read_text().splitlines()]
        return sum(math.hypot(p["x1"] - p["x0"], p["y1"] - p["y0"]) for p in pieces if p["s"] > 0)

    def stands_dark(self, seconds=0.3):
        """For longer than two of its reports the machine neither moves nor burns."""
        before = self.test.get(self.path)["status"]
        time.sleep(seconds)
        after = self.test.get(self.path)["status"]
        self.test.assertEqual(after["power_s"], 0)
        self.test.assertEqual(after["work_position_mm"], before["work_position_mm"])

    def burnt_in_all_mm(self):
        """The same when the machine is gone, with all that it burnt until then."""
        status, _, answer = self.test.ask("DELETE", self.path)
        self.test.assertEqual(status, 204, answer)
        return self.burnt_mm()


class CutsOf(Served):
    def put_cut(self, machine, job=None, **fields):
        job = job or self.job
        status, _, cut = self.ask("POST", f"/jobs/{job['id']}/cuts", {"device": machine.name, **fields})
        self.assertEqual(status, 201, cut)
        return f"/cuts/{cut['id']}"

    def fire(self, path, call="start"):
        cut = self.wait(path, lambda cut: call in cut["actions"])
        answer = self.ask("POST", f"{path}/{call}", {"program_sha256": cut["program_sha256"], "bed_clear": True})
        self.assertEqual(answer[0], 202, answer[2])

    def reaches(self, path, *states, seconds=15.0):
        cut = self.wait(path, lambda cut: cut["state"] in (*states, *FINAL), seconds)
        self.assertIn(cut["state"], states, cut)
        return cut

    def burning(self, machine, path):
        self.fire(path)
        # More lines than the controller's planner holds: some are burnt.
        self.wait(path, lambda cut: cut["state"] == "cutting" and cut["progress"]["lines_acknowledged"] > 30)
        self.assertEqual(self.get(machine.path)["cut"], path.split("/")[-1])

    def planned_mm(self, *sheets):
        report = self.get(f"/jobs/{self.job['id']}/artifacts/report.json")
        return sum(sheet["burn_mm"] for sheet in report["cut"]["sheets"] if sheet["sheet"] in sheets)


class Cuts(CutsOf):
    def test_a_paused_cut_holds_with_the_beam_off_and_goes_on(self):
        machine = Machine(self, "pause", 12)
        path = self.put_cut(machine, sheets=[1])
        self.burning(machine, path)
        self.assertEqual(self.ask("POST", path + "/pause")[0], 202)
        cut = self.reaches(path, "paused")
        self.assertEqual(sorted(cut["actions"]), ["abort", "resume"])
        self.wait(machine.path, lambda device: device["status"]["power_s"] == 0)
        self.wait(machine.path, lambda device: device["status"]["feed_mm_per_min"] == 0)
        machine.stands_dark()
        self.assertEqual(self.ask("POST", path + "/resume")[0], 202)
        self.reaches(path, "cutting", "done")
        cut = self.reaches(path, "done", seconds=20)
        self.assertEqual(cut["progress"]["fraction"], 1.0)
        self.assert_problem(self.ask("POST", path + "/resume"), 409, "not-now")
        planned = self.planned_mm(1)
        self.assertAlmostEqual(machine.burnt_in_all_mm(), planned, delta=planned * 0.001)

    def test_a_hold_at_the_machine_pauses_the_cut(self):
        machine = Machine(self, "hold", 3)
        path = self.put_cut(machine, sheets=[1])
        self.burning(machine, path)
        self.assertEqual(machine.command("hold")[0], 202)
        self.reaches(path, "paused")
        self.assertEqual(machine.command("resume")[0], 202)
        self.reaches(path, "cutting")
        self.assertEqual(self.ask("POST", path + "/pause")[0], 202)
        self.reaches(path, "paused")
        self.assertEqual(self.ask("POST", path + "/abort")[0], 202)
        self.reaches(path, "aborted")
        machine.until("idle")

    def test_an_aborted_cut_burns_nothing_more(self):
        machine = Machine(self, "abort", 3)
        job = self.ready_job(self.post_job())
        path = self.put_cut(machine, job)
        self.burning(machine, path)
        self.assertEqual(self.ask("POST", path + "/abort")[0], 202)
        cut = self.reaches(path, "aborted")
        self.assertEqual(cut["actions"], ["finish"])
        machine.until("idle")
        burnt = machine.burnt_mm()
        self.assertTrue(0 < burnt < 0.9 * self.planned_mm(1), burnt)
        machine.stands_dark()
        self.assertEqual(self.get(path)["state"], "aborted")
        for call in ("start", "confirm-sheet"):
            consent = {"program_sha256": cut["program_sha256"], "bed_clear": True}
            self.assert_problem(self.ask("POST", f"{path}/{call}", consent), 409, "not-now")
        self.assert_problem(self.ask("POST", path + "/abort"), 409, "not-now")
        job = self.get(f"/jobs/{job['id']}")
        self.assertEqual((job["state"], {sheet["state"] for sheet in job["sheets"]}), ("ready", {"uncut"}))
        self.assertEqual(machine.burnt_in_all_mm(), burnt)

    def test_a_stop_ends_the_cut_and_nothing_restarts_it(self):
        machine = Machine(self, "stop", 3)
        path = self.put_cut(machine)
        self.burning(machine, path)
        self.assertEqual(machine.command("stop")[0], 202)
        self.reaches(path, "aborted", "interrupted")
        machine.command("unlock")
        machine.until("idle")
        burnt = machine.burnt_mm()
        machine.stands_dark()
        self.assertEqual(self.get(path)["actions"], ["finish"])
        self.assertEqual(machine.burnt_in_all_mm(), burnt)

    def test_a_machine_of_its_own_cuts_every_sheet_by_itself(self):
        machine = Machine(self, "auto", 300, auto_start=True)
        path = self.put_cut(machine, sheets=[1, 2])
        cut = self.wait(path, lambda cut: cut["state"] in FINAL)
        self.assertEqual((cut["state"], cut["sheet"]), ("done", 2))
        planned = self.planned_mm(1, 2)
        self.assertAlmostEqual(machine.burnt_in_all_mm(), planned, delta=planned * 0.001)

    def test_sheet_after_sheet_needs_its_own_word(self):
        machine = Machine(self, "sheets", 300)
        path = self.put_cut(machine, sheets=[1, 2])
        first = self.get(path)["program_sha256"]
        self.fire(path)
        cut = self.reaches(path, "awaiting-sheet")
        self.assertEqual(cut["sheet"], 2)
        self.assertNotEqual(cut["program_sha256"], first)
        machine.stands_dark()
        stale = {"program_sha256": first, "bed_clear": True}
        self.assert_problem(self.ask("POST", path + "/confirm-sheet", stale), 409, "other-program")
        self.fire(path, "confirm-sheet")
        self.reaches(path, "done")

    def test_a_cut_awaiting_its_sheet_keeps_the_machine_until_it_is_aborted(self):
        machine = Machine(self, "await", 300)
        first, second = self.put_cut(machine, sheets=[1, 2]), self.put_cut(machine, sheets=[2])
        self.fire(first)
        self.reaches(first, "awaiting-sheet")
        waiting = self.get(second)
        self.assertEqual(waiting["actions"], ["abort"])
        consent = {"program_sha256": waiting["program_sha256"], "bed_clear": True}
        self.assert_problem(self.ask("POST", second + "/start", consent), 409, "device-not-ready")
        self.assertEqual(self.ask("POST", first + "/abort")[0], 202)
        self.assertEqual(self.get(first)["state"], "aborted")
        self.wait(second, lambda cut: cut["actions"] == ["start", "abort"])
        self.ask("POST", second + "/abort")

    def test_nothing_fires_without_the_whole_word(self):
        machine = Machine(self, "word", 300)
        path = self.put_cut(machine, sheets=[1])
        self.wait(path, lambda cut: "start" in cut["actions"])
        program = self.get(path)["program_sha256"]
        start = path + "/start"
        self.assert_problem(self.ask("POST", start, {"bed_clear": True}), 422, "bad-field", "/program_sha256")
        other = {"program_sha256": "0" * 64, "bed_clear": True}
        self.assert_problem(self.ask("POST", start, other), 409, "other-program")
        for said in ({}, {"bed_clear": False}, {"bed_clear": "true"}, {"bed_clear": 1}):
            answer = self.ask("POST", start, {"program_sha256": program, **said})
            self.assert_problem(answer, 422, "bad-field", "/bed_clear")
        early = {"program_sha256": program, "bed_clear": True}
        self.assert_problem(self.ask("POST", path + "/confirm-sheet", early), 409, "not-now")
        self.assertEqual(self.get(path)["state"], "waiting")
        self.ask("POST", path + "/abort")
        self.assertEqual(machine.burnt_in_all_mm(), 0)

    def test_a_cut_names_sheets_of_its_job_and_a_machine(self):
        machine = Machine(self, "names", 300)
        cuts = f"/jobs/{self.job['id']}/cuts"
        self.assert_problem(self.ask("POST", cuts, {"device": "nobody"}), 422, "no-such-device", "/device")
        self.assert_problem(self.ask("POST", cuts, {}), 422, "bad-field", "/device")
        for sheets in (1, "1", {"a": 1}, [0], ["1"], [1.5]):
            answer = self.ask("POST", cuts, {"device": machine.name, "sheets": sheets})
            self.assert_problem(answer, 422, "bad-field", "/sheets")
        answer = self.ask("POST", cuts, {"device": machine.name, "sheets": [99]})
        self.assert_problem(answer, 409, "not-cuttable")

    def test_pages_hear_when_only_what_is_allowed_changed(self):
        """A waiting cut may start once the one before it lets go of the machine: its event says so."""
        machine = Machine(self, "hear", 300)
        first, second = self.put_cut(machine, sheets=[1, 2]), self.put_cut(machine, sheets=[2])
        self.fire(first)
        self.reaches(first, "awaiting-sheet")
        machine.stands_dark()  # Nothing is left to be told.
        with self.daemon.events() as events:
            self.ask("POST", first + "/abort")
            told = events.until(lambda kind, data: kind == "cut" and data["cut"]["id"] in second
                                and "start" in data["cut"]["actions"])
            self.assertTrue(told)
            self.ask("POST", second + "/abort")
            self.assertTrue(events.until(lambda kind, data: kind == "job" and data["job"]["id"] == self.job["id"]))


class Machines(CutsOf):
    def test_a_machine_at_work_is_not_changed(self):
        machine = Machine(self, "busy", 3)
        path = self.put_cut(machine, sheets=[1])
        self.burning(machine, path)
        self.assert_problem(self.ask("PUT", machine.path, machine.fields), 409, "refused")
        self.assert_problem(self.ask("DELETE", machine.path), 409, "in-use")
        for command in ("home", "unlock", "jog", "frame"):
            self.assert_problem(machine.command(command), 409, "refused")
        self.assert_problem(machine.command("console", line="$$"), 409, "refused")
        self.assertNotIn("jog", self.get(machine.path)["actions"])
        self.assert_problem(self.ask("DELETE", f"/jobs/{self.job['id']}"), 409, "in-use")
        self.ask("POST", path + "/abort")
        self.reaches(path, "aborted")
        self.assertEqual(self.ask("DELETE", machine.path)[0], 204)
        self.assert_problem(self.ask("GET", machine.path), 404, "no-such-device")

    def test_putting_a_machine_checks_it_and_makes_or_changes_it(self):
        fields = {"name": "Left", "uri": "sim:grbl?speed=9", "bed_mm": [300, 200]}
        status, _, device = self.ask("PUT", "/devices/left", fields)
        self.assertEqual((status, device["bed_mm"], device["auto_start"]), (201, [300, 200], False))
        status, _, device = self.ask("PUT", "/devices/left", {**fields, "name": "Right"})
        self.assertEqual((status, device["name"]), (200, "Right"))
        for wrong, pointer in (({"uri": 1}, "/uri"), ({"uri": "file:/etc/passwd"}, "/uri"),
                               ({"bed_mm": [0, 1]}, "/bed_mm"), ({"bed_mm": [1]}, "/bed_mm"),
                               ({"auto_start": "yes"}, "/auto_start"), ({"colour": "red"}, "/colour")):
            self.assert_problem(self.ask("PUT", "/devices/left", {**fields, **wrong}), 422, "bad-field", pointer)
        self.assert_problem(self.ask("PUT", "/devices/LEFT", fields), 422, "bad-field")
        self.assertEqual(self.get("/devices/left")["name"], "Right")
        self.assertEqual(self.ask("DELETE", "/devices/left")[0], 204)

    def test_a_board_that_lost_its_place_must_be_homed_first(self):
        board = Machine(self, "k40", 30, more="&width=700&height=500", kind="lihuiyu", rests="alarm")
        path = self.put_cut(board, sheets=[1])
        cut = self.get(path)
        consent = {"program_sha256": cut["program_sha256"], "bed_clear": True}
        self.assertNotIn("start", cut["actions"])
        self.assert_problem(self.ask("POST", path + "/start", consent), 409, "device-not-ready")
        self.assertEqual(board.command("jog", dx_mm=1, dy_mm=0, feed_mm_min=1000)[0], 409)
        self.assertEqual(board.command("home")[0], 202)
        board.until("idle")
        self.burning(board, path)
        self.assertEqual(board.command("stop")[0], 202)
        self.reaches(path, "aborted")
        self.assertIn("home", board.until("alarm")["status"]["message"])
        again = self.put_cut(board, sheets=[1])
        self.assert_problem(self.ask("POST", again + "/start", consent), 409, "device-not-ready")
        self.assertEqual(board.command("home")[0], 202)
        board.until("idle")
        self.burning(board, again)

    def test_marlin_and_smoothieware_cut_a_sheet_each(self):
        for kind in ("marlin", "smoothie"):
            params = {**PARAMS, "output": {"dialect": kind}}
            job = self.ready_job(self.post_job(params=params))
            machine = Machine(self, kind, 0, kind=kind)
            path = self.put_cut(machine, job, sheets=[1])
            self.fire(path)
            self.reaches(path, "done", seconds=60)
            planned = self.planned_mm(1)
            self.assertAlmostEqual(machine.burnt_in_all_mm(), planned, delta=planned * 0.001)

    def test_a_machine_jogs_and_frames_without_light(self):
        machine = Machine(self, "hand", 20)
        self.assert_problem(machine.command("frame"), 409, "refused")
        self.assertEqual(machine.command("jog", dx_mm=30, dy_mm=20, feed_mm_per_min=6000)[0], 202)
        self.wait(machine.path, lambda device: device["status"]["work_position_mm"][:2] == [30, 20])
        machine.until("idle")
        path = self.put_cut(machine, sheets=[1])
        self.assertEqual(machine.command("frame")[0], 202)
        machine.until("run")
        self.assertNotIn("start", self.get(path)["actions"])
        machine.until("idle")
        program = self.get(path)["program_sha256"]
        # It ends where it began: at the lower left corner of what will be burnt.
        corner = [min(axis) for axis in zip(*self.burn_points(self.program(program)))]
        self.assertEqual(self.get(machine.path)["status"]["work_position_mm"][:2], corner)
        for wrong, pointer in (({"dx_mm": "a"}, "/dx_mm"), ({"feed_mm_per_min": 0}, "/feed_mm_per_min")):
            self.assert_problem(machine.command("jog", **wrong), 422, "bad-field", pointer)
        self.assert_problem(machine.command("dance"), 422, "bad-field", "/command")
        self.assert_problem(machine.command("console", line="a!"), 422, "bad-field", "/line")
        self.assertEqual(machine.command("console", line="$I")[0], 202)
        self.wait(machine.path, lambda device: "> $I" in device["console"])
        self.ask("POST", path + "/abort")
        self.assertEqual(machine.burnt_in_all_mm(), 0)

    def test_a_cut_goes_faster_and_weaker_while_it_burns(self):
        machine = Machine(self, "override", 4)
        path = self.put_cut(machine, sheets=[1])
        self.burning(machine, path)
        for wrong, pointer in (({"feed": 9}, "/feed"), ({"feed": 201}, "/feed"), ({"power": 80.5}, "/power"),
                               ({"power": "80"}, "/power"), ({"rapid": 75}, "/rapid"), ({}, "/feed")):
            self.assert_problem(machine.command("override", **wrong), 422, "bad-field", pointer)
        self.assertEqual(machine.command("override", feed=120, power=70)[0], 202)
        self.wait(machine.path, lambda device: device["status"]["override_percent"] == [120, 100, 70])
        self.assertEqual(machine.command("override", rapid=50)[0], 202)
        self.wait(machine.path, lambda device: device["status"]["override_percent"] == [120, 50, 70])
        self.reaches(path, "done", seconds=60)
        powers = {json.loads(line)["s"] for line in machine.log.read_text().splitlines()}
        self.assertGreater(len([s for s in powers if s > 0]), 1)

    def test_settings_are_listed_and_edited_within_what_is_safe(self):
        machine = Machine(self, "settings", 9)
        settings = lambda: {s["key"]: s for s in self.get(machine.path + "/settings")["settings"]}
        self.assertEqual(settings()["$110"], {"key": "$110", "value": 6000, "name": "X maximum rate, mm/min"})
        self.assertEqual(machine.command("setting", key="$110", value=4500.5)[0], 202)
        self.wait(machine.path + "/settings", lambda _: settings()["$110"]["value"] == 4500.5)
        for wrong, pointer in (({"value": 1}, "/key"), ({"key": "$110"}, "/value"), ({"key": "$110", "value": "1"}, "/value")):
            self.assert_problem(machine.command("setting", **wrong), 422, "bad-field", pointer)
        for key, value in (("$110", -5), ("$100", 0), ("$999", 1), ("$J", 1), ("$110=1", 2), ("$32", 0.5)):
            self.assert_problem(machine.command("setting", key=key, value=value), 409, "refused")
        self.assertEqual(settings()["$110"]["value"], 4500.5)
        self.assert_problem(self.ask("GET", "/devices/nobody/settings"), 404, "no-such-device")
        board = Machine(self, "board", 9, kind="marlin")
        self.assertEqual(self.get(board.path + "/settings"), {"settings": []})
        self.assert_problem(board.command("setting", key="$110", value=5), 409, "refused")
        self.assert_problem(board.command("override", feed=120), 409, "refused")

    def burn_points(self, program):
        at, burns = {"X": 0.0, "Y": 0.0}, False
        for line in program.splitlines():
            if line.startswith(";"):
                continue
            burns = {"G0": False, "G1": True}.get(line.split()[0], burns)
            before = tuple(at.values())
            at.update({word[0]: float(word[1:]) for word in line.split() if word[0] in at})
            if burns:
                yield from (before, tuple(at.values()))

    def program(self, sha256):
        for artifact in self.get(f"/jobs/{self.job['id']}/artifacts")["artifacts"]:
            if artifact["sha256"] == sha256:
                return self.ask("GET", f"/jobs/{self.job['id']}/artifacts/{artifact['path']}")[2].decode()
        self.fail("the cut's program is no artifact")


class Files(Served):
    def test_every_artifact_is_what_its_entry_says_also_in_the_package(self):
        listed = self.get(f"/jobs/{self.job['id']}/artifacts")["artifacts"]
        self.assertIn("sheets/sheet-002.gcode", [artifact["path"] for artifact in listed])
        status, headers, packed = self.ask("GET", f"/jobs/{self.job['id']}/package.zip")
        self.assertEqual((status, headers["Content-Type"]), (200, "application/zip"))
        with zipfile.ZipFile(io.BytesIO(packed)) as package:
            self.assertIsNone(package.testzip())
            self.assertEqual(sorted(package.namelist()), sorted(artifact["path"] for artifact in listed))
            for artifact in listed:
                path = f"/api/v1/jobs/{self.job['id']}/artifacts/{artifact['path']}"
                status, _, content = self.daemon.exchange("GET", path)
                self.assertEqual((status, len(content)), (200, artifact["bytes"]))
                self.assertEqual(hashlib.sha256(content).hexdigest(), artifact["sha256"])
                self.assertEqual(package.read(artifact["path"]), content)

    def test_ranges_and_validators(self):
        path = f"/api/v1/jobs/{self.job['id']}/artifacts/quads.obj"
        _, headers, whole = self.daemon.exchange("GET", path)
        size, etag = len(whole), headers["ETag"]
        for asked, first, last in (("0-9", 0, 9), ("5-", 5, size - 1), ("-7", size - 7, size - 1),
                                   (f"3-{size + 99}", 3, size - 1), (f"-{size + 9}", 0, size - 1)):
            status, headers, part = self.daemon.exchange("GET", path, None, {"Range": f"bytes={asked}"})
            self.assertEqual((status, part), (206, whole[first:last + 1]), asked)
            self.assertEqual(headers["Content-Range"], f"bytes {first}-{last}/{size}")
        for asked in (f"{size}-", "-0"):
            status, headers, _ = self.daemon.exchange("GET", path, None, {"Range": f"bytes={asked}"})
            self.assertEqual((status, headers["Content-Range"]), (416, f"bytes */{size}"))
        stale = {"Range": "bytes=0-9", "If-Range": '"another"'}
        self.assertEqual(self.daemon.exchange("GET", path, None, stale)[::2], (200, whole))
        for seen in (etag, "W/" + etag, f'"another", {etag}', "*"):
            status, headers, body = self.daemon.exchange("GET", path, None, {"If-None-Match": seen})
            self.assertEqual((status, body, headers["ETag"]), (304, b"", etag), seen)
        self.assertEqual(self.daemon.exchange("GET", path, None, {"If-None-Match": '"another"'})[0], 200)
        status, headers, body = self.daemon.exchange("HEAD", path)
        self.assertEqual((status, body, headers["Content-Length"]), (200, b"", str(size)))


class Jobs(Served):
    def test_a_repeated_key_makes_one_job(self):
        once = {"Idempotency-Key": "once"}
        body = {"blob": self.blob, "name": "once.off", "params": PARAMS}
        first, again = (self.ask("POST", "/jobs", body, once) for _ in range(2))
        self.assertEqual((first[0], again[0]), (201, 201))
        self.assertEqual(first[2]["id"], again[2]["id"])
        self.assertEqual(first[1]["Location"], f"/api/v1/jobs/{first[2]['id']}")
        other = self.ask("POST", "/jobs", {**body, "name": "twice"}, once)
        self.assert_problem(other, 422, "idempotency-key-reused")

    def test_wrong_parameters_are_refused_by_their_place(self):
        for params, pointer in (({"grid": {"strip_width_mm": -1}}, "/grid/strip_width_mm"),
                                ({"grid": {"stripes": 1}}, "/grid/stripes"),
                                ({"fit": {"clearance_mm": "a"}}, "/fit/clearance_mm")):
            answer = self.ask("POST", "/jobs", {"blob": self.blob, "params": params})
            self.assertIn(answer[0], (400, 422))
            self.assert_problem(answer, answer[0], answer[2]["code"], pointer)
            again = self.ask("POST", f"/jobs/{self.job['id']}/recompute", {"params": params})
            self.assert_problem(again, answer[0], answer[2]["code"], pointer)
        self.assert_problem(self.ask("POST", "/jobs", {"blob": "0" * 64}), 422, "no-blob", "/blob")
        self.assert_problem(self.ask("POST", "/jobs", {"blob": self.blob, "name": 1}), 422, "bad-field", "/name")

    def test_recomputing_makes_a_new_job_of_the_same_mesh(self):
        params = {**PARAMS, "grid": {"rows": 3, "cols": 5}}
        status, headers, job = self.ask("POST", f"/jobs/{self.job['id']}/recompute", {"params": params})
        self.assertEqual((status, headers["Location"]), (201, f"/api/v1/jobs/{job['id']}"))
        self.assertNotEqual(job["id"], self.job["id"])
        self.assertEqual((job["file"], job["params"], job["name"]), (self.job["file"], params, self.job["name"]))
        job = self.ready_job(job)
        self.assertEqual((job["state"], job["summary"]["quads"]), ("ready", 15))
        self.assertEqual(self.get(f"/jobs/{self.job['id']}")["summary"]["quads"], 16)

    def test_deleting_cancels_what_runs_and_removes_what_is_over(self):
        job = self.post_job(params={**PARAMS, "nesting": {"time_s": 60}})
        path = f"/jobs/{job['id']}"
        self.wait(path, lambda job: job["state"] == "computing")
        self.assert_problem(self.ask("POST", path + "/cuts", {"device": "sim"}), 409, "not-cuttable")
        self.assert_problem(self.ask("GET", path + "/package.zip"), 409, "not-ready")
        status, _, job = self.ask("DELETE", path)
        self.assertEqual((status, job["state"]), (200, "cancelled"))
        self.assertEqual(sorted(job["actions"]), ["recompute", "remove", "retry"])
        self.assertEqual(self.ask("DELETE", path)[0], 204)
        self.assert_problem(self.ask("GET", path), 404, "no-such-job")
        self.assert_problem(self.ask("DELETE", path), 404, "no-such-job")


if __name__ == "__main__":
    unittest.main()
