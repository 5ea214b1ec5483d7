/// \file
/// Logs on disk, whole and in chunks.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>

#include "arrow_tables.hpp"
#include "bind.hpp"
#include "given.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using Path = std::filesystem::path;
using Released = nb::call_guard<nb::gil_scoped_release>;

BeamLog next_chunk(io::LogReader& reader) {
  BeamLog chunk;
  bool more = false;
  {
    const nb::gil_scoped_release released;
    more = reader.next(chunk);
  }
  if (!more) throw nb::stop_iteration();
  return chunk;
}

ArrowTable table_of_chunk(BeamLog&& chunk) {
  const auto kept = std::make_shared<const BeamLog>(std::move(chunk));
  return table_of(*kept, kept);
}

/// Returns the stream of a reader's chunks from the first row on.
nb::object arrow_stream_of(nb::handle_t<io::LogReader> self, nb::handle) {
  io::LogReader& reader = *nb::inst_ptr<io::LogReader>(self);
  const auto kept = kept_alive(self);
  BeamLog first;
  {
    const nb::gil_scoped_release released;
    reader.rewind();
    if (!reader.next(first)) first.info = reader.info();
  }
  return arrow_stream(table_of_chunk(std::move(first)), [&reader, kept]() {
    BeamLog chunk;
    return reader.next(chunk) ? std::optional(table_of_chunk(std::move(chunk))) : std::nullopt;
  });
}

void bind_reader(nb::module_& m) {
  nb::class_<io::LogReader>(
      m, "LogReader",
      "Reads a log (.ply or .ublog) in chunks of at most `chunk_size` rows, each a `BeamLog` of "
      "its\n"
      "own. Iterating begins at the first row. With `first_echoes`, it yields one row for each\n"
      "beam: its first echo, or its miss. Raises `FormatError` as soon as it finds damage.")
      .def(nb::new_([](const Path& path, size_t chunk_size, bool first_echoes) {
             const nb::gil_scoped_release released;
             return first_echoes ? std::make_unique<io::BeamReader>(path, chunk_size)
                                 : std::make_unique<io::LogReader>(path, chunk_size);
           }),
           "path"_a, "chunk_size"_a = size_t(1) << 20, "first_echoes"_a = false)
      .def("__len__", &io::LogReader::size)
      .def(
          "__iter__",
          [](nb::handle_t<io::LogReader> self) {
            nb::inst_ptr<io::LogReader>(self)->rewind();
            return nb::borrow<nb::object>(self);
          },
          nb::sig("def __iter__(self) -> LogReader"))
      .def("__next__", &next_chunk)
      .def(
          "__arrow_c_stream__", &arrow_stream_of, "requested_schema"_a.none() = nb::none(),
          nb::sig("def __arrow_c_stream__(self, requested_schema: object | None = None) -> object"),
          "Returns a capsule with a stream of the chunks from the first row on, for Arrow. Like\n"
          "iterating, it moves the reader.")
      .def_prop_ro("info", &io::LogReader::info, nb::rv_policy::reference_internal,
                   "Facts about the log as a whole.")
      .def_prop_ro("provenance", &io::LogReader::provenance,
                   "Provenance (JSON) of the program that wrote the log; empty if there is none.")
      .def_prop_ro("skipped", &io::LogReader::skipped,
                   "How many records were left out so far, by reason.");
}

void bind_writer(nb::module_& m) {
  nb::class_<io::LogWriter>(
      m, "LogWriter",
      "Writes a log in chunks: a ray cloud PLY, or a compact log where `path` ends in .ublog.\n"
      "Nothing appears at `path` before `close()`; a `with` block closes it at its end, or "
      "removes\n"
      "what was written if it raises.")
      .def(
          "__init__",
          [](io::LogWriter* w, const Path& path, const LogInfo& info, const std::string& provenance,
             bool double_coordinates, bool limits_from_data) {
            new (w) io::LogWriter(path, info, provenance, {double_coordinates, limits_from_data});
          },
          "path"_a, "info"_a, "provenance"_a = "", "double_coordinates"_a = true,
          "limits_from_data"_a = false,
          "Opens the writer. With `limits_from_data`, a longer range of a hit raises the log's\n"
          "maximum range.")
      .def("write", &io::LogWriter::write, "chunk"_a, Released(),
           "Appends rows. All chunks carry the same extra columns. Raises `ValueError`, `OSError`.")
      .def("close", &io::LogWriter::close, Released(),
           "Completes the file under its name. Raises `OSError`.")
      .def(
          "__enter__",
          [](nb::handle_t<io::LogWriter> self) { return nb::borrow<nb::object>(self); },
          nb::sig("def __enter__(self) -> LogWriter"))
      .def(
          "__exit__",
          [](io::LogWriter& w, nb::handle type, nb::handle, nb::handle) {
            if (type.is_none()) w.close();
          },
          "type"_a.none(), "value"_a.none(), "traceback"_a.none(),
          nb::sig("def __exit__(self, type: object, value: object, traceback: object) -> None"));
}

}  // namespace

void bind_log_files(nb::module_& m) {
  bind_reader(m);
  bind_writer(m);
  m.def("read_log", &io::read_log, "path"_a, Released(),
        "Reads a whole log (.ply or .ublog) into memory. Raises `FormatError`, `OSError`.");
  m.def(
      "write_log",
      [](const Path& path, const BeamLog& log, const std::string& format,
         const std::string& provenance, const nb::object& progress) {
        run_watched(progress, [&](const Hook& hook) {
          log.check();
          MemorySource memory(log, 1 << 18);
          WatchedSource source(memory, hook, "write");
          io::export_log(path, source, format, provenance);
        });
      },
      "path"_a, "log"_a, "format"_a = "", "provenance"_a = "", "progress"_a = nb::none(),
      "Writes a log as \"ply\", \"pcd\", \"csv\" or \"kitti\", chosen by the extension if "
      "`format`\n"
      "is empty. The file appears whole or not at all. Raises `ValueError`, `OSError`.");
}

}  // namespace underbrush::python
