#include "underbrush/pipeline/simulation.hpp"

#include <algorithm>

#include "underbrush/actors/actor_edits.hpp"
#include "underbrush/core/beam_window.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/perception/rig_source.hpp"
#include "underbrush/pipeline/instrument.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/simulate/support.hpp"

namespace underbrush::pipeline {
namespace {

// Beams of a rig's sensor k have numbers from k · 2⁴⁰, so that no two have the same.
constexpr int kSensorBits = 40;

simulate::Options thin_rays(const SimulateOptions& o, const TracedWorld& world) {
  simulate::Options out;
  out.seed = o.seed;
  out.draw = o.draw == "on_ray"   ? simulate::RangeDraw::kOnRay
             : o.draw == "median" ? simulate::RangeDraw::kMedian
                                  : simulate::RangeDraw::kVolumetric;
  out.range_noise_m = o.range_noise_m;
  out.intensity =
      o.intensity == "mean" ? simulate::IntensityDraw::kMean : simulate::IntensityDraw::kDrawn;
  out.max_range_m = o.max_range_m;
  out.sway_s = world.sway_s();
  out.element_ids = o.element_ids;
  out.keyframes = o.keyframes;
  out.instance_labels = world.labels();
  return out;
}

simulate::EchoOptions echo_options(const SimulateOptions& o, const TracedWorld& world) {
  simulate::EchoOptions out;
  out.seed = o.seed;
  out.element_ids = o.element_ids;
  out.all_sub_rays = o.instrument.all_sub_rays;
  out.sway_s = world.sway_s();
  out.instance_labels = world.labels();
  if (o.on_waveforms) out.waveforms = o.waveform;
  if (o.on_waveforms && o.all_waveforms) out.waveforms.count = SIZE_MAX;
  return out;
}

sensor::Sensor no_sensor(const char* what) {
  throw std::invalid_argument(std::string("simulate: ") + what +
                              ", but the sensor of the beams is not known");
}

bool names_materials(const TracedWorld& world) {
  return std::ranges::any_of(world.materials(),
                             [](const std::string& name) { return !name.empty(); });
}

bool knows_light(const TracedWorld& world) {
  return std::ranges::all_of(world.models(),
                             [](const elements::Model& m) { return m.light.known(); });
}

const std::vector<uint8_t>& sensors_in(const BeamLog& beams) {
  return std::get<std::vector<uint8_t>>(beams.extra.at(perception::kSensorColumn));
}

/// Puts the beams of several sensors back into their order, each with all its echoes.
BeamLog in_order(const LogInfo& info, const std::vector<uint8_t>& sensor,
                 const std::vector<BeamLog>& part) {
  BeamLog out;
  out.info = info;
  std::vector<std::vector<bool>> begins;
  begins.reserve(part.size());
  for (const BeamLog& p : part) begins.push_back(begins_beam(p));
  std::vector<size_t> at(part.size(), 0);
  for (size_t i = 0; i < sensor.size();) {
    const uint8_t k = sensor[i];
    const size_t begin = at[k];
    for (; i < sensor.size() && sensor[i] == k; ++i) {
      do {
        ++at[k];
      } while (at[k] < part[k].size() && !begins[k][at[k]]);
    }
    out.append(part[k], begin, at[k]);
  }
  return out;
}

}  // namespace

bool changes_world(const SimulateOptions& options) {
  return !options.actors.empty() || options.tau > 0 || options.grain_m > 0;
}

void change_world(World& world, const SimulateOptions& options) {
  if (!options.actors.empty()) add_actors(world, actors::read_actors(options.actors));
  for (elements::Model& model : world.scene.models) {
    require(!world.regions || options.tau <= model.tau,
            "simulate: --tau of a world of regions must not be larger than that of its models, for "
            "which the bounds of the regions are");
    if (options.tau > 0) model.tau = options.tau;
    if (options.grain_m > 0) model.grain = {options.grain_m, options.grain_m, {}};
  }
}

Matter matter_of(const SimulateOptions& options) {
  check_options("simulate", simulate_options(), options);
  return {options.matter == "anew", options.matter == "still", options.sway_s};
}

/// The answers to the beams of one sensor.
class Simulation::OfSensor {
 public:
  OfSensor(const TracedWorld& world, const SimulateOptions& options, const SensorOf& sensor_of)
      : world_(world),
        keyframes_allowed_(options.keyframes),
        adds_support_(options.support),
        thin_(thin_rays(options, world)),
        on_waveforms_(options.on_waveforms) {
    if (adds_support_ && !world.still().unknown_space()) {
      throw std::invalid_argument(
          "simulate: --support needs a model with a map of observed space (fit --unknown-cell 1)");
    }
    if (options.beam == "random") thin_.random_ray = sensor_of("--beam random").beam;
    const bool thin = options.instrument.super_sample.empty();
    if (thin && !names_materials(world)) return;
    const radiometry::Materials materials = materials_of(options.instrument, world.kinds());
    for (const std::string& name : world.materials()) {
      if (!name.empty()) materials.named(name);  // This throws for an unknown name.
    }
    if (thin) return;
    sensor_ = sensor_of("--super-sample");
    const std::optional<sensor::Sensor> recorder = world.recorder();
    instrument_ = instrument_of(options.instrument, sensor_, recorder);
    if (options.max_range_m > 0) instrument_.receiver.max_range_m = options.max_range_m;
    reflection_ =
        std::make_unique<simulate::Reflection>(materials, sensor_.wavelength_m, world.kinds());
    simulate::EchoOptions echoes = echo_options(options, world);
    if (has_learnt_light(options.instrument, sensor_, recorder) && knows_light(world)) {
      echoes.learnt_light = thin_.intensity;
    }
    has_learnt_light_ = echoes.learnt_light.has_value();
    maker_ =
        std::make_unique<simulate::EchoMaker>(world.dynamic(), *reflection_, instrument_, echoes);
  }

