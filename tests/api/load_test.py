#!/usr/bin/env python3
"""Many pages, slow clients and jobs at once: how long ordinary calls and a stop take. Prints what it measured. Usage:
load_test.py LEAFCUTTER
LEAFCUTTER_LOAD=full: 1,000 event streams and 500 slow clients; a tenth of that if not given."""
import http.client
import os
import resource
import selectors
import socket
import tempfile
import threading
import time
import unittest

from daemon import Daemon, form, free_port

FULL = os.environ.get("LEAFCUTTER_LOAD") == "full"
STREAMS, SLOW, CALLS = (1000, 500, 2000) if FULL else (100, 50, 300)
AS_JSON = {"Content-Type": "application/json"}


def percentile(values, part):
    return sorted(values)[min(len(values) - 1, int(part * len(values)))]


class Streams:
    """Open event streams, read by one thread; counts what comes."""

    def __init__(self, port, count):
        self.selector = selectors.DefaultSelector()
        self.clients = []
        self.received = 0
        self.lost = 0
        self.over = False
        for _ in range(count):
            client = socket.create_connection(("127.0.0.1", port), timeout=20)
            client.sendall(b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n")
            client.setblocking(False)
            self.selector.register(client, selectors.EVENT_READ)
            self.clients.append(client)
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self):
        while not self.over:
            for key, _ in self.selector.select(0.1):
                part = key.fileobj.recv(65536)
                self.received += len(part)
                if not part:
                    self.lost += 1
                    self.selector.unregister(key.fileobj)

    def close(self):
        self.over = True
        self.reader.join()
        for client in self.clients:
            client.close()


class Load(unittest.TestCase):
    def test_ordinary_calls_and_a_stop_under_load(self):
        hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(8192, hard), hard))
        with tempfile.TemporaryDirectory() as folder:
            daemon = Daemon(folder, free_port())
            idle = self.timed(daemon, CALLS // 2)
            streams = Streams(daemon.port, STREAMS)
            slow = []
            for _ in range(SLOW):
                client = socket.create_connection(("127.0.0.1", daemon.port), timeout=20)
                client.sendall(b"GET / HTTP/1.1\r\nHo")
                slow.append(client)
            for number in range(6):
                params = {"nesting": {"time_s": 2}}
                self.assertEqual(daemon.call("POST", "/api/v1/jobs", *form(f"l{number}", "load", params))[0], 201)
            before = daemon.rss_mb()
            calls = self.timed(daemon, CALLS)
            stops = self.timed(daemon, CALLS // 4, "POST", "/api/v1/devices/sim/commands", '{"command": "stop"}')
            after = daemon.rss_mb()
            clients = daemon.call("GET", "/metrics")[1].decode()
            streams.close()
            for client in slow:
                client.close()
            self.assertEqual(daemon.stop(), 0)
        for name, times in (("idle", idle), ("calls", calls), ("stops", stops)):
            print(f"{name}: p50 {1e3 * percentile(times, 0.5):.1f} ms, p99 {1e3 * percentile(times, 0.99):.1f} ms, "
                  f"longest {1e3 * max(times):.1f} ms of {len(times)}")
        print(f"{STREAMS} streams, {SLOW} slow clients; {streams.received >> 10} kB of events; "
              f"memory {before:.0f} -> {after:.0f} MB")
        self.assertIn(f"leafcutter_event_clients {STREAMS}\n", clients)
        self.assertEqual(streams.lost, 0)
        self.assertGreater(streams.received, STREAMS * 1000)
        self.assertLess(after - before, 60)
        self.assertLess(max(stops), 5)

    def timed(self, daemon, count, method="GET", path="/api/v1/jobs?limit=10", body=None):
        connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=20)
        times = []
        for _ in range(count):
            begin = time.monotonic()
            connection.request(method, path, body, AS_JSON if body else {})
            answer = connection.getresponse()
            answer.read()
            times.append(time.monotonic() - begin)
            self.assertLess(answer.status, 300)
        connection.close()
        return times


if __name__ == "__main__":
    unittest.main()
