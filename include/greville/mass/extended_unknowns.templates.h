// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_mass_extended_unknowns_templates_h
#define greville_mass_extended_unknowns_templates_h

#include <greville/base/with_width.h>
#include <greville/mass/extended_unknowns.h>

namespace greville
{
  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_unknown(const unsigned int i,
                                          const Visit       &visit) const
  {
    const int role = roles[i];
    if (role > 0)
      visit(unsigned(role - 1), 1.);
    else if (role < 0)
      for (std::size_t e = extended_begin[-role - 1]; e < extended_begin[-role];
           ++e)
        visit(extended_entries[e].unknown, extended_entries[e].weight);
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_image_of_unknown(const Visit &visit) const
  {
    for (const auto &[f, place] : places->images())
      if (roles[places->place(f)] > 0)
        visit(unsigned(roles[places->place(f)] - 1), std::size_t(place));
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_active(const unsigned int n_functions,
                                         const Visit       &visit) const
  {
    for (unsigned int f = 0; f < n_functions; ++f)
      if ((*extension)[f] != Extension<dim>::inactive)
        visit(f, std::size_t(places->place(f)));
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_active_place(const Visit &visit) const
  {
    for_each_active(held_functions.size(), visit);
    for_each_active_image(visit);
  }


  template <int dim>
  template <typename Visit>
  void
  ExtendedUnknowns<dim>::for_each_active_image(const Visit &visit) const
  {
    for (const auto &[f, place] : places->images())
      if ((*extension)[f] != Extension<dim>::inactive)
        visit(f, std::size_t(place));
  }


  template <int dim>
  bool
  ExtendedUnknowns<dim>::is_held(const unsigned int function,
                                 const unsigned int column) const
  {
    return (held_functions[function] >> (column % dim)) & 1;
  }


  template <int dim>
  bool
  ExtendedUnknowns<dim>::may_extend_held(const unsigned int place,
                                         const unsigned int column) const
  {
    const int role = roles[place];
    if (role >= 0)
      return false;
    for (std::size_t e = extended_begin[-role - 1]; e < extended_begin[-role];
         ++e)
      {
        const unsigned int u = extended_entries[e].unknown;
        if (u >= n_owned || is_held(owned_unknown_functions[u], column))
          return true;
      }
    return false;
  }


  template <int dim>
  unsigned int
  ExtendedUnknowns<dim>::n_owned_functions() const
  {
    return places->space().owned_functions().size();
  }



  namespace internal
  {
    /**
     * to[c] += factor * from[c].
     */
    template <int width, typename Number>
    inline void
    add_columns(double *to, const double factor, const Number *from)
    {
      for (int c = 0; c < width; ++c)
        to[c] += factor * from[c];
    }

    template <int width, typename To, typename From>
    inline void
    copy_columns(To *to, const From *from)
    {
      for (int c = 0; c < width; ++c)
        to[c] = To(from[c]);
    }
  } // namespace internal



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::zero_held(Number            *values,
                                   const unsigned int width) const
  {
    for (const auto &entry : held_places)
      for (unsigned int c = 0; c < width; ++c)
        if ((entry.second >> (c % dim)) & 1)
          values[std::size_t(entry.first) * width + c] = 0.;
  }



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::expand(Number            *values,
                                const double      *x,
                                const unsigned int width) const
  {
    with_width(width, [&](const auto w) {
      constexpr int n = decltype(w)::value;
      for (unsigned int u = 0; u < unknowns.size(); ++u)
        if (unknowns[u] != dealii::numbers::invalid_unsigned_int)
          internal::copy_columns<n>(values + std::size_t(unknowns[u]) * n,
                                    x + std::size_t(u) * n);
      for (unsigned int k = 0; k < extended.size(); ++k)
        {
          double sum[n] = {};
          for (std::size_t e = extended_begin[k]; e < extended_begin[k + 1];
               ++e)
            internal::add_columns<n>(
              sum,
              extended_entries[e].weight,
              x + std::size_t(extended_entries[e].unknown) * n);
          internal::copy_columns<n>(values + std::size_t(extended[k]) * n, sum);
        }
    });
  }



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::collect(double            *y,
                                 const Number      *values,
                                 const unsigned int width) const
  {
    with_width(width, [&](const auto w) {
      constexpr int n = decltype(w)::value;
      for (unsigned int u = 0; u < unknowns.size(); ++u)
        if (unknowns[u] != dealii::numbers::invalid_unsigned_int)
          internal::copy_columns<n>(y + std::size_t(u) * n,
                                    values + std::size_t(unknowns[u]) * n);
        else
          for (int c = 0; c < n; ++c)
            y[std::size_t(u) * n + c] = 0.;
      for (unsigned int k = 0; k < extended.size(); ++k)
        for (std::size_t e = extended_begin[k]; e < extended_begin[k + 1]; ++e)
          internal::add_columns<n>(y +
                                     std::size_t(extended_entries[e].unknown) *
                                       n,
                                   extended_entries[e].weight,
                                   values + std::size_t(extended[k]) * n);
    });
  }



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::multiply(
    VectorType                                          &y,
    VectorType                                          &x,
    const unsigned int                                   width,
    const std::function<void(Number *, const Number *)> &product) const
  {
    Number *at_places, *of_rows;
    if constexpr (std::is_same_v<Number, float>)
      {
        at_places = single_x.data();
        of_rows   = single_y.data();
      }
    else
      {
        at_places = place_x.data();
        of_rows   = place_y.data();
      }
    x.update_ghost_values();
    expand(at_places, x.begin(), width);
    zero_held(at_places, width);
    product(of_rows, at_places);
    zero_held(of_rows, width);
    collect(y.begin(), of_rows, width);
    y.compress(dealii::VectorOperation::add);
    zero_held_unknowns(y, width);
    x.zero_out_ghost_values();
  }
} // namespace greville

#endif
