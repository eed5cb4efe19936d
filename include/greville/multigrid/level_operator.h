// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/base/errors.h>
#include <greville/base/petsc.h>
#include <greville/linear_algebra/incomplete_cholesky.h>
#include <greville/linear_algebra/preconditioner.h>
#include <greville/mass/density_weights.h>

#include <memory>
#include <string>

namespace greville
{
  struct LatticeCycleParameters;

  /**
   * A symmetric positive definite operator A of one order of a hierarchy, with
   * the interface required by cycles, smoothers and transfers. Vectors have a
   * coefficient for each function of a spline space and component c,
   * interleaved: entry i * n_components() + c of local function i.
   *
   * *Inactive* functions do not take part in A, because they have no material
   * in their support, are constrained, or depend on others (extended
   * B-splines). Their rows and columns are zero except for the diagonal, so
   * that a right-hand side of zero gives zero.
   */
  template <int dim>
  class LevelOperator
  {
  public:
    virtual ~LevelOperator() = default;

    /// Return the space of one component.
    virtual const SplineSpace<dim> &
    space() const = 0;

    virtual unsigned int
    n_components() const
    {
      return 1;
    }

    /// Compute dst = A src.
    virtual void
    vmult(VectorType &dst, const VectorType &src) const = 0;

    void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      vmult(dst, src);
    }

    /// Compute dst = A src for smoothers and cycles. Entries may have single
    /// precision, which halves the memory traffic.
    virtual void
    vmult_in_cycle(VectorType &dst, const VectorType &src) const
    {
      vmult(dst, src);
    }

    /// Return the diagonal, which is positive also for inactive functions.
    virtual const VectorType &
    diagonal() const = 0;

    /// Return the local numbers of the inactive functions of this process.
    virtual const std::vector<unsigned int> &
    inactive() const = 0;

    /// Return the entries of one component, for smoothers that need them: the
    /// entries of A if it has one component, otherwise a matrix that represents
    /// all diagonal blocks (MPIAIJ). Rows and columns have the global numbers
    /// of the space.
    virtual Mat
    matrix() const
    {
      Require(false,
              "The parameter 'Smoother' needs the entries of one component, "
              "which this operator does not provide: take chebyshev-ic0, "
              "chebyshev, ic0 or jacobi.");
      return nullptr;
    }

    /// Collective. Compute all coefficients of a spline from the active ones,
    /// @f$ x \leftarrow E x @f$, for one @p component. Inactive functions
    /// become zero unless they depend on others.
    virtual void
    distribute(VectorType &x, const unsigned int /*component*/ = 0) const
    {
      for (const unsigned int i : inactive())
        x.local_element(i) = 0.;
    }

    /// Collective. Compute @f$ x \leftarrow E^T x @f$, with zeros at inactive
    /// functions.
    virtual void
    condense(VectorType &x, const unsigned int /*component*/ = 0) const
    {
      for (const unsigned int i : inactive())
        x.local_element(i) = 0.;
    }

    /// Return a symmetric positive definite B, dst = B src for all components,
    /// for smoothers. It has incomplete factorizations of the diagonal blocks
    /// of the components, or one factorization of their mean. Null if there is
    /// none.
    virtual std::unique_ptr<Preconditioner>
    factorization(const CholeskyParameters & /*parameters*/,
                  const bool /*by_components*/) const
    {
      return nullptr;
    }

    /// Collective. Replace x by a symmetric approximation of @f$ M^{-1} x @f$
    /// with the mass matrix M of the points of the transfer, for all
    /// components.
    virtual void
    apply_inverse_mass(VectorType & /*x*/) const
    {
      Require(false,
              "The parameter 'Prolongation' is <ic0-l2>, which is for implicit "
              "steps: mass matrices take lumped-l2.");
    }

    /// Collective. Return a preconditioner of PETSc for the entries of all
    /// components, described by PETSc's options; null if the operator has no
    /// entries.
    virtual std::unique_ptr<Preconditioner>
    petsc_preconditioner(const std::string & /*options*/) const
    {
      return nullptr;
    }

    /// Collective. Return a LatticeCycle for the operator, which is kept by
    /// reference; null if the operator has no entries.
    virtual std::unique_ptr<Preconditioner>
    lattice_preconditioner(const LatticeCycleParameters & /*parameters*/) const
    {
      return nullptr;
    }

    /// Return the points and weights for the L2 products of a transfer; null
    /// for integrals over the volume.
    virtual const DensityWeights<dim> *
    transfer_weights() const
    {
      return nullptr;
    }
  };



  /// Collective. Make a vector of the operator.
  template <int dim>
  void
  initialize_vector(VectorType &vector, const LevelOperator<dim> &level)
  {
    const SplineSpace<dim> &space = level.space();
    const unsigned int      n     = level.n_components();
    if (n == 1)
      {
        space.initialize_vector(vector);
        return;
      }
    const auto       range = space.partitioner()->local_range();
    dealii::IndexSet owned(n * space.n_dofs());
    owned.add_range(n * range.first, n * range.second);
    vector.reinit(owned, space.communicator());
  }

  /// Apply @p action(to, from, c), which handles one component c, to all @p n
  /// components of interleaved vectors. The vectors @p to and @p from have the
  /// layouts of one component; they are not used for n = 1.
  template <typename Action>
  void
  apply_by_components(const unsigned int n,
                      VectorType        &dst,
                      const VectorType  &src,
                      VectorType        &to,
                      VectorType        &from,
                      const Action      &action)
  {
    if (n == 1)
      {
        action(dst, src, 0u);
        return;
      }
    for (unsigned int c = 0; c < n; ++c)
      {
        for (unsigned int i = 0; i < from.locally_owned_size(); ++i)
          from.local_element(i) = src.local_element(i * n + c);
        action(to, from, c);
        for (unsigned int i = 0; i < to.locally_owned_size(); ++i)
          dst.local_element(i * n + c) = to.local_element(i);
      }
  }
} // namespace greville
