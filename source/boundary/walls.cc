// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/step_errors.h>
#include <greville/boundary/walls.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace greville
{
  using namespace dealii;

  template <int dim>
  Walls<dim>::Walls(const WallParameters &parameters)
  {
    static const std::map<std::string, WallType> types = {
      {"free", WallType::free},
      {"fixed", WallType::fixed},
      {"sliding", WallType::sliding},
      {"moving", WallType::moving},
      {"friction", WallType::friction},
      {"periodic", WallType::periodic}};
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        type[w]                = types.at(parameters.type[w]);
        friction[w]            = parameters.friction[w];
        const std::string name = "Walls/" + WallParameters::names[w];
        if (!parameters.region[w].empty())
          region[w].emplace(parameters.region[w], name + " region");
        if (!parameters.velocity[w].empty())
          velocity[w] = {parameters.velocity[w],
                         name + " velocity",
                         variables_of<dim>("xt")};
        if (!parameters.displacement[w].empty())
          displacement[w] = {parameters.displacement[w],
                             name + " displacement",
                             variables_of<dim>("xt")};
      }
  }



  template <int dim>
  std::array<bool, dim>
  Walls<dim>::periodic_directions(const WallParameters &parameters)
  {
    std::array<bool, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = parameters.is_periodic(2 * d);
    return result;
  }



  template <int dim>
  std::vector<unsigned int>
  Walls<dim>::coefficients_at(const SplineSpace<dim> &space,
                              const unsigned int      wall) const
  {
    std::vector<unsigned int> result;
    for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
      if (space.on_side(i, wall) &&
          (!region[wall] || region[wall]->contains(space.greville_point(i))))
        result.push_back(i);
    return result;
  }



  template <int dim>
  void
  Walls<dim>::reinit(const SplineSpace<dim> &space)
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        coefficients[w] = coefficients_at(space, w);
        abscissae[w].clear();
        for (const unsigned int i : coefficients[w])
          abscissae[w].push_back(space.greville_point(i));
      }
    // If several walls constrain a coefficient, the last wall gives its value.
    std::vector<unsigned char> others(space.owned_functions().size(), 0);
    for (unsigned int w = 2 * dim; w-- > 0;)
      {
        counted[w].clear();
        for (const unsigned int i : coefficients[w])
          {
            counted[w].push_back(constrained_components(w) & ~others[i]);
            others[i] |= constrained_components(w);
          }
      }
  }



  template <int dim>
  Tensor<1, dim>
  Walls<dim>::velocity_at(const unsigned int wall,
                          const Point<dim>  &x,
                          const WallTime    &time) const
  {
    const VectorExpression<dim> &d = displacement[wall];
    if (d.is_zero())
      return velocity[wall](x, time.t);
    if (time.begin == time.end)
      return Tensor<1, dim>();
    return (d(x, time.end) - d(x, time.begin)) / (time.end - time.begin);
  }



  template <int dim>
  void
  Walls<dim>::check_paths(const SplineSpace<dim> &space,
                          const double            start,
                          const double            end,
                          const bool              walls_have_to_stay) const
  {
    constexpr unsigned int n  = 1000; // steps of the trapezoidal rule
    const double           dt = (end - start) / n;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (is_moving(w))
        for (unsigned int corner = 0; corner < (1u << dim); ++corner)
          {
            const unsigned int d = w / 2;
            if (((corner >> d) & 1) != w % 2)
              continue;
            Point<dim> x;
            for (unsigned int c = 0; c < dim; ++c)
              x[c] = (corner >> c) & 1 ? space.upper_corner()[c]
                                       : space.lower_corner()[c];
            const double h =
              space.hierarchy()
                ? space.cell_size(d)
                : space.cell_size(
                    d, w % 2 == 0 ? 0 : space.cells_per_direction()[d] - 1);
            double path = 0., last = 0.;
            for (unsigned int k = 0; k <= n; ++k)
              {
                const double t = start + dt * k;
                if (displacement[w].is_zero())
                  {
                    const double v = velocity[w](x, t)[d];
                    if (k > 0)
                      path += 0.5 * dt * (last + v);
                    last = v;
                  }
                else
                  path = (displacement[w](x, t) - displacement[w](x, start))[d];
                Require(
                  !walls_have_to_stay || std::abs(path) <= 0.1 * h,
                  "The parameter 'Walls/" + WallParameters::names[w] +
                    (displacement[w].is_zero() ? " velocity"
                                               : " displacement") +
                    "' moves the wall along its normal: by " +
                    std::to_string(path) + " m until t = " + std::to_string(t) +
                    " s. Except in total Lagrangian steps, walls of the grid "
                    "only move tangentially (or by a tenth of a cell, " +
                    std::to_string(0.1 * h) +
                    " m): take one of 'Simulation/Rigid bodies' as a piston.");
              }
          }
  }



  template <int dim>
  std::vector<unsigned int>
  Walls<dim>::constrained_functions(const SplineSpace<dim> &space,
                                    const unsigned int      component) const
  {
    std::vector<unsigned int> result;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (constrains(w, component))
        for (const unsigned int i : coefficients_at(space, w))
          result.push_back(i);
    return result;
  }



  template <int dim>
  bool
  Walls<dim>::have_moving() const
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (is_moving(w))
        return true;
    return false;
  }



  template <int dim>
  template <typename Value>
  void
  Walls<dim>::impose(VectorField<dim> &field, const Value &value_at) const
  {
    const auto set = [&]() {
      for (unsigned int w = 0; w < 2 * dim; ++w)
        if (const unsigned int components = constrained_components(w))
          for (unsigned int k = 0; k < coefficients[w].size(); ++k)
            {
              const Tensor<1, dim> value = value_at(w, abscissae[w][k]);
              for (unsigned int c = 0; c < dim; ++c)
                if ((components >> c) & 1)
                  field[c].local_element(coefficients[w][k]) = value[c];
            }
    };
    // Some processes have no coefficients whose formulas can fail.
    if (have_moving())
      run_or_fail(field[0].get_mpi_communicator(), set);
    else
      set();
  }



  template <int dim>
  void
  Walls<dim>::impose_velocity(VectorField<dim> &field,
                              const WallTime   &time) const
  {
    impose(field, [&](const unsigned int w, const Point<dim> &x) {
      return velocity_at(w, x, time);
    });
  }



  template <int dim>
  void
  Walls<dim>::impose_acceleration(VectorField<dim> &field,
                                  const WallTime   &before,
                                  const WallTime   &after,
                                  const double      dt) const
  {
    impose(field, [&](const unsigned int w, const Point<dim> &x) {
      return dt > 0.
               ? (velocity_at(w, x, after) - velocity_at(w, x, before)) / dt
               : Tensor<1, dim>();
    });
  }



  template <int dim>
  unsigned char
  Walls<dim>::constrained_components(const unsigned int wall) const
  {
    unsigned char result = 0;
    for (unsigned int c = 0; c < dim; ++c)
      result |= constrains(wall, c) << c;
    return result;
  }



  template <int dim>
  WallSums<dim>
  Walls<dim>::constrained_sums(const VectorField<dim> &field) const
  {
    WallSums<dim> sums;
    add_constrained(sums, [&](const unsigned int c, const unsigned int i) {
      return field[c].local_element(i);
    });
    return sums;
  }



  template <int dim>
  WallSums<dim>
  Walls<dim>::add_contact(VectorField<dim> &v,
                          VectorField<dim> &acceleration,
                          const double      dt,
                          const VectorType &lumped_mass) const
  {
    WallSums<dim> impulses;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (is_friction(w))
        {
          const unsigned int normal = w / 2;
          const double       sign   = w % 2 == 0 ? -1. : 1.;
          for (const unsigned int i : coefficients[w])
            {
              const double v_n = sign * v[normal].local_element(i);
              if (v_n <= 0.)
                continue;
              Tensor<1, dim> change, v_t;
              for (unsigned int c = 0; c < dim; ++c)
                if (c != normal)
                  v_t[c] = v[c].local_element(i);
              change[normal] = -sign * v_n;
              if (v_t.norm() > 0.)
                change -= std::min(friction[w] * v_n / v_t.norm(), 1.) * v_t;
              impulses[w] += lumped_mass.local_element(i) * change;
              for (unsigned int c = 0; c < dim; ++c)
                {
                  v[c].local_element(i) += change[c];
                  if (dt > 0.)
                    acceleration[c].local_element(i) += change[c] / dt;
                }
            }
        }
    return impulses;
  }



  template <int dim>
  void
  Walls<dim>::stop(VectorField<dim> &v) const
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (is_friction(w))
        for (const unsigned int i : coefficients[w])
          {
            double &v_n = v[w / 2].local_element(i);
            v_n         = w % 2 == 0 ? std::max(0., v_n) : std::min(0., v_n);
          }
  }



  GREVILLE_INSTANTIATE_CLASS(Walls);
} // namespace greville
