#!/usr/bin/env python3
"""What a workshop does around its jobs: test cards that are cut, the steps before a beam comes on,
offcuts that go back into the stock. Usage: workshop_test.py LEAFCUTTER"""
import collections
import json
import re
import unittest

from cuts_test import PARAMS, CutsOf, Machine


def segments(machine):
    return [piece for piece in map(json.loads, machine.log.read_text().splitlines()) if piece["s"] > 0]


class TestCards(CutsOf):
    def card(self, **wish):
        status, headers, job = self.ask("POST", "/test-cards", {"material": "plywood-0.8", **wish})
        self.assertEqual((status, job["state"]), (201, "ready"), job)
        self.assertEqual(headers["Location"], f"/api/v1/jobs/{job['id']}")
        return job

    def cut(self, machine, job):
        path = self.put_cut(machine, job)
        self.fire(path)
        self.reaches(path, "done", seconds=25)
        self.assertEqual(self.get(f"/jobs/{job['id']}")["state"], "done")
        self.wait(machine.path, lambda device: device["cut"] is None)
        self.assertEqual(self.ask("DELETE", machine.path)[0], 204)  # Its log is whole then.
        return segments(machine)

    def test_a_kerf_test_is_cut_with_no_kerf_counted(self):
        job = self.card(kind="kerf", cells=4, cell_mm=10)
        material = self.get("/materials/plywood-0.8")
        burnt = self.cut(Machine(self, "kerf", 400), job)
        full = material["cut"]["power_percent"] * 10
        upright = collections.Counter()
        for piece in burnt:
            if abs(piece["s"] - full) < 1e-6 and abs(piece["x0"] - piece["x1"]) < 1e-6:
                upright[round(piece["x0"], 2)] += abs(piece["y1"] - piece["y0"])
        lines = {x: length for x, length in upright.items() if length > 9}
        # The window's sides and what parts its cells, exactly a cell apart.
        self.assertEqual(len(lines), 5, upright)
        steps = sorted(lines)
        self.assertEqual([round(b - a, 2) for a, b in zip(steps, steps[1:])], [10.0] * 4)
        passes = material["cut"]["passes"]
        for length in lines.values():
            self.assertAlmostEqual(length, 10 * passes, delta=0.1)

    def test_every_cell_of_a_grid_is_burnt_with_its_own_power_and_feed(self):
        job = self.card(kind="power", operation="cut", power_percent=[20, 80], feed_mm_per_min=[600, 1800],
                        powers=3, feeds=2, passes=2, cell_mm=5, name="grid")
        self.assertEqual(job["name"], "grid")
        program = self.get(f"/jobs/{job['id']}/artifacts/sheets/sheet-001.gcode").decode()
        feed, power, cells = None, None, collections.Counter()
        for line in program.splitlines():
            feed = float(found.group(1)) if (found := re.search(r"F([0-9.]+)", line)) else feed
            power = float(found.group(1)) if (found := re.search(r"S([0-9.]+)", line)) else power
            if line.startswith("G1"):
                cells[power, feed] += 1
        for cell in ((s, f) for s in (200, 500, 800) for f in (600, 1800)):
            self.assertEqual(cells[cell], 8, cells)  # Four sides, twice.
        burnt = self.cut(Machine(self, "grid", 400), job)
        length = collections.Counter()
        for piece in burnt:
            if round(piece["s"]) in (200, 500, 800):
                length[round(piece["s"])] += abs(piece["x1"] - piece["x0"]) + abs(piece["y1"] - piece["y0"])
        for power in (200, 500, 800):
            self.assertAlmostEqual(length[power], 2 * 2 * 4 * 5, delta=0.5)

    def test_cards_of_every_operation_keep_to_their_material(self):
        for operation in ("score", "engrave"):
            job = self.card(kind="power", operation=operation, powers=2, feeds=2, cell_mm=4)
            self.assertEqual(job["summary"]["test"], "power")
            self.assertNotIn("recompute", job["actions"])
        wrong = "bad-parameter"
        for wish, code, pointer in (({"kind": "burn"}, wrong, "/kind"),
                                    ({"kind": "kerf", "material": "gold"}, wrong, "/material"),
                                    ({"kind": "power", "powers": 0}, wrong, "/powers"),
                                    ({"kind": "power", "cell_mm": 50, "powers": 20, "feeds": 20}, "too-large", None),
                                    ({"kind": "kerf", "speed": 1}, wrong, "/speed"),
                                    ({"kind": "power", "power_percent": [10, 101]}, wrong, "/power_percent/1")):
            with self.subTest(wish=wish):
                answer = self.ask("POST", "/test-cards", {"material": "plywood-0.8", **wish})
                self.assert_problem(answer, 422, code, pointer)
        self.assert_problem(self.ask("POST", f"/jobs/{job['id']}/recompute", {}), 409, "no-mesh")


