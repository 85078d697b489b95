#!/usr/bin/env python3
"""Materials and recut, on the command line and through the API of the real daemon.
Usage: recut_test.py LEAFCUTTER"""
import json
import subprocess
import tempfile
import unittest
import zipfile
from pathlib import Path

from cuts_test import PARAMS, PLATE, Served
from daemon import BINARY

OWN = {"id": "paper-mine", "like": "paper-160-white", "kerf_mm": 0.25,
       "sheets": [{"width_mm": 300, "height_mm": 200, "price": 0.5}]}


def run(*arguments):
    done = subprocess.run([BINARY, *map(str, arguments)], capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout, done.stderr


def outlines(strips):
    return {piece["id"]: piece["outline"] for piece in strips["pieces"]}


class CommandLine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = Path(cls.folder.name)
        (cls.root / "plate.off").write_bytes(PLATE)
        (cls.root / "materials.json").write_text(json.dumps([OWN]))
        (cls.root / "params.json").write_text(json.dumps({**PARAMS, "material": {"weft": "paper-mine"}}))
        status, _, error = run("weave", cls.root / "plate.off", "-o", cls.root / "plate", "--params",
                               cls.root / "params.json", "--materials", cls.root / "materials.json")
        assert status == 0, error

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def read(self, path):
        return json.loads((self.root / path).read_text())

    def test_weaves_from_materials_of_a_file(self):
        sheets = self.read("plate/layout.json")["sheets"]
        own = [sheet for sheet in sheets if sheet["material"] == "paper-mine"]
        self.assertTrue(own)
        self.assertEqual({(sheet["width_mm"], sheet["height_mm"]) for sheet in own}, {(300, 200)})
        bill = {line["material"]: line for line in self.read("plate/report.json")["bill"]}
        self.assertEqual(bill["paper-mine"]["cost"], 0.5 * len(own))
        table = (self.root / "plate/bill.csv").read_text()
        self.assertEqual(len(table.splitlines()), 1 + len(bill))

    def test_lists_materials_and_takes_its_own_list(self):
        status, text, _ = run("materials", "--json", "--materials", self.root / "materials.json")
        self.assertEqual(status, 0)
        ids = [material["id"] for material in json.loads(text)["materials"]]
        self.assertIn("paper-mine", ids)
        (self.root / "all.json").write_text(text)
        self.assertEqual(run("materials", "--json", "--materials", self.root / "all.json")[1], text)
        self.assertIn("paper-mine", run("materials", "--materials", self.root / "materials.json")[1])

    def test_refuses_bad_materials_in_one_line(self):
        (self.root / "bad.json").write_text('[{"id": "x", "like": "felt-1", "kerf_mm": -1}]')
        status, _, error = run("materials", "--materials", self.root / "bad.json")
        self.assertEqual((status, error), (2, "leafcutter: materials[0].kerf_mm: must be >= 0\n"))

    def test_recuts_pieces_with_the_same_outlines(self):
        out = self.root / "again"
        status, _, error = run("recut", self.root / "plate", "W1.1", "P2", "-o", out, "--sheet", "297x210")
        self.assertEqual((status, error), (0, ""))
        again, whole = outlines(self.read("again/strips.json")), outlines(self.read("plate/strips.json"))
        self.assertEqual(sorted(again), ["P2.1", "W1.1"])
        for piece, outline in again.items():
            self.assertEqual(outline, whole[piece])
        self.assertEqual({path.name for path in (out / "sheets").iterdir()},
                         {f"sheet-00{n}.{kind}" for n in (1, 2) for kind in ("svg", "dxf", "gcode")})
        self.assertIn("W1.1", (out / "recut.html").read_text())
        self.assertEqual(run("audit", out)[0], 0)

    def test_reads_archives_and_refuses_broken_ones(self):
        archive = self.root / "plate.zip"
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
            for name in ("report.json", "strips.json", "layout.json"):
                packed.write(self.root / "plate" / name, f"plate/{name}")
        self.assertEqual(run("recut", archive, "W1.1", "-o", self.root / "unzipped")[0], 0)
        whole = outlines(self.read("plate/strips.json"))
        self.assertEqual(outlines(self.read("unzipped/strips.json")), {"W1.1": whole["W1.1"]})
        content = archive.read_bytes()
        for damaged in (content[:-40], content[:500] + b"x" * 800 + content[1300:], b"PK"):
            archive.write_bytes(damaged)
            status, _, error = run("recut", archive, "all", "-o", self.root / "no")
            self.assertEqual((status, error.count("\n")), (2, 1))

    def test_recuts_onto_a_remnant(self):
        (self.root / "remnant.json").write_text("[[0, 0], [200, 0], [0, 200]]")
        out = self.root / "remnant"
        status, _, error = run("recut", self.root / "plate", "W1", "-o", out, "--remnant", self.root / "remnant.json")
        self.assertEqual((status, error), (0, ""))
        (sheet,) = self.read("remnant/layout.json")["sheets"]
        self.assertEqual(sheet["outline"], [[0, 0], [200, 0], [0, 200]])

    def test_a_file_of_materials_replaces_those_of_the_package(self):
        (self.root / "other.json").write_text(json.dumps(
            [{**OWN, "sheets": [{"width_mm": 222, "height_mm": 111}]}]))
        status, _, error = run("recut", self.root / "plate", "W1", "-o", self.root / "other", "--materials",
                               self.root / "other.json")
        self.assertEqual((status, error), (0, ""))
        (sheet,) = self.read("other/layout.json")["sheets"]
        self.assertEqual((sheet["width_mm"], sheet["height_mm"]), (222, 111))

    def test_refusals_name_piece_and_package(self):
        package = str(self.root / "plate")
        status, _, error = run("recut", package, "W11.1", "-o", self.root / "no")
        self.assertEqual(status, 2)
        self.assertIn(f"{package}: has no piece or strip W11.1; the nearest are W1.1", error)
        status, _, error = run("recut", package, "W1.1", "-o", self.root / "no", "--sheet", "12x12")
        self.assertEqual(status, 2)
        self.assertIn("W1.1", error)
        for wrong in ("12", "12x", "x12", "0x5", "5x5x5"):
            self.assertEqual(run("recut", package, "W1.1", "-o", self.root / "no", "--sheet", wrong)[0], 2)
        self.assertEqual(run("recut", self.root / "nothing", "W1.1", "-o", self.root / "no")[0], 2)
        self.assertFalse((self.root / "no").exists())


class Api(Served):
    def recut(self, job, wish):
        status, headers, made = self.ask("POST", f"/jobs/{job['id']}/recut", wish)
        self.assertEqual(status, 201, made)
        self.assertEqual(headers["Location"], f"/api/v1/jobs/{made['id']}")
        return self.wait(f"/jobs/{made['id']}", lambda job: job["state"] not in ("queued", "computing"))

    def test_materials_are_added_changed_and_removed(self):
        built_in = self.get("/materials/felt-1")
        self.assertEqual(built_in["origin"], "built-in")
        status, _, made = self.ask("PUT", "/materials/paper-mine", {"like": "paper-160-white", "kerf_mm": 0.3})
        self.assertEqual((status, made["origin"], made["kerf_mm"]), (201, "own", 0.3))
        status, _, changed = self.ask("PUT", "/materials/felt-1", {**built_in, "kerf_mm": 0.4})
        self.assertEqual((status, changed["origin"]), (200, "changed"))
        self.assertEqual(changed, {**built_in, "kerf_mm": 0.4, "origin": "changed"})
        ids = [material["id"] for material in self.get("/materials")["materials"]]
        self.assertEqual(len(ids), len(set(ids)))
        self.assertIn("paper-mine", ids)
        status, _, problem = self.ask("PUT", "/materials/bad", {"like": "felt-1", "sheets": []})
        self.assertEqual((status, problem["detail"]), (422, "sheets: must hold at least one size"))
        self.assertEqual(self.ask("PUT", "/materials/bad", {"like": "felt-1", "id": "other"})[0], 422)
        self.assertEqual(self.ask("PUT", "/materials/b@d", {"like": "felt-1"})[0], 422)
        for path, status in (("felt-1", 204), ("felt-1", 409), ("paper-mine", 204), ("paper-mine", 404)):
            self.assertEqual(self.ask("DELETE", f"/materials/{path}")[0], status, path)
        self.assertEqual(self.get("/materials/felt-1"), built_in)

    def test_jobs_are_made_of_stored_materials(self):
        self.ask("PUT", "/materials/small", {"like": "paper-160-red", "sheets": [{"width_mm": 250, "height_mm": 180}]})
        job = self.ready_job(self.post_job(params={**PARAMS, "material": {"warp": "small", "weft": "small"}}))
        self.assertEqual(job["state"], "ready", job)
        self.assertEqual({sheet["material"] for sheet in job["sheets"]}, {"small"})
        self.ask("DELETE", "/materials/small")
        # The package knows what it was made of.
        again = self.recut(job, {"pieces": ["W1.1"]})
        self.assertEqual(again["state"], "ready", again)
        layout = self.get(f"/jobs/{again['id']}/artifacts/layout.json")
        self.assertEqual((layout["sheets"][0]["width_mm"], layout["sheets"][0]["height_mm"]), (250, 180))

    def test_recut_is_a_job_that_can_be_cut(self):
        path = f"/jobs/{self.job['id']}"
        self.assertIn("recut", self.job["actions"])
        job = self.recut(self.job, {"pieces": ["W1.1", "P1.1"], "sheet": {"width_mm": 210, "height_mm": 148}})
        self.assertEqual((job["state"], job["recut_of"]), ("ready", self.job["id"]), job)
        whole = outlines(self.get(f"{path}/artifacts/strips.json"))
        pieces = outlines(self.get(f"/jobs/{job['id']}/artifacts/strips.json"))
        self.assertEqual(pieces, {piece: whole[piece] for piece in ("W1.1", "P1.1")})
        self.assertEqual(len(job["sheets"]), 2)
        status, _, device = self.ask("PUT", "/devices/recutter", {"uri": "sim:grbl?speed=200"})
        self.assertEqual(status, 201, device)
        status, _, cut = self.ask("POST", f"/jobs/{job['id']}/cuts", {"device": "recutter", "sheets": [1]})
        self.assertEqual(status, 201, cut)
        cut = self.wait(f"/cuts/{cut['id']}", lambda cut: "start" in cut["actions"])
        status, _, cut = self.ask("POST", f"/cuts/{cut['id']}/start", {
            "program_sha256": job["sheets"][0]["program_sha256"], "bed_clear": True})
        self.assertIn(status, (200, 202), cut)
        self.wait(f"/cuts/{cut['id']}", lambda cut: cut["state"] == "done", seconds=60.0)
        # What the daemon hands out, the command line can cut again.
        archive = Path(self.folder.name) / "pieces.zip"
        archive.write_bytes(self.ask("GET", f"/jobs/{job['id']}/package.zip")[2])
        out = Path(self.folder.name) / "pieces"
        self.assertEqual(run("recut", archive, "P1.1", "-o", out), (0, "", ""))
        self.assertEqual(outlines(json.loads((out / "strips.json").read_text())), {"P1.1": pieces["P1.1"]})

    def test_recut_refuses_what_cannot_be(self):
        path = f"/jobs/{self.job['id']}/recut"
        for body, status in (({}, 422), ({"pieces": []}, 422), ({"pieces": ["W99.9"]}, 422),
                             ({"pieces": ["W1.1"], "material": "tin"}, 422),
                             ({"pieces": ["W1.1"], "colour": 1}, 422)):
            answer = self.ask("POST", path, body)
            self.assertEqual(answer[0], status, (body, answer[2]))
        self.assertIn("the nearest are", self.ask("POST", path, {"pieces": ["W99.9"]})[2]["detail"])
        self.assertEqual(self.ask("POST", "/jobs/j_nothing/recut", {"pieces": ["W1.1"]})[0], 404)
        small = self.recut(self.job, {"pieces": ["W1.1"], "sheet": {"width_mm": 9, "height_mm": 9}})
        self.assertEqual((small["state"], small["error"]["kind"]), ("failed", "bad-option"))
        self.assertIn("9 x 9 mm", small["error"]["detail"])

    def test_recut_is_asked_for_once_however_often_it_is_sent(self):
        path, wish = f"/jobs/{self.job['id']}/recut", {"pieces": ["W1.1"]}
        key = {"Idempotency-Key": "again"}
        first = self.ask("POST", path, wish, key)[2]
        self.assertEqual(self.ask("POST", path, wish, key)[2]["id"], first["id"])
        self.assertEqual(self.ask("POST", path, {"pieces": ["P1.1"]}, key)[0], 422)

    def test_recut_waits_behind_no_model(self):
        slow = {**PARAMS, "grid": {"rows": 40, "cols": 40}, "nesting": {"time_s": 600}}
        models = [self.post_job(name=f"slow {i}.off", params=slow) for i in range(2)]
        try:
            self.wait(f"/jobs/{models[0]['id']}", lambda job: job["state"] == "computing")
            self.assertEqual(self.recut(self.job, {"pieces": ["W1.1"]})["state"], "ready")
            self.assertEqual([self.get(f"/jobs/{job['id']}")["state"] for job in models], ["computing", "queued"])
        finally:
            for job in models:
                self.ask("DELETE", f"/jobs/{job['id']}")

    def test_recut_of_a_job_that_is_gone_fails(self):
        source = self.ready_job(self.post_job(name="short lived.off"))
        self.ask("POST", "/queue/pause", {})
        try:
            again = self.ask("POST", f"/jobs/{source['id']}/recut", {"pieces": ["W1.1"]})[2]
            self.assertEqual(again.get("state"), "queued", again)
            self.assertEqual(self.ask("DELETE", f"/jobs/{source['id']}")[0], 204)
        finally:
            self.ask("POST", "/queue/resume", {})
        failed = self.wait(f"/jobs/{again['id']}", lambda job: job["state"] not in ("queued", "computing"))
        self.assertEqual((failed["state"], failed["error"]["code"]), ("failed", "no-package"))


if __name__ == "__main__":
    unittest.main()
