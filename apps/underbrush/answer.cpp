#include "answer.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::app {

trace::Draws draws_of(const std::string& matter, double sway_s) {
  require(matter == "once" || sway_s == 0,
          "simulate: --wind moves matter that is drawn once, not --matter anew");
  if (matter == "anew") return trace::Draws::kAnew;
  return sway_s > 0 ? trace::Draws::kSwaying : trace::Draws::kOnce;
}

Answer::Answer(AnswerArguments a, const simulate::DynamicWorld& world,
               const simulate::InstanceKinds& kinds, const std::optional<sensor::Sensor>& recorder,
               const SensorOf& sensor_of)
    : a_(std::move(a)), world_(world) {
  a_.simulate.draw = a_.draw == "on_ray"   ? simulate::RangeDraw::kOnRay
                     : a_.draw == "median" ? simulate::RangeDraw::kMedian
                                           : simulate::RangeDraw::kVolumetric;
  a_.simulate.intensity =
      a_.intensity == "mean" ? simulate::IntensityDraw::kMean : simulate::IntensityDraw::kDrawn;
  if (a_.beam == "random") a_.simulate.random_ray = sensor_of("--beam random").beam;
  if (!a_.instrument.super_sample.empty()) set_up(kinds, recorder, sensor_of);
}

void Answer::set_up(const simulate::InstanceKinds& kinds,
                    const std::optional<sensor::Sensor>& recorder, const SensorOf& sensor_of) {
  require(a_.beam == "thin" && a_.draw == "on_ray" && a_.simulate.range_noise_m == 0 &&
              a_.intensity == "mean",
          "simulate: --beam, --draw, --intensity and --range-noise are of thin rays, not of "
          "--super-sample");
  sensor_ = sensor_of("--super-sample");
  instrument_ = instrument_of(a_.instrument, sensor_, recorder);
  if (a_.simulate.max_range_m > 0) instrument_.receiver.max_range_m = a_.simulate.max_range_m;
  reflection_ = std::make_unique<simulate::Reflection>(materials_of(a_.instrument, kinds),
                                                       sensor_.wavelength_m, kinds);
  simulate::EchoOptions options;
  options.seed = a_.simulate.seed;
  options.element_ids = a_.simulate.element_ids;
  options.all_sub_rays = a_.instrument.all_sub_rays;
  options.sway_s = a_.simulate.sway_s;
  options.instance_labels = a_.simulate.instance_labels;
  if (!a_.instrument.waveforms.empty()) options.waveforms = a_.instrument.waveform;
  for (const std::string& file : a_.instrument.waveforms) {
    if (!is_waveform_file(file)) continue;
    files_.push_back(std::make_unique<WaveformFile>(file));
    options.waveforms.count = SIZE_MAX;
  }
  maker_ = std::make_unique<simulate::EchoMaker>(world_, *reflection_, instrument_, options);
}

void Answer::operator()(size_t first_beam, BeamLog& beams) {
  if (maker_) {
    maker_->answer(first_beam, beams);
    take_waveforms();
  } else {
    simulate::simulate(world_, a_.simulate, first_beam, beams);
  }
  add_offsets(world_.model(0).channels_of(beams.info), 1, beams);
}

void Answer::take_waveforms() {
  if (a_.instrument.waveforms.empty()) return;
  std::vector<simulate::BeamWaveform> taken = maker_->take_waveforms();
  for (const auto& file : files_) file->append(taken);
  for (simulate::BeamWaveform& w : taken) {
    if (waveforms_.size() < a_.instrument.waveform.count) waveforms_.push_back(std::move(w));
  }
}

void Answer::write_waveforms() {
  if (maker_) app::write_waveforms(a_.instrument, sensor_, waveforms_);
  for (const auto& file : files_) file->close();
  files_.clear();
}

}  // namespace underbrush::app
