/// \file
/// The lidar equation in watts, sunlight, noise: what sets the signal-to-noise ratio of a sensor
/// whose optics are known.
#pragma once

namespace underbrush::radiometry {

/// Transmitter, optics and detector of a lidar: what its link budget is computed from.
struct LinkBudget {
  double peak_power_w = 25;
  double aperture_m = 0.025;  ///< Diameter D of the receiver.
  double transmission = 0.5;  ///< η_t η_r of the optics, out and back.
  double wavelength_m = 905e-9;
  double view_rad = 0.003;            ///< Full angle of the receiver's field of view.
  double filter_m = 20e-9;            ///< Width of the optical filter.
  double responsivity_a_per_w = 0.5;  ///< Of the detector.
  double bandwidth_hz = 200e6;
  double dark_a_per_rt_hz = 2e-12;  ///< Noise of the dark detector and its amplifier.

  /// Throws `std::invalid_argument` unless all are positive and finite.
  void check() const;
};

/// Peak power at the detector (W) from a target that fills a share `fill` of the beam:
/// P_t · fill · factor · D² / (4 R²) · η · e^{−2αR}, factor = reflectance × backscatter (1 = white,
/// Lambertian, perpendicular). R > 0.
double received_power_w(const LinkBudget& link, double range_m, double factor, double fill,
                        double extinction_per_m);

/// Spectral irradiance of the sun above the atmosphere, W/m² per m: a black body of 5772 K over
/// 6.79·10⁻⁵ sr (Planck).
double solar_irradiance(double wavelength_m);

/// Sunlight at the detector (W) from a Lambertian scene of this reflectance that fills the view,
/// `share` of the irradiance above the atmosphere arriving: E ρ/π · Ω · π D²/4 · η_r · Δλ, with
/// half of the losses on the way back (η_r = √η).
double solar_background_w(const LinkBudget& link, double reflectance, double share);

/// Noise as power at the detector (W, σ): √((i_dark² + 2 q 𝓡 P) B) / 𝓡 with background P (shot
/// noise).
double noise_power_w(const LinkBudget& link, double background_w);

/// How much sunlight raises the noise: `noise_power_w` over that in the dark, ≥ 1. For
/// `ReceiverOptions::noise_sigma`.
double noise_in_light(const LinkBudget& link, double background_w);

/// Signal-to-noise ratio in the dark of a white Lambertian perpendicular target at 1 m. For
/// `ReceiverOptions::signal_at_1m`.
double signal_at_1m(const LinkBudget& link);

/// Extinction of haze and fog (1/m) by the visibility V: 3.912/V · (λ/550 nm)^−q with q = 1.6
/// beyond 50 km, 1.3 to 6 km, 0.16 V + 0.34 to 1 km, V − 0.5 to 0.5 km (V in km), 0 below
/// ([kim01]).
double fog_extinction_per_m(double visibility_m, double wavelength_m);

/// Extinction of rain (1/m) at a rate in mm/h: 1.076 rate^0.67 dB/km ([carbonneau98]).
double rain_extinction_per_m(double rate_mm_per_h);

}  // namespace underbrush::radiometry
