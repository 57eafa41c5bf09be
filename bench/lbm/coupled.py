#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Times a suspension of moving spheres, mapped anew every step, beside plain flow of the same run.

The program takes turns between both; each round runs it once for every precision and number of
ranks. Fractions are taken within a turn, then their median.
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
    parser.add_argument('--rounds', type=int, default=3)
    arguments = parser.parse_args()

    rows = {}
    for _ in range(arguments.rounds):
        for precision in PRECISIONS:
            for ranks in RANKS:
                command = [arguments.program, '--precision', precision,
                           '--cells', str(arguments.cells)]
                rows.setdefault((precision, ranks), []).append(run(command, ranks))

    first = rows[('double', 1)][0]
    print(f"D3Q19 TRT, {arguments.cells}^3 periodic, 33 % solids, 125 spheres of"
          f" {first['diameter']:.0f} cells, {arguments.rounds} rounds; MLUPS, median (least-most)")
    print('| precision | ranks | coupled | plain | of plain | bytes per cell |')
    print('|---|---|---|---|---|---|')
    by = {}
    out = {'fraction_of_plain_by': by, 'mlups': {}, 'plain_mlups': {}, 'bytes_per_cell': {}}
    for (precision, ranks), found in rows.items():
        share = statistics.median(r['fraction_of_plain'] for r in found)
        print(f"| {precision} | {ranks} | {spread([r['coupled_mlups'] for r in found])} |"
              f" {spread([r['plain_mlups'] for r in found])} | {share:.2f} |"
              f" {found[0]['bytes_per_cell']:.0f} |")
        for key, value in (('fraction_of_plain_by', share),
                           ('mlups', statistics.median(r['coupled_mlups'] for r in found)),
                           ('plain_mlups', statistics.median(r['plain_mlups'] for r in found)),
                           ('bytes_per_cell', found[0]['bytes_per_cell'])):
            out[key].setdefault(precision, {})[str(ranks)] = value
        if not all(r['finite'] for r in found):
            sys.exit('the flow did not stay finite')
    # The one figure: in double, on both cores.
    out['fraction_of_plain'] = by['double'][str(RANKS[-1])]
    if arguments.json:
        with open(arguments.json, 'w', encoding='utf-8') as file:
            json.dump({'coupled': out}, file, indent=2)


if __name__ == '__main__':
    main()
