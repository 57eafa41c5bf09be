#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Times plain flow on a lattice in interleaved rounds, beside its own limit of bandwidth.

Each round runs every code once, one after another; ratios are taken within a round, then their
median. The limit is measured by lbm_bench itself between its timed steps: as many streams of memory
as the lattice has velocities, each number read, changed and written back.
"""
import argparse
import json
import statistics
import sys

from turns import PRECISIONS, RANKS, run, spread


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('program')
    parser.add_argument('--json')
    parser.add_argument('--cells', type=int, default=128)
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--others', action='store_true', help='other lattices and collisions too')
    arguments = parser.parse_args()
    cells = str(arguments.cells)

    ours = {}
    for _ in range(arguments.rounds):
        for precision in PRECISIONS:
            for ranks in RANKS:
                command = [arguments.program, '--precision', precision, '--cells', cells]
                ours.setdefault((precision, ranks), []).append(run(command, ranks))

    print(f'D3Q19 TRT, {cells}^3 periodic, {arguments.rounds} rounds; MLUPS, median (least-most)')
    print('| precision | ranks | grouser | limit | of the limit | of one stream | bytes per cell |')
    print('|---|---|---|---|---|---|---|')
    figures = {'lbm': {'fraction_of_bandwidth_limit': {}, 'mlups': {}, 'limit_mlups': {},
                       'bytes_per_cell': {}}}
    out = figures['lbm']
    for (precision, ranks), rows in ours.items():
        share = statistics.median(r['mlups'] / r['limit_mlups'] for r in rows)
        one = statistics.median(r['mlups'] / r['limit_mlups'] * r['streams_gb_per_s'] /
                                r['one_stream_gb_per_s'] for r in rows)
        bytes_per_cell = rows[0]['bytes_per_cell']
        print(f"| {precision} | {ranks} | {spread([r['mlups'] for r in rows])} |"
              f" {spread([r['limit_mlups'] for r in rows])} | {share:.2f} | {one:.2f} |"
              f" {bytes_per_cell:.0f} |")
        for key, value in (('fraction_of_bandwidth_limit', share),
                           ('mlups', statistics.median(r['mlups'] for r in rows)),
                           ('limit_mlups', statistics.median(r['limit_mlups'] for r in rows)),
                           ('bytes_per_cell', bytes_per_cell)):
            out[key].setdefault(precision, {})[str(ranks)] = value
        if not all(r['finite'] for r in rows):
            sys.exit('the flow did not stay finite')

    if arguments.others:
        print('\n| lattice | collision | precision | MLUPS, 1 rank | of the limit |')
        print('|---|---|---|---|---|')
        for lattice in ('D3Q15', 'D3Q19', 'D3Q27'):
            for collision in ('bgk', 'trt', 'mrt', 'les'):
                for precision in PRECISIONS:
                    r = run([arguments.program, '--lattice', lattice, '--collision', collision,
                             '--precision', precision, '--cells', cells, '--steps', '10'], 1)
                    print(f"| {lattice} | {collision} | {precision} | {r['mlups']:.1f} |"
                          f" {r['mlups'] / r['limit_mlups']:.2f} |")
    if arguments.json:
        with open(arguments.json, 'w', encoding='utf-8') as file:
            json.dump(figures, file, indent=2)


if __name__ == '__main__':
    main()
