#!/usr/bin/env python3
"""Curves every mesh given and tabulates what was certified: one line of Markdown for each mesh and degree.

usage: certify_meshes.py RECURVE OUT_FOLDER [-p 2,3,4] [--seconds 600] [--sampler "COMMAND"] MESH ...

Columns: cells; cells the straight-sided mesh has wrong (excluded); cells that fail after deformation, and their share; cells
repaired from inside; cells that lost curvature; share of the curved area at full curvature, of all patches and of the least
of them; smallest certified scaled Jacobian; verdict; seconds. COMMAND is called with each result and has to exit with 0 if it
finds no folded cell: a second opinion.
"""
import argparse
import json
import subprocess
import time
from pathlib import Path

HEADER = ("mesh", "p", "cells", "excluded", "failing", "%", "repaired", "reduced", "area at full curvature %",
          "least patch %", "smallest scaled Jacobian", "verdict", "sampler", "s")


def least_patch(validity):
    """share of the curved faces at full curvature of the patch that lost most"""
    lost = {}
    for face in validity["first_reduced_faces"]:
        lost[face["patch"]] = lost.get(face["patch"], 0) + 1
    return lost


def row(arguments, mesh, degree):
    stem = Path(arguments.folder) / f"{Path(mesh).stem}.p{degree}"
    out, report = stem.with_name(stem.name + ".cgns"), stem.with_name(stem.name + ".json")
    report.unlink(missing_ok=True)
    start = time.time()
    try:
        run = subprocess.run([arguments.recurve, "curve", mesh, str(out), "-p", str(degree), "--report", str(report), "-q"],
                             capture_output=True, text=True, timeout=arguments.seconds)
        status, error = run.returncode, run.stderr.strip()
    except subprocess.TimeoutExpired:
        status, error = None, f"no result after {arguments.seconds} s"
    seconds = time.time() - start
    name = Path(mesh).stem
    if not report.exists():
        return [name, degree] + ["-"] * 9 + [error.split(": ")[-1][:80] or f"exit {status}", "-", f"{seconds:.1f}"]
    found = json.loads(report.read_text())
    validity = found["validity"]
    cells = found["cells"]["total"]
    curved = {}
    for patch in found["patches"]:
        curved[patch["name"]] = curved.get(patch["name"], 0) + patch["curved_faces"]
    least = min((100 * (1 - lost / curved[patch]) for patch, lost in least_patch(validity).items() if curved.get(patch)),
                default=100.0)
    smallest = validity["after_restoration"]["smallest_scaled_jacobian"]
    sampled = "-"
    if arguments.sampler:
        sampled = "ok" if subprocess.run([*arguments.sampler.split(), str(out)], capture_output=True).returncode == 0 else "FOLDED"
    failing = validity["failing_cells"]
    return [name, degree, cells, validity["excluded_cells"], failing, f"{100 * failing / max(cells, 1):.3f}",
            validity["repaired_cells"], validity["reduced_cells"], f"{100 * validity['share_at_full_curvature']:.2f}",
            f"{least:.1f}", f"{smallest:.3g}" if smallest is not None else "-",
            "certified" if validity["is_certified"] and status == 0 else f"NOT CERTIFIED ({status})", sampled, f"{seconds:.1f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recurve")
    parser.add_argument("folder")
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("-p", default="2,3,4")
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--sampler", default="")
    arguments = parser.parse_args()
    Path(arguments.folder).mkdir(parents=True, exist_ok=True)
    print("| " + " | ".join(HEADER) + " |\n|" + "---|" * len(HEADER), flush=True)
    for degree in map(int, arguments.p.split(",")):
        for mesh in arguments.meshes:
            print("| " + " | ".join(map(str, row(arguments, mesh, degree))) + " |", flush=True)


if __name__ == "__main__":
    main()
