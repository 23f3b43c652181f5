#!/usr/bin/env python3
"""How many cells fold where only the surface is curved, and how many after the layers behind it have followed.

    fold_table.py PROGRAM MESH ... [--degrees 2 3] [--options ...] [--sample SCRIPT]

PROGRAM is the program recurve; every MESH is curved with `--histogram`, and the certified Jacobians of its report become a line of
a Markdown table. --options are handed to `recurve curve` for all meshes, MESH=PATCHES keeps patches straight there. --sample names a
program that samples the Jacobians of a CGNS file on its own, whose last line is added."""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile


def curve(arguments, mesh, keep, degree, folder):
    output = folder / f'{mesh.stem}_p{degree}.cgns'
    report = folder / f'{mesh.stem}_p{degree}.json'
    command = [arguments.program, 'curve', str(mesh), str(output), '-p', str(degree), '--quiet',
               '--report', str(report), '--histogram', str(report.with_suffix('.svg'))]
    command += ['--keep', keep] if keep else []
    done = subprocess.run(command + arguments.options, capture_output=True, text=True)
    if not report.exists():
        print(done.stderr, file=sys.stderr)
        return None
    sampled = ''
    if arguments.sample:
        lines = subprocess.run([arguments.python, arguments.sample, str(output)], capture_output=True,
                               text=True).stdout.splitlines()
        sampled = lines[-1].split(' cells')[0] if lines else 'failed'
    if not arguments.folder:
        output.unlink()
    return json.loads(report.read_text()), sampled


def line(mesh, degree, report, sampled):
    stages = {stage['stage']: stage for stage in report['jacobians']}
    seconds = {stage['stage']: stage['seconds'] for stage in report['stages']}
    cells = [mesh.stem, degree, report['cells']['total'], stages['straight']['wrong_before']]
    for name in ('curved', 'deformed'):
        stage = stages.get(name)
        cells += [stage['inverted'], f"{stage['least_scaled']:.3g}"] if stage else ['', '']
    cells += [f"{stages['straight']['least_scaled']:.3g}", report['cells']['straight'],
              f"{seconds.get('deform interior', 0):.1f}", sampled]
    return '| ' + ' | '.join(str(cell) for cell in cells) + ' |'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program')
    parser.add_argument('meshes', nargs='+', metavar='MESH')
    parser.add_argument('--degrees', nargs='+', type=int, default=[2, 3])
    parser.add_argument('--options', type=str.split, default=[], help='in one word, quoted')
    parser.add_argument('--sample', help='program that samples a CGNS file')
    parser.add_argument('--python', default=sys.executable, help='what runs it')
    parser.add_argument('--folder', type=pathlib.Path, help='where to leave meshes, reports and histograms')
    arguments = parser.parse_args()
    print('| mesh | p | cells | wrong before | inverted, surface curved | least | inverted, deformed | least | least, straight |'
          ' exactly straight | s | folded at samples |')
    print('|---|---|---|---|---|---|---|---|---|---|---|---|')
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name in arguments.meshes:
            mesh, _, keep = name.partition('=')
            for degree in arguments.degrees:
                done = curve(arguments, pathlib.Path(mesh), keep, degree, folder)
                print(line(pathlib.Path(mesh), degree, *done) if done else f'| {mesh} | {degree} | failed |', flush=True)


if __name__ == '__main__':
    main()
