// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/spline/extension.h>

#include <tests.h>

// The filled fraction of a cell, as a function of its lattice index.
template <int dim>
using Filling = std::function<double(const MultiIndex<dim> &)>;



// From a drawing, rows from the top to the bottom: # is well-filled, + cut.
inline Filling<2>
drawing(const std::vector<std::string> &rows)
{
  return [rows](const MultiIndex<2> &cell) {
    const char c = rows[rows.size() - 1 - cell[1]][cell[0]];
    return c == '#' ? 1. : c == '+' ? 0.3 : 0.;
  };
}



// A ball with a layer of cut cells, and a fragment in the last corner.
template <int dim>
Filling<dim>
ball(const unsigned int n, const double center, const double radius)
{
  return [=](const MultiIndex<dim> &cell) {
    double square = 0.;
    bool   corner = true;
    for (unsigned int d = 0; d < dim; ++d)
      {
        square += std::pow(cell[d] + 0.5 - center, 2);
        corner = corner && cell[d] + 1 == n;
      }
    const double distance = std::sqrt(square);
    return distance < radius ? 1. : distance < radius + 1. || corner ? 0.3 : 0.;
  };
}



template <int dim>
std::vector<double>
fillings(const SplineSpace<dim> &space, const Filling<dim> &filling)
{
  std::vector<double> result;
  for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
    result.push_back(filling(space.box(cell).index));
  return result;
}



// The coefficient of the product of (x_d - 0.3 (d + 1))^p.
template <int dim>
double
coefficient(const SplineSpace<dim> &space, const std::uint64_t position)
{
  const auto i       = multi_index<dim>(position, space.n_functions());
  double     product = 1.;
  for (unsigned int d = 0; d < dim; ++d)
    for (unsigned int k = 1; k <= space.degree(); ++k)
      product *= space.knots(d).knots()[i[d] + k] - 0.3 * (d + 1);
  return product;
}
