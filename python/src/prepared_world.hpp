/// \file
/// The worlds into which beams are fired, as Python gives them.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "given.hpp"
#include "report/waveform_outputs.hpp"
#include "underbrush/pipeline/simulation.hpp"

namespace underbrush::python {

/// An object that moves: a model, or the path of a model or mesh; its poses; its material.
using GivenMover =
    std::tuple<GivenModel, std::variant<std::filesystem::path, Trajectory>, std::string>;

/// The options of `simulate` and `Lidar`.
struct SimulateOptions {
  pipeline::SimulateOptions pipeline;
  std::vector<GivenMover> movers;
  std::map<std::string, GivenModel> absent;  ///< Movers without a motion of their own, by name.
  report::SimulateFiles files;
  worlds::ReadOptions read;  ///< The options for reading a world of another program.
};

/// A model or scene, prepared for tracing. A model or scene that was given as a value and is not
/// changed by the options must outlive it; all else is its own.
class PreparedWorld {
 public:
  /// Throws as the readers do, and `std::invalid_argument` for options out of range.
  PreparedWorld(const GivenWorld& given, const SimulateOptions& options);
  pipeline::TracedWorld& world() const { return *traced_; }

 private:
  std::unique_ptr<pipeline::TracedWorld> traced_;
};

}  // namespace underbrush::python
