"""A sweep on a real Ray cluster of this machine: python ray_cluster.py GAITWAY FOLDER [RUNS] [SECONDS]

A head and two workers. A worker and all that it started is killed: once, or with SECONDS every so often, and then another
takes its place. Whatever happens, the runs must be those of FOLDER/serial. RUNS is for the plan's first so many alone.
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

gaitway, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
every = float(sys.argv[3]) if len(sys.argv) > 3 else None
example = pathlib.Path(__file__).resolve().parents[2] / "examples" / "cluster" / "ray_sweep.py"
plan, runs = folder / "plan.jsonl", folder / "ray"
# Ray's heartbeats are patient; a test is not.
patience = {"health_check_initial_delay_ms": 2000, "health_check_period_ms": 500, "health_check_failure_threshold": 4}
os.environ |= {"RAY_USAGE_STATS_ENABLED": "0", "RAYON_NUM_THREADS": "1", "RAY_enable_metrics_collection": "0"}

from ray.cluster_utils import Cluster  # noqa: E402


def offspring(process):
    """All processes that one has started, and those that they have."""
    parents = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            except OSError:
                continue
            parents.setdefault(int(fields[1]), []).append(int(entry.name))
    found, open_ones = [], [process]
    while open_ones:
        for child in parents.get(open_ones.pop(), []):
            found.append(child)
            open_ones.append(child)
    return found


def done():
    return len(list(runs.glob("run=*")))


def worker():
    # a whole GPU by name: tasks take a quarter of it, and find none
    return cluster.add_node(num_cpus=1, num_gpus=1, object_store_memory=80 << 20)


def kill(node):
    raylet = node.all_processes["raylet"][0].process.pid
    for process in [*offspring(raylet), raylet]:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass
    cluster.remove_node(node, allow_graceful=False)


begin = time.monotonic()
head = {"num_cpus": 0, "object_store_memory": 80 << 20, "_system_config": patience}
cluster = Cluster(initialize_head=True, head_node_args=head)
workers = [worker(), worker()]
started, kills = time.monotonic() - begin, 0
try:
    command = [sys.executable, str(example), str(plan), str(runs), "--gaitway", gaitway, "--gpus", "0.25"]
    sweep = subprocess.Popen(command, env={**os.environ, "RAY_ADDRESS": cluster.address}, stdout=subprocess.PIPE, text=True)
    last = time.monotonic()
    while sweep.poll() is None:
        time.sleep(0.1)
        if every is None and kills == 0 and done() >= 4:
            kill(workers.pop())
            kills += 1
        elif every is not None and time.monotonic() - last >= every:
            kill(workers.pop(0))
            workers.append(worker())
            kills, last = kills + 1, time.monotonic()
    output = sweep.stdout.read()
    assert sweep.returncode == 0, output
    found = json.loads(next(line for line in reversed(output.splitlines()) if line.startswith("{")))
finally:
    cluster.shutdown()
print(f"ray: {done()} of {found['runs']} runs on two workers, {kills} killed: by node {found['nodes']};", end=" ")
print(f"{started:.1f} s to start, {time.monotonic() - begin:.1f} s in all")
assert done() == found["runs"] and kills > 0, found
