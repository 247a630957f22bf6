#include "physics/materials/hencky.h"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace sluice::hencky {

namespace {

/// J = V / V_0, setting V_0 of a point that comes for the first time.
double volume_ratio(double volume, double& initial_volume) {
  if (initial_volume == 0) initial_volume = volume;
  return volume / initial_volume;
}

/// A symmetric 2 x 2 tensor.
struct Symmetric {
  double xx, yy, xy;
};

/// mean + share * (deviator of a): the form of every isotropic function of a.
Symmetric isotropic(const Symmetric& a, double mean, double share) {
  const double half = 0.5 * (a.xx - a.yy) * share;
  return {mean + half, mean - half, share * a.xy};
}

Symmetric exponential(const Symmetric& a) {
  const double centre = 0.5 * (a.xx + a.yy), radius = std::hypot(0.5 * (a.xx - a.yy), a.xy);
  const double scale = std::exp(centre);
  return isotropic(a, scale * std::cosh(radius), scale * (radius > 0 ? std::sinh(radius) / radius : 1));
}

Symmetric logarithm(const Symmetric& a) {
  const double centre = 0.5 * (a.xx + a.yy), radius = std::hypot(0.5 * (a.xx - a.yy), a.xy);
  const double slope = radius > 0 ? std::atanh(radius / centre) / radius : 1 / centre;
  return isotropic(a, 0.5 * (std::log(centre + radius) + std::log(centre - radius)), slope);
}

Eigen::Matrix3d function_of(const Eigen::Matrix3d& a, double (*function)(double)) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(a);
  return principal.eigenvectors() * principal.eigenvalues().unaryExpr(function).asDiagonal() *
         principal.eigenvectors().transpose();
}

}  // namespace

void begin(std::size_t n, const std::array<double*, 4>& stress, const std::array<double*, 4>& strain,
           const std::array<const double*, 1>& rotation, const double* volume, double* initial_volume,
           const IsotropicElasticity& elasticity) {
  const double compliance = 1 / (2 * elasticity.shear);
  const double share = elasticity.lambda / (3 * elasticity.lambda + 2 * elasticity.shear);
  for (std::size_t p = 0; p < n; ++p) {
    const double ratio = volume_ratio(volume[p], initial_volume[p]);
    for (double* const column : stress) column[p] *= ratio;
    const double trace = share * (stress[0][p] + stress[1][p] + stress[2][p]);
    const Symmetric elastic = {compliance * (stress[0][p] - trace), compliance * (stress[1][p] - trace),
                               compliance * stress[3][p]};
    const Symmetric b = exponential({2 * elastic.xx, 2 * elastic.yy, 2 * elastic.xy});

    // f = (I - A)^-1 (I + A) with A half the increment of the displacement gradient (24b); f - I = 2 (I - A)^-1 A.
    const double xx = 0.5 * strain[0][p], yy = 0.5 * strain[1][p];
    const double xy = 0.5 * (strain[3][p] - rotation[0][p]), yx = 0.5 * (strain[3][p] + rotation[0][p]);
    const double inverse = 2 / ((1 - xx) * (1 - yy) - xy * yx);
    const double fxx = 1 + inverse * ((1 - yy) * xx + xy * yx), fxy = inverse * xy;
    const double fyx = inverse * yx, fyy = 1 + inverse * ((1 - xx) * yy + xy * yx);
    const double gxx = fxx * b.xx + fxy * b.xy, gxy = fxx * b.xy + fxy * b.yy;
    const double gyx = fyx * b.xx + fyy * b.xy, gyy = fyx * b.xy + fyy * b.yy;
    const Symmetric trial = logarithm({gxx * fxx + gxy * fxy, gyx * fyx + gyy * fyy, gxx * fyx + gxy * fyy});

    strain[0][p] = 0.5 * trial.xx - elastic.xx;
    strain[1][p] = 0.5 * trial.yy - elastic.yy;
    strain[3][p] = 0.5 * trial.xy - elastic.xy;
  }
}

void begin(std::size_t n, const std::array<double*, 6>& stress, const std::array<double*, 6>& strain,
           const std::array<const double*, 3>& rotation, const double* volume, double* initial_volume,
           const IsotropicElasticity& elasticity) {
  const double compliance = 1 / (2 * elasticity.shear);
  const double share = elasticity.lambda / (3 * elasticity.lambda + 2 * elasticity.shear);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const auto symmetric = [](const std::array<double*, 6>& t, std::size_t p) {
    Eigen::Matrix3d m;
    m << t[0][p], t[3][p], t[5][p], t[3][p], t[1][p], t[4][p], t[5][p], t[4][p], t[2][p];
    return m;
  };
  for (std::size_t p = 0; p < n; ++p) {
    const double ratio = volume_ratio(volume[p], initial_volume[p]);
    for (double* const column : stress) column[p] *= ratio;
    const Eigen::Matrix3d tau = symmetric(stress, p);
    const double xy = rotation[0][p], yz = rotation[1][p], xz = rotation[2][p];
    Eigen::Matrix3d spin;
    spin << 0, xy, xz, -xy, 0, yz, -xz, -yz, 0;
    const Eigen::Matrix3d half = 0.5 * (symmetric(strain, p) + spin);
    if (!tau.allFinite() || !half.allFinite()) continue;  // left for the guard of the time loop to find
    const Eigen::Matrix3d elastic = compliance * (tau - share * tau.trace() * one);
    const Eigen::Matrix3d f = (one - half).inverse() * (one + half);
    const Eigen::Matrix3d b = f * function_of(2 * elastic, [](double x) { return std::exp(x); }) * f.transpose();
    const Eigen::Matrix3d change = 0.5 * function_of(b, [](double x) { return std::log(x); }) - elastic;
    strain[0][p] = change(0, 0);
    strain[1][p] = change(1, 1);
    strain[2][p] = change(2, 2);
    strain[3][p] = change(1, 0);
    strain[4][p] = change(2, 1);
    strain[5][p] = change(2, 0);
  }
}

}  // namespace sluice::hencky
