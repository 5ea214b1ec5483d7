#include "rig_answer.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::app {
namespace {

// Beams of a rig's sensor k have numbers from k · 2⁴⁰, so that no two have the same.
constexpr int kSensorBits = 40;

const std::vector<uint8_t>& sensors_in(const BeamLog& beams) {
  return std::get<std::vector<uint8_t>>(beams.extra.at(perception::kSensorColumn));
}

}  // namespace

RigAnswer::RigAnswer(const std::vector<sensor::Sensor>& sensors, const Make& make)
    : fired_(sensors.size(), 0) {
  for (const sensor::Sensor& s : sensors) {
    LogInfo limits;
    limits.sensor = s.name;
    limits.min_range_m = s.min_range_m;
    limits.max_range_m = s.max_range_m;
    limits_.push_back(limits);
    answers_.push_back(make(s));
  }
}

size_t RigAnswer::rays_traced() const {
  size_t sum = 0;
  for (const auto& a : answers_) sum += a->rays_traced();
  return sum;
}

void RigAnswer::operator()(size_t first_beam, BeamLog& beams) {
  if (first_beam == 0) fired_.assign(fired_.size(), 0);
  std::vector<BeamLog> part(answers_.size());
  const std::vector<uint8_t> sensor = sensors_in(beams);
  for (size_t i = 0; i < beams.size(); ++i) part[sensor[i]].append(beams, i);
  for (size_t k = 0; k < part.size(); ++k) {
    if (part[k].empty()) continue;
    part[k].info.sensor = limits_[k].sensor;
    part[k].info.min_range_m = limits_[k].min_range_m;
    part[k].info.max_range_m = limits_[k].max_range_m;
    const size_t fired = part[k].size();
    (*answers_[k])((k << kSensorBits) + fired_[k], part[k]);
    fired_[k] += fired;
  }
  // Beams come back in their order, each with all its echoes.
  BeamLog out;
  out.info = beams.info;
  std::vector<std::vector<bool>> begins;
  begins.reserve(part.size());
  for (const BeamLog& p : part) begins.push_back(begins_beam(p));
  std::vector<size_t> at(part.size(), 0);
  for (const uint8_t k : sensor) {
    const size_t begin = at[k];
    do {
      ++at[k];
    } while (at[k] < part[k].size() && !begins[k][at[k]]);
    out.append(part[k], begin, at[k]);
  }
  beams = std::move(out);
}

}  // namespace underbrush::app
