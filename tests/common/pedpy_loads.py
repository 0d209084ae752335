"""Loads a trajectory file with PedPy: python pedpy_loads.py FILE AGENTS FRAMES RATE AREA (area 0: none in the file)."""

import pathlib
import sys

import pedpy

path, agents, frames, rate, area = pathlib.Path(sys.argv[1]), *map(float, sys.argv[2:6])
load = pedpy.load_trajectory_from_jupedsim_sqlite if path.suffix == ".sqlite" else pedpy.load_trajectory_from_txt
trajectory = load(trajectory_file=path)
assert trajectory.data.id.nunique() == agents, trajectory.data
assert trajectory.data.frame.nunique() == frames, trajectory.data
assert abs(trajectory.frame_rate - rate) < 1e-6, trajectory.frame_rate

if area > 0:
    walkable = pedpy.load_walkable_area_from_jupedsim_sqlite(trajectory_file=path)
    assert abs(walkable.area - area) < 1e-3 * area, (walkable.area, area)
    assert pedpy.is_trajectory_valid(traj_data=trajectory, walkable_area=walkable)

speed = pedpy.compute_individual_speed(traj_data=trajectory, frame_step=2)
assert abs(speed.speed.mean() - 1.2) < 0.01, speed.speed.mean()
print("ok", path.name, len(trajectory.data), "rows")
