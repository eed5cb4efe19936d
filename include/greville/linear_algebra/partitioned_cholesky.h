// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_linear_algebra_partitioned_cholesky_h
#define greville_linear_algebra_partitioned_cholesky_h

#include <deal.II/lac/la_parallel_vector.h>

#include <greville/linear_algebra/incomplete_cholesky.h>
#include <greville/linear_algebra/interleaved_layout.h>

#include <array>
#include <memory>

namespace greville
{
  /**
   * An incomplete Cholesky factorization of a matrix that is the sum of
   * matrices A_s of all processes s, each between the local unknowns of its
   * process.
   *
   * Unknowns that one process alone knows are its *interior* I, the others are
   * the *interface* B. Rows of the interior are complete, so that each process
   * eliminates its own by IncompleteCholesky without asking others,
   * @f[
   *   A_s = \begin{pmatrix} A_{II} & A_{IB} \\ A_{BI} & A_{BB} \end{pmatrix},
   *   \qquad
   *   S_s = A_{BB} - A_{BI} A_{II}^{-1} A_{IB},
   * @f]
   * with the fill that IC(0) drops. An unknown of the interface is *managed* by
   * the first process that knows it. The sum of the S_s is the matrix of the
   * next level, with the interface as its unknowns, which each process owns
   * where it manages them; entries between two managers go to the first of
   * them. Levels follow each other until there is no interface. A level needs
   * two exchanges with neighbours in a solve: of what the interiors leave to
   * the interface, and of the solution there. On one process there is one
   * level, IncompleteCholesky.
   *
   * The fill that IC(0) drops is that of elimination away from what comes last:
   * a Kronecker product of banded matrices has none in lexicographic order,
   * that is, from one corner of the body to the opposite one. So each process
   * eliminates its interior in lexicographic order with the directions that
   * lead towards its interface, and towards walls that hold unknowns. Further
   * levels are small, and irregular where parts of processes meet like stairs:
   * they keep the fill that two entries of the matrix make, IC(1), without
   * which iterations grow with the number of processes.
   *
   * See @ref Karypis1997 "Karypis and Kumar, 1997", and
   * @ref Saad2003 "Saad, 2003", section 12.
   *
   * Vectors have several columns, which can leave out (hold at zero) unknowns,
   * see HeldRows.
   */
  class PartitionedCholesky
  {
  public:
    /**
     * Collective. @p matrix has the entries of this process between the
     * unknowns of @p layout. The owned unknowns have @p positions in a lattice,
     * in which the matrix couples those whose positions differ by @p reach at
     * most, apart from few others. Some of them columns @p may_leave_out.
     * A @p shift, see IncompleteCholesky, is raised where the diagonal of the
     * interface would not be positive. Throws ErrorOnAll where
     * IncompleteCholesky::factorize() throws on any process.
     */
    void
    factorize(const LowerTriangle                            &matrix,
              const std::shared_ptr<const InterleavedLayout> &layout,
              const std::vector<std::array<int, 3>>          &positions,
              const std::vector<bool>                        &may_leave_out,
              const unsigned int                              reach,
              const double                                    shift);

    /**
     * Collective. Bit c of @p held[u] leaves the owned unknown u out of the
     * columns c, c + @p n_components, ...
     */
    void
    hold(const std::vector<unsigned char> &held,
         const unsigned int                n_components);

    /**
     * Collective. Solve in place for the owned unknowns, @p width (1, 2, 4 or
     * 8) columns.
     */
    void
    solve(double *x, const unsigned int width) const;

  private:
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;

    /**
     * Collective. Factorize with a shift. False where that leaves an interface
     * with a diagonal that is not positive.
     */
    bool
    try_shift(const LowerTriangle                            &matrix,
              const std::shared_ptr<const InterleavedLayout> &layout,
              std::vector<std::array<int, 3>>                 positions,
              std::vector<bool>                               may_leave_out,
              const unsigned int                              reach,
              const double                                    shift);

    /**
     * What is known of owned unknowns, of ghosts as well.
     */
    void
    add_ghosts(std::vector<std::array<int, 3>> &positions,
               std::vector<bool>               &may_leave_out) const;

    /**
     * Find interior and interface, and who manages what.
     */
    void
    find_interface();

    void
    find_order(const std::vector<std::array<int, 3>> &positions,
               const std::vector<bool>               &may_leave_out,
               const unsigned int                     reach);

    /**
     * Sum up the Schur complements, and make the next level of them, as
     * try_shift() does.
     */
    bool
    make_next_level(const LowerTriangle                   &complement,
                    const std::vector<std::array<int, 3>> &positions,
                    const std::vector<bool>               &may_leave_out,
                    const unsigned int                     reach,
                    const double                           shift);

    /**
     * The part of solve() between the sweeps over the interior: @p x has the
     * solution of owned unknowns, and their right-hand side before.
     */
    void
    solve_interface(double            *x,
                    const unsigned int width,
                    const double       largest) const;

    /**
     * A vector of the interface, with contents of no meaning.
     */
    Vector &
    vector_at_interface(const unsigned int width) const
    {
      Vector     &result      = at_interface[width];
      const auto &partitioner = interface_layout->partitioner(width);
      if (result.get_partitioner() != partitioner)
        result.reinit(partitioner);
      return result;
    }

    bool
    is_parallel() const
    {
      return dealii::Utilities::MPI::n_mpi_processes(layout->communicator()) >
             1;
    }

    std::shared_ptr<const InterleavedLayout> layout;
    bool                                     has_fill = false; // IC(1)

    // Unknowns of the interface that this process knows, those that it manages
    // first, by local unknown.
    std::unique_ptr<InterleavedLayout> interface_layout;
    std::vector<unsigned int>          interface_unknowns;

    // Local unknowns in the order of elimination: interior, then interface.
    std::vector<unsigned int> order;
    unsigned int              n_interior = 0;
    std::array<bool, 3>       descends{}; // in the directions of the lattice

    IncompleteCholesky                   interior;
    HeldRows                             held_interior;
    std::unique_ptr<PartitionedCholesky> next; // level; none: no interface

    mutable std::vector<float>    values;       // of all local rows
    mutable std::array<Vector, 9> at_interface; // by width
  };
} // namespace greville

#endif
