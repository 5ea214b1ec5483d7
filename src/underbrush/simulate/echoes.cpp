#include "underbrush/simulate/echoes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/element_class.hpp"

namespace underbrush::simulate {
namespace {

using trace::Intersection;

constexpr size_t kRaysACall = 8192;  // as many as the tracer orders at a time
/// Returns no farther apart than so many pulses are one echo.
constexpr double kSamePulse = 1;

/// The length of a pulse along the beam, m.
double pulse_m(const Instrument& instrument) {
  return instrument.receiver.response.pulse_fwhm_s * radiometry::kSpeedOfLight / 2;
}

/// The least shares of the energy of an instrument's beam that must return, by range (whole m).
std::vector<double> least_shares(const Instrument& instrument) {
  constexpr double kShare = 0.5;  // of the area of the fitted beam
  if (!instrument.fitted_beam) return {0};
  std::vector<double> share;
  for (int range_m = 0; range_m <= int(instrument.receiver.max_range_m); ++range_m) {
    const auto own = instrument.beam.sigma_m(range_m),
               fitted = instrument.fitted_beam->sigma_m(range_m);
    share.push_back(kShare);
    for (size_t k = 0; k < 2; ++k) {
      if (own[k] > fitted[k]) share.back() *= fitted[k] / own[k];
    }
  }
  return share;
}

/// The echoes of what a keyframe answers: one of the length of a pulse, or none.
radiometry::Echoes echoes_of_cached(const keyframes::CachedReturn& cached, bool mean,
                                    double pulse_m, const trace::RangeLimits& limits) {
  radiometry::Echoes out;
  if (!(cached.range_m >= limits.min_m && cached.range_m <= limits.max_m)) return out;
  radiometry::Echo echo;
  echo.range_m = float(cached.range_m);
  echo.width_m = float(pulse_m);
  echo.intensity = mean ? cached.mean_intensity : cached.intensity;
  out.push(echo);
  return out;
}

/// Gathers the rows `row` of a column.
template <class T>
std::vector<T> gathered(const std::vector<T>& column, const std::vector<uint32_t>& row) {
  std::vector<T> out(row.size());
  parallel_for(row.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out[i] = column[row[i]];
  });
  return out;
}

/// Rewrites the log so that row i has beam `beam[i]`.
void repeat_beams(const std::vector<uint32_t>& beam, BeamLog& log) {
  log.origin = gathered(log.origin, beam);
  log.direction = gathered(log.direction, beam);
  log.time_s = gathered(log.time_s, beam);
  log.ring = gathered(log.ring, beam);
  log.scan = gathered(log.scan, beam);
  log.packet = gathered(log.packet, beam);
  for (auto& [name, column] : log.extra) {
    std::visit([&](auto& c) { c = gathered(c, beam); }, column);
  }
  log.range_m.resize(beam.size());
  log.intensity.resize(beam.size());
  log.flags.resize(beam.size());
}

}  // namespace

/// The beams to answer, and what all of them have in common.
struct EchoMaker::Request {
  const BeamLog& beams;
  size_t first_beam;
  std::span<const std::optional<keyframes::CachedReturn>> cached;
  trace::RangeLimits limits;

  uint64_t key(uint64_t seed, size_t i) const {
    return beam_key(seed, beams.scan[i], first_beam + i);
  }
};

/// The element that an echo came from.
struct EchoMaker::Element {
  uint32_t number = Intersection::kNone;
  uint16_t label = 0;
  uint32_t instance = 0;
};

/// The results of a block of beams.
struct EchoMaker::Block {
  std::vector<uint8_t> count;  ///< Number of echoes of each beam.
  std::vector<radiometry::Echo> echo;
  std::vector<Element> element;  ///< The element of each echo, if requested.
  std::vector<BeamWaveform> waveforms;
};

/// The working memory of a thread.
struct EchoMaker::Scratch {
  explicit Scratch(const EchoMaker& m)
      : traced(m.world_),
        returns(m.tracer_.most()),
        waveform(m.receiver_.scratch()),
        evaluator(m.reflection_, m.world_),
        matter(m.world_),
        pulse_m(kSamePulse * simulate::pulse_m(m.instrument_)),
        seed(m.options_.seed) {}

  /// The mean intensity of the sub-rays that lie in the echo at a range (m).
  float light_of(const SubReturns& of, const TracedBeams::Beam& beam, float range_m,
                 const Request& r, size_t i) {
    double sum = 0, weights = 0;
    for (size_t k = 0; k < of.size(); ++k) {
      if (std::abs(double(of.range_m()[k] - range_m)) > pulse_m) continue;
      const Intersection& met = beam.met[of.sub_ray()[k]];
      const Ray& ray = beam.rays[of.sub_ray()[k]];
      const double range = double(of.range_m()[k]), weight = double(of.weight()[k]);
      const uint64_t key = r.key(seed, i);
      const float intensity = met.element == trace::kUnknown
                                  ? light->of_unknown(ray, range, r.beams, i, key)
                                  : light->intensity(matter.model(met, r.beams.time_s[i]), ray, met,
                                                     range, r.beams, i, key);
      sum += weight * double(intensity);
      weights += weight;
    }
    return weights > 0 ? float(sum / weights) : 0;
  }

