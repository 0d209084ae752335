"""Reads a folder of runs as one table, with polars, pandas and DuckDB: python tables.py FOLDER

Each run=NAME below it has trajectories.parquet and agents.parquet of 12 people and 20 frames.
"""

import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
everything = str(folder / "run=*" / "trajectories.parquet")
agents = str(folder / "run=*" / "agents.parquet")


def with_polars():
    import polars

    table = polars.scan_parquet(everything, hive_partitioning=True)
    people = polars.scan_parquet(agents, hive_partitioning=True)
    both = table.join(people, on=["run", "id"]).filter(polars.col("is_person")).collect()
    assert both.height == 480 and set(both["run"]) == {"a", "b"}, both
    assert both["emotion"].null_count() == 0 and both["happy"].null_count() == 480, both
    steps = both.sort("run", "id", "frame").with_columns(polars.col("x").diff().over("run", "id").alias("dx"))
    assert steps["dx"].abs().max() < 0.4, steps
    return [both["x"].cast(polars.Float64).sum(), both["y"].cast(polars.Float64).sum()]


def with_pandas():
    import pandas

    table = pandas.concat(pandas.read_parquet(path) for path in folder.glob("run=*/trajectories.parquet"))
    assert len(table) == 480 and table.dtypes["x"] == "float32" and table.dtypes["id"] == "int32", table.dtypes
    return [table.x.astype(float).sum(), table.y.astype(float).sum()]


def with_duckdb():
    import duckdb

    query = f"""SELECT count(*), sum(x::DOUBLE), sum(y::DOUBLE), count(vx), count(agents.emotion), count(DISTINCT run)
        FROM read_parquet('{everything}', hive_partitioning = true) JOIN
        read_parquet('{agents}', hive_partitioning = true, union_by_name = true) AS agents USING (run, id) WHERE is_person"""
    count, x, y, moving, feeling, runs = duckdb.sql(query).fetchall()[0]
    assert (count, moving, feeling, runs) == (480, 480, 480, 2), (count, moving, feeling, runs)
    return [x, y]


found = {}
for name, read in [("polars", with_polars), ("pandas", with_pandas), ("duckdb", with_duckdb)]:
    try:
        __import__(name)
    except ImportError:
        print("skipped:", name, "is not installed")
        continue
    found[name] = read()
sums = list(found.values())
assert all(abs(a - b) < 1e-6 for one in sums for a, b in zip(one, sums[0])), found


def mixed():
    """What mixed.parquet holds, row after row: as the test wrote it."""
    for agent in range(80_000):
        heading = agent % 48 * 0.125 - 3.0
        own = agent % 5
        is_fast = own == 1 and agent > 60_000
        speeds = [40.0 + agent % 3 if is_fast else own * 0.25 + part * 0.125 if own else 0.0 for part in range(4)]
        feelings = (0.5, 0.25, float(agent % 2), 0.0)
        for frame in range(agent % 10 if agent % 7 == 3 else 0, 10):
            felt = feelings if frame >= 5 else (None,) * 4
            x, y = agent % 50_000 * 0.25, frame * 0.125
            yield (frame, agent + 1, x, y, heading, speeds[frame % 4], -0.5, True, *felt)


wanted = sorted(mixed(), key=lambda row: row[:2])
path = str(folder / "mixed.parquet")
rows = {}
if "polars" in found:
    import polars

    rows["polars"] = polars.read_parquet(path).rows()
if "pandas" in found:
    import pyarrow.parquet

    columns = pyarrow.parquet.read_table(path).to_pydict()
    rows["pyarrow"] = list(zip(*columns.values()))
if "duckdb" in found:
    import duckdb

    rows["duckdb"] = duckdb.sql(f"SELECT * FROM read_parquet('{path}')").fetchall()
for name, read in rows.items():
    assert sorted(read, key=lambda row: row[:2]) == wanted, name
if "pandas" in found:
    import pandas
    import pedpy

    path = next(folder.glob("run=*/trajectories.parquet"))
    rows = pandas.read_parquet(path, columns=["id", "frame", "x", "y"])
    walked = pedpy.compute_individual_speed(traj_data=pedpy.TrajectoryData(data=rows, frame_rate=10.0), frame_step=1)
    assert 0.2 < walked.speed.mean() < 2.5, walked.speed.mean()
print("ok:", ", ".join(found))
