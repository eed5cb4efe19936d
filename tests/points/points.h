// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

// Shared by the tests of particles: points whose numbers depend on their id
// only, and B-splines evaluated function by function by KnotVector.

#include <greville/points/material_points.h>
#include <greville/points/point_transport.h>

#include <functional>
#include <map>
#include <tests.h>

// Numbers between -1 and 1 that are the same everywhere (splitmix64 of G.
// Steele, D. Lea and C. Flood: quick to begin with any seed).
class Random
{
public:
  Random(const std::uint64_t seed)
    : state(seed * 0xD1342543DE82EF95ull)
  {}

  double
  operator()()
  {
    std::uint64_t z = (state += 0x9E3779B97F4A7C15ull);
    z               = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z               = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    z ^= z >> 31;
    return (z >> 11) * (2. / 9007199254740992.) - 1.;
  }

private:
  std::uint64_t state;
};



template <int dim>
std::vector<double>
numbers_of(const MaterialPoints<dim> &points, const ConstPointRef<dim> p)
{
  std::vector<double> values;
  for (unsigned int k = 0; k < points.layout().size; ++k)
    values.push_back(p[k]);
  return values;
}



// All points of this process by their ids.
template <int dim>
std::map<std::uint64_t, std::vector<double>>
by_id(const MaterialPoints<dim> &points)
{
  std::map<std::uint64_t, std::vector<double>> result;
  points.for_each([&](const unsigned int, const auto p) {
    result[p.id()] = numbers_of<dim>(points, p);
  });
  return result;
}



// With n_state history variables, APIC's matrix and an acceleration by loads.
template <int dim>
PointLayout<dim>
make_layout(const unsigned int n_state,
            const bool         has_affine,
            const bool         has_load)
{
  std::vector<std::string> names;
  for (unsigned int k = 0; k < n_state; ++k)
    names.push_back("state " + std::to_string(k));
  PointLayout<dim> layout(names);
  if (has_affine)
    layout.add("affine", dim * dim);
  if (has_load)
    layout.add("load", dim);
  return layout;
}



// Points with n per direction in each cell, moved at random by at most jitter
// times half their distance, all numbers of which are random. A part of them is
// left out, so that groups have empty lanes.
template <int dim>
void
random_points(MaterialPoints<dim>    &points,
              const SplineSpace<dim> &space,
              const PointLayout<dim> &layout,
              const MultiIndex<dim>  &n,
              const double            jitter,
              const std::uint64_t     seed     = 1,
              const double            left_out = 0.)
{
  points.reinit(space, layout);
  unsigned int n_in_cell = 1;
  for (unsigned int d = 0; d < dim; ++d)
    n_in_cell *= n[d];
  std::vector<double> values(layout.size);
  const PointRef<dim> p(values.data());
  for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
    {
      const CellBox<dim> box = space.box(cell);
      for (unsigned int k = 0; k < n_in_cell; ++k)
        {
          const std::uint64_t id = space.owned_cells()[cell] * n_in_cell + k;
          Random              random(1000 * id + seed);
          if (0.5 + 0.5 * random() < left_out)
            continue;
          for (double &value : values)
            value = random();
          const auto local  = multi_index<dim>(k, n);
          double     volume = 1.;
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double h = box.size[d] / n[d];
              volume *= h;
              p.position(d) =
                box.lower[d] + h * (local[d] + 0.5 + 0.5 * jitter * random());
              p.reference(d) = p.position(d);
            }
          p.mass()       = volume * (2. + random());
          p.volume0()    = volume * (1. + 0.1 * random());
          Tensor<2, 3> F = unit_symmetric_tensor<3>();
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              F[i][j] += 0.1 * random();
          if (dim == 2)
            F[2][2] += 0.1 * random();
          p.set_F(F);
          p.J()  = determinant(F);
          p.id() = id;
          points.insert(cell, make_array_view(values));
        }
    }
}



// Univariate functions at x, as KnotVector evaluates them.
struct Splines1D
{
  Splines1D(const KnotVector &knots, const double x)
    : N(knots.degree() + 1)
    , dN(knots.degree() + 1)
  {
    const unsigned int element = knots.find_element(x);
    first                      = knots.first_function(element);
    knots.evaluate(element, x, 0, make_array_view(N));
    knots.evaluate(element, x, 1, make_array_view(dN));
  }

  std::vector<double> N, dN;
  unsigned int        first;
};



