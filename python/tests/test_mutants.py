"""A few damaged files of every kind; `mutate_formats.py` reads as many as one likes."""
from __future__ import annotations

import bz2
import functools
import pathlib
import subprocess
import sys

import pytest
from format_fields import FIELDS, bag_with_chunk, zeros_in_mcap
from mutate_formats import KINDS, LIES, read_all, run, seed_bag

_NEEDS = {"las": "laspy", "laz": "lazrs", "old-laz": "lazrs", "e57": "pye57", "xyz": "numpy", "npz": "numpy"}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs fork and RLIMIT_AS")
@pytest.mark.parametrize("kind", list(KINDS))
def test_damaged_files_are_read_or_refused(kind: str) -> None:
    module = _NEEDS.get(kind, "rosbags")
    pytest.importorskip(module, reason=f"{module} is not installed: pip install 'underbrush[formats]'")
    results, failures = run(kind, 40, 20)
    assert failures == []
    assert sum(results.values()) == 40 and results["refused"] > 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs fork and RLIMIT_AS")
@pytest.mark.parametrize("kind", list(FIELDS))
def test_files_that_lie_of_their_structure_are_read_or_refused(kind: str) -> None:
    module = _NEEDS.get(kind, "rosbags")
    pytest.importorskip(module, reason=f"{module} is not installed: pip install 'underbrush[formats]'")
    results, failures = run(kind, 40, LIES)
    assert failures == []
    assert sum(results.values()) >= 40 and results["refused"] > 0


_READ = """
import sys, resource
from mutate_formats import read_all
import pathlib
resource.setrlimit(resource.RLIMIT_AS, (1 << 31, 1 << 31))
print(read_all(pathlib.Path(sys.argv[1])))
"""


@functools.cache
def three_gigabytes(algorithm: str) -> bytes:
    """As many zeros, compressed."""
    zeros, count = bytes(1 << 24), 192
    if algorithm == "bz2":
        return bz2.compress(zeros) * count
    if algorithm == "zstd":
        one = pytest.importorskip("zstandard").ZstdCompressor(write_content_size=False).compressobj()
        return b"".join(one.compress(zeros) for _ in range(count)) + one.flush()
    frame = pytest.importorskip("lz4.frame").LZ4FrameCompressor()
    return frame.begin() + b"".join(frame.compress(zeros) for _ in range(count)) + frame.flush()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs RLIMIT_AS")
@pytest.mark.parametrize("told", [1000, 3 << 30])
@pytest.mark.parametrize("compression", ["zstd of MCAP", "lz4 of MCAP", "lz4", "bz2"])
def test_chunks_that_unpack_to_three_gigabytes_are_refused(compression: str, told: int, tmp_path: pathlib.Path) -> None:
    pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
    packed = three_gigabytes(compression.split()[0])
    if compression.endswith("MCAP"):
        path = tmp_path / "zeros.mcap"
        path.write_bytes(zeros_in_mcap(packed, compression.split()[0], told))
    else:
        path = seed_bag(tmp_path, "zeros.bag")
        path.write_bytes(bag_with_chunk(path.read_bytes(), packed, compression, told))
    done = subprocess.run([sys.executable, "-c", _READ, path], cwd=pathlib.Path(__file__).parent, check=False,
                          capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout.strip()) == (0, "refused"), done.stderr[-300:]


def test_a_bag_with_its_own_chunk_packed_anew_is_read(tmp_path: pathlib.Path) -> None:
    """The bags of the test above differ from this one by their chunk alone."""
    pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
    path = seed_bag(tmp_path, "log.bag")
    good = path.read_bytes()
    at = good.index(b"compression=none")
    begin = good.index(b"size=", at) + 9
    size = int.from_bytes(good[begin - 4:begin], "little")
    chunk = next(good[k + 4:k + 4 + size] for k in range(begin, begin + 64) if good[k:k + 4] == good[begin - 4:begin])
    path.write_bytes(bag_with_chunk(good, bz2.compress(chunk), "bz2", size))
    assert read_all(path) == "read"
