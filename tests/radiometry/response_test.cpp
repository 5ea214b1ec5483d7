#include "underbrush/radiometry/response.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::radiometry {
namespace {

/// Computes the width at half height by bisection on both flanks.
double width_m(const Response& h) {
  double sum = 0;
  for (const double sign : {-1.0, 1.0}) {
    double in = 0, out = sign * 10;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (in + out);
      (h.at(middle) > 0.5 ? in : out) = middle;
    }
    sum += std::abs(in);
  }
  return sum;
}

TEST(Response, OfTwoGaussiansIsAGaussianOfTheSummedSquares) {
  const Response h({Pulse::kGaussian, 4e-9, 3e-9, 1e-9});
  EXPECT_NEAR(h.cell_m(), 0.1499, 1e-4);
  const double fwhm = kSpeedOfLight / 2 * 5e-9, sigma = fwhm / std::sqrt(8 * M_LN2);
  for (double x = -1.2; x < 1.2; x += 0.01) {
    EXPECT_NEAR(h.at(x), std::exp(-x * x / (2 * sigma * sigma)), 3e-4) << x;
  }
  EXPECT_NEAR(h.area_m(), sigma * std::sqrt(2 * M_PI), 2e-4 * h.area_m());
}

TEST(Response, OfAnyPulsePeaksAtTheTargetAndHasItsWidth) {
  for (const Pulse pulse : {Pulse::kGaussian, Pulse::kQSwitched}) {
    const Response sharp({pulse, 6e-9, 0, 1e-9}), blurred({pulse, 6e-9, 6e-9, 1e-9});
    EXPECT_NEAR(width_m(sharp), kSpeedOfLight / 2 * 6e-9, 2e-3);
    EXPECT_GT(width_m(blurred), 1.3 * width_m(sharp));
    for (const Response* h : {&sharp, &blurred}) {
      EXPECT_NEAR(h->at(0), 1, 1e-6);
      EXPECT_LT(h->at(0.02), 1);
      EXPECT_LT(h->at(-0.02), 1);
      EXPECT_EQ(h->at(100), 0);
      EXPECT_EQ(h->taps() % 8, 0);
      // A row holds h at its own places.
      for (int k = 0; k < h->taps(); ++k) {
        const double x = (k - h->before() - (100 + 0.5) / Response::kPhases) * h->cell_m();
        EXPECT_NEAR(h->row(100)[k], h->at(x), 1e-6);
      }
    }
    // The receiver's response conserves energy: the area is the product of its own and the pulse's,
    // divided by the peak.
    EXPECT_NEAR(blurred.area_m() / sharp.area_m(), pulse == Pulse::kGaussian ? M_SQRT2 : 1.44,
                0.01);
  }
  const Response q({Pulse::kQSwitched, 6e-9, 0, 1e-9});
  EXPECT_GT(q.at(0.5), 2 * q.at(-0.5));  // it rises faster than it falls
}

TEST(Response, RefusesTimesThatAreNone) {
  EXPECT_THROW(Response({Pulse::kGaussian, 0, 0, 1e-9}), std::invalid_argument);
  EXPECT_THROW(Response({Pulse::kGaussian, 5e-9, -1, 1e-9}), std::invalid_argument);
  EXPECT_THROW(Response({Pulse::kGaussian, 5e-9, 0, NAN}), std::invalid_argument);
  EXPECT_THROW(Response({Pulse::kGaussian, 1, 0, 1e-9}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::radiometry
