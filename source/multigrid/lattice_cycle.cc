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
    // Lattices become coarser until a matrix has so few rows. A matrix of more
    // than the second number of rows is smoothed, not factorized.
    constexpr unsigned int small_size = 250, largest_direct_size = 1200;

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

    /// Return the number of functions of order 1 of a lattice.
    template <typename Lattice>
    std::uint64_t
    n_functions_of_order_1(const Lattice &lattice)
    {
      std::uint64_t result = 1;
      for (const NestedKnots &direction : lattice)
        if (direction.degree() > 0)
          result *= direction.n_cells() + !direction.is_periodic();
      return result;
    }
  } // namespace



  template <int dim>
  LatticeCycle<dim>::LatticeCycle(std::unique_ptr<ExtendedLattice<dim>> finest,
                                  const LatticeCycleParameters &parameters)
    : finest(std::move(finest))
    , parameters(parameters)
  {
    coarsen();
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        Level                   &level  = levels[l];
        const InterleavedLayout &layout = level.matrix->layout();
        for (SingleVector *vector :
             {&level.x, &level.b, &level.step, &level.product})
          vector->reinit(layout.partitioner(level.matrix->n_components()));
        const bool is_last = l > 0 && l + 1 == levels.size();
        if (is_last)
          make_direct_matrix();
        if (!is_last || parameters.lowers_order || direct_matrix.m() == 0)
          make_smoother(level);
        if (!level.factors.empty())
          estimate_eigenvalue(level);
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::coarsen()
  {
    const LatticeLevel<dim> *last     = finest.get();
    const auto               is_small = [&](const LatticeLevel<dim> &level) {
      return parameters.lowers_order ? n_functions_of_order_1(level.lattice()) *
                                           level.n_components() <=
                                         largest_direct_size
                                                   : n_rows(level) <= small_size;
    };
    while ((last == finest.get() || !is_small(*last)) &&
           LatticeMatrix<dim>::can_coarsen(*last))
      {
        auto next = std::make_unique<LatticeMatrix<dim>>(*last);
        // Bodies of a few functions each have more coarse unknowns.
        if (n_rows(*next) > 2 * n_rows(*finest))
          break;
        coarse.push_back(std::move(next));
        last = coarse.back().get();
      }
    levels.resize(coarse.size() + 1);
    levels[0].matrix = finest.get();
    for (unsigned int l = 1; l < levels.size(); ++l)
      levels[l].matrix = coarse[l - 1].get();
  }



  template <int dim>
  void
  LatticeCycle<dim>::make_smoother(Level &level)
  {
    level.factors =
      level.matrix->factorize({parameters.shift, 0.}, parameters.by_components);
    level.constrained = level.matrix->constrained_unknowns();
    if (std::all_of(level.constrained.begin(),
                    level.constrained.end(),
                    [](const unsigned char bits) { return bits == 0; }))
      level.constrained.clear();
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
          for (unsigned int e = 0; e < 3; ++e)
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
    const Level &level  = levels[l];
    const auto  &last   = levels.back();
    const bool   direct = &level == &last && direct_matrix.m() > 0;
    level.x             = 0.f;
    if (level.factors.empty())
      {
        add_direct_solution(level.x, level.b);
        return;
      }
    smooth(level);
    subtract_product(level, level.step);
    if (direct || &level != &last)
      {
        level.step = 0.f;
        if (direct)
          add_direct_solution(level.step, level.b);
        else
          {
            const LatticeUnknowns<dim> &unknowns = coarse[l]->unknowns();
            unknowns.restrict(levels[l + 1].b, level.b);
            cycle(l + 1);
            unknowns.prolongate_and_add(level.step, levels[l + 1].x);
          }
        level.x.add(1.f, level.step);
        subtract_product(level, level.step);
      }
    smooth(level);
  }



  template <int dim>
  void
  LatticeCycle<dim>::make_direct_matrix()
  {
    const LatticeMatrix<dim> &last       = *coarse.back();
    const unsigned int        components = last.n_components();
    const InterleavedLayout  &layout     = last.layout();
    const auto               &positions  = last.unknowns().positions();
    const auto                lattice    = last.lattice();
    const std::uint64_t       n_columns =
      parameters.lowers_order ? n_functions_of_order_1(lattice) * components
                                    : n_rows(last);
    if (n_columns > largest_direct_size)
      return;
    const auto columns =
      [&](const unsigned int u, const unsigned int c, const auto &add) {
        if (!parameters.lowers_order)
          {
            add(layout.global_number(u) * components + c, 1.);
            return;
          }
        std::vector<std::pair<unsigned int, double>> terms{{0, 1.}};
        for (unsigned int d = 3; d-- > 0;)
          {
            const NestedKnots &knots = lattice[d];
            if (knots.degree() == 0)
              continue;
            const unsigned int n    = knots.n_cells() + !knots.is_periodic();
            const auto [cell, part] = knots.greville_point(positions[u][d]);
            std::vector<std::pair<unsigned int, double>> product;
            for (const auto &[number, weight] : terms)
              {
                product.emplace_back(number * n + cell, weight * (1. - part));
                if (part > 0.)
                  product.emplace_back(number * n + (cell + 1) % n,
                                       weight * part);
              }
            terms = product;
          }
        for (const auto &[number, weight] : terms)
          add(number * components + c, weight);
      };
    direct_begin.assign(1, 0);
    for (unsigned int u = 0; u < layout.n_owned(); ++u)
      for (unsigned int c = 0; c < components; ++c)
        {
          if (!last.unknowns().is_constrained(u, c))
            columns(u, c, [&](const unsigned int column, const double weight) {
              direct_columns.emplace_back(column, weight);
            });
          direct_begin.push_back(direct_columns.size());
        }
    direct_values.reinit(n_columns);
    factorize_direct_matrix(last.reduced_entries(n_columns, columns));
  }



  template <int dim>
  void
  LatticeCycle<dim>::factorize_direct_matrix(std::vector<double> entries)
  {
    // Functions can be linearly dependent, and tangents indefinite: the
    // diagonal is raised as far as necessary.
    constexpr double   smallest_shift = 1e-6, largest_shift = 10., growth = 30.;
    const unsigned int n = direct_values.size();
    for (double shift = smallest_shift; shift < largest_shift; shift *= growth)
      {
        direct_matrix.reinit(n, n);
        direct_matrix.set_property(LAPACKSupport::symmetric);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            direct_matrix(i, j) = entries[std::size_t(i) * n + j];
        for (unsigned int i = 0; i < n; ++i)
          if (entries[std::size_t(i) * n + i] > 0.)
            direct_matrix(i, i) *= 1. + shift;
          else
            direct_matrix(i, i) = 1.;
        try
          {
            direct_matrix.compute_cholesky_factorization();
            return;
          }
        catch (const ExceptionBase &)
          {}
      }
    direct_matrix.reinit(0, 0);
  }



  template <int dim>
  void
  LatticeCycle<dim>::add_direct_solution(SingleVector       &x,
                                         const SingleVector &b) const
  {
    direct_values = 0.;
    for (unsigned int i = 0; i < b.locally_owned_size(); ++i)
      for (std::size_t k = direct_begin[i]; k < direct_begin[i + 1]; ++k)
        direct_values[direct_columns[k].first] +=
          direct_columns[k].second * b.local_element(i);
    const MPI_Comm comm = coarse.back()->layout().communicator();
    if (Utilities::MPI::n_mpi_processes(comm) > 1)
      Utilities::MPI::sum(direct_values, comm, direct_values);
    direct_matrix.solve(direct_values);
    for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
      {
        double sum = 0.;
        for (std::size_t k = direct_begin[i]; k < direct_begin[i + 1]; ++k)
          sum +=
            direct_columns[k].second * direct_values[direct_columns[k].first];
        x.local_element(i) += float(sum);
      }
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
    const unsigned int n         = finest->n_components();
    const auto        &functions = finest->unknown_functions();
    for (unsigned int u = 0; u < functions.size(); ++u)
      for (unsigned int c = 0; c < n; ++c)
        level.b.local_element(u * n + c) =
          !level.constrained.empty() && ((level.constrained[u] >> c) & 1)
            ? 0.f
            : float(src.local_element(functions[u] * n + c) / largest);
    cycle(0);
    const double scale = largest / finest->unit();
    for (unsigned int u = 0; u < functions.size(); ++u)
      for (unsigned int c = 0; c < n; ++c)
        dst.local_element(functions[u] * n + c) =
          scale * level.x.local_element(u * n + c);
  }



  GREVILLE_INSTANTIATE_CLASS(LatticeCycle);
} // namespace greville
