#!/usr/bin/env python3
"""Tests of verbs that a plan has as whole tasks: their results have the bytes of the verb alone."""
import json
import pathlib
import subprocess

import cli_test
import jobs_test


class PlannedVerbs(jobs_test.JobFolder):
    """Searches, splits and studies in plans."""

    def test_splits_and_searches(self):
        (self.folder / "poses.txt").write_text("0 0 0 1.8 0 0 0 1\n0.4 2 0 1.8 0 0 0 1\n")
        self.ok(*f"{jobs_test.SENSED} --range-noise 0.02 -o seen.ply".split())
        for k, (command, ends) in enumerate({"split seen.ply --every 2 --train {}train.ply --test {}test.ply":
                                             ("train.ply", "test.ply"),
                                             "optimize seen.ply --budget 2 -o {}.yaml": (".yaml",)}.items()):
            self.assertEqual(self.plan(command.replace("{}", "made"), f"plan{k}"), 1)
            self.run_tasks([0], f"plan{k}")
            self.ok("merge", f"plan{k}")
            self.ok(*command.replace("{}", "whole").split())
            for end in ends:  # A file of parameters names itself.
                made, whole = (self.bytes_of(name + end).replace(name.encode(), b"") for name in ("made", "whole"))
                self.assertEqual(made, whole)

    def test_inputs_that_other_inputs_name(self):
        sensor = pathlib.Path(__file__).parents[2] / "share/sensors/velodyne-vlp16.yaml"
        (self.folder / "own.yaml").write_text(sensor.read_text())
        (self.folder / "rig.yaml").write_text("name: rig\nsensors:\n  - {name: a, sensor: own.yaml}\n")
        self.plan("simulate field.obj --rig rig.yaml --trajectory poses.txt -o made.ply", pieces=2)
        self.ok("run", "plan", "--task", 0)
        (self.folder / "own.yaml").write_text(sensor.read_text().replace("max_range_m: ", "max_range_m: 1"))
        self.assert_fails(self.call("run", "plan", "--task", 1), 3, "own.yaml", "its hash differs")

    def test_options_that_a_task_cannot_have(self):
        for command in ("optimize seen.ply -o {k}.yaml --resume", "optimize seen.ply -o {k}.yaml --checkpoint=c",
                        "annotate --generate forest -o {k}.json"):
            (self.folder / "job.yaml").write_text(json.dumps({"command": command, "over": {"k": [1]}}))
            self.assert_fails(self.call("plan", "job.yaml", "-o", "plan"), 3, "not ")

    def test_studies(self):
        studies = pathlib.Path(cli_test.PROGRAM).resolve().with_name("underbrush-study")
        if not studies.exists():
            self.skipTest("this build has no studies")
        # The verdict falls short at this size, as exit code 1 says.
        self.plan("study sequential --quick --seed {seed} --json {seed}.json", over={"seed": [1, 2]})
        self.run_tasks((1, 0))
        self.ok("merge", "plan")
        done = subprocess.run([studies, "sequential", "--quick", "--seed", "2", "--json", "whole.json"], cwd=self.folder,
                              check=False, capture_output=True)
        self.assertEqual(done.returncode, 1)
        made, whole = (json.loads(self.bytes_of(name)) for name in ("2.json", "whole.json"))
        for figures in (made, whole):
            del figures["seconds"], figures["provenance"]
        self.assertEqual(made, whole)
        self.plan("study no-such-study --json {k}.json", "bad", over={"k": [1]})
        self.assert_fails(self.call("run", "bad", "--task", 0), 4, "no study 'no-such-study'")


if __name__ == "__main__":
    cli_test.main()
