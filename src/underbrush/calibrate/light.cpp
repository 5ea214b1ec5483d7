#include "underbrush/calibrate/light.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/calibrate/light_response.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/credit/explaining.hpp"
#include "underbrush/elements/element_light.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::calibrate {
namespace {

constexpr size_t kLeastSamples = size_t(1) << 17, kMostSamples = size_t(1) << 22;
constexpr size_t kMostForResponse = size_t(1) << 16;

bool has_intensity(const BeamLog& log, size_t i) {
  return log.is_hit(i) && std::isfinite(log.intensity[i]) && log.intensity[i] >= 0;
}

void forget_light(elements::Model& model) {
  model.light = {};
  model.ground.light.clear();
  model.surface.light.clear();
  for (elements::Ellipsoid& e : model.ellipsoids) e.light = {};
}

/// The returns of a chunk with intensity of which an element is known.
std::vector<LightSample> samples_of(const trace::World& world, const BeamLog& chunk) {
  const elements::Model& model = world.model();
  const std::vector<uint32_t> element = credit::explaining_elements(world, chunk);
  std::vector<LightSample> out;
  for (size_t i = 0; i < chunk.size(); ++i) {
    if (element[i] == trace::Intersection::kNone || !has_intensity(chunk, i)) continue;
    const Vec3 direction = chunk.ray(i).direction;
    out.push_back({element[i], chunk.intensity[i], chunk.range_m[i],
                   float(elements::incidence_cosine(model, element[i], direction)), chunk.ring[i],
                   model.kind(element[i]) == elements::Kind::kEllipsoid});
  }
  return out;
}

/// One run of beams in so many of a log, chosen by its number. The beams of a run point alike, so
/// that what they meet is found together.
class Thinned {
 public:
  Thinned(size_t beams, size_t wanted) : one_in_(1 + beams / wanted) {}
  BeamLog operator()(const BeamLog& chunk) {
    if (one_in_ == 1) return chunk;
    constexpr size_t kRun = 64;
    BeamLog out = chunk.like();
    for (size_t begin = 0, end = 0; begin < chunk.size(); begin = end) {
      end = std::min(chunk.size(), begin + kRun - row_ % kRun);
      if (mix64(row_ / kRun + 1) % one_in_ == 0) out.append(chunk, begin, end);
      row_ += end - begin;
    }
    return out;
  }

 private:
  size_t one_in_, row_ = 0;
};

/// Every n-th sample, so that enough of them are left for the response.
std::vector<LightSample> for_response(const std::vector<LightSample>& samples) {
  const size_t step = 1 + samples.size() / kMostForResponse;
  std::vector<LightSample> out;
  for (size_t k = 0; k < samples.size(); k += step) out.push_back(samples[k]);
  return out;
}

/// Numbers the kinds of elements and their classes.
std::vector<uint32_t> groups_of(const elements::Model& model, size_t& groups) {
  std::map<std::pair<elements::Kind, uint32_t>, uint32_t> number;
  std::vector<uint32_t> out(model.size());
  for (size_t e = 0; e < out.size(); ++e) {
    const elements::ElementPlace at = model.place(e);
    const bool is_ellipsoid = at.kind == elements::Kind::kEllipsoid;
    const uint32_t label = is_ellipsoid ? model.ellipsoids[at.index].label : 0;
    out[e] = number.try_emplace({at.kind, label}, uint32_t(number.size())).first->second;
  }
  groups = number.size();
  return out;
}

/// Whether no reflectance is beyond what a float can hold, as intensities of 10³⁸ make them.
bool are_finite(const std::vector<elements::Reflectance>& of) {
  return std::all_of(of.begin(), of.end(), [](const elements::Reflectance& r) {
    return std::isfinite(r.mean) && std::isfinite(r.spread);
  });
}

/// Sets the reflectances of the wanted elements, or of all.
void set_light(elements::Model& model, const std::vector<elements::Reflectance>& of,
               const std::vector<bool>* wanted = nullptr) {
  model.ground.light.resize(model.ground.size());
  model.surface.light.resize(model.surface.size());
  for (size_t e = 0; e < of.size(); ++e) {
    if (wanted && !(*wanted)[e]) continue;
    const elements::ElementPlace at = model.place(e);
    if (at.kind == elements::Kind::kGround) model.ground.light[at.index] = of[e];
    if (at.kind == elements::Kind::kSurface) model.surface.light[at.index] = of[e];
    if (at.kind == elements::Kind::kEllipsoid) model.ellipsoids[at.index].light = of[e];
  }
}

}  // namespace

void learn_light(elements::Model& model, BeamSource& log, size_t samples_an_element) {
  forget_light(model);
  const trace::World world(model);
  std::vector<LightSample> samples;
  Thinned thinned(log.size(),
                  std::clamp(samples_an_element * model.size(), kLeastSamples, kMostSamples));
  double most = 0;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (has_intensity(chunk, i)) most = std::max(most, double(chunk.intensity[i]));
    }
    const BeamLog chosen = thinned(chunk);
    if (most == 0) continue;
    const std::vector<LightSample> more = samples_of(world, chosen);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  const std::vector<LightSample> chosen = for_response(samples);
  // The brightest return may be none of them.
  if (std::none_of(chosen.begin(), chosen.end(), [](auto& s) { return s.intensity > 0; })) return;
  size_t groups = 0;
  const std::vector<uint32_t> group = groups_of(model, groups);
  elements::Light light = fit_response(chosen, group, groups);
  light.max_intensity = most;
  std::vector<LightSums> sums(model.size());
  for (const LightSample& s : samples) {
    sums[s.element].add(s.intensity,
                        light.response(s.range_m, s.cosine, s.is_ellipsoid, s.ring, true));
  }
  const std::vector<elements::Reflectance> learnt = reflectances(sums, group, groups);
  if (!are_finite(learnt)) return;
  model.light = std::move(light);
  set_light(model, learnt);
}

void learn_reflectances(elements::Model& model, BeamSource& log, const std::vector<bool>& wanted) {
  const auto count = size_t(std::count(wanted.begin(), wanted.end(), true));
  if (!model.light.known() || count == 0) return;
  const trace::World world(model);
  std::vector<LightSums> sums(model.size());
  Thinned thinned(log.size(),
                  std::clamp(kSamplesOfLight * model.size(), kLeastSamples, kMostSamples));
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (const LightSample& s : samples_of(world, thinned(chunk))) {
      if (!wanted[s.element]) continue;
      sums[s.element].add(s.intensity,
                          model.light.response(s.range_m, s.cosine, s.is_ellipsoid, s.ring, true));
    }
  }
  size_t groups = 0;
  const std::vector<uint32_t> group = groups_of(model, groups);
  const std::vector<elements::Reflectance> learnt = reflectances(sums, group, groups);
  if (are_finite(learnt)) set_light(model, learnt, &wanted);
}

}  // namespace underbrush::calibrate
