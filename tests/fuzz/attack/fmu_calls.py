"""Calls an FMU in ways that make no sense, in a process of its own: `fmu_calls.py FMU FMU3 ATTACK SEED`.

Prints how many calls were answered and how many refused. The process must not end before that.
"""
import ctypes
import json
import pathlib
import random
import resource
import sys
import tempfile
import threading

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "fmu"))
from cases import SENSOR, drive  # noqa: E402
from fmi3 import Archive3, Instance3  # noqa: E402
from fmu import VIEW_IN, Archive, Instance  # noqa: E402

SEQUENCES, CALLS, INSTANCES = 60, 60, 10_000
COUNTS = {"answer": 0, "refusal": 0}
SIZE, REAL = ctypes.c_size_t, ctypes.c_double


def note(status):
    COUNTS["answer" if status in (0, 1) else "refusal"] += 1


def memory_kib():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def array(kind, values):
    return (kind * len(values))(*values)


def arguments_of(function, rng, references, binary, keep):
    """Arguments of a call that fit its types, some of them null pointers or beyond all bounds."""
    n = rng.choice((0, 1, 2, 3))
    names = array(ctypes.c_uint, [rng.choice((*references, 0xFFFFFFFF, 10_000)) for _ in range(n)])
    null = rng.random() < 0.2
    real = lambda: REAL(rng.choice((0, 0.05, -1, float("nan"), float("inf"), 1e308, 1e-308)))  # noqa: E731
    if function.startswith("DoStep"):
        return [real(), real(), 1, None, None, None, None]
    if function in ("SetupExperiment", "EnterInitializationMode"):
        return [0, real(), real(), 0, real()]
    if function.startswith(("Get", "Set")) and not function.endswith(("state", "State")):
        kinds = {"Real": REAL, "Float64": REAL, "Integer": ctypes.c_int, "Int32": ctypes.c_int, "Boolean": ctypes.c_int,
                 "String": ctypes.c_char_p}
        if function.endswith("Binary"):
            sizes = array(SIZE, [rng.choice((0, 1, 100, len(binary))) for _ in range(n)])
            values = array(ctypes.c_void_p, [rng.choice((None, ctypes.addressof(keep))) for _ in range(n)])
            return [None if null else names, SIZE(n), sizes, values, SIZE(rng.choice((n, n, n + 1)))]
        kind = kinds[function[3:]]
        odd = {REAL: (0, float("nan"), -1, 1e308), ctypes.c_int: (0, -1, 2**31 - 1, -2**31, 3),
               ctypes.c_char_p: (None, b"", b"\xff\xfe", b"a" * 10_000, b"%n%s%s", b"../../..", b"/dev/zero", b"median")}
        # Addresses have attacks of their own.
        values = array(kind, [rng.choice(odd[kind]) for _ in range(n)])
        return [None if null else names, SIZE(n), None if rng.random() < 0.1 else values, SIZE(rng.choice((n, n, n + 1)))]
    return []


CALLS2 = ("SetupExperiment", "EnterInitializationMode", "ExitInitializationMode", "Terminate", "Reset", "DoStep", "GetReal",
          "SetReal", "GetInteger", "SetInteger", "GetBoolean", "SetBoolean", "GetString", "SetString", "GetFMUstate",
          "SetFMUstate", "FreeFMUstate", "CancelStep")
CALLS3 = ("EnterInitializationMode", "ExitInitializationMode", "Terminate", "Reset", "DoStep", "GetFloat64", "SetFloat64",
          "GetInt32", "SetInt32", "GetBoolean", "SetBoolean", "GetString", "SetString", "GetBinary", "SetBinary", "GetFMUState",
          "SetFMUState", "FreeFMUState", "EnterEventMode")


def call(one, function, rng, references, state, keep):
    """Does one call; states are real ones, null or those of another instance."""
    if function.lower().endswith("fmustate"):
        if function.startswith("Set"):
            note(one.call(function, state if rng.random() < 0.8 else None))
        else:
            note(one.call(function, ctypes.byref(state) if rng.random() < 0.9 else None))
        return
    note(one.call(function, *arguments_of(function, rng, references, keep.raw, keep)))


