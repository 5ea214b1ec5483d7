#include "studies/transmission.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::studies {
namespace {

constexpr double kStep = 0.6 * M_PI / 180;
constexpr LeafAngles kAllAngles[] = {LeafAngles::kSpherical, LeafAngles::kHorizontal,
                                     LeafAngles::kVertical};

TEST(TurbidSlab, LeavesOfAnyAnglesCoverHalfTheirAreaInAllDirectionsOnAverage) {
  for (const LeafAngles angles : kAllAngles) {
    double sum = 0;
    constexpr int kSteps = 10'000;
    for (int k = 0; k < kSteps; ++k) {  // The cosine is uniform for directions on a sphere.
      const double cosine = (k + 0.5) / kSteps;
      sum += projection(angles, {std::sqrt(1 - cosine * cosine), 0, cosine});
    }
    EXPECT_NEAR(sum / kSteps, 0.5, 1e-4);
  }
  EXPECT_EQ(projection(LeafAngles::kHorizontal, -Vec3::UnitZ()), 1);
  EXPECT_EQ(projection(LeafAngles::kHorizontal, Vec3::UnitX()), 0);
  EXPECT_EQ(projection(LeafAngles::kVertical, -Vec3::UnitZ()), 0);
}

TEST(TurbidSlab, AsManyBeamsPassAsTheExtinctionLetsThrough) {
  for (const LeafAngles angles : kAllAngles) {
    for (const SlabView view : {SlabView::kTripods, SlabView::kOverhead, SlabView::kMobile}) {
      const TurbidSlab slab{0.3, angles};
      const BeamLog beams = view_beams(view, 40'000, 5);
      const Transmission truth = true_transmission(slab, beams);
      EXPECT_NEAR(transmission_of(measured(slab, beams, 6)), truth.share, 4 * truth.error)
          << int(angles) << " " << int(view);
      if (view != SlabView::kOverhead) continue;
      const double k = slab.area_density * projection(angles, Vec3::UnitZ());
      EXPECT_NEAR(truth.share, std::exp(-10 * k), 1e-6);
    }
  }
}

/// Throws discs across a beam of radius `beam_m` and returns the mean area in which the disc's
/// middle lies when they touch.
double touching_area(double beam_m, Stream& random) {
  constexpr int kThrows = 40'000, kOutline = 90;
  const double side = 2.2 * (TurbidSlab::kLeafRadiusM + beam_m);
  int touching = 0;
  for (int k = 0; k < kThrows; ++k) {
    const double x = random.uniform(-side / 2, side / 2);
    const double y = random.uniform(-side / 2, side / 2);
    const double a = TurbidSlab::kLeafRadiusM, b = a * random.uniform();  // b/a: cosine of the tilt
    bool touches = x * x / (a * a) + y * y / (b * b) <= 1;
    for (int j = 0; j < kOutline && !touches; ++j) {
      const double u = 2 * M_PI * j / kOutline;
      touches = std::hypot(x + a * std::cos(u), y + b * std::sin(u)) <= beam_m;
    }
    touching += touches;
  }
  return side * side * touching / kThrows;
}

TEST(TurbidSlab, AWideBeamTouchesAsManyDiscsAsOneCounts) {
  Stream random(7);
  const TurbidSlab slab{0.2, LeafAngles::kSpherical, 0.01};
  for (const double range : {4.0, 10.0, 25.0}) {
    const double discs_per_m3 = slab.area_density / (M_PI * std::pow(slab.kLeafRadiusM, 2));
    const double depth = slab.optical_depth({}, range - 0.5, range + 0.5);
    const double counted = discs_per_m3 * touching_area(slab.divergence_rad / 2 * range, random);
    EXPECT_NEAR(depth / counted, 1, 0.03) << range;
  }
}

TEST(TurbidSlab, WideBeamsPassAsTheirExtinctionLetsThrough) {
  const TurbidSlab slab{0.1, LeafAngles::kSpherical, 0.005};
  const BeamLog beams = view_beams(SlabView::kTripods, 40'000, 5);
  const Transmission truth = true_transmission(slab, beams);
  EXPECT_GT(truth.share, 20 * truth.error);
  EXPECT_NEAR(transmission_of(measured(slab, beams, 6)), truth.share, 4 * truth.error);
  EXPECT_THROW(measured({0.1, LeafAngles::kVertical, 0.005}, beams, 6), std::invalid_argument);
}

TEST(PlainDensity, ReturnsTheDensityOfTheSlabWithinItsError) {
  for (const LeafAngles angles : kAllAngles) {
    const TurbidSlab slab{0.5, angles};
    const SlabCells cells(measured(slab, tripod_beams(kStep), 3), angles);
    for (int z = 1; z + 1 < SlabCells::kHeight; ++z) {
      double hits = 0, path = 0;
      for (int y = kFirstInner; y < kEndInner; ++y) {
        for (int x = kFirstInner; x < kEndInner; ++x) {
          hits += double(cells.at(x, y, z).hits);
          path += cells.at(x, y, z).path_m;
        }
      }
      EXPECT_NEAR(hits / path, 0.5, 4 * std::sqrt(0.5 / path)) << int(angles) << " " << z;
      EXPECT_LT(std::sqrt(0.5 / path), 0.02);
    }
  }
}

TEST(PlainDensity, PathLengthsAreThoseOfTheBeams) {
  const BeamLog beams = view_beams(SlabView::kMobile, 1000, 3);
  const BeamLog log = measured({0.5}, beams, 4);
  const SlabCells cells(log, LeafAngles::kSpherical);
  double path = 0, in_cells = 0;
  size_t hits = 0, hits_in_cells = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    const SlabCrossing c = *TurbidSlab::crossing(log.ray(i));
    path += 0.5 * (std::clamp(double(log.range_m[i]), c.enter_m, c.leave_m) - c.enter_m);
    hits += log.range_m[i] > c.enter_m && log.range_m[i] < c.leave_m;
  }
  for (int z = 0; z < SlabCells::kHeight; ++z) {
    for (int y = 0; y < SlabCells::kWidth; ++y) {
      for (int x = 0; x < SlabCells::kWidth; ++x) {
        in_cells += cells.at(x, y, z).path_m;
        hits_in_cells += cells.at(x, y, z).hits;
      }
    }
  }
  EXPECT_NEAR(in_cells, path, 1e-6 * path);
  EXPECT_EQ(hits_in_cells, hits);
}

/// Fires beams through a cell of 1 m with G = 1.
CellSums fired(double density, size_t beams, Stream& random) {
  CellSums out;
  out.beams = beams;
  for (size_t k = 0; k < beams; ++k) {
    const double leaf = -std::log(random.uniform()) / density;
    out.path_m += std::min(leaf, 1.0);
    out.hits += leaf < 1;
    if (leaf < 1) out.path_of_hits_m += leaf;
  }
  return out;
}

TEST(PlainDensity, IsUnbiasedWithFewBeamsAndItsIntervalHolds) {
  Stream random(11);
  constexpr int kCells = 40'000;
  double corrected = 0, plain = 0, held = 0, held_wrong = 0;
  for (int k = 0; k < kCells; ++k) {
    const CellSums few = fired(1, 8, random);
    corrected += few.density() / kCells;
    plain += double(few.hits) / few.path_m / kCells;
    const CellSums many = fired(0.1, 100, random);
    held += many.interval_holds(0.1) / double(kCells);
    held_wrong += many.interval_holds(0.25) / double(kCells);
  }
  EXPECT_NEAR(corrected, 1, 0.03);
  EXPECT_GT(plain, 1.08);
  EXPECT_NEAR(held, 0.95, 0.015);
  EXPECT_LT(held_wrong, 0.2);
}

TEST(Transmission, TheIntervalsOfTheLogHoldTheTruthInNineteenOfTwentyCells) {
  const TurbidSlab slab{0.5};
  const SlabCells cells(measured(slab, tripod_beams(kStep), 3), slab.angles);
  EXPECT_NEAR(densities_of([](int, int, int) { return 0.5; }, cells).covered, 0.95, 0.015);
  EXPECT_LT(densities_of([](int, int, int) { return 1.0; }, cells).covered, 0.1);
  const SlabAnswer half =
      densities_of([](int x, int, int z) { return x % 2    ? NAN
                                                  : z == 0 ? 2.0
                                                           : 0.5; }, cells);
  EXPECT_NEAR(half.opaque, 0.5, 1e-9);
  EXPECT_EQ(half.layer.front(), 2);
  EXPECT_NEAR(half.area_density, 0.65, 1e-9);
}

TEST(Transmission, VoxelsOfSphericalLeavesHaveTheirDensityAndOthersLess) {
  EXPECT_NEAR(area_density_of_voxels({0.7}), 0.7, 1e-12);
  EXPECT_LT(area_density_of_voxels({0.7, LeafAngles::kHorizontal}), 0.6);
  EXPECT_LT(area_density_of_voxels({0.7, LeafAngles::kVertical}), 0.6);
}

TEST(Transmission, ChecksHoldForTheTruthAndFailBeyondTheirLimits) {
  SlabAnswer truth;
  truth.area_density = 0.5;
  truth.layer.fill(0.5);
  truth.transmission = {0.1, 0.08, 0.05};
  const auto holds_with = [&](const auto& change) {
    SlabAnswer answer = truth;
    change(answer);
    return holds(slab_checks("slab", answer, truth));
  };
  EXPECT_TRUE(holds_with([](SlabAnswer&) {}));
  EXPECT_TRUE(holds_with([](SlabAnswer& a) { a.layer.front() = a.layer.back() = 2; }));
  EXPECT_TRUE(holds_with([](SlabAnswer& a) { a.transmission = {0.9, 0.086, 0.9}; }));
  EXPECT_FALSE(holds_with([](SlabAnswer& a) { a.area_density = 0.53; }));
  EXPECT_FALSE(holds_with([](SlabAnswer& a) { a.layer[4] = 0.47; }));
  EXPECT_FALSE(holds_with([](SlabAnswer& a) { a.layer[8] = NAN; }));
  EXPECT_FALSE(holds_with([](SlabAnswer& a) { a.transmission[1] = 0.07; }));
}

}  // namespace
}  // namespace underbrush::studies
