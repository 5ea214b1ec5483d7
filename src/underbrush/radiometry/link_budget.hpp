/// \file
/// This file computes the signal-to-noise ratio of a sensor whose optics are known, from the lidar
/// equation in watts, sunlight and noise.
#pragma once

namespace underbrush::radiometry {

/// The transmitter, optics and detector of a lidar.
struct LinkBudget {
  double peak_power_w = 25;
  double aperture_m = 0.025;  ///< Diameter D of the receiver.
  double transmission = 0.5;  ///< η_t η_r of the optics, out and back.
  double wavelength_m = 905e-9;
  double view_rad = 0.003;            ///< Full angle of the receiver's field of view.
  double filter_m = 20e-9;            ///< Width of the optical filter.
  double responsivity_a_per_w = 0.5;  ///< The detector's own responsivity.
  double bandwidth_hz = 200e6;
  double dark_a_per_rt_hz = 2e-12;  ///< Noise of the dark detector and its amplifier.

  /// Throws `std::invalid_argument` unless all values are positive and finite.
  void check() const;
};

/// Computes the peak power at the detector (W) from a target that fills a share `fill` of the beam:
/// P_t · fill · factor · D² / (4 R²) · η · e^{−2αR}. `factor` is reflectance × backscatter, 1 for a
/// white, Lambertian, perpendicular target; R = `range_m` > 0.
double received_power_w(const LinkBudget& link, double range_m, double factor, double fill,
                        double extinction_per_m);

/// Computes the spectral irradiance of the sun above the atmosphere, W/m² per m, as a black body of
/// 5772 K over 6.79·10⁻⁵ sr (Planck's law).
double solar_irradiance(double wavelength_m);

/// Computes the sunlight at the detector (W) from a Lambertian scene of this reflectance ρ that
/// fills the field of view: E ρ/π · Ω · π D²/4 · η_r · Δλ. E is `share` of the irradiance above the
/// atmosphere. Half of the optical losses are on the way back, η_r = √η.
double solar_background_w(const LinkBudget& link, double reflectance, double share);

/// Computes the noise as power at the detector (W, σ): √((i_dark² + 2 q 𝓡 P) B) / 𝓡 with the
/// background P = `background_w`, whose noise is shot noise.
double noise_power_w(const LinkBudget& link, double background_w);

/// Computes the ratio of the noise in sunlight to the noise in the dark, ≥ 1, for
/// `ReceiverOptions::noise_sigma`.
double noise_in_light(const LinkBudget& link, double background_w);

/// Computes the signal-to-noise ratio in the dark of a white, Lambertian, perpendicular target at 1
/// m, for `ReceiverOptions::signal_at_1m`.
double signal_at_1m(const LinkBudget& link);

/// Computes the extinction of haze and fog (1/m) from the visibility V (m) [kim01]: 3.912/V ·
/// (λ/550 nm)^−q. With V in km, q is 1.6 beyond 50 km, 1.3 down to 6 km, 0.16 V + 0.34 down to 1
/// km, V − 0.5 down to 0.5 km, and 0 below.
double fog_extinction_per_m(double visibility_m, double wavelength_m);

/// Computes the extinction of rain (1/m) from its rate in mm/h: 1.076 rate^0.67 dB/km
/// [carbonneau98].
double rain_extinction_per_m(double rate_mm_per_h);

}  // namespace underbrush::radiometry
