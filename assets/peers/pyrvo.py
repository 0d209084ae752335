# RVO2 as the package pyrvo has it, for `gaitway bench --peers`: a line of JSON, then "step N" and "state", until the input ends.
import json
import sys
import time
from importlib.metadata import version

import pyrvo

crowd = json.loads(sys.stdin.readline())
side = crowd["side"]
sim = pyrvo.RVOSimulator()
sim.set_time_step(crowd["time_step"])
sim.set_agent_defaults(
    crowd["neighbour_distance"],
    int(crowd["neighbours"]),
    crowd["horizon"],
    crowd["horizon"],
    crowd["radius"],
    crowd["max_speed"],
)
agents = range(len(crowd["position"]))
for i in agents:
    sim.add_agent(tuple(crowd["position"][i]))
    velocity = tuple(crowd["velocity"][i])
    sim.set_agent_velocity(i, velocity)
    sim.set_agent_pref_velocity(i, velocity)
print("pyrvo " + version("pyrvo"), flush=True)

for line in sys.stdin:
    order = line.split()
    if order[0] == "step":
        spent = 0.0
        for _ in range(int(order[1])):
            begin = time.perf_counter()
            sim.do_step()
            spent += time.perf_counter() - begin
            for i in agents:  # opposite sides are joined, which RVO2 cannot do: not timed
                p = sim.get_agent_position(i)
                x, y = p.x, p.y
                if not (0.0 <= x < side and 0.0 <= y < side):
                    sim.set_agent_position(i, (x % side, y % side))
        print(spent * 1e3, flush=True)
    else:
        points = lambda get: [[v.x, v.y] for v in map(get, agents)]
        print(
            json.dumps({"position": points(sim.get_agent_position), "velocity": points(sim.get_agent_velocity)}),
            flush=True,
        )
