// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_extended_unknowns_templates_h
#define greville_mass_extended_unknowns_templates_h

#include <greville/mass/extended_unknowns.h>

namespace greville
{
  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_unknown(const unsigned int i,
                                          const Visit       &visit) const
  {
    const int signed_number = signed_numbers[i];
    if (signed_number > 0)
      visit(unsigned(signed_number - 1), 1.);
    else if (signed_number < 0)
      for (std::size_t e = extended_begin[-signed_number - 1];
           e < extended_begin[-signed_number];
           ++e)
        visit(extended_entries[e].unknown, extended_entries[e].weight);
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_image_of_unknown(const Visit &visit) const
  {
    for (const auto &[f, place] : stencil->images())
      if (signed_numbers[stencil->place(f)] > 0)
        visit(unsigned(signed_numbers[stencil->place(f)] - 1),
              std::size_t(place));
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_active(const unsigned int n_functions,
                                         const Visit       &visit) const
  {
    for (unsigned int f = 0; f < n_functions; ++f)
      if ((*extension)[f] != Extension<dim>::inactive)
        visit(f, std::size_t(stencil->place(f)));
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_active_place(const Visit &visit) const
  {
    for_each_active(constrained_functions.size(), visit);
    for_each_active_image(visit);
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_active_image(const Visit &visit) const
  {
    for (const auto &[f, place] : stencil->images())
      if ((*extension)[f] != Extension<dim>::inactive)
        visit(f, std::size_t(place));
  }


  template <int dim>
  bool
  ExtendedUnknowns<dim>::is_constrained(const unsigned int function,
                                        const unsigned int column) const
  {
    return (constrained_functions[function] >> (column % dim)) & 1;
  }


  template <int dim>
  bool
  ExtendedUnknowns<dim>::may_extend_constrained(const unsigned int place,
                                                const unsigned int column) const
  {
    const int signed_number = signed_numbers[place];
    if (signed_number >= 0)
      return false;
    for (std::size_t e = extended_begin[-signed_number - 1];
         e < extended_begin[-signed_number];
         ++e)
      {
        const unsigned int u = extended_entries[e].unknown;
        if (u >= n_owned || is_constrained(owned_unknown_functions[u], column))
          return true;
      }
    return false;
  }


  template <int dim>
  unsigned int
  ExtendedUnknowns<dim>::n_owned_functions() const
  {
    return stencil->space().owned_functions().size();
  }
} // namespace greville

#endif
