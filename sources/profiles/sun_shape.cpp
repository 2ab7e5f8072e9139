#include "sources/profiles/sun_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numerics/adaptive_quadrature.h"
#include "core/numerics/root.h"

namespace photorque {

SunShape::SunShape(std::vector<RadialPiece> pieces)
    : pieces_(std::move(pieces)), sampler_(pieces_) {
  // Integrates 1 − cos θ, which is small and keeps its precision, instead of cos θ.
  double flux = 0.0, missing = 0.0;
  for (const RadialPiece& piece : pieces_) {
    constexpr double relative = 1e-11;
    const double width_rad = piece.to_rad - piece.from_rad;
    const double scale = piece.to_rad * width_rad *
                         std::max(piece.intensity(piece.from_rad), piece.intensity(piece.to_rad));
    const auto integral = [&](const auto& weight, double unit) {
      return integrate_adaptively(
                 [&](double angle_rad) {
                   return weight(angle_rad) * piece.intensity(angle_rad) * std::sin(angle_rad);
                 },
                 piece.from_rad, piece.to_rad, relative * unit * scale)
          .value;
    };
    flux += integral([](double) { return 1.0; }, 1.0);
    missing += integral(rise_at, rise_at(piece.to_rad));
    largest_ = std::max({largest_, piece.intensity(piece.from_rad), piece.intensity(piece.to_rad)});
  }
  mean_cosine_ = 1.0 - missing / flux;
}

double SunShape::radiance(double angle_rad) const {
  const auto piece =
      std::lower_bound(pieces_.begin(), pieces_.end(), angle_rad,
                       [](const RadialPiece& one, double angle) { return one.to_rad < angle; });
  return piece == pieces_.end() ? 0.0 : piece->intensity(angle_rad) / largest_;
}

std::vector<double> SunShape::edges_rad() const {
  std::vector<double> edges;
  for (const RadialPiece& piece : pieces_) edges.push_back(piece.to_rad);
  return edges;
}

SunShape limb_darkened_disc(double angular_radius_rad, double u1, double u2) {
  const double sine2 = std::sin(angular_radius_rad) * std::sin(angular_radius_rad);
  const auto radiance = [=](double angle_rad) {
    const double sine = std::sin(angle_rad);
    const double depth = 1.0 - std::sqrt(std::max(0.0, 1.0 - sine * sine / sine2));
    return 1.0 - u1 * depth - u2 * depth * depth;
  };
  // The slope is infinite at the edge, so the pieces become smaller towards it.
  std::vector<RadialPiece> pieces;
  double from_rad = 0.0;
  for (double cosine = 0.5; cosine > 0.03; cosine *= 0.5) {
    const double to_rad = std::asin(std::sqrt((1.0 - cosine * cosine) * sine2));
    pieces.push_back({from_rad, to_rad, radiance});
    from_rad = to_rad;
  }
  pieces.push_back({from_rad, angular_radius_rad, radiance});
  return SunShape(std::move(pieces));
}

SunShape gaussian_sun(double sigma_rad) {
  constexpr double reach = 6.0;
  return SunShape({{0.0, reach * sigma_rad, [sigma_rad](double angle_rad) {
                      const double part = angle_rad / sigma_rad;
                      return std::exp(-0.5 * part * part);
                    }}});
}

namespace {

// κ and γ of Buie's aureole for a given χ.
struct BuieAureole {
  explicit BuieAureole(double chi)
      : kappa(0.9 * std::log(13.5 * chi) * std::pow(chi, -0.3)),
        gamma(2.2 * std::log(0.52 * chi) * std::pow(chi, 0.43) - 0.1) {}

  // Radiance at `angle` [mrad].
  double operator()(double angle) const { return std::exp(kappa + gamma * std::log(angle)); }

  double kappa, gamma;
};

double buie_disc(double angle) {
  return std::cos(0.326 * angle) / std::cos(0.308 * angle);
}

}  // namespace

SunShape buie_sun(double circumsolar_ratio) {
  constexpr double disc = 4.65, end = 43.6;  // mrad
  constexpr double mrad = 1e-3;
  // Fluxes in mrad². For these small angles sin θ equals θ to 1e-3.
  const auto flux = [](const auto& radiance, double low, double high) {
    return integrate_adaptively(
               [&](double angle) { return radiance(angle) * std::sin(mrad * angle) / mrad; }, low,
               high, 1e-13)
        .value;
  };
  const double of_disc = flux(buie_disc, 0.0, disc);
  const auto falls_short = [&](double chi) {
    const double of_aureole = flux(BuieAureole(chi), disc, end);
    return of_aureole < circumsolar_ratio * (of_disc + of_aureole);
  };
  // The ratio rises with χ, from 8e-6 to 0.85.
  const BuieAureole aureole(bisect(0.005, 0.9, falls_short, {60}).low);
  return SunShape({{0.0, mrad * disc, [](double angle_rad) { return buie_disc(angle_rad / mrad); }},
                   {mrad * disc, mrad * end,
                    [aureole](double angle_rad) { return aureole(angle_rad / mrad); }}});
}

SunShape tabulated_sun(const std::vector<double>& angle_rad, const std::vector<double>& radiance) {
  std::vector<RadialPiece> pieces;
  for (size_t i = 0; i + 1 < angle_rad.size(); ++i) {
    const double from_rad = angle_rad[i], width_rad = angle_rad[i + 1] - from_rad;
    const double low = radiance[i], high = radiance[i + 1];
    pieces.push_back({from_rad, angle_rad[i + 1], [=](double at_rad) {
                        return low + (high - low) * std::min(1.0, (at_rad - from_rad) / width_rad);
                      }});
  }
  return SunShape(std::move(pieces));
}

}  // namespace photorque
