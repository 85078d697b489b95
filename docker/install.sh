#!/bin/sh
# Installs what Leafcutter needs on Debian 12; used by `make setup` and by the Dockerfile.
#
# usage: install.sh build|compile|run
#   build    compilers, libraries, test tools, browser and Node.js
#   compile  of these, what the binary alone needs
#   run      only what the finished binary loads
# Says what it installs and leaves alone what is already there.
set -eu

RUN_PACKAGES="libopenmesh1 libcholmod3 libopenblas0-pthread libcpp-httplib0.11 libspdlog1.10 libfmt9
    libsqlite3-0 libpq5 libtomlplusplus3 libpolyclipping22 libhpdf-2.3.0 libpng16-16 libssl3 libusb-1.0-0 libsodium23 zlib1g"
COMPILE_PACKAGES="g++ cmake ninja-build make pkg-config ccache git ca-certificates
    libopenmesh-dev libeigen3-dev libsuitesparse-dev libopenblas-pthread-dev
    nlohmann-json3-dev libcli11-dev libtomlplusplus-dev libspdlog-dev libfmt-dev
    libcpp-httplib-dev libssl-dev zlib1g-dev libbrotli-dev
    libsqlite3-dev libpq-dev libsqlitecpp-dev libsodium-dev libusb-1.0-0-dev libpolyclipping-dev libhpdf-dev libpng-dev"
TEST_PACKAGES="fakeroot nginx-light openssl postgresql-15 iproute2 nftables faketime libgtest-dev libgmock-dev libbenchmark-dev umockdev libumockdev-dev
    clang clang-format clang-tidy libclang-rt-14-dev
    python3 python3-jsonschema python3-yaml python3-numpy python3-scipy python3-shapely python3-ezdxf poppler-utils chromium"

case "${1:-}" in
    run) wanted=$RUN_PACKAGES ;;
    compile) wanted=$COMPILE_PACKAGES ;;
    build) wanted="$COMPILE_PACKAGES $TEST_PACKAGES" ;;
    *) echo "usage: install.sh build|compile|run" >&2; exit 2 ;;
esac

# Any Node.js from 18 on will do; Debian's own only where there is none.
if [ "$1" != run ]; then
    node_major=$(node --version 2>/dev/null | sed 's/^v\([0-9]*\).*/\1/')
    if [ "${node_major:-0}" -lt 18 ] || ! command -v npm >/dev/null; then
        wanted="$wanted nodejs npm"
    fi
fi

missing=""
for package in $wanted; do
    if ! dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed'; then
        missing="$missing $package"
    fi
done

if [ -z "$missing" ]; then
    echo "setup: every Debian package is there"
    exit 0
fi

as_root=""
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "setup: needs root or sudo to install:$missing" >&2; exit 1; }
    as_root="sudo"
fi
echo "setup: installing$missing"
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -qq
# Recommended packages would pull in a whole scene graph for OpenMesh's header files.
# shellcheck disable=SC2086
$as_root apt-get install -y -qq --no-install-recommends $missing >/dev/null
echo "setup: done"
