#!/bin/sh
# Builds the image of docker/Dockerfile.
#
# usage: docker/build_image.sh [--bootstrap] [TAG]
#   --bootstrap  for a host without an image registry or a Docker engine: the base image is made by
#                debootstrap, and buildah builds in plain chroots. Needs root, debootstrap, buildah.
#   TAG          leafcutter:latest if not given
# Says how long each part took and how large the image is.
set -eu

bootstrap=""
if [ "${1:-}" = --bootstrap ]; then
    bootstrap=yes
    shift
fi
tag=${1:-leafcutter:latest}
cd "$(dirname "$0")/.."

say() {
    echo "build_image: $1: $(($(date +%s) - begun)) s"
    begun=$(date +%s)
}

# A Debian 12 that trusts whom this host trusts.
make_base() {
    rootfs=$(mktemp -d)
    trap 'rm -rf "$rootfs"' EXIT
    debootstrap --variant=minbase bookworm "$rootfs" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >/dev/null
    mkdir -p "$rootfs/usr/local/share/ca-certificates"
    cp /usr/local/share/ca-certificates/*.crt "$rootfs/usr/local/share/ca-certificates/" 2>/dev/null || true
    base=$(buildah from scratch)
    buildah add --quiet "$base" "$rootfs" / >/dev/null
    buildah commit --quiet --rm "$base" leafcutter-base:12 >/dev/null
}

begun=$(date +%s)
if [ -n "$bootstrap" ]; then
    buildah inspect --type image leafcutter-base:12 >/dev/null 2>&1 || make_base
    say "base image"
    # Docker's own format: the other one knows no health check.
    buildah build --isolation chroot --format docker --quiet \
        --build-arg BASE=localhost/leafcutter-base:12 --build-arg RUN_BASE=localhost/leafcutter-base:12 \
        --tag "$tag" --file docker/Dockerfile .
    say "image"
    buildah images --format '{{.Name}}:{{.Tag}} {{.Size}}' | grep -F "$tag"
    exit 0
fi
for builder in docker podman buildah; do
    if command -v "$builder" >/dev/null; then
        format=""
        [ "$builder" = docker ] || format="--format docker"
        # shellcheck disable=SC2086
        "$builder" build $format --tag "$tag" --file docker/Dockerfile .
        say "image"
        exit 0
    fi
done
echo "build_image: needs docker, podman or buildah" >&2
exit 1
