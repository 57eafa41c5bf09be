#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Strong scaling of the engine's messages on simulated ranks; see docs/performance/scaling.md.

  run.py DRIVER [--json FILE] [--ranks N,N,...] [--svg FILE] [--layers N]

Prints a table. DRIVER is scaling_driver as built by bench/run.sh. With fewer layers than the bed
has, each grain stands for several, and the network is as much slower: less memory, same times.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from plot import efficiency_plot

HERE = pathlib.Path(__file__).resolve().parent
CORES = 64  # of a node of platform.xml
LAYERS = 131  # of grains on top of each other, as in bed_share.hpp
RATE = 10e6  # particle-steps per second and core
PUBLISHED_RATE = 0.448e6  # of the publication whose bed this is, on cores of 2013
STEPS_PER_REBUILD = 50
# Alltoallv sends as many messages as the square of the ranks: beyond this many the simulator would
# be busy for long, and the time is taken as linear in the ranks.
EXCHANGE_LIMIT = 2048
# The simulator's own corrections of latency and bandwidth are those of an old Ethernet cluster.
# Collectives as Open MPI chooses them at these sizes, but for Alltoallv, whose ring is the one
# that the simulator's memory holds.
OPTIONS = [
    "--log=root.thres:warning", "--cfg=smpi/simulate-computation:no",
    "--cfg=contexts/stack-size:1024", "--cfg=smpi/bw-factor:0:1", "--cfg=smpi/lat-factor:0:1",
    "--cfg=network/weight-S:0", "--cfg=network/crosstraffic:no", "--cfg=smpi/os:0:3e-7:0",
    "--cfg=smpi/or:0:3e-7:0", "--cfg=smpi/allreduce:rdb", "--cfg=smpi/alltoall:bruck",
    "--cfg=smpi/alltoallv:ring", "--cfg=smpi/barrier:ompi_recursivedoubling",
]


def rows_of_nodes(ranks, columns):
    """Node of each rank: as started by default, neighbours in number together."""
    return [rank // CORES for rank in range(ranks)]


def tiles_of_nodes(ranks, columns):
    """Node of each rank: 8 x 8 neighbouring columns together."""
    across = columns[1] // 8
    return [(rank // columns[1] // 8) * across + rank % columns[1] // 8 for rank in range(ranks)]


def thinned_platform(layers):
    share = layers / LAYERS
    return re.sub(r'bw="(\d+)GBps"', lambda match: f'bw="{float(match[1]) * share:.6f}GBps"',
                  (HERE / "platform.xml").read_text())


def simulate(driver, ranks, rate, exchanges, nodes, layers, cores):
    with tempfile.TemporaryDirectory() as folder:
        hosts = pathlib.Path(folder) / "hosts"
        hosts.write_text("".join(f"node-{node}\n" for node in nodes))
        platform = pathlib.Path(folder) / "platform.xml"
        platform.write_text(thinned_platform(layers))
        command = ["smpirun", "-no-privatize", "-np", str(ranks), "-hostfile", str(hosts),
                   "-platform", str(platform), *OPTIONS,
                   f"--cfg=smpi/send-is-detached-thresh:{65536 * layers // LAYERS}", str(driver), "steps",
                   str(rate), str(int(exchanges)), str(layers), str(cores)]
        done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode != 0 or not lines:
        sys.exit(f"scaling: {ranks} ranks: smpirun ended with {done.returncode}\n{done.stdout}")
    return json.loads(lines[-1])


def finish(point, exchange_per_rank, cores):
    """Adds what a rebuild costs each step, and the efficiency against one core alone."""
    is_simulated = point["exchange"] >= 0
    if not is_simulated:
        point["exchange"] = exchange_per_rank * point["ranks"]
    point["exchange_is_simulated"] = is_simulated
    point["rebuild_share"] = (point["rebuild"] + point["exchange"]) / STEPS_PER_REBUILD
    ideal = point["grains"] / point["rate"] / point["ranks"] / cores
    point["ideal"] = ideal
    # One core alone makes new lists too: 400 ns a grain.
    alone = ideal + point["grains"] * 400e-9 / STEPS_PER_REBUILD / point["ranks"] / cores
    point["time_per_step"] = point["step"] + point["rebuild_share"]
    point["efficiency"] = alone / point["time_per_step"]


HEAD = ("| ranks | columns | grains a rank (most) | ghosts a rank | step [ms] | compute | halo | "
        "agree | rebuild, of it migration | efficiency |")


def table_row(point):
    ms = {name: 1e3 * point[name] for name in
          ("time_per_step", "compute", "halo", "agree", "rebuild_share", "exchange")}
    mark = "" if point["exchange_is_simulated"] else "*"
    return (f"| {point['ranks']} | {point['columns'][0]} x {point['columns'][1]} "
            f"| {point['grains'] / point['ranks']:.0f} ({point['most']}) "
            f"| {point['ghosts'] / point['ranks']:.0f} | {ms['time_per_step']:.3f} "
            f"| {ms['compute']:.3f} | {ms['halo']:.3f} | {ms['agree']:.3f} "
            f"| {ms['rebuild_share']:.3f}, {ms['exchange'] / STEPS_PER_REBUILD:.3f}{mark} "
            f"| {100 * point['efficiency']:.1f} % |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("driver", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--svg", type=pathlib.Path)
    parser.add_argument("--ranks", default="64,128,256,512,1024,2048,3072,4096")
    parser.add_argument("--layers", type=int, default=LAYERS)
    options = parser.parse_args()
    driver = options.driver.resolve()

    points, exchange_per_rank = [], 0.0

    def run(name, ranks, rate, nodes, cores=1):
        exchanges = ranks <= EXCHANGE_LIMIT
        point = simulate(driver, ranks, rate, exchanges, nodes, options.layers, cores)
        nonlocal exchange_per_rank
        if exchanges:
            exchange_per_rank = point["exchange"] / ranks
        finish(point, exchange_per_rank, cores)
        point["case"] = name
        points.append(point)
        print(table_row(point), flush=True)
        if options.json:
            options.json.write_text(json.dumps({"scaling": points}, indent=1) + "\n")
        return point

    print(f"{HEAD}\n|{'---|' * 10}")
    for ranks in (int(word) for word in options.ranks.split(",")):
        last = run("plain", ranks, RATE, rows_of_nodes(ranks, None))
        if ranks == 3072:
            widest = last
    if any(point["ranks"] == 3072 for point in points):
        print("\n3072 cores: 8 x 8 columns on a node; a core as fast as the publication's; "
              "384 ranks of 8 cores")
        tiles = tiles_of_nodes(3072, widest["columns"])
        run("tiles", 3072, RATE, tiles)
        run("published speed", 3072, PUBLISHED_RATE, rows_of_nodes(3072, None))
        run("threads", 384, RATE, [rank * 8 // CORES for rank in range(384)], 8)
    if options.svg:
        options.svg.write_text(efficiency_plot(points))


if __name__ == "__main__":
    main()
