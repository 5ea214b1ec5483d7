#include "underbrush/simulate/echoes.hpp"

#include <gtest/gtest.h>

#include "simulate/targets.hpp"
#include "trace/scenes.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::simulate {
namespace {

constexpr double kRho = 0.99;  // reflectance of white_target

TEST(Echoes, APlaneAtAnyRangeAndAngleHasTheSignalOfTheLidarEquation) {
  for (const double range : {3.0, 10.0, 47.3, 90.0}) {
    for (const double tilt : {0.0, 0.5, 1.0}) {
      elements::Model model;
      add_wall(model, range, -20, 20, tilt);
      Instrument instrument = quiet_instrument();
      instrument.beam.divergence_rad = {1e-4, 1e-4};  // a negligible footprint
      const BeamLog log = answered(model, instrument, beams_along_x(1));
      ASSERT_EQ(log.size(), 1u);
      EXPECT_NEAR(log.range_m[0], range, 1e-3) << tilt;
      const double signal = 1e6 * kRho * std::cos(tilt) / (range * range);
      EXPECT_NEAR(log.intensity[0], signal, 0.003 * signal) << range << " " << tilt;
    }
  }
}

TEST(Echoes, EnergyOverSubRaysIsConserved) {
  elements::Model model;
  add_wall(model, 20);
  float first = 0;
  for (const int n : {1, 2, 5, 9, 16}) {
    const BeamLog log = answered(model, quiet_instrument(n, n), beams_along_x(1));
    ASSERT_EQ(log.size(), 1u);
    if (n == 1) first = log.intensity[0];
    EXPECT_NEAR(log.intensity[0], first, 2e-4 * first) << n;
  }
}

TEST(Echoes, AnEdgeGivesTwoEchoesWithItsSharesOfTheEnergy) {
  elements::Model model;
  add_wall(model, 20, 0, 20);    // the left half of the beam
  add_wall(model, 23, -20, 20);  // behind it, in the other half
  const BeamLog log = answered(model, quiet_instrument(20, 20), beams_along_x(1));
  ASSERT_EQ(log.size(), 2u);
  EXPECT_EQ(column<uint8_t>(log, kEchoColumn), (std::vector<uint8_t>{1, 2}));
  EXPECT_EQ(column<uint8_t>(log, kEchoesColumn), (std::vector<uint8_t>{2, 2}));
  EXPECT_NEAR(log.range_m[0], 20, 0.002);
  EXPECT_NEAR(log.range_m[1], 23, 0.002);
  EXPECT_NEAR(log.intensity[0], 0.5 * 1e6 * kRho / 400, 15);
  EXPECT_NEAR(log.intensity[1], 0.5 * 1e6 * kRho / 529, 15);
  EXPECT_GT(column<float>(log, kPulseWidthColumn)[0], 0.5f);
}

TEST(Echoes, AStepThatThePulseCannotSeparateIsOneMixedPixel) {
  elements::Model model;
  add_wall(model, 20, 0, 20);
  add_wall(model, 20.4, -20, 20);
  const BeamLog log = answered(model, quiet_instrument(20, 20), beams_along_x(1));
  ASSERT_EQ(log.size(), 1u);
  EXPECT_GT(log.range_m[0], 20.1f);  // between the surfaces
  EXPECT_LT(log.range_m[0], 20.3f);
  elements::Model alone;
  add_wall(alone, 20);
  const BeamLog flat = answered(alone, quiet_instrument(20, 20), beams_along_x(1));
  EXPECT_GT(column<float>(log, kPulseWidthColumn)[0],
            column<float>(flat, kPulseWidthColumn)[0] + 0.05f);
}

TEST(Echoes, ATargetOfHalfTheFootprintFadesAsTheFootprintGrows) {
  // The disc-like beam of 20 mrad has a half-width of 0.1 m at 10 m and 0.2 m at 20 m; the sheet is
  // 0.1 m wide.
  std::vector<float> share;
  for (const double range : {10.0, 20.0, 40.0}) {
    elements::Model model;
    add_sheet(model, Vec3(range, -0.05, -20), Vec3(0, 0.1, 0), Vec3(0, 0, 40));
    Instrument instrument = quiet_instrument(64, 64);
    const BeamLog log = answered(model, instrument, beams_along_x(1));
    ASSERT_EQ(log.size(), 1u);
    const double r = 0.01 * range, a = 0.05 / r;  // strip |y| < a of the unit disc
    const double exact = 2 / M_PI * (a * std::sqrt(1 - a * a) + std::asin(a));
    EXPECT_NEAR(log.intensity[0], exact * 1e6 * kRho / (range * range), 0.03 * log.intensity[0]);
  }
}

TEST(Echoes, ReturnWhereHalfOfTheFittedBeamsAreaDoes) {
  // The edge of a wall at 20 m stands at −r to r beside the beam's axis, whose half-width is 0.2 m.
  const auto returns = [](double edge_m, double fitted_rad) {
    elements::Model model;
    add_wall(model, 20, edge_m, 20);
    Instrument instrument = quiet_instrument(64, 64);
    if (fitted_rad > 0) instrument.fitted_beam = sensor::round_beam(fitted_rad, 0);
    return answered(model, instrument, beams_along_x(1)).is_hit(0);
  };
  EXPECT_TRUE(returns(0.18, 0));  // any part of the beam is enough
  for (const double rad : {0.02, 0.06}) {
    EXPECT_TRUE(returns(-0.01, rad));
    EXPECT_FALSE(returns(0.01, rad));
  }
  // Half of the area of a beam half as wide is an eighth of that of this one: the edge may be
  // 0.63 half-widths off the axis, where (acos a − a √(1 − a²)) / π = 1/8.
  EXPECT_TRUE(returns(0.121, 0.01));
  EXPECT_FALSE(returns(0.131, 0.01));
}

TEST(Echoes, AThinRayAndItsInstrumentReturnAlikeFromEdges) {
  // Gratings of bars whose period is many beams: a thin ray returns from the covered share.
  for (const double covered : {0.3, 0.5, 0.8}) {
    elements::Model model;
    for (int k = -20; k < 20; ++k) {
      add_sheet(model, Vec3(20, 2.0 * k, -20), Vec3(0, 2 * covered, 0), Vec3(0, 0, 40));
    }
    Instrument instrument = quiet_instrument(12, 12);
    instrument.fitted_beam = instrument.beam;
    BeamLog beams = beams_along_x(4000);
    for (size_t i = 0; i < beams.size(); ++i) {
      beams.direction[i] = Vec3f(20, -15 + 30 * float(i) / 4000, 0).normalized();
    }
    const BeamLog log = answered(model, instrument, beams);
    ASSERT_EQ(log.size(), 4000u);
    int hits = 0;
    for (size_t i = 0; i < log.size(); ++i) hits += log.is_hit(i);
    EXPECT_NEAR(hits / 4000.0, covered, 0.01);
  }
}

TEST(Echoes, WhatAKeyframeAnswersIsTheOnlyEcho) {
  elements::Model model;
  add_wall(model, 20);
  const trace::World world(model);
  const DynamicWorld dynamic_world(world);
  const Reflection reflection(all_of("white_target"), 905e-9);
  const Instrument instrument = quiet_instrument();
  BeamLog log = beams_along_x(3);
  const std::vector<std::optional<keyframes::CachedReturn>> cached{
      {}, keyframes::CachedReturn{7, 3, 4}, keyframes::CachedReturn{INFINITY, 0, 0}};
  EchoOptions options;
  options.waveforms.count = 3;
  EchoMaker maker(dynamic_world, reflection, instrument, options);
  maker.answer(0, log, cached);
  ASSERT_EQ(maker.waveforms().size(), 1u);  // those of keyframes have none
  EXPECT_EQ(maker.waveforms()[0].beam, 0u);
  ASSERT_EQ(log.size(), 3u);
  EXPECT_NEAR(log.range_m[0], 20, 0.01);
  EXPECT_EQ(log.range_m[1], 7);
  EXPECT_EQ(log.intensity[1], 4);
  EXPECT_FALSE(log.is_hit(2));
}

TEST(Echoes, LeavesOfAllDirectionsSendBackTwoThirds) {
  elements::Model model;
  elements::Ellipsoid e;
  e.mean = Vec3f(20, 0, 0);
  e.set_covariance(Vec3(1e-6, 4, 4).asDiagonal());
  model.ellipsoids.push_back(e);
  const BeamLog log = answered(model, quiet_instrument(), beams_along_x(1), "leaf");
  ASSERT_EQ(log.size(), 1u);
  EXPECT_NEAR(log.range_m[0], 20, 0.005);
  EXPECT_NEAR(log.intensity[0], 2.0 / 3 * 0.48 * 1e6 / 400, 3);
}

TEST(Echoes, APermeableVolumeStopsItsShareOfTheLight) {
  elements::Model model;
  elements::Ellipsoid e;
  e.mean = Vec3f(20, 0, 0);
  e.set_covariance(Vec3(1e-4, 9, 9).asDiagonal());
  e.hit.p = 0.3f;
  model.ellipsoids.push_back(e);
  add_wall(model, 30);
  const BeamLog log = answered(model, quiet_instrument(7, 7), beams_along_x(2000));
  double front = 0, back = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    (log.range_m[i] < 25 ? front : back) += log.intensity[i] / double(2000);
  }
  const double leaves = 2.0 / 3;
  EXPECT_NEAR(front, 0.3 * leaves * kRho * 1e6 / 400, 0.01 * front);
  EXPECT_NEAR(back, 0.7 * kRho * 1e6 / 900, 0.01 * back);
}

