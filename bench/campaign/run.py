#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How long the manager takes over a large campaign: docs/performance/campaign.md."""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "reliability"))
import run as reliability  # noqa: E402  (the case is the same)


def sweep(runs):
    """Axes of which all combinations are that many runs: slips and loads."""
    slips = 100
    loads = runs // slips
    lines = ["sweep:", "  - axis: slip", "    points:"]
    lines += [f"      - {{label: s{i}, set: {{wheel.slip: {0.5 * i} %}}}}" for i in range(slips)]
    lines += ["  - axis: load", "    points:"]
    lines += [f"      - {{label: w{i}, set: {{wheel.load: {20 + i} N}}}}" for i in range(loads)]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    parser.add_argument("--fake-engine", type=Path, required=True)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--runs", type=int, default=10000)
    parser.add_argument("--chunks", type=int, default=20)
    parser.add_argument("--active", type=int, default=1000)
    args = parser.parse_args()
    args.bin, args.fake_engine = args.bin.resolve(), args.fake_engine.resolve()
    case = reliability.CASE[:reliability.CASE.index("sweep:")]
    result = {"runs": args.runs, "chunks": args.runs * args.chunks}
    with tempfile.TemporaryDirectory(prefix="grouser-campaign-") as folder:
        work = Path(folder)
        yaml = work / "campaign.yaml"
        yaml.write_text("grouser: 1\ncampaign: large\nscheduler: slurm\n"
                        f"resources: {{walltime: 1h, launcher: env, concurrent: {args.active}}}\n"
                        f"chunks: {{count: {args.chunks}}}\n{case}{sweep(args.runs)}")
        calls = work / "calls"
        environment = dict(os.environ, GROUSER_ENGINE=str(args.fake_engine),
                           BENCH_CALLS=str(calls), BENCH_JOBS=str(work / "jobs"),
                           PATH=f"{HERE}/bin:{os.environ['PATH']}")
        (work / "jobs").touch()
        root = work / "root"

        def timed(name, *words):
            calls.write_text("")
            begun = time.time()
            done = subprocess.run([args.bin / "grouser", *words], env=environment, cwd=work,
                                  capture_output=True, text=True, check=False)
            result[name + "_s"] = round(time.time() - begun, 3)
            if done.returncode not in (0, 1):
                sys.exit(f"{words}: {done.stderr}")
            print(f"  {name} {result[name + '_s']} s", file=sys.stderr, flush=True)
            return done

        timed("plan", "plan", yaml)
        timed("submit_dry_run", "submit", "--dry-run", yaml, "--root", root)
        timed("submit", "submit", yaml, "--root", root)
        # The bed settles; its engine is not run.
        bed = next((root / "beds").iterdir())
        token = (bed / "fence").read_text()
        outcome = {"token": token, "code": 0, "reason": "", "by_signal": False, "step": 100,
                   "time": 0.1, "end_time": 0.1, "checkpoint": "c.h5", "state_hash": "h",
                   "particles": 1, "steps_done": 100, "wall_seconds": 1.0, "compute_seconds": 1.0,
                   "checkpoint_seconds": 0.0, "ranks": 1}
        (bed / f"outcome-{token}.json").write_text(json.dumps(outcome))
        (bed / "attempts" / f"{token}.exit").write_text(
            json.dumps({"token": token, "job": "1", "host": "h", "code": 0}))
        timed("tick_that_submits", "tick", "-C", root)
        timed("tick_that_sees_them_run", "tick", "-C", root)
        timed("tick", "tick", "-C", root)
        result["active"] = args.active
        result["tick_scheduler_calls"] = len(calls.read_text().split())
        timed("status", "status", "-C", root)
        result["status_scheduler_calls"] = len(calls.read_text().split())
        timed("status_json", "status", "-C", root, "--json")
        timed("fsck", "fsck", "-C", root)
        (root / "grouser.db").unlink()
        timed("rebuild", "rebuild", "-C", root)
    text = json.dumps({"campaign": result}, indent=2)
    print(text)
    if args.json:
        args.json.write_text(text + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
