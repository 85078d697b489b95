#!/usr/bin/env python3
"""Holds the source tree to its layers: which module may include which, and which files may include
an awkward third-party header. Usage: check_layers.py ROOT"""
import re
import sys
from pathlib import Path

MODULES = {
    "geometry": {"geometry"},
    "fab": {"fab", "geometry"},
    "drivers": {"drivers"},
    "server": {"server", "fab", "geometry", "drivers"},
}

# Header (regular expression) -> files (regular expressions) that may include it.
PINNED = {
    r"nlohmann/.*": [r"fab/package/.*\.(h|cpp)", r"fab/nest/instance_io\.cpp", r"fab/export/gltf\.cpp", r"server/.*"],
    r"httplib\.h": [r"server/http/edge\.(h|cpp)", r"server/webhook/post\.cpp", r"server/fleet/peers\.cpp", r"server/cli/.*\.cpp"],
    r"libpq-fe\.h": [r"server/store/postgres/connection\.cpp"],
    r"SQLiteCpp/.*|sqlite3\.h": [r"server/store/.*\.cpp"],
    r"CLI/.*": [r"server/cli/.*\.cpp", r"server/main\.cpp"],
    r"spdlog/.*": [r"server/.*", r"drivers/.*"],
    r"toml\+\+/.*|toml\.hpp": [r"server/config\.cpp"],
    r"cholmod\.h|Eigen/(CholmodSupport|SparseCholesky)": [r"geometry/sparse_solver\.cpp"],
    r"polyclipping/.*": [r"fab/.*\.cpp", r"fab/clipper_paths\.h"],
    r"hpdf\.h": [r"fab/guide/pdf\.cpp"],
    r"png\.h": [r"drivers/sim/burn_picture\.cpp"],
    r"OpenMesh/.*": [r"geometry/mesh\.h"],
    r"termios\.h|asm/termbits\.h|sys/ioctl\.h|pty\.h": [r"drivers/.*", r"server/cli/.*"],
    r"sys/socket\.h|netdb\.h|arpa/inet\.h": [r"drivers/.*", r"server/.*"],
    r"sodium\.h": [r"server/auth/secrets\.cpp"],
    r"libusb.*": [r"drivers/usb_(context|pipe|watch)\.(h|cpp)"],
}

# Words that have no business in the pure core: clocks, randomness without a seed, threads' owners.
FORBIDDEN_IN_CORE = re.compile(
    r"\b(std::chrono::\w+_clock|std::random_device|getenv|std::cout|std::cerr|std::rand|\.detach\(\))")

INCLUDE = re.compile(r'^\s*#\s*include\s+([<"])([^>"]+)[>"]')


def check(root: Path) -> list[str]:
    faults = []
    for module, allowed in MODULES.items():
        for path in sorted((root / module).rglob("*")):
            if path.suffix not in {".h", ".cpp"}:
                continue
            name = path.relative_to(root).as_posix()
            for number, line in enumerate(path.read_text().splitlines(), 1):
                where = f"{name}:{number}"
                if module in {"geometry", "fab"} and FORBIDDEN_IN_CORE.search(line.split("//")[0]):
                    faults.append(f"{where}: the core knows no clock, environment or console: {line.strip()}")
                match = INCLUDE.match(line)
                if not match:
                    continue
                header = match.group(2)
                if match.group(1) == '"':
                    target = header.split("/")[0]
                    if target not in MODULES:
                        faults.append(f'{where}: "{header}" is no path from the root')
                    elif target not in allowed:
                        faults.append(f"{where}: {module} may not include {target}")
                for pattern, files in PINNED.items():
                    if re.fullmatch(pattern, header) and not any(re.fullmatch(f, name) for f in files):
                        faults.append(f"{where}: {header} belongs to {', '.join(files)}")
    for path in sorted((root / "server").rglob("*")):
        name = path.relative_to(root).as_posix()
        if path.suffix in {".h", ".cpp"} and re.match(r"server/(store|queue)/", name):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                if match and match.group(2).startswith("server/http"):
                    faults.append(f"{name}:{number}: store and queue never see HTTP")
    return faults


if __name__ == "__main__":
    found = check(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    print("\n".join(found) if found else "layers hold")
    sys.exit(1 if found else 0)
