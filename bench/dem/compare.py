#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Times grouser and its peers on one bed in interleaved rounds; prints a table, checks agreement.

Each round runs every code once, one after another, so that what slows the machine for a while slows
all of them; ratios are taken within a round, then their median.
Ends with 1 when a code's bed differs from grouser's by more than its bound, or a code failed.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

DECKS = pathlib.Path(__file__).resolve().parent
RANKS = (1, 2)
THREADS = 'threads2'  # one rank of two threads; beside peers on two cores, however they use them
PROGRAM = {'lammps': 'lmp', 'liggghts': 'liggghts', 'yade': 'yade'}  # of the Debian packages
# Case: code -> input deck.
CASES = {
    'plain': {'grouser': [], 'lammps': 'lammps.in', 'liggghts': 'liggghts.in', 'yade': 'yade.py'},
    'rolling': {'grouser': ['--rolling'], 'lammps': 'lammps_rolling.in',
                'liggghts': 'liggghts_rolling.in'},
    'wheel': {'grouser': [], 'liggghts': 'liggghts_wheel.in'},
}
# How far a peer's bed may be from grouser's after the timed window, relative. All start from rest
# in the same places without tangential forces, so that the bed lets go and falls back onto
# friction: a wrong law shows in the kinetic energy at once. Seen after 200 steps: friction 0.4
# instead of 0.5 +32 %, Young's modulus 10 % too low +54 %, no rolling resistance +170 %, a wheel
# that does not turn +7 %. (The limit of the rolling moment does not show: few contacts reach it.)
# With the same law there remain the integrators (half a step between position and velocity) and
# what each code does where the law says little (spring of a shrinking contact, arm of the friction
# force, edges of a mesh): 3.5 % of the energy and 0.2 % of contacts and overlap were seen.
SAME_LAW = {'kinetic_energy_J': 0.05, 'coordination': 0.005, 'mean_overlap_m': 0.005}
BOUNDS = {
    # Damping that grows as d^(1/2) instead of d^(1/4), equal at the mean overlap only: 12 % seen.
    ('plain', 'lammps'): {'kinetic_energy_J': 0.2, 'coordination': 0.01, 'mean_overlap_m': 0.01},
    # A rolling spring of constant stiffness, right at the mean overlap only: 7 % seen.
    ('rolling', 'lammps'): {**SAME_LAW, 'kinetic_energy_J': 0.1},
    # The same program on other ranks: bit for bit the same trajectory.
    **{(case, 'grouser'): dict.fromkeys(SAME_LAW, 0.0) for case in CASES},
}


