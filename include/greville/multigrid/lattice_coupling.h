// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/tensor.h>

#include <greville/base/petsc.h>
#include <greville/multigrid/lattice_unknowns.h>

#include <deque>
#include <vector>

namespace greville
{
  /**
   * The stiffness of springs that couple the parts of a LatticeCycle, and its
   * Galerkin products on all levels:
   * @f[
   *   C = \sum_k G_k^T K_k G_k, \qquad
   *   G_k x = \sum_\text{parts} \sum_u g_{ku} x_u,
   * @f]
   * with a symmetric positive semidefinite K_k of dim components for each *key*
   * k. The weights g of the unknowns u of all parts are the same for all
   * components, except for constrained ones. On the next coarser level, G
   * becomes G P. G has dim rows for each key, on the process that owns it, and
   * interleaved components of unknowns as columns.
   */
  template <int dim>
  class LatticeCoupling
  {
  public:
    using Blocks = std::vector<SingleVector>;

    /// The weight of a key for a global unknown of a part. @p key is the global
    /// number of the key in its group. Constrained components (bits) have no
    /// weight.
    struct Weight
    {
      std::uint64_t                   key;
      dealii::types::global_dof_index unknown;
      double                          weight;
      unsigned char                   constrained;
    };

    /// Return whether there are no keys.
    bool
    is_empty() const
    {
      return groups.empty();
    }

    /// Begin a group of keys with the stiffness of the keys of this process.
    void
    add_keys(const std::vector<dealii::Tensor<2, dim>> &stiffness);

    /// Collective. Add weights to keys of the last group, which may belong to
    /// other processes. The sum of all weights of an own key is multiplied by
    /// its factor. The @p layout numbers the unknowns of the part.
    void
    add_weights(const unsigned int         part,
                const InterleavedLayout   &layout,
                const std::vector<Weight> &weights,
                const std::vector<double> &factors);

    /// Collective. Append a level. @p transfers[part] are the unknowns of the
    /// coarser level, or null if the part is the same there. @p layouts belong
    /// to the finer level.
    void
    coarsen(const std::vector<const LatticeUnknowns<dim> *> &transfers,
            const std::vector<const InterleavedLayout *>    &layouts);

    /// Remove all levels but the first.
    void
    reset()
    {
      levels.resize(1);
    }

    /// Collective. Add @p factor C x of a level to y.
    void
    add_product(const unsigned int level,
                Blocks            &y,
                const Blocks      &x,
                const double       factor) const;

    /// Collective. Return the entries of C between owned unknowns of this
    /// process and between equal components, sorted. The unknowns of the parts
    /// are numbered one part after another.
    std::vector<BlockEntry>
    owned_entries(const unsigned int                            level,
                  const std::vector<const InterleavedLayout *> &layouts) const;

    /// An entry of G in the row of a component of a key. Its column is unknown
    /// * dim + component, for a global unknown of a part.
    struct Entry
    {
      unsigned int component, part;
      PetscInt     column;
      double       weight;
    };

    /// Call visit(K, entries) for the keys of this process.
    using Visit = std::function<void(const dealii::Tensor<2, dim> &stiffness,
                                     const std::vector<Entry>     &entries)>;
    void
    for_each_key(const unsigned int level, const Visit &visit) const;

  private:
    /// The weights of a group for a part.
    struct Term
    {
      unsigned int group, part;
      PetscMatrix  G;
    };

    std::vector<std::vector<dealii::Tensor<2, dim>>> groups; // K of own keys
    std::vector<std::vector<Term>> levels = std::vector<std::vector<Term>>(1);
    mutable std::vector<std::vector<double>> gaps; // by group
    mutable std::vector<double>              of_unknowns, of_keys;
  };
} // namespace greville