def in_any_order(archives, rng, made):
    """Sequences of calls in any order, some of them with null pointers."""
    for number in range(SEQUENCES):
        archive, kind, calls = (archives[0], Instance, CALLS2) if number % 2 else (archives[1], Instance3, CALLS3)
        # Addresses of messages (FMI 2.0) are left out here: what they lead to is another attack.
        references = [r for name, r in archive.reference.items() if "OSMP" not in name]
        one, state = made(kind, archive, start=rng.random() < 0.5), ctypes.c_void_p()
        keep = ctypes.create_string_buffer(drive(1))
        for _ in range(CALLS):
            call(one, rng.choice(calls), rng, references, state, keep)
            if rng.random() < 0.1 and one.call("DoStep", REAL(one.now), REAL(0.05), 1, None, None, None, None) == 0:
                one.now += 0.05
        function = "FreeFMUstate" if kind is Instance else "FreeFMUState"
        one.call(function, ctypes.byref(state))
        one.free()


def addresses(archives, rng, made):
    """Addresses and sizes of messages that lie (FMI 2.0)."""
    one = made(Instance, archives[0])
    message = ctypes.create_string_buffer(drive(0))
    true, size = ctypes.addressof(message), len(drive(0))
    end = (true // 4096 + 1) * 4096
    for address in (0, 1, 0x10, 0xFFF, 0xDEADBEEF, 1 << 47, (1 << 64) - 1, (1 << 63), true, end):
        for length in (0, 1, size, -1, -2**31, 2**31 - 1, size + 1, 1 << 20):
            low, high = ctypes.c_int32(address & 0xFFFFFFFF).value, ctypes.c_int32(address >> 32).value
            if address in (true, end) and length > size:
                continue  # bytes of others, which may be anything
            one.set_integers([VIEW_IN, VIEW_IN + 1, VIEW_IN + 2], [low, high, length])
            print(f"address {address:#x} size {length}", file=sys.stderr, flush=True)
            status = one.call("DoStep", REAL(one.now), REAL(0.05), 1)
            one.now += 0.05 if status == 0 else 0
            note(0 if one.boolean("valid") else 3)
    one.free()


def states(archives, rng, made):
    """States that are freed twice, restored after that, of another instance, or no states."""
    first, second = made(Instance, archives[0]), made(Instance, archives[0])
    state = ctypes.c_void_p()
    note(first.call("GetFMUstate", ctypes.byref(state)))
    copy = ctypes.c_void_p(state.value)
    note(second.call("SetFMUstate", copy))
    note(second.call("FreeFMUstate", ctypes.byref(state)))
    note(first.call("FreeFMUstate", ctypes.byref(state)))
    for odd in (copy.value, 8, ctypes.addressof(state)):
        print(f"state {odd:#x}", file=sys.stderr, flush=True)
        note(first.call("SetFMUstate", ctypes.c_void_p(odd)))
        note(first.call("GetFMUstate", ctypes.byref(ctypes.c_void_p(odd))))
        note(first.call("FreeFMUstate", ctypes.byref(ctypes.c_void_p(odd))))
    first.free()
    second.free()


def threads(archives, rng, made):
    """Instances in threads of their own, and one instance that several threads call."""
    shared = made(Instance, archives[0])

    def work(number):
        own = made(Instance3 if number % 2 else Instance, archives[number % 2])
        for k in range(10):
            own.step(drive(k))
            note(shared.call("DoStep", REAL(0.05 * k), REAL(0.05), 1))
            note(shared.call("Reset") if k == 5 else 0)
        own.free()
    all_of_them = [threading.Thread(target=work, args=(n,)) for n in range(8)]
    for one in all_of_them:
        one.start()
    for one in all_of_them:
        one.join()
    shared.free()


def instances(archives, rng, made):
    """Ten thousand instances, made and freed; memory must not grow with their number."""
    before = 0
    for k in range(INSTANCES):
        one = made(Instance3 if k % 2 else Instance, archives[k % 2], start=k % 200 == 0)
        if k % 200 == 0:
            one.step(drive(0))
        one.free()
        note(0)
        before = before or (memory_kib() if k == INSTANCES // 10 else 0)
    grown = memory_kib() - before
    if grown > 20_000:
        raise SystemExit(f"memory grew by {grown} KiB over {INSTANCES} instances")
    held = [made(Instance3 if k % 2 else Instance, archives[k % 2], start=False) for k in range(INSTANCES)]
    for one in held:
        note(0)
        one.free()


def main():
    fmu, fmu3, attack, seed = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "tiny.yaml").write_text(SENSOR)
        archives = (Archive(fmu, folder / "two"), Archive3(fmu3, folder / "three"))
        parameters = {"profile": str(folder / "tiny.yaml"), "threads": 1}

        def made(kind, archive, start=True):
            return kind(archive, parameters, start=start)
        globals()[attack](archives, random.Random(f"{seed}/{attack}"), made)
    print(json.dumps(COUNTS))


if __name__ == "__main__":
    main()