class Bench:
    def __init__(self, arguments):
        self.program = arguments.dem_bench
        self.directory = {'plain': arguments.bed, 'rolling': arguments.bed,
                          'wheel': arguments.wheel}
        self.warm_up, self.steps, self.rounds = (100, 100, 1) if arguments.quick else (200, 400, 5)
        self.scratch = pathlib.Path(tempfile.mkdtemp(prefix='dem_bench-'))
        self.rates = {}    # (case, code, ranks or THREADS) -> particle-steps/s of each round
        self.beds = {}     # the same -> what dem_bench measures of the state left
        self.builds = {}   # the same -> neighbour lists made while timed, where the code tells
        self.faults = {}   # (case, code) -> why there is no rate
        self.memory = []   # bytes per particle of grouser, plain case on one rank
        self.particles = {case: sum(1 for _ in open(directory + '/bed.txt'))
                          for case, directory in self.directory.items()}

    def command(self, case, code, ranks, state):
        deck = CASES[case][code]
        threads = ['--threads', '2'] if ranks == THREADS else []
        mpi = ['mpirun', '--oversubscribe', '--bind-to', 'none', '-np',
               '1' if threads else str(ranks)]
        steps, warm_up, directory = str(self.steps), str(self.warm_up), self.directory[case]
        if code == 'grouser':
            return mpi + [self.program, 'time', directory, '--steps', steps, '--warm-up', warm_up,
                          '--state', state] + threads + deck
        if code == 'yade':
            return ['yade', '-n', '-x', f'-j{ranks}', str(DECKS / deck), directory, warm_up, steps,
                    state]
        return mpi + [PROGRAM[code], '-var', 'data', directory, '-var', 'warm_up', warm_up, '-var',
                      'steps', steps, '-var', 'state', state, '-log', 'none', '-in',
                      str(DECKS / deck)]

    def run(self, case, code, ranks):
        """One run of one code: its rate is kept, or why there is none."""
        if (case, code) in self.faults:
            return
        if code in PROGRAM and not shutil.which(PROGRAM[code]):
            self.faults[case, code] = 'not installed'
            return
        state = str(self.scratch / f'{case}-{code}-{ranks}')
        done = subprocess.run(self.command(case, code, ranks, state), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, cwd=self.scratch)
        seconds = seconds_of(code, self.steps, done.stdout)
        if done.returncode != 0 or seconds is None:
            self.faults[case, code] = 'failed'
            print(done.stdout[-2000:], file=sys.stderr)
            return
        rate = self.particles[case] * self.steps / seconds
        print(f'bench: {case} {code} {ranks}: {rate / 1e6:.2f} M/s', file=sys.stderr)
        self.rates.setdefault((case, code, ranks), []).append(rate)
        if code == 'grouser' and case == 'plain' and ranks == 1:
            self.memory.append(json.loads(last_json(done.stdout))['bytes_per_particle'])
        if builds := re.findall(r'Neighbor list builds = (\d+)', done.stdout):
            # The first run is the warm-up, the second the timed one.
            self.builds[case, code, ranks] = builds[1]
        if (case, code, ranks) not in self.beds:
            self.beds[case, code, ranks] = json.loads(last_json(subprocess.run(
                [self.program, 'measure', self.directory[case], state], check=True, text=True,
                stdout=subprocess.PIPE).stdout))

    def run_all(self):
        for _ in range(self.rounds):
            for ranks in RANKS:
                for case, codes in CASES.items():
                    for code in codes:
                        self.run(case, code, ranks)
                        if code == 'grouser' and ranks == 2:
                            self.run(case, code, THREADS)

    def peers(self, case):
        """How many peers were timed."""
        return sum(1 for code in CASES[case] if code != 'grouser' and (case, code, 1) in self.rates)

    def ratio(self, case, ranks):
        """Median over rounds of grouser's rate over the best peer's of the same round."""
        cores = 2 if ranks == THREADS else ranks
        peers = [self.rates[case, code, cores] for code in CASES[case]
                 if code != 'grouser' and (case, code, cores) in self.rates]
        own = self.rates.get((case, 'grouser', ranks))
        if not own or not peers:
            return None
        return statistics.median(rate / max(best) for rate, *best in zip(own, *peers))


def last_json(text):
    return [line for line in text.splitlines() if line.startswith('{')][-1]


def seconds_of(code, steps, output):
    """Time of the stepping loop as each code tells it."""
    if code == 'grouser':
        found = re.findall(r'"seconds":([0-9.e+-]+)', output)
    elif code == 'yade':
        found = re.findall(r'yade seconds ([0-9.e+-]+)', output)
    else:  # the last is the timed one; the warm-up may have as many steps
        found = re.findall(rf'Loop time of ([0-9.e+-]+) on \d+ procs for {steps} steps', output)
    return float(found[-1]) if found else None


def machine():
    model = re.search(r'model name\s*: (.*)', open('/proc/cpuinfo').read())
    load = os.getloadavg()[0]
    name = model.group(1) if model else 'unknown processor'
    return (f'{datetime.datetime.now():%Y-%m-%d %H:%M}, {os.cpu_count()} x {name}, '
            f'load before the first run {load:.1f}')


def cell(rates):
    if not rates:
        return '-'
    text = f'{statistics.median(rates) / 1e6:.2f}'
    return text if len(rates) == 1 else f'{text} ({min(rates) / 1e6:.2f}-{max(rates) / 1e6:.2f})'


