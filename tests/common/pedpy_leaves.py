"""Compares an evacuation with PedPy's n-t curves: python pedpy_leaves.py FILE.sqlite EVACUATION_JSON.

People vanish in exits that begin at x = 10 and x = -10. PedPy counts who crosses a line half a metre before.
"""

import json
import pathlib
import sys

import pedpy

path, evacuation = pathlib.Path(sys.argv[1]), json.loads(sys.argv[2])
trajectory = pedpy.load_trajectory_from_jupedsim_sqlite(trajectory_file=path)
ours = {one["exit"]: one for one in evacuation["exits"]}
total = 0
for name, x in [("east", 9.5), ("west", -9.5)]:
    line = pedpy.MeasurementLine([(x, -6), (x, 6)])
    n_t, crossings = pedpy.compute_n_t(traj_data=trajectory, measurement_line=line)
    assert n_t.cumulative_pedestrians.max() == ours[name]["left"], (name, n_t, ours)
    total += n_t.cumulative_pedestrians.max()
    for share, key in [(0.5, "time_50"), (0.95, "time_95"), (1.0, "time_100")]:
        count = -(-ours[name]["left"] * round(100 * share) // 100)
        time = n_t[n_t.cumulative_pedestrians >= count].time.min()
        assert 0.1 < ours[name][key] - time < 1.5, (name, key, time, ours[name])
last = trajectory.data.groupby("id").frame.max().sort_values() + 1
for time, count in evacuation["n_t"]:
    assert (last / trajectory.frame_rate <= time + 1e-6).sum() == count, (time, count)
assert total == evacuation["left"] == len(last)
print("ok: as many leave as PedPy counts,", total)
