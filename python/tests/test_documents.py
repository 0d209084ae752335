"""The README's lines and the notebook's cells run."""

import doctest
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from common import ROOT, needs, program

FOLDER = ROOT / "python"
DRAWS = os.environ.get("GAITWAY_REQUIRE_GPU") == "1"


def blocks(text):
    """The blocks of Python in a document."""
    return [part.split("```")[0] for part in text.split("```python\n")[1:]]


class Documents(unittest.TestCase):
    @needs("pandas", "polars", "pyarrow", "pedpy", "gymnasium")
    def test_every_line_of_the_readme_runs(self):
        names, here = {}, os.getcwd()
        found = blocks((FOLDER / "README.md").read_text())
        self.assertGreater(len(found), 8)
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for block in found:
                    if "picture(" in block and not DRAWS:
                        continue
                    exec(compile(block, "README.md", "exec"), names)
            finally:
                os.chdir(here)

    @needs("pedpy")
    def test_the_lines_of_the_main_readme_run(self):
        (block,) = blocks((ROOT / "README.md").read_text())
        block = block.replace("agents=500", "agents=40").replace("seconds=60", "seconds=1")
        if not DRAWS:
            block = block.replace("sim.picture()", "")
        with tempfile.TemporaryDirectory() as folder:
            hall = Path(folder) / "hall.toml"
            hall.write_text((ROOT / "assets" / "scenes" / "garden.toml").read_text())
            exec(compile(block.replace("hall.toml", str(hall)), "README.md", "exec"), {})

    @needs("polars")
    def test_the_guide_to_sweeps_reads_its_runs_as_one_table(self):
        (block,) = blocks((ROOT / "docs" / "sweeps.md").read_text())
        with tempfile.TemporaryDirectory() as folder:
            sweep, plan = Path(folder) / "sweep.toml", Path(folder) / "plan.jsonl"
            sweep.write_text(
                'scenario = "garden"\nseconds = 1\nseeds = 2\ntrajectories = true\n'
                '[vary]\npopulation.agents = [3, 4]\ncondition = ["baseline", "eva-g"]\n'
            )
            program("plan", sweep, "--out", plan)
            program("run", plan, "--out", Path(folder) / "runs", "--backend", "cpu")
            names = {}
            exec(compile(block.replace('"runs/', f'"{folder}/runs/'), "sweeps.md", "exec"), names)
        self.assertEqual((names["runs"].height, names["speed"].height), (8, 8))
        self.assertEqual(sorted(names["runs"]["population.agents"].unique()), [3, 4])
        self.assertEqual(set(names["runs"]["key"]), set(names["speed"]["run"]))

    @needs("nbclient", "ipykernel", "pedpy", "pandas")
    def test_the_notebook_of_twenty_cells_runs(self):
        import nbformat
        from nbclient import NotebookClient

        book = nbformat.read(FOLDER / "examples" / "crowd.ipynb", as_version=4)
        self.assertEqual(len(book.cells), 20)
        with tempfile.TemporaryDirectory() as folder:
            # the kernel finds the drivers as this process does
            kernel = Path(folder) / "kernels" / "gaitway-tests"
            kernel.mkdir(parents=True)
            start = [os.environ["GAITWAY_RUNNER"]] if "GAITWAY_RUNNER" in os.environ else []
            start += [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
            named = {"argv": start, "display_name": "tests", "language": "python"}
            (kernel / "kernel.json").write_text(json.dumps(named))
            with mock.patch.dict(os.environ, {"JUPYTER_PATH": folder}):
                here = {"metadata": {"path": folder}}
                NotebookClient(book, timeout=300, kernel_name="gaitway-tests", resources=here).execute()
        kinds = {kind for cell in book.cells for out in cell.get("outputs", []) for kind in out.get("data", {})}
        self.assertIn("text/html", kinds)
        if DRAWS:
            self.assertIn("image/png", kinds)
        self.assertEqual([out for cell in book.cells for out in cell.get("outputs", []) if out.output_type == "error"], [])

    def test_the_example_of_the_package_runs(self):
        import gaitway

        found = doctest.testmod(gaitway)
        self.assertEqual((found.failed, found.attempted), (0, 4))

    def test_every_public_name_has_a_docstring_and_the_package_is_typed(self):
        import gaitway as gw

        for name in gw.__all__:
            value = getattr(gw, name)
            if callable(value) or hasattr(value, "__path__"):
                self.assertTrue(value.__doc__, name)
        for owner in (gw.Simulation, gw.Trajectories, gw.Table, gw.gaits.Gaits, gw.Perceiver, gw.Picture, gw.Video):
            for name in dir(owner):
                if not name.startswith("_"):
                    self.assertTrue(getattr(owner, name).__doc__, f"{owner.__name__}.{name}")
        folder = Path(gw.__file__).parent
        self.assertTrue((folder / "py.typed").exists())
        stub = (folder / "_gaitway.pyi").read_text()
        for owner in (gw._gaitway.Simulation, gw._gaitway.Table, gw._gaitway.Gaits, gw._gaitway.Perceiver):
            for name in vars(owner):
                if not name.startswith("__"):
                    self.assertIn(f"def {name}(", stub, f"{owner.__name__}.{name} is not in the stub")


if __name__ == "__main__":
    unittest.main()
