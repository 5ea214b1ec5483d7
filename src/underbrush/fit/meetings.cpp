#include "underbrush/fit/meetings.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::fit {
namespace {

/// Elements beyond a return count if their closest approach lies up to this much farther, because
/// their Gaussians reach back to the return, m.
constexpr double kBeyondM = 4;
constexpr size_t kPiece = 4096;  // beams that are searched together

/// The meetings of a piece of a block.
struct Piece {
  std::vector<uint32_t> met;
  std::vector<TriangleMeeting> on_triangle;
};

template <class T>
size_t bytes_of(const std::vector<T>& v) {
  return v.size() * sizeof(T);
}

float tilt_of(const elements::Model& model, const trace::Intersection& m, const Vec3& direction) {
  const elements::ElementPlace at = model.place(m.element);
  const elements::TriangleMesh& mesh = model.mesh(at.kind);
  const auto& corner = mesh.triangles[at.index];
  const Vec3 a = mesh.vertices[corner[0]].cast<double>(),
             b = mesh.vertices[corner[1]].cast<double>(),
             c = mesh.vertices[corner[2]].cast<double>();
  const Vec3 normal = (b - a).cross(c - a);
  const double along = normal.dot(direction), square = normal.squaredNorm();
  return float(square / std::max(along * along, 1e-4 * square));
}

/// Whether an element may give credit for the outcome of a beam at `range_m` while it stays within
/// its bounds, `reach` times the ellipsoid. It then has at most `reach` times its σ, and its
/// closest approach is not before the beam enters the bounds.
bool may_matter(const trace::Intersection& m, bool triangle, double tau, double scale,
                double range_m) {
  if (triangle) return m.t_m <= range_m + kBeyondM;
  const double half_chord = std::sqrt(std::max(tau * tau * scale * scale - m.delta2, 0.0));
  return m.t_m - (half_chord + double(kFarthestMisfit) * scale) * m.sigma_m <= range_m;
}

/// Joins the meetings of pieces of a block, whose `first` and `first_triangle` have the numbers of
/// each beam.
void join(std::vector<Piece>& pieces, BeamBlock& block) {
  const size_t n = block.beams.size();
  for (size_t i = 0; i < n; ++i) {
    block.first[i + 1] += block.first[i];
    block.first_triangle[i + 1] += block.first_triangle[i];
  }
  block.met.resize(block.first[n]);
  block.on_triangle.resize(block.first_triangle[n]);
  parallel_for(n, kPiece, [&](size_t begin, size_t) {
    const Piece from = std::exchange(pieces[begin / kPiece], {});
    std::copy(from.met.begin(), from.met.end(), block.met.begin() + block.first[begin]);
    std::copy(from.on_triangle.begin(), from.on_triangle.end(),
              block.on_triangle.begin() + block.first_triangle[begin]);
  });
}

/// The meetings of a block with the heirs of its ellipsoids, each once for a beam.
BeamBlock rearranged_block(const BeamBlock& block,
                           const std::vector<std::array<uint32_t, 2>>& heirs, size_t triangles) {
  const size_t n = block.beams.size();
  BeamBlock out{block.beams, block.held_out,   std::vector<uint32_t>(n + 1), block.first_triangle,
                {},          block.on_triangle};
  std::vector<std::vector<uint32_t>> found((n + kPiece - 1) / kPiece);
  parallel_for(n, kPiece, [&](size_t begin, size_t end) {
    std::vector<uint32_t>& to = found[begin / kPiece];
    for (size_t b = begin; b < end; ++b) {
      const auto first = ptrdiff_t(to.size());
      for (size_t s = block.first[b]; s < block.first[b + 1]; ++s) {
        const uint32_t element = block.met[s];
        if (element < triangles) {
          to.push_back(element);
          continue;
        }
        for (const uint32_t heir : heirs[element - triangles]) {
          if (heir == Rearranged::kNone) continue;
          const uint32_t added = uint32_t(triangles) + heir;
          if (std::find(to.begin() + first, to.end(), added) == to.end()) to.push_back(added);
        }
      }
      out.first[b + 1] = uint32_t(ptrdiff_t(to.size()) - first);
    }
  });
  for (size_t i = 0; i < n; ++i) out.first[i + 1] += out.first[i];
  for (const std::vector<uint32_t>& piece : found) {
    out.met.insert(out.met.end(), piece.begin(), piece.end());
  }
  return out;
}

}  // namespace

