// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/partitioner.h>

#include <memory>
#include <vector>

namespace greville
{
  /// The unknowns that a process owns, and the unknowns of other processes that
  /// it stores (ghosts). Vectors have several values per unknown, their
  /// *width*: value c of local unknown u is entry u * width + c. Owned unknowns
  /// come first, then ghosts in the order of their global numbers.
  class InterleavedLayout
  {
  public:
    InterleavedLayout() = default;

    /// Collective. Owned unknowns have the global numbers from @p first to
    /// @p first + @p n_owned; @p ghosts ascend.
    InterleavedLayout(
      const dealii::types::global_dof_index               first,
      const dealii::types::global_dof_index               n_owned,
      const std::vector<dealii::types::global_dof_index> &ghosts,
      const MPI_Comm                                      communicator)
      : first(first)
      , n_all(dealii::Utilities::MPI::sum(n_owned, communicator))
      , n_own(n_owned)
      , ghosts(ghosts)
      , comm(communicator)
    {}

    unsigned int
    n_owned() const
    {
      return n_own;
    }

    unsigned int
    n_local() const
    {
      return n_own + ghosts.size();
    }

    dealii::types::global_dof_index
    global_number(const unsigned int unknown) const
    {
      return unknown < n_own ? first + unknown : ghosts[unknown - n_own];
    }

    MPI_Comm
    communicator() const
    {
      return comm;
    }

    /// Return the layout of vectors. Collective at the first call for a width.
    const std::shared_ptr<const dealii::Utilities::MPI::Partitioner> &
    partitioner(const unsigned int width) const;

  private:
    dealii::types::global_dof_index              first = 0, n_all = 0;
    unsigned int                                 n_own = 0;
    std::vector<dealii::types::global_dof_index> ghosts;
    MPI_Comm                                     comm = MPI_COMM_SELF;
    mutable std::
      array<std::shared_ptr<const dealii::Utilities::MPI::Partitioner>, 9>
        partitioners;
  };

  /// The unknowns of several parts in one system. Each process numbers its
  /// owned unknowns one part after another.
  struct JoinedLayout
  {
    /// Collective.
    explicit JoinedLayout(const std::vector<const InterleavedLayout *> &parts);

    InterleavedLayout layout;
    /// By part, the numbers of its local unknowns in the system, ascending.
    std::vector<std::vector<unsigned int>> numbers;
  };
} // namespace greville
