# SPDX-License-Identifier: BSD-3-Clause
"""What the comparisons of lattices share: who is run, how, and how figures are told."""
import json
import statistics
import subprocess

RANKS = (1, 2)
PRECISIONS = ('double', 'float')


def run(command, ranks):
    mpi = ['mpirun', '--oversubscribe', '--bind-to', 'none', '-np', str(ranks)]
    done = subprocess.run(mpi + command, stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def spread(values):
    return f'{statistics.median(values):.1f} ({min(values):.1f}-{max(values):.1f})'
