#!/usr/bin/env python3
"""What HTTP promises: pages, tags, ranges, replay of events, large bodies in flat memory. Usage: http_test.py LEAFCUTTER
LEAFCUTTER_UPLOAD_MB: size of the large upload; 64 if not given."""
import hashlib
import http.client
import io
import json
import os
import tempfile
import threading
import unittest
import zipfile

from daemon import Daemon, form, free_port

AS_JSON = {"Content-Type": "application/json"}
QUICK = {"nesting": {"time_s": 0.5}}


class Http(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.daemon = Daemon(cls.folder.name, free_port())
        cls.job = cls.ready_job("first")

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        cls.folder.cleanup()
        assert status == 0, status

    @classmethod
    def ready_job(cls, name):
        with cls.daemon.events() as events:
            job = json.loads(cls.daemon.call("POST", "/api/v1/jobs", *form(name, name, QUICK))[1])["id"]
            assert events.until(lambda kind, data: kind == "job" and data["job"]["id"] == job
                                and data["job"]["state"] == "ready", 60)
        return job

    def get(self, path, headers=None):
        status, headers, body = self.daemon.exchange("GET", "/api/v1" + path, None, headers)
        self.assertEqual(status, 200, body)
        return headers, json.loads(body)


class Pages(Http):
    def test_every_list_is_the_same_page_by_page(self):
        for name in ("a", "b"):
            self.daemon.call("POST", "/api/v1/jobs", *form(name, name, QUICK))
        for _ in range(3):
            self.daemon.call("POST", f"/api/v1/jobs/{self.job}/cuts", '{"device": "sim"}', AS_JSON)
        for path, field, key in (("/jobs", "jobs", "id"), ("/cuts", "cuts", "id"), ("/devices", "devices", "id"),
                                 ("/materials", "materials", "id"), ("/presets", "presets", "id"),
                                 ("/stock", "stock", "id"), ("/users", "users", "name"), ("/keys", "keys", "id"),
                                 ("/audit", "entries", "seq"), (f"/jobs/{self.job}/artifacts", "artifacts", "path")):
            with self.subTest(path=path):
                whole = [item[key] for item in self.get(path + "?limit=200")[1][field]]
                pages, cursor = [], ""
                while cursor is not None:
                    page = self.get(f"{path}?limit=2{cursor}")[1]
                    self.assertLessEqual(len(page[field]), 2)
                    pages += [item[key] for item in page[field]]
                    cursor = page["next_cursor"] and f"&cursor={page['next_cursor'].replace('/', '%2F')}"
                self.assertEqual(pages, whole)

    def test_a_cursor_that_is_none_is_refused(self):
        self.assertEqual(self.daemon.call("GET", "/api/v1/jobs?cursor=x")[0], 400)
        self.assertEqual(self.daemon.call("GET", "/api/v1/devices?cursor=none-such")[0], 400)


class Tags(Http):
    def put(self, path, body, **headers):
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        return self.daemon.exchange("PUT", "/api/v1" + path, json.dumps(body), {**AS_JSON, **headers})

    def test_a_change_of_what_somebody_else_changed_is_refused(self):
        machine = {"uri": "sim:grbl", "name": "one"}
        sheet = {"material": "paper-160-blue", "width_mm": 300, "height_mm": 200, "quantity": 2}
        material = {"like": "paper-160-blue", "name": "mine"}
        for path, first, second in (("/devices/tagged", machine, {**machine, "name": "two"}),
                                    ("/stock/tagged", sheet, {**sheet, "quantity": 1}),
                                    ("/materials/tagged", material, {**material, "name": "other"})):
            with self.subTest(path=path):
                self.assertEqual(self.put(path, first, If_Match="*")[0], 412)
                status, headers, answer = self.put(path, first, If_None_Match="*")
                self.assertEqual(status, 201, answer)
                seen = headers["ETag"]
                self.assertEqual(self.get(path)[0]["ETag"], seen)
                self.assertEqual(self.put(path, first, If_None_Match="*")[0], 412)
                status, headers, _ = self.put(path, second, If_Match=seen)
                self.assertEqual(status, 200)
                self.assertNotEqual(headers["ETag"], seen)
                status, _, answer = self.put(path, first, If_Match=seen)
                self.assertEqual((status, json.loads(answer)["code"]), (412, "changed-meanwhile"))
                self.assertEqual(self.put(path, second, If_Match=f'"other", {headers["ETag"]}')[0], 200)

    def test_of_many_at_once_one_change_wins(self):
        self.put("/materials/contested", {"like": "paper-160-blue", "name": "at first"})
        seen = self.get("/materials/contested")[0]["ETag"]
        answers = []

        def change(number):
            body = {"like": "paper-160-blue", "name": f"number {number}"}
            answers.append(self.put("/materials/contested", body, If_Match=seen)[0])

        threads = [threading.Thread(target=change, args=(i,)) for i in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(answers), [200] + [412] * 7)


class Artifacts(Http):
    def test_ranges_are_the_parts_of_the_whole(self):
        path = f"/api/v1/jobs/{self.job}/artifacts/report.json"
        _, headers, whole = self.daemon.exchange("GET", path)
        size = len(whole)
        for spec, part in (("0-9", whole[:10]), ("5-", whole[5:]), ("-7", whole[-7:]),
                           (f"{size - 1}-{size + 100}", whole[-1:])):
            status, answer_headers, body = self.daemon.exchange("GET", path, None, {"Range": f"bytes={spec}"})
            self.assertEqual((status, body), (206, part), spec)
            self.assertTrue(answer_headers["Content-Range"].endswith(f"/{size}"))
        for spec in (f"{size}-", "9-2"):
            self.assertEqual(self.daemon.exchange("GET", path, None, {"Range": f"bytes={spec}"})[0], 416, spec)
        stale = {"Range": "bytes=0-9", "If-Range": '"stale"'}
        self.assertEqual(self.daemon.exchange("GET", path, None, stale)[2], whole)
        self.assertEqual(self.daemon.exchange("GET", path, None, {"If-None-Match": headers["ETag"]})[0], 304)

    def test_the_mesh_comes_back_as_it_was_sent(self):
        job = self.get(f"/jobs/{self.job}")[1]
        path = f"/api/v1/jobs/{self.job}/mesh"
        _, headers, mesh = self.daemon.exchange("GET", path)
        self.assertEqual(hashlib.sha256(mesh).hexdigest(), job["file"]["sha256"])
        self.assertIn(job["file"]["name"], headers["Content-Disposition"])
        self.assertEqual(self.daemon.exchange("GET", path, None, {"Range": "bytes=0-9"})[2], mesh[:10])
        self.assertEqual(self.daemon.exchange("GET", path, None, {"If-None-Match": headers["ETag"]})[0], 304)
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/jobs/nobody/mesh")[0], 404)

    def test_the_zip_is_the_package(self):
        _, _, body = self.daemon.exchange("GET", f"/api/v1/jobs/{self.job}/package.zip")
        with zipfile.ZipFile(io.BytesIO(body)) as package:
            self.assertIsNone(package.testzip())
            _, listed = self.get(f"/jobs/{self.job}/artifacts")
            self.assertEqual({i["path"] for i in listed["artifacts"]}, {n.split("/", 1)[-1] if n not in
                             {i["path"] for i in listed["artifacts"]} else n for n in package.namelist()})
            for item in listed["artifacts"][:5]:
                name = next(n for n in package.namelist() if n.endswith(item["path"]))
                self.assertEqual(hashlib.sha256(package.read(name)).hexdigest(), item["sha256"])


class Replay(Http):
    def replayed(self, last_seen):
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=20)
        try:
            connection.request("GET", "/api/v1/events", headers={"Last-Event-ID": str(last_seen)})
            stream = connection.getresponse()
            seqs = []
            while not seqs or seqs[-1] < self.last:
                line = stream.readline().decode()
                self.assertNotIn("snapshot", line.split(":")[-1] if line.startswith("event:") else "")
                if line.startswith("id: "):
                    seqs.append(int(line[4:]))
            return seqs
        finally:
            connection.close()

    def test_whoever_comes_back_hears_exactly_what_was_missed(self):
        self.ready_job("second")
        metrics = self.daemon.call("GET", "/metrics")[1].decode()
        self.last = int(next(l for l in metrics.splitlines() if l.startswith("leafcutter_event_seq ")).split()[1])
        self.assertGreater(self.last, 4)
        for seen in (0, 1, self.last - 2):
            self.assertEqual(self.replayed(seen), list(range(seen + 1, self.last + 1)))

    def test_an_id_of_nobodys_gets_a_snapshot(self):
        for strange in ("999999", "x", "-1"):
            connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=20)
            connection.request("GET", "/api/v1/events", headers={"Last-Event-ID": strange})
            stream = connection.getresponse()
            lines = [stream.readline() for _ in range(4)]
            connection.close()
            self.assertIn(b"event: snapshot\n", lines)


