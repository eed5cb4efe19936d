// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/spline/coarse_cells.h>

#include <algorithm>
#include <sstream>

namespace greville
{
  namespace
  {
    // Numbers of coarse cells without a noticeable cost.
    constexpr double accepted_cells = 1e4, proposed_cells = 1000.;



    template <int dim>
    double
    product(const MultiIndex<dim> &n)
    {
      double result = 1.;
      for (const unsigned int factor : n)
        result *= factor;
      return result;
    }



    template <int dim>
    std::string
    text_of(const MultiIndex<dim> &n)
    {
      std::string result;
      for (unsigned int d = 0; d < dim; ++d)
        result += (d == 0 ? "" : ", ") + std::to_string(n[d]);
      return result;
    }
  } // namespace



  template <int dim>
  CoarseCells<dim>::CoarseCells(const MultiIndex<dim> &n_cells)
    : n(n_cells)
  {
    const auto is_even = [](const unsigned int k) {
      return k > 0 && k % 2 == 0;
    };
    while (std::all_of(n.begin(), n.end(), is_even))
      {
        for (unsigned int &k : n)
          k /= 2;
        ++n_refinements;
      }
  }



  template <int dim>
  double
  CoarseCells<dim>::n_all() const
  {
    return product<dim>(n);
  }



  template <int dim>
  std::string
  describe_many_coarse_cells(const MultiIndex<dim> &n_cells,
                             const unsigned int     n_processes)
  {
    const double n_coarse = CoarseCells<dim>(n_cells).n_all();
    if (n_coarse <= accepted_cells ||
        n_coarse * n_processes <= product<dim>(n_cells))
      return "";
    // Round up to multiples of a power of two.
    MultiIndex<dim> better = n_cells;
    for (unsigned int unit = 2;
         CoarseCells<dim>(better).n_all() > proposed_cells;
         unit *= 2)
      for (unsigned int d = 0; d < dim; ++d)
        better[d] = (n_cells[d] + unit - 1) / unit * unit;
    std::ostringstream message;
    message << "The parameter 'Grid/Cells' is <" << text_of<dim>(n_cells)
            << ">, which makes " << n_coarse
            << " coarse cells, and each process keeps all of them, more than "
               "its share of the cells. Cells are halved from coarse ones as "
               "long as all numbers are even: <"
            << text_of<dim>(better) << "> makes "
            << CoarseCells<dim>(better).n_all() << ".";
    return message.str();
  }



  GREVILLE_INSTANTIATE_CLASS(CoarseCells);
  GREVILLE_INSTANTIATE(describe_many_coarse_cells);
} // namespace greville
