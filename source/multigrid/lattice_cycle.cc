// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/tridiagonal_matrix.h>

#include <greville/base/errors.h>
#include <greville/multigrid/lattice_cycle.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // A level of fewer rows is the last one. A last level of more rows than the
    // second number is smoothed, not factorized.
    constexpr unsigned int small_size = 250, largest_direct_size = 1200;

    // Pivots below this part of the diagonal entry are left out.
    constexpr double smallest_pivot = 1e-5;

    unsigned int
    width_of_factors(const unsigned int n_components)
    {
      return n_components == 3 ? 4 : n_components;
    }

    template <int dim>
    std::uint64_t
    n_rows(const LatticeLevel<dim> &level)
    {
      return Utilities::MPI::sum(std::uint64_t(level.layout().n_owned()) *
                                   level.n_components(),
                                 level.layout().communicator());
    }
  } // namespace



  template <int dim>
  LatticeCycle<dim>::LatticeCycle(const ExtendedLevel<dim> &finest,
                                  const SmootherParameters &parameters,
                                  const bool                by_components)
    : finest(finest)
    , parameters(parameters)
  {
    const LatticeLevel<dim> *last = &finest;
    while (n_rows(*last) > small_size && LatticeMatrix<dim>::can_coarsen(*last))
      {
        auto next = std::make_unique<LatticeMatrix<dim>>(*last);
        // Bodies of a few functions each can have more coarse unknowns.
        if (n_rows(*next) >= n_rows(*last))
          break;
        coarse.push_back(std::move(next));
        last = coarse.back().get();
      }
    levels.resize(coarse.size() + 1);
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        levels[l].matrix = l == 0
                             ? static_cast<const LatticeLevel<dim> *>(&finest)
                             : coarse[l - 1].get();
        for (SingleVector *vector :
             {&levels[l].x, &levels[l].b, &levels[l].step, &levels[l].product})
          vector->reinit(
            matrix(l).layout().partitioner(matrix(l).n_components()));
        if (l > 0 && l + 1 == levels.size() &&
            n_rows(matrix(l)) <= largest_direct_size)
          factorize_coarsest();
        else
          {
            if (l > 0)
              coarse[l - 1]->finish();
            make_smoother(levels[l], by_components);
          }
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::make_smoother(Level &level, const bool by_components)
  {
    level.factors =
      level.matrix->factorize({parameters.shift, 0.}, by_components);
    level.constrained = level.matrix->constrained_unknowns();
    if (std::all_of(level.constrained.begin(),
                    level.constrained.end(),
                    [](const unsigned char bits) { return bits == 0; }))
      level.constrained.clear();
    estimate_eigenvalue(level);
  }



  template <int dim>
  void
  LatticeCycle<dim>::estimate_eigenvalue(Level &level) const
  {
    // Lanczos' method, by conjugate gradients. The start is a function of the
    // position only, so that the estimate does not depend on the number of
    // processes.
    constexpr unsigned int n_steps = 8;
    constexpr double       safety  = 1.2;
    const unsigned int     n       = level.matrix->n_components();
    SingleVector          &r = level.b, &z = level.product, &d = level.step;
    const auto             positions   = level.matrix->unknown_positions();
    const auto             constrained = level.matrix->constrained_unknowns();
    for (unsigned int u = 0; u < positions.size(); ++u)
      for (unsigned int c = 0; c < n; ++c)
        {
          double phase = c;
          for (unsigned int e = 0; e < dim; ++e)
            phase += (e == 0   ? 12.9898
                      : e == 1 ? 78.233
                               : 37.719) *
                     positions[u][e];
          r.local_element(u * n + c) =
            (constrained[u] >> c) & 1 ? 0.f : float(std::sin(phase));
        }
    std::vector<double> alphas, betas;
    double              r_z = 0.;
    for (unsigned int step = 0; step < n_steps; ++step)
      {
        precondition(level, z, r);
        const double new_r_z = double(r * z);
        if (!(new_r_z > 0.) || !std::isfinite(new_r_z))
          break;
        const double beta = step == 0 ? 0. : new_r_z / r_z;
        r_z               = new_r_z;
        if (step == 0)
          d = z;
        else
          d.sadd(beta, 1., z);
        level.matrix->multiply(z, d);
        z *= float(1. / level.matrix->unit());
        const double curvature = double(d * z);
        if (!(curvature > 0.) || !std::isfinite(curvature))
          break;
        const double alpha = r_z / curvature;
        r.add(float(-alpha), z);
        alphas.push_back(alpha);
        betas.push_back(beta);
      }
    AssertThrow(!alphas.empty() ||
                  Utilities::MPI::sum(positions.size(),
                                      level.matrix->layout().communicator()) ==
                    0,
                ErrorOnAll("the eigenvalues of the smoother are negative, "
                           "infinite or NaN"));
    TridiagonalMatrix<double> T(alphas.size(), true);
    for (unsigned int k = 0; k < alphas.size(); ++k)
      {
        T(k, k) = 1. / alphas[k] + (k == 0 ? 0. : betas[k] / alphas[k - 1]);
        if (k > 0)
          T(k, k - 1) = std::sqrt(betas[k]) / alphas[k - 1];
      }
    if (!alphas.empty())
      {
        T.compute_eigenvalues();
        level.largest_eigenvalue = safety * T.eigenvalue(alphas.size() - 1);
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::precondition(const Level        &level,
                                  SingleVector       &dst,
                                  const SingleVector &src) const
  {
    const unsigned int n         = level.matrix->n_components();
    const unsigned int n_columns = n / level.factors.size();
    const unsigned int width     = width_of_factors(n_columns);
    const unsigned int n_owned   = level.matrix->layout().n_owned();
    work.assign(std::size_t(n_owned) * width, 0.f);
    for (unsigned int c = 0; c < level.factors.size(); ++c)
      {
        for (unsigned int u = 0; u < n_owned; ++u)
          for (unsigned int k = 0; k < n_columns; ++k)
            work[u * width + k] = src.local_element(u * n + c * n_columns + k);
        level.factors[c].solve(work.data(), width, level.matrix->unit());
        for (unsigned int u = 0; u < n_owned; ++u)
          for (unsigned int k = 0; k < n_columns; ++k)
            dst.local_element(u * n + c * n_columns + k) = work[u * width + k];
      }
    const auto &constrained = level.constrained;
    if (constrained.empty())
      return;
    for (unsigned int u = 0; u < n_owned; ++u)
      if (constrained[u] != 0)
        for (unsigned int c = 0; c < n; ++c)
          if ((constrained[u] >> c) & 1)
            dst.local_element(u * n + c) = 0.f;
  }



  template <int dim>
  void
  LatticeCycle<dim>::subtract_product(const Level &level, SingleVector &x) const
  {
    level.matrix->multiply(level.product, x);
    level.b.add(float(-1. / level.matrix->unit()), level.product);
  }



  template <int dim>
  void
  LatticeCycle<dim>::smooth(const Level &level) const
  {
    const double upper = level.largest_eigenvalue;
    const double lower = upper / (1.2 * parameters.chebyshev_range);
    const double theta = 0.5 * (upper + lower), delta = 0.5 * (upper - lower);
    const double sigma = theta / delta;
    double       rho   = 1. / sigma;
    precondition(level, level.product, level.b);
    level.step.equ(float(1. / theta), level.product);
    level.x.add(1.f, level.step);
    for (unsigned int k = 1; k < parameters.chebyshev_degree; ++k)
      {
        subtract_product(level, level.step);
        precondition(level, level.product, level.b);
        const double next = 1. / (2. * sigma - rho);
        level.step.sadd(float(next * rho),
                        float(2. * next / delta),
                        level.product);
        level.x.add(1.f, level.step);
        rho = next;
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::cycle(const unsigned int l) const
  {
    const Level &level = levels[l];
    level.x            = 0.f;
    if (level.factors.empty())
      {
        solve_coarsest(level);
        return;
      }
    smooth(level);
    subtract_product(level, level.step);
    if (l + 1 < levels.size())
      {
        const Level &next = levels[l + 1];
        coarse[l]->restrict(next.b, level.b);
        cycle(l + 1);
        level.step = 0.f;
        coarse[l]->prolongate_and_add(level.step, next.x);
        level.x.add(1.f, level.step);
        subtract_product(level, level.step);
      }
    smooth(level);
  }



  template <int dim>
  void
  LatticeCycle<dim>::factorize_coarsest()
  {
    factors      = coarse.back()->all_entries();
    n_last       = n_rows(*coarse.back());
    const auto n = n_last;
    // The factor L by rows, with the inverse of its diagonal.
    for (std::size_t i = 0; i < n; ++i)
      {
        double *const row_i    = factors.data() + i * n;
        const double  diagonal = row_i[i];
        for (std::size_t j = 0; j <= i; ++j)
          {
            const double *row_j = factors.data() + j * n;
            double        sum   = 0.;
#pragma GCC ivdep
            for (std::size_t k = 0; k < j; ++k)
              sum += row_i[k] * row_j[k];
            if (j < i)
              row_i[j] = (row_i[j] - sum) * row_j[j];
            else
              {
                const double pivot = row_i[i] - sum;
                row_i[i]           = pivot > smallest_pivot * diagonal
                                       ? 1. / std::sqrt(pivot)
                                       : 0.;
              }
          }
      }
    right_hand_side.resize(n);
  }



  template <int dim>
  void
  LatticeCycle<dim>::solve_coarsest(const Level &level) const
  {
    const std::size_t        n      = n_last;
    const InterleavedLayout &layout = level.matrix->layout();
    const std::size_t        first =
      layout.n_owned() > 0
               ? layout.global_number(0) * level.matrix->n_components()
               : 0;
    std::vector<double> &x = right_hand_side;
    std::fill(x.begin(), x.end(), 0.);
    for (unsigned int i = 0; i < level.b.locally_owned_size(); ++i)
      x[first + i] = level.b.local_element(i);
    if (Utilities::MPI::n_mpi_processes(layout.communicator()) > 1)
      Utilities::MPI::sum(x, layout.communicator(), x);
    for (std::size_t i = 0; i < n; ++i)
      {
        const double *row = factors.data() + i * n;
        double        sum = 0.;
        for (std::size_t k = 0; k < i; ++k)
          sum += row[k] * x[k];
        x[i] = (x[i] - sum) * row[i];
      }
    for (std::size_t i = n; i-- > 0;)
      {
        const double *row = factors.data() + i * n;
        x[i] *= row[i];
        for (std::size_t k = 0; k < i; ++k)
          x[k] -= row[k] * x[i];
      }
    for (unsigned int i = 0; i < level.x.locally_owned_size(); ++i)
      level.x.local_element(i) = float(x[first + i]);
  }



  template <int dim>
  void
  LatticeCycle<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    const Level &level   = levels[0];
    const double largest = src.linfty_norm();
    dst                  = 0.;
    if (!(largest > 0.) || !std::isfinite(largest))
      return;
    const unsigned int n    = finest.n_components();
    const auto &functions   = finest.extended().unknowns().unknown_functions();
    const auto &constrained = finest.constrained_components();
    for (unsigned int u = 0; u < functions.size(); ++u)
      for (unsigned int c = 0; c < n; ++c)
        level.b.local_element(u * n + c) =
          ((constrained[functions[u]] >> c) & 1)
            ? 0.f
            : float(src.local_element(functions[u] * n + c) / largest);
    cycle(0);
    const double scale = largest / finest.unit();
    for (unsigned int u = 0; u < functions.size(); ++u)
      for (unsigned int c = 0; c < n; ++c)
        dst.local_element(functions[u] * n + c) =
          scale * level.x.local_element(u * n + c);
  }



  template class LatticeCycle<2>;
  template class LatticeCycle<3>;
} // namespace greville