class Large(Http):
    def test_a_large_upload_takes_no_memory(self):
        """PUT stops at the daemon's limit of 256 MB; so several of up to that size, one after another."""
        wanted_mb = int(os.environ.get("LEAFCUTTER_UPLOAD_MB", "64"))
        piece = os.urandom(1 << 20)
        before = self.daemon.rss_mb()
        most = 0.0
        sent_mb = 0
        while sent_mb < wanted_mb:
            count = min(255, wanted_mb - sent_mb)
            digest = hashlib.sha256()
            for number in range(count):
                digest.update(number.to_bytes(4, "big") + sent_mb.to_bytes(4, "big") + piece[8:])
            connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=60)
            connection.putrequest("PUT", "/api/v1/blobs/" + digest.hexdigest())
            connection.putheader("Content-Length", str(count << 20))
            connection.endheaders()
            for number in range(count):
                connection.send(number.to_bytes(4, "big") + sent_mb.to_bytes(4, "big") + piece[8:])
                most = max(most, self.daemon.rss_mb())
            answer = connection.getresponse()
            answer.read()
            connection.close()
            self.assertEqual(answer.status, 201)
            sent_mb += count
        print(f"{sent_mb} MB taken; {before:.1f} MB of memory before, {most:.1f} MB at most")
        self.assertLess(most - before, 16)

    def test_a_body_beyond_the_limit_is_refused_before_it_is_sent(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=20)
        connection.putrequest("PUT", "/api/v1/blobs/" + "0" * 64)
        connection.putheader("Content-Length", str((256 << 20) + 1))
        connection.putheader("Expect", "100-continue")
        connection.endheaders()
        self.assertEqual(connection.getresponse().status, 413)
        connection.close()


if __name__ == "__main__":
    unittest.main()
