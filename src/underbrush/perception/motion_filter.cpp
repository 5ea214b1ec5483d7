#include "underbrush/perception/motion_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {
namespace {

double square(double x) { return x * x; }
double sinc(double a) { return std::abs(a) < 1e-4 ? 1 - a * a / 6 : std::sin(a) / a; }
double sinc_slope(double a) {
  return std::abs(a) < 1e-4 ? -a / 3 : (std::cos(a) - std::sin(a) / a) / a;
}

}  // namespace

void MotionOptions::check() const {
  for (const double s : {acceleration_m_s2, yaw_acceleration_rad_s2, climb_m_s, position_m, yaw_rad,
                         start_speed_m_s, start_yaw_rate_rad_s, acceleration_time_s}) {
    require(s > 0 && std::isfinite(s), "motion: standard deviations and times must be positive");
  }
}

void MotionFilter::start(const MotionOptions& o, const Vec3& position,
                         std::optional<double> yaw_rad, double hint_rad) {
  x_ << position.x(), position.y(), yaw_rad.value_or(hint_rad), 0, 0;
  State variance;
  variance << square(o.position_m), square(o.position_m), square(yaw_rad ? o.yaw_rad : M_PI / 2),
      square(o.start_speed_m_s), square(o.start_yaw_rate_rad_s);
  p_ = variance.asDiagonal();
  z_ = position.z();
  z_variance_ = square(o.position_m);
  acceleration_ = 0;
}

void MotionFilter::predict(const MotionOptions& o, double t) {
  const double a = x_[4] * t / 2, chord = x_[3] * t * sinc(a), direction = x_[2] + a;
  const double c = std::cos(direction), s = std::sin(direction);
  // The derivative of the chord and its direction by the yaw rate.
  const double stretch = x_[3] * t * sinc_slope(a) * t / 2, sweep = chord * t / 2;
  Covariance f = Covariance::Identity();
  f(0, 2) = -chord * s;
  f(0, 3) = t * sinc(a) * c;
  f(0, 4) = stretch * c - sweep * s;
  f(1, 2) = chord * c;
  f(1, 3) = t * sinc(a) * s;
  f(1, 4) = stretch * s + sweep * c;
  f(2, 4) = t;
  Eigen::Matrix<double, 5, 2> g;
  g << t * t / 2 * std::cos(x_[2]), 0, t * t / 2 * std::sin(x_[2]), 0, 0, t * t / 2, t, 0, 0, t;
  const Eigen::Vector2d noise(square(o.acceleration_m_s2), square(o.yaw_acceleration_rad_s2));
  p_ = (f * p_ * f.transpose() + g * noise.asDiagonal() * g.transpose()).eval();
  x_[0] += chord * c;
  x_[1] += chord * s;
  x_[2] = wrapped(x_[2] + x_[4] * t);
  z_variance_ += square(o.climb_m_s * t);
}

// Joseph's form keeps the covariance positive.
template <int N>
void MotionFilter::correct(const Eigen::Matrix<double, N, 5>& h,
                           const Eigen::Matrix<double, N, 1>& residual,
                           const Eigen::Matrix<double, N, N>& noise) {
  const Eigen::Matrix<double, N, N> s = h * p_ * h.transpose() + noise;
  const Eigen::Matrix<double, 5, N> gain = s.llt().solve(h * p_).transpose();
  x_ += gain * residual;
  x_[2] = wrapped(x_[2]);
  const Covariance left = Covariance::Identity() - gain * h;
  p_ = (left * p_ * left.transpose() + gain * noise * gain.transpose()).eval();
}

void MotionFilter::update(const MotionOptions& o, const Vec3& position,
                          std::optional<double> yaw_rad, double time_s) {
  const double before = x_[3];
  Eigen::Matrix<double, 2, 5> h = Eigen::Matrix<double, 2, 5>::Zero();
  h(0, 0) = h(1, 1) = 1;
  correct<2>(h, Eigen::Vector2d(position.x() - x_[0], position.y() - x_[1]),
             square(o.position_m) * Eigen::Matrix2d::Identity());
  if (yaw_rad) {
    Eigen::Matrix<double, 1, 5> to_yaw = Eigen::Matrix<double, 1, 5>::Zero();
    to_yaw(0, 2) = 1;
    const double residual = wrapped(*yaw_rad - x_[2]);
    const double expected = 9 * (p_(2, 2) + square(o.yaw_rad));
    const double factor = std::max(1.0, square(residual) / expected);
    correct<1>(to_yaw, Eigen::Matrix<double, 1, 1>(residual),
               Eigen::Matrix<double, 1, 1>(factor * square(o.yaw_rad)));
  }
  const double gain = z_variance_ / (z_variance_ + square(o.position_m));
  z_ += gain * (position.z() - z_);
  z_variance_ *= 1 - gain;
  if (time_s > 0) {
    const double weight = time_s / (time_s + o.acceleration_time_s);
    acceleration_ += weight * ((x_[3] - before) / time_s - acceleration_);
  }
}

void MotionFilter::set_velocity(const MotionOptions& o, const Vec3& moved, double time_s,
                                bool heading_is_known) {
  const double distance = moved.head<2>().norm();
  if (!heading_is_known && distance > 2 * o.position_m) {
    x_[2] = std::atan2(moved.y(), moved.x());
    p_.row(2).setZero();
    p_.col(2).setZero();
    p_(2, 2) = square(2 * o.position_m / distance);
  }
  x_[3] = (moved.x() * std::cos(x_[2]) + moved.y() * std::sin(x_[2])) / time_s;
  p_.row(3).setZero();
  p_.col(3).setZero();
  p_(3, 3) = 2 * square(o.position_m / time_s);
}

void MotionFilter::shift(const Vec3& by) {
  x_[0] += by.x();
  x_[1] += by.y();
  z_ += by.z();
}

void MotionFilter::turn(const MotionOptions& o, int quarters) {
  x_[2] = wrapped(x_[2] + quarters * M_PI / 2);
  if (quarters % 2 == 0) {
    if (quarters % 4 != 0) {
      x_[3] = -x_[3];
      p_.row(3) = -p_.row(3);
      p_.col(3) = -p_.col(3);
      acceleration_ = -acceleration_;
    }
    return;
  }
  x_[3] = acceleration_ = 0;
  p_.row(3).setZero();
  p_.col(3).setZero();
  p_(3, 3) = square(o.start_speed_m_s);
}

Vec3 MotionFilter::velocity_m_s() const {
  return {x_[3] * std::cos(x_[2]), x_[3] * std::sin(x_[2]), 0};
}

Vec3 MotionFilter::acceleration_m_s2() const {
  const double c = std::cos(x_[2]), s = std::sin(x_[2]), across = x_[3] * x_[4];
  return {acceleration_ * c - across * s, acceleration_ * s + across * c, 0};
}

}  // namespace underbrush::perception
