#include "underbrush/compact/chunk.hpp"

#include <gtest/gtest.h>

#include "logs.hpp"
#include "underbrush/compact/track.hpp"

namespace underbrush::compact {
namespace {

BeamLog back_from(std::string_view bytes, const BeamLog& log) {
  BeamLog out = log.like();
  out.resize(log.size());
  Scratch scratch;
  Cursor in(bytes, kFile, kPlace);
  decode(in, log.size(), scratch, out, 0);
  EXPECT_THROW(in.require(1), FormatError);  // every byte was read
  return out;
}

std::string bytes_of(const BeamLog& log) {
  Scratch scratch;
  return encoded(log, log.info.scans, 0, log.size(), scratch);
}

double bytes_a_beam(const BeamLog& log) {
  const std::string bytes = bytes_of(log);
  expect_same_bits(log, back_from(bytes, log));
  return double(bytes.size()) / double(log.size());
}

TEST(Chunk, EveryBitComesBack) {
  for (const size_t n : {1, 2, 7, 100, 3000}) {
    for (const bool extra : {false, true}) bytes_a_beam(random_log(n, n, extra));
  }
  bytes_a_beam(scanned_log(20000));
  bytes_a_beam(scanned_log(40000, true));
}

// Whatever no sensor measures: numbers that are none, both zeros, infinities, denormal ones.
TEST(Chunk, EveryBitOfOddValuesComesBack) {
  BeamLog log = scanned_log(4096);
  log.extra["g"] = std::vector<float>(log.size());
  log.extra["h"] = std::vector<double>(log.size());
  Stream random(1);
  const auto odd = [&](auto& x) {
    using T = std::decay_t<decltype(x)>;
    const T values[] = {T(NAN),   -T(NAN), T(INFINITY), -T(INFINITY),
                        T(-0.0),  T(0),    T(1e-42),    std::numeric_limits<T>::denorm_min(),
                        T(3.4e38)};
    x = values[random.below(std::size(values))];
    if (random.uniform() < 0.3) reinterpret_cast<uint8_t&>(x) ^= 0x55;  // a payload
  };
  for (size_t k = 0; k < log.size(); k += 5) {
    odd(log.origin[k][Eigen::Index(k % 3)]);
    odd(log.direction[k][Eigen::Index(k % 3)]);
    odd(log.range_m[k]);
    odd(log.intensity[k]);
    odd(std::get<std::vector<float>>(log.extra["g"])[k]);
    odd(std::get<std::vector<double>>(log.extra["h"])[k]);
  }
  bytes_a_beam(log);
}

// Times, origins and directions of a known pattern are predicted to the bit, so that ranges (2
// bytes of noise) and intensities (7 bits) remain.
TEST(Chunk, AScanPatternTakesNextToNothing) {
  for (const bool ring_by_ring : {false, true}) {
    BeamLog log = scanned_log(65536, ring_by_ring);
    EXPECT_LT(bytes_a_beam(log), 3.2);
    std::fill(log.range_m.begin(), log.range_m.end(), kMiss);
    std::fill(log.intensity.begin(), log.intensity.end(), 0.0f);
    EXPECT_LT(bytes_a_beam(log), 0.6);
  }
}

// Without poses the origins are stored, and the turning of the car is left in the directions.
TEST(Chunk, WithoutPosesAPatternTakesMore) {
  BeamLog log = scanned_log(65536);
  log.info.scans.clear();
  EXPECT_LT(bytes_a_beam(log), 8);
}

// An organised scan whose beams have one time goes by the number of the beam.
TEST(Chunk, AzimuthsMayGoByNumber) {
  BeamLog log = scanned_log(32000, true, true);
  const double timed = bytes_a_beam(log);
  log.time_s.assign(log.size(), 4.0);
  EXPECT_LT(bytes_a_beam(log), timed);
}

TEST(Track, PositionsAreThoseOfTheTrajectory) {
  const BeamLog log = scanned_log(200'000);
  std::vector<StampedPose> poses;
  for (const ScanInfo& s : log.info.scans) poses.push_back({s.time_s, s.world_from_sensor});
  const Trajectory trajectory(poses);
  Stream random(4);
  for (int k = 0; k < 2000; ++k) {
    const double first = random.uniform(4.95, 5.65), last = first + random.uniform(0, 0.2);
    const Track whole(log.info.scans, first, last);
    std::string bytes;
    whole.append_to(bytes);
    Cursor in(bytes, kFile, kPlace);
    const Track track = Track::read(in);
    const double t = random.uniform(first, last);
    const Pose pose = *trajectory.at(t);
    const Place place = track.at(t);
    ASSERT_EQ(Vec3(place.position.x, place.position.y, place.position.z), pose.translation);
    const Eigen::Quaterniond turn(place.turn.w, place.turn.x, place.turn.y, place.turn.z);
    ASSERT_LT(turn.angularDistance(pose.rotation), 1e-7);
  }
}

TEST(Chunk, DamageIsRefusedOrHarmless) {
  for (const BeamLog& log : {random_log(8, 200), scanned_log(2000)}) {
    const std::string whole = bytes_of(log);
    Stream random(6);
    size_t refused = 0;
    for (int k = 0; k < 2000; ++k) {
      std::string bytes = whole;
      for (int flips = 0; flips < 3; ++flips) {
        bytes[size_t(random.below(bytes.size()))] = char(random.below(256));
      }
      if (k % 3 == 0) bytes.resize(size_t(random.below(bytes.size())));
      BeamLog out = log.like();
      out.resize(log.size());
      Scratch scratch;
      try {
        Cursor in(bytes, kFile, kPlace);
        decode(in, log.size(), scratch, out, 0);
      } catch (const FormatError& e) {
        EXPECT_EQ(e.place(), kPlace);
        ++refused;
      }
    }
    EXPECT_GT(refused, 500u);
  }
}

}  // namespace
}  // namespace underbrush::compact
