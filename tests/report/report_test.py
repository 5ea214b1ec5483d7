#!/usr/bin/env python3
"""The report: one file that needs nothing else, draws itself, and bears any log.

    report_test.py --program build/bin/underbrush [--chromium chromium]
"""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile

HEADER = "x,y,z,time,ox,oy,oz,hit,scan,ring\n"


def csv(path, rows):
    path.write_text(HEADER + "".join(",".join(map(str, row)) + "\n" for row in rows))


def beams(hit):
    """A fan of beams on the ground, some of them misses; `hit` says which end in a return."""
    for k in range(400):
        x, y = 5 + 0.05 * (k % 20), 0.1 * (k // 20) - 1
        yield (x, y, -1.5, 0.001 * k, 0, 0, 0, int(hit(k)), k // 200, k % 20)


def run(program, *words):
    subprocess.run([program, *map(str, words)], check=True, capture_output=True)


def report_of(program, folder, name, real, simulated):
    for label, rows in (("real", real), ("one", simulated), ("two", real)):
        csv(folder / f"{label}.csv", rows)
        run(program, "import", folder / f"{label}.csv", "-o", folder / f"{label}.ply")
    run(program, "score", folder / "real.ply", folder / "one.ply", folder / "two.ply", "--name", "first_model",
        "--name", "second_model", "--report", folder / name)
    return folder / name / "index.html"


def check_page(page):
    text = page.read_text()
    body = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", text)
    # The one address in it is the name of the SVG namespace, which nothing fetches.
    addresses = [a for a in re.findall(r"https?:[^'\"\s<]+", body) if not a.endswith("www.w3.org/2000/svg")]
    assert not addresses, f"the page refers to {addresses}"
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", body), "the page loads a file"
    data = json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.S)
                      .group(1).replace("<\\/", "</"))
    assert list(data["scores"]["models"]) == ["first_model", "second_model"]
    assert len(data["pictures"]) == 3
    return data


def check_drawn(chromium, page, profile):
    dom = subprocess.run(
        [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync",
         "--disable-background-networking", "--disable-component-update", f"--user-data-dir={profile}",
         "--virtual-time-budget=5000", "--dump-dom", page.resolve().as_uri()],
        capture_output=True, text=True, timeout=120).stdout
    failure = re.search(r'id="failure".*?</p>', dom, re.S)
    assert not failure, failure.group(0)
    assert 'data-drawn="yes"' in dom, "the page did not draw itself"
    assert dom.count("first_model") > 5 and "native code" not in dom


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--chromium", default="")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        cases = {"some": (lambda k: k % 3 > 0, lambda k: k % 4 > 0),
                 "no_hits": (lambda k: False, lambda k: False)}
        for case, (real, simulated) in cases.items():
            page = report_of(args.program, folder, case, list(beams(real)), list(beams(simulated)))
            data = check_page(page)
            if case == "no_hits":
                assert data["scores"]["true_hits"] == 0 and data["scores"]["f1"] is None
            if args.chromium and "NOTFOUND" not in args.chromium:
                check_drawn(args.chromium, page, folder / f"profile_{case}")
    if not args.chromium or "NOTFOUND" in args.chromium:
        print("chromium is not installed: the page was read but not drawn")


main()
