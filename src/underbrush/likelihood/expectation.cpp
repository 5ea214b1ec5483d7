#include "underbrush/likelihood/expectation.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/likelihood/meetings.hpp"

namespace underbrush::likelihood {
namespace {

constexpr size_t kTask = 2048, kRun = 64;  // beams of one block, and those shared out at a time

/// Shares out the beams of a block, one after the other.
class Sharing {
 public:
  Sharing(const ModelForm& model, const BeamBlock& block, double max_range_m)
      : model_(model), block_(block), max_range_m_(max_range_m) {}

  /// Adds up the likelihoods of some beams and, unless `soft` is null, shares them out and adds
  /// what they say to `sums`, unless that is null.
  void share(size_t begin, size_t end, const trace::OutlierShares* soft, BlockShares* shares,
             ElementSums* sums) {
    const size_t from = block_.first[begin];
    columns_.resize(block_.first[end] - from);
    const MeetingColumns c = columns_.meetings();
    const EllipsoidColumns ellipsoids = columns_.ellipsoids();
    const size_t count = pass_kernels().approach(
        model_, block_.beams.data(), block_.first.data(), begin, end, block_.met.data(),
        block_.on_triangle.data() + block_.first_triangle[begin], c, ellipsoids);
    for (size_t b = begin; b < end; ++b) {
      const size_t at = block_.first[b] - from, met = block_.first[b + 1] - block_.first[b];
      const MeetingColumns mine{c.t_m + at, c.sigma_m + at, c.p + at, c.density + at};
      sort(mine, &block_.met[block_.first[b]], met);
      hit_.resize(std::max(hit_.size(), met));
      const bool is_hit = block_.beams[b].range_m != kMiss;
      const Outcome outcome = outcome_of(mine, is_hit);
      totals_.loss.add(-std::log(likelihood(outcome, is_hit, trace::kReportedOutliers)));
      if (soft) share_out(b, mine, outcome, *soft, *shares, sums);
    }
    if (!sums) return;
    sums->add(ellipsoids, count, block_.met.data() + from,
              {shares->hit.data() + from, shares->pass.data() + from});
  }
  const PassTotals& totals() const { return totals_; }

 private:
  /// The density (1/m) or probability of a beam's outcome under the elements, and the probability
  /// that the beam meets none of them.
  struct Outcome {
    double found, through;
  };

  /// Puts the meetings of a beam into the order of range. A search lists near ones first, roughly.
  void sort(const MeetingColumns& c, const uint32_t* met, size_t count) {
    order_.clear();
    for (uint32_t k = 0; k < count; ++k) {
      if (c.p[k] < 0) continue;
      size_t at = order_.size();
      order_.push_back(k);
      for (; at > 0; --at) {
        const uint32_t j = order_[at - 1];
        if (c.t_m[j] < c.t_m[k] || (c.t_m[j] == c.t_m[k] && met[j] < met[k])) break;
        order_[at] = j;
      }
      order_[at] = k;
    }
  }

  Outcome outcome_of(const MeetingColumns& c, bool is_hit) {
    double through = 1, density = 0;
    for (const uint32_t k : order_) {
      const double found = through * double(c.p[k]) * double(c.density[k]);
      hit_[k] = float(found);
      density += found;
      through *= 1 - double(c.p[k]);
    }
    return {is_hit ? density : through, through};
  }

  double likelihood(const Outcome& outcome, bool is_hit, const trace::OutlierShares& o) const {
    return o.explained() * outcome.found + o.likelihood(is_hit, max_range_m_);
  }

  void share_out(size_t b, const MeetingColumns& c, const Outcome& outcome,
                 const trace::OutlierShares& soft, BlockShares& shares, ElementSums* sums) {
    const size_t first = block_.first[b], count = block_.first[b + 1] - first;
    const double range = block_.beams[b].range_m;
    const bool is_hit = block_.beams[b].range_m != kMiss;
    float* const hit = &shares.hit[first];
    float* const pass = &shares.pass[first];
    std::fill_n(hit, count, 0.0f);
    std::fill_n(pass, count, 0.0f);
    const double total = likelihood(outcome, is_hit, soft), scale = soft.explained() / total;
    if (is_hit) totals_.stray_hits.add(soft.likelihood(true, max_range_m_) / total);
    double later = is_hit ? 0 : outcome.through * scale;
    for (size_t i = order_.size(); i-- > 0;) {
      const uint32_t k = order_[i];
      const double share = is_hit ? double(hit_[k]) * scale : 0;
      hit[k] = float(share);
      pass[k] = float(later);
      later += share;
      const uint32_t element = block_.met[first + k];
      if (element >= model_.triangles) continue;
      TriangleSums terms{double(hit[k]), double(pass[k])};
      if (share > 0) add_noise(element, range - double(c.t_m[k]), double(c.sigma_m[k]), terms);
      if (sums) sums->add_triangle(element, terms);
    }
  }

  /// Adds the terms of a return by the range noise of its mesh, and by the roughness of its
  /// triangle.
  void add_noise(uint32_t element, double residual, double sigma, TriangleSums& of_triangle) {
    const size_t mesh = element >= model_.ground_triangles;
    const double variance = sigma * sigma, misfit = residual * residual / variance - 1;
    const double own = double(model_.range_variance[mesh]) / variance, rough = 1 - own;
    const double hit = of_triangle.hits;
    totals_.noise[mesh][0].add(hit * misfit * own);
    totals_.noise[mesh][1].add(hit * 2 * own * own);
    of_triangle.roughness_slope = hit * misfit * rough;
    of_triangle.roughness_curvature = hit * 2 * rough * rough;
  }

