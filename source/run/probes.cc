// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/run/probes.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return whether a field is defined for single points and for means, and
    /// is not among the columns that are always written.
    bool
    is_for_probes(const std::string &field)
    {
      return !contains(Utilities::split_string_list(
                         "velocity, stress, reference, body, id, process"),
                       field);
    }
  } // namespace



  template <int dim>
  Probes<dim>::Probes(const std::string              &text,
                      const std::vector<std::string> &field_names,
                      const BodyList<dim>            &bodies,
                      const MPI_Comm                  comm)
    : comm(comm)
  {
    for (const OutputField<dim> &field : point_fields(field_names, bodies, 0))
      if (is_for_probes(field.name))
        {
          fields.push_back(field);
          n_more += field.components.size();
        }
    for (const std::string &probe : Utilities::split_string_list(text, ';'))
      if (probe.find('(') != std::string::npos)
        add_shape(probe, bodies);
      else
        add_point(probe, bodies);
  }



  template <int dim>
  void
  Probes<dim>::add_shape(const std::string &text, const BodyList<dim> &bodies)
  {
    const Shape<dim> shape(text, "Output/Probes");
    bool             is_empty = true;
    for (const Body<dim> &body : bodies)
      body.points.for_each([&](ConstPointRef<dim> p) {
        if (shape.contains(p.position()))
          is_empty = false;
      });
    Require(Utilities::MPI::min<unsigned int>(is_empty, comm) == 0,
            "The parameter 'Output/Probes' has the shape <" + text +
              ">, which contains no point of a body.");
    probes.push_back({numbers::invalid_unsigned_int, 0., shape});
  }



  template <int dim>
  void
  Probes<dim>::add_point(const std::string   &position,
                         const BodyList<dim> &bodies)
  {
    std::vector<double> x;
    try
      {
        x = Utilities::string_to_double(
          Utilities::split_string_list(position, ','));
      }
    catch (const std::exception &)
      {}
    Require(x.size() == dim,
            "The parameter 'Output/Probes' takes positions of " +
              std::to_string(dim) +
              " numbers, or shapes, separated by semicolons, not <" + position +
              ">.");

    // The nearest point; of several, the point with the lowest body and id.
    double nearest = std::numeric_limits<double>::max();
    Probe  probe{0, 0., {}};
    for (unsigned int b = 0; b < bodies.size(); ++b)
      bodies[b].points.for_each([&](ConstPointRef<dim> p) {
        double square = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          square += std::pow(p.reference(d) - x[d], 2);
        const double id = PointLayout<dim>::initial_id(p.id());
        if (square < nearest ||
            (square == nearest && b == probe.body && id < probe.id))
          {
            nearest    = square;
            probe.body = b;
            probe.id   = id;
          }
      });
    const double best = Utilities::MPI::min(nearest, comm);
    double       size = 0.;
    for (const Body<dim> &body : bodies)
      for (unsigned int d = 0; d < dim; ++d)
        size = std::max(size, body.points.space().largest_cell_size(d));
    Require(best <= size * size,
            "The parameter 'Output/Probes' has the position <" + position +
              ">, but no point of a body is within a cell length of it.");
    const double       none = std::numeric_limits<double>::max();
    const unsigned int own_body =
      nearest == best ? probe.body : numbers::invalid_unsigned_int;
    probe.body = Utilities::MPI::min(own_body, comm);
    probe.id =
      Utilities::MPI::min(own_body == probe.body ? probe.id : none, comm);
    probes.push_back(probe);
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
        for (const std::string &name : symmetric_entries<dim>("stress"))
          names.push_back(name + probe);
        for (const OutputField<dim> &field : fields)
          for (unsigned int c = 0; c < field.components.size(); ++c)
            names.push_back(
              field.components[c] +
              (field.is_vector ? std::string("_") + axes[c] : "") + probe);
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
    const unsigned int     n        = n_values();
    const unsigned int     stride   = n + dim + 2;
    sums.resize(stride * probes.size(), 0.);
    weights[velocities] = weight;
    std::vector<double> more(n_more);
    for (unsigned int b = 0; b < bodies.size(); ++b)
      bodies[b].points.for_each([&](ConstPointRef<dim> p) {
        for (unsigned int k = 0; k < probes.size(); ++k)
          {
            const Probe &probe = probes[k];
            if (probe.shape
                  ? !probe.shape->contains(p.position())
                  : probe.body != first + b ||
                      probe.id != PointLayout<dim>::initial_id(p.id()))
              continue;
            const double  volume = p.volume0();
            double *const sum    = &sums[k * stride];
            double *const v      = sum + (velocities ? n + 1 : dim);
            sum[velocities ? n + 1 + dim : n] += volume;
            for (unsigned int d = 0; d < dim; ++d)
              v[d] += volume * p.velocity(d);
            if (velocities)
              continue;
            for (unsigned int d = 0; d < dim; ++d)
              sum[d] += volume * p.position(d);
            for (unsigned int c = 0; c < n_stress; ++c)
              sum[2 * dim + c] += volume * p.stress(c);
            unsigned int i = 0;
            for (const OutputField<dim> &field : fields)
              {
                field.evaluate(p, bodies[b], first + b, &more[i]);
                i += field.components.size();
              }
            for (i = 0; i < n_more; ++i)
              sum[2 * dim + n_stress + i] += volume * more[i];
          }
      });
  }



  template <int dim>
  const std::vector<double> &
  Probes<dim>::finish(const double time)
  {
    row.assign(1, time);
    const unsigned int n      = n_values();
    const unsigned int stride = n + dim + 2;
    sums.resize(stride * probes.size(), 0.);
    Utilities::MPI::sum(sums, comm, sums);
    for (unsigned int k = 0; k < probes.size(); ++k)
      {
        const double *const sum    = &sums[k * stride];
        const double        volume = sum[n], second = sum[n + 1 + dim];
        for (unsigned int i = 0; i < n; ++i)
          {
            double value = volume > 0. ? sum[i] / volume : 0.;
            if (i >= dim && i < 2 * dim)
              {
                value *= weights[0];
                if (second > 0.)
                  value += weights[1] * (sum[n + 1 + i - dim] / second);
              }
            row.push_back(value);
          }
      }
    forget();
    return row;
  }



  GREVILLE_INSTANTIATE_CLASS(Probes);
} // namespace greville
