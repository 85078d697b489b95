#!/usr/bin/env python3
"""Who may do what: every call by every role, sessions, keys, the audit log. Usage: auth_test.py LEAFCUTTER"""
import http.client
import json
import subprocess
import tempfile
import unittest

from daemon import BINARY, Daemon, form, free_port

ROLES = ["nobody", "viewer", "submitter", "operator", "admin"]
PASSWORD = "correct horse"
AS_JSON = {"Content-Type": "application/json"}


def user_command(state, *words, password=PASSWORD, check=True):
    return subprocess.run([BINARY, "user", "--state", state, *words], input=password + "\n", text=True,
                          capture_output=True, check=check, timeout=30)


class Open(unittest.TestCase):
    def test_without_accounts_loopback_is_open_and_the_first_account_ends_that(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Daemon(folder, free_port())
            try:
                session = json.loads(daemon.call("GET", "/api/v1/session")[1])
                self.assertEqual((session["accounts"], session["role"]), (False, "admin"))
                viewer = json.dumps({"name": "ann", "role": "viewer", "password": PASSWORD})
                self.assertEqual(daemon.call("POST", "/api/v1/users", viewer, AS_JSON)[0], 422)
                admin = json.dumps({"name": "ann", "role": "admin", "password": PASSWORD})
                self.assertEqual(daemon.call("POST", "/api/v1/users", admin, AS_JSON)[0], 201)
                self.assertEqual(daemon.call("GET", "/api/v1/jobs")[0], 401)
                session = json.loads(daemon.call("GET", "/api/v1/session")[1])
                self.assertEqual((session["accounts"], session["role"]), (True, None))
            finally:
                daemon.stop()

    def test_the_daemon_listens_to_others_only_with_an_account(self):
        with tempfile.TemporaryDirectory() as folder:
            refused = subprocess.run([BINARY, "serve", "--state", folder, "--listen", "0.0.0.0:0"],
                                     capture_output=True, text=True, timeout=20)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("leafcutter user add", refused.stderr)
            user_command(folder, "add", "ann")
            daemon = Daemon(folder, free_port(), address="0.0.0.0")
            try:
                self.assertEqual(daemon.call("GET", "/healthz")[0], 200)
                self.assertEqual(daemon.call("GET", "/api/v1/jobs")[0], 401)
            finally:
                daemon.stop()

    def test_a_trusted_proxy_takes_an_account_too(self):
        with tempfile.TemporaryDirectory() as folder:
            config = f"{folder}/c.toml"
            with open(config, "w", encoding="utf-8") as file:
                file.write('trusted_proxies = ["127.0.0.1"]\n')
            refused = subprocess.run([BINARY, "serve", "--config", config, "--state", folder, "--listen", ":0"],
                                     capture_output=True, text=True, timeout=20)
            self.assertEqual((refused.returncode, "trusted_proxies" in refused.stderr), (2, True))

    def test_the_command_line_refuses_a_folder_in_use(self):
        with tempfile.TemporaryDirectory() as folder:
            daemon = Daemon(folder, free_port())
            try:
                self.assertEqual(user_command(folder, "add", "ann", check=False).returncode, 1)
            finally:
                daemon.stop()
            self.assertEqual(user_command(folder, "add", "ann", password="short", check=False).returncode, 2)


class WithAccounts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        state = cls.folder.name
        user_command(state, "add", "admin")
        cls.keys = {"nobody": None}
        for role in ROLES[1:]:
            if role != "admin":
                user_command(state, "add", role, "--role", role)
            cls.keys[role] = user_command(state, "key", role, "--role", role, "--may-fire").stdout.strip()
        cls.daemon = Daemon(state, free_port(), "--config", cls.config(state))

    @classmethod
    def config(cls, state):
        path = f"{state}/leafcutter.toml"
        with open(path, "w", encoding="utf-8") as file:
            file.write('trusted_proxies = ["127.0.0.1"]\nhosts = ["cutter.example"]\n')
        return path

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        cls.folder.cleanup()
        assert status == 0, status

    def as_role(self, role, method, path, body=None, **headers):
        if self.keys.get(role):
            headers["Authorization"] = f"Bearer {self.keys[role]}"
        status, _, answer = self.daemon.exchange(method, path, body, headers)
        return status, answer

    def log_in(self, user, password=PASSWORD, **headers):
        body = json.dumps({"user": user, "password": password})
        return self.daemon.exchange("POST", "/api/v1/session", body, {**AS_JSON, **headers})


class Roles(WithAccounts):
    def test_every_call_by_every_role(self):
        """With names that don't exist: what is let through finds nothing, or is not understood."""
        api = json.loads(self.daemon.call("GET", "/api/v1/openapi.json")[1])
        seen = 0
        for pattern, item in api["paths"].items():
            for method, operation in item.items():
                if method == "parameters":
                    continue
                path = pattern
                for parameter in item.get("parameters", []):
                    path = path.replace("{%s}" % parameter["name"], "none-such")
                for role in ROLES:
                    with self.subTest(call=f"{method} {path}", role=role):
                        status, answer = self.answer_to(role, method.upper(), "/api/v1" + path)
                        may = ROLES.index(role) >= ROLES.index(operation["x-role"])
                        self.assertLess(status, 500)
                        code = json.loads(answer)["code"] if status in (401, 403) else ""
                        refusal = (401, "unauthenticated") if role == "nobody" else (403, "role")
                        self.assertEqual((status, code) == refusal, not may, (status, code))
                        seen += 1
        self.assertGreater(seen, 200)

    def answer_to(self, role, method, path):
        if not path.endswith("/events"):
            return self.as_role(role, method, path, None if method == "GET" else "{}", **AS_JSON)
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=20)
        headers = {"Authorization": f"Bearer {self.keys[role]}"} if self.keys[role] else {}
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        try:
            return answer.status, b"" if answer.status == 200 else answer.read()
        finally:
            connection.close()

    def test_viewers_stop_and_hold_but_do_nothing_else_to_a_machine(self):
        path = "/api/v1/devices/sim/commands"
        for command, role, wanted in [("stop", "viewer", 202), ("hold", "viewer", 202), ("home", "viewer", 403),
                                      ("console", "submitter", 403), ("stop", "nobody", 401)]:
            body = json.dumps({"command": command, "line": "$$"})
            self.assertEqual(self.as_role(role, "POST", path, body, **AS_JSON)[0], wanted, (command, role))

    def test_a_key_fires_only_with_the_right_to(self):
        body = json.dumps({"label": "no fire", "role": "operator", "user": "operator"})
        status, answer = self.as_role("admin", "POST", "/api/v1/keys", body, **AS_JSON)
        self.assertEqual(status, 201, answer)
        bearer = {"Authorization": "Bearer " + json.loads(answer)["key"], **AS_JSON}
        for path in ("/api/v1/cuts/none/start", "/api/v1/cuts/none/confirm-sheet", "/api/v1/cuts/none/resume"):
            status, _, answer = self.daemon.exchange("POST", path, "{}", bearer)
            self.assertEqual((status, json.loads(answer)["code"]), (403, "may-not-fire"))
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/cuts", None, bearer)[0], 200)

    def test_a_key_makes_no_keys_and_an_operator_no_admin(self):
        body = json.dumps({"label": "more"})
        self.assertEqual(self.as_role("operator", "POST", "/api/v1/keys", body, **AS_JSON)[0], 403)
        self.assertEqual(self.as_role("operator", "GET", "/api/v1/users/admin")[0], 404)

    def test_keys_list_without_secrets_and_end_when_revoked(self):
        body = json.dumps({"label": "gone soon", "role": "viewer", "expires_in_days": 3})
        made = json.loads(self.as_role("admin", "POST", "/api/v1/keys", body, **AS_JSON)[1])
        listed = self.as_role("admin", "GET", "/api/v1/keys")[1].decode()
        self.assertIn(made["id"], listed)
        self.assertNotIn(made["key"].rsplit("_", 1)[1], listed)
        bearer = {"Authorization": "Bearer " + made["key"]}
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/jobs", None, bearer)[0], 200)
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/jobs", None, {"X-Api-Key": made["key"]})[0], 200)
        self.assertEqual(self.as_role("admin", "DELETE", "/api/v1/keys/" + made["id"])[0], 204)
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/jobs", None, bearer)[0], 401)

    def listen(self, headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=10)
        connection.request("GET", "/api/v1/events", headers=headers)
        answer = connection.getresponse()
        self.assertEqual(answer.status, 200)
        while not answer.readline().startswith(b"event: snapshot"):
            pass
        return connection, answer

    def goes_on(self, answer):
        """Whether the stream says something that happens after this call."""
        self.as_role("operator", "POST", "/api/v1/queue/pause", '{"reason": "listen"}', **AS_JSON)
        self.as_role("operator", "POST", "/api/v1/queue/resume", "{}", **AS_JSON)
        while line := answer.readline():
            if line.startswith(b"event: queue"):
                return True
        return False

    def test_live_events_end_with_the_key_or_session_that_opened_them(self):
        made = json.loads(self.as_role("admin", "POST", "/api/v1/keys", '{"label": "ends", "role": "viewer"}',
                                       **AS_JSON)[1])
        key_link, by_key = self.listen({"Authorization": "Bearer " + made["key"]})
        _, headers, answer = self.log_in("viewer")
        cookie = {"Cookie": headers["Set-Cookie"].split(";")[0]}
        session_link, by_session = self.listen(cookie)
        other_link, other = self.listen({"Authorization": f"Bearer {self.keys['operator']}"})
        self.assertTrue(self.goes_on(by_key) and self.goes_on(by_session) and self.goes_on(other))
        self.as_role("admin", "DELETE", "/api/v1/keys/" + made["id"])
        self.daemon.exchange("DELETE", "/api/v1/session", None,
                             {**cookie, "X-CSRF-Token": json.loads(answer)["csrf_token"]})
        for stream in (by_key, by_session):
            try:
                while stream.readline():  # A timeout is an error.
                    pass
            except (http.client.IncompleteRead, ConnectionError):
                pass
        self.assertTrue(self.goes_on(other))
        for link in (key_link, session_link, other_link):
            link.close()

    def test_a_key_in_the_address_is_no_key(self):
        self.assertEqual(self.daemon.call("GET", f"/api/v1/jobs?key={self.keys['admin']}")[0], 401)


