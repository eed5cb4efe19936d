// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/statistics.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  std::vector<std::pair<std::string, double>>
  Statistics<dim>::columns() const
  {
    std::vector<std::pair<std::string, double>> result = {{"time", time},
                                                          {"dt", step},
                                                          {"mass", mass}};
    const auto add = [&](const std::string &name, const auto &vector) {
      for (unsigned int d = 0; d < vector.dimension; ++d)
        result.emplace_back(name + "_" + "xyz"[d], vector[d]);
    };
    const auto add_moment = [&](const std::string &name, const auto &vector) {
      if (dim == 2)
        result.emplace_back(name, vector[0]);
      else
        add(name, vector);
    };
    add("momentum", momentum);
    add_moment("angular_momentum", angular_momentum);
    result.emplace_back("kinetic", kinetic);
    result.emplace_back("strain", strain);
    result.emplace_back("dissipation", dissipation);
    result.emplace_back("gravitational", gravitational);
    result.emplace_back("total", kinetic + strain + gravitational);
    add("center", center);
    result.emplace_back("front", runout);
    result.emplace_back("front_99", runout_99);
    result.emplace_back("height", height);
    result.emplace_back("iterations", iterations);
    result.emplace_back("largest_speed", largest_speed);
    result.emplace_back("active", active);
    result.emplace_back("points", n_points);
    result.emplace_back("fragments", fragments);
    result.emplace_back("redone", redone);
    result.emplace_back("work_gravity", work.gravity);
    result.emplace_back("work_loads", work.loads);
    result.emplace_back("work_walls", work.walls);
    result.emplace_back("work_friction", work.friction);
    result.emplace_back("work_damping", work.damping);
    for (const auto &load : loads)
      add("load_" + load.first, load.second);
    for (unsigned int k = 0; k < loads.size(); ++k)
      result.emplace_back("work_load_" + loads[k].first,
                          k < work.surfaces.size() ? work.surfaces[k] : 0.);
    for (const auto &[name, contact] : contacts)
      {
        const std::string begin = "contact_" + name;
        add(begin, contact.force);
        add_moment(begin + "_moment", contact.moment);
        result.emplace_back(begin + "_gap", contact.gap);
        result.emplace_back(begin + "_area", contact.area);
        const auto found = work.contacts.find(name);
        result.emplace_back("work_contact_" + name,
                            found == work.contacts.end() ? 0. : found->second);
      }
    for (const auto &[name, body] : rigid_bodies)
      {
        const std::string begin = "rigid_" + name;
        add("rigid_" + name, current_position(body, body.reference));
        for (unsigned int d = 0; d < dim; ++d)
          result.emplace_back(begin + "_v" + "xyz"[d], body.velocity[d]);
      }
    if (bodies.size() < 2)
      return result;
    for (const BodyStatistics<dim> &body : bodies)
      {
        result.emplace_back("kinetic_" + body.name, body.kinetic);
        result.emplace_back("strain_" + body.name, body.strain);
        result.emplace_back("dissipation_" + body.name, body.dissipation);
        add("momentum_" + body.name, body.momentum);
        result.emplace_back("front_" + body.name, body.runout);
        result.emplace_back("height_" + body.name, body.height);
      }
    return result;
  }



  template <int dim>
  std::vector<std::string>
  Statistics<dim>::names(const std::vector<std::string> &loads,
                         const std::vector<std::string> &bodies,
                         const std::vector<std::string> &contacts,
                         const std::vector<std::string> &rigid_bodies)
  {
    Statistics statistics;
    for (const std::string &contact : contacts)
      statistics.contacts.emplace_back(contact, ContactResult<dim>());
    for (const std::string &body : rigid_bodies)
      statistics.rigid_bodies.emplace_back(body, RigidPosition<dim>());
    for (const std::string &load : loads)
      statistics.loads.emplace_back(load, Tensor<1, dim>());
    for (const std::string &body : bodies)
      {
        statistics.bodies.emplace_back();
        statistics.bodies.back().name = body;
      }
    std::vector<std::string> result;
    for (const auto &column : statistics.columns())
      result.push_back(column.first);
    return result;
  }



  template <int dim>
  std::vector<double>
  Statistics<dim>::values() const
  {
    std::vector<double> result;
    for (const auto &column : columns())
      result.push_back(column.second);
    return result;
  }



  template <int dim>
  void
  Statistics<dim>::add(const Statistics &other)
  {
    if (mass + other.mass > 0.)
      center =
        (mass * center + other.mass * other.center) / (mass + other.mass);
    mass += other.mass;
    momentum += other.momentum;
    angular_momentum += other.angular_momentum;
    kinetic += other.kinetic;
    strain += other.strain;
    dissipation += other.dissipation;
    gravitational += other.gravitational;
    runout.add(other.runout);
    runout_99.add(other.runout_99);
    height.add(other.height);
    iterations    = std::max(iterations, other.iterations);
    largest_speed = std::max(largest_speed, other.largest_speed);
    active += other.active;
    fragments += other.fragments;
    redone += other.redone;
    work.gravity += other.work.gravity;
    work.loads += other.work.loads;
    work.walls += other.work.walls;
    work.friction += other.work.friction;
    work.damping += other.work.damping;
    work.surfaces.insert(work.surfaces.end(),
                         other.work.surfaces.begin(),
                         other.work.surfaces.end());
    for (const auto &[name, amount] : other.work.contacts)
      work.contacts[name] += amount;
    bodies.insert(bodies.end(), other.bodies.begin(), other.bodies.end());
    n_points += other.n_points;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      reactions[w] += other.reactions[w];
    loads.insert(loads.end(), other.loads.begin(), other.loads.end());
  }



  namespace
  {
    /// Set each number to its maximum over all processes.
    void
    find_largest(const std::vector<Largest *> &numbers, const MPI_Comm comm)
    {
      std::vector<double> values;
      for (const Largest *number : numbers)
        values.push_back(number->value);
      Utilities::MPI::max(values, comm, values);
      for (unsigned int k = 0; k < numbers.size(); ++k)
        numbers[k]->value = values[k];
    }
  } // namespace



  template <int dim>
  void
  add_sums(Statistics<dim>                 &row,
           const std::vector<Body<dim>>    &bodies,
           const std::vector<RowSums<dim>> &sums,
           const Tensor<1, dim>            &gravity,
           const MPI_Comm                   comm)
  {
    constexpr unsigned int n_spins = RowSums<dim>::n_spins;
    // Send all sums in one message. Numbers of points are exact as doubles.
    std::vector<double> values;
    for (const RowSums<dim> &own : sums)
      {
        values.push_back(double(own.n_points));
        for (const auto &lane :
             {own.mass, own.kinetic, own.strain, own.dissipation})
          values.push_back(own.sum(lane));
        for (const auto &lane : own.momentum)
          values.push_back(own.sum(lane));
        for (const auto &lane : own.first_moment)
          values.push_back(own.sum(lane));
        for (const auto &lane : own.angular_momentum)
          values.push_back(own.sum(lane));
      }
    Utilities::MPI::sum(values, comm, values);

    std::vector<Largest>              speeds(sums.size());
    std::vector<Largest *>            extremes;
    std::vector<const RowSums<dim> *> of_runouts;
    row.bodies.resize(sums.size());
    const double  *value = values.data();
    Tensor<1, dim> first_moment;
    for (unsigned int b = 0; b < sums.size(); ++b)
      {
        BodyStatistics<dim> &own = row.bodies[b];
        own.name                 = bodies[b].name;
        own.runout               = sums[b].runout;
        own.height               = sums[b].height;
        extremes.insert(extremes.end(), {&own.runout, &own.height});
        row.n_points += std::llround(*value++);
        const double mass = *value++;
        own.kinetic       = *value++;
        own.strain        = *value++;
        own.dissipation   = *value++;
        Tensor<1, dim> moment;
        for (unsigned int d = 0; d < dim; ++d)
          own.momentum[d] = *value++;
        for (unsigned int d = 0; d < dim; ++d)
          moment[d] = *value++;
        const double *const spins = value;
        value += n_spins;
        of_runouts.push_back(&sums[b]);
        for (const double square : sums[b].square_of_speed)
          speeds[b].add(square);
        extremes.push_back(&speeds[b]);
        row.mass += mass;
        row.kinetic += own.kinetic;
        row.strain += own.strain;
        row.dissipation += own.dissipation;
        row.momentum += own.momentum;
        first_moment += moment;
        for (unsigned int i = 0; i < n_spins; ++i)
          row.angular_momentum[i] += spins[i];
        // In periodic directions, gravity has no potential.
        for (unsigned int d = 0; d < dim; ++d)
          if (!bodies[b].points.space().is_periodic(d))
            row.gravitational -= gravity[d] * moment[d];
      }
    find_largest(extremes, comm);
    Largest square_of_speed;
    for (unsigned int b = 0; b < sums.size(); ++b)
      {
        square_of_speed.add(speeds[b]);
        row.runout.add(row.bodies[b].runout);
        row.height.add(row.bodies[b].height);
      }
    row.largest_speed = std::sqrt(square_of_speed);
    if (row.mass > 0.)
      row.center = first_moment / row.mass;
    row.runout_99 = runout_quantile<dim>(of_runouts, comm);
  }



  template <int dim>
  Largest
  runout_quantile(const std::vector<const RowSums<dim> *> &sums,
                  const MPI_Comm                           comm)
  {
    constexpr unsigned int n_bars = 1024;

    // Edges and masses of this process' points that may be the quantile.
    std::vector<std::pair<double, double>> points;
    double                                 all = 0.;
    for (const RowSums<dim> *own : sums)
      {
        const auto &outer = own->outer_points().get();
        points.insert(points.end(), outer.begin(), outer.end());
        all += own->mass_above;
      }
    all = Utilities::MPI::sum(all, comm);
    // The interval of the quantile: minus the lower end, and the upper end.
    std::vector<double> ends(2, Largest::none);
    for (const auto &point : points)
      {
        ends[0] = std::max(ends[0], -point.first);
        ends[1] = std::max(ends[1], point.first);
      }
    Utilities::MPI::max(ends, comm, ends);
    if (ends[1] == Largest::none)
      return {};

    double              lower = -ends[0], width = ends[1] - lower, beyond = 0.;
    std::vector<double> bars(n_bars);
    // Each pass divides the interval by 1024.
    for (unsigned int pass = 0; pass < 3 && width > 0.; ++pass)
      {
        const auto bar_of = [&](const double x) {
          return unsigned(
            std::min(n_bars - 1., std::max(0., (x - lower) / width * n_bars)));
        };
        std::fill(bars.begin(), bars.end(), 0.);
        for (const auto &[x, mass] : points)
          bars[bar_of(x)] += mass;
        Utilities::MPI::sum(bars, comm, bars);
        // Allow for round-off: equal points may have exactly this share.
        unsigned int bar = n_bars - 1;
        while (bar > 0 &&
               beyond + bars[bar] <= mass_beyond_runout * all * (1. + 1e-9))
          beyond += bars[bar--];
        points.erase(std::remove_if(points.begin(),
                                    points.end(),
                                    [&](const auto &point) {
                                      return bar_of(point.first) != bar;
                                    }),
                     points.end());
        width /= n_bars;
        lower += bar * width;
      }
    Largest result;
    for (const auto &point : points)
      result.add(point.first);
    return Utilities::MPI::max(result.value, comm);
  }



  template <int dim>
  Largest
  runout_quantile(const BodyList<dim> &bodies,
                  const MPI_Comm       comm,
                  const double         runout_above)
  {
    std::vector<RowSums<dim>>         sums;
    std::vector<const RowSums<dim> *> pointers;
    for (const Body<dim> &body : bodies)
      {
        sums.emplace_back(nullptr,
                          runout_above,
                          std::numeric_limits<double>::max());
        sums.back().add(body.points);
      }
    for (const RowSums<dim> &own : sums)
      pointers.push_back(&own);
    return runout_quantile(pointers, comm);
  }



  template <int dim>
  double
  energy_of_bodies(const std::vector<Body<dim>> &bodies,
                   const PointTransfer<dim>     &transfer,
                   const MPI_Comm                comm)
  {
    double sum = 0.;
    for (const Body<dim> &body : bodies)
      {
        RowSums<dim> own(body.material);
        own.add(body.points, &transfer);
        sum +=
          own.sum(own.kinetic) + own.sum(own.strain) + own.sum(own.dissipation);
      }
    return Utilities::MPI::sum(sum, comm);
  }



  template <int dim>
  double
  largest_displacement(const std::vector<Body<dim>> &bodies,
                       const MPI_Comm                comm)
  {
    double square = 0.;
    for (const Body<dim> &body : bodies)
      body.points.for_each([&](const ConstPointRef<dim> p) {
        square = std::max(square, p.position().distance_square(p.reference()));
      });
    return std::sqrt(Utilities::MPI::max(square, comm));
  }



  GREVILLE_INSTANTIATE_CLASS(Statistics);
  GREVILLE_INSTANTIATE(add_sums);
  template Largest
  runout_quantile(const std::vector<const RowSums<2> *> &, const MPI_Comm);
  template Largest
  runout_quantile(const std::vector<const RowSums<3> *> &, const MPI_Comm);
  template Largest
  runout_quantile(const BodyList<2> &, const MPI_Comm, const double);
  template Largest
  runout_quantile(const BodyList<3> &, const MPI_Comm, const double);
  GREVILLE_INSTANTIATE(energy_of_bodies);
  GREVILLE_INSTANTIATE(largest_displacement);
} // namespace greville
