/// \file
/// Logs and models as Arrow's tables, and the methods by which other libraries get them.
#pragma once
#include "arrow.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::python {

/// Returns the table of a log, whose memory `owner` keeps. Nothing is copied.
ArrowTable table_of(const BeamLog& log, std::shared_ptr<const void> owner);

/// Returns the table of a model: a copy with a row for each element, in the order of their numbers.
ArrowTable table_of(const elements::Model& model);

/// Adds the methods of Arrow's PyCapsule interface to a class; `table` makes the table of a value.
/// They take a wanted schema, as the interface demands, and give the table's own.
template <class Class, class Table>
void bind_arrow(Class& c, Table table) {
  using Self = nb::handle_t<typename Class::Type>;
  using namespace nb::literals;
  c.def(
       "__arrow_c_schema__", [table](Self self) { return arrow_schema(table(self)); },
       "Returns a capsule with the schema of the table, for Arrow.")
      .def(
          "__arrow_c_array__", [table](Self self, nb::handle) { return arrow_array(table(self)); },
          "requested_schema"_a.none() = nb::none(),
          nb::sig("def __arrow_c_array__(self, requested_schema: object | None = None) -> "
                  "tuple[object, object]"),
          "Returns capsules with the schema and the columns, for Arrow.")
      .def(
          "__arrow_c_stream__",
          [table](Self self, nb::handle) { return arrow_stream(table(self)); },
          "requested_schema"_a.none() = nb::none(),
          nb::sig("def __arrow_c_stream__(self, requested_schema: object | None = None) -> object"),
          "Returns a capsule with a stream of one batch of rows, for Arrow.");
}

}  // namespace underbrush::python
