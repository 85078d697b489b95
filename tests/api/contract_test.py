#!/usr/bin/env python3
"""The public contract of the API, call by call as a stranger reads it: paths, fields, statuses, states. Every answer is held
against openapi.json besides (daemon.py). Usage: contract_test.py LEAFCUTTER"""
import hashlib
import http.client
import io
import json
import re
import unittest
import zipfile

from cuts_test import PARAMS, PLATE, CutsOf, Machine, plate

RFC3339 = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z")
JOB_STATES = {"queued", "computing", "ready", "done", "failed", "cancelled"}
CUT_STATES = {"waiting", "armed", "cutting", "paused", "awaiting-sheet", "done", "aborted", "failed", "interrupted"}


class Jobs(CutsOf):
    def test_a_job_of_a_form(self):
        parts = {"params": json.dumps(PARAMS).encode(), "name": "of a form".encode()}
        for mesh_name in ("plate.off", "plate"):  # A file without an ending is told by its bytes.
            body = b"".join(b'--x\r\nContent-Disposition: form-data; name="%s"\r\n\r\n%s\r\n' % (name.encode(), value)
                            for name, value in parts.items())
            body += (b'--x\r\nContent-Disposition: form-data; name="mesh"; filename="%s"\r\n'
                     b"Content-Type: application/octet-stream\r\n\r\n%s\r\n--x--\r\n" % (mesh_name.encode(), PLATE))
            status, headers, answer = self.daemon.exchange(
                "POST", "/api/v1/jobs", body, {"Content-Type": "multipart/form-data; boundary=x", "Idempotency-Key": mesh_name})
            job = json.loads(answer)
            self.assertEqual((status, job["name"], job["state"]), (201, "of a form", "queued"))
            self.assertEqual(headers["Location"], f"/api/v1/jobs/{job['id']}")
            self.assertEqual(self.ready_job(job)["state"], "ready")

    def test_a_job_of_a_blob_with_a_name_of_any_kind(self):
        for name in ("A lamp, №1", "plate v1.2", ""):
            status, headers, job = self.ask("POST", "/jobs", {"blob": self.blob, "params": PARAMS, "name": name})
            self.assertEqual((status, headers["Location"]), (201, f"/api/v1/jobs/{job['id']}"))
            self.assertEqual(self.ready_job(job)["state"], "ready", name)

    def test_times_and_states_are_those_of_the_contract(self):
        for job in self.get("/jobs?limit=200")["jobs"]:
            self.assertIn(job["state"], JOB_STATES)
            self.assertRegex(job["created_at"], RFC3339)
        failed = self.ready_job(self.post_job(params={**PARAMS, "foliation": {"mode": "torus"}}))
        self.assertEqual(failed["state"], "failed")
        self.assertTrue(failed["error"]["kind"] and failed["error"]["detail"])

    def test_large_uploads_are_named_by_their_content(self):
        mesh = plate(9, 9)
        path = "/api/v1/blobs/" + hashlib.sha256(mesh).hexdigest()
        self.assertEqual([self.daemon.call("PUT", path, mesh)[0] for _ in range(2)], [201, 204])
        self.assertEqual(self.daemon.call("GET", path), (200, mesh))
        self.assertEqual(self.daemon.call("PUT", path[:-64] + "0" * 64, mesh)[0], 422)

    def test_lists_have_filters_and_pages(self):
        jobs = [self.post_job()["id"] for _ in range(3)]
        first = self.get("/jobs?limit=2")
        self.assertEqual([job["id"] for job in first["jobs"]], jobs[:0:-1])
        self.assertEqual(self.get(f"/jobs?limit=1&cursor={first['next_cursor']}")["jobs"][0]["id"], jobs[0])
        for state in JOB_STATES:
            self.assertLessEqual({job["state"] for job in self.get(f"/jobs?state={state}")["jobs"]}, {state})
        self.assert_problem(self.ask("GET", "/jobs?state=none"), 400, "bad-query")
        self.assert_problem(self.ask("GET", "/jobs?limit=many"), 400, "bad-query")

    def test_delete_cancels_and_then_removes(self):
        self.ask("POST", "/queue/pause", {})
        path = f"/jobs/{self.post_job()['id']}"
        self.assertEqual((self.ask("DELETE", path)[2]["state"], self.ask("DELETE", path)[0]), ("cancelled", 204))
        self.ask("POST", "/queue/resume", {})
        self.assert_problem(self.ask("GET", path), 404, "no-such-job")

    def test_the_package_is_there_file_by_file_and_whole(self):
        root = f"/jobs/{self.job['id']}"
        listed = {each["path"] for each in self.get(root + "/artifacts")["artifacts"]}
        wanted = {"report.json", "surface.ply", "quads.obj", "leaves.json", "strips.json", "weave.json", "layout.json",
                  "guide.html", "sheets/sheet-001.svg", "sheets/sheet-001.dxf", "sheets/sheet-001.gcode"}
        self.assertLessEqual(wanted, listed)
        status, headers, report = self.ask("GET", root + "/artifacts/report.json")
        self.assertEqual((status, headers["ETag"][0]), (200, '"'))
        self.assertIn("certificate", report)
        head = {"Range": "bytes=0-3"}
        status, headers, part = self.daemon.exchange("GET", f"/api/v1{root}/artifacts/surface.ply", None, head)
        self.assertEqual((status, part), (206, b"ply\n"))
        status, _, packed = self.ask("GET", root + "/package.zip")
        self.assertEqual(set(zipfile.ZipFile(io.BytesIO(packed)).namelist()), listed)

    def test_recompute_is_a_new_job_of_the_mesh(self):
        status, headers, job = self.ask("POST", f"/jobs/{self.job['id']}/recompute", {"params": {**PARAMS, "weave": {
            "pattern": "twill-2x2"}}})
        self.assertEqual((status, headers["Location"]), (201, f"/api/v1/jobs/{job['id']}"))
        self.assertEqual((job["state"], job["file"]["sha256"]), ("queued", self.blob))

    def test_an_impossible_parameter_is_refused_by_its_whole_path(self):
        answer = self.ask("POST", "/jobs", {"blob": self.blob, "params": {"grid": {"strip_width_mm": 0}}})
        self.assert_problem(answer, 422, answer[2]["code"], "/grid/strip_width_mm")
        self.assertIn("grid.strip_width_mm: must be > 0", answer[2]["detail"])


