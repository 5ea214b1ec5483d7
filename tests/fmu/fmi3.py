"""Calls an FMU of FMI 3.0 through ctypes, as a co-simulation master does."""
from __future__ import annotations

import ctypes
import os
import pathlib
import re
import zipfile

OK, WARNING, DISCARD, ERROR = range(4)
LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)


class Archive3:
    """An unzipped FMU and its library, which is loaded on its own for each copy."""

    def __init__(self, fmu: str, folder: pathlib.Path) -> None:
        """Unzips into a folder, which must not exist."""
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        self.folder = folder
        self.description = (folder / "modelDescription.xml").read_text(encoding="utf-8")
        self.token = re.findall(r'instantiationToken="([^"]*)"', self.description)[0]
        self.reference = {name: int(reference) for name, reference in
                          re.findall(r'<\w+ name="([^"]*)" valueReference="(\d+)"', self.description)}
        self.path = folder / "binaries/x86_64-linux/underbrush.so"
        self.library = ctypes.CDLL(str(self.path), mode=os.RTLD_LOCAL | os.RTLD_NOW)
        for name in ("CoSimulation", "ModelExchange", "ScheduledExecution"):
            getattr(self.library, f"fmi3Instantiate{name}").restype = ctypes.c_void_p
        self.library.fmi3GetVersion.restype = ctypes.c_char_p


class Instance3:
    """An instance, from instantiation to its end."""

    def __init__(self, archive: Archive3, parameters: dict[str, object] | None = None, start: bool = True,
                 token: str | None = None, events: bool = False) -> None:
        """Instantiates, sets parameters by name and, if asked to, ends the initialisation."""
        self.archive, self.library, self.messages = archive, archive.library, list[str]()
        self.logger = LOGGER(lambda _env, _status, _category, text: self.messages.append(text.decode()))
        self.component = ctypes.c_void_p(self.library.fmi3InstantiateCoSimulation(
            b"sensor", (token or archive.token).encode(), str(archive.folder / "resources").encode() + b"/",
            ctypes.c_bool(False), ctypes.c_bool(True), ctypes.c_bool(events), ctypes.c_bool(False), None,
            ctypes.c_size_t(0), None, self.logger, None))
        self.parameters, self.now = parameters or {}, 0.0
        if start:
            self.start()

    def start(self) -> None:
        """Sets the parameters and leads to the first step."""
        for name, value in self.parameters.items():
            assert self.set(name, value) == OK, (name, self.messages)
        assert self.initialize() == OK
        assert self.call("ExitInitializationMode") == OK, self.messages

    def initialize(self) -> int:
        """Enters the initialisation."""
        return self.call("EnterInitializationMode", ctypes.c_bool(False), ctypes.c_double(0), ctypes.c_double(0),
                         ctypes.c_bool(False), ctypes.c_double(0))

    def call(self, function: str, *arguments: object) -> int:
        """Calls fmi3... of this instance."""
        return int(getattr(self.library, "fmi3" + function)(self.component, *arguments))

    def set(self, name: str, value: object) -> int:
        """Sets a variable by the type of its value."""
        reference, one = (ctypes.c_uint * 1)(self.archive.reference[name]), ctypes.c_size_t(1)
        if isinstance(value, bytes):
            held = ctypes.create_string_buffer(value, max(len(value), 1))
            status = self.call("SetBinary", reference, one, (ctypes.c_size_t * 1)(len(value)),
                               (ctypes.c_void_p * 1)(ctypes.addressof(held)), one)
            ctypes.memset(held, 0xFF, len(held))  # The FMU has made a copy.
            return status
        if isinstance(value, bool):
            return self.call("SetBoolean", reference, one, (ctypes.c_bool * 1)(value), one)
        if isinstance(value, int):
            return self.call("SetInt32", reference, one, (ctypes.c_int32 * 1)(value), one)
        if isinstance(value, float):
            return self.call("SetFloat64", reference, one, (ctypes.c_double * 1)(value), one)
        return self.call("SetString", reference, one, (ctypes.c_char_p * 1)(str(value).encode()), one)

    def number(self, name: str) -> float:
        """Gets a Float64."""
        out = (ctypes.c_double * 1)()
        reference, one = (ctypes.c_uint * 1)(self.archive.reference[name]), ctypes.c_size_t(1)
        assert self.call("GetFloat64", reference, one, out, one) == OK, self.messages
        return float(out[0])

    def binary(self, name: str = "OSMPSensorDataOut") -> bytes:
        """Gets a binary variable."""
        sizes, values = (ctypes.c_size_t * 1)(), (ctypes.c_void_p * 1)()
        reference, one = (ctypes.c_uint * 1)(self.archive.reference[name]), ctypes.c_size_t(1)
        assert self.call("GetBinary", reference, one, sizes, values, one) == OK, self.messages
        assert values[0]
        return ctypes.string_at(values[0], sizes[0])

    def do_step(self, step: float = 0.05) -> int:
        """Does a step."""
        event, end, early, last = ctypes.c_bool(True), ctypes.c_bool(True), ctypes.c_bool(True), ctypes.c_double()
        status = self.call("DoStep", ctypes.c_double(self.now), ctypes.c_double(step), ctypes.c_bool(True),
                           ctypes.byref(event), ctypes.byref(end), ctypes.byref(early), ctypes.byref(last))
        if status == OK:
            assert not (event.value or end.value or early.value)
            assert last.value == self.now + step
            self.now += step
        return status

    def step(self, message: bytes, variable: str = "OSMPSensorViewIn") -> bytes:
        """Gives an input, does a step and returns the output."""
        assert self.set(variable, message) == OK, self.messages
        assert self.do_step() == OK, self.messages
        return self.binary()

    def free(self) -> None:
        """Ends the instance."""
        self.library.fmi3FreeInstance(self.component)
