// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/lac/full_matrix.h>

#include <greville/mass/mass_operator.h>
#include <greville/spline/extension.h>

#include <tests.h>

// E^T M~ E by its definition, on one process. Inactive coefficients have a zero
// diagonal entry.
template <int dim>
FullMatrix<double>
dense(const SplineSpace<dim>                         &space,
      const DensityWeights<dim>                      &weights,
      const Extension<dim>                           &extension,
      const std::function<bool(const std::uint64_t)> &is_constrained)
{
  const unsigned int           n = space.n_dofs();
  const CrossMassOperator<dim> cross(space, space, weights);
  FullMatrix<double>           M(n, n), lumped(n, n), E(n, n), product(n, n);
  VectorType                   unit, column;
  space.initialize_vector(unit);
  space.initialize_vector(column);
  for (unsigned int j = 0; j < n; ++j)
    {
      unit    = 0.;
      unit(j) = 1.;
      cross.vmult(column, unit);
      for (unsigned int i = 0; i < n; ++i)
        M(i, j) = column(i);
    }
  lumped = M;
  for (unsigned int i = 0; i < n; ++i)
    for (unsigned int j = 0; j < i; ++j)
      if (extension[i] == Extension<dim>::lumped ||
          extension[j] == Extension<dim>::lumped)
        {
          lumped(i, i) += M(i, j);
          lumped(j, j) += M(i, j);
          lumped(i, j) -= M(i, j);
          lumped(j, i) -= M(i, j);
        }
  std::vector<std::uint64_t> positions;
  std::vector<double>        row;
  for (unsigned int i = 0; i < n; ++i)
    if (is_constrained(i))
      continue;
    else if (extension[i] != Extension<dim>::extended)
      E(i, i) = 1.;
    else
      {
        extension.row(i, positions, row);
        for (unsigned int k = 0; k < row.size(); ++k)
          if (!is_constrained(positions[k]))
            E(i, positions[k]) = row[k];
      }
  lumped.mmult(product, E);
  E.Tmmult(M, product);
  return M;
}
