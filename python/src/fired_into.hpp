/// \file
/// What beams are fired into, as Python gives it.
#pragma once
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "answer.hpp"
#include "given.hpp"
#include "traced_scene.hpp"

namespace underbrush::python {

/// An object that moves: a model, or the path of a model or mesh; its poses; its material.
using GivenMover =
    std::tuple<GivenModel, std::variant<std::filesystem::path, Trajectory>, std::string>;

/// The options of `simulate` and `Lidar`.
struct SimulateOptions {
  app::AnswerArguments answer;
  std::string matter = "once";
  double tau = 0, grain_m = 0;
  std::vector<GivenMover> movers;
};

/// A model or scene, prepared for tracing. A model or scene that was given as a value and is not
/// changed by the options must outlive it; all else is its own.
class FiredInto {
 public:
  /// Throws as the readers do, and `std::invalid_argument` for options out of range.
  FiredInto(const GivenWorld& given, const SimulateOptions& options);
  const simulate::DynamicWorld& world() const { return *traced_.dynamic_world; }
  /// Returns what answers its beams. This must outlive it.
  app::Answer answer(const SimulateOptions& options, const app::Answer::SensorOf& sensor_of) const;

 private:
  elements::Scene own_;
  elements::SceneInfo info_;
  simulate::InstanceKinds kinds_;
  std::optional<sensor::Sensor> recorder_;
  bool labelled_ = false;  ///< Whether instances have classes.
  app::TracedScene traced_;
};

}  // namespace underbrush::python
