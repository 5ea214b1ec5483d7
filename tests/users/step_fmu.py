#!/usr/bin/env python3
"""Steps the FMU through the messages of an OSI trace in FMPy, as a co-simulation master does, and writes what it gives
as a trace.

  step_fmu.py UNDERBRUSH.fmu TRACE.osi OUT.osi
"""
from __future__ import annotations

import ctypes
import pathlib
import struct
import sys
import tempfile
from collections.abc import Iterator

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from osi3.osi_sensordata_pb2 import SensorData
from osi3.osi_sensorview_pb2 import SensorView

STEP_S = 0.1


def messages(path: str) -> Iterator[bytes]:
    content = pathlib.Path(path).read_bytes()
    at = 0
    while at < len(content):
        (size,) = struct.unpack_from("<I", content, at)
        yield content[at + 4:at + 4 + size]
        at += 4 + size


def outputs(fmu: str, views: Iterator[bytes]) -> Iterator[bytes]:
    description = read_model_description(fmu)
    name = {v.name: v.valueReference for v in description.modelVariables}
    given = [name[f"OSMPSensorViewIn.{part}"] for part in ("base.lo", "base.hi", "size")]
    got = [name[f"OSMPSensorDataOut.{part}"] for part in ("base.lo", "base.hi", "size")]
    with tempfile.TemporaryDirectory() as folder:
        model = FMU2Slave(guid=description.guid, unzipDirectory=extract(fmu, folder), modelIdentifier="underbrush",
                          instanceName="lidar")
        model.instantiate()
        model.setReal([name["cycle_s"]], [STEP_S])
        model.setupExperiment(startTime=0.0)
        model.enterInitializationMode()
        model.exitInitializationMode()
        for k, view in enumerate(views):
            buffer = ctypes.create_string_buffer(view, len(view))
            address = ctypes.addressof(buffer)
            model.setInteger(given, [ctypes.c_int32(address & 0xFFFFFFFF).value, address >> 32, len(view)])
            model.doStep(currentCommunicationPoint=STEP_S * k, communicationStepSize=STEP_S)
            low, high, size = model.getInteger(got)
            yield ctypes.string_at((high & 0xFFFFFFFF) << 32 | low & 0xFFFFFFFF, size)
        model.terminate()
        model.freeInstance()


def main() -> None:
    fmu, trace, out = sys.argv[1:]
    views = list(messages(trace))
    found = times = 0
    with open(out, "wb") as file:
        for view, data in zip(views, outputs(fmu, iter(views)), strict=True):
            message, given = SensorData.FromString(data), SensorView.FromString(view)
            if abs(message.last_measurement_time.seconds - given.timestamp.seconds) > 1:
                sys.exit(f"step_fmu: measured at {message.last_measurement_time} a view of {given.timestamp}")
            times, found = times + 1, found + bool(message.moving_object)
            file.write(struct.pack("<I", len(data)) + data)
    print(f"{times} steps, objects in {found} of them")
    if found < 0.85 * times:
        sys.exit("step_fmu: the car ahead is not found")


if __name__ == "__main__":
    main()
