#!/bin/sh
# Builds recurve with its tests and runs them, on a bare Debian 12 machine too: sh cmake/test.sh [ctest arguments]
#
# Every tier but fuzz; tests that need meshes from outside this repository say that they skip where those are absent.
set -eu
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$*"; }

step "packages"
sh cmake/install_dependencies.sh build test

step "format"
find toolkit tests examples data -name '*.h' -o -name '*.cpp' | xargs clang-format --dry-run --Werror

step "configure"
cmake --preset dev

step "build"
# A translation unit of CGAL takes up to 2 GB; more jobs than that allows would swap.
jobs=$(awk '/MemAvailable/ { n = int($2 / 2000000); print n < 1 ? 1 : n }' /proc/meminfo)
[ "$jobs" -le "$(nproc)" ] || jobs=$(nproc)
cmake --build --preset dev --parallel "$jobs"

step "every public header compiles alone"
cmake --build --preset dev --parallel "$jobs" --target all_verify_interface_header_sets

step "tests"
ctest --preset dev --parallel "$jobs" "$@"
