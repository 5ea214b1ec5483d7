#include "underbrush/fit/expectation.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/fit/meetings.hpp"

namespace underbrush::fit {
namespace {

constexpr size_t kTask = 4096, kRun = 64;  // beams that are shared out by one task, and at a time

/// The columns of the meetings of a run of beams.
class Columns {
 public:
  MeetingColumns of(size_t count) {
    for (std::vector<float>* c : {&t_, &sigma_, &p_, &density_}) c->assign(count + 8, 1);
    return {t_.data(), sigma_.data(), p_.data(), density_.data()};
  }

 private:
  std::vector<float> t_, sigma_, p_, density_;
};

/// Shares out the beams of a block, one after the other.
class Sharing {
 public:
  Sharing(const ModelForm& model, const BeamBlock& block, double max_range_m)
      : model_(model), block_(block), max_range_m_(max_range_m) {}

  /// Adds up the likelihoods of some beams and, unless `soft` is null, shares them out.
  void share(size_t begin, size_t end, const trace::OutlierShares* soft, BlockShares* shares) {
    const size_t from = block_.first[begin];
    const MeetingColumns c = columns_.of(block_.first[end] - from);
    pass_kernels().approach(model_, block_.beams.data(), block_.first.data(), begin, end,
                            block_.met.data(),
                            block_.on_triangle.data() + block_.first_triangle[begin], c);
    for (size_t b = begin; b < end; ++b) {
      const size_t at = block_.first[b] - from, count = block_.first[b + 1] - block_.first[b];
      const MeetingColumns mine{c.t_m + at, c.sigma_m + at, c.p + at, c.density + at};
      sort(mine, &block_.met[block_.first[b]], count);
      hit_.resize(std::max(hit_.size(), count));
      const bool is_hit = block_.beams[b].range_m != kMiss;
      const Outcome outcome = outcome_of(mine, is_hit);
      totals_.loss.add(-std::log(likelihood(outcome, is_hit, trace::kReportedOutliers)));
      if (is_hit) totals_.hits.add(1);
      if (soft) share_out(b, mine, outcome, *soft, *shares);
    }
  }
  const PassTotals& totals() const { return totals_; }

 private:
  /// What the elements say of a beam's outcome: its density (1/m) or probability, and the
  /// probability that nothing was met.
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
                 const trace::OutlierShares& soft, BlockShares& shares) {
    const size_t first = block_.first[b], count = block_.first[b + 1] - first;
    const double range = block_.beams[b].range_m;
    const bool is_hit = block_.beams[b].range_m != kMiss;
    float* const hit = &shares.hit[first];
    float* const pass = &shares.pass[first];
    std::fill_n(hit, count, 0.0f);
    std::fill_n(pass, count, 0.0f);
    const double total = likelihood(outcome, is_hit, soft), scale = soft.explained() / total;
    shares.loss[b] = float(-std::log(total));
    if (is_hit) totals_.stray_hits.add(soft.likelihood(true, max_range_m_) / total);
    double later = is_hit ? 0 : outcome.through * scale;
    for (size_t i = order_.size(); i-- > 0;) {
      const uint32_t k = order_[i];
      const double share = is_hit ? double(hit_[k]) * scale : 0;
      hit[k] = float(share);
      pass[k] = float(later);
      later += share;
      const uint32_t element = block_.met[first + k];
      if (share > 0 && element < model_.triangles) {
        add_noise(element, share, range - double(c.t_m[k]), double(c.sigma_m[k]));
      }
    }
  }

  void add_noise(uint32_t element, double hit, double residual, double sigma) {
    const size_t mesh = element >= model_.ground_triangles;
    const double variance = sigma * sigma, misfit = residual * residual / variance - 1;
    const double own = double(model_.range_variance[mesh]) / variance;
    const double share[2] = {own, 1 - own};
    for (size_t j = 0; j < 2; ++j) {
      totals_.noise[mesh][j].add(hit * misfit * share[j]);
      totals_.noise[mesh][2 + j].add(hit * 2 * share[j] * share[j]);
    }
  }

  const ModelForm& model_;
  const BeamBlock& block_;
  double max_range_m_;
  PassTotals totals_;
  Columns columns_;
  std::vector<uint32_t> order_;
  std::vector<float> hit_;  // w_k N(z; t_k, σ_k²) of the meetings of a beam
};

PassTotals totals_of(const ModelForm& model, const BeamBlock& block, double max_range_m,
                     const trace::OutlierShares* soft, BlockShares* shares) {
  const size_t n = block.beams.size();
  std::vector<PassTotals> pieces((n + kTask - 1) / kTask);
  parallel_for(n, kTask, [&](size_t begin, size_t end) {
    Sharing sharing(model, block, max_range_m);
    for (size_t b = begin; b < end; b += kRun) {
      sharing.share(b, std::min(b + kRun, end), soft, shares);
    }
    pieces[begin / kTask] = sharing.totals();
  });
  PassTotals all;
  for (const PassTotals& piece : pieces) all.add(piece);
  return all;
}

}  // namespace

void PassTotals::add(const PassTotals& other) {
  loss.add(other.loss);
  stray_hits.add(other.stray_hits);
  hits.add(other.hits);
  for (size_t m = 0; m < noise.size(); ++m) {
    for (size_t k = 0; k < noise[m].size(); ++k) noise[m][k].add(other.noise[m][k]);
  }
}

PassTotals find_shares(const ModelForm& model, const BeamBlock& block,
                       const trace::OutlierShares& soft, double max_range_m, BlockShares& shares) {
  shares.hit.resize(block.met.size());
  shares.pass.resize(block.met.size());
  shares.loss.resize(block.beams.size());
  return totals_of(model, block, max_range_m, &soft, &shares);
}

Expectation expect(const trace::World& world, const ListedBeams& beams,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress) {
  const elements::Model& model = world.model();
  const LogInfo& info = beams.info();
  const ModelForms forms(model, info.min_range_m);
  const ModelForm form = forms.view();
  Expectation out;
  out.sums = ElementSums(model);
  PassTotals totals;
  BlockShares shares;
  size_t done = 0;
  beams.for_each([&](BeamBlock& block) {
    find_meetings(world, info, block);
    MeetingsByElement lists;
    parallel_invoke([&] { totals.add(find_shares(form, block, soft, info.max_range_m, shares)); },
                    [&] { lists = by_element(block, model.size()); });
    out.sums.add(form, block, lists, shares);
    done += block.beams.size();
    if (progress) progress(done, beams.training_beams());
  });
  out.sums.add_noise(elements::Kind::kGround, totals.noise[0]);
  out.sums.add_noise(elements::Kind::kSurface, totals.noise[1]);
  const double count = std::max<double>(1, double(beams.training_beams()));
  out.nll = totals.loss.value() / count;
  out.stray_hits = totals.stray_hits.value() / count;
  return out;
}

Judgement judge(const trace::World& world, const ListedBeams& beams) {
  const LogInfo& info = beams.info();
  const ModelForms forms(world.model(), info.min_range_m);
  BeamBlock block;
  block.beams = beams.held_out();
  find_meetings(world, info, block);
  const PassTotals totals = totals_of(forms.view(), block, info.max_range_m, nullptr, nullptr);
  const double count = std::max<double>(1, double(block.beams.size()));
  return {size_t(totals.hits.value()), totals.loss.value() / count};
}

}  // namespace underbrush::fit