size_t BeamBlock::bytes() const {
  return bytes_of(beams) + bytes_of(held_out) + bytes_of(first) + bytes_of(first_triangle) +
         bytes_of(met) + bytes_of(on_triangle);
}

MeetingsByElement by_element(const BeamBlock& block, size_t elements) {
  MeetingsByElement out;
  std::vector<uint32_t> at(elements);
  for (size_t b = 0; b < block.beams.size(); ++b) {
    if (block.held_out[b]) continue;
    for (size_t s = block.first[b]; s < block.first[b + 1]; ++s) ++at[block.met[s]];
  }
  uint32_t sum = 0;
  for (size_t e = 0; e < elements; ++e) {
    const uint32_t count = std::exchange(at[e], sum);
    if (count) out.elements.push_back({uint32_t(e), sum});
    sum += count;
  }
  out.elements.push_back({uint32_t(elements), sum});
  out.met.resize(sum);
  for (size_t b = 0; b < block.beams.size(); ++b) {
    if (block.held_out[b]) continue;
    for (size_t s = block.first[b]; s < block.first[b + 1]; ++s) {
      out.met[at[block.met[s]]++] = {uint32_t(b), uint32_t(s)};
    }
  }
  return out;
}

Meetings::Meetings(const elements::Model& model, double scale, BeamSource& source,
                   const HeldOut& held_out, size_t most_bytes)
    : source_(source), held_out_(held_out), scale_(scale), bounds_(model) {
  require(scale >= 1, "meetings: bounds must not be smaller than the model");
  bounds_.tau *= scale;
  world_.emplace(bounds_);
  source_.rewind();
  size_t bytes = 0;
  for (BeamLog chunk; complete_ && source_.next(chunk);) {
    BeamBlock block = search(chunk);
    bytes += block.bytes();
    complete_ = bytes <= most_bytes;
    if (complete_) kept_.push_back(std::move(block));
  }
  if (complete_) world_.reset();
}

Meetings::Meetings(const Meetings& before, const Rearranged& after)
    : source_(before.source_),
      held_out_(before.held_out_),
      scale_(before.scale_),
      bounds_(after.model),
      complete_(before.complete_) {
  bounds_.tau = before.bounds_.tau;
  std::vector<uint8_t> merged(bounds_.ellipsoids.size());
  for (size_t i = 0; i < after.heirs.size(); ++i) {
    for (const uint32_t heir : after.heirs[i]) {
      if (heir == Rearranged::kNone) continue;
      if (!merged[heir]++) bounds_.ellipsoids[heir] = before.bounds_.ellipsoids[i];
    }
  }
  for (size_t k = 0; k < merged.size(); ++k) {
    if (merged[k] > 1) bounds_.ellipsoids[k] = after.model.ellipsoids[k];
  }
  if (!complete_) world_.emplace(bounds_);
  for (const BeamBlock& block : before.kept_) {
    kept_.push_back(rearranged_block(block, after.heirs, bounds_.triangle_count()));
  }
}

Meetings::~Meetings() = default;

