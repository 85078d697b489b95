"""A machine on a socket that notes when a stop arrives, and the hand that presses the button: in a process of its own,
so that what is measured is the daemon and not the test."""
import http.client
import json
import multiprocessing
import queue
import socket
import threading
import time

REPLIES = {b"$I": b"[VER:1.1h.20190830:]\r\n[OPT:VL,35,254]\r\nok\r\n", b"$$": b"$30=1000\r\n$32=1\r\nok\r\n",
           b"$G": b"[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\r\nok\r\n"}


class Machine:
    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.stops = queue.Queue()
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            link, _ = self.listener.accept()
            link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            try:
                self.talk(link)
            except OSError:
                pass

    def talk(self, link):
        link.sendall(b"\r\nGrbl 1.1h ['$' for help]\r\n")
        line = b""
        while part := link.recv(4096):
            now = time.monotonic()
            for byte in (part[i:i + 1] for i in range(len(part))):
                if byte in (b"\x18", b"!"):
                    self.stops.put(now)
                if byte == b"\x18":
                    line = b""
                    link.sendall(b"\r\nGrbl 1.1h ['$' for help]\r\n")
                elif byte == b"?":
                    link.sendall(b"<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>\r\n")
                elif byte == b"\n":
                    link.sendall(REPLIES.get(line.strip(), b"ok\r\n"))
                    line = b""
                elif byte not in b"!~\r":
                    line += byte

    def drain(self):
        while not self.stops.empty():
            self.stops.get()


def press(port, machine, times):
    """Seconds from the press to the byte on the machine's wire, each."""
    link = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    taken = []
    for _ in range(times):
        time.sleep(0.05)
        machine.drain()
        begun = time.monotonic()
        link.request("POST", "/api/v1/devices/wire/commands", '{"command": "stop"}', {"Content-Type": "application/json"})
        taken.append(machine.stops.get(timeout=10) - begun)
        link.getresponse().read()
    link.close()
    return taken


def idle(port):
    link = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    link.request("GET", "/api/v1/devices/wire")
    state = json.loads(link.getresponse().read())["status"]["state"]
    link.close()
    return state == "idle"


def serve(pipe):
    machine = Machine()
    pipe.send(machine.port)
    while True:
        port, times = pipe.recv()
        deadline = time.monotonic() + 20
        while not idle(port) and time.monotonic() < deadline:
            time.sleep(0.05)
        pipe.send(press(port, machine, times))


class StopProbe:
    """Must be made before any other thread is."""

    def __init__(self):
        self.pipe, theirs = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=serve, args=(theirs,), daemon=True)
        self.process.start()
        self.uri = f"grbl:tcp://127.0.0.1:{self.pipe.recv()}"

    def press(self, port, times):
        self.pipe.send((port, times))
        return self.pipe.recv()

    def stop(self):
        self.process.terminate()
        self.process.join()
