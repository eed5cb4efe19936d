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
   * The unknowns of one process only are its *interior* I, the others are the
   * *interface* B. Rows of the interior are complete, so each process
   * eliminates its interior by IncompleteCholesky without communication,
   * @f[
   *   A_s = \begin{pmatrix} A_{II} & A_{IB} \\ A_{BI} & A_{BB} \end{pmatrix},
   *   \qquad
   *   S_s = A_{BB} - A_{BI} A_{II}^{-1} A_{IB},
   * @f]
   * up to the fill that IC(0) drops. An unknown of the interface is *managed*
   * by the first process that stores it. The sum of the S_s is the matrix of
   * the next level, whose unknowns are the interface, owned by their managers;
   * an entry between two managers belongs to the first of them. Levels are
   * added until there is no interface. In a solve, a level needs two exchanges
   * with neighbours: the right-hand sides that the interiors leave at the
   * interface, and the solution there. One process needs one level,
   * IncompleteCholesky.
   *
   * IC(0) drops little fill if the elimination proceeds towards the last
   * unknowns: a Kronecker product of banded matrices has no other fill in
   * lexicographic order, from one corner of the body to the opposite one. Each
   * process therefore eliminates its interior in lexicographic order in
   * directions towards its interface and towards walls that constrain unknowns.
   * Further levels are small and irregular at staircase-shaped interfaces: they
   * keep the fill from pairs of matrix entries, IC(1); otherwise iterations
   * would grow with the number of processes.
   *
   * See @ref Karypis1997 "Karypis and Kumar, 1997", and @ref Saad2003 "Saad,
   * 2003", section 12.
   *
   * Vectors have several columns. Unknowns can be constrained to zero in some
   * of them, see ConstrainedRows.
   */
  class PartitionedCholesky
  {
  public:
    /**
     * Collective. @p matrix has the entries of this process between the
     * unknowns of @p layout. The owned unknowns have @p positions in a lattice.
     * Apart from few entries, the matrix couples unknowns whose positions
     * differ by at most @p reach. @p may_leave_out marks unknowns that may be
     * left out of some columns. A @p shift, see IncompleteCholesky, is raised
     * if the diagonal of the interface would not be positive. Throws ErrorOnAll
     * if IncompleteCholesky::factorize() throws on any process.
     */
    void
    factorize(const LowerTriangle                            &matrix,
              const std::shared_ptr<const InterleavedLayout> &layout,
              const std::vector<std::array<int, 3>>          &positions,
              const std::vector<bool>                        &may_leave_out,
              const unsigned int                              reach,
              const double                                    shift);

    /**
     * Collective. Bit c of @p constrained[u] leaves the owned unknown u out of
     * the columns c, c + @p n_components, ...
     */
    void
    constrain(const std::vector<unsigned char> &constrained,
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
     * Collective. Factorize with a shift. Returns false if the diagonal of the
     * interface is then not positive.
     */
    bool
    try_shift(const LowerTriangle                            &matrix,
              const std::shared_ptr<const InterleavedLayout> &layout,
              std::vector<std::array<int, 3>>                 positions,
              std::vector<bool>                               may_leave_out,
              const unsigned int                              reach,
              const double                                    shift);

    /// Extend the data of owned unknowns to ghosts.
    void
    add_ghosts(std::vector<std::array<int, 3>> &positions,
               std::vector<bool>               &may_leave_out) const;

    /// Find interior and interface, and the manager of each unknown.
    void
    find_interface();

    void
    find_order(const std::vector<std::array<int, 3>> &positions,
               const std::vector<bool>               &may_leave_out,
               const unsigned int                     reach);

    /**
     * Sum up the Schur complements and build the next level from them, as
     * try_shift().
     */
    bool
    make_next_level(const LowerTriangle                   &complement,
                    const std::vector<std::array<int, 3>> &positions,
                    const std::vector<bool>               &may_leave_out,
                    const unsigned int                     reach,
                    const double                           shift);

    /**
     * Do the part of solve() between the sweeps over the interior. On entry, @p
     * x contains the right-hand side of owned unknowns, on return their
     * solution.
     */
    void
    solve_interface(double            *x,
                    const unsigned int width,
                    const double       largest) const;

    /// Return a vector of the interface, with undefined entries.
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

    // The unknowns of the interface on this process, managed ones first, by
    // local unknown.
    std::unique_ptr<InterleavedLayout> interface_layout;
    std::vector<unsigned int>          interface_unknowns;

    // Local unknowns in the order of elimination: interior, then interface.
    std::vector<unsigned int> order;
    unsigned int              n_interior = 0;
    std::array<bool, 3>       descends{}; // in the directions of the lattice

    IncompleteCholesky                   interior;
    ConstrainedRows                      constrained_interior;
    std::unique_ptr<PartitionedCholesky> next; // level; none: no interface

    mutable std::vector<float>    values;       // of all local rows
    mutable std::array<Vector, 9> at_interface; // by width
  };
} // namespace greville

#endif
