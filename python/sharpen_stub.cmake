# cmake -DFROM=… -DTO=… -P sharpen_stub.cmake: gives the types in the module's stub their arguments, which mypy --strict
# asks for.
file(READ ${FROM} stub)
string(REPLACE "os.PathLike" "os.PathLike[str]" stub "${stub}")
string(REGEX REPLACE ": dict([,)])" ": dict[str, object]\\1" stub "${stub}")
file(WRITE ${TO} "${stub}")