class Cuts(CutsOf):
    def test_from_waiting_to_done_sheet_by_sheet(self):
        machine = Machine(self, "contract", 200)
        job = self.ready_job(self.post_job())
        status, headers, cut = self.ask("POST", f"/jobs/{job['id']}/cuts", {"device": "contract", "sheets": [1, 2]})
        self.assertEqual((status, cut["state"], cut["sheets"]), (201, "waiting", [1, 2]))
        path = headers["Location"].removeprefix("/api/v1")
        for call in ("start", "confirm-sheet"):
            cut = self.wait(path, lambda cut, call=call: call in cut["actions"])
            self.assertEqual(cut["program_sha256"], job["sheets"][cut["sheet"] - 1]["program_sha256"])
            consent = {"program_sha256": cut["program_sha256"], "bed_clear": True}
            for spoilt in ({**consent, "bed_clear": False}, {**consent, "program_sha256": "0" * 64}, {"bed_clear": True}):
                self.assertIn(self.ask("POST", f"{path}/{call}", spoilt)[0], (409, 422))
            self.assertEqual(self.ask("POST", f"{path}/{call}", consent)[0], 202)
            self.assertIn(self.get(path)["state"], CUT_STATES)
        self.reaches(path, "done")
        self.assertEqual(self.wait(f"/jobs/{job['id']}", lambda job: job["state"] == "done")["cuts"], [path.split("/")[-1]])
        self.assertIn(path.split("/")[-1], [cut["id"] for cut in self.get("/cuts")["cuts"]])
        self.assertGreater(machine.burnt_mm(), 0)

    def test_pause_resume_and_abort(self):
        machine = Machine(self, "held", 12)
        path = self.put_cut(machine, sheets=[1])
        self.burning(machine, path)
        for call, state in (("pause", "paused"), ("resume", "cutting"), ("abort", "aborted")):
            self.assertEqual(self.ask("POST", f"{path}/{call}")[0], 202)
            self.reaches(path, state)
        self.assertEqual(self.ask("POST", f"{path}/resume")[0], 409)

    def test_sheets_spread_over_the_machines_that_take_them(self):
        for name, bed in (("wide", [600, 400]), ("wide-too", [600, 400]), ("tiny", [50, 50])):
            Machine(self, name, 400)
            self.ask("PUT", f"/devices/{name}", {"uri": f"sim:grbl?speed=400&width={bed[0]}&height={bed[1]}", "bed_mm": bed})
            self.wait(f"/devices/{name}", lambda device: device["status"]["state"] == "idle")
        status, _, made = self.ask("POST", f"/jobs/{self.job['id']}/cuts", {"devices": ["wide", "wide-too", "tiny"]})
        self.assertEqual(status, 201, made)
        self.assertEqual(sorted(cut["device"] for cut in made["cuts"]), ["wide", "wide-too"])
        self.assertEqual(sorted(cut["sheets"] for cut in made["cuts"]), [[1], [2]])
        for cut in made["cuts"]:
            self.fire(f"/cuts/{cut['id']}")
        for cut in made["cuts"]:
            self.reaches(f"/cuts/{cut['id']}", "done")
        self.assertEqual(self.ask("POST", f"/jobs/{self.job['id']}/cuts", {"devices": ["tiny"]})[0], 409)


