#!/usr/bin/env python3
"""Tests of fits of several logs: tasks and one process give the same model, and logs that do not fit are named."""
import json
import random

import cli_test
import jobs_test


class ManyLogs(jobs_test.JobFolder):
    """Logs of one field."""

    def test_fits_of_many_logs(self):
        """Logs of one place become one model, whose passes tasks sum up, across the logs' ends, in any order."""
        logs = ("c.ublog", "a.ublog", "b.ply")
        for k, log in enumerate(logs):
            poses = "".join(f"{0.1 * s} {4 * k + 0.5 * s} {0.03 * k} 1.8 0 0 0 1\n" for s in range(2))
            (self.folder / f"{k}.txt").write_text(poses)
            self.ok("simulate", "field.obj", "--sensor", "velodyne-vlp16", "--trajectory", f"{k}.txt", "--range-noise", 0.02,
                    "--seed", k, "-o", log)
        command = f"fit {' '.join(logs)} --rounds 2 -o {{}}"
        pieces = 5
        self.assertEqual(self.plan(command.format("joined"), pieces=pieces), 1 + 2 * (pieces + 1))
        tasks = json.loads((self.folder / "plan/plan.json").read_text())["tasks"]
        self.assertEqual(tasks[0]["inputs"], sorted(logs))
        chance = random.Random(5)
        for stage in range(5):
            numbers = [k for k, task in enumerate(tasks) if task["stage"] == stage]
            chance.shuffle(numbers)
            self.run_tasks([*numbers, numbers[0]])
        self.ok("merge", "plan")
        told = json.loads(self.ok(*command.format("whole").split(), "--json", "-"))
        self.assertEqual(told["beams"], sum(json.loads(self.ok("info", log, "--json", "-"))["beams"] for log in logs))
        self.assertEqual(self.files_of("joined"), self.files_of("whole"))
        self.assertEqual([log["file"] for log in json.loads(self.bytes_of("whole/training/training.json"))["logs"]], list(logs))
        self.ok("regions", "joined", "-o", "world", "--side", 30)
        for model in ("world", "whole"):
            self.ok("simulate", model, "--like", "b.ply", "-o", f"of-{model}.csv")
        self.assertEqual(self.bytes_of("of-world.csv"), self.bytes_of("of-whole.csv"))
        self.assert_fails(self.call("fit", "a.ublog", "b.ply", "--update", "whole", "-o", "grown"), 2, "--update", "one log")
        self.assert_fails(self.call("fit", "a.ublog", "./a.ublog", "-o", "twice"), 3, "a.ublog", "twice")
        self.ok("simulate", "field.obj", "--sensor", "velodyne-hdl32e", "--trajectory", "0.txt", "-o", "other.ublog")
        self.assert_fails(self.call("fit", "a.ublog", "other.ublog", "-o", "mixed"), 3, "other.ublog", "velodyne-hdl32e")


if __name__ == "__main__":
    cli_test.main()
