// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/lac/lapack_full_matrix.h>

#include <greville/multigrid/lattice_coupling.h>
#include <greville/multigrid/lattice_matrix.h>

namespace greville
{
  /**
   * The last level of a LatticeCycle: a factorized matrix of few rows, on each
   * process. Its unknowns are the components of the last lattices of all parts.
   * If @p lowers_order, they are the components of functions of order 1 on
   * these lattices. A function of order 1 is interpolated by the spline whose
   * coefficients are its values at the Greville points, which is exact for
   * linear functions.
   */
  template <int dim>
  class CoarsestSolver
  {
  public:
    using Blocks = std::vector<SingleVector>;

    /// The largest number of rows of a matrix.
    static constexpr unsigned int largest_size = 1200;

    /// Return the number of rows of a lattice.
    static std::uint64_t
    n_rows(const LatticeLevel<dim> &lattice, const bool lowers_order);

    /// Collective. The matrix is the sum of the @p lattices of all parts and,
    /// unless @p coupling is null, of the given level of the coupling divided
    /// by @p unit. The lattices are kept by reference.
    void
    reinit(const std::vector<const LatticeMatrix<dim> *> &lattices,
           const bool                                     lowers_order,
           const LatticeCoupling<dim>                    *coupling,
           const unsigned int                             level,
           const double                                   unit);

    /// Return whether there is a factorized matrix: it has few rows, and the
    /// factorization has succeeded.
    bool
    is_factorized() const
    {
      return matrix.m() > 0;
    }

    /// Collective. Add the solution for b to x.
    void
    add_solution(Blocks &x, const Blocks &b) const;

  private:
    /// The columns of this level, with weights, that represent each component
    /// of a part's owned unknowns.
    struct Columns
    {
      std::vector<std::size_t>                     begin{0};
      std::vector<std::pair<unsigned int, double>> entries;
    };

    /// Call add(column, weight) for the columns of a component of a local
    /// unknown. Columns are counted from the first column of the part.
    template <typename Add>
    static void
    for_each_column(const LatticeMatrix<dim> &lattice,
                    const bool                lowers_order,
                    const unsigned int        unknown,
                    const unsigned int        component,
                    const Add                &add);

    /// Collective. Add the coupling to the matrix entries, stored row by row.
    void
    add_coupling(std::vector<double>        &entries,
                 const LatticeCoupling<dim> &coupling,
                 const unsigned int          level,
                 const double                unit) const;

    void
    factorize(const std::vector<double> &entries);

    MPI_Comm                         comm = MPI_COMM_SELF;
    std::vector<Columns>             columns; // by part
    dealii::LAPACKFullMatrix<double> matrix;
    mutable dealii::Vector<double>   values;
  };
} // namespace greville
