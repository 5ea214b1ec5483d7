"""Calls an FMU through ctypes, as a co-simulation master does."""
from __future__ import annotations

import ctypes
import itertools
import os
import pathlib
import re
import zipfile
from collections.abc import Sequence

OK, WARNING, DISCARD, ERROR = range(4)
VIEW_IN, DATA_OUT, DATA_IN, REQUEST, CONFIG = 0, 3, 6, 9, 12
LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p,
                          ctypes.c_char_p)


class Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions."""
    _fields_ = [("logger", LOGGER), ("allocate", ctypes.c_void_p), ("free", ctypes.c_void_p),
                ("finished", ctypes.c_void_p), ("environment", ctypes.c_void_p)]


class Archive:
    """An unzipped FMU and its library, which is loaded on its own for each copy."""

    def __init__(self, fmu: str, folder: pathlib.Path) -> None:
        """Unzips into a folder, which must not exist."""
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        self.folder = folder
        self.description = (folder / "modelDescription.xml").read_text(encoding="utf-8")
        self.guid = re.findall(r'guid="([^"]*)"', self.description)[0]
        self.reference = {name: int(reference) for name, reference in
                          re.findall(r'ScalarVariable name="([^"]*)" valueReference="(\d+)"', self.description)}
        self.path = folder / "binaries/linux64/underbrush.so"
        self.library = ctypes.CDLL(str(self.path), mode=os.RTLD_LOCAL | os.RTLD_NOW)
        self.library.fmi2Instantiate.restype = ctypes.c_void_p
        self.library.fmi2GetVersion.restype = self.library.fmi2GetTypesPlatform.restype = ctypes.c_char_p


class Instance:
    """An instance, from instantiation to its end."""
    _numbers = itertools.count()

    def __init__(self, archive: Archive, parameters: dict[str, object] | None = None, start: bool = True) -> None:
        """Instantiates, sets parameters by name and, if asked to, ends the initialisation."""
        self.archive, self.library, self.messages = archive, archive.library, list[str]()
        self.logger = LOGGER(lambda _env, _name, _status, _category, form, text: self.messages.append(
            text.decode() if form == b"%s" else "BAD FORMAT"))
        self.callbacks = Callbacks(self.logger, None, None, None, None)
        resources = (archive.folder / "resources").as_uri().encode()
        self.component = ctypes.c_void_p(self.library.fmi2Instantiate(
            b"sensor%d" % next(self._numbers), 1, archive.guid.encode(), resources, ctypes.byref(self.callbacks), 0, 1))
        assert self.component.value, self.messages
        self.parameters = parameters or {}
        self.now, self.held = 0.0, list[object]()
        if start:
            self.start()

    def start(self) -> None:
        """Sets the parameters and leads to the first step."""
        for name, value in self.parameters.items():
            assert self.set(name, value) == OK, (name, self.messages)
        assert self.call("SetupExperiment", 0, ctypes.c_double(0), ctypes.c_double(0), 0, ctypes.c_double(0)) == OK
        assert self.call("EnterInitializationMode") == OK
        assert self.call("ExitInitializationMode") == OK, self.messages

    def call(self, function: str, *arguments: object) -> int:
        """Calls fmi2... of this instance."""
        return int(getattr(self.library, "fmi2" + function)(self.component, *arguments))

    def set(self, name: str, value: object) -> int:
        """Sets a variable by the type of its value."""
        reference = (ctypes.c_uint * 1)(self.archive.reference[name])
        if isinstance(value, bool):
            return self.call("SetBoolean", reference, ctypes.c_size_t(1), (ctypes.c_int * 1)(value))
        if isinstance(value, int):
            return self.call("SetInteger", reference, ctypes.c_size_t(1), (ctypes.c_int * 1)(value))
        if isinstance(value, float):
            return self.call("SetReal", reference, ctypes.c_size_t(1), (ctypes.c_double * 1)(value))
        return self.call("SetString", reference, ctypes.c_size_t(1), (ctypes.c_char_p * 1)(str(value).encode()))

    def set_integers(self, references: Sequence[int], values: Sequence[int]) -> int:
        """Sets integers in one call."""
        n = len(references)
        return self.call("SetInteger", (ctypes.c_uint * n)(*references), ctypes.c_size_t(n),
                         (ctypes.c_int * n)(*values))

    def integers(self, *references: int) -> list[int]:
        """Gets integers in one call."""
        n = len(references)
        out = (ctypes.c_int * n)()
        assert self.call("GetInteger", (ctypes.c_uint * n)(*references), ctypes.c_size_t(n), out) == OK, self.messages
        return list(out)

    def boolean(self, name: str) -> bool:
        """Gets a boolean."""
        out = (ctypes.c_int * 1)()
        assert self.call("GetBoolean", (ctypes.c_uint * 1)(self.archive.reference[name]), ctypes.c_size_t(1), out) == OK
        return bool(out[0])

    def give(self, message: bytes | None, variable: int = VIEW_IN, one_by_one: bool = False) -> None:
        """Sets a binary variable; the bytes stay where they are until the next call."""
        if message is None:
            values = [0, 0, 0]
        else:
            held = ctypes.create_string_buffer(message, max(len(message), 1))
            self.held = [*self.held[-1:], held]
            address = ctypes.addressof(held)
            values = [ctypes.c_int32(address & 0xFFFFFFFF).value, ctypes.c_int32(address >> 32).value, len(message)]
        for k in range(3) if one_by_one else ():
            assert self.set_integers([variable + k], [values[k]]) == OK
        if not one_by_one:
            assert self.set_integers([variable, variable + 1, variable + 2], values) == OK

    def output(self, variable: int = DATA_OUT) -> tuple[int, bytes]:
        """The address and the bytes of a binary variable."""
        low, high, size = self.integers(variable, variable + 1, variable + 2)
        address = (high & 0xFFFFFFFF) << 32 | low & 0xFFFFFFFF
        return address, ctypes.string_at(address, size) if size else b""

    def step(self, message: bytes | None, variable: int = VIEW_IN, step: float = 0.05) -> bytes:
        """Gives an input, does a step and returns the output."""
        self.give(message, variable)
        assert self.call("DoStep", ctypes.c_double(self.now), ctypes.c_double(step), 1) == OK, self.messages
        self.now += step
        return self.output()[1]

    def free(self) -> None:
        """Ends the instance."""
        self.library.fmi2FreeInstance(self.component)
