"""Whether folders of runs are whole and hold the same as another: python equal.py SERIAL FOLDER..."""

import json
import pathlib
import sys


def results(folder):
    found = {}
    for run in pathlib.Path(folder).glob("run=*"):
        record = json.loads((run / "run.json").read_text())
        assert run.name == "run=" + record["key"], run
        for table in run.glob("*.parquet"):
            content = table.read_bytes()
            assert content[:4] == content[-4:] == b"PAR1", table
        assert {"run.json", "agents.parquet"} <= {file.name for file in run.iterdir()}, run
        assert not any(file.name.startswith(".") for file in run.iterdir()), run
        found[record["key"]] = record["state_hash"]
    return found


serial = results(sys.argv[1])
assert serial, sys.argv[1]
for folder in sys.argv[2:]:
    hidden = len(list(pathlib.Path(folder).glob(".run=*")))
    assert results(folder) == serial, f"{folder}: other runs, or other hashes, than {sys.argv[1]}"
    print(f"equal: {len(serial)} state hashes of {folder}; {hidden} folders of killed runs are left under hidden names")
