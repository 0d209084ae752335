"""A sweep on a Ray cluster: python sweep.py plan.jsonl RUNS [--each N] [--gpus SHARE]

Ray only hands out numbers of runs. `gaitway run` does them, and skips those that are done: a node that is lost costs the
runs it was in, which other nodes do again. All nodes see the plan and the folder of runs (a shared file system).
"""

import argparse
import json
import os
import subprocess

import ray

options = argparse.ArgumentParser()
options.add_argument("plan")
options.add_argument("runs")
options.add_argument("--each", type=int, default=1, help="runs of one task: more for short runs")
options.add_argument("--gpus", type=float, default=0.0, help="share of a GPU that a task takes, such as 0.25")
options.add_argument("--cpus", type=float, default=1.0)
options.add_argument("--gaitway", default="gaitway", help="the program")
options = options.parse_args()
options.plan, options.runs = os.path.abspath(options.plan), os.path.abspath(options.runs)


def work(begin, end, backend):
    command = [options.gaitway, "run", options.plan, "--index", f"{begin}..{end}", "--out", options.runs, "--json", "-q"]
    done = subprocess.run([*command, "--backend", backend], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return {"node": ray.get_runtime_context().get_node_id(), **json.loads(done.stdout)}


with open(options.plan) as plan:
    count = json.loads(plan.readline())["runs"]
ray.init(address="auto", log_to_driver=False)
# A killed worker or a lost node is not the task's fault: it is done again, elsewhere, as often as it takes.
on_cpu = ray.remote(num_cpus=options.cpus, max_retries=-1)(work)
on_gpu = ray.remote(num_cpus=0, num_gpus=options.gpus, max_retries=-1)(work)
tasks = []
for number, begin in enumerate(range(0, count, options.each)):
    # With --gpus every other task goes to a card: both kinds of places work on one plan, and the results are the same. `auto`
    # takes the card, or the CPU where Ray was told of a card that there is not.
    place = on_gpu if options.gpus and number % 2 else on_cpu
    backend = "auto" if place is on_gpu else "cpu"
    tasks.append(place.remote(begin, min(begin + options.each, count), backend))
results = ray.get(tasks)
nodes = {}
for result in results:
    nodes[result["node"]] = nodes.get(result["node"], 0) + result["done"]
keys = ("done", "skipped", "taken")
print(json.dumps({"runs": count, **{key: sum(result[key] for result in results) for key in keys}, "nodes": list(nodes.values())}))