  const ModelForm& model_;
  const BeamBlock& block_;
  double max_range_m_;
  PassTotals totals_;
  RunColumns columns_;
  std::vector<uint32_t> order_;
  std::vector<float> hit_;  // w_k N(z; t_k, σ_k²) of the meetings of a beam
};

PassTotals totals_of(const ModelForm& model, const BeamBlock& block, double max_range_m,
                     const trace::OutlierShares* soft, BlockShares& shares, ElementSums* sums) {
  const size_t n = block.beams.size();
  if (soft) {
    shares.hit.resize(block.met.size());
    shares.pass.resize(block.met.size());
  }
  Sharing sharing(model, block, max_range_m);
  for (size_t b = 0; b < n; b += kRun) {
    sharing.share(b, std::min(b + kRun, n), soft, &shares, sums);
  }
  return sharing.totals();
}

/// Searches some beams and adds up their likelihoods; unless `soft` is null, what they say of the
/// elements is added to `sums`.
PassTotals pass_over(const trace::World& world, const ModelForm& form, const LogInfo& info,
                     std::span<const ListedBeam> beams, const trace::OutlierShares* soft,
                     ElementSums* sums) {
  std::vector<PassTotals> pieces((beams.size() + kTask - 1) / kTask);
  parallel_for(beams.size(), kTask, [&](size_t begin, size_t end) {
    BeamBlock block;
    block.beams = beams.subspan(begin, end - begin);
    find_meetings(world, info, block);
    BlockShares shares;
    pieces[begin / kTask] = totals_of(form, block, info.max_range_m, soft, shares, sums);
  });
  PassTotals all;
  for (const PassTotals& piece : pieces) all.add(piece);
  return all;
}

}  // namespace

void RunColumns::resize(size_t count) {
  room_ = (count + 8 + 7) / 8 * 8;
  numbers_.resize(std::max(numbers_.size(), 14 * room_), 1);
  places_.resize(std::max(places_.size(), 2 * room_));
}

MeetingColumns RunColumns::meetings() {
  float* const at = numbers_.data();
  return {at, at + room_, at + 2 * room_, at + 3 * room_};
}

EllipsoidColumns RunColumns::ellipsoids() {
  const auto column = [&](size_t k) { return numbers_.data() + (4 + k) * room_; };
  return {column(0),
          column(1),
          column(2),
          {column(3), column(4), column(5)},
          {column(6), column(7), column(8)},
          column(9),
          places_.data(),
          places_.data() + room_};
}

void PassTotals::add(const PassTotals& other) {
  loss.add(other.loss);
  stray_hits.add(other.stray_hits);
  for (size_t m = 0; m < noise.size(); ++m) {
    for (size_t k = 0; k < noise[m].size(); ++k) noise[m][k].add(other.noise[m][k]);
  }
}

PassTotals find_shares(const ModelForm& model, const BeamBlock& block,
                       const trace::OutlierShares& soft, double max_range_m, BlockShares& shares,
                       ElementSums* sums) {
  return totals_of(model, block, max_range_m, &soft, shares, sums);
}

PassSums pass_over_training(const trace::World& world, const ListedBeams& beams,
                            credit::BeamShare share, const trace::OutlierShares& soft,
                            const std::function<void(size_t, size_t)>& progress) {
  const elements::Model& model = world.model();
  const LogInfo& info = beams.info();
  const ModelForms forms(model, info.min_range_m);
  const ModelForm form = forms.view();
  PassSums out{ElementSums(model), {}, 0};
  beams.for_each(share, [&](std::span<const ListedBeam> block) {
    out.totals.add(pass_over(world, form, info, block, &soft, &out.elements));
    out.beams += block.size();
    if (progress) progress(out.beams, beams.training_beams() / share.weight());
  });
  return out;
}

Expectation expectation_of(PassSums sums, credit::BeamShare share) {
  Expectation out;
  out.sums = std::move(sums.elements);
  out.sums.add_noise(elements::Kind::kGround, sums.totals.noise[0]);
  out.sums.add_noise(elements::Kind::kSurface, sums.totals.noise[1]);
  out.sums.multiply(share.weight());
  const double count = std::max<double>(1, double(sums.beams));
  out.nll = sums.totals.loss.value() / count;
  out.stray_hits = sums.totals.stray_hits.value() / count;
  return out;
}

Expectation expect(const trace::World& world, const ListedBeams& beams, credit::BeamShare share,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress) {
  return expectation_of(pass_over_training(world, beams, share, soft, progress), share);
}

ElementSums held_out_sums(const trace::World& world, const ListedBeams& beams,
                          const trace::OutlierShares& soft) {
  const LogInfo& info = beams.info();
  const ModelForms forms(world.model(), info.min_range_m);
  ElementSums sums(world.model());
  pass_over(world, forms.view(), info, beams.held_out(), &soft, &sums);
  return sums;
}

double validation_nll(const trace::World& world, const ListedBeams& beams) {
  const LogInfo& info = beams.info();
  const ModelForms forms(world.model(), info.min_range_m);
  const std::vector<ListedBeam>& validation = beams.validation();
  const PassTotals totals = pass_over(world, forms.view(), info, validation, nullptr, nullptr);
  return totals.loss.value() / std::max<double>(1, double(validation.size()));
}

}  // namespace underbrush::likelihood