TEST(Echoes, OneSubRayAnswersAsTheThinRayDoes) {
  elements::Model model = trace::random_model(3, 2000);
  const trace::World world(model);
  BeamLog thin = beams_along_x(500);
  Stream random(5);
  for (size_t i = 0; i < thin.size(); ++i) {
    thin.direction[i] =
        Vec3(random.normal(), random.normal(), random.normal()).normalized().cast<float>();
  }
  const BeamLog fired = thin;
  simulate(world, {}, 0, thin);
  Instrument instrument = quiet_instrument();
  instrument.beam = {};
  instrument.sub_rays = {{}};
  instrument.receiver.signal_at_1m = 1e9;
  const BeamLog log = answered(model, instrument, fired);
  ASSERT_EQ(log.size(), thin.size());
  size_t hits = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    ASSERT_EQ(log.is_hit(i), thin.is_hit(i)) << i;
    hits += log.is_hit(i);
    if (log.is_hit(i)) {
      EXPECT_NEAR(log.range_m[i], thin.range_m[i], 1e-3) << i;
    }
  }
  EXPECT_GT(hits, 100u);
}

TEST(Echoes, RangesSpreadByTheConfiguredAccuracy) {
  elements::Model model;
  add_wall(model, 20);
  Instrument instrument = quiet_instrument();
  instrument.receiver.range_sigma_m = 0.03;
  const BeamLog log = answered(model, instrument, beams_along_x(40000));
  double mean = 0, square = 0;
  for (const float r : log.range_m) mean += (r - 20.0) / double(log.size());
  for (const float r : log.range_m) square += (r - 20.0) * (r - 20.0) / double(log.size());
  EXPECT_NEAR(mean, 0, 6e-4);
  EXPECT_NEAR(std::sqrt(square), 0.03, 4e-4);
}

