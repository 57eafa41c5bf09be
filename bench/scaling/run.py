#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Strong scaling of the engine's messages on simulated ranks; see docs/performance/scaling.md.

  run.py DRIVER [--json FILE] [--ranks N,N,...] [--part N] [--svg FILE]

--part 8: an eighth of the bed along x; 384 ranks then have the shares that 3 072 have of all of it.

Prints a table. DRIVER is scaling_driver as built by bench/run.sh.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

from plot import efficiency_plot

HERE = pathlib.Path(__file__).resolve().parent
CORES = 64  # of a node of platform.xml
STEP = 100e-9  # seconds of a core for a particle-step
LISTS = 400e-9  # seconds of a core for the new lists of a grain
STEPS_PER_REBUILD = 50
# Up to so many grains a rank takes those that need no ghosts first; kFewGrains of world_lists.cpp.
FEW_GRAINS = 32768
GRAINS = 793 * 347 * 131  # ScalingBed's
# The simulator's own corrections of latency and bandwidth are those of an old Ethernet cluster.
# Collectives as Open MPI chooses them at these sizes.
OPTIONS = [
    "--log=root.thres:warning", "--cfg=smpi/simulate-computation:no",
    "--cfg=contexts/stack-size:1024", "--cfg=smpi/bw-factor:0:1", "--cfg=smpi/lat-factor:0:1",
    "--cfg=network/weight-S:0", "--cfg=network/crosstraffic:no", "--cfg=smpi/os:0:3e-7:0",
    "--cfg=smpi/or:0:3e-7:0", "--cfg=smpi/allreduce:rdb",
    "--cfg=smpi/barrier:ompi_recursivedoubling",
]


def simulate(driver, ranks, step, lists, cores, overlaps, part):
    with tempfile.TemporaryDirectory() as folder:
        hosts = pathlib.Path(folder) / "hosts"
        hosts.write_text("".join(f"node-{rank * cores // CORES}\n" for rank in range(ranks)))
        command = ["smpirun", "-no-privatize", "-np", str(ranks), "-hostfile", str(hosts),
                   "-platform", str(HERE / "platform.xml"), *OPTIONS, str(driver), "steps",
                   str(step), str(lists), str(cores), str(int(overlaps)), str(part)]
        done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode != 0 or not lines:
        sys.exit(f"scaling: {ranks} ranks: smpirun ended with {done.returncode}\n{done.stdout}")
    return json.loads(lines[-1])


def finish(point):
    """Adds what a rebuild costs each step, and the efficiency against one core alone."""
    cores = point["ranks"] * point["cores"]
    point["rebuild_share"] = (point["rebuild"] + point["exchange"]) / STEPS_PER_REBUILD
    # One core alone makes new lists too.
    point["alone"] = (point["grains"] / cores *
                      (point["step_cost"] + point["lists_cost"] / STEPS_PER_REBUILD))
    point["time_per_step"] = point["step"] + point["rebuild_share"]
    point["efficiency"] = point["alone"] / point["time_per_step"]


HEAD = ("| ranks | grains a rank (most) | ghosts a rank | neighbours | step [ms] | compute | halo | "
        "agree | rebuild, of it migration | efficiency |")


def table_row(point):
    ms = {name: 1e3 * point[name] for name in
          ("time_per_step", "compute", "halo", "agree", "rebuild_share", "exchange")}
    return (f"| {point['ranks']} | {point['grains'] / point['ranks']:.0f} ({point['most']:.0f}) "
            f"| {point['ghosts']:.0f} | {point['neighbours']:.1f} | {ms['time_per_step']:.3f} "
            f"| {ms['compute']:.3f} | {ms['halo']:.3f} | {ms['agree']:.3f} "
            f"| {ms['rebuild_share']:.3f}, {ms['exchange'] / STEPS_PER_REBUILD:.3f} "
            f"| {100 * point['efficiency']:.1f} % |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("driver", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--svg", type=pathlib.Path)
    parser.add_argument("--part", type=int, default=1)
    parser.add_argument("--ranks", default="64,128,256,512,1024,2048,3072,4096")
    options = parser.parse_args()
    driver = options.driver.resolve()
    points = []

    def run(ranks, cores=1):
        share = GRAINS / options.part / ranks
        point = simulate(driver, ranks, STEP, LISTS, cores, share <= FEW_GRAINS, options.part)
        finish(point)
        point["part"] = options.part
        points.append(point)
        print(table_row(point), flush=True)
        if options.json:
            options.json.write_text(json.dumps({"scaling": points}, indent=1) + "\n")

    print(f"{HEAD}\n|{'---|' * 10}")
    for ranks in (int(word) for word in options.ranks.split(",")):
        run(ranks)
    if options.svg:
        options.svg.write_text(efficiency_plot(points))


if __name__ == "__main__":
    main()