  TracedBeams traced;
  SubReturns returns;
  radiometry::Waveform waveform;
  Reflection::Evaluator evaluator;
  MatterAt matter;
  std::optional<LearntLight> light;
  double pulse_m;
  uint64_t seed;
};

/// A pool of working memories, as many as threads that ask at the same time.
class EchoMaker::Scratches {
 public:
  std::unique_ptr<Scratch> take(const EchoMaker& m) {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<Scratch>(m);
    std::unique_ptr<Scratch> s = std::move(free_.back());
    free_.pop_back();
    return s;
  }
  void give_back(std::unique_ptr<Scratch> s) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(s));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> free_;
};

void add_offsets(const ChannelOffsets& offsets, std::vector<BeamWaveform>& waveforms) {
  for (BeamWaveform& w : waveforms) {
    for (const ChannelOffset& o : offsets) {
      if (o.ring != w.ring) continue;
      for (auto& [range_m, signal] : w.signal) range_m += o.range_m;
      for (double& range_m : w.echo_m) range_m = std::max(range_m + o.range_m, kLeastRangeM);
    }
  }
}

EchoMaker::EchoMaker(const DynamicWorld& world, const Reflection& reflection,
                     const Instrument& instrument, const EchoOptions& options)
    : world_(world),
      reflection_(reflection),
      instrument_(instrument),
      options_(options),
      tracer_(world, instrument.beam, instrument.sub_rays, options.seed,
              options.all_sub_rays ? 0 : kSamePulse * pulse_m(instrument), options.sway_s),
      receiver_(instrument.receiver),
      scratches_(std::make_unique<Scratches>()),
      least_share_(least_shares(instrument)) {
  require(options.waveforms.every > 0, "echoes: waveforms of every zeroth beam");
}

EchoMaker::~EchoMaker() = default;

/// Whether enough of the beam with this key returns. Of beams that are on the border, half do.
bool EchoMaker::returns_enough(const SubReturns& returns, uint64_t key) const {
  double share = 0;
  float nearest_m = std::numeric_limits<float>::infinity();
  for (size_t k = 0; k < returns.size(); ++k) {
    share += double(returns.weight()[k]);
    nearest_m = std::min(nearest_m, returns.range_m()[k]);
  }
  if (returns.size() == 0) return true;
  const double more = share - least_share_[std::min(size_t(nearest_m), least_share_.size() - 1)];
  if (std::abs(more) > 1e-6) return more > 0;
  return uniform_from_bits(random_bits(key, 3, Purpose::kDirection)) < 0.5;
}

radiometry::Echoes EchoMaker::echoes_of(const Request& r, size_t i, const TracedBeams::Beam& beam,
                                        Scratch& s, radiometry::Receiver::Way way) const {
  const bool mean = options_.learnt_light != IntensityDraw::kDrawn;
  if (!r.cached.empty() && r.cached[i])
    return echoes_of_cached(*r.cached[i], mean, s.pulse_m, r.limits);
  const BeamLog& beams = r.beams;
  SubReturns& returns = s.returns;
  returns.collect(beam.range_m, beam.weight, beam.traced);
  s.evaluator.begin(beams.direction[i].cast<double>(), beams.time_s[i]);
  s.evaluator.factors(beam.met, beam.rays, returns.sub_ray(), returns.factor());
  radiometry::Echoes echoes =
      receiver_.receive(returns.range_m(), returns.weight(), returns.factor(), returns.signal(),
                        r.key(options_.seed, i), s.waveform, way);
  if (!returns_enough(returns, r.key(options_.seed, i))) echoes.count = 0;
  if (!options_.learnt_light) return echoes;
  for (int k = 0; k < echoes.count; ++k) {
    echoes.echo[size_t(k)].intensity =
        s.light_of(returns, beam, echoes.echo[size_t(k)].range_m, r, i);
  }
  return echoes;
}

void EchoMaker::receive(const Request& request, size_t begin, size_t end, Scratch& s,
                        Block& block) const {
  const BeamLog& beams = request.beams;
  if (options_.learnt_light) s.light.emplace(world_, beams.info, *options_.learnt_light);
  for (size_t i = begin; i < end; ++i) {
    const TracedBeams::Beam beam = s.traced[i - begin];
    using Way = radiometry::Receiver::Way;
    const size_t number = request.first_beam + i;
    const bool is_cached = !request.cached.empty() && request.cached[i];
    const bool is_kept = options_.waveforms.wants(number) && !is_cached;
    const radiometry::Echoes echoes =
        echoes_of(request, i, beam, s, is_kept ? Way::kByWaveform : Way::kFast);
    block.count.push_back(uint8_t(echoes.count));
    block.echo.insert(block.echo.end(), echoes.begin(), echoes.end());
    if (options_.element_ids) {
      for (const radiometry::Echo& e : echoes) {
        block.element.push_back(element_at(e.range_m, s.returns, beam.met));
      }
    }
    if (is_kept) {
      BeamWaveform w{number,          beams.scan[i],        beams.ring[i],
                     beams.time_s[i], table_of(s.waveform), {}};
      for (const radiometry::Echo& e : echoes) w.echo_m.push_back(double(e.range_m));
      block.waveforms.push_back(std::move(w));
    }
  }
}

