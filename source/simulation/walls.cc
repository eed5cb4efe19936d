#include <greville/simulation/walls.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  template <int dim>
  Walls<dim>::Walls(const WallParameters &parameters)
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      {
        type[w]     = parameters.type[w];
        friction[w] = parameters.friction[w];
        if (type[w] == "moving")
          velocity[w] =
            make_expressions(parameters.velocity[w],
                             "Walls/" + WallParameters::names[w] + " velocity",
                             {"t"},
                             dim);
      }
  }



  namespace
  {
    /**
     * Owned coefficients at a wall.
     */
    template <int dim>
    std::vector<unsigned int>
    coefficients_at(const SplineSpace<dim> &space, const unsigned int wall)
    {
      const unsigned int d   = wall / 2;
      const unsigned int end = wall % 2 == 0 ? 0 : space.n_functions()[d] - 1;
      std::vector<unsigned int> result;
      for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
        if (multi_index<dim>(space.owned_functions()[i],
                             space.n_functions())[d] == end)
          result.push_back(i);
      return result;
    }
  } // namespace



  template <int dim>
  void
  Walls<dim>::reinit(const SplineSpace<dim> &space)
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      coefficients[w] = coefficients_at(space, w);
  }



  template <int dim>
  bool
  Walls<dim>::holds(const unsigned int wall, const unsigned int component) const
  {
    return type[wall] == "fixed" || type[wall] == "moving" ||
           (type[wall] != "free" && wall / 2 == component);
  }



  template <int dim>
  Constraints
  Walls<dim>::constraints(const SplineSpace<dim> &space,
                          const unsigned int      component) const
  {
    Constraints result;
    result.reinit(space.locally_owned_dofs());
    const auto first = space.partitioner()->local_range().first;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (holds(w, component))
        for (const unsigned int i : coefficients_at(space, w))
          result.add_line(first + i);
    result.close();
    return result;
  }



  template <int dim>
  bool
  Walls<dim>::hold_the_same(const unsigned int a, const unsigned int b) const
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (holds(w, a) != holds(w, b))
        return false;
    return true;
  }



  template <int dim>
  bool
  Walls<dim>::move() const
  {
    for (const std::string &name : type)
      if (name == "moving")
        return true;
    return false;
  }



  template <int dim>
  void
  Walls<dim>::hold_velocity(VectorField<dim> &field, const double t) const
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      for (unsigned int c = 0; c < dim; ++c)
        if (holds(w, c))
          {
            const double value =
              type[w] == "moving"
                ? velocity[w][c](ArrayView<const double>(&t, 1))
                : 0.;
            for (const unsigned int i : coefficients[w])
              field[c].local_element(i) = value;
          }
  }



  template <int dim>
  void
  Walls<dim>::hold_acceleration(VectorField<dim> &field,
                                const double      t,
                                const double      dt) const
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      for (unsigned int c = 0; c < dim; ++c)
        if (holds(w, c))
          {
            double value = 0.;
            if (type[w] == "moving" && dt > 0.)
              {
                const double next = t + dt;
                value = (velocity[w][c](ArrayView<const double>(&next, 1)) -
                         velocity[w][c](ArrayView<const double>(&t, 1))) /
                        dt;
              }
            for (const unsigned int i : coefficients[w])
              field[c].local_element(i) = value;
          }
  }



  template <int dim>
  void
  Walls<dim>::add_friction(const VectorField<dim> &momentum,
                           VectorField<dim>       &force,
                           const double            dt) const
  {
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (type[w] == "friction" && friction[w] > 0. && dt > 0.)
        {
          const unsigned int normal = w / 2;
          const double       sign   = w % 2 == 0 ? -1. : 1.;
          for (const unsigned int i : coefficients[w])
            {
              const double push =
                std::max(0., sign * force[normal].local_element(i));
              Tensor<1, dim> slip;
              for (unsigned int c = 0; c < dim; ++c)
                if (c != normal)
                  slip[c] = momentum[c].local_element(i) / dt +
                            force[c].local_element(i);
              const double size = slip.norm();
              if (size > 0.)
                for (unsigned int c = 0; c < dim; ++c)
                  force[c].local_element(i) -=
                    std::min(friction[w] * push, size) / size * slip[c];
            }
        }
  }



  template class Walls<2>;
  template class Walls<3>;
} // namespace greville