def print_rates(bench):
    print('\n| case | code | 1 rank | 2 ranks | 2 threads |\n|---|---|---|---|---|')
    for case, codes in CASES.items():
        for code in codes:
            if (case, code) in bench.faults:
                row = [bench.faults[case, code], '', '']
            else:
                one, two, threads = (cell(bench.rates.get((case, code, ranks)))
                                     for ranks in (*RANKS, THREADS))
                row = [one, '-', two] if code == 'yade' else [one, two, threads]
            print('| ' + ' | '.join([case, code] + row) + ' |')
        ratios = [bench.ratio(case, ranks) for ranks in (*RANKS, THREADS)]
        row = ['-' if ratio is None else f'**{ratio:.2f}**' for ratio in ratios]
        name = f'grouser / best of {bench.peers(case)} peers'
        print('| ' + ' | '.join([case, name] + row) + ' |')
    print('\nM particle-steps/s, median (least-most) of '
          f'{bench.rounds} rounds of {bench.steps} steps after {bench.warm_up}; '
          f'{", ".join(f"{case} {count}" for case, count in bench.particles.items())} particles. '
          'Two threads are compared with the best peer on two cores.')
    if bench.memory:
        print(f'Memory of grouser, plain, 1 rank: {statistics.median(bench.memory):.0f} bytes per '
              'particle.')


def print_agreement(bench):
    """The beds that the codes left, beside grouser's. Returns whether all are within bounds."""
    print('\n| case | code | ranks | kinetic energy [J] | coordination | mean overlap [m] '
          '| list builds | |\n|---|---|---|---|---|---|---|---|')
    agree = True
    for (case, code, ranks), bed in bench.beds.items():
        own = bench.beds.get((case, 'grouser', 1))
        off = ['no grouser'] if own is None else [
            f'{name} off by {bed[name] / own[name] - 1:+.1%}, allowed {bound:.1%}'
            for name, bound in BOUNDS.get((case, code), SAME_LAW).items()
            if not abs(bed[name] / own[name] - 1) <= bound]
        agree = agree and not off
        builds = bench.builds.get((case, code, ranks), '-')
        figures = ' | '.join(f'{value:.4g}' for value in bed.values())
        verdict = '; '.join(off) or 'agrees'
        print(f'| {case} | {code} | {ranks} | {figures} | {builds} | {verdict} |')
    return agree


def write_json(bench, file):
    out = {}
    for case, codes in CASES.items():
        out[f'dem.peers.{case}'] = bench.peers(case)
        for ranks in (*RANKS, THREADS):
            if (ratio := bench.ratio(case, ranks)) is not None:
                out[f'dem.ratio_vs_best_peer.{case}.{ranks}'] = ratio
            for code in codes:
                if rates := bench.rates.get((case, code, ranks)):
                    name = f'dem.particle_steps_per_s.{code}.{case}.{ranks}'
                    out[name] = statistics.median(rates)
    if bench.memory:
        out['dem.bytes_per_particle'] = statistics.median(bench.memory)
    with open(file, 'w') as stream:
        json.dump(out, stream, indent=2)
        stream.write('\n')


def main():
    parser = argparse.ArgumentParser(prog='bench/run.sh dem')
    parser.add_argument('dem_bench', help=argparse.SUPPRESS)
    parser.add_argument('bed', help=argparse.SUPPRESS)
    parser.add_argument('wheel', help=argparse.SUPPRESS)
    parser.add_argument('--json', metavar='FILE', help='write the figures to a file, too')
    parser.add_argument('--quick', action='store_true', help='one round of few steps')
    arguments = parser.parse_args()
    print(f'DEM benchmark, {machine()}', flush=True)
    bench = Bench(arguments)
    try:
        bench.run_all()
    finally:
        shutil.rmtree(bench.scratch)
    print_rates(bench)
    agree = print_agreement(bench)
    if arguments.json:
        write_json(bench, arguments.json)
    if not agree:
        print('bench: a bed is out of bounds', file=sys.stderr)
    sys.exit(0 if agree and 'failed' not in bench.faults.values() else 1)


if __name__ == '__main__':
    main()