class Steps(CutsOf):
    def steps(self, path):
        return self.get(path)["steps"]

    def names(self, path):
        return [each["step"] for each in self.steps(path)]

    def test_steps_lead_from_sheet_to_sheet(self):
        machine = Machine(self, "steps", 400)
        job = self.ready_job(self.post_job())
        path = self.put_cut(machine, job)
        self.assertEqual(self.names(path), ["load-sheet", "frame", "bed-clear", "start"])
        load, frame = self.steps(path)[:2]
        first = job["sheets"][0]
        self.assertEqual((load["sheet"], load["material"], load["size_mm"]), (1, first["material"], first["size_mm"]))
        self.assertEqual((frame["required"], frame["done"]), (False, False))
        self.assertEqual(machine.command("frame")[0], 202)
        self.wait(path, lambda cut: cut["steps"][1]["done"])
        self.assertEqual(machine.until("idle")["status"]["power_s"], 0)
        self.fire(path)
        self.reaches(path, "awaiting-sheet")
        self.assertEqual(self.names(path), ["remove-sheet", "load-sheet", "frame", "bed-clear", "confirm-sheet"])
        steps = self.steps(path)
        self.assertEqual((steps[0]["sheet"], steps[1]["sheet"], steps[2]["done"]), (1, 2, False))
        self.fire(path, "confirm-sheet")
        self.reaches(path, "done")
        self.assertEqual(self.steps(path), [])


class Offcuts(CutsOf):
    def test_what_a_cut_leaves_is_in_stock_and_feeds_the_next_job(self):
        self.ask("PUT", "/stock/large", {"material": "paper-160-blue", "width_mm": 600, "height_mm": 400, "quantity": 1})
        params = {**PARAMS, "material": {"warp": "paper-160-blue", "weft": "paper-160-blue"},
                  "nesting": {"time_s": 0.1, "stock": "store", "only_stock": True}}
        job = self.ready_job(self.post_job(params=params))
        self.assertEqual([sheet["stock"] for sheet in job["sheets"]], ["large"], job["error"])
        self.assertEqual(self.get("/stock/large")["planned"], 1)
        machine = Machine(self, "offcuts", 400)
        path = self.put_cut(machine, job)
        self.assertEqual(self.get(path)["steps"][0]["stock"], "large")
        self.fire(path)
        self.reaches(path, "done")
        stock = self.get("/stock")["stock"]
        self.assertEqual([(each["kind"], each["from_job"], each["material"]) for each in stock],
                         [("remnant", job["id"], "paper-160-blue")], stock)
        left = stock[0]["id"]
        # Nothing else is at hand: the next job is cut from it, and leaves what is left of it.
        second = self.ready_job(self.post_job(params=params))
        self.assertEqual([sheet["stock"] for sheet in second["sheets"]], [left], second["error"])
        # What is planned for one job is no longer there for others.
        third = self.ask("POST", "/jobs", {"blob": self.blob, "name": "third", "params": params})
        self.assert_problem(third, 422, "bad-parameter", "/nesting/only_stock")
        path = self.put_cut(machine, second)
        self.fire(path)
        self.reaches(path, "done")
        ids = [each["id"] for each in self.get("/stock")["stock"]]
        self.assertNotIn(left, ids)
        for each in self.get("/stock")["stock"]:
            self.assertEqual(each["from_job"], second["id"])


if __name__ == "__main__":
    unittest.main()