  void answer(size_t first_beam, BeamLog& beams) {
    const ChannelOffsets offsets = world_.dynamic().model(0).channels_of(beams.info);
    if (adds_support_) {
      beams.extra[simulate::kSupportColumn] = simulate::supports(world_.still(), beams);
    }
    if (maker_) {
      simulate::CachedReturns cached;
      if (keyframes_serve(beams.info)) {
        cached = simulate::keyframe_answers(world_.dynamic(), thin_, first_beam, beams);
      }
      maker_->answer(first_beam, beams, cached);
      if (on_waveforms_) {
        std::vector<simulate::BeamWaveform> waveforms = maker_->take_waveforms();
        simulate::add_offsets(offsets, waveforms);
        on_waveforms_(std::move(waveforms));
      }
    } else {
      simulate::simulate(world_.dynamic(), thin_, first_beam, beams);
    }
    add_offsets(offsets, 1, beams);
  }

  void recognise(BeamSource& log) {
    thin_.keyframes = keyframes_allowed_;
    if (!keyframes_serve(log.info())) return;
    thin_.keyframes = keyframes::KeyframeCache::serves(world_.dynamic().model(0), log);
  }

  bool& keyframes() { return thin_.keyframes; }
  /// How far (m) a ray may lie from the axis of its beam at a range.
  double spread_m(double range_m) const {
    constexpr double kHalfWidths = 10;  // more than any normal number that is drawn
    if (!maker_ && !thin_.random_ray) return 0;
    const sensor::BeamShape& shape = maker_ ? sensor_.beam : *thin_.random_ray;
    const auto [right, up] = shape.half_width_m(range_m);
    return kHalfWidths * std::max(right, up) + range_m * shape.encoder_step_rad;
  }

  size_t sub_rays() const { return maker_ ? instrument_.sub_rays.size() : 0; }
  bool uses_learnt_light() const { return !maker_ || has_learnt_light_; }
  size_t rays_traced() const { return maker_ ? maker_->rays() : 0; }
  const sensor::Sensor& sensor() const { return sensor_; }
  bool keyframes_serve(const LogInfo& beams) const {
    // Pixels are first echoes.
    const bool several = maker_ && instrument_.receiver.max_echoes > 1;
    return !several && simulate::keyframes_serve(world_.dynamic(), thin_, beams);
  }

