#!/bin/sh
# Installs what recurve needs on Debian 12 (or a derivative with the same packages).
#
#   sh cmake/install_dependencies.sh [build] [pictures] [test]
#
# build      compiler, CMake and the libraries that the program links
# pictures   what cmake/demo.sh draws with
# test       Catch2, OpenMesh, TetGen, the foreign readers that check our files, clang-format
#
# Without an argument: all of them. Needs root, or sudo. Does nothing when everything is there already.
set -eu

build="g++ cmake ninja-build ccache libcgal-dev libeigen3-dev libboost-dev libtbb-dev libcgns-dev libhdf5-dev
       libcli11-dev nlohmann-json3-dev libfmt-dev libtomlplusplus-dev libcairo2-dev"
pictures="python3 python3-numpy python3-h5py python3-matplotlib"
test="python3 python3-numpy python3-h5py python3-matplotlib python3-vtk9 python3-gmsh catch2 libopenmesh-dev libtet1.5-dev cgns-convert
      clang-format"

fail() {
  echo "install_dependencies.sh: $*" >&2
  exit 1
}

packages=""
for group in "${@:-all}"; do
  case "$group" in
  build) packages="$packages $build" ;;
  pictures) packages="$packages $pictures" ;;
  test) packages="$packages $test" ;;
  all) packages="$packages $build $pictures $test" ;;
  *) fail "unknown group '$group'; the groups are build, pictures and test" ;;
  esac
done

command -v dpkg-query >/dev/null 2>&1 || fail "this system has no Debian packages; please install by hand:" $packages

missing=""
for package in $packages; do
  case "$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null)" in
  "install ok installed") ;;
  *) case "$missing " in *" $package "*) ;; *) missing="$missing $package" ;; esac ;;
  esac
done
[ -n "$missing" ] || exit 0

echo "installing:$missing"
as_root=""
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null 2>&1 || fail "neither root nor sudo: as root, please run apt-get install$missing"
  as_root="sudo"
fi
# env keeps the setting through sudo.
apt="$as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Acquire::Retries=3"
$apt update || fail "apt-get update failed"
$apt install --no-install-recommends $missing || fail "could not install:$missing"
