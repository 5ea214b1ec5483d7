"""The commands that the attacks on files disturb, and the inputs of these commands."""
import dataclasses
import os
import pathlib
import shutil
import subprocess
import sys

import bounded

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import seeds  # noqa: E402


@dataclasses.dataclass(frozen=True)
class Job:
    """A command; OUT stands for its output, whose name ends as `ending` says."""
    name: str
    command: str
    inputs: tuple
    ending: str = ""
    seeded: bool = True  # Whether it takes --seed, which the output then tells.
    resumed: bool = False  # Whether it goes on from the checkpoint of a run that was stopped.

    def words(self, out, seed=1, **replaced):
        """The words of the command, with an output and with other names for inputs."""
        words = [replaced.get(word, word).replace("OUT", str(out)) for word in self.command.split()]
        return words + (["--seed", str(seed)] if self.seeded else [])


JOBS = (
    Job("import", "import big.csv -o OUT", ("big.csv",), ".ply"),
    Job("import a folder", "import drive -o OUT", ("drive",), ".ply"),
    Job("split", "split big.ply --every 2 --train OUT --test second.ply", ("big.ply",), ".ply"),
    Job("segment", "segment big.ply -o OUT", ("big.ply",), ".ply"),
    Job("movers", "movers big.ply -o OUT", ("big.ply",), ".ply"),
    Job("actors", "actors passing.ply --boxes van.csv --least-returns 10 -o OUT", ("passing.ply", "van.csv")),
    Job("fit", "fit seen.ply -o OUT", ("seen.ply",)),
    Job("fit likelihood", "fit log.ply -o OUT --fitter likelihood --ground-spacing 2", ("log.ply",)),
    Job("update", "fit more.ply --update remembering -o OUT", ("more.ply", "remembering", "seen.ply"),
        seeded=False),
    Job("rasters", "rasters model -o OUT", ("model",)),
    Job("extract", "extract model labelled.ply -o OUT", ("model", "labelled.ply")),
    Job("meshes", "meshes tree.obj -o OUT --sizes 1", ("tree.obj",)),
    Job("annotate", "annotate labelled.ply -o OUT --ground-spacing 2", ("labelled.ply",), ".json"),
    Job("annotate in parts", "annotate --generate forest --size 40 30 --ground-spacing 4 --parts 20 -o OUT", ()),
    Job("primitives", "primitives merge primitives -o OUT", ("primitives",)),
    Job("compose", "compose site.json primitives -o OUT", ("site.json", "primitives")),
    Job("regions", "regions scene --side 8 -o OUT", ("scene",)),
    Job("simulate", "simulate remembering --like big.ply -o OUT", ("remembering", "big.ply"), ".ply"),
    Job("simulate echoes",
        "simulate model --sensor spinning.yaml --trajectory poses.txt --super-sample sensor -o OUT",
        ("model", "spinning.yaml", "poses.txt"), ".ply"),
    Job("simulate waveforms",
        "simulate model --sensor spinning.yaml --trajectory poses.txt --super-sample sensor --waveforms second.waves "
        "-o OUT", ("model", "spinning.yaml", "poses.txt"), ".ply"),
    Job("simulate a folder", "simulate model --sensor spinning.yaml --trajectory poses.txt -o OUT --profile ouster",
        ("model", "spinning.yaml", "poses.txt")),
    Job("simulate a point cloud", "simulate model --like log.ply -o OUT", ("model", "log.ply"), ".pcd"),
    Job("perceive", "perceive big.ply --pipeline real -o OUT", ("big.ply",), ".csv"),
    Job("osi", "osi record big.ply -o OUT", ("big.ply",), ".osi"),
    Job("score", "score log.ply simulated.ply --model model --report OUT", ("log.ply", "simulated.ply", "model")),
    Job("plan", "plan job.yaml -o OUT --force", ("job.yaml", "model", "log.ply"), seeded=False),
    Job("optimize", "optimize log.ply -o OUT --budget 3 --ground-spacing 2", ("log.ply",), ".yaml", resumed=True),
)


def make_inputs(folder, program):
    """Writes the inputs of all jobs."""
    seeds.make(folder, program)
    (folder / "big.csv").write_text(seeds.csv(seeds.beams(scans=4, columns=400, rings=32)))
    subprocess.run([program, "import", "big.csv", "-o", "big.ply"], cwd=folder, check=True, capture_output=True)


def copy_inputs(source, folder, job):
    """Copies the inputs of a job, and what they name, into a new folder."""
    folder.mkdir()
    for name in {*job.inputs, *(("site.ground",) if "site.json" in job.inputs else ())}:
        if (source / name).is_dir():
            shutil.copytree(source / name, folder / name)
        else:
            shutil.copy(source / name, folder)
    return folder


def good_run(program, folder, job, seed=1):
    """What an undisturbed run writes, and the files that it adds; its output is removed."""
    out = folder / ("out" + job.ending)
    before = bounded.names(folder)
    done = bounded.run([program, *job.words(out.name, seed)], folder)
    if done.code != 0:
        raise SystemExit(f"attack: {job.name} fails without an attack: {done.err}")
    found = bounded.contents(out)
    for name in sorted(bounded.names(folder) - before, reverse=True):
        os.rmdir(folder / name) if (folder / name).is_dir() else (folder / name).unlink()
    return found
