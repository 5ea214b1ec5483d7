/// \file
/// Exceptions of the library as those of Python.
#include <nanobind/stl/string.h>

#include <filesystem>
#include <system_error>

#include "bind.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::python {
namespace nb = nanobind;
namespace {

void raise_format_error(const FormatError& e) {
  const nb::object type = nb::module_::import_("underbrush.errors").attr("FormatError");
  const nb::object raised = type(e.file(), e.place(), e.reason());
  PyErr_SetObject(type.ptr(), raised.ptr());
}

void raise_os_error(const std::filesystem::filesystem_error& e) {
  const nb::object type = nb::borrow(PyExc_OSError);
  const nb::object raised = type(e.code().value(), e.code().message(), e.path1().string());
  PyErr_SetObject(type.ptr(), raised.ptr());
}

}  // namespace

void bind_errors(nb::module_&) {
  nb::register_exception_translator([](const std::exception_ptr& p, void*) {
    try {
      std::rethrow_exception(p);
    } catch (const FormatError& e) {
      raise_format_error(e);
    } catch (const IoError& e) {
      PyErr_SetString(PyExc_OSError, e.what());
    } catch (const std::filesystem::filesystem_error& e) {
      raise_os_error(e);
    }
  });
}

}  // namespace underbrush::python
