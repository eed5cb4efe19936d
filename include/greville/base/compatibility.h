// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/config.h>
#include <deal.II/base/mpi.h>
#if DEAL_II_VERSION_GTE(9, 7, 0)
#  include <deal.II/base/enable_observer_pointer.h>
#else
#  include <deal.II/base/subscriptor.h>
#endif

#include <deal.II/distributed/tria.h>
#include <deal.II/lac/la_parallel_vector.h>
#if DEAL_II_VERSION_GTE(9, 6, 0)
#  include <deal.II/lac/orthogonalization.h>
#endif

/// Instantiate a class, or a function that is not overloaded, in 2D and 3D.
#define GREVILLE_INSTANTIATE_CLASS(name) \
  template class name<2>;                \
  template class name<3>
#define GREVILLE_INSTANTIATE(name)    \
  template decltype(name<2>) name<2>; \
  template decltype(name<3>) name<3>

/**
 * The base of all parts of the project. This file contains everything that
 * deal.II renamed between the oldest and the newest supported version (9.4 to
 * 9.8), so that no other file depends on the version.
 */
namespace greville
{
  /// The vector type of the project: the locally owned entries are contiguous,
  /// followed by ghost entries.
  using VectorType = dealii::LinearAlgebra::distributed::Vector<double>;

  /// A VectorType in @p Number.
  template <typename Number>
  using VectorOf = dealii::LinearAlgebra::distributed::Vector<Number>;

  template <int dim>
  using DistributedTriangulation =
    dealii::parallel::distributed::Triangulation<dim>;

  /// The base of classes to which deal.II's solvers and smoothers keep
  /// pointers.
#if DEAL_II_VERSION_GTE(9, 7, 0)
  using Observable = dealii::EnableObserverPointer;
#else
  using Observable = dealii::Subscriptor;
#endif

  /// The AdditionalData of SolverFGMRES for modified Gram-Schmidt, the only
  /// kind of deal.II 9.4. The default of 9.6 corrects a basis vector after the
  /// preconditioner has used it, so its estimated residual may be far from the
  /// residual of the solution.
  template <typename Fgmres>
  typename Fgmres::AdditionalData
  fgmres_data(const unsigned int n_basis_vectors)
  {
#if DEAL_II_VERSION_GTE(9, 6, 0)
    return typename Fgmres::AdditionalData(
      n_basis_vectors,
      dealii::LinearAlgebra::OrthogonalizationStrategy::modified_gram_schmidt);
#else
    return typename Fgmres::AdditionalData(n_basis_vectors);
#endif
  }

  template <int dim>
  MPI_Comm
  get_communicator(const DistributedTriangulation<dim> &triangulation)
  {
#if DEAL_II_VERSION_GTE(9, 7, 0)
    return triangulation.get_mpi_communicator();
#else
    return triangulation.get_communicator();
#endif
  }
} // namespace greville

/*
 * deal.II's change notes on the names above:
 * - EnableObserverPointer: incompatible changes between 9.6.0 and 9.7.0
 *   (2024/09/09): "the Subscriptor class has been renamed to
 *   EnableObserverPointer, since that is what the class actually does".
 * - get_mpi_communicator(): incompatible changes between 9.4.0 and 9.5.0
 *   (2023/04/12) for vectors and matrices, which have had no other name; in 9.7
 *   Triangulation::get_communicator() is marked "Access the MPI communicator
 *   with get_mpi_communicator() instead".
 * - OrthogonalizationStrategy: 9.6 added it to SolverFGMRES, with
 *   delayed_classical_gram_schmidt as the default (pull requests 16749, 16833).
 *
 * Names of all supported versions, used in place of removed names:
 * - ParameterHandler::PRM, ShortPRM: 9.7 removed Text and ShortText
 *   (2024/08/21).
 * - Triangulation::Signals::weight: 9.6 removed cell_weight (2023/06/27), which
 *   added 1000 to all weights.
 * - DoFTools::extract_locally_relevant_dofs() that returns the IndexSet: 9.7
 *   deprecates the one that fills an argument.
 *
 * According to its notes, the incompatible changes of 9.8 do not affect this
 * project. It has not been compiled with 9.7 and 9.8.
 */
