// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/largest_eigenvalue.h>
#include <greville/steps/critical_step.h>

#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr double       tolerance    = 0.01;
    constexpr unsigned int max_products = 40;

    // The fraction of noise in the squared norm of the first vector, if an
    // eigenvector is known.
    constexpr double noise_part = 0.05;



    /// Return a number between -1 and 1, the same for any number of processes.
    double
    noise(const std::uint64_t function, const unsigned int component)
    {
      const double x =
        std::sin(12.9898 * (function % 100003) + 78.233 * component + 0.7) *
        43758.5453;
      return 2. * (x - std::floor(x)) - 1.;
    }



    double
    dot(const std::vector<double> &a,
        const std::vector<double> &b,
        const MPI_Comm             comm)
    {
      double sum = 0.;
      for (std::size_t u = 0; u < a.size(); ++u)
        sum += a[u] * b[u];
      return Utilities::MPI::sum(sum, comm);
    }



    /// Collective. Return the critical step, and set @p start to its
    /// eigenvector. multiply(y, x, elastic, viscous) computes y = (elastic K +
    /// viscous C) x. The iteration begins with @p step if it is positive,
    /// otherwise with the step of the first vector; without viscosity, any step
    /// will do. The result is negative if the first vector is zero.
    template <typename Multiply>
    double
    find_critical_step(double               step,
                       std::vector<double> &start,
                       const bool           is_viscous,
                       const LinearAction  &B,
                       const Multiply      &multiply,
                       const MPI_Comm       comm)
    {
      // Return the dt with dt^2 a + dt b = 1.
      const auto root = [](const double a, const double b) {
        return a > 0. || b > 0. ? 2. / (b + std::sqrt(b * b + 4. * a))
                                : std::numeric_limits<double>::infinity();
      };

      // A vector x has the step dt for which x^T B^-1 x = x^T (dt^2 / 4 K + dt
      // / 2 C) x. The critical step is the smallest step of all vectors.
      std::vector<double> x(start.size()), y(start.size());
      if (!(step > 0.))
        {
          B(x, start);
          const double square = dot(x, start, comm);
          multiply(y, x, 0.25, 0.);
          const double a = dot(x, y, comm);
          multiply(y, x, 0., 0.5);
          const double b = dot(x, y, comm);
          if (!(square > 0.))
            return -1.;
          step = root(a / square, b / square);
        }
      for (unsigned int repeat = 0; repeat < 5; ++repeat)
        {
          if (!std::isfinite(step))
            break;
          const LinearAction S = [&](std::vector<double>       &y,
                                     const std::vector<double> &x) {
            multiply(y, x, 0.25 * step * step, 0.5 * step);
          };
          LargestEigenvalue result =
            largest_eigenvalue(S, B, start, tolerance, max_products, comm);
          start = result.b;
          if (!is_viscous)
            {
              step = root(result.value, 0.);
              break;
            }
          multiply(y, result.x, 0.25, 0.);
          const double a      = dot(result.x, y, comm);
          const double b      = result.value / step - a * step;
          const double before = step;
          step                = root(a, std::max(b, 0.));
          if (std::abs(step - before) <= tolerance * step)
            break;
        }
      return step;
    }
  } // namespace



  template <int dim>
  void
  CriticalStep<dim>::choose_unknowns(const GridMass<dim>    &mass,
                                     const HighestMode<dim> &mode)
  {
    const SplineSpace<dim> &space  = mass.space();
    const VectorType       &lumped = mass.lumped();
    for (auto *field : {&source, &target})
      for (VectorType &component : *field)
        space.initialize_vector(component);

    // Constrained coefficients stay zero.
    const double smallest_mass       = !mass.is_exact() && space.degree() == 1
                                         ? 0.01 * lumped.linfty_norm()
                                         : 0.;
    const CellHierarchy<dim> *levels = space.hierarchy();
    const auto                size_of_cells = [&](const unsigned int i) {
      return levels ? std::ldexp(1.,
                                 -int(dim * levels->level_of_function(
                                              space.owned_functions()[i] %
                                              space.n_functions()[0])))
                                   : 1.;
    };
    std::vector<double> random;
    start.clear();
    std::vector<double> squares(2, 0.); // of noise and of the last vector
    for (unsigned int d = 0; d < dim; ++d)
      {
        unknowns[d].clear();
        for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
          {
            const double m = lumped.local_element(i);
            if (!mass.has_points(i) || m < smallest_mass * size_of_cells(i) ||
                ((mass.constrained_by_walls(i) >> d) & 1))
              continue;
            unknowns[d].push_back(i);
            const double r = noise(space.owned_functions()[i], d);
            random.push_back(m * r);
            const double b =
              mode.is_known ? mode.force[d].local_element(i) : 0.;
            start.push_back(b);
            squares[0] += m * r * r;
            squares[1] += m > 0. ? b * b / m : 0.;
          }
      }
    Utilities::MPI::sum(squares, space.communicator(), squares);
    const double weight = squares[1] > 0. ? noise_part * squares[1] : 1.;
    if (squares[0] > 0.)
      for (std::size_t u = 0; u < start.size(); ++u)
        start[u] += random[u] * std::sqrt(weight / squares[0]);
  }



  template <int dim>
  void
  CriticalStep<dim>::read_field(std::vector<double>    &values,
                                const VectorField<dim> &field) const
  {
    std::size_t u = 0;
    for (unsigned int d = 0; d < dim; ++d)
      for (const unsigned int i : unknowns[d])
        values[u++] = field[d].local_element(i);
  }



  template <int dim>
  void
  CriticalStep<dim>::write_field(VectorField<dim>          &field,
                                 const std::vector<double> &values) const
  {
    std::size_t u = 0;
    for (unsigned int d = 0; d < dim; ++d)
      {
        field[d] = 0.;
        for (const unsigned int i : unknowns[d])
          field[d].local_element(i) = values[u++];
      }
  }



  template <int dim>
  void
  CriticalStep<dim>::multiply_by_B(
    std::vector<double>                            &x,
    const std::vector<double>                      &b,
    GridMass<dim>                                  &mass,
    PointTransfer<dim>                             &transfer,
    const std::vector<const MaterialPoints<dim> *> &mass_points,
    const StepScheme                               &scheme)
  {
    // The coefficients of the polynomial in s.
    std::array<double, 3> c{{1., 0., 0.}};
    if (!mass.is_exact())
      {
        if (!scheme.deforms_by_mapped_velocity)
          c = {{2., -1., 0.}};
        else if (!scheme.has_affine)
          c = {{0.,
                2. / (1. + scheme.flip),
                -(1. - scheme.flip) / (1. + scheme.flip)}};
      }

    const auto solve = [&](const VectorField<dim> &rows) {
      for (VectorType &component : target)
        component = 0.;
      mass.solve({&target}, {&rows});
    };
    write_field(source, b);
    solve(source);
    std::vector<double> part(b.size());
    read_field(part, target);
    for (std::size_t u = 0; u < x.size(); ++u)
      x[u] = c[0] * part[u];
    for (unsigned int k = 1; k < 3 && (c[k] != 0. || c[2] != 0.); ++k)
      {
        write_field(target, part);
        mass.distribute_levels(target);
        transfer.multiply_mass(mass_points, target, product);
        mass.condense_levels(product);
        solve(product);
        read_field(part, target);
        for (std::size_t u = 0; u < x.size(); ++u)
          x[u] += c[k] * part[u];
      }
  }



  template <int dim>
  void
  CriticalStep<dim>::multiply_by_stiffness(
    std::vector<double>                  &y,
    const std::vector<double>            &x,
    const double                          elastic,
    const double                          viscous,
    const double                          factor,
    GridMass<dim>                        &mass,
    PointTransfer<dim>                   &transfer,
    const std::vector<const Body<dim> *> &bodies,
    const std::vector<Surface<dim>>      &surfaces)
  {
    write_field(source, x);
    mass.distribute_levels(source);
    for (const Body<dim> *body : bodies)
      {
        const Moduli m = body->material->moduli();
        Stiffness    stiffness;
        stiffness.lambda         = m.bulk - 2. / 3. * m.shear;
        stiffness.shear          = m.shear;
        stiffness.elastic_factor = factor * elastic;
        stiffness.viscous_shear  = factor * viscous * m.viscosity;
        stiffness.viscous_lambda =
          factor * viscous * (m.bulk_viscosity - 2. / 3. * m.viscosity);
        transfer.add_stiffness(
          body->points, stiffness, source, target, body == bodies[0]);
      }
    // Dashpots act on an extrapolated velocity and count twice.
    for (const Surface<dim> &surface : surfaces)
      {
        const double k = factor * (elastic * surface.stiffness +
                                   2. * viscous * surface.damping);
        if (k == 0.)
          continue;
        for (unsigned int d = 0; d < dim; ++d)
          extended[d] = source[d];
        mass.distribute(extended);
        transfer.multiply_mass({&surface.points}, extended, product);
        mass.condense(product);
        for (unsigned int d = 0; d < dim; ++d)
          target[d].add(k, product[d]);
      }
    mass.condense_levels(target);
    read_field(y, target);
  }



  template <int dim>
  double
  CriticalStep<dim>::estimate(
    GridMass<dim>                                  &mass,
    PointTransfer<dim>                             &transfer,
    const std::vector<Body<dim>>                   &all_bodies,
    const std::vector<Surface<dim>>                &surfaces,
    const std::vector<const MaterialPoints<dim> *> &mass_points,
    const StepScheme                               &scheme,
    HighestMode<dim>                               &mode)
  {
    std::vector<const Body<dim> *> bodies;
    bool                           is_viscous = false;
    for (const Body<dim> &body : all_bodies)
      {
        const Moduli moduli = body.material->moduli();
        const bool   flows  = moduli.viscosity + moduli.bulk_viscosity > 0.;
        if (!(moduli.bulk + moduli.shear > 0. || flows))
          continue;
        bodies.push_back(&body);
        is_viscous = is_viscous || flows;
      }
    for (const Surface<dim> &surface : surfaces)
      is_viscous = is_viscous || surface.damping > 0.;
    if (bodies.empty())
      return std::numeric_limits<double>::infinity();

    const MPI_Comm comm = mass.space().communicator();
    choose_unknowns(mass, mode);
    if (!mass.is_exact() || !surfaces.empty())
      for (VectorType &component : product)
        mass.space().initialize_vector(component);
    const double       factor = mass.is_diagonal() ? 1. + scheme.damping
                                                   : std::pow(1. + scheme.damping, 2);
    const LinearAction B      = [&](std::vector<double>       &x,
                               const std::vector<double> &b) {
      multiply_by_B(x, b, mass, transfer, mass_points, scheme);
    };
    const auto multiply = [&](std::vector<double>       &y,
                              const std::vector<double> &x,
                              const double               elastic,
                              const double               viscous) {
      multiply_by_stiffness(
        y, x, elastic, viscous, factor, mass, transfer, bodies, surfaces);
    };

    const double step = find_critical_step(
      is_viscous ? mode.step : 1., start, is_viscous, B, multiply, comm);
    if (step < 0.)
      return std::numeric_limits<double>::infinity();
    mode.is_known = std::isfinite(step);
    mode.step     = mode.is_known ? step : 0.;
    if (mode.is_known)
      {
        for (VectorType &component : mode.force)
          mass.space().initialize_vector(component);
        write_field(mode.force, start);
      }
    return step;
  }



  GREVILLE_INSTANTIATE_CLASS(CriticalStep);
} // namespace greville
