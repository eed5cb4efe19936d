// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/run/probes.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  template <int dim>
  Probes<dim>::Probes(const std::string   &text,
                      const BodyList<dim> &bodies,
                      const MPI_Comm       comm)
    : comm(comm)
  {
    for (const std::string &position : Utilities::split_string_list(text, ';'))
      {
        std::vector<double> x;
        try
          {
            x = Utilities::string_to_double(
              Utilities::split_string_list(position, ','));
          }
        catch (const std::exception &)
          {}
        AssertThrow(x.size() == dim,
                    ExcMessage("The parameter 'Output/Probes' takes positions "
                               "of " +
                               std::to_string(dim) +
                               " numbers, separated by semicolons, not <" +
                               position + ">."));

        // The nearest point; of several the one of the first body and id.
        double nearest = std::numeric_limits<double>::max();
        Probe  probe{0, 0.};
        for (unsigned int b = 0; b < bodies.size(); ++b)
          bodies[b].points.for_each(
            [&](const unsigned int, ConstPointRef<dim> p) {
              double square = 0.;
              for (unsigned int d = 0; d < dim; ++d)
                square += std::pow(p.reference(d) - x[d], 2);
              const double id = p.id();
              if (square < nearest ||
                  (square == nearest && b == probe.body && id < probe.id))
                {
                  nearest = square;
                  probe   = {b, id};
                }
            });
        const double best = Utilities::MPI::min(nearest, comm);
        double       size = 0.;
        for (const Body<dim> &body : bodies)
          for (unsigned int d = 0; d < dim; ++d)
            size = std::max(size, body.points.space().lattice().cell_size(d));
        AssertThrow(best <= size * size,
                    ExcMessage("The parameter 'Output/Probes' has the position "
                               "<" +
                               position +
                               ">, but no point of a body is nearer to it "
                               "than a cell is long."));
        const double       none = std::numeric_limits<double>::max();
        const unsigned int own_body =
          nearest == best ? probe.body : numbers::invalid_unsigned_int;
        probe.body = Utilities::MPI::min(own_body, comm);
        probe.id =
          Utilities::MPI::min(own_body == probe.body ? probe.id : none, comm);
        probes.push_back(probe);
      }
  }



  template <int dim>
  std::vector<std::string>
  Probes<dim>::columns() const
  {
    std::vector<std::string> names  = {"time"};
    const char              *axes[] = {"x", "y", "z"};
    for (unsigned int k = 0; k < probes.size(); ++k)
      {
        const std::string probe = std::to_string(k);
        for (const char *what : {"", "v"})
          for (unsigned int d = 0; d < dim; ++d)
            names.push_back(std::string(what) + axes[d] + probe);
        const char *components[] = {"xx", "yy", "zz", "xy", "xz", "yz"};
        for (unsigned int c = 0; c < PointLayout<dim>::n_stress; ++c)
          names.push_back(std::string("stress_") + components[c] + probe);
      }
    return names;
  }



  template <int dim>
  void
  Probes<dim>::take(const unsigned int   first,
                    const BodyList<dim> &bodies,
                    const double         weight,
                    const bool           velocities)
  {
    if (probes.empty())
      return;
    constexpr unsigned int n_stress = PointLayout<dim>::n_stress;
    constexpr unsigned int n        = 2 * dim + n_stress;
    values.resize(1 + n * probes.size(), 0.);
    for (unsigned int b = 0; b < bodies.size(); ++b)
      bodies[b].points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
        for (unsigned int k = 0; k < probes.size(); ++k)
          if (probes[k].body == first + b && probes[k].id == p.id())
            {
              double *const row = &values[1 + k * n];
              for (unsigned int d = 0; d < dim; ++d)
                row[dim + d] += weight * p.velocity(d);
              if (velocities)
                continue;
              for (unsigned int d = 0; d < dim; ++d)
                row[d] = p.position(d);
              for (unsigned int c = 0; c < n_stress; ++c)
                row[2 * dim + c] = p.stress(c);
            }
      });
  }



  template <int dim>
  void
  Probes<dim>::write(const double time)
  {
    if (probes.empty())
      return;
    values.resize(columns().size(), 0.);
    Utilities::MPI::sum(values, comm, values);
    values[0] = time;
    file.write(values);
    values.clear();
  }



  template class Probes<2>;
  template class Probes<3>;
} // namespace greville
