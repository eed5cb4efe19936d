// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/lac/la_parallel_vector.h>

#include <greville/base/index_limits.h>
#include <greville/multigrid/lattice_levels.h>

#include <algorithm>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The largest number of rows for which a level is solved directly.
    constexpr PetscInt direct_solver_size = 400;

    // Coarse unknowns at the edge of a body may be linearly dependent: a
    // fraction of the diagonal keeps matrices regular.
    constexpr double regularization = 1e-10;



    void
    add_to_diagonal(const Mat matrix)
    {
      Vec handle;
      check_petsc(MatCreateVecs(matrix, &handle, nullptr));
      const PetscVector diagonal(handle);
      check_petsc(MatGetDiagonal(matrix, handle));
      check_petsc(VecScale(handle, regularization));
      check_petsc(MatDiagonalSet(matrix, handle, ADD_VALUES));
    }



    /**
     * The keys of the coarse functions of an unknown, one or two in each
     * direction, with equal weights. A key is a lattice position and component.
     */
    template <int dim>
    struct CoarseKeys
    {
      static constexpr unsigned int max_number = 1 << dim;

      /// Set the keys of an unknown, and return their number.
      unsigned int
      operator()(const MultiIndex<dim> &position,
                 const unsigned int     component,
                 std::uint64_t (&keys)[max_number]) const
      {
        keys[0]              = component;
        unsigned int  n      = 1;
        std::uint64_t stride = n_components;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const unsigned int lower = position[d] / 2;
            if (position[d] % 2 == 1)
              {
                const unsigned int upper = (lower + 1) % size[d];
                for (unsigned int k = 0; k < n; ++k)
                  keys[n + k] = keys[k] + stride * upper;
              }
            for (unsigned int k = 0; k < n; ++k)
              keys[k] += stride * lower;
            n *= 1 + position[d] % 2;
            stride *= size[d];
          }
        return n;
      }

      const MultiIndex<dim> size;
      const unsigned int    n_components;
    };



    /**
     * Collective. Return the owned ones of the @p wanted keys, and number all
     * keys in @p list. All processes share this list; the first process that
     * needs a key owns it.
     */
    std::vector<std::uint64_t>
    number_keys(LinearAlgebra::distributed::Vector<double> &list,
                const std::vector<std::uint64_t>           &wanted,
                const std::uint64_t                         n_keys,
                const MPI_Comm                              comm)
    {
      const unsigned int me          = Utilities::MPI::this_mpi_process(comm);
      const unsigned int n_processes = Utilities::MPI::n_mpi_processes(comm);
      IndexSet           mine(n_keys), others(n_keys);
      mine.add_range(n_keys * me / n_processes,
                     n_keys * (me + 1) / n_processes);
      others.add_indices(wanted.begin(), wanted.end());
      list.reinit(mine, others, comm);
      list = n_processes;
      for (unsigned int i = 0; i < list.get_partitioner()->n_ghost_indices();
           ++i)
        list.local_element(list.locally_owned_size() + i) = n_processes;
      for (const std::uint64_t key : wanted)
        list(key) = me;
      list.compress(VectorOperation::min);
      list.update_ghost_values();
      std::vector<std::uint64_t> owned;
      for (const std::uint64_t key : wanted)
        if (list(key) == me)
          owned.push_back(key);

      // The numbers of the keys.
      const std::uint64_t n_owned = owned.size();
      const std::uint64_t first   = sum_before(n_owned, comm);
      list.zero_out_ghost_values();
      list = 0.;
      for (std::uint64_t k = 0; k < n_owned; ++k)
        list(owned[k]) = first + k;
      list.compress(VectorOperation::add);
      list.update_ghost_values();
      return owned;
    }



    /**
     * Collective. Return the interpolation to unknowns from coarse ones with
     * the numbers in @p list.
     */
    template <int dim, typename Unknowns>
    PetscMatrix
    interpolation(const Unknowns                                   &unknowns,
                  const CoarseKeys<dim>                            &keys_of,
                  const LinearAlgebra::distributed::Vector<double> &list,
                  const std::size_t                                 n_owned,
                  const MatType                                     type)
    {
      constexpr unsigned int max_number = CoarseKeys<dim>::max_number;
      Mat                    handle;
      check_petsc(MatCreate(list.get_mpi_communicator(), &handle));
      PetscMatrix result(handle);
      check_petsc(MatSetSizes(
        handle, unknowns.size(), n_owned, PETSC_DETERMINE, PETSC_DETERMINE));
      check_petsc(MatSetType(handle, type));
      check_petsc(MatSeqAIJSetPreallocation(handle, max_number, nullptr));
      check_petsc(MatMPIAIJSetPreallocation(
        handle, max_number, nullptr, max_number, nullptr));
      PetscInt row;
      check_petsc(MatGetOwnershipRange(handle, &row, nullptr));
      for (const auto &u : unknowns)
        {
          if (!u.is_constrained)
            {
              std::uint64_t      keys[max_number];
              PetscInt           columns[max_number];
              PetscScalar        weights[max_number];
              const unsigned int n = keys_of(u.position, u.component, keys);
              for (unsigned int k = 0; k < n; ++k)
                {
                  columns[k] = static_cast<PetscInt>(list(keys[k]));
                  weights[k] = 1. / n;
                }
              check_petsc(MatSetValues(
                handle, 1, &row, n, columns, weights, INSERT_VALUES));
            }
          ++row;
        }
      check_petsc(MatAssemblyBegin(handle, MAT_FINAL_ASSEMBLY));
      check_petsc(MatAssemblyEnd(handle, MAT_FINAL_ASSEMBLY));
      return result;
    }
  } // namespace



  template <int dim>
  LatticeLevels<dim>::LatticeLevels(
    const Mat                         matrix,
    const SplineSpace<dim>           &space,
    const std::vector<unsigned int>  &functions,
    const unsigned int                n_components,
    const std::vector<unsigned char> &constrained)
  {
    AssertThrow(space.degree() == 1, ExcInternalError());
    std::vector<Unknown> unknowns;
    unknowns.reserve(functions.size() * n_components);
    for (unsigned int i = 0; i < functions.size(); ++i)
      {
        const MultiIndex<dim> position =
          multi_index<dim>(space.owned_functions()[functions[i]],
                           space.n_functions());
        for (unsigned int c = 0; c < n_components; ++c)
          unknowns.push_back({position, c, ((constrained[i] >> c) & 1) != 0});
      }
    MultiIndex<dim>       size = space.n_functions();
    std::array<bool, dim> periodic;
    for (unsigned int d = 0; d < dim; ++d)
      periodic[d] = space.is_periodic(d);

    Mat      fine = matrix;
    PetscInt n_rows;
    // PETSc multiplies only matrices of the same type, and both types occur on
    // one process.
    MatType type;
    check_petsc(MatGetType(matrix, &type));
    check_petsc(MatGetSize(matrix, &n_rows, nullptr));
    while (n_rows > direct_solver_size &&
           *std::max_element(size.begin(), size.end()) > 2)
      {
        PetscMatrix P = coarsen(
          unknowns, size, periodic, n_components, type, space.communicator());
        PetscInt n_coarse;
        check_petsc(MatGetSize(P.get(), nullptr, &n_coarse));
        // Bodies of a few functions each can have more coarse than fine
        // unknowns.
        if (n_coarse >= n_rows)
          break;
        Mat coarse;
        check_petsc(
          MatPtAP(fine, P.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, &coarse));
        interpolations.push_back(std::move(P));
        matrices.emplace_back(coarse);
        add_to_diagonal(coarse);
        fine   = coarse;
        n_rows = n_coarse;
      }
  }



  template <int dim>
  PetscMatrix
  LatticeLevels<dim>::coarsen(std::vector<Unknown>        &unknowns,
                              MultiIndex<dim>             &size,
                              const std::array<bool, dim> &periodic,
                              const unsigned int           n_components,
                              const MatType                type,
                              const MPI_Comm               comm) const
  {
    MultiIndex<dim> coarse_size;
    std::uint64_t   n_keys = n_components;
    for (unsigned int d = 0; d < dim; ++d)
      {
        coarse_size[d] = periodic[d] ? (size[d] + 1) / 2 : size[d] / 2 + 1;
        n_keys *= coarse_size[d];
      }
    checked_index<types::global_dof_index>(n_keys, "functions of a level");
    const CoarseKeys<dim>      keys_of{coarse_size, n_components};
    std::vector<std::uint64_t> wanted;
    for (const Unknown &u : unknowns)
      if (!u.is_constrained)
        {
          std::uint64_t      keys[CoarseKeys<dim>::max_number];
          const unsigned int n = keys_of(u.position, u.component, keys);
          wanted.insert(wanted.end(), keys, keys + n);
        }
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());

    LinearAlgebra::distributed::Vector<double> list;
    const std::vector<std::uint64_t>           owned =
      number_keys(list, wanted, n_keys, comm);
    PetscMatrix result =
      interpolation(unknowns, keys_of, list, owned.size(), type);

    size = coarse_size;
    unknowns.clear();
    for (const std::uint64_t key : owned)
      unknowns.push_back({multi_index<dim>(key / n_components, coarse_size),
                          static_cast<unsigned int>(key % n_components),
                          false});
    return result;
  }



  template <int dim>
  std::string
  LatticeLevels<dim>::options() const
  {
    if (interpolations.empty())
      return "-pc_type redundant -redundant_pc_type lu "
             "-redundant_pc_factor_shift_type inblocks";
    return "-pc_mg_multiplicative_cycles 2 -mg_levels_ksp_type chebyshev "
           "-mg_levels_ksp_max_it 3 -mg_levels_pc_type jacobi "
           "-mg_levels_ksp_chebyshev_esteig 0,0.1,0,1.3";
  }



  template <int dim>
  void
  LatticeLevels<dim>::apply_to(PC pc) const
  {
    const PetscInt n = interpolations.size() + 1;
    if (n == 1)
      return;
    check_petsc(PCSetType(pc, PCMG));
    check_petsc(PCMGSetLevels(pc, n, nullptr));
    for (PetscInt l = 0; l + 1 < n; ++l)
      {
        KSP smoother;
        check_petsc(PCMGGetSmoother(pc, n - 2 - l, &smoother));
        check_petsc(
          KSPSetOperators(smoother, matrices[l].get(), matrices[l].get()));
        check_petsc(
          PCMGSetInterpolation(pc, n - 1 - l, interpolations[l].get()));
      }
  }



  template class LatticeLevels<2>;
  template class LatticeLevels<3>;
} // namespace greville
