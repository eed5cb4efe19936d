// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/tridiagonal_matrix.h>

#include <greville/base/errors.h>
#include <greville/multigrid/lattice_cycle.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Lattices become coarser until a part has one level of cells and at most
    // this number of rows.
    constexpr unsigned int small_size = 250;

    // The distance between parts in a common lattice, more than any overlap.
    constexpr int far_away = 100;

    unsigned int
    width_of_factors(const unsigned int n_components)
    {
      return n_components == 3 ? 4 : n_components;
    }

    // Operations on all parts of a vector.
    using Blocks = std::vector<SingleVector>;

    void
    set_zero(Blocks &x)
    {
      for (SingleVector &part : x)
        part = 0.f;
    }

    /// Compute x = a x + b y.
    void
    sadd(Blocks &x, const double a, const double b, const Blocks &y)
    {
      for (unsigned int part = 0; part < x.size(); ++part)
        if (a == 0.)
          x[part].equ(float(b), y[part]);
        else
          x[part].sadd(float(a), float(b), y[part]);
    }

    void
    add(Blocks &x, const double b, const Blocks &y)
    {
      for (unsigned int part = 0; part < x.size(); ++part)
        x[part].add(float(b), y[part]);
    }

    double
    dot(const Blocks &x, const Blocks &y)
    {
      double sum = 0.;
      for (unsigned int part = 0; part < x.size(); ++part)
        sum += double(x[part] * y[part]);
      return sum;
    }

    template <int dim>
    typename LatticeCycle<dim>::Parts
    one_part(std::unique_ptr<ExtendedLattice<dim>> part)
    {
      typename LatticeCycle<dim>::Parts result;
      result.push_back(std::move(part));
      return result;
    }
  } // namespace



  template <int dim>
  LatticeCycle<dim>::LatticeCycle(std::unique_ptr<ExtendedLattice<dim>> finest,
                                  const LatticeCycleParameters &parameters)
    : LatticeCycle(one_part<dim>(std::move(finest)), parameters)
  {}



  template <int dim>
  LatticeCycle<dim>::LatticeCycle(Parts                         parts_,
                                  const LatticeCycleParameters &parameters,
                                  LatticeCoupling<dim>         *coupling,
                                  const bool                    coarsens,
                                  const bool                    of_unknowns)
    : parts(std::move(parts_))
    , parameters(parameters)
    , coupling(coupling)
    , of_unknowns(of_unknowns)
  {
    unit = parts[0]->unit();
    for (const auto &part : parts)
      unit = std::max(unit, part->unit());
    for (const auto &part : parts)
      part->set_unit(unit);
    coarsen(coarsens);
    for (unsigned int l = 0; l < levels.size(); ++l)
      {
        Level &level = levels[l];
        for (Blocks *vector : {&level.x, &level.b, &level.step, &level.product})
          for (const Block &block : level.blocks)
            vector->emplace_back(
              block.matrix->layout().partitioner(block.matrix->n_components()));
        const bool is_last = l > 0 && l + 1 == levels.size();
        if (is_last)
          {
            std::vector<const LatticeMatrix<dim> *> matrices;
            for (const Block &block : level.blocks)
              matrices.push_back(
                static_cast<const LatticeMatrix<dim> *>(block.matrix));
            coarsest.reinit(
              matrices, parameters.lowers_order, coupling, l, unit);
          }
        level.is_smoothed =
          !is_last || parameters.lowers_order || !coarsest.is_factorized();
        if (level.is_smoothed)
          {
            make_smoother(l);
            estimate_eigenvalue(l);
          }
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::coarsen(const bool coarsens)
  {
    if (coupling)
      coupling->reset();
    const unsigned int largest =
      parameters.lowers_order
        ? CoarsestSolver<dim>::largest_size / parts.size()
        : std::min<unsigned int>(small_size,
                                 CoarsestSolver<dim>::largest_size /
                                   parts.size());
    const auto is_small = [&](const LatticeLevel<dim> &lattice) {
      return CoarsestSolver<dim>::n_rows(lattice, parameters.lowers_order) <=
             largest;
    };
    levels.resize(1);
    for (const auto &part : parts)
      levels[0].blocks.push_back({part.get(), {}, nullptr});
    for (bool changes = coarsens; changes;)
      {
        Level &level = levels.back();
        Level  next;
        changes = false;
        std::vector<const LatticeUnknowns<dim> *> transfers;
        std::vector<const InterleavedLayout *>    layouts;
        for (unsigned int part = 0; part < parts.size(); ++part)
          {
            Block                   &block = level.blocks[part];
            const LatticeLevel<dim> &last  = *block.matrix;
            const bool has_levels          = last.lattice()[0].n_levels() > 1;
            if ((levels.size() == 1 || !is_small(last) || has_levels) &&
                LatticeMatrix<dim>::can_coarsen(last))
              {
                auto matrix = std::make_unique<LatticeMatrix<dim>>(last);
                // Coarsening many bodies of a few functions each adds unknowns.
                if (has_levels ||
                    CoarsestSolver<dim>::n_rows(*matrix, false) <=
                      2 * CoarsestSolver<dim>::n_rows(*parts[part], false))
                  {
                    block.coarser = &matrix->unknowns();
                    coarse.push_back(std::move(matrix));
                    changes = true;
                  }
              }
            // Unchanged parts also need a LatticeMatrix below the finest level.
            if (!block.coarser && levels.size() == 1 && parts.size() > 1)
              {
                coarse.push_back(
                  std::make_unique<LatticeMatrix<dim>>(last, false));
                block.coarser = &coarse.back()->unknowns();
              }
            transfers.push_back(block.coarser);
            layouts.push_back(&last.layout());
            next.blocks.push_back(
              {block.coarser ? coarse.back().get() : block.matrix,
               {},
               nullptr});
          }
        if (!changes)
          break;
        if (coupling)
          coupling->coarsen(transfers, layouts);
        levels.push_back(std::move(next));
      }
    if (levels.size() == 1)
      {
        coarse.clear();
        for (Block &block : levels[0].blocks)
          block.coarser = nullptr;
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::make_smoother(const unsigned int l)
  {
    Level                                  &level = levels[l];
    std::vector<const InterleavedLayout *>  layouts;
    std::vector<std::vector<UpperTriangle>> matrices; // by component, part
    std::vector<std::array<int, 3>>         positions;
    int                                     reach = 0, begin_of_part = 0;
    for (Block &block : level.blocks)
      {
        auto of_part = block.matrix->diagonal_blocks(parameters.by_components);
        matrices.resize(of_part.size());
        for (unsigned int c = 0; c < of_part.size(); ++c)
          matrices[c].push_back(std::move(of_part[c]));
        // Shift the parts, so that all positions differ.
        for (std::array<int, 3> position : block.matrix->unknown_positions())
          {
            position[2] += begin_of_part;
            positions.push_back(position);
          }
        begin_of_part += block.matrix->lattice()[2].n_functions() + far_away;
        layouts.push_back(&block.matrix->layout());
        reach = std::max<int>(reach, block.matrix->lattice()[0].degree());
        block.constrained = block.matrix->constrained_unknowns();
        if (std::all_of(block.constrained.begin(),
                        block.constrained.end(),
                        [](const unsigned char bits) { return bits == 0; }))
          block.constrained.clear();
      }
    std::vector<BlockEntry> coupled;
    if (coupling)
      coupled = coupling->owned_entries(l, layouts);
    for (BlockEntry &entry : coupled)
      for (double &value : entry.values)
        value *= level.unit() / unit;
    const unsigned int n = level.blocks[0].matrix->n_components();
    const std::optional<JoinedLayout> joined =
      parts.size() > 1 ? std::optional<JoinedLayout>(layouts) : std::nullopt;
    level.factors.resize(matrices.size());
    for (unsigned int c = 0; c < matrices.size(); ++c)
      {
        UpperTriangle matrix = parts.size() == 1
                                 ? std::move(matrices[c][0])
                                 : block_diagonal(matrices[c], joined->numbers);
        matrix.add(coupled, c, n / matrices.size());
        level.factors[c].factorize(matrix,
                                   joined ? joined->layout : *layouts[0],
                                   positions,
                                   reach,
                                   l == 0 && reach > 2 ? 2 : 1,
                                   {parameters.shift, 0.});
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::estimate_eigenvalue(const unsigned int l)
  {
    // Lanczos' method, by conjugate gradients. The start is a function of the
    // position, so that the estimate does not depend on the number of
    // processes.
    constexpr unsigned int n_steps = 8;
    constexpr double       safety  = 1.2;
    Level                 &level   = levels[l];
    Blocks                &r = level.b, &z = level.product, &d = level.step;
    std::uint64_t          n_unknowns = 0;
    for (unsigned int part = 0; part < parts.size(); ++part)
      {
        const LatticeLevel<dim> &matrix      = *level.blocks[part].matrix;
        const unsigned int       n           = matrix.n_components();
        const auto               positions   = matrix.unknown_positions();
        const auto               constrained = matrix.constrained_unknowns();
        n_unknowns += positions.size();
        for (unsigned int u = 0; u < positions.size(); ++u)
          for (unsigned int c = 0; c < n; ++c)
            {
              double phase = c;
              for (unsigned int e = 0; e < 3; ++e)
                phase += (e == 0   ? 12.9898
                          : e == 1 ? 78.233
                                   : 37.719) *
                         positions[u][e];
              r[part].local_element(u * n + c) =
                (constrained[u] >> c) & 1 ? 0.f : float(std::sin(phase));
            }
      }
    std::vector<double> alphas, betas;
    double              r_z = 0.;
    for (unsigned int step = 0; step < n_steps; ++step)
      {
        precondition(level, z, r);
        const double new_r_z = dot(r, z);
        if (!(new_r_z > 0.) || !std::isfinite(new_r_z))
          break;
        const double beta = step == 0 ? 0. : new_r_z / r_z;
        r_z               = new_r_z;
        sadd(d, beta, 1., z);
        multiply(l, z, d);
        const double curvature = dot(d, z) / level.unit();
        if (!(curvature > 0.) || !std::isfinite(curvature))
          break;
        const double alpha = r_z / curvature;
        add(r, -alpha / level.unit(), z);
        alphas.push_back(alpha);
        betas.push_back(beta);
      }
    AssertThrow(!alphas.empty() ||
                  Utilities::MPI::sum(
                    n_unknowns,
                    level.blocks[0].matrix->layout().communicator()) == 0,
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
  LatticeCycle<dim>::precondition(const Level  &level,
                                  Blocks       &dst,
                                  const Blocks &src) const
  {
    const unsigned int n         = level.blocks[0].matrix->n_components();
    const unsigned int n_columns = n / level.factors.size();
    const unsigned int width     = width_of_factors(n_columns);
    std::size_t        n_owned   = 0;
    for (const SingleVector &part : src)
      n_owned += part.locally_owned_size() / n;
    for (unsigned int c = 0; c < level.factors.size(); ++c)
      {
        work.assign(n_owned * width, 0.f);
        float *at = work.data();
        for (const SingleVector &part : src)
          for (unsigned int i = c * n_columns; i < part.locally_owned_size();
               i += n, at += width)
            std::copy_n(part.begin() + i, n_columns, at);
        level.factors[c].solve(work.data(), width, level.unit());
        at = work.data();
        for (SingleVector &part : dst)
          for (unsigned int i = c * n_columns; i < part.locally_owned_size();
               i += n, at += width)
            for (unsigned int k = 0; k < n_columns; ++k)
              part.local_element(i + k) = at[k];
      }
    for (unsigned int part = 0; part < parts.size(); ++part)
      {
        const auto &constrained = level.blocks[part].constrained;
        for (unsigned int u = 0; u < constrained.size(); ++u)
          if (constrained[u] != 0)
            for (unsigned int c = 0; c < n; ++c)
              if ((constrained[u] >> c) & 1)
                dst[part].local_element(u * n + c) = 0.f;
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::multiply(const unsigned int l, Blocks &y, Blocks &x) const
  {
    const Level &level = levels[l];
    for (unsigned int part = 0; part < parts.size(); ++part)
      level.blocks[part].matrix->multiply(y[part], x[part]);
    if (coupling)
      coupling->add_product(l, y, x, level.unit() / unit);
  }



  template <int dim>
  void
  LatticeCycle<dim>::subtract_product(const unsigned int l, Blocks &x) const
  {
    multiply(l, levels[l].product, x);
    add(levels[l].b, -1. / levels[l].unit(), levels[l].product);
  }



  template <int dim>
  void
  LatticeCycle<dim>::smooth(const unsigned int l) const
  {
    const Level &level = levels[l];
    const double upper = level.largest_eigenvalue;
    const double lower = upper / (1.2 * parameters.chebyshev_range);
    const double theta = 0.5 * (upper + lower), delta = 0.5 * (upper - lower);
    const double sigma = theta / delta;
    double       rho   = 1. / sigma;
    precondition(level, level.product, level.b);
    sadd(level.step, 0., 1. / theta, level.product);
    add(level.x, 1., level.step);
    for (unsigned int k = 1; k < parameters.chebyshev_degree; ++k)
      {
        subtract_product(l, level.step);
        precondition(level, level.product, level.b);
        const double next = 1. / (2. * sigma - rho);
        sadd(level.step, next * rho, 2. * next / delta, level.product);
        add(level.x, 1., level.step);
        rho = next;
      }
  }



  template <int dim>
  void
  LatticeCycle<dim>::add_coarse_correction(const unsigned int l) const
  {
    const Level &level = levels[l], &next = levels[l + 1];
    for (unsigned int part = 0; part < parts.size(); ++part)
      if (const auto *coarser = level.blocks[part].coarser)
        coarser->restrict(next.b[part], level.b[part]);
      else
        next.b[part] = level.b[part];
    cycle(l + 1);
    set_zero(level.step);
    for (unsigned int part = 0; part < parts.size(); ++part)
      if (const auto *coarser = level.blocks[part].coarser)
        coarser->prolongate_and_add(level.step[part], next.x[part]);
      else
        level.step[part] = next.x[part];
  }



  template <int dim>
  void
  LatticeCycle<dim>::cycle(const unsigned int l) const
  {
    const Level &level   = levels[l];
    const bool   is_last = l + 1 == levels.size();
    set_zero(level.x);
    if (!level.is_smoothed)
      {
        coarsest.add_solution(level.x, level.b);
        return;
      }
    smooth(l);
    subtract_product(l, level.step);
    if (!is_last || coarsest.is_factorized())
      {
        if (!is_last)
          add_coarse_correction(l);
        else
          {
            set_zero(level.step);
            coarsest.add_solution(level.step, level.b);
          }
        add(level.x, 1., level.step);
        subtract_product(l, level.step);
      }
    smooth(l);
  }



  template <int dim>
  void
  LatticeCycle<dim>::vmult(const std::vector<VectorType *>       &dst,
                           const std::vector<const VectorType *> &src) const
  {
    double largest = 0.;
    for (unsigned int part = 0; part < parts.size(); ++part)
      {
        largest    = std::max(largest, src[part]->linfty_norm());
        *dst[part] = 0.;
      }
    if (!(largest > 0.) || !std::isfinite(largest))
      return;
    // Call action(part, entry of unknowns, entry of functions, is free).
    const auto for_each_entry = [&](const auto &action) {
      for (unsigned int part = 0; part < parts.size(); ++part)
        {
          const unsigned int n           = parts[part]->n_components();
          const auto        &functions   = parts[part]->unknown_functions();
          const auto        &constrained = levels[0].blocks[part].constrained;
          for (unsigned int u = 0; u < functions.size(); ++u)
            for (unsigned int c = 0; c < n; ++c)
              action(part,
                     u * n + c,
                     (of_unknowns ? u : functions[u]) * n + c,
                     constrained.empty() || !((constrained[u] >> c) & 1));
        }
    };
    for_each_entry([&](const unsigned int part,
                       const unsigned int i,
                       const unsigned int f,
                       const bool         is_free) {
      levels[0].b[part].local_element(i) =
        is_free ? float(src[part]->local_element(f) / largest) : 0.f;
    });
    cycle(0);
    const double scale = largest / unit;
    for_each_entry([&](const unsigned int part,
                       const unsigned int i,
                       const unsigned int f,
                       const bool) {
      dst[part]->local_element(f) = scale * levels[0].x[part].local_element(i);
    });
  }



  GREVILLE_INSTANTIATE_CLASS(LatticeCycle);
} // namespace greville
