"""Calls the Python package in ways that make no sense, in a process of its own: `python_calls.py ATTACK FOLDER`.

Prints how many calls were answered and how many refused by an exception of Python. The process must not end before.
"""
import faulthandler
import itertools
import json
import os
import pathlib
import signal
import sys
import threading
import time

import numpy as np
import underbrush as ub

COUNTS = {"answer": 0, "refusal": 0}
N = 600


def columns():
    """The columns of a log in which a sensor sees a floor."""
    azimuth = np.linspace(0, 20 * np.pi, N)
    direction = np.stack([np.cos(azimuth), np.sin(azimuth), np.full(N, -0.3)], 1)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    return {"origin": np.tile([0.0, 0, 2], (N, 1)), "direction": direction, "range_m": -2 / direction[:, 2]}


def attempt(what, call, check=None):
    """Calls something: it returns, or raises what Python code may expect."""
    print(what, file=sys.stderr, flush=True)
    try:
        found = call()
    except (ValueError, TypeError, MemoryError, OSError, OverflowError, IndexError, KeyError, RuntimeError) as error:
        assert str(error) or isinstance(error, MemoryError), f"{what}: no reason"
        COUNTS["refusal"] += 1
        return
    assert check is None or check(found), f"{what}: a wrong answer"
    COUNTS["answer"] += 1


def forms(array):
    """The same numbers in memory in other ways, and whether these are still the same numbers."""
    wide = np.repeat(array, 2, axis=0)
    read_only = array.copy()
    read_only.flags.writeable = False
    odd = np.frombuffer(b"\0" + array.tobytes(), np.uint8)[1:].view(array.dtype).reshape(array.shape)
    yield from (("steps", wide[::2]), ("backwards", array[::-1].copy()[::-1]), ("Fortran", np.asfortranarray(array)),
                ("read-only", read_only), ("not aligned", odd), ("other byte order", array.astype(array.dtype.newbyteorder(">"))),
                ("float32", array.astype(np.float32)), ("list", array.tolist()),
                ("float128", array.astype(np.longdouble)), ("memoryview", memoryview(np.ascontiguousarray(array))))


def strides(_):
    """Arrays of any layout give the log of plain arrays, or are refused."""
    given = columns()
    plain = ub.log_from_columns(**given)
    for name in given:
        for what, form in forms(given[name]):
            attempt(f"{name}: {what}", lambda: ub.log_from_columns(**{**given, name: form}),
                    lambda log: np.allclose(log.end_points(), plain.end_points(), atol=1e-4))


def kinds(_):
    """Arrays of wrong kinds, shapes and values."""
    given = columns()
    whole = np.ones((N, 3))
    odd = {"none": None, "text": "x", "objects": np.array([object()] * N), "complex": whole * 1j, "bools": whole > 0,
           "empty": np.zeros((0, 3)), "scalar": np.float64(1), "4-D": np.ones((N, 3, 1, 1)), "wide": np.ones((N, 4)),
           "broadcast": np.broadcast_to(1.0, (N, 3)), "no step": np.lib.stride_tricks.as_strided(np.ones(3), (N, 3), (0, 8)),
           "nan": whole * np.nan, "inf": whole * np.inf, "huge": whole * 1e308, "strings": np.full((N, 3), "1.0"),
           "dates": np.zeros(N, "datetime64[s]"), "record": np.zeros(N, [("x", "f8")]), "masked": np.ma.masked_all((N, 3)),
           "short": np.ones((N - 1, 3)), "negative": -whole, "zero": whole * 0, "dict": {}, "bytes": b"\0" * 24 * N}
    names = (*given, "time_s", "ring", "intensity", "scan")
    for name, (what, value) in itertools.product(names, odd.items()):
        attempt(f"{name}: {what}", lambda: ub.log_from_columns(**{**given, name: value}))
        attempt(f"extra: {what}", lambda: ub.log_from_columns(**given, extra={name: value}))
    for n in (-1, 2**31, 2**40, 2**62, 2**64, 1.5, "3", None):
        attempt(f"BeamLog({n})", lambda: ub.BeamLog(n))
        attempt(f"slice {n}", lambda: ub.log_from_columns(**given).slice(n, n))
        attempt(f"chunks of {n}", lambda: sum(map(len, ub.LogReader("log.ply", n))) if n == 1.5 else ub.LogReader("log.ply", n))
    for value in (np.ones(3), np.ones((4, 4)), "x", [1, 2], np.full(3, np.nan), np.zeros((4, 4)), None, {}):
        attempt(f"Pose {value!r:.20}", lambda: ub.Pose(value))
        attempt(f"matrix {value!r:.20}", lambda: ub.Pose.from_matrix(value))
        attempt(f"rotation {value!r:.20}", lambda: ub.Pose([0, 0, 0], value))