class Sessions(WithAccounts):
    def test_a_session_is_a_cookie_for_pages_of_ours_alone(self):
        status, headers, answer = self.log_in("operator")
        self.assertEqual(status, 200)
        cookie = headers["Set-Cookie"]
        self.assertIn("HttpOnly", cookie)
        self.assertIn("SameSite=Strict", cookie)
        self.assertNotIn("Secure", cookie)
        session = json.loads(answer)
        self.assertEqual((session["user"], session["role"]), ("operator", "operator"))
        with_cookie = {"Cookie": cookie.split(";")[0], **AS_JSON}
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/jobs", None, with_cookie)[0], 200)
        body, form_headers = form("s1", "s1")
        without = {**form_headers, "Cookie": with_cookie["Cookie"]}
        status, _, answer = self.daemon.exchange("POST", "/api/v1/jobs", body, without)
        self.assertEqual((status, json.loads(answer)["code"]), (403, "csrf-token"))
        token = {"X-CSRF-Token": session["csrf_token"]}
        self.assertEqual(self.daemon.exchange("POST", "/api/v1/jobs", body, {**without, **token})[0], 201)
        foreign = {**without, **token, "Origin": "http://evil.example"}
        self.assertEqual(self.daemon.exchange("POST", "/api/v1/jobs", body, foreign)[0], 403)
        again = json.loads(self.daemon.exchange("GET", "/api/v1/session", None, with_cookie)[2])
        self.assertEqual(again["csrf_token"], session["csrf_token"])
        self.assertEqual(self.daemon.exchange("DELETE", "/api/v1/session", None, {**with_cookie, **token})[0], 204)
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/jobs", None, with_cookie)[0], 401)

    def test_behind_a_trusted_proxy_the_cookie_is_secure_and_the_caller_named(self):
        proxied = {"Host": "cutter.example", "X-Forwarded-Proto": "https", "X-Forwarded-For": "6.6.6.6, 203.0.113.9",
                   "Origin": "https://cutter.example"}
        status, headers, _ = self.log_in("viewer", **proxied)
        self.assertEqual(status, 200)
        self.assertIn("Secure", headers["Set-Cookie"])
        entries = json.loads(self.as_role("admin", "GET", "/api/v1/audit?limit=200")[1])["entries"]
        logins = [entry for entry in entries if entry["note"] == "viewer" and entry["status"] == 200]
        self.assertEqual(logins[0]["remote"], "203.0.113.9")

    def test_guessing_is_slowed_down_for_the_guesser_alone(self):
        guesser = {"X-Forwarded-For": "198.51.100.7"}
        statuses = [self.log_in("submitter", f"guess number {i}", **guesser)[0] for i in range(7)]
        self.assertEqual(statuses, [401] * 5 + [429] * 2)
        status, headers, _ = self.log_in("submitter", PASSWORD, **guesser)
        self.assertEqual(status, 429)
        self.assertGreater(int(headers["Retry-After"]), 0)
        self.assertEqual(self.log_in("submitter")[0], 200)

    def test_a_new_password_takes_the_old_one_and_ends_sessions(self):
        _, headers, answer = self.log_in("viewer")
        mine = {"Cookie": headers["Set-Cookie"].split(";")[0], "X-CSRF-Token": json.loads(answer)["csrf_token"],
                **AS_JSON}
        change = {"password": "another horse", "old_password": "wrong horse"}
        self.assertEqual(self.daemon.exchange("PUT", "/api/v1/users/viewer", json.dumps(change), mine)[0], 403)
        self.assertEqual(
            self.daemon.exchange("PUT", "/api/v1/users/viewer", '{"role": "admin"}', mine)[0], 403)
        change["old_password"] = PASSWORD
        self.assertEqual(self.daemon.exchange("PUT", "/api/v1/users/viewer", json.dumps(change), mine)[0], 200)
        self.assertEqual(self.daemon.exchange("GET", "/api/v1/jobs", None, mine)[0], 401)
        self.assertEqual(self.log_in("viewer", "another horse")[0], 200)
        back = json.dumps({"password": PASSWORD})
        self.assertEqual(self.as_role("admin", "PUT", "/api/v1/users/viewer", back, **AS_JSON)[0], 200)

    def test_the_last_admin_stays(self):
        status, answer = self.as_role("admin", "PUT", "/api/v1/users/admin", '{"role": "viewer"}', **AS_JSON)
        self.assertEqual((status, json.loads(answer)["code"]), (409, "last-admin"))
        self.assertEqual(self.as_role("admin", "DELETE", "/api/v1/users/admin")[0], 409)


class Audit(WithAccounts):
    def test_every_action_is_kept_page_by_page(self):
        for command in ("stop", "hold", "stop"):
            self.as_role("viewer", "POST", "/api/v1/devices/sim/commands", json.dumps({"command": command}), **AS_JSON)
        entries, cursor = [], ""
        while cursor is not None:
            page = json.loads(self.as_role("admin", "GET", f"/api/v1/audit?limit=2{cursor}")[1])
            entries += page["entries"]
            cursor = page["next_cursor"] and "&cursor=" + page["next_cursor"]
        commands = [e["note"] for e in entries if e["action"].endswith("/commands") and e["user"] == "viewer"]
        self.assertEqual(commands, ["stop", "hold", "stop"])
        self.assertEqual(len({e["seq"] for e in entries}), len(entries))
        self.assertTrue(any(e["action"].startswith("leafcutter user add") for e in entries))


if __name__ == "__main__":
    unittest.main()
