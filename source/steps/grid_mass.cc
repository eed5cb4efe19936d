// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/mass/fmpm.h>
#include <greville/steps/consistent_mass.h>
#include <greville/steps/lumped_mass.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  template <int dim>
  GridMass<dim>::GridMass(const OrderHierarchy<dim> &orders,
                          const Walls<dim>          &walls)
    : orders(orders)
  {
    space().initialize_vector(lumped_mass);
    constrained      = constrained_components_at_walls(space(), walls);
    wall_constrained = constrained;
  }



  template <int dim>
  void
  GridMass<dim>::set_constrained(
    std::vector<unsigned char>              &components,
    std::vector<ConstrainedDirections<dim>> &directions)
  {
    const MPI_Comm            comm = space().communicator();
    std::vector<unsigned int> of_all{components != constrained ||
                                       !(directions == oblique),
                                     !directions.empty()};
    Utilities::MPI::max(of_all, comm, of_all);
    AssertThrow(of_all[1] == 0 || is_diagonal(),
                ErrorOnAll("A contact constrains velocities along a normal "
                           "that is not an axis of the grid, which needs "
                           "'Scheme/Mass' = lumped, not <" +
                           solver() + ">."));
    if (of_all[0] == 0)
      return;
    constrained.swap(components);
    oblique.swap(directions);
    update_constrained();
  }



  template <int dim>
  void
  GridMass<dim>::constrain(const Constraints<dim> &more)
  {
    Constraints<dim>                        reduced = more;
    std::vector<ConstrainedDirections<dim>> directions =
      reduced.reduce(wall_constrained);
    std::vector<unsigned char> now = with_ghosts(space(), reduced.components);
    for (unsigned int f = 0; f < now.size(); ++f)
      now[f] |= wall_constrained[f];
    set_constrained(now, directions);
  }



  template <int dim>
  void
  GridMass<dim>::release()
  {
    std::vector<unsigned char>              now = wall_constrained;
    std::vector<ConstrainedDirections<dim>> none;
    set_constrained(now, none);
  }



  template <int dim>
  Tensor<1, dim>
  GridMass<dim>::free_part(const unsigned int i, Tensor<1, dim> vector) const
  {
    for (unsigned int c = 0; c < dim; ++c)
      if ((constrained[i] >> c) & 1)
        vector[c] = 0.;
    if (oblique.empty())
      return vector;
    const auto found = std::lower_bound(oblique.begin(),
                                        oblique.end(),
                                        i,
                                        [](const ConstrainedDirections<dim> &a,
                                           const unsigned int function) {
                                          return a.function < function;
                                        });
    if (found != oblique.end() && found->function == i)
      vector -= found->part_along(vector);
    return vector;
  }



  template <int dim>
  std::array<bool, dim>
  GridMass<dim>::constrained_components_with_mass() const
  {
    std::vector<unsigned int> found(dim, 0);
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      if (constrained[i] != 0 && lumped_mass.local_element(i) > 0.)
        for (unsigned int c = 0; c < dim; ++c)
          found[c] |= (constrained[i] >> c) & 1;
    Utilities::MPI::max(found, space().communicator(), found);
    std::array<bool, dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      result[c] = found[c] != 0;
    return result;
  }



  template <int dim>
  void
  GridMass<dim>::constrained_residual(VectorField<dim>       &residual,
                                      const VectorField<dim> &b,
                                      const VectorField<dim> &x) const
  {
    const auto meets_mass = constrained_components_with_mass();
    multiply_constrained_rows(residual, x, meets_mass);
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int i = 0; i < b[c].locally_owned_size(); ++i)
        {
          const double m = lumped_mass.local_element(i);
          double      &r = residual[c].local_element(i);
          r = meets_mass[c] && ((constrained[i] >> c) & 1) && m > 0.
                ? (b[c].local_element(i) - r) / m
                : 0.;
        }
    for (const ConstrainedDirections<dim> &at : oblique)
      {
        const unsigned int i = at.function;
        const double       m = lumped_mass.local_element(i);
        if (!(m > 0.))
          continue;
        const Tensor<1, dim> part =
          at.part_along(values_at<dim>(b, i) / m - values_at<dim>(x, i));
        for (unsigned int c = 0; c < dim; ++c)
          if (!((constrained[i] >> c) & 1))
            residual[c].local_element(i) = part[c];
      }
    distribute_levels(residual);
  }



  template <int dim>
  std::uint64_t
  GridMass<dim>::n_active() const
  {
    std::uint64_t n = 0;
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      n += lumped_mass.local_element(i) > 0.;
    return Utilities::MPI::sum(n, space().communicator());
  }



  template <int dim>
  std::unique_ptr<GridMass<dim>>
  make_grid_mass(const OrderHierarchy<dim>  &orders,
                 const SimulationParameters &parameters,
                 const Walls<dim>           &walls)
  {
    const std::string &mass = parameters.scheme.mass;
    if (const unsigned int n_terms = n_fmpm_terms(mass))
      return std::make_unique<LumpedMass<dim>>(n_terms, orders, walls);
    Require(parameters.scheme.has_consistent_mass(),
            "Unknown mass <" + mass + ">.");
    return std::make_unique<ConsistentMass<dim>>(orders, parameters, walls);
  }



  GREVILLE_INSTANTIATE_CLASS(GridMass);
  GREVILLE_INSTANTIATE(make_grid_mass);
} // namespace greville
