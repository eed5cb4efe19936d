// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/index_set.h>

#include <greville/contact/contact_tangent.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  ContactTangent<dim>::begin(std::vector<Key>                &&own_keys,
                             const std::uint64_t               first,
                             const std::vector<std::uint64_t> &numbers,
                             const MPI_Comm                    comm)
  {
    keys = std::move(own_keys);
    sides.clear();
    have_pores.clear();
    ends.clear();
    shares.clear();
    const std::uint64_t n_keys =
      Utilities::MPI::sum<std::uint64_t>(keys.size(), comm);
    if (n_keys == 0)
      {
        // deal.II does not exchange vectors without entries.
        values.reinit(0);
        return;
      }
    IndexSet owned(n_keys * size), ghosts(n_keys * size);
    owned.add_range(first * size, (first + keys.size()) * size);
    for (const std::uint64_t number : numbers)
      if (number < first || number >= first + keys.size())
        ghosts.add_range(number * size, (number + 1) * size);
    owned.compress();
    ghosts.compress();
    values.reinit(owned, ghosts, comm);
  }



  template <int dim>
  void
  ContactTangent<dim>::add_point(const unsigned int side, const bool has_pores)
  {
    sides.push_back(side);
    have_pores.push_back(has_pores);
    ends.push_back(shares.size());
  }



  template <int dim>
  void
  ContactTangent<dim>::add_share(const std::uint64_t number,
                                 const double        weight)
  {
    shares.push_back(
      {values.get_partitioner()->global_to_local(number * size), weight});
    ends.back() = shares.size();
  }



  template <int dim>
  void
  ContactTangent<dim>::multiply(
    const std::vector<Tensor<1, dim>> &displacements,
    std::vector<Tensor<1, dim>>       &forces,
    const std::vector<double>         *pore_pressures) const
  {
    AssertThrow(displacements.size() == sides.size(),
                ExcDimensionMismatch(displacements.size(), sides.size()));
    values = 0.;
    for (std::size_t s = 0, k = 0; s < sides.size(); ++s)
      for (; k < ends[s]; ++k)
        {
          const unsigned int first = shares[k].place + sides[s] * dim;
          for (unsigned int d = 0; d < dim; ++d)
            values.local_element(first + d) +=
              shares[k].weight * displacements[s][d];
          if (pore_pressures && have_pores[s])
            values.local_element(shares[k].place + 2 * dim) +=
              shares[k].weight * (*pore_pressures)[s];
        }
    values.compress(VectorOperation::add);
    for (unsigned int k = 0; k < keys.size(); ++k)
      {
        const Key     &key = keys[k];
        Tensor<1, dim> u;
        for (unsigned int d = 0; d < dim; ++d)
          u[d] =
            key.inverse_weights[0] * values.local_element(k * size + d) -
            key.inverse_weights[1] * values.local_element(k * size + dim + d);
        const Tensor<1, dim> force =
          key.stiffness * u -
          values.local_element(k * size + 2 * dim) * key.by_pore_pressure;
        for (unsigned int d = 0; d < dim; ++d)
          {
            values.local_element(k * size + d) =
              -key.inverse_weights[0] * force[d];
            values.local_element(k * size + dim + d) =
              key.inverse_weights[1] * force[d];
          }
      }
    values.update_ghost_values();
    forces.assign(sides.size(), Tensor<1, dim>());
    for (std::size_t s = 0, k = 0; s < sides.size(); ++s)
      for (; k < ends[s]; ++k)
        {
          const unsigned int first = shares[k].place + sides[s] * dim;
          for (unsigned int d = 0; d < dim; ++d)
            forces[s][d] += shares[k].weight * values.local_element(first + d);
        }
    values.zero_out_ghost_values();
  }



  GREVILLE_INSTANTIATE_CLASS(ContactTangent);
} // namespace greville
