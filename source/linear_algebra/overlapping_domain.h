// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <greville/linear_algebra/interleaved_layout.h>
#include <greville/linear_algebra/row_variants.h>

#include <algorithm>
#include <array>
#include <map>

namespace greville
{
  namespace internal
  {
    /// The domain of a process: its rows of A, and some layers of unknowns that
    /// A couples with them, in lexicographic order. Rows that differ between
    /// variants are last.
    class OverlappingDomain
    {
    public:
      using Number   = dealii::types::global_dof_index;
      using Position = std::array<int, 3>;

      /// A matrix entry with global numbers, and the process of its column.
      struct SharedEntry
      {
        Number       row, column;
        unsigned int owner_of_column;
        double       value;
      };

      /// An unknown with a process that owns it or needs its row.
      struct UnknownOf
      {
        Number       unknown;
        unsigned int process;
      };

      struct Ghost
      {
        Number        unknown;
        Position      position;
        unsigned char differs, fixed; // see RowVariants
      };

      /// An entry between rows of the domain.
      struct DomainEntry
      {
        unsigned int row, column;
        double       value;
      };

      /// Collective. All arguments are kept by reference.
      OverlappingDomain(const UpperTriangle         &matrix,
                        const InterleavedLayout     &layout,
                        const std::vector<Position> &own_positions,
                        const unsigned int           n_layers,
                        const RowVariants           &variants);

      /// Return the unknowns of the overlap, ascending.
      const std::vector<Number> &
      ghosts() const
      {
        return ghost_numbers;
      }

      /// The local unknowns in lexicographic order, and the local unknown of
      /// each row.
      std::vector<unsigned int> lexicographic, order;

      const std::vector<Position> &
      local_positions() const
      {
        return positions;
      }

      /// The number of rows that are equal in all variants.
      unsigned int
      n_common() const
      {
        return std::count(differs.begin(), differs.end(), 0);
      }

      /// Return R A R^T.
      UpperTriangle
      domain_matrix() const
      {
        return domain_matrix(matrix);
      }

      /// Collective. Return R A R^T of a variant. Its last rows are given.
      UpperTriangle
      domain_matrix(const unsigned int variant);

      /// Return the last rows of R A R^T.
      UpperTriangle
      last_rows(const UpperTriangle &all) const;

      /// Return which of the last rows are constrained in a variant.
      std::vector<unsigned char>
      is_fixed(const unsigned int variant) const;

    private:
      /// Return R A R^T, from the given entries of this process, and the
      /// entries of other processes that were exchanged last.
      UpperTriangle
      domain_matrix(const UpperTriangle &own) const;

      /// Append the entries of a row between two owned unknowns that both
      /// differ between variants, or both do not: such unknowns keep their
      /// order in the domain.
      void
      append_own_entries(UpperTriangle       &result,
                         const UpperTriangle &own,
                         const unsigned int   row) const;

      static void
      add_to_last_row(UpperTriangle     &result,
                      const DomainEntry *entry,
                      const DomainEntry *end);

      /// Call visit(j, A_ij) for the entries of this process in a row.
      template <typename Visit>
      void
      for_each_entry(const UpperTriangle &of,
                     const unsigned int   i,
                     const Visit         &visit) const
      {
        for (std::size_t e = of.row_begin[i]; e < of.row_begin[i + 1]; ++e)
          visit(of.columns[e], of.values[e]);
      }

      /// Collective. Send the entries with unknowns of other processes to these
      /// processes, and store the entries in own rows. Entries between two
      /// unknowns of one process are sent once.
      void
      sum_shared_rows(const UpperTriangle &own);

      /// Collective. Add layers of ghosts, and find who needs own rows.
      void
      find_ghosts(const unsigned int n_layers);

      /// Collective. Add the given unknowns that are not known yet.
      void
      add_ghosts(std::vector<UnknownOf> &unknowns);

      /// Return the columns of own rows for the processes that need the rows.
      std::map<unsigned int, std::vector<UnknownOf>>
      columns_for_others() const;

      /// Return the entries that processes need besides the entries that they
      /// share: entries between own rows that they need, once, and entries in
      /// other columns.
      std::map<unsigned int, std::vector<SharedEntry>>
      rows_for_others(const UpperTriangle &own) const;

      void
      find_order();

      unsigned int
      owner(const unsigned int unknown) const
      {
        return unknown < n_owned ? me : owners[unknown - n_owned];
      }

      bool
      is_owned(const Number unknown) const
      {
        return n_owned > 0 && unknown >= layout.global_number(0) &&
               unknown < layout.global_number(0) + n_owned;
      }

      bool
      is_ghost(const Number unknown) const;

      /// Return the local number of an unknown, or invalid_unsigned_int. The
      /// search begins after the @p last ghost found, and updates it.
      unsigned int
      local(const Number unknown, unsigned int &last) const;

      unsigned int
      local(const Number unknown) const
      {
        unsigned int last = n_owned;
        return local(unknown, last);
      }

      const UpperTriangle      &matrix;
      const InterleavedLayout  &layout;
      const RowVariants        &variants;
      const MPI_Comm            comm;
      const unsigned int        me, n_owned;
      std::vector<unsigned int> owners;    // of the ghosts of the layout
      std::vector<SharedEntry>  shared;    // in own rows
      std::vector<SharedEntry>  received;  // in rows of the overlap
      std::vector<Position>     positions; // of local unknowns
      std::vector<std::vector<unsigned int>> processes_of_row; // that need it
      std::vector<Ghost>                     all_ghosts;       // of the domain
      std::vector<Number>                    ghost_numbers;    // ascending
      std::vector<unsigned int>              row_of; // of local unknowns
      std::vector<unsigned char>             differs, fixed; // likewise
    };
  } // namespace internal
} // namespace greville