def spoiled(folder):
    """Logs whose columns the caller has filled with nonsense, and the verbs on them."""
    model = ub.fit(ub.read_log(folder / "log.ply"), ground_spacing=2)
    values = (0, -1, 65535, 2**32 - 1, np.nan, np.inf, 1e300)
    for name in ("origin", "direction", "range_m", "time_s", "ring", "scan", "packet", "flags", "intensity"):
        for value in values:
            log = ub.read_log(folder / "log.ply")
            column = getattr(log, name)
            with np.errstate(all="ignore"):
                column[...] = np.array(value).astype(column.dtype)
            attempt(f"fit {name}={value}", lambda: ub.fit(log, ground_spacing=2))
            attempt(f"simulate {name}={value}", lambda: ub.simulate(model, like=log))
            attempt(f"write {name}={value}", lambda: ub.write_log(folder / "spoiled.ply", log))


def lifetimes(folder):
    """Views whose owner is gone, iterators whose reader is, and deleted attributes."""
    views = [getattr(ub.read_log(folder / "log.ply"), name) for name in ("origin", "range_m", "ring") * 20]
    junk = [np.full(100_000, 7.0) for _ in range(50)]
    attempt("views", lambda: [float(view.sum()) for view in views], lambda sums: len(set(sums[::3])) == 1)
    del junk
    reader = iter(ub.LogReader(folder / "log.ply", 100))
    attempt("iterator", lambda: sum(map(len, reader)))
    attempt("iterator at its end", lambda: list(reader))
    writer = ub.LogWriter(folder / "w.ply", ub.read_log(folder / "log.ply").info)
    attempt("close", writer.close)
    attempt("close again", writer.close)
    attempt("write after close", lambda: writer.write(ub.read_log(folder / "log.ply")))
    for kind in (ub.BeamLog, ub.LogReader, ub.LogWriter, ub.Model, ub.Pose, ub.Sensor, ub.Lidar, ub.TriangleMesh):
        attempt(f"{kind.__name__} without its beginning", lambda: len(kind.__new__(kind)))
        attempt(f"{kind.__name__} that was not made", lambda: repr(vars(kind)["__repr__"](kind.__new__(kind))))


def forks(folder):
    """A child process of a process that has used threads: it works, or ends by itself."""
    log = ub.read_log(folder / "log.ply")
    ub.fit(log, ground_spacing=2)
    for k in range(5):
        child = os.fork()
        if child == 0:
            signal.alarm(20)
            ub.fit(log, ground_spacing=2)
            os._exit(0)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        assert status == 0, f"the child ended with {status}"
        COUNTS["answer"] += 1


def interrupted(folder):
    """Ctrl-C at many moments of a fit, and callbacks that throw: an exception, and the next fit is as ever."""
    log = ub.read_log(folder / "log.ply")
    options = {"fitter": "likelihood", "rounds": 20, "ground_spacing": 2}
    good = ub.fit(log, **options).ellipsoids.mean.copy()
    for k in range(15):
        timer = threading.Timer(0.01 * (k + 1), lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        try:
            ub.fit(log, **options)
            time.sleep(1)
            COUNTS["answer"] += 1
        except KeyboardInterrupt:
            COUNTS["refusal"] += 1
        timer.join()
    for error in (KeyError, SystemExit, KeyboardInterrupt, GeneratorExit, StopIteration, MemoryError, RecursionError):
        def fail(*_):
            raise error("the callback")
        try:
            ub.fit(log, **options, progress=fail)
            raise AssertionError(f"{error.__name__} was lost")
        except error:
            COUNTS["refusal"] += 1
    for odd in (lambda: None, 3, "x", print, lambda *a: ub.fit(log, ground_spacing=2), lambda *a: log.slice(0, 5)):
        attempt(f"progress {odd!r:.30}", lambda: ub.fit(log, fitter="likelihood", rounds=1, ground_spacing=2, progress=odd))
    assert np.array_equal(ub.fit(log, **options).ellipsoids.mean, good), "another model after that"


def shared(folder):
    """A log that one thread changes while others read it."""
    log, stop = ub.read_log(folder / "log.ply"), threading.Event()

    def spoil():
        while not stop.is_set():
            log.range_m[:] = np.random.default_rng(1).normal(5, 100, len(log))
            log.add_column("x", np.float32)
    thread = threading.Thread(target=spoil)
    thread.start()
    for _ in range(10):
        attempt("fit", lambda: ub.fit(log, ground_spacing=2))
        attempt("copy", lambda: log.copy())
    stop.set()
    thread.join()


if __name__ == "__main__":
    faulthandler.enable()
    os.chdir(sys.argv[2])
    globals()[sys.argv[1]](pathlib.Path(sys.argv[2]))
    print(json.dumps(COUNTS))
