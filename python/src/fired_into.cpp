#include "fired_into.hpp"

#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/poses.hpp"

namespace underbrush::python {
namespace {

void check(const SimulateOptions& o) {
  const auto one_of = [](const std::string& value, const char* a, const char* b,
                         const char* message) { require(value == a || value == b, message); };
  require(o.answer.draw == "median" || o.answer.draw == "on_ray" || o.answer.draw == "volumetric",
          "simulate: draw is on_ray, volumetric or median");
  one_of(o.answer.beam, "thin", "random", "simulate: beam is thin or random");
  one_of(o.answer.instrument.footprint, "excess", "whole",
         "simulate: footprint is excess or whole");
  one_of(o.matter, "once", "anew", "simulate: matter is once or anew");
  const auto not_negative = [](double x, const char* message) { require(x >= 0, message); };
  not_negative(o.tau, "simulate: tau is not negative");
  not_negative(o.grain_m, "simulate: grain is not negative");
  not_negative(o.answer.simulate.sway_s, "simulate: wind is not negative");
  not_negative(o.answer.simulate.max_range_m, "simulate: max_range is not negative");
  not_negative(o.answer.simulate.range_noise_m, "simulate: range_noise is not negative");
  not_negative(o.answer.instrument.visibility_m, "simulate: visibility is not negative");
  not_negative(o.answer.instrument.rain_mm_per_h, "simulate: rain is not negative");
  require(o.answer.instrument.sun >= 0 && o.answer.instrument.sun <= 1,
          "simulate: sun is in [0, 1]");
  o.answer.instrument.check();
}

}  // namespace

FiredInto::FiredInto(const GivenWorld& given, const SimulateOptions& options) {
  check(options);
  const auto* path = std::get_if<std::filesystem::path>(&given);
  const auto* model = std::get_if<const ModelValue*>(&given);
  const auto* scene = std::get_if<const SceneValue*>(&given);
  const bool changed = !options.movers.empty() || options.tau > 0 || options.grain_m > 0;
  const trace::Draws draws = app::draws_of(options.matter, options.answer.simulate.sway_s);
  if (path) own_ = app::read_world(*path, &info_);
  if (scene) info_ = (*scene)->info;
  if (changed && model) own_.models.push_back(**model);
  if (changed && scene) own_ = (*scene)->scene;
  for (const auto& [moved, poses, material] : options.movers) {
    const auto* file = std::get_if<std::filesystem::path>(&moved);
    const auto* poses_file = std::get_if<std::filesystem::path>(&poses);
    elements::Model object;
    if (file) {
      object = app::read_mover_model(*file);
    } else {
      object = *std::get<const ModelValue*>(moved);
    }
    app::add_mover(own_, info_, std::move(object),
                   poses_file ? io::read_trajectory(*poses_file) : std::get<Trajectory>(poses),
                   material);
  }
  app::set_matter(own_, options.tau, options.grain_m);
  const elements::Scene& shown = scene && !changed ? (*scene)->scene : own_;
  kinds_ = simulate::instance_kinds(shown, info_);
  std::span<const elements::Model> models = shown.models;
  if (model && !changed) models = {static_cast<const elements::Model*>(*model), 1};
  recorder_ = app::recorder_of(models);
  labelled_ = !shown.instances.empty();
  if (model && !changed) {
    traced_.world = std::make_unique<trace::World>(**model, trace::Isa::kBest, draws);
    traced_.dynamic_world = std::make_unique<simulate::DynamicWorld>(*traced_.world);
  } else {
    traced_ = app::traced_scene(shown, info_, draws);
  }
  const radiometry::Materials materials = app::materials_of(options.answer.instrument, kinds_);
  for (const std::string& name : info_.materials) {
    if (!name.empty()) materials.named(name);  // throws for an unknown name
  }
}

app::Answer FiredInto::answer(const SimulateOptions& options,
                              const app::Answer::SensorOf& sensor_of) const {
  app::AnswerArguments arguments = options.answer;
  if (labelled_) arguments.simulate.instance_labels = info_.labels;
  return app::Answer(arguments, world(), kinds_, recorder_, sensor_of);
}

}  // namespace underbrush::python
