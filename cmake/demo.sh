#!/bin/sh
# Curves the wing of data/ and draws it before and after, on a bare Debian 12 machine too: sh cmake/demo.sh [degree]
set -eu
cd "$(dirname "$0")/.."
degree=${1:-2}
demo=build/demo

step() { printf '\n== %s\n' "$*"; }

step "packages"
sh cmake/install_dependencies.sh build pictures

step "build"
cmake --preset release
cmake --build --preset release --target recurve_program

step "curve the wing"
mkdir -p "$demo"
build/release/toolkit/apps/recurve curve data/wing_tetrahedra.cgns "$demo/wing_curved.cgns" \
  --degree "$degree" --report "$demo/wing_report.json"

step "pictures"
# Debian's own Python: another one on the path would not see its packages.
/usr/bin/python3 toolkit/doc/render.py "$demo/wing_curved.cgns" "$demo" \
  --patch 'wing_*' --at 0.515 1.47 0 --from 0.1 2.3 0.25 --width 0.12 --section 0.03 0.08

step "done"
echo "curved mesh  $demo/wing_curved.cgns"
echo "report       $demo/wing_report.json"
echo "pictures     $demo/before.png, $demo/after.png, $demo/section.png"
