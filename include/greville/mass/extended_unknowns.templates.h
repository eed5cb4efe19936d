// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

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


  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::initialize_vector(VectorOf<Number>  &vector,
                                           const unsigned int width) const
  {
    vector.reinit(layout->partitioner(width));
  }



  namespace internal
  {
    /// to[c] += factor * from[c].
    template <int width, typename Number>
    inline void
    add(Number *to, const Number factor, const Number *from)
    {
      for (int c = 0; c < width; ++c)
        to[c] += factor * from[c];
    }

    template <int width, typename Number>
    inline void
    copy(Number *to, const Number *from)
    {
      for (int c = 0; c < width; ++c)
        to[c] = from[c];
    }
  } // namespace internal



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::zero_constrained(Number            *values,
                                          const unsigned int width) const
  {
    for (const auto &entry : constrained_places)
      for (unsigned int c = 0; c < width; ++c)
        if ((entry.second >> (c % dim)) & 1)
          values[std::size_t(entry.first) * width + c] = Number(0.);
  }



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::expand(const Number      *x,
                                const unsigned int width,
                                Number            *values) const
  {
    with_width(width, [&](const auto w) {
      constexpr int n = decltype(w)::value;
      for (unsigned int u = 0; u < unknowns.size(); ++u)
        if (unknowns[u] != dealii::numbers::invalid_unsigned_int)
          internal::copy<n>(values + std::size_t(unknowns[u]) * n,
                            x + std::size_t(u) * n);
      for (unsigned int k = 0; k < extended.size(); ++k)
        {
          Number sum[n] = {};
          for (std::size_t e = extended_begin[k]; e < extended_begin[k + 1];
               ++e)
            internal::add<n>(sum,
                             Number(extended_entries[e].weight),
                             x + std::size_t(extended_entries[e].unknown) * n);
          internal::copy<n>(values + std::size_t(extended[k]) * n, sum);
        }
    });
  }



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::collect(Number            *y,
                                 const unsigned int width,
                                 const Number      *values) const
  {
    with_width(width, [&](const auto w) {
      constexpr int n = decltype(w)::value;
      for (unsigned int u = 0; u < unknowns.size(); ++u)
        if (unknowns[u] != dealii::numbers::invalid_unsigned_int)
          internal::copy<n>(y + std::size_t(u) * n,
                            values + std::size_t(unknowns[u]) * n);
        else
          for (int c = 0; c < n; ++c)
            y[std::size_t(u) * n + c] = Number(0.);
      for (unsigned int k = 0; k < extended.size(); ++k)
        for (std::size_t e = extended_begin[k]; e < extended_begin[k + 1]; ++e)
          internal::add<n>(y + std::size_t(extended_entries[e].unknown) * n,
                           Number(extended_entries[e].weight),
                           values + std::size_t(extended[k]) * n);
    });
  }



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::zero_constrained_unknowns(
    VectorOf<Number> &x, const unsigned int width) const
  {
    for (const auto &entry : constrained_places)
      {
        const int signed_number = signed_numbers[entry.first];
        if (signed_number <= 0 || signed_number > int(n_owned))
          continue;
        for (unsigned int c = 0; c < width; ++c)
          if ((entry.second >> (c % dim)) & 1)
            x.local_element((signed_number - 1) * width + c) = Number(0.);
      }
  }



  template <int dim>
  template <typename Number>
  void
  ExtendedUnknowns<dim>::multiply(
    VectorOf<Number>                                    &y,
    VectorOf<Number>                                    &x,
    const unsigned int                                   width,
    const std::function<void(Number *, const Number *)> &product) const
  {
    // Products are set only at places with a row; they must be zero before.
    Number *values, *products = reinterpret_cast<Number *>(place_y.data());
    if constexpr (std::is_same_v<Number, double>)
      values = place_x.data();
    else
      values = single_x.data();
    x.update_ghost_values();
    expand(x.begin(), width, values);
    zero_constrained(values, width);
    product(products, values);
    zero_constrained(products, width);
    collect(y.begin(), width, products);
    y.compress(dealii::VectorOperation::add);
    zero_constrained_unknowns(y, width);
    x.zero_out_ghost_values();
  }
} // namespace greville
