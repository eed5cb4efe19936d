// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/materials/mohr_coulomb.h>

namespace greville
{
  using namespace dealii;

  void
  MohrCoulomb::declare(ParameterHandler &prm)
  {
    HenckyPlasticity<MohrCoulomb>::declare(prm);
    using Patterns::Double;
    add_parameter(prm, "Cohesion", cohesion, Double(0.))(
      "Peak cohesion, Kirchhoff stress. Unit: Pa.");
    add_parameter(prm, "Residual cohesion", residual_cohesion, Double())(
      "Cohesion after softening; negative: the peak. Unit: Pa.");
    add_parameter(prm, "Friction angle", friction_angle, Double(0., 89.))(
      "Peak angle of internal friction. Unit: degrees.");
    add_parameter(prm,
                  "Residual friction angle",
                  residual_friction_angle,
                  Double(-90., 89.))(
      "Friction angle after softening; negative: the peak. Unit: degrees.");
    add_parameter(prm, "Dilatancy angle", dilatancy_angle, Double(0., 89.))(
      "Angle of dilatancy, at most the residual friction angle. Unit: "
      "degrees.");
    add_choice<bool>(prm,
                     "Softening",
                     exponential,
                     {{false, "linear"}, {true, "exponential"}})(
      "Decrease of cohesion and friction angle with plastic strain.");
    add_parameter(prm, "Softening strain", softening_strain, positive())(
      "Equivalent plastic strain at which linear softening ends, or over which "
      "exponential softening falls by the factor e. Unit: none.");
    reduction_of_strength.declare(prm);
  }



  void
  MohrCoulomb::reinit(const std::string &section)
  {
    HenckyPlasticity<MohrCoulomb>::reinit(section);
    last_cohesion = residual_cohesion < 0. ? cohesion : residual_cohesion;
    last_angle =
      residual_friction_angle < 0. ? friction_angle : residual_friction_angle;
    check_parameter(last_cohesion <= cohesion,
                    section,
                    "Residual cohesion",
                    last_cohesion,
                    "at most the peak cohesion, which is " + text_of(cohesion));
    check_parameter(last_angle <= friction_angle,
                    section,
                    "Residual friction angle",
                    last_angle,
                    "at most the peak friction angle, which is " +
                      text_of(friction_angle));
    check_parameter(dilatancy_angle <= last_angle,
                    section,
                    "Dilatancy angle",
                    dilatancy_angle,
                    "at most the (residual) friction angle, which is " +
                      text_of(last_angle));
    check_parameter(last_cohesion > 0. || last_angle > 0.,
                    section,
                    "Residual cohesion",
                    last_cohesion,
                    "greater than 0 if the residual friction angle is 0");
    softens = last_cohesion < cohesion || last_angle < friction_angle;
    reduction_of_strength.reinit(section);
    peak = make_surface(0., 1.);
  }



  MohrCoulomb::Surface
  MohrCoulomb::make_surface(const double alpha, const double reduction) const
  {
    const double x    = alpha / softening_strain;
    const double part = exponential ? std::exp(-x) : std::max(1. - x, 0.);
    const double c =
      (last_cohesion + (cohesion - last_cohesion) * part) / reduction;
    const double phi = StrengthReduction::reduced_angle(
      last_angle + (friction_angle - last_angle) * part, reduction);
    const double psi =
      std::min(StrengthReduction::reduced_angle(dilatancy_angle, 1.),
               StrengthReduction::reduced_angle(last_angle, reduction));
    const double sine = std::sin(phi), cosine = std::cos(phi);
    return {sine,
            2. * c * cosine,
            sine > 0. ? c * cosine / sine : 0.,
            std::sin(psi)};
  }



