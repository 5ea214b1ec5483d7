/// \file
/// This file has the Kalman filter of an object's motion.
#pragma once
#include <Eigen/Core>
#include <optional>

#include "underbrush/core/pose.hpp"

namespace underbrush::perception {

/// The options of `MotionFilter`. All but the last are standard deviations.
struct MotionOptions {
  double acceleration_m_s2 = 2;  ///< Process noise: acceleration outside the motion model.
  double yaw_acceleration_rad_s2 = 1;
  double climb_m_s = 0.2;       ///< The vertical speed.
  double position_m = 0.1;      ///< A measured position.
  double yaw_rad = 0.05;        ///< A measured heading.
  double start_speed_m_s = 10;  ///< The speed of an object that was measured once.
  double start_yaw_rate_rad_s = 0.3;
  double acceleration_time_s = 0.5;  ///< Time over which the reported acceleration is smoothed.

  /// Throws `std::invalid_argument` where a value is not positive.
  void check() const;
};

/// An extended Kalman filter of constant turn rate and velocity (CTRV). Its state is x, y (m), yaw
/// (rad), speed (m/s, negative for a drive backwards), and yaw rate (rad/s). The height has a
/// filter of its own, of constant position.
///
/// In a time t the object moves along the chord v t sinc(ω t / 2) in the direction ψ + ω t / 2,
/// which is exact for constant v and ω.
class MotionFilter {
 public:
  using State = Eigen::Matrix<double, 5, 1>;
  using Covariance = Eigen::Matrix<double, 5, 5>;

  /// Begins at a measured position. Without a heading `hint_rad` is taken, with a σ of a quarter
  /// turn.
  void start(const MotionOptions& options, const Vec3& position, std::optional<double> yaw_rad,
             double hint_rad);
  /// Moves the state by `time_s` ≥ 0.
  void predict(const MotionOptions& options, double time_s);
  /// Takes a measured position, and the heading if there is one. `time_s` is the time since the
  /// last update. A heading that is farther off than three standard deviations counts less.
  void update(const MotionOptions& options, const Vec3& position, std::optional<double> yaw_rad,
              double time_s);
  /// Sets the velocity from the difference `moved` (m) of two positions `time_s` apart.
  void set_velocity(const MotionOptions& options, const Vec3& moved, double time_s,
                    bool heading_is_known);
  /// Moves the position without a change of its covariance, when another point is tracked.
  void shift(const Vec3& by);
  /// Turns the heading by k quarter turns. For an odd k the speed is forgotten.
  void turn(const MotionOptions& options, int quarters);

  const State& state() const { return x_; }
  const Covariance& covariance() const { return p_; }
  Vec3 position_m() const { return {x_[0], x_[1], z_}; }
  double yaw_rad() const { return x_[2]; }
  double speed_m_s() const { return x_[3]; }
  double yaw_rate_rad_s() const { return x_[4]; }
  Vec3 velocity_m_s() const;
  /// The smoothed change of the speed along the heading, and v ω across it.
  Vec3 acceleration_m_s2() const;
  /// The variance of the height, m².
  double height_variance_m2() const { return z_variance_; }

 private:
  template <int N>
  void correct(const Eigen::Matrix<double, N, 5>& h, const Eigen::Matrix<double, N, 1>& residual,
               const Eigen::Matrix<double, N, N>& noise);

  State x_ = State::Zero();
  Covariance p_ = Covariance::Identity();
  double z_ = 0, z_variance_ = 1, acceleration_ = 0;
};

}  // namespace underbrush::perception
