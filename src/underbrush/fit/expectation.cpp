#include "underbrush/fit/expectation.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/parallel.hpp"

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
  Sharing(const ModelForm& model, const BeamBlock& block, const trace::OutlierShares& soft,
          double max_range_m, BlockShares& shares)
      : model_(model), block_(block), soft_(soft), max_range_m_(max_range_m), shares_(shares) {}

  void share(size_t begin, size_t end) {
    const size_t from = block_.first[begin];
    const MeetingColumns c = columns_.of(block_.first[end] - from);
    pass_kernels().approach(model_, block_.beams.data(), block_.first.data(), begin, end,
                            block_.met.data(),
                            block_.on_triangle.data() + block_.first_triangle[begin], c);
    for (size_t b = begin; b < end; ++b) {
      const size_t at = block_.first[b] - from;
      share_one(b, {c.t_m + at, c.sigma_m + at, c.p + at, c.density + at});
    }
  }
  const PassTotals& totals() const { return totals_; }

 private:
  /// Puts the meetings of a beam into the order of range. Those of a search are nearly so.
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

  void share_one(size_t b, const MeetingColumns& c) {
    const size_t first = block_.first[b], count = block_.first[b + 1] - first;
    const double range = block_.beams[b].range_m;
    const bool is_hit = block_.beams[b].range_m != kMiss;
    sort(c, &block_.met[first], count);
    float* const hit = &shares_.hit[first];
    float* const pass = &shares_.pass[first];
    std::fill_n(hit, count, 0.0f);
    std::fill_n(pass, count, 0.0f);
    double through = 1, density = 0;
    for (const uint32_t k : order_) {
      const double found = through * double(c.p[k]) * double(c.density[k]);
      hit[k] = float(found);
      density += found;
      through *= 1 - double(c.p[k]);
    }
    const double found = is_hit ? density : through;
    const auto likelihood = [&](const trace::OutlierShares& o) {
      return o.explained() * found + o.likelihood(is_hit, max_range_m_);
    };
    const double loss = -std::log(likelihood(trace::kReportedOutliers));
    (block_.held_out[b] ? totals_.held_out : totals_.training).add(loss);
    (block_.held_out[b] ? totals_.held_out_beams : totals_.training_beams).add(1);
    if (block_.held_out[b] && is_hit) totals_.held_out_hits.add(1);
    if (block_.held_out[b]) return std::fill_n(hit, count, 0.0f), void();
    const double total = likelihood(soft_), scale = soft_.explained() / total;
    shares_.loss[b] = float(-std::log(total));
    if (is_hit) totals_.stray_hits.add(soft_.likelihood(true, max_range_m_) / total);
    double later = is_hit ? 0 : through * scale;
    for (size_t i = order_.size(); i-- > 0;) {
      const uint32_t k = order_[i];
      const double share = is_hit ? double(hit[k]) * scale : 0;
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
  const trace::OutlierShares& soft_;
  double max_range_m_;
  BlockShares& shares_;
  PassTotals totals_;
  Columns columns_;
  std::vector<uint32_t> order_;
};

}  // namespace

void PassTotals::add(const PassTotals& other) {
  training.add(other.training);
  held_out.add(other.held_out);
  stray_hits.add(other.stray_hits);
  training_beams.add(other.training_beams);
  held_out_beams.add(other.held_out_beams);
  held_out_hits.add(other.held_out_hits);
  for (size_t m = 0; m < noise.size(); ++m) {
    for (size_t k = 0; k < noise[m].size(); ++k) noise[m][k].add(other.noise[m][k]);
  }
}

PassTotals find_shares(const ModelForm& model, const BeamBlock& block,
                       const trace::OutlierShares& soft, double max_range_m, BlockShares& shares) {
  const size_t n = block.beams.size();
  shares.hit.resize(block.met.size());
  shares.pass.resize(block.met.size());
  shares.loss.resize(n);
  std::vector<PassTotals> pieces((n + kTask - 1) / kTask);
  parallel_for(n, kTask, [&](size_t begin, size_t end) {
    Sharing sharing(model, block, soft, max_range_m, shares);
    for (size_t b = begin; b < end; b += kRun) sharing.share(b, std::min(b + kRun, end));
    pieces[begin / kTask] = sharing.totals();
  });
  PassTotals all;
  for (const PassTotals& piece : pieces) all.add(piece);
  return all;
}

Expectation expect(const elements::Model& model, const Meetings& meetings,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress) {
  const LogInfo& info = meetings.info();
  const ModelForms forms(model, info.min_range_m);
  const ModelForm form = forms.view();
  Expectation out;
  out.sums = ElementSums(model);
  PassTotals totals;
  BlockShares shares;
  meetings.for_each([&](const BeamBlock& block, size_t done) {
    MeetingsByElement lists;
    parallel_invoke([&] { totals.add(find_shares(form, block, soft, info.max_range_m, shares)); },
                    [&] { lists = by_element(block, model.size()); });
    out.sums.add(form, block, lists, shares);
    if (progress) progress(done, meetings.beams());
  });
  out.sums.add_noise(elements::Kind::kGround, totals.noise[0]);
  out.sums.add_noise(elements::Kind::kSurface, totals.noise[1]);
  out.training_beams = size_t(totals.training_beams.value());
  out.held_out_beams = size_t(totals.held_out_beams.value());
  out.held_out_hits = size_t(totals.held_out_hits.value());
  const double trained = std::max(1.0, totals.training_beams.value());
  out.training_nll = totals.training.value() / trained;
  out.held_out_nll = totals.held_out.value() / std::max(1.0, totals.held_out_beams.value());
  out.stray_hits = totals.stray_hits.value() / trained;
  return out;
}

Expectation expect(const elements::Model& model, BeamSource& source, const HeldOut& held_out,
                   const trace::OutlierShares& soft) {
  return expect(model, Meetings(model, 1, source, held_out, 0), soft);
}

}  // namespace underbrush::fit