  MohrCoulomb::Surface
  MohrCoulomb::slope_of_surface(const double alpha,
                                const double reduction) const
  {
    if (!softens)
      return {0., 0., 0., 0.};
    const double x     = alpha / softening_strain;
    const double part  = exponential ? std::exp(-x) : std::max(1. - x, 0.);
    const double slope = (exponential ? -part
                          : part > 0. ? -1.
                                      : 0.) /
                         softening_strain;
    const double degree = numbers::PI / 180.;
    const double c =
      (last_cohesion + (cohesion - last_cohesion) * part) / reduction;
    const double change_of_c = (cohesion - last_cohesion) * slope / reduction;
    // tan(phi) = tan(full) / r: phi' = full' r / (r^2 cos^2 + sin^2).
    const double full =
      degree * (last_angle + (friction_angle - last_angle) * part);
    const double phi = std::atan(std::tan(full) / reduction);
    const double a = reduction * std::cos(full), b = std::sin(full);
    const double change_of_phi = degree * (friction_angle - last_angle) *
                                 slope * reduction / (a * a + b * b);
    const double sine = std::sin(phi), cosine = std::cos(phi);
    // The change of c cos(phi).
    const double change = change_of_c * cosine - c * sine * change_of_phi;
    return {cosine * change_of_phi,
            2. * change,
            sine > 0.
              ? (change - c * cosine * cosine / sine * change_of_phi) / sine
              : 0.,
            0.};
  }



  void
  MohrCoulomb::differentiate_return(const Principal &t,
                                    const Surface   &s,
                                    const Surface   &slope,
                                    double (&by_trial)[3][3],
                                    Principal &by_parameter) const
  {
    // The names are the same as in returned().
    Region region;
    returned(t, s, &region);
    const double K = elastic.bulk, G = elastic.shear;
    const double phi = s.sine, psi = s.sin_dilatancy;
    const double upper  = 2. * G * (1. + psi / 3.) + 2. * K * psi,
                 lower  = 2. * G * (1. - psi / 3.) - 2. * K * psi,
                 middle = (4. / 3. * G - 2. * K) * psi;
    const double a      = 4. * G * (1. + phi * psi / 3.) + 4. * K * phi * psi;
    const double change_of_a = (4. / 3. * G + 4. * K) * psi * slope.sine;
    const bool   right       = region == Region::right;

    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        by_trial[i][j] = (i == j && region != Region::apex) ? 1. : 0.;
    by_parameter.fill(slope.apex);
    if (region == Region::apex)
      return;

    // The derivatives of f, of the first plane, and f2, of the second plane, by
    // t[0], t[1], t[2] and the parameter.
    const double by_larger = 1. + phi, by_smaller = phi - 1.;
    double       f[]   = {by_larger,
                          0.,
                          by_smaller,
                          (t[0] + t[2]) * slope.sine - slope.strength};
    double       f2[4] = {};
    double       b     = 0.;
    if (region == Region::plane)
      f[3] -= s.f(t[0], t[2]) / a * change_of_a;
    else
      {
        const unsigned int larger = right ? 0 : 1, smaller = right ? 1 : 2;
        f2[larger]  = by_larger;
        f2[smaller] = by_smaller;
        f2[3]       = (t[larger] + t[smaller]) * slope.sine - slope.strength;
        const double sign = right ? 1. : -1.;
        b = 2. * G * (1. + sign * (phi + psi) - phi * psi / 3.) +
            4. * K * phi * psi;
        const double change_of_b =
          (2. * G * (sign - psi / 3.) + 4. * K * psi) * slope.sine;
        const double v = s.f(t[0], t[2]), v2 = s.f(t[larger], t[smaller]);
        const double determinant = (a - b) * (a + b);
        const double g1          = (a * v - b * v2) / determinant,
                     g2          = (a * v2 - b * v) / determinant;
        f[3] -= change_of_a * g1 + change_of_b * g2;
        f2[3] -= change_of_b * g1 + change_of_a * g2;
      }

    const double determinant = (a - b) * (a + b);
    by_parameter.fill(0.);
    for (unsigned int j = 0; j < 4; ++j)
      {
        const double g1 = (a * f[j] - b * f2[j]) / determinant,
                     g2 = region == Region::plane
                            ? 0.
                            : (a * f2[j] - b * f[j]) / determinant;
        Principal change;
        if (region == Region::left)
          change = {{middle * g2 - upper * g1,
                     middle * g1 - upper * g2,
                     lower * (g1 + g2)}};
        else
          change = {{-upper * (g1 + g2),
                     middle * g1 + lower * g2,
                     lower * g1 + middle * g2}};
        for (unsigned int i = 0; i < 3; ++i)
          (j < 3 ? by_trial[i][j] : by_parameter[i]) += change[i];
      }
    // The two stresses that meet at an edge are equal.
    if (region != Region::plane)
      {
        const unsigned int i = right ? 1 : 0;
        for (unsigned int j = 0; j < 3; ++j)
          by_trial[i][j] = by_trial[i + 1][j] =
            0.5 * (by_trial[i][j] + by_trial[i + 1][j]);
        by_parameter[i] = by_parameter[i + 1] =
          0.5 * (by_parameter[i] + by_parameter[i + 1]);
      }
  }



