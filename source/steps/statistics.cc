// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/statistics.h>

#include <algorithm>
#include <cmath>
#include <numeric>

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
    add("momentum", momentum);
    if (dim == 2)
      result.emplace_back("angular_momentum", angular_momentum[0]);
    else
      add("angular_momentum", angular_momentum);
    result.emplace_back("kinetic", kinetic);
    result.emplace_back("strain", strain);
    result.emplace_back("dissipation", dissipation);
    result.emplace_back("gravitational", gravitational);
    result.emplace_back("total", kinetic + strain + gravitational);
    add("center", center);
    result.emplace_back("front", front);
    result.emplace_back("front_99", front_99);
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
    result.emplace_back("work_obstacles", work.obstacles);
    result.emplace_back("work_friction", work.friction);
    result.emplace_back("work_damping", work.damping);
    for (const auto &load : loads)
      add("load_" + load.first, load.second);
    for (unsigned int k = 0; k < loads.size(); ++k)
      result.emplace_back("work_load_" + loads[k].first,
                          k < work.surfaces.size() ? work.surfaces[k] : 0.);
    if (bodies.size() < 2)
      return result;
    for (const BodyStatistics<dim> &body : bodies)
      {
        result.emplace_back("kinetic_" + body.name, body.kinetic);
        result.emplace_back("strain_" + body.name, body.strain);
        result.emplace_back("dissipation_" + body.name, body.dissipation);
        add("momentum_" + body.name, body.momentum);
        result.emplace_back("front_" + body.name, body.front);
        result.emplace_back("height_" + body.name, body.height);
      }
    return result;
  }



  template <int dim>
  std::vector<std::string>
  Statistics<dim>::names(const std::vector<std::string> &loads,
                         const std::vector<std::string> &bodies)
  {
    Statistics statistics;
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
    front.add(other.front);
    front_99.add(other.front_99);
    height.add(other.height);
    iterations    = std::max(iterations, other.iterations);
    largest_speed = std::max(largest_speed, other.largest_speed);
    active += other.active;
    fragments += other.fragments;
    redone += other.redone;
    work.gravity += other.work.gravity;
    work.loads += other.work.loads;
    work.walls += other.work.walls;
    work.obstacles += other.work.obstacles;
    work.friction += other.work.friction;
    work.damping += other.work.damping;
    work.surfaces.insert(work.surfaces.end(),
                         other.work.surfaces.begin(),
                         other.work.surfaces.end());
    bodies.insert(bodies.end(), other.bodies.begin(), other.bodies.end());
    n_points += other.n_points;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      reactions[w] += other.reactions[w];
    loads.insert(loads.end(), other.loads.begin(), other.loads.end());
  }



  namespace
  {
    /**
     * Of a point: m |v|^2 / 2, and m C:(C D) / 2 with APIC's matrix C, so that
     * a linear velocity v has the energy sum_i m_i |v(xi_i)|^2 / 2 of the grid.
     */
    template <int dim>
    double
    kinetic_energy_of(const ConstPointRef<dim>  p,
                      const unsigned int        cell,
                      const PointField         *affine,
                      const PointTransfer<dim> &transfer)
    {
      double square = p.velocity().norm_square();
      if (affine)
        {
          const auto D = transfer.spread(cell, p.position());
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              square +=
                Utilities::fixed_power<2>(p[affine->first + i * dim + j]) *
                D[j];
        }
      return 0.5 * p.mass() * square;
    }
  } // namespace



  namespace
  {
    /**
     * x or y of a point, with half of its size.
     */
    template <int dim>
    double
    outer_edge(const ConstPointRef<dim> p, const unsigned int d)
    {
      const double volume = p.volume();
      return p.position(d) +
             0.5 * (dim == 2 ? std::sqrt(volume) : std::cbrt(volume));
    }
  } // namespace



  template <int dim>
  Statistics<dim>
  compute_statistics(const std::vector<Body<dim>> &bodies,
                     const PointTransfer<dim>     &transfer,
                     const Tensor<1, dim>         &gravity,
                     const MPI_Comm                comm,
                     const double                  front_above)
  {
    Statistics<dim> result;
    Tensor<1, dim>  first_moment;
    Largest         square_of_speed;
    for (const Body<dim> &body : bodies)
      {
        const PointLayout<dim> &layout = body.points.layout();
        const PointField       *affine = layout.find("affine");
        BodyStatistics<dim>     own;
        own.name = body.name;
        body.points.for_each(
          [&](const unsigned int cell, ConstPointRef<dim> p) {
            const double         m        = p.mass();
            const double         V0       = p.volume0();
            const Point<dim>     position = p.position();
            const Tensor<1, dim> velocity = p.velocity();
            ++result.n_points;
            own.kinetic += kinetic_energy_of<dim>(p, cell, affine, transfer);
            own.momentum += m * velocity;
            if (position[1] > front_above)
              own.front.add(outer_edge<dim>(p, 0));
            own.height.add(outer_edge<dim>(p, 1));
            if (body.rigid_motion)
              return;

            Tensor<1, 3> x, v;
            for (unsigned int d = 0; d < dim; ++d)
              {
                x[d] = position[d];
                v[d] = velocity[d];
              }
            result.mass += m;
            first_moment += m * position;
            result.angular_momentum += m * cross_product_3d(x, v);
            if (affine)
              {
                // m C D, whose skew part is a spin
                const auto   D = transfer.spread(cell, position);
                const auto   C = p.matrix(affine->first);
                Tensor<2, 3> B;
                for (unsigned int i = 0; i < dim; ++i)
                  for (unsigned int j = 0; j < dim; ++j)
                    B[i][j] = C[i][j] * D[j];
                result.angular_momentum[0] += m * (B[2][1] - B[1][2]);
                result.angular_momentum[1] += m * (B[0][2] - B[2][0]);
                result.angular_momentum[2] += m * (B[1][0] - B[0][1]);
              }
            // Where the grid is periodic, gravity has no potential.
            for (unsigned int d = 0; d < dim; ++d)
              if (!body.points.space().lattice().is_periodic(d))
                result.gravitational -= m * gravity[d] * position[d];
            MaterialPoint point;
            load_material_point<dim>(p, layout, point);
            own.strain += V0 * body.material->strain_energy(point);
            own.dissipation += V0 * body.material->dissipation(point);
            square_of_speed.add(velocity.norm_square());
          });
        result.bodies.push_back(own);
      }
    // In 2D the spin has one component.
    if (dim == 2)
      {
        result.angular_momentum[0] = result.angular_momentum[2];
        result.angular_momentum[1] = result.angular_momentum[2] = 0.;
      }

    // All sums are one message. Numbers of points are exact as doubles.
    double                n_points = result.n_points;
    std::vector<double *> sums     = {&result.mass,
                                      &result.gravitational,
                                      &n_points};
    std::vector<double *> extremes = {&square_of_speed.value};
    for (unsigned int d = 0; d < dim; ++d)
      sums.push_back(&first_moment[d]);
    for (unsigned int d = 0; d < 3; ++d)
      sums.push_back(&result.angular_momentum[d]);
    for (BodyStatistics<dim> &body : result.bodies)
      {
        sums.insert(sums.end(),
                    {&body.kinetic, &body.strain, &body.dissipation});
        for (unsigned int d = 0; d < dim; ++d)
          sums.push_back(&body.momentum[d]);
        extremes.insert(extremes.end(),
                        {&body.front.value, &body.height.value});
      }
    const auto reduce = [&](const std::vector<double *> &numbers,
                            const auto                  &operation) {
      std::vector<double> values;
      for (const double *number : numbers)
        values.push_back(*number);
      operation(values);
      for (unsigned int k = 0; k < numbers.size(); ++k)
        *numbers[k] = values[k];
    };
    reduce(sums,
           [&](auto &values) { Utilities::MPI::sum(values, comm, values); });
    reduce(extremes,
           [&](auto &values) { Utilities::MPI::max(values, comm, values); });

    result.largest_speed = std::sqrt(square_of_speed);
    result.n_points      = std::llround(n_points);
    if (result.mass > 0.)
      result.center = first_moment / result.mass;
    for (unsigned int b = 0; b < bodies.size(); ++b)
      if (!bodies[b].rigid_motion)
        {
          const BodyStatistics<dim> &own = result.bodies[b];
          result.kinetic += own.kinetic;
          result.strain += own.strain;
          result.dissipation += own.dissipation;
          result.momentum += own.momentum;
          result.front.add(own.front);
          result.height.add(own.height);
        }
    result.front_99 = front_quantile<dim>(bodies, comm, front_above);
    return result;
  }



  template <int dim>
  Largest
  front_quantile(const BodyList<dim> &bodies,
                 const MPI_Comm       comm,
                 const double         front_above)
  {
    constexpr double       share  = 0.005;
    constexpr unsigned int n_bars = 1024;

    // Edges and masses of the points of this process that can be the one.
    std::vector<std::pair<double, double>> points;
    // Of the interval in which it is: minus the lower end, and the upper one.
    std::vector<double> ends(2, Largest::none);
    for (const Body<dim> &body : bodies)
      if (!body.rigid_motion)
        body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
          if (p.position(1) > front_above)
            {
              const double x = outer_edge<dim>(p, 0);
              points.emplace_back(x, p.mass());
              ends[0] = std::max(ends[0], -x);
              ends[1] = std::max(ends[1], x);
            }
        });
    Utilities::MPI::max(ends, comm, ends);
    if (ends[1] == Largest::none)
      return {};

    double              lower = -ends[0], width = ends[1] - lower;
    double              all = 0., beyond = 0.;
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
        if (pass == 0)
          all = std::accumulate(bars.begin(), bars.end(), 0.);
        // Equal points can hold the share exactly: sums have round-off.
        unsigned int bar = n_bars - 1;
        while (bar > 0 && beyond + bars[bar] <= share * all * (1. + 1e-9))
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
  double
  free_energy(const std::vector<Body<dim>> &bodies,
              const PointTransfer<dim>     &transfer,
              const MPI_Comm                comm)
  {
    double sum = 0.;
    for (const Body<dim> *body : deformable_bodies(bodies))
      {
        const PointLayout<dim> &layout = body->points.layout();
        const PointField       *affine = layout.find("affine");
        body->points.for_each(
          [&](const unsigned int cell, ConstPointRef<dim> p) {
            sum += kinetic_energy_of<dim>(p, cell, affine, transfer);
            MaterialPoint point;
            load_material_point<dim>(p, layout, point);
            sum += p.volume0() * (body->material->strain_energy(point) +
                                  body->material->dissipation(point));
          });
      }
    return Utilities::MPI::sum(sum, comm);
  }



  template <int dim>
  double
  largest_displacement(const std::vector<Body<dim>> &bodies,
                       const MPI_Comm                comm)
  {
    double square = 0.;
    for (const Body<dim> *body : deformable_bodies(bodies))
      body->points.for_each([&](const unsigned int,
                                const ConstPointRef<dim> p) {
        square = std::max(square, p.position().distance_square(p.reference()));
      });
    return std::sqrt(Utilities::MPI::max(square, comm));
  }



  template struct Statistics<2>;
  template struct Statistics<3>;
  template decltype(compute_statistics<2>)   compute_statistics<2>;
  template decltype(compute_statistics<3>)   compute_statistics<3>;
  template decltype(front_quantile<2>)       front_quantile<2>;
  template decltype(front_quantile<3>)       front_quantile<3>;
  template decltype(free_energy<2>)          free_energy<2>;
  template decltype(free_energy<3>)          free_energy<3>;
  template decltype(largest_displacement<2>) largest_displacement<2>;
  template decltype(largest_displacement<3>) largest_displacement<3>;
} // namespace greville
