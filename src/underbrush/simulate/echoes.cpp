#include "underbrush/simulate/echoes.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/radiometry/clones.hpp"
#include "underbrush/simulate/draw.hpp"

namespace underbrush::simulate {
namespace {

using trace::Met;

constexpr size_t kRaysACall = 8192;  // as many as the tracer brings into order at once

/// The first sub-ray is the beam's own; the others decide for themselves.
uint64_t sub_key(uint64_t key, size_t sub_ray) {
  return sub_ray == 0 ? key : mix64(key + 0x9e3779b97f4a7c15ull * sub_ray);
}

uint16_t class_of(const elements::Model& model, const Met& met, const EchoOptions& options) {
  const uint32_t element = met.element;
  if (!options.instance_labels.empty()) return uint16_t(options.instance_labels.at(met.instance));
  if (model.kind(element) != elements::Kind::kEllipsoid) return 0;
  return uint16_t(model.ellipsoids[element - model.ground.size() - model.surface.size()].label);
}

/// The rays of lines in the axes of a beam.
UNDERBRUSH_CLONES void fan(const SubRayLine* lines, size_t n, const sensor::BeamAxes& axes,
                           Ray* rays) {
  static_assert(sizeof(Ray) == 6 * sizeof(double));
  const double* o = axes.axis.origin.data();
  const double* d = axes.axis.direction.data();
  const double* r = axes.right.data();
  const double* u = axes.up.data();
  double start[6], right[6], up[6];
  for (size_t c = 0; c < 3; ++c) {
    start[c] = o[c];
    start[3 + c] = d[c];
    right[c] = right[3 + c] = r[c];
    up[c] = up[3 + c] = u[c];
  }
  auto* out = reinterpret_cast<double*>(rays);
  for (size_t k = 0; k < n; ++k, out += 6) {
    const SubRayLine& l = lines[k];
    for (size_t c = 0; c < 3; ++c) out[c] = start[c] + (l.right * right[c] + l.up * up[c]);
    for (size_t c = 3; c < 6; ++c) {
      out[c] = l.along * start[c] + (l.to_right * right[c] + l.to_up * up[c]);
    }
  }
}

/// Rows `row` of a column.
template <class T>
std::vector<T> gathered(const std::vector<T>& column, const std::vector<uint32_t>& row) {
  std::vector<T> out(row.size());
  parallel_for(row.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out[i] = column[row[i]];
  });
  return out;
}

/// The log with beam `beam[i]` in row i.
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

/// What becomes of some beams.
struct EchoMaker::Block {
  struct Element {
    uint32_t number = Met::kNone;
    uint16_t label = 0;
    uint32_t instance = 0;
  };
  std::vector<uint8_t> count;  ///< Echoes of each beam.
  std::vector<radiometry::Echo> echo;
  std::vector<Element> element;  ///< Of each echo, if wanted.
  std::vector<BeamWaveform> waveforms;
};

/// What a thread works in.
struct EchoMaker::Scratch {
  Scratch(const EchoMaker& m, size_t beams)
      : rays(beams * m.lines_.size()),
        keys(rays.size()),
        met(rays.size()),
        range(m.lines_.size()),
        weight(range.size()),
        factor(range.size()),
        signal(range.size()),
        which(range.size()),
        waveform(m.receiver_.scratch()),
        asker(m.reflection_, m.surroundings_) {}
  std::vector<Ray> rays;
  std::vector<uint64_t> keys;
  std::vector<Met> met;
  std::vector<float> range, weight, factor, signal;
  std::vector<uint32_t> which;  ///< Sub-ray of each return.
  radiometry::Waveform waveform;
  Reflection::Asker asker;
};

/// Scratches that are used again; as many as threads ask at once.
class EchoMaker::Scratches {
 public:
  std::unique_ptr<Scratch> take(const EchoMaker& m, size_t beams) {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<Scratch>(m, beams);
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

EchoMaker::EchoMaker(const Surroundings& surroundings, const Reflection& reflection,
                     const Instrument& instrument, const EchoOptions& options)
    : surroundings_(surroundings),
      reflection_(reflection),
      instrument_(instrument),
      options_(options),
      receiver_(instrument.receiver),
      scratches_(std::make_unique<Scratches>()) {
  instrument.beam.check();
  require(!instrument.sub_rays.empty(), "echoes: at least one sub-ray is needed");
  require(options.waveforms.every > 0, "echoes: waveforms of every zeroth beam");
  const sensor::RayMaker maker(instrument.beam);
  const sensor::BeamAxes axes{{Vec3::Zero(), Vec3::UnitX()}, Vec3::UnitY(), Vec3::UnitZ(), {}};
  for (const sensor::SubRay& place : instrument.sub_rays) {
    const Ray ray = maker.ray(axes, double(place.u), double(place.v));
    lines_.push_back(
        {ray.origin.y(), ray.origin.z(), ray.direction.x(), ray.direction.y(), ray.direction.z()});
    weight_.push_back(place.weight);
  }
}

EchoMaker::~EchoMaker() = default;

void EchoMaker::trace(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                      Scratch& s) const {
  Ray* ray = s.rays.data();
  uint64_t* sub = s.keys.data();
  for (size_t i = begin; i < end; ++i) {
    Ray axis{beams.origin[i], beams.direction[i].cast<double>().normalized()};
    const uint64_t key = beam_key(options_.seed, beams.scan[i], first_beam + i);
    if (instrument_.beam.encoder_step_rad > 0) {
      const double off = uniform_from_bits(random_bits(key, 2, Purpose::kDirection)) - 0.5;
      axis.direction = Eigen::AngleAxisd(off * instrument_.beam.encoder_step_rad, Vec3::UnitZ()) *
                       axis.direction;
    }
    const sensor::BeamAxes axes = sensor::beam_axes(axis);
    fan(lines_.data(), lines_.size(), axes, ray);
    ray += lines_.size();
    for (size_t k = 0; k < lines_.size(); ++k) *sub++ = sub_key(key, k);
  }
  const size_t n = (end - begin) * lines_.size();
  surroundings_.nearest_accepted(
      {s.rays.data(), n}, {s.keys.data(), n}, {&beams.time_s[begin], end - begin},
      {beams.info.min_range_m, beams.info.max_range_m}, {s.met.data(), n});
}

void EchoMaker::receive(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                        Scratch& s, Block& block) const {
  const trace::RangeLimits limits{beams.info.min_range_m, beams.info.max_range_m};
  const QuickNormal normal;
  for (size_t i = begin, at = 0; i < end; ++i, at += lines_.size()) {
    size_t n = 0;
    s.asker.begin(beams.direction[i].cast<double>(), beams.time_s[i]);
    for (size_t k = 0; k < lines_.size(); ++k) {
      const Met& met = s.met[at + k];
      if (met.none()) continue;
      s.range[n] = float(drawn_on_ray(met, s.keys[at + k], limits, normal));
      s.weight[n] = weight_[k];
      s.factor[n] = s.asker.factor(met, s.rays[at + k].direction);
      s.which[n++] = uint32_t(at + k);
    }
    const radiometry::Echoes echoes = receiver_.receive(
        {s.range.data(), n}, {s.weight.data(), n}, {s.factor.data(), n}, {s.signal.data(), n},
        beam_key(options_.seed, beams.scan[i], first_beam + i), s.waveform);
    block.count.push_back(uint8_t(echoes.count));
    block.echo.insert(block.echo.end(), echoes.begin(), echoes.end());
    if (options_.element_ids) {
      for (const radiometry::Echo& e : echoes) {
        Block::Element element;
        for (size_t k = 0, best = n; k < n; ++k) {
          if (best < n && std::abs(s.range[k] - e.range_m) >= std::abs(s.range[best] - e.range_m))
            continue;
          best = k;
          const Met& met = s.met[s.which[k]];
          element = {met.element, class_of(surroundings_.model(met.instance), met, options_),
                     met.instance};
        }
        block.element.push_back(element);
      }
    }
    if (options_.waveforms.wants(first_beam + i)) {
      BeamWaveform w{first_beam + i,  beams.scan[i],        beams.ring[i],
                     beams.time_s[i], table_of(s.waveform), {}};
      for (const radiometry::Echo& e : echoes) w.echo_m.push_back(double(e.range_m));
      block.waveforms.push_back(std::move(w));
    }
  }
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
  std::vector<uint32_t> element(options_.element_ids ? rows : 0, Met::kNone);
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

void EchoMaker::answer(size_t first_beam, BeamLog& beams) {
  const size_t grain = std::max<size_t>(1, kRaysACall / lines_.size());
  std::vector<Block> blocks((beams.size() + grain - 1) / grain);
  parallel_for(beams.size(), grain, [&](size_t begin, size_t end) {
    std::unique_ptr<Scratch> s = scratches_->take(*this, grain);
    trace(beams, first_beam, begin, end, *s);
    receive(beams, first_beam, begin, end, *s, blocks[begin / grain]);
    scratches_->give_back(std::move(s));
  });
  for (Block& b : blocks) {
    waveforms_.insert(waveforms_.end(), std::make_move_iterator(b.waveforms.begin()),
                      std::make_move_iterator(b.waveforms.end()));
  }
  write(blocks, beams);
}

}  // namespace underbrush::simulate