// Call action(position of the function, its Greville point, value, gradient)
// for the functions that do not vanish at x.
template <int dim>
void
for_each_function(const SplineSpace<dim>                            &space,
                  const Point<dim>                                  &x,
                  const std::function<void(const std::uint64_t,
                                           const Point<dim> &,
                                           const double,
                                           const Tensor<1, dim> &)> &action)
{
  std::vector<Splines1D> splines;
  for (unsigned int d = 0; d < dim; ++d)
    splines.emplace_back(space.knots(d), x[d]);
  MultiIndex<dim> extents;
  extents.fill(space.degree() + 1);
  for (unsigned int a = 0; a < Utilities::pow(space.degree() + 1, dim); ++a)
    {
      const auto      local = multi_index<dim>(a, extents);
      MultiIndex<dim> index;
      Point<dim>      xi;
      double          value = 1.;
      Tensor<1, dim>  gradient;
      for (unsigned int d = 0; d < dim; ++d)
        {
          index[d] = splines[d].first + local[d];
          xi[d]    = space.knots(d).greville_abscissa(index[d]);
          value *= splines[d].N[local[d]];
          gradient[d] = 1.;
          for (unsigned int e = 0; e < dim; ++e)
            gradient[d] *=
              (d == e ? splines[e].dN[local[e]] : splines[e].N[local[e]]);
        }
      action(lexicographic<dim>(index, space.n_functions()),
             xi,
             value,
             gradient);
    }
}



// Sums of functions over points, of all processes, n_fields per function.
template <int dim>
class DirectSums
{
public:
  DirectSums(const SplineSpace<dim> &space, const unsigned int n_fields)
    : space(space)
    , n_fields(n_fields)
    , sums(n_fields * space.n_dofs(), 0.)
  {}

  double &
  operator()(const std::uint64_t function, const unsigned int field)
  {
    return sums[function * n_fields + field];
  }

  void
  add_processes()
  {
    Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
  }

  // The largest difference, relative to the largest sum.
  double
  difference(const VectorType &vector, const unsigned int field) const
  {
    double largest = 0., error = 0.;
    for (std::size_t i = 0; i < space.n_dofs(); ++i)
      largest = std::max(largest, std::abs(sums[i * n_fields + field]));
    for (unsigned int i = 0; i < space.owned_functions().size(); ++i)
      error =
        std::max(error,
                 std::abs(vector.local_element(i) -
                          sums[space.owned_functions()[i] * n_fields + field]));
    return max_all(error) / largest;
  }

private:
  const SplineSpace<dim> &space;
  const unsigned int      n_fields;
  std::vector<double>     sums;
};



// The largest difference between the numbers of two sets of points with the
// same ids; 1e300 for others.
template <int dim>
double
difference(const MaterialPoints<dim> &a, const MaterialPoints<dim> &b)
{
  const auto x = by_id(a), y = by_id(b);
  double     error = x.size() == y.size() ? 0. : 1e300;
  for (const auto &point : x)
    {
      const auto other = y.find(point.first);
      if (other == y.end() || other->second.size() != point.second.size())
        return 1e300;
      for (unsigned int k = 0; k < point.second.size(); ++k)
        error = std::max(error, std::abs(point.second[k] - other->second[k]));
    }
  return error;
}



// Return whether a condition holds on all processes.
inline bool
on_all(const bool condition)
{
  return Utilities::MPI::min<int>(condition, MPI_COMM_WORLD) == 1;
}



// Lanes without a point have no mass and lie at the centre of their cell.
template <int dim>
bool
empty_lanes_are_harmless(const MaterialPoints<dim> &points)
{
  using Layout = PointLayout<dim>;
  bool ok      = true;
  for (const unsigned int cell : points.cells())
    {
      const Point<dim> center = points.space().box(cell).center;
      for (unsigned int lane = points.n_in_first_group(cell);
           lane < MaterialPoints<dim>::width;
           ++lane)
        {
          const ConstPointRef<dim> p =
            points.point(points.first_group(cell), lane);
          ok &= p.position().distance(center) < 1e-14;
          for (unsigned int k = dim; k < points.layout().size; ++k)
            {
              const bool is_F   = k >= Layout::F && k < Layout::F + Layout::n_F;
              const bool is_one = k == Layout::J ||
                                  (is_F && dim == 2 && k == Layout::F + 4) ||
                                  (is_F && k < Layout::F + dim * dim &&
                                   (k - Layout::F) % (dim + 1) == 0);
              ok &= p[k] == (is_one ? 1. : 0.);
            }
        }
    }
  return ok;
}