EchoMaker::Element EchoMaker::element_at(float range_m, const SubReturns& returns,
                                         std::span<const Intersection> met) const {
  const std::span<const float> range = returns.range_m();
  const auto off = [&](float r) { return std::abs(r - range_m); };
  const auto best = std::min_element(range.begin(), range.end(),
                                     [&](float a, float b) { return off(a) < off(b); });
  if (best == range.end()) return {};
  const Intersection& m = met[returns.sub_ray()[size_t(best - range.begin())]];
  if (m.element == trace::kUnknown) return {};
  return {m.element, element_class(world_.model(m.instance), m, options_.instance_labels),
          world_.world().number(m.instance)};
}

void EchoMaker::write(const std::vector<Block>& blocks, BeamLog& beams) const {
  std::vector<size_t> first_row(blocks.size() + 1, 0), first_beam(blocks.size() + 1, 0);
  for (size_t b = 0; b < blocks.size(); ++b) {
    size_t rows = 0;
    for (const uint8_t n : blocks[b].count) rows += std::max<size_t>(1, n);
    first_row[b + 1] = first_row[b] + rows;
    first_beam[b + 1] = first_beam[b] + blocks[b].count.size();
  }
  const size_t rows = first_row.back();
  std::vector<uint32_t> beam(rows == beams.size() ? 0 : rows);
  std::vector<float> width(rows);
  std::vector<uint8_t> echo(rows), echoes(rows);
  std::vector<uint32_t> element(options_.element_ids ? rows : 0, Intersection::kNone);
  std::vector<uint16_t> label(element.size());
  std::vector<uint32_t> instance(options_.instance_labels.empty() ? 0 : element.size());
  std::vector<float> range(rows, kMiss), intensity(rows, 0);
  parallel_for(blocks.size(), 1, [&](size_t b, size_t) {
    const Block& block = blocks[b];
    size_t row = first_row[b], e = 0;
    for (size_t i = 0; i < block.count.size(); ++i) {
      const uint8_t n = block.count[i];
      for (uint8_t k = 0; k < std::max<uint8_t>(1, n); ++k, ++row) {
        if (!beam.empty()) beam[row] = uint32_t(first_beam[b] + i);
        if (n == 0) continue;
        const radiometry::Echo& found = block.echo[e];
        range[row] = found.range_m;
        intensity[row] = found.intensity;
        width[row] = found.width_m;
        echo[row] = uint8_t(k + 1);
        echoes[row] = n;
        if (options_.element_ids) {
          element[row] = block.element[e].number;
          label[row] = block.element[e].label;
          if (!instance.empty()) instance[row] = block.element[e].instance;
        }
        ++e;
      }
    }
  });
  if (!beam.empty()) repeat_beams(beam, beams);
  beams.range_m = std::move(range);
  beams.intensity = std::move(intensity);
  std::fill(beams.flags.begin(), beams.flags.end(), uint8_t(0));
  beams.extra[kEchoColumn] = std::move(echo);
  beams.extra[kEchoesColumn] = std::move(echoes);
  beams.extra[kPulseWidthColumn] = std::move(width);
  if (!options_.element_ids) return;
  beams.extra["element"] = std::move(element);
  beams.extra["element_class"] = std::move(label);
  if (!instance.empty()) beams.extra["instance"] = std::move(instance);
}

void EchoMaker::answer(size_t first_beam, BeamLog& beams,
                       std::span<const std::optional<keyframes::CachedReturn>> cached) {
  require(cached.empty() || cached.size() == beams.size(), "echoes: one cached return a beam");
  const Request request{
      beams, first_beam, cached, {beams.info.min_range_m, beams.info.max_range_m}};
  const size_t grain = std::max<size_t>(1, kRaysACall / tracer_.first());
  std::vector<Block> blocks((beams.size() + grain - 1) / grain);
  parallel_for(beams.size(), grain, [&](size_t begin, size_t end) {
    std::unique_ptr<Scratch> s = scratches_->take(*this);
    tracer_.trace(beams, first_beam, begin, end, s->traced);
    rays_ += s->traced.rays();
    receive(request, begin, end, *s, blocks[begin / grain]);
    scratches_->give_back(std::move(s));
  });
  for (Block& b : blocks) {
    waveforms_.insert(waveforms_.end(), std::make_move_iterator(b.waveforms.begin()),
                      std::make_move_iterator(b.waveforms.end()));
  }
  write(blocks, beams);
}

}  // namespace underbrush::simulate
