#!/usr/bin/env python3
"""Labels one RELLIS scan as a person does with `underbrush serve`: the proposal of `segment`, then lassos seen from above.
Prints the clicks, and the IoU of grass, trees, bushes and ground before and after.

  scripts/label_path.py --program build/bin/underbrush --data ../shared/data

The script sends the requests that the page sends. Its lassos were drawn with a picture of the true labels at hand, as
a person has a camera's picture; the time that a person needs is not measured."""
import argparse
import array
import json
import pathlib
import re
import subprocess
import tempfile
import time
import urllib.parse
import urllib.request

# What counts as one class: numbers of RELLIS. Void, people, fences and vehicles are not scored.
SCORED = {"grass": {3}, "tree": {4}, "bush": {19}, "ground": {1, 10, 23, 31, 33}}
GROUND, GRASS, SHRUB, TREE = 1, 2, 5, 8  # of the label set "underbrush"
VIEW_M = 32.0  # half of what the picture from above shows
PIXELS = 900

# What is hidden, and so not changed, while a lasso is drawn, and the clicks that it takes: "Show only" takes
# one, "Hide" one for each class.
ONLY_GROUND = (tuple(k for k in range(14) if k != GROUND), 1)
NO_GROUND = ((GROUND, GRASS), 2)
ONLY_GRASS = (tuple(k for k in range(14) if k != GRASS), 1)
NO_GRASS = ((GRASS,), 1)
# (class, what is hidden, polygon in metres as seen from above)
LASSOS = (
    (GRASS, ONLY_GROUND, ((6.2, 11.5), (2.4, 4.6), (0, 3.5), (-3, 2), (-3.2, -2), (-2.7, -3.4), (-7.9, -10.6), (-11.5, -9),
                      (-14, -7.5), (-20, -5), (-30, -4), (-30, 3), (-7, 3), (-5, 6), (-1, 15), (2, 16))),
    (GROUND, ONLY_GRASS, ((-10.2, 0.6), (-5.5, 0.6), (-5.5, -2.6), (-10.2, -2.6))),
    (TREE, NO_GROUND, ((-30, 2), (-30, 30), (6, 30), (3, 17), (1.5, 16), (-2, 3), (-7, 2))),
    (SHRUB, NO_GROUND, ((-13.7, 4.2), (-6.3, 4.2), (-6.3, 1.5), (-13.7, 1.5))),
    (TREE, NO_GROUND, ((-23, -8.5), (-16, -8.5), (-16, -16), (-23, -17))),
    (SHRUB, NO_GROUND, ((-25, -2), (-14, -2.8), (-14.5, -8), (-19, -9.8), (-24, -8))),
    (GROUND, NO_GRASS, ((3, 11), (2.5, 16), (6, 21), (12, 22), (30, 25), (30, -30), (-14, -30), (-14, -11), (-8, -10.6),
                        (-2.7, -4), (4, -4), (5, 6))),
)


