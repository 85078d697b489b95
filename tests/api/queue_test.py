"""The queue of jobs, the stock and the presets through the API."""
import json
import tempfile
import unittest
from pathlib import Path

from daemon import Daemon, form, free_port

REMNANT = {"material": "paper-160-blue", "width_mm": 200, "height_mm": 300, "quantity": 2,
           "note": "top drawer"}


class QueueTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.daemon = Daemon(Path(self.folder.name) / "state", free_port())

    def tearDown(self):
        self.daemon.kill()
        self.folder.cleanup()

    def call(self, method, path, body=None, status=200):
        text = None if body is None else json.dumps(body)
        got, answer = self.daemon.call(method, "/api/v1" + path, text,
                                       {"Content-Type": "application/json"})
        self.assertEqual(got, status, answer)
        return json.loads(answer) if answer else None

    def submit(self, name, params=None, status=201):
        body, headers = form(name, name, params)
        got, answer = self.daemon.call("POST", "/api/v1/jobs", body, headers)
        self.assertEqual(got, status, answer)
        return json.loads(answer)

    def order(self):
        return [job["name"] for job in self.call("GET", "/queue")["next"]]

    def wait_for_end(self, job):
        with self.daemon.events() as events:
            def over(kind, data):
                return data.get("id") == job["id"] and data.get("job", {}).get("state") in (
                    "failed", "ready", "cancelled")
            now = self.call("GET", "/jobs/" + job["id"])
            return now if now["state"] == "failed" else events.until(over, 60)["job"]

    def test_a_paused_queue_keeps_an_order_that_operators_change(self):
        self.assertTrue(self.call("POST", "/queue/pause", {"reason": "lunch"})["paused"])
        jobs = {name: self.submit(name) for name in "abcd"}
        self.assertEqual(self.order(), list("abcd"))
        self.call("PATCH", "/jobs/" + jobs["d"]["id"], {"position": 1})
        self.assertEqual(self.order(), list("dabc"))
        self.call("PATCH", "/jobs/" + jobs["a"]["id"], {"position": 3})
        self.assertEqual(self.order(), list("dbac"))
        changed = self.call("PATCH", "/jobs/" + jobs["c"]["id"], {"priority": 5})
        self.assertEqual(changed["priority"], 5)
        self.assertEqual(self.order(), list("cdba"))
        self.call("PATCH", "/jobs/" + jobs["c"]["id"], {"position": 99})
        self.assertEqual(self.order(), list("dbac"))
        self.call("PATCH", "/jobs/" + jobs["c"]["id"], {"name": "late"})
        self.assertEqual(self.order()[-1], "late")
        self.assertEqual(self.call("GET", "/queue")["reason"], "lunch")
        self.call("PATCH", "/jobs/" + jobs["c"]["id"], {"priority": "high"}, 422)
        self.call("PATCH", "/jobs/" + jobs["c"]["id"], {"state": "done"}, 422)

    def test_a_pause_survives_a_restart_and_ends_by_resume(self):
        self.call("POST", "/queue/pause", {})
        job = self.submit("waits")
        state, port = Path(self.folder.name) / "state", self.daemon.port
        self.daemon.kill()
        self.daemon = Daemon(state, port)
        self.assertTrue(self.call("GET", "/queue")["paused"])
        self.assertEqual(self.call("GET", "/jobs/" + job["id"])["state"], "queued")
        self.call("POST", "/queue/resume")
        self.assertNotEqual(self.wait_for_end(job)["state"], "queued")

    def test_a_cancelled_job_is_tried_again_with_its_cause(self):
        self.call("POST", "/queue/pause", {})
        job = self.submit("again")
        self.call("POST", f"/jobs/{job['id']}/retry", {}, 409)
        self.assertEqual(self.call("DELETE", "/jobs/" + job["id"])["state"], "cancelled")
        tried = self.call("POST", f"/jobs/{job['id']}/retry", {"cause": "wrong button"}, 202)
        self.assertEqual((tried["state"], tried["retries"], tried["retry_cause"]),
                         ("queued", 1, "wrong button"))
        self.assertEqual(self.order(), ["again"])

    def test_stock_is_kept_checked_and_taken_over_as_json(self):
        added = self.call("PUT", "/stock/left-1", REMNANT, 201)
        self.assertEqual((added["quantity"], added["note"], added["kind"]), (2, "top drawer", "sheet"))
        self.assertEqual(self.call("PUT", "/stock/left-1", {**REMNANT, "quantity": 3})["quantity"], 3)
        self.call("PUT", "/stock/left-2", {**REMNANT, "material": "gold"}, 422)
        self.call("PUT", "/stock/left-2", {"width_mm": 10}, 422)
        exported = self.call("GET", "/stock")
        self.call("DELETE", "/stock/left-1", status=204)
        self.call("GET", "/stock/left-1", status=404)
        self.assertEqual(self.call("POST", "/stock", exported)["stock"][0]["quantity"], 3)
        broken = {"stock": [REMNANT | {"id": "new"}, {"id": "bad"}]}
        self.call("POST", "/stock", broken, 422)
        self.call("GET", "/stock/new", status=404)

    def test_jobs_take_what_the_store_has(self):
        self.call("POST", "/queue/pause", {})
        self.submit("unknown", {"nesting": {"stock": ["left-1"]}}, 422)
        self.call("PUT", "/stock/left-1", REMNANT, 201)
        self.submit("known", {"nesting": {"stock": ["left-1"]}})
        self.submit("all", {"nesting": {"stock": "store"}})
        self.submit("wrong", {"nesting": {"stock": "shop"}}, 422)

    def test_presets_are_built_in_changed_and_own(self):
        shown = {each["id"]: each for each in self.call("GET", "/presets")["presets"]}
        self.assertIn("paper-two-colours", shown)
        for preset in shown.values():
            self.submit("preset-" + preset["id"], preset["params"])
        self.call("PUT", "/presets/mine", {"params": {"grid": {"strip_width_mm": -1}}}, 422)
        mine = {"name": "Mine", "params": {"grid": {"strip_width_mm": 7}}}
        self.assertEqual(self.call("PUT", "/presets/mine", mine, 201)["origin"], "own")
        self.assertEqual(self.call("PUT", "/presets/card", mine)["origin"], "changed")
        self.call("DELETE", "/presets/card", status=204)
        self.assertEqual(self.call("GET", "/presets/card")["origin"], "built-in")
        self.call("DELETE", "/presets/card", status=409)
        exported = self.call("GET", "/presets")
        self.call("DELETE", "/presets/mine", status=204)
        self.call("POST", "/presets", exported)
        self.assertEqual(self.call("GET", "/presets/mine")["name"], "Mine")

    def test_materials_are_taken_over_as_json(self):
        felt = self.call("GET", "/materials/felt-1")
        self.call("PUT", "/materials/house-felt", {**felt, "id": "house-felt", "kerf_mm": 0.3}, 201)
        exported = self.call("GET", "/materials")
        self.call("DELETE", "/materials/house-felt", status=204)
        self.call("POST", "/materials", exported)
        self.assertEqual(self.call("GET", "/materials/house-felt")["kerf_mm"], 0.3)

    def test_backups_and_retention(self):
        self.assertEqual(self.call("PUT", "/retention", {"backups_kept": 2})["backups_kept"], 2)
        names = [self.call("POST", "/backups", status=201)["name"] for _ in range(3)]
        kept = [each["name"] for each in self.call("GET", "/backups")["backups"]]
        self.assertEqual(kept, sorted(names, reverse=True)[:2])
        self.call("PUT", "/retention", {"jobs_days": -1}, 422)


if __name__ == "__main__":
    unittest.main()