TEST(Echoes, KeepsMissesAndOtherColumnsBesideSeveralEchoes) {
  elements::Model model;
  add_wall(model, 20, 0, 20);
  add_wall(model, 23, -20, 20);
  BeamLog beams = beams_along_x(3);
  beams.direction[1] = -Vec3f::UnitX();
  beams.ring = {4, 5, 6};
  beams.time_s = {0.1, 0.2, 0.3};
  beams.extra["tag"] = std::vector<int16_t>{-1, -2, -3};
  EchoOptions options;
  options.element_ids = true;
  BeamLog log = answered(model, quiet_instrument(), beams, "white_target", options);
  log.check();
  EXPECT_EQ(log.ring, (std::vector<uint16_t>{4, 4, 5, 6, 6}));
  EXPECT_EQ(log.time_s, (std::vector<double>{0.1, 0.1, 0.2, 0.3, 0.3}));
  EXPECT_EQ(column<int16_t>(log, "tag"), (std::vector<int16_t>{-1, -1, -2, -3, -3}));
  EXPECT_EQ(column<uint8_t>(log, kEchoColumn), (std::vector<uint8_t>{1, 2, 0, 1, 2}));
  EXPECT_FALSE(log.is_hit(2));
  const auto& element = column<uint32_t>(log, "element");
  EXPECT_LT(element[0], 2u);
  EXPECT_GE(element[1], 2u);
  EXPECT_EQ(element[2], trace::Intersection::kNone);
  keep_first_echoes(log);
  EXPECT_EQ(log.ring, beams.ring);
  EXPECT_NEAR(log.range_m[2], 20, 0.002);
}

