// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/statistics.h>

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
    front         = std::max(front, other.front);
    height        = std::max(height, other.height);
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



  template <int dim>
  Statistics<dim>
  compute_statistics(const std::vector<Body<dim>> &bodies,
                     const PointTransfer<dim>     &transfer,
                     const Tensor<1, dim>         &gravity,
                     const MPI_Comm                comm,
                     const double                  front_above)
  {
    Statistics<dim>     result;
    std::vector<double> largest = {-1e300, -1e300, 0.};
    Tensor<1, dim>      first_moment;
    for (const Body<dim> &body : bodies)
      {
        const PointLayout<dim> &layout = body.points.layout();
        const PointField       *affine = layout.find("affine");
        BodyStatistics<dim>     own;
        own.name = body.name;
        body.points.for_each([&](const unsigned int cell,
                                 ConstPointRef<dim> p) {
          const double         m        = p.mass();
          const double         V0       = p.volume0();
          const Point<dim>     position = p.position();
          const Tensor<1, dim> velocity = p.velocity();
          Tensor<1, 3>         x, v;
          for (unsigned int d = 0; d < dim; ++d)
            {
              x[d] = position[d];
              v[d] = velocity[d];
            }
          result.mass += m;
          result.momentum += m * velocity;
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
          const double kinetic =
            kinetic_energy_of<dim>(p, cell, affine, transfer);
          result.kinetic += kinetic;
          own.kinetic += kinetic;
          own.momentum += m * velocity;
          // Where the grid is periodic, gravity has no potential.
          for (unsigned int d = 0; d < dim; ++d)
            if (!body.points.space().lattice().is_periodic(d))
              result.gravitational -= m * gravity[d] * position[d];
          if (!body.rigid_motion)
            {
              MaterialPoint point;
              load_material_point<dim>(p, layout, point);
              const double strain = V0 * body.material->strain_energy(point);
              const double dissipation = V0 * body.material->dissipation(point);
              result.strain += strain;
              result.dissipation += dissipation;
              own.strain += strain;
              own.dissipation += dissipation;
            }
          largest[2] = std::max(largest[2], velocity.norm_square());
          const double half_size =
            0.5 * (dim == 2 ? std::sqrt(p.volume()) : std::cbrt(p.volume()));
          if (position[1] > front_above)
            largest[0] = std::max(largest[0], position[0] + half_size);
          largest[1] = std::max(largest[1], position[1] + half_size);
          ++result.n_points;
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
                                      &result.kinetic,
                                      &result.strain,
                                      &result.dissipation,
                                      &result.gravitational,
                                      &n_points};
    for (unsigned int d = 0; d < dim; ++d)
      sums.insert(sums.end(), {&result.momentum[d], &first_moment[d]});
    for (unsigned int d = 0; d < 3; ++d)
      sums.push_back(&result.angular_momentum[d]);
    for (BodyStatistics<dim> &body : result.bodies)
      {
        sums.insert(sums.end(),
                    {&body.kinetic, &body.strain, &body.dissipation});
        for (unsigned int d = 0; d < dim; ++d)
          sums.push_back(&body.momentum[d]);
      }
    std::vector<double> values;
    for (const double *sum : sums)
      values.push_back(*sum);
    Utilities::MPI::sum(values, comm, values);
    for (unsigned int k = 0; k < sums.size(); ++k)
      *sums[k] = values[k];

    Utilities::MPI::max(largest, comm, largest);
    result.front         = largest[0];
    result.height        = largest[1];
    result.largest_speed = std::sqrt(largest[2]);
    result.n_points      = std::llround(n_points);
    if (result.n_points == 0)
      result.height = 0.;
    if (result.front == -1e300)
      result.front = 0.;
    if (result.mass > 0.)
      result.center = first_moment / result.mass;
    return result;
  }



  template <int dim>
  double
  free_energy(const std::vector<Body<dim>> &bodies,
              const PointTransfer<dim>     &transfer,
              const MPI_Comm                comm,
              const bool                    only_kinetic)
  {
    double sum = 0.;
    for (const Body<dim> *body : deformable_bodies(bodies))
      {
        const PointLayout<dim> &layout = body->points.layout();
        const PointField       *affine = layout.find("affine");
        body->points.for_each(
          [&](const unsigned int cell, ConstPointRef<dim> p) {
            sum += kinetic_energy_of<dim>(p, cell, affine, transfer);
            if (only_kinetic)
              return;
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
  template decltype(free_energy<2>)          free_energy<2>;
  template decltype(free_energy<3>)          free_energy<3>;
  template decltype(largest_displacement<2>) largest_displacement<2>;
  template decltype(largest_displacement<3>) largest_displacement<3>;
} // namespace greville
