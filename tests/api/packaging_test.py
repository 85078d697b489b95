#!/usr/bin/env python3
"""The Debian package and its unit, as built: what is in it, who may touch it, how exposed the service is. Exit
status 77: the tools for it are missing. Usage: packaging_test.py SOURCE BUILD"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = Path(sys.argv.pop(2))
SOURCE = Path(sys.argv.pop(1))
UNIT = SOURCE / "docker" / "debian" / "leafcutter.service"


def run(*words, **options):
    return subprocess.run(words, capture_output=True, text=True, check=True, timeout=250, **options).stdout


class Unit(unittest.TestCase):
    @unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze is missing")
    def test_the_service_is_hardly_exposed(self):
        report = run("systemd-analyze", "security", "--offline=true", str(UNIT))
        level = float(re.search(r"exposure level for \S+: ([\d.]+)", report).group(1))
        self.assertLessEqual(level, 2.0, report)

    def test_the_machines_it_cuts_with_stay_reachable(self):
        unit = UNIT.read_text()
        for device in ("char-ttyUSB", "char-ttyACM", "char-usb_device"):
            self.assertIn(f"DeviceAllow={device} rw", unit)
        self.assertNotIn("PrivateDevices=yes", unit)

    def test_computations_may_step_back_and_keep_their_budgets(self):
        filters = [line.split("=", 1)[1] for line in UNIT.read_text().splitlines() if line.startswith("SystemCallFilter=")]
        self.assertEqual(filters[0], "@system-service")
        self.assertEqual(filters[-1], "setpriority")
        # The budget of memory is set by a call that none of the groups taken away holds.
        taken_away = run("systemd-analyze", "syscall-filter", "@privileged", "@resources").split()
        self.assertNotIn("prlimit64", taken_away)
        self.assertIn("setpriority", taken_away)


@unittest.skipUnless(shutil.which("cpack") and shutil.which("fakeroot") and shutil.which("dpkg-deb"),
                     "cpack, fakeroot or dpkg-deb is missing")
class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        run("fakeroot", "cpack", "-G", "DEB", "-B", cls.folder.name, "--config", str(BUILD / "CPackConfig.cmake"))
        cls.package = next(Path(cls.folder.name).glob("*.deb"))
        cls.root = Path(cls.folder.name) / "root"
        cls.control = Path(cls.folder.name) / "control"
        run("dpkg-deb", "-x", str(cls.package), str(cls.root))
        run("dpkg-deb", "-e", str(cls.package), str(cls.control))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_it_has_the_daemon_its_unit_its_rule_and_its_settings(self):
        contents = run("dpkg-deb", "--contents", str(self.package))
        for path in ("usr/bin/leafcutter", "lib/systemd/system/leafcutter.service",
                     "lib/udev/rules.d/70-leafcutter.rules", "etc/leafcutter/leafcutter.toml",
                     "usr/share/doc/leafcutter/copyright", "usr/share/doc/leafcutter/operations.md"):
            self.assertRegex(contents, rf"root/root\s.* \./{path}\n", path)
        self.assertNotIn(" ./usr/include", contents)

    def test_it_names_what_it_loads_and_keeps_the_hosts_settings(self):
        fields = run("dpkg-deb", "--field", str(self.package))
        for library in ("libcpp-httplib", "libsodium", "libsqlite3", "libusb-1.0", "adduser"):
            self.assertIn(library, fields)
        self.assertEqual((self.control / "conffiles").read_text(), "/etc/leafcutter/leafcutter.toml\n")
        for script in ("postinst", "prerm", "postrm"):
            self.assertTrue((self.control / script).stat().st_mode & 0o111)
            run("sh", "-n", str(self.control / script))

    def test_its_binary_runs_and_takes_its_own_settings(self):
        binary = str(self.root / "usr/bin/leafcutter")
        self.assertRegex(run(binary, "--version"), r"\d+\.\d+")
        settings = Path(self.folder.name) / "c.toml"
        settings.write_text((self.root / "etc/leafcutter/leafcutter.toml").read_text() + "no_such_key = 1\n")
        refused = subprocess.run([binary, "serve", "--config", str(settings), "--state", self.folder.name],
                                 capture_output=True, text=True, timeout=20)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("no_such_key: there is no such key", refused.stderr)

    def test_the_rule_names_the_engraver(self):
        rule = (self.root / "lib/udev/rules.d/70-leafcutter.rules").read_text()
        self.assertIn('ATTR{idVendor}=="1a86", ATTR{idProduct}=="5512", GROUP="leafcutter", MODE="0660"', rule)
        self.assertNotIn("0666", rule)


if __name__ == "__main__":
    unittest.main()