TEST(Echoes, GivesTheSameBitsForAnyThreadsAndChunksAndOthersForAnotherSeed) {
  const elements::Model model = trace::random_model(3, 2000);
  BeamLog beams = beams_along_x(3000);
  Stream random(6);
  for (Vec3f& d : beams.direction) {
    d = Vec3(random.normal(), random.normal(), random.normal()).normalized().cast<float>();
  }
  Instrument instrument = quiet_instrument(5, 5);
  instrument.receiver.noise_sigma = 1;
  instrument.receiver.false_alarms = true;
  instrument.receiver.range_sigma_m = 0.02;
  instrument.beam.encoder_step_rad = 0.001;
  const BeamLog whole = answered(model, instrument, beams);
  set_threads(1);
  const BeamLog alone = answered(model, instrument, beams);
  set_threads(0);
  EXPECT_EQ(whole.range_m, alone.range_m);
  EXPECT_EQ(whole.intensity, alone.intensity);

  const trace::World world(model);
  const DynamicWorld dynamic_world(world);
  const Reflection reflection(all_of("white_target"), 905e-9);
  EchoMaker maker(dynamic_world, reflection, instrument, {});
  BeamLog joined;
  for (size_t begin = 0; begin < beams.size(); begin += 700) {
    BeamLog part = beams.like();
    part.append(beams, begin, std::min(begin + 700, beams.size()));
    maker.answer(begin, part);
    joined.append(part, 0, part.size());
  }
  EXPECT_EQ(whole.range_m, joined.range_m);
  EchoOptions other;
  other.seed = 2;
  EXPECT_NE(answered(model, instrument, beams, "white_target", other).range_m, whole.range_m);
}

TEST(Echoes, WaveformsOfTheChosenBeamsAreKept) {
  elements::Model model;
  add_wall(model, 20);
  EchoOptions options;
  options.waveforms = {3, 4};
  const trace::World world(model);
  const DynamicWorld dynamic_world(world);
  const Reflection reflection(all_of("white_target"), 905e-9);
  const Instrument instrument = quiet_instrument();
  EchoMaker maker(dynamic_world, reflection, instrument, options);
  BeamLog beams = beams_along_x(50);
  maker.answer(0, beams);
  ASSERT_EQ(maker.waveforms().size(), 4u);
  for (size_t k = 0; k < 4; ++k) {
    const BeamWaveform& w = maker.waveforms()[k];
    EXPECT_EQ(w.beam, 3 * k);
    double peak = 0, at = 0;
    for (const auto& [range, signal] : w.signal) {
      if (signal > peak) peak = signal, at = range;
    }
    EXPECT_NEAR(at, 20, 0.08);
    EXPECT_NEAR(peak, 1e6 * kRho / 400, 60);
    EXPECT_EQ(w.echo_m.size(), 1u);
  }
}

TEST(Echoes, SayWhichElementOfWhichInstanceTheyCameFrom) {
  elements::Model half, wall;
  add_sheet(half, {10, 0, -5}, {0, 10, 0}, {0, 0, 10});
  add_wall(wall, 20);
  elements::Scene scene;
  scene.models = {half, wall};
  scene.instances.resize(2);
  scene.instances[1].model = 1;
  const trace::World world(scene);
  const DynamicWorld dynamic_world(world);
  const Reflection reflection(all_of("white_target"), 905e-9);
  const Instrument instrument = quiet_instrument(8, 8);
  EchoOptions options;
  options.element_ids = true;
  options.instance_labels = {elements::Class::kSmallShrub, elements::Class::kLargeTree};
  EchoMaker maker(dynamic_world, reflection, instrument, options);
  BeamLog beams = beams_along_x(20);
  beams.direction[7] = -beams.direction[7];  // meets nothing
  maker.answer(0, beams);
  ASSERT_EQ(beams.size(), 39u);
  size_t hits = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    if (!beams.is_hit(i)) {
      EXPECT_EQ(column<uint32_t>(beams, "element")[i], trace::Intersection::kNone);
      continue;
    }
    ++hits;
    const bool far = column<uint8_t>(beams, kEchoColumn)[i] == 2;
    EXPECT_NEAR(beams.range_m[i], far ? 20 : 10, 0.02);
    EXPECT_EQ(column<uint32_t>(beams, "instance")[i], far ? 1u : 0u);
    EXPECT_LT(column<uint32_t>(beams, "element")[i], 2u);
    EXPECT_EQ(column<uint16_t>(beams, "element_class")[i], uint16_t(options.instance_labels[far]));
  }
  EXPECT_EQ(hits, 38u);
}

}  // namespace
}  // namespace underbrush::simulate
