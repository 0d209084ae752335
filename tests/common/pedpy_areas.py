"""Loads every trajectory file of a folder with PedPy: python pedpy_areas.py FOLDER.

truth.jsonl there has a line [name, [bounds], [obstacle, ..]] for each: the area is what shapely makes of them, of its parts
those with people in, but for slits between them.
"""

import json
import pathlib
import sqlite3
import sys

import pedpy
import shapely

folder = pathlib.Path(sys.argv[1])
count = joined = 0
for line in (folder / "truth.jsonl").read_text().splitlines():
    name, [bounds], obstacles = json.loads(line)
    path = folder / f"{name}.sqlite"
    with sqlite3.connect(path) as connection:
        [[wkt]] = connection.execute("SELECT wkt FROM geometry").fetchall()
    polygon = shapely.from_wkt(wkt)
    assert polygon.geom_type == "Polygon", (name, wkt)
    assert polygon.is_valid, (name, shapely.is_valid_reason(polygon), wkt)
    trajectory = pedpy.load_trajectory_from_jupedsim_sqlite(trajectory_file=path)
    walkable = pedpy.load_walkable_area_from_jupedsim_sqlite(trajectory_file=path)
    assert pedpy.is_trajectory_valid(traj_data=trajectory, walkable_area=walkable), name
    solid = shapely.union_all([shapely.Polygon(ring).buffer(0) for ring in obstacles])
    free = shapely.difference(shapely.Polygon(bounds), solid)
    people = [shapely.Point(x, y) for x, y in zip(trajectory.data.x, trajectory.data.y)]
    parts = [part for part in shapely.get_parts(free) if any(part.contains(point) for point in people)]
    area = sum(part.area for part in parts)
    slit = 0.0 if len(parts) < 2 else 0.1
    assert -0.05 < polygon.area - area < 0.05 + slit, (name, polygon.area, area)
    joined += len(parts) > 1
    count += 1
print(f"ok: {count} places, in {joined} of them people in several parts")