 private:
  const TracedWorld& world_;
  const bool keyframes_allowed_;  ///< By the options.
  const bool adds_support_;
  simulate::Options thin_;
  std::function<void(std::vector<simulate::BeamWaveform>)> on_waveforms_;
  sensor::Sensor sensor_;
  simulate::Instrument instrument_;
  std::unique_ptr<simulate::Reflection> reflection_;
  std::unique_ptr<simulate::EchoMaker> maker_;
  bool has_learnt_light_ = false;  // of the instrument
};

Simulation::Simulation(const TracedWorld& world, SimulateOptions options, const SensorOf& sensor_of)
    : world_(&world),
      options_(std::move(options)),
      sensor_of_{sensor_of ? sensor_of : SensorOf(no_sensor)} {
  prepare();
}

Simulation::Simulation(const TracedWorld& world, const SimulateOptions& options,
                       const std::vector<sensor::Sensor>& rig)
    : world_(&world), options_(options), rig_(true), fired_(rig.size(), 0) {
  for (const sensor::Sensor& s : rig) {
    LogInfo limits;
    limits.sensor = s.name;
    limits.min_range_m = s.min_range_m;
    limits.max_range_m = s.max_range_m;
    limits_.push_back(limits);
    sensor_of_.emplace_back([s](const char*) { return s; });
  }
  prepare();
}

void Simulation::prepare() {
  options_.check();
  const uint64_t memory = regions::memory_of(options_.memory);
  if (const regions::WorldFolder* folder = world_->regions()) {
    open_ = std::make_unique<regions::OpenRegions>(*folder, memory);
  }
  use(*world_);
  if (!open_) sensor_of_.clear();
}

void Simulation::use(const TracedWorld& world) {
  for (const auto& a : answers_) rays_before_ += a->rays_traced();
  answers_.clear();
  for (const SensorOf& sensor_of : sensor_of_) {
    SimulateOptions own = options_;
    if (!answers_.empty()) own.on_waveforms = nullptr;
    answers_.push_back(std::make_unique<OfSensor>(world, own, sensor_of));
  }
  answers_[0]->keyframes() &= uses_keyframes_;
}

Simulation::Simulation(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

bool Simulation::uses_learnt_light() const { return answers_[0]->uses_learnt_light(); }

size_t Simulation::sub_rays() const { return answers_[0]->sub_rays(); }

size_t Simulation::rays_traced() const {
  size_t sum = rays_before_;
  for (const auto& a : answers_) sum += a->rays_traced();
  return sum;
}

const sensor::Sensor& Simulation::sensor() const { return answers_[0]->sensor(); }

void Simulation::recognise(BeamSource& log) {
  if (rig_) return;
  answers_[0]->recognise(log);
  uses_keyframes_ = answers_[0]->keyframes();
}

bool Simulation::keyframes_serve(const LogInfo& beams) const {
  return answers_[0]->keyframes_serve(beams);
}

std::vector<size_t> Simulation::fired_in(BeamSource& source, size_t beams) const {
  std::vector<size_t> out(fired_.size(), 0);
  if (!rig_ || beams == 0) return out;
  BeamWindow window(source, 0, beams);
  window.rewind();
  for (BeamLog chunk; window.next(chunk);) {
    for (const uint8_t sensor : sensors_in(chunk)) ++out[sensor];
  }
  return out;
}

void Simulation::answer(size_t first_beam, BeamLog& beams) {
  if (!open_) return answer_here(first_beam, beams);
  regions::Reach reach{options_.max_range_m > 0 ? options_.max_range_m : beams.info.max_range_m};
  for (const LogInfo& of_sensor : limits_) {
    reach.range_m = std::max(reach.range_m, of_sensor.max_range_m);
  }
  for (const auto& a : answers_) {
    reach.spread_m = std::max(reach.spread_m, a->spread_m(reach.range_m));
  }
  BeamLog out;
  for (size_t begin = 0, end = 0; begin < beams.size(); begin = end) {
    end = open_->open_for(beams, begin, reach);
    if (const auto regions = open_->changed()) enter(*regions);
    BeamLog part = beams.like();
    part.append(beams, begin, end);
    answer_here(first_beam + begin, part);
    if (begin == 0) out = part.like();
    out.append(part, 0, part.size());
  }
  if (!beams.empty()) beams = std::move(out);
}

void Simulation::enter(const std::vector<uint32_t>& regions) {
  use(*world_);
  part_.reset();  // Two parts need not be in memory at a time.
  part_ = open_part(*world_, regions);
  use(*part_);
}

void Simulation::answer_here(size_t first_beam, BeamLog& beams) {
  if (!rig_) return answers_[0]->answer(first_beam, beams);
  if (first_beam == 0) fired_.assign(fired_.size(), 0);
  std::vector<BeamLog> part(answers_.size());
  const std::vector<uint8_t> sensor = sensors_in(beams);
  for (size_t begin = 0, end = 0; begin < beams.size(); begin = end) {
    while (end < beams.size() && sensor[end] == sensor[begin]) ++end;
    part[sensor[begin]].append(beams, begin, end);
  }
  for (size_t k = 0; k < part.size(); ++k) {
    if (part[k].empty()) continue;
    part[k].info.sensor = limits_[k].sensor;
    part[k].info.min_range_m = limits_[k].min_range_m;
    part[k].info.max_range_m = limits_[k].max_range_m;
    const size_t fired = part[k].size();
    answers_[k]->answer((k << kSensorBits) + fired_[k], part[k]);
    fired_[k] += fired;
  }
  beams = in_order(beams.info, sensor, part);
}

}  // namespace underbrush::pipeline
