#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Kills managers and engines, fills disks, and counts what was lost: docs/reliability.md."""
import argparse
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
KILLS_EACH = 25
ENGINE_KILLS_EACH = 40
CASE = """
case:
  box: {length: 40 cm, width: 12 cm, depth: 10 cm}
  grains:
    density: 2650 kg/m3
    size_curve: [{diameter: 0.4 mm, finer: 0 %}, {diameter: 0.8 mm, finer: 100 %}]
    coarse_graining: 12
  contact:
    grain_grain: {restitution: 0.5, friction: 0.5}
    grain_box: {restitution: 0.5, friction: 0.5}
    grain_wheel: {restitution: 0.5, friction: 0.5}
  bed: {depth: 6 cm}
  wheel:
    diameter: 12.5 cm
    width: 6 cm
    load: 24 N
    forward_speed: 20 cm/s
    travel: 4 cm
    average_travel: 2 cm
  output: {checkpoint_interval: 20 ms}
sweep:
  - axis: slip
    points:
      - {label: towed, set: {wheel.drive: towed}}
      - {label: slip_00, set: {wheel.slip: 0 %}}
      - {label: slip_20, set: {wheel.slip: 20 %}}
"""


class Campaign:
    """One campaign of the real manager with the stand-in engine, and Slurm's stand-ins."""

    def __init__(self, args, folder, head):
        self.grouser = args.bin / "grouser"
        self.folder = folder
        self.root = folder / "root"
        self.batch = folder / "batch"
        (self.batch / "jobs").mkdir(parents=True)
        self.yaml = folder / "campaign.yaml"
        self.yaml.write_text(f"grouser: 1\ncampaign: kills\n{head}{CASE}")
        self.environment = dict(
            os.environ,
            GROUSER_ENGINE=str(args.fake_engine),
            FAKE_BATCH_DIR=str(self.batch),
            FAKE_STEP_MICROSECONDS="200",
            PATH=f"{SOURCE}/tests/fakes/slurm:{os.environ['PATH']}",
        )

    def run(self, *words, **more):
        environment = dict(self.environment, **more)
        return subprocess.run([self.grouser, *words], env=environment, cwd=self.folder,
                              capture_output=True, text=True, timeout=600, check=False)

    def submit(self, **more):
        return self.run("submit", self.yaml, "--root", self.root, "--grace", "0.5", **more)

    def tick(self, **more):
        return self.run("tick", "-C", self.root, "--grace", "0.5", **more)

    def query(self, sql):
        answer = self.run("query", "-C", self.root, "--json", sql)
        return json.loads(answer.stdout)["rows"] if answer.returncode == 0 else []

    def finish(self, seconds=120):
        """Ticks without faults until all is done. @return whether it was"""
        end = time.time() + seconds
        while time.time() < end:
            self.submit() if not (self.root / "grouser.db").exists() else self.tick()
            states = {row["state"] for row in self.query("SELECT state FROM v_runs")}
            if states == {"COMPLETED"}:
                return True
            if states & {"FAILED", "HELD"}:
                self.run("resume", "--all", "-C", self.root, "--grace", "0.5")
            time.sleep(0.1)
        return False

    def hashes(self):
        return self.query("SELECT label, step, state_hash FROM v_runs ORDER BY label")

    def double_runs(self):
        """Run directories in which two engines were at work at once, and jobs of one token."""
        names = [file.read_text().strip() for file in self.batch.glob("jobs/*/name")]
        return len(list(self.root.glob("*/*/overlap"))) + len(names) - len(set(names))

    def lost_jobs(self):
        """Jobs that the scheduler has and no attempt knows."""
        known = {"g" + row["token"] for row in self.query("SELECT token FROM v_attempts")}
        names = {file.read_text().strip() for file in self.batch.glob("jobs/*/name")}
        return len(names - known)


SLURM = ("scheduler: slurm\nresources: {walltime: 1h, launcher: env}\n"
         "chunks: {count: 3}\nretries: {infrastructure: 1000, delay: 0s}\n"
         "limits: {max_chunks: 9000}\n")


def calm_hashes(args, work):
    campaign = Campaign(args, work / "calm", "scheduler: local\n")
    campaign.submit(FAKE_STEP_MICROSECONDS="0")
    return campaign.hashes()


def kill_managers(args, work, calm, seed, lives):
    """One campaign whose managers die so often. @return what to add to the result"""
    rng = random.Random(seed)
    campaign = Campaign(args, work / f"manager-{seed}", SLURM)
    kills = 0
    for _ in range(lives * 8):
        if kills == lives:
            break
        mode = rng.choice(["", "", "timeout", "lost", "busy"])
        (campaign.batch / "sbatch.modes").write_text(mode + "\n" if mode else "")
        (campaign.batch / "squeue.modes").write_text(rng.choice(["", "", "fail\n"]))
        begin = campaign.tick if (campaign.root / "grouser.db").exists() else campaign.submit
        died = begin(GROUSER_FAULT=str(rng.randrange(12))).returncode == -signal.SIGKILL
        kills += died
    for name in ("sbatch", "squeue"):
        (campaign.batch / f"{name}.modes").unlink(missing_ok=True)
    is_done = campaign.finish()
    found = {"manager_kills": kills, "campaigns": 1,
             "lost": (not is_done) + campaign.lost_jobs(),
             "double_runs": campaign.double_runs(),
             "bit_mismatches": int(is_done and campaign.hashes() != calm)}
    if is_done:
        shutil.rmtree(campaign.folder)
    else:
        print(f"seed {seed}: not done in {campaign.folder}", file=sys.stderr)
    return found


