// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/water_terms.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  std::array<double, 2>
  kozeny_carman(const double J, const double solid)
  {
    constexpr double smallest = 1e-6;
    const double     e = J / solid - 1., e0 = 1. / solid - 1.;
    if (e <= 0.)
      return {{smallest, 0.}};
    const double value = std::pow(e / e0, 3) / J;
    if (value <= smallest)
      return {{smallest, 0.}};
    return {{value, value * (3. / (e * solid) - 1. / J)}};
  }



  std::array<double, 2>
  relative_conductivity(const double p, const double suction)
  {
    constexpr double smallest = 1e-3;
    if (p >= 0. || suction == 0.)
      return {{1., 0.}};
    if (p <= -suction)
      return {{smallest, 0.}};
    const double s = 1. + p / suction;
    return {{smallest + (1. - smallest) * s * s * (3. - 2. * s),
             (1. - smallest) * 6. * s * (1. - s) / suction}};
  }



  template <int dim>
  typename WaterTerms<dim>::Mobility
  WaterTerms<dim>::mobility(const Term &term)
  {
    Mobility result{term.mobility, 0., 0.};
    if (term.solid > 0.)
      {
        const double J  = term.old_J * term.J;
        const auto   by = kozeny_carman(J, term.solid);
        result.value *= by[0];
        result.by_volume = term.mobility * J * by[1];
      }
    if (term.suction > 0.)
      {
        const auto by      = relative_conductivity(term.p, term.suction);
        result.by_pressure = result.value * by[1];
        result.value *= by[0];
        result.by_volume *= by[0];
      }
    return result;
  }



  template <int dim>
  double
  WaterTerms<dim>::outflow(const Drained &term) const
  {
    const Tensor<1, dim> &a = term.end_area;
    return mobility(term).value *
           (term.penalty * a.norm() * (term.p - term.value) -
            (term.gradient - weight) * a);
  }



  template <int dim>
  typename WaterTerms<dim>::Sources
  WaterTerms<dim>::sources(const Point &term) const
  {
    Sources result;
    result.force = -term.volume * term.J * term.p * transpose(term.map);
    if (is_axisymmetric)
      result.radial = -term.volume * term.J * term.p / term.end_radius;
    result.value = term.volume * term.change +
                   term.storage * (term.p - term.old_p) - term.earlier;
    const double flow = dt * mobility(term).value * term.J;
    result.gradient   = flow * (term.map * (term.gradient - weight));
    result.value_size = term.volume * term.change_size +
                        term.storage * (term.p_size + std::abs(term.old_p)) +
                        std::abs(term.earlier);
    result.gradient_size = flow * (term.gradient_size + weight.norm());
    return result;
  }



  template <int dim>
  typename WaterTerms<dim>::Sources
  WaterTerms<dim>::sources(const Drained &term) const
  {
    using Kind              = typename Drained::Kind;
    const Tensor<1, dim> &a = term.end_area;
    Sources               result;
    if (term.kind == Kind::flux)
      result.value = dt * term.value * a.norm();
    else if (term.kind == Kind::seepage)
      result.value = dt * std::max(0., outflow(term));
    else
      {
        result.value        = dt * outflow(term);
        const double flow   = dt * mobility(term).value;
        const double excess = term.p_size + std::abs(term.value);
        result.gradient     = -flow * (term.p - term.value) * (term.map * a);
        result.value_size =
          flow * a.norm() *
          (term.penalty * excess + term.gradient_size + weight.norm());
        result.gradient_size = flow * excess * a.norm();
      }
    return result;
  }



  template <int dim>
  typename WaterTerms<dim>::Sources
  WaterTerms<dim>::derivative(const Drained &term, const Change &change) const
  {
    using Kind                   = typename Drained::Kind;
    const Tensor<1, dim> &a      = term.end_area;
    const Tensor<1, dim>  w      = term.gradient - weight;
    const double          excess = term.p - term.value;
    const double          size   = a.norm();
    const double          rate   = trace(change.h) + change.hoop;
    const Tensor<1, dim>  da     = rate * a - transpose(change.h) * a;
    Sources               result;
    if (term.kind == Kind::flux)
      {
        result.value = dt * term.value * (a * da) / size;
        return result;
      }
    if (term.kind == Kind::seepage && outflow(term) <= 0.)
      return result;
    const Mobility k           = mobility(term);
    const double   change_of_k = k.by_volume * rate;
    result.value =
      dt *
      (change_of_k * (term.penalty * size * excess - w * a) +
       k.value * (term.penalty * (size * change.p + excess * (a * da) / size) -
                  (change.gradient - transpose(change.h) * term.gradient) * a -
                  w * da));
    if (term.kind == Kind::pressure)
      result.gradient =
        -dt *
        (term.map * (change_of_k * excess * a +
                     k.value * (change.p * a + excess * (da - change.h * a))));
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(WaterTerms);
} // namespace greville