class Page:
    """The requests of the page for one log, whose number is 0."""
    def __init__(self, address: str) -> None:
        self.address = address
        self.revision = 0

    def get(self, path: str) -> dict:
        """Returns the JSON of an answer. Raises urllib.error.HTTPError for an error."""
        with urllib.request.urlopen(self.address + path) as reply:
            return json.load(reply)

    def post(self, path: str, /, **values: object) -> dict:
        """Asks for a change and returns the JSON of the answer."""
        query = urllib.parse.urlencode({k: v for k, v in values.items() if v is not None}, safe=",")
        request = urllib.request.Request(f"{self.address}{path}?{query}", method="POST")
        with urllib.request.urlopen(request) as reply:
            return json.load(reply)

    def edit(self, path: str, /, **values: object) -> dict:
        self.revision = self.get("api/labels?file=0")["revision"]
        return self.post(f"api/labels/{path}", file=0, revision=self.revision, **values)

    def wait(self, ready, path: str, seconds: float = 120) -> dict:
        """Asks until `ready(answer)`. Raises TimeoutError."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            answer = self.get(path)
            if ready(answer):
                return answer
            time.sleep(0.05)
        raise TimeoutError(path)


def call(*words: object, cwd: str) -> None:
    subprocess.run([str(w) for w in words], cwd=cwd, check=True, stdout=subprocess.DEVNULL)


def labels_of(path: pathlib.Path) -> array.array:
    """Reads a .label file: one number for each row, without the instances."""
    out = array.array("I")
    out.frombytes(path.read_bytes())
    return array.array("I", (v & 0xffff for v in out))


def scores(found: array.array, truth: array.array) -> dict:
    """The IoU of each scored class over the rows whose true class is scored."""
    classes = {number: name for name, numbers in SCORED.items() for number in numbers}
    if len(found) != len(truth):
        raise ValueError(f"{len(found)} rows, {len(truth)} true labels")
    pairs = [(classes.get(f), classes[t]) for f, t in zip(found, truth) if t in classes]
    out = {}
    for name in SCORED:
        both = sum(f == name and t == name for f, t in pairs)
        either = sum(name in (f, t) for f, t in pairs)
        out[name] = both / either if either else float("nan")
    return out


def lasso(page: Page, label: int, hidden: tuple, corners: tuple) -> int:
    """Paints what a polygon holds, seen from above; returns the number of points that changed."""
    matrix = [1 / VIEW_M, 0, 0, 0, 0, 1 / VIEW_M, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]  # by columns
    path = [c for x, y in corners for c in ((x / VIEW_M + 1) * PIXELS / 2, (1 - y / VIEW_M) * PIXELS / 2)]
    shape = {"matrix": ",".join(map(str, matrix)), "path": ",".join(f"{c:.1f}" for c in path)}
    return page.edit("edit", **{"class": label}, width=PIXELS, height=PIXELS, name="lasso",
                     hidden=",".join(map(str, hidden)), **shape)["rows"]


def play(page: Page, folder: pathlib.Path, truth: array.array) -> dict:
    """Plays the path; returns clicks, IoU before and after, and the seconds that the program took."""
    def now(name: str) -> dict:
        page.post("api/labels/export", file=0, format="label", set="rellis", name=name)
        return scores(labels_of(folder / name), truth)
    start = time.monotonic()
    job = page.post("api/jobs/start", verb="segment", log=0, name="proposal.ply", min_range=2.2)
    job = page.wait(lambda j: j["state"] != "running", f"api/jobs/log?number={job['number']}")
    if job["state"] != "done":
        raise RuntimeError(job["log"])
    page.edit("import", name="proposal.ply", unlabelled=1)
    clicks = 2  # the log to label, and Propose
    before = now("before.label")
    clicks += 1  # the lasso
    held: tuple = ((), 0)
    label = None
    changed = []
    for wanted, hidden, corners in LASSOS:
        if hidden != held:
            clicks += held[1] + hidden[1]  # what was hidden is shown again
        clicks += (wanted != label) + 1  # the class, and the stroke
        held, label = hidden, wanted
        changed.append(lasso(page, wanted, hidden[0], corners))
    seconds = time.monotonic() - start
    return {"clicks": clicks, "lassos": len(LASSOS), "points_changed": changed, "seconds_of_program": round(seconds, 2),
            "iou_before": before, "iou_after": now("after.label")}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/bin/underbrush", type=pathlib.Path)
    parser.add_argument("--data", default="../shared/data", type=pathlib.Path, help="folder with rellis_000104")
    parser.add_argument("--json", type=pathlib.Path, help="write the result to this file")
    options = parser.parse_args()
    program, scan = options.program.resolve(), (options.data / "rellis_000104").resolve()
    with tempfile.TemporaryDirectory() as folder:
        call(program, "import", scan / "000104.bin", "-o", "log.ply", cwd=folder)
        server = subprocess.Popen([program, "serve", "log.ply", "--labels", "work", "--cache", "cache"], cwd=folder,
                                  text=True, stdout=subprocess.PIPE)
        try:
            assert server.stdout is not None
            found = None
            while not found:
                found = re.match(r"open (\S+) in", server.stdout.readline())
            page = Page(found.group(1))
            page.wait(lambda s: s["state"] == "ready", "api/octree?file=0")
            result = play(page, pathlib.Path(folder, "work"), labels_of(scan / "000104.label"))
        finally:
            server.terminate()
            server.wait()
    print(f"{result['clicks']} clicks and strokes, {result['lassos']} of them lassos; the program took "
          f"{result['seconds_of_program']} s")
    print(f"{'class':<8}{'before':>8}{'after':>8}")
    for name in SCORED:
        print(f"{name:<8}{result['iou_before'][name]:>8.3f}{result['iou_after'][name]:>8.3f}")
    if options.json:
        options.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