BeamBlock Meetings::search(const BeamLog& chunk) const {
  const size_t n = chunk.size(), triangles = bounds_.triangle_count();
  const double max_range = std::min(chunk.info.max_range_m, bounds_.max_range_m);
  double widest = 0;  // largest length of the bounds along a ray
  for (const elements::Ellipsoid& e : bounds_.ellipsoids) {
    widest = std::max(widest, double(e.covariance[0]) + e.covariance[3] + e.covariance[5]);
  }
  widest = 2 * bounds_.tau * std::sqrt(widest);
  const trace::RangeLimits limits{chunk.info.min_range_m - widest, max_range + widest};
  BeamBlock block;
  block.beams.resize(n);
  block.held_out.resize(n);
  block.first.resize(n + 1);
  block.first_triangle.resize(n + 1);
  std::vector<Piece> found((n + kPiece - 1) / kPiece);
  parallel_for(n, kPiece, [&](size_t begin, size_t end) {
    std::vector<Ray> rays;
    std::vector<double> reach;
    for (size_t i = begin; i < end; ++i) {
      const Vec3f origin = (chunk.origin[i] - bounds_.origin).cast<float>();
      const Vec3f direction = chunk.ray(i).direction.cast<float>();
      rays.push_back({bounds_.origin + origin.cast<double>(), direction.cast<double>()});
      reach.push_back(std::min(double(chunk.range_m[i]) + kBeyondM, max_range));
      block.beams[i] = {{origin[0], origin[1], origin[2]},
                        chunk.range_m[i],
                        {direction[0], direction[1], direction[2]},
                        float(reach.back())};
      block.held_out[i] = held_out_(chunk, i);
    }
    trace::IntersectionLists lists;
    world_->all_intersections(rays, limits, reach, lists);
    Piece& out = found[begin / kPiece];
    for (size_t i = begin; i < end; ++i) {
      for (const trace::Intersection& m : lists[i - begin]) {
        const bool triangle = m.element < triangles;
        if (!may_matter(m, triangle, bounds_.tau / scale_, scale_, chunk.range_m[i])) continue;
        out.met.push_back(m.element);
        ++block.first[i + 1];
        if (!triangle) continue;
        out.on_triangle.push_back({float(m.t_m), tilt_of(bounds_, m, rays[i - begin].direction)});
        ++block.first_triangle[i + 1];
      }
    }
  });
  join(found, block);
  return block;
}

bool Meetings::within_bounds(size_t index, const elements::Ellipsoid& e) const {
  const elements::Ellipsoid& old = bounds_.ellipsoids[index];
  const Mat3 root = Eigen::LLT<Mat3>(old.covariance_matrix()).matrixL();
  const auto lower = root.triangularView<Eigen::Lower>();
  const Mat3 half = lower.solve(e.covariance_matrix());
  const Mat3 covariance = lower.solve(half.transpose());
  // The largest eigenvalue is at most 1 + |M − I|.
  const double growth = std::sqrt(1 + (covariance - Mat3::Identity()).norm());
  const double shift = lower.solve((e.mean - old.mean).cast<double>()).norm();
  const double tau = bounds_.tau / scale_;
  return shift + tau * growth <= bounds_.tau;
}

size_t Meetings::keep_within_bounds(const elements::Model& now, elements::Model& next) const {
  std::vector<uint8_t> held_back(now.ellipsoids.size());
  parallel_for(held_back.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const elements::Ellipsoid &from = now.ellipsoids[i], to = next.ellipsoids[i];
      elements::Ellipsoid& e = next.ellipsoids[i];
      float part = 1;
      while (!within_bounds(i, e)) {
        held_back[i] = 1;
        part = part > 0.2f ? part / 2 : 0;
        e.mean = from.mean + part * (to.mean - from.mean);
        for (size_t k = 0; k < 6; ++k) {
          e.covariance[k] = from.covariance[k] + part * (to.covariance[k] - from.covariance[k]);
        }
        if (part == 0) break;
      }
    }
  });
  return size_t(std::count(held_back.begin(), held_back.end(), 1));
}

void Meetings::for_each(const std::function<void(const BeamBlock&, size_t)>& use) const {
  size_t done = 0;
  for (const BeamBlock& block : kept_) use(block, done += block.beams.size());
  if (complete_) return;
  source_.rewind();
  size_t number = 0;
  for (BeamLog chunk; source_.next(chunk);) {
    if (number++ >= kept_.size()) use(search(chunk), done += chunk.size());
  }
}

}  // namespace underbrush::fit