def add_up(result, found):
    for key, value in found.items():
        result[key] = result.get(key, 0) + value


def manager_kills(args, work, calm, result):
    """Managers die at every step of their work while sbatch accepts, times out or loses jobs."""
    result["manager_kills"] = 0
    seed = args.seed
    while result["manager_kills"] < args.manager_kills:
        left = args.manager_kills - result["manager_kills"]
        count = min(args.jobs, -(-left // KILLS_EACH))
        with ThreadPoolExecutor(args.jobs) as pool:
            for found in pool.map(lambda one: kill_managers(args, work, calm, one,
                                                            min(KILLS_EACH, -(-left // count))),
                                  range(seed, seed + count)):
                add_up(result, found)
        seed += count
        print(f"  {result['manager_kills']} managers killed", file=sys.stderr, flush=True)


def engine_command(args, folder, bed=None):
    command = [args.bin / "grouser-engine", "--run-dir", folder, "--token", "reliability"]
    return command + (["--bed", bed] if bed else [])


def prepare_case(folder, wheel):
    (folder / "checkpoints").mkdir(parents=True)
    text = (HERE / "case.yaml").read_text()
    (folder / "case.yaml").write_text(text if wheel else text[:text.index("\nwheel:") + 1])
    (folder / "fence").write_text("reliability")


def outcome_of(folder):
    return json.loads((folder / "outcome-reliability.json").read_text())


def run_engine(command, **more):
    return subprocess.run(command, env=dict(os.environ, **more), capture_output=True, timeout=300,
                          check=False).returncode


def kill_engines(args, work, bed, straight, duration, seed, lives):
    """One run whose engines die so often. @return what to add to the result"""
    rng = random.Random(seed)
    folder = work / f"killed-{seed}"
    prepare_case(folder, wheel=True)
    kills = in_checkpoint = 0
    code = None
    while code is None:
        if kills == lives:
            code = run_engine(engine_command(args, folder, bed))
            break
        engine = subprocess.Popen(engine_command(args, folder, bed), stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL)
        try:
            code = engine.wait(rng.uniform(0.0, 0.5 * duration))
        except subprocess.TimeoutExpired:
            engine.kill()
            engine.wait()
            kills += 1
            in_checkpoint += any(not file.with_suffix(".json").exists()
                                 for file in (folder / "checkpoints").glob("*.h5"))
    same = code == 0 and outcome_of(folder)["state_hash"] == outcome_of(straight)["state_hash"]
    same = same and (folder / "series.csv").read_bytes() == (straight / "series.csv").read_bytes()
    shutil.rmtree(folder)
    return {"engine_kills": kills, "engine_kills_in_checkpoint": in_checkpoint,
            "bit_mismatches": int(not same)}


def engine_kills(args, work, result):
    """The real engine dies at random times, many of them inside a checkpoint."""
    bed = work / "bed"
    prepare_case(bed, wheel=False)
    assert run_engine(engine_command(args, bed)) == 0, "the bed does not settle"
    straight = work / "straight"
    prepare_case(straight, wheel=True)
    begun = time.time()
    assert run_engine(engine_command(args, straight, bed)) == 0, "the wheel does not run"
    duration = time.time() - begun
    result["engine_kills"] = result["engine_kills_in_checkpoint"] = 0
    seed = args.seed
    while result["engine_kills"] < args.engine_kills:
        left = args.engine_kills - result["engine_kills"]
        count = min(args.jobs, -(-left // ENGINE_KILLS_EACH))
        with ThreadPoolExecutor(args.jobs) as pool:
            for found in pool.map(lambda one: kill_engines(args, work, bed, straight, duration, one,
                                                           min(ENGINE_KILLS_EACH, -(-left // count))),
                                  range(seed, seed + count)):
                add_up(result, found)
        seed += count
        print(f"  {result['engine_kills']} engines killed", file=sys.stderr, flush=True)
    return bed, outcome_of(straight)["state_hash"]


def no_space(args, work, bed, straight, calm, result):
    """Every call of engine and manager that needs room fails in its turn, and all after it."""
    shim = work / "no_space.so"
    subprocess.run(["gcc", "-shared", "-fPIC", "-O1", "-w", "-o", shim, HERE / "no_space.c",
                    "-ldl"], check=True)
    count = work / "count"

    def calls_of(action):
        action(LD_PRELOAD=str(shim), NO_SPACE_COUNT=str(count))
        return int(count.read_text())

    def stride(calls, wanted):
        return range(1, calls + 1, max(1, calls // max(wanted, 1)))

    folder = work / "full"

    def start_engine(**more):
        shutil.rmtree(folder, ignore_errors=True)
        prepare_case(folder, wheel=True)
        return run_engine(engine_command(args, folder, bed), NO_SPACE_BELOW=str(folder),
                          NO_SPACE_IN="grouser-engine", **more)

    calls = calls_of(start_engine)
    tried = 0
    for at in stride(calls, args.no_space):
        code = start_engine(LD_PRELOAD=str(shim), NO_SPACE_AT=str(at))
        manifests = list((folder / "checkpoints").glob("*.json"))
        sizes = all(file.with_suffix(".h5").exists() and
                    file.with_suffix(".h5").stat().st_size == json.loads(file.read_text())["bytes"]
                    for file in manifests)
        again = run_engine(engine_command(args, folder, bed))
        good = code in (40, -signal.SIGABRT, 0) and sizes and again == 0
        good = good and outcome_of(folder)["state_hash"] == straight
        if not good:
            print(f"engine, call {at}: code {code}, then {again}", file=sys.stderr)
        result["lost"] += not good
        tried += 1
    result["no_space_engine"] = tried

    campaign_folder = work / "full-manager"

    def start_manager(**more):
        shutil.rmtree(campaign_folder, ignore_errors=True)
        campaign = Campaign(args, campaign_folder, SLURM)
        campaign.root.mkdir()
        code = campaign.submit(NO_SPACE_BELOW=str(campaign.root), NO_SPACE_IN="grouser",
                               **more).returncode
        return campaign, code

    calls = calls_of(start_manager)
    tried = 0
    for at in stride(calls, args.no_space):
        campaign, code = start_manager(LD_PRELOAD=str(shim), NO_SPACE_AT=str(at))
        good = code in (0, 1, 40) and campaign.finish() and campaign.hashes() == calm
        if not good:
            print(f"manager, call {at}: code {code}", file=sys.stderr)
        result["lost"] += not good
        result["double_runs"] += campaign.double_runs()
        tried += 1
    result["no_space_manager"] = tried


def two_ticks(args, work, calm, result):
    """Two managers at once: one works, the other waits its turn or says who is at work."""
    campaign = Campaign(args, work / "two", SLURM)
    campaign.submit()
    said = 0
    for _ in range(args.two_ticks):
        pair = [subprocess.Popen([campaign.grouser, "tick", "-C", campaign.root, "--grace", "0.5"],
                                 env=campaign.environment, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True) for _ in range(2)]
        for one in pair:
            _, error = one.communicate(timeout=120)
            said += one.returncode == 75 and "is at work on this campaign" in error
            result["lost"] += one.returncode not in (0, 1, 75)
    result["two_ticks"] = args.two_ticks
    result["two_ticks_busy"] = said
    done = campaign.finish()
    result["lost"] += not done
    result["double_runs"] += campaign.double_runs()
    result["bit_mismatches"] += campaign.hashes() != calm


def scenarios(args, result):
    """Each scenario's tests by name; true when there is one and all pass."""
    passed = {}
    listing = subprocess.run([args.unit_tests, "--gtest_list_tests"], capture_output=True,
                             text=True, check=True).stdout
    for number in range(1, 25):
        name = f"S{number:02d}"
        if not re.search(rf"^  {name}", listing, re.M):
            continue
        done = subprocess.run([args.unit_tests, f"--gtest_filter=*.{name}*"], capture_output=True,
                              check=False)
        passed[str(number)] = done.returncode == 0
    result["scenarios"] = passed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    parser.add_argument("--fake-engine", type=Path, required=True)
    parser.add_argument("--unit-tests", type=Path, required=True)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--manager-kills", type=int, default=1000)
    parser.add_argument("--engine-kills", type=int, default=500)
    parser.add_argument("--no-space", type=int, default=100, help="calls tried; 0 = all")
    parser.add_argument("--jobs", type=int, default=4, help="campaigns at work at one time")
    parser.add_argument("--two-ticks", type=int, default=100)
    args = parser.parse_args()
    args.bin, args.fake_engine = args.bin.resolve(), args.fake_engine.resolve()
    result = {"lost": 0, "double_runs": 0, "bit_mismatches": 0, "campaigns": 0}
    begun = time.time()
    with tempfile.TemporaryDirectory(prefix="grouser-reliability-") as folder:
        work = Path(folder)
        calm = calm_hashes(args, work)
        manager_kills(args, work, calm, result)
        bed, straight = engine_kills(args, work, result)
        no_space(args, work, bed, straight, calm, result)
        two_ticks(args, work, calm, result)
    scenarios(args, result)
    result["seconds"] = round(time.time() - begun, 1)
    text = json.dumps({"reliability": result}, indent=2)
    print(text)
    if args.json:
        args.json.write_text(text + "\n")
    return int(result["lost"] + result["double_runs"] + result["bit_mismatches"] > 0 or
               not all(result["scenarios"].values()))


if __name__ == "__main__":
    sys.exit(main())
