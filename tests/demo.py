#!/usr/bin/env python3
"""The whole road on this machine: a sample mesh goes in, a simulated laser cuts it.

Starts the daemon on a free loopback port with a fresh state folder, submits a sample surface, cuts every
sheet on the simulated machine, holds the beam log against the plan, and leaves the daemon running until
Ctrl-C (`--once`: ends by itself). Exit status 0 only if the burn matches the plan.
"""
import argparse
import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
import uuid
import zipfile
from pathlib import Path

sys.path.append(str(Path(__file__).parent / "support"))
from loopback import free_port  # noqa: E402

LARGEST_DEVIATION_MM = 0.05


class Api:
    def __init__(self, address):
        self.root = f"http://{address}"

    def call(self, method, path, body=None, content_type="application/json"):
        data = json.dumps(body).encode() if isinstance(body, (dict, list)) else body
        request = urllib.request.Request(self.root + "/api/v1" + path, data=data, method=method)
        if data is not None:
            request.add_header("Content-Type", content_type)
        try:
            with urllib.request.urlopen(request, timeout=60) as response:
                raw = response.read()
                is_json = "json" in response.headers.get("Content-Type", "")
                return json.loads(raw) if is_json and raw else raw
        except urllib.error.HTTPError as error:
            sys.exit(f"demo: {method} {path}: {error.code} {error.read().decode(errors='replace')}")

    def upload(self, mesh, params, name):
        boundary = uuid.uuid4().hex
        parts = [
            (f'name="mesh"; filename="{mesh.name}"', "application/octet-stream", mesh.read_bytes()),
            ('name="params"', "application/json", json.dumps(params).encode()),
            ('name="name"', "text/plain", name.encode()),
        ]
        body = b"".join(
            f"--{boundary}\r\nContent-Disposition: form-data; {head}\r\nContent-Type: {kind}\r\n\r\n".encode()
            + content + b"\r\n" for head, kind, content in parts)
        body += f"--{boundary}--\r\n".encode()
        return self.call("POST", "/jobs", body, f"multipart/form-data; boundary={boundary}")


def show(text, last=False):
    """One line that rewrites itself on a terminal; elsewhere a line for each new stage."""
    stage = text.rstrip("0123456789 %")
    if sys.stdout.isatty():
        print(f"\r\033[K{text}", end="\n" if last else "", flush=True)
    elif last or show.before != stage:
        print(text if last else stage, flush=True)
    show.before = stage


show.before = ""


def start_daemon(binary, state, port, log):
    address = f"127.0.0.1:{port}"
    daemon = subprocess.Popen(
        [str(binary), "serve", "--listen", address, "--state", str(state)], stdout=log, stderr=log)
    for _ in range(200):
        if daemon.poll() is not None:
            sys.exit(f"demo: the daemon ended with status {daemon.returncode}:\n{Path(log.name).read_text()}")
        try:
            urllib.request.urlopen(f"http://{address}/healthz", timeout=1).read()
            return daemon, address
        except OSError:
            time.sleep(0.05)
    sys.exit("demo: the daemon does not answer")


def compute(api, job):
    while job["state"] in ("queued", "computing"):
        progress = job.get("progress") or {}
        show(f"  {job['state']}: {progress.get('stage', '')} {100 * progress.get('fraction', 0):.0f} %")
        time.sleep(0.1)
        job = api.call("GET", f"/jobs/{job['id']}")
    if job["state"] != "ready":
        sys.exit(f"demo: the job is {job['state']}: {job.get('error')}")
    summary = job["summary"]
    show(f"  {summary['quads']} cells, {summary['strips']} strips in {summary['pieces']} pieces on "
         f"{summary['sheets']} sheets, about {summary['estimated_s'] / 60:.0f} minutes of laser", last=True)
    return job