class Machines(CutsOf):
    def test_machines_come_change_and_go(self):
        fields = {"name": "One", "uri": "sim:grbl"}
        self.assertEqual([self.ask("PUT", "/devices/one", fields)[0] for _ in range(2)], [201, 200])
        self.assertIn("one", [device["id"] for device in self.get("/devices")["devices"]])
        self.wait("/devices/one", lambda device: device["status"]["state"] == "idle")
        for command in ({"command": "home"}, {"command": "unlock"}, {"command": "jog", "dx_mm": 1, "dy_mm": 1}, {"command": "hold"},
                        {"command": "resume"}, {"command": "console", "line": "$I"}, {"command": "stop"}, {"command": "reset"}):
            self.assertEqual(self.ask("POST", "/devices/one/commands", command)[0], 202, command)
        self.assertIn(self.ask("POST", "/devices/one/commands", {"command": "frame"})[0], (202, 409))
        self.assert_problem(self.ask("POST", "/devices/one/commands", {"command": "fire"}), 422, "bad-field", "/command")
        self.assertEqual(self.ask("DELETE", "/devices/one")[0], 204)
        self.assertEqual(self.ask("GET", "/devices/one")[0], 404)
        self.assertIsInstance(self.get("/ports")["ports"], list)

    def test_materials_and_stock(self):
        material = {"like": "paper-160-blue", "name": "Mine", "kerf_mm": 0.12, "thickness_mm": 0.3}
        sheet = {"material": "mine", "width_mm": 300, "height_mm": 200, "quantity": 2}
        for path, entry, kept in (("/materials/mine", material, "kerf_mm"), ("/stock/drawer", sheet, "quantity")):
            self.assertEqual([self.ask("PUT", path, entry)[0] for _ in range(2)], [201, 200])
            self.assertEqual(self.get(path)[kept], entry[kept])
        self.assertEqual([self.ask("DELETE", path)[0] for path in ("/stock/drawer", "/materials/mine", "/stock/drawer")],
                         [204, 204, 404])
        for part in ("cut", "score", "engrave"):
            self.assertIn(part, self.get("/materials/paper-160-blue"))


class Watching(CutsOf):
    def stream(self, path, headers=None):
        link = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=10)
        self.addCleanup(link.close)
        link.request("GET", "/api/v1" + path, headers=headers or {})
        answer = link.getresponse()
        self.assertEqual((answer.status, answer.getheader("Content-Type").split(";")[0]), (200, "text/event-stream"))
        return answer

    def test_events_of_all_and_of_one_job(self):
        everything, one = self.stream("/events"), self.stream(f"/jobs/{self.job['id']}/events")
        other = self.post_job()
        self.ask("PATCH", f"/jobs/{self.job['id']}", {"name": "told.off"})
        seen = self.until(everything, lambda line: other["id"].encode() in line)
        self.assertTrue(any(line.startswith(b"id: ") for line in seen))
        seen = self.until(one, lambda line: b"told.off" in line)
        self.assertFalse(any(other["id"].encode() in line for line in seen))
        last = max(int(line[4:]) for line in seen if line.startswith(b"id: "))
        again = self.stream("/events", {"Last-Event-ID": str(last - 1)})
        self.assertIn(b"id: %d\n" % last, self.until(again, lambda line: line == b"id: %d\n" % last))

    def until(self, stream, condition):
        seen = []
        while not seen or not condition(seen[-1]):
            seen.append(stream.readline())
        return seen

    def test_operations_answer_at_the_root_and_below_it(self):
        for path in ("/healthz", "/readyz", "/metrics"):
            for root in ("", "/api/v1"):
                self.assertEqual(self.daemon.call("GET", root + path)[0], 200, root + path)
        self.assertIn("version", self.get("/version"))
        self.assertTrue(self.get("/openapi.json")["openapi"].startswith("3.1"))

    def test_problems_are_problems(self):
        for method, path, status in (("GET", "/nothing", 404), ("POST", "/version", 405), ("GET", "/jobs/j_none", 404),
                                     ("POST", "/jobs", 422)):
            answer = self.ask(method, path, {} if method == "POST" else None)
            self.assertEqual(answer[0], status, path)
            self.assertEqual(answer[1]["Content-Type"], "application/problem+json")
            self.assertLessEqual({"type", "title", "status", "detail"}, set(answer[2]))


if __name__ == "__main__":
    unittest.main()