  double
  MohrCoulomb::opening_at_apex(const Principal &trial,
                               const double     apex,
                               const double     m) const
  {
    const double mean  = mean_of(trial);
    const double right = (trial[0] - mean) / (1. + m / 3.),
                 left  = (mean - trial[2]) / (1. - m / 3.);
    return std::max((mean - apex) / elastic.bulk -
                      m * std::max(right, left) / elastic.shear,
                    0.);
  }



  Principal
  MohrCoulomb::soften(const Principal &trial,
                      const double     growth,
                      const double     reduction,
                      double          &alpha) const
  {
    const double mean  = mean_of(trial);
    const double range = equivalent_strain(trial, {{mean, mean, mean}});
    double       low = alpha, high = alpha + range;
    double       x_old = alpha, h_old = growth;
    double       x = alpha + std::min(growth, range);
    Principal    result;
    for (unsigned int i = 0;; ++i)
      {
        result         = returned(trial, surface_at(x, reduction));
        const double h = alpha + equivalent_strain(trial, result) - x;
        if (std::abs(h) <= 1e-15 * range + 2e-16 * x || i == 100)
          break;
        (h > 0. ? low : high) = x;
        if (!(high - low > 4e-16 * high))
          break;
        double next = x - h * (x - x_old) / (h - h_old);
        if (!(next > low && next < high) || i % 8 == 7)
          next = 0.5 * (low + high);
        x_old = x;
        h_old = h;
        x     = next;
      }
    alpha = x;
    return result;
  }



  void
  MohrCoulomb::differentiate(ReturnTangent                     &tangent,
                             const Principal                   &trial,
                             const Principal                   &result,
                             const double                       alpha,
                             const double                       reduction,
                             const bool                         grows,
                             const std::array<unsigned int, 3> &order) const
  {
    double    by_trial[3][3];
    Principal by_alpha;
    differentiate_return(trial,
                         surface_at(alpha, reduction),
                         slope_of_surface(alpha, reduction),
                         by_trial,
                         by_alpha);
    if (softens && grows)
      {
        // d alpha = v (d trial - d result) with the derivatives v of
        // equivalent_strain().
        Principal    v;
        const double mean   = mean_of(trial) - mean_of(result);
        double       square = 0., change = 0.;
        for (unsigned int i = 0; i < 3; ++i)
          {
            v[i] = trial[i] - result[i] - mean;
            square += v[i] * v[i];
          }
        for (unsigned int i = 0; i < 3; ++i)
          {
            v[i] /= std::sqrt(6. * square) * elastic.shear;
            change += v[i] * by_alpha[i];
          }
        Principal alpha_by_trial;
        for (unsigned int j = 0; j < 3; ++j)
          alpha_by_trial[j] = (v[j] - v[0] * by_trial[0][j] -
                               v[1] * by_trial[1][j] - v[2] * by_trial[2][j]) /
                              (1. + change);
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            by_trial[i][j] += by_alpha[i] * alpha_by_trial[j];
      }
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        {
          tangent.slopes[order[i]][order[j]] = by_trial[i][j];
          const double difference            = trial[i] - trial[j];
          if (i < j)
            tangent.ratios[order[i] + order[j] - 1] =
              difference > 0. ? (result[i] - result[j]) / difference : 0.;
        }
  }
} // namespace greville