def cut_all_sheets(api, job, device, burn_log, folder):
    """Cuts sheet after sheet as an operator would; returns one beam log per sheet."""
    cut = api.call("POST", f"/jobs/{job['id']}/cuts", {"device": device})
    logs, begun, sheet = [], 0, None
    while cut["state"] != "done":
        if cut["state"] in ("aborted", "failed", "interrupted"):
            sys.exit(f"demo: the cut is {cut['state']}: {cut.get('reason')}")
        for action in ("start", "confirm-sheet"):
            if action in cut["actions"]:
                if sheet is not None:
                    begun = keep_burn(burn_log, begun, folder, sheet, logs)
                sheet = cut["sheet"]
                api.call("POST", f"/cuts/{cut['id']}/{action}",
                         {"program_sha256": cut["program_sha256"], "bed_clear": True})
        show(f"  sheet {cut['sheet']} of {len(cut['sheets'])}: {cut['state']} "
             f"{100 * cut['progress'].get('fraction', 0):.0f} %")
        time.sleep(0.1)
        cut = api.call("GET", f"/cuts/{cut['id']}")
    keep_burn(burn_log, begun, folder, sheet, logs)
    show(f"  all {len(cut['sheets'])} sheets cut", last=True)
    return logs


def keep_burn(burn_log, begun, folder, sheet, logs):
    with open(burn_log, "rb") as log:
        log.seek(begun)
        part = folder / f"burn-{sheet:03d}.jsonl"
        part.write_bytes(log.read())
        logs.append(part)
        return log.tell()


def audit(binary, package, logs):
    result = subprocess.run(
        [str(binary), "audit", str(package), "--burn", *map(str, logs)],
        capture_output=True, text=True)
    print(result.stdout.strip() or result.stderr.strip())
    return result.returncode == 0


def wait_for_ctrl_c(daemon):
    try:
        daemon.wait()
    except KeyboardInterrupt:
        print("\n  ending")


def run(arguments, folder):
    binary = Path(arguments.leafcutter).resolve()
    burn_log = folder / "state/burns/demo.jsonl"
    print(f"leafcutter demo: sample surface '{arguments.sample}', simulated laser")
    mesh = folder / f"{arguments.sample}.obj"
    subprocess.run([str(binary), "sample", arguments.sample, "-o", str(mesh)], check=True)
    with open(folder / "daemon.log", "w") as log:
        daemon, address = start_daemon(binary, folder / "state", arguments.port or free_port(), log)
        try:
            api = Api(address)
            print(f"  dashboard: http://{address}/")
            api.call("PUT", "/devices/demo", {
                "name": "Simulated laser", "uri": f"sim:grbl?burn={burn_log}&speed={arguments.speed}",
                "auto_start": False, "bed_mm": [600, 400]})
            job = api.upload(mesh, {"grid": {"strip_width_mm": arguments.strip_width}}, f"Demo {arguments.sample}")
            job = compute(api, job)
            logs = cut_all_sheets(api, job, "demo", burn_log, folder)
            package = folder / "package"
            zipfile.ZipFile(io.BytesIO(api.call("GET", f"/jobs/{job['id']}/package.zip"))).extractall(package)
            good = audit(binary, package, logs)
            state = api.call("GET", f"/jobs/{job['id']}")["state"]
            print(f"  job is {state}; the burn {'matches' if good else 'DOES NOT MATCH'} the plan "
                  f"(tolerance {LARGEST_DEVIATION_MM} mm)")
            if good and not arguments.once:
                print(f"  the daemon keeps running: http://{address}/   (Ctrl-C ends it)", flush=True)
                wait_for_ctrl_c(daemon)
            return good and state == "done"
        finally:
            daemon.send_signal(signal.SIGTERM)
            try:
                daemon.wait(timeout=20)
            except subprocess.TimeoutExpired:
                daemon.kill()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--leafcutter", default="build/release/leafcutter")
    parser.add_argument("--sample", default="vase")
    parser.add_argument("--strip-width", type=float, default=15.0)
    parser.add_argument("--speed", type=float, default=100.0, help="simulated seconds per second")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--once", action="store_true", help="end after the cut instead of serving on")
    arguments = parser.parse_args()
    try:
        with tempfile.TemporaryDirectory(prefix="leafcutter-demo-") as folder:
            sys.exit(0 if run(arguments, Path(folder)) else 1)
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    os.environ.setdefault("PYTHONUNBUFFERED", "1")
    main()
