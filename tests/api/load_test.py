#!/usr/bin/env python3
"""Many pages, slow clients and jobs at once: how long ordinary calls and a stop take. Prints what it measured. Usage:
load_test.py LEAFCUTTER
LEAFCUTTER_LOAD=full: 1,000 event streams and 500 slow clients; a tenth of that if not given."""
import http.client
import json
import os
import resource
import selectors
import socket
import tempfile
import threading
import time
import unittest

from daemon import Daemon, form, free_port
from stop_probe import StopProbe

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
        probe = StopProbe()
        self.addCleanup(probe.stop)
        with tempfile.TemporaryDirectory() as folder:
            daemon = Daemon(folder, free_port())
            wire = json.dumps({"name": "wire", "uri": probe.uri})
            self.assertEqual(daemon.call("PUT", "/api/v1/devices/wire", wire, AS_JSON)[0], 201)
            idle = self.timed(daemon, CALLS // 2)
            streams = Streams(daemon.port, STREAMS)
            deadline = time.monotonic() + 30  # On their way they are waiting connections, which are counted, too.
            while f"leafcutter_event_clients {STREAMS}\n" not in daemon.call("GET", "/metrics")[1].decode():
                self.assertLess(time.monotonic(), deadline)
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
            wires = probe.press(daemon.port, CALLS // 20)
            after = daemon.rss_mb()
            clients = daemon.call("GET", "/metrics")[1].decode()
            streams.close()
            for client in slow:
                client.close()
            self.assertEqual(daemon.stop(), 0)
        for name, times in (("idle", idle), ("calls", calls), ("stops", stops), ("stop to the wire", wires)):
            print(f"{name}: p50 {1e3 * percentile(times, 0.5):.1f} ms, p99 {1e3 * percentile(times, 0.99):.1f} ms, "
                  f"longest {1e3 * max(times):.1f} ms of {len(times)}")
        print(f"{STREAMS} streams, {SLOW} slow clients; {streams.received >> 10} kB of events; "
              f"memory {before:.0f} -> {after:.0f} MB")
        self.assertIn(f"leafcutter_event_clients {STREAMS}\n", clients)
        self.assertEqual(streams.lost, 0)
        self.assertGreater(streams.received, STREAMS * 1000)
        self.assertLess(after - before, 60)
        self.assertLess(max(stops), 5)
        self.assertLess(max(wires), 5)

    def test_memory_stays_flat_over_an_hour_of_events(self):
        """Ten events a second for an hour, as fast as they go; a daemon that keeps them grows by as much."""
        events = 36000 if FULL else 1500
        with tempfile.TemporaryDirectory() as folder:
            daemon = Daemon(folder, free_port())
            streams = Streams(daemon.port, 20)
            daemon.call("POST", "/api/v1/queue/pause", "{}", AS_JSON)
            jobs = [json.loads(daemon.call("POST", "/api/v1/jobs", *form(f"e{number}", "events"))[1])["id"]
                    for number in range(4)]
            self.stir(daemon, jobs, events // 5)
            before = daemon.rss_mb()
            begun = time.monotonic()
            self.stir(daemon, jobs, events)
            took = time.monotonic() - begun
            after = daemon.rss_mb()
            metrics = daemon.call("GET", "/metrics")[1].decode()
            seq = next(line for line in metrics.splitlines() if line.startswith("leafcutter_event_seq "))
            streams.close()
            self.assertEqual(daemon.stop(), 0)
        print(f"{events} events to 20 streams in {took:.0f} s: memory {before:.1f} -> {after:.1f} MB; "
              f"{streams.received >> 20} MB were told")
        self.assertGreaterEqual(int(seq.split()[1]), events)
        self.assertGreater(streams.received, 20 * events * 100)
        self.assertEqual(streams.lost, 0)
        self.assertLess(after - before, 10)

    def stir(self, daemon, jobs, count):
        """So many changes of waiting jobs, each with its event."""
        def change(job):
            connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=20)
            for number in range(count // len(jobs) + 1):
                connection.request("PATCH", f"/api/v1/jobs/{job}", json.dumps({"priority": number % 2 + 1}), AS_JSON)
                connection.getresponse().read()
            connection.close()
        threads = [threading.Thread(target=change, args=(job,)) for job in jobs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

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
