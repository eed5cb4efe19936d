// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/steps/implicit_steps.h>

#include <algorithm>
#include <cmath>
#include <limits>

// The forces in a step of ImplicitSteps.
namespace greville
{
  using namespace dealii;

  template <int dim>
  std::string
  ImplicitSteps<dim>::evaluate(const VectorType &x,
                               const double      dt,
                               const bool        with_stiffness)
  {
    const PartTimer timer(log, with_stiffness ? "stiffness" : "residual");
    system.extend(displacement, x);
    std::string problem = system.evaluate(
      bodies, displacement, dt, scheme.stress, with_stiffness, force);
    has_stiffness = with_stiffness;
    // Formulas may have no value where the step would bring the points.
    if (!surfaces.empty())
      try
        {
          const bool symmetric = system.surfaces().add(surfaces,
                                                       displacement,
                                                       surface_motion,
                                                       with_stiffness,
                                                       new_surface_loads);
          if (with_stiffness)
            surfaces_are_symmetric = symmetric;
        }
      catch (const ErrorOnAll &error)
        {
          problem = message_of(error);
        }
    return first_of_all(problem, discretization.communicator());
  }



  template <int dim>
  void
  ImplicitSteps<dim>::find_residual(VectorType             &r,
                                    const double            dt,
                                    const VectorField<dim> *of_contacts)
  {
    contact_force = of_contacts;
    const PartTimer timer(log, "residual");
    // All loads, while the forces of stresses wait.
    for (unsigned int d = 0; d < dim; ++d)
      {
        work[d] = new_loads[d];
        if (!surfaces.empty())
          work[d] += new_surface_loads[d];
        if (contact_force)
          work[d] += (*contact_force)[d];
      }
    system.restrict(r, work, nullptr);
    force_scale = std::max(system.force_scale(), r.l2_norm());
    if (water)
      force_scale = std::max(force_scale, water->force_scale());
    const double old_share = scheme.alpha_f / (1. - scheme.alpha_f);
    for (unsigned int d = 0; d < dim; ++d)
      {
        force[d] -= work[d];
        if (old_share != 0.)
          force[d].add(-old_share, old_force[d], -old_share, old_loads[d]);
        if (!scheme.is_static)
          {
            // (1 - alpha_m) a' + alpha_m a, over 1 - alpha_f
            const double share = 1. / (1. - scheme.alpha_f);
            const double end   = (1. - scheme.alpha_m) * share;
            work[d].equ(end * scheme.alpha_u / (dt * dt), displacement[d]);
            work[d].add(-end * scheme.alpha_v / dt,
                        velocity[d],
                        scheme.alpha_m * share - end * scheme.alpha_a,
                        acceleration[d]);
          }
      }
    system.restrict(r, force, nullptr);
    if (!scheme.is_static)
      {
        last_residual = r;
        system.restrict(r, force, &work);
        last_residual -= r;
        force_scale = std::max(force_scale, last_residual.l2_norm());
      }
    round_off = find_round_off();
  }



  template <int dim>
  double
  ImplicitSteps<dim>::find_inertia_at_begin(const double dt)
  {
    if (scheme.is_static)
      return 0.;
    const double share = 1. / (1. - scheme.alpha_f);
    const double end   = (1. - scheme.alpha_m) * share;
    double       sum   = 0.;
    for (VectorType &component : force)
      component = 0.;
    const auto add = [&](const double factor, const VectorField<dim> &field) {
      if (factor == 0.)
        return;
      system.restrict(last_residual, force, &field);
      sum += std::abs(factor) * last_residual.l2_norm();
    };
    add(end * scheme.alpha_v / dt, velocity);
    add(scheme.alpha_m * share - end * scheme.alpha_a, acceleration);
    return sum;
  }



  template <int dim>
  double
  ImplicitSteps<dim>::find_round_off() const
  {
    constexpr double units = 16. * std::numeric_limits<double>::epsilon();
    // The displacement of points is of the size of its mean: coefficients of
    // functions that points hardly see may be any number.
    const VectorType   &mass = field().lumped_mass;
    std::vector<double> sums(2);
    for (unsigned int i = 0; i < mass.locally_owned_size(); ++i)
      {
        sums[1] += mass.local_element(i);
        for (unsigned int d = 0; d < dim; ++d)
          sums[0] += mass.local_element(i) * displacement[d].local_element(i) *
                     displacement[d].local_element(i);
      }
    Utilities::MPI::sum(sums, discretization.communicator(), sums);
    const double u = sums[1] > 0. ? std::sqrt(sums[0] / sums[1]) : 0.;
    double       x = 0.;
    for (const auto *corner : {&parameters.grid.lower, &parameters.grid.upper})
      for (const double coordinate : *corner)
        x = std::max(x, std::abs(coordinate));
    const double of_surfaces = system.surfaces().stiffness_scale() * x;
    return units *
           (system.stiffness_scale() * (1. + u / discretization.cell_size()) +
            of_surfaces + force_scale + inertia_at_begin);
  }



  template class ImplicitSteps<2>;
  template class ImplicitSteps<3>;
} // namespace greville
