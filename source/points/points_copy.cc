// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/points_copy.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    bool
    is_exact(const unsigned int k)
    {
      using Layout = PointLayout<dim>;
      return k == Layout::mass || k == Layout::volume0 || k == Layout::id;
    }



    /**
     * Return the offsets of the numbers of a point, which are subtracted before
     * rounding; in addition, the position is subtracted from the initial one.
     */
    template <int dim>
    std::vector<double>
    offsets(const MaterialPoints<dim> &points, const unsigned int cell)
    {
      std::vector<double> result(points.layout().size, 0.);
      const Point<dim>    center = points.space().box(cell).center;
      const PointRef<dim> offset(result.data());
      for (unsigned int d = 0; d < dim; ++d)
        offset.position(d) = center[d];
      offset.set_F(unit_symmetric_tensor<3>());
      offset.J() = 1.;
      if (points.layout().projected_J != 0)
        result[points.layout().projected_J] = 1.;
      if (points.layout().is_axisymmetric())
        result[points.layout().radius0] = center[0];
      return result;
    }
  } // namespace



  template <int dim>
  void
  PointsCopy<dim>::copy(const MaterialPoints<dim> &points)
  {
    using Layout            = PointLayout<dim>;
    layout                  = points.layout();
    const unsigned int size = layout.size;
    cells                   = points.cells();
    counts.clear();
    exact.clear();
    rounded.clear();
    // Reserve exactly the required memory.
    exact.reserve(points.n_points() * 3);
    rounded.reserve(points.n_points() * (size - 3));
    std::vector<double> offset;
    unsigned int        last_cell = MaterialPoints<dim>::none;
    points.for_each([&](const unsigned int cell, ConstPointRef<dim> p) {
      if (cell != last_cell)
        {
          offset = offsets(points, cell);
          counts.push_back(points.n_points(cell));
          last_cell = cell;
        }
      for (unsigned int k = 0; k < size; ++k)
        if (is_exact<dim>(k))
          exact.push_back(p[k]);
        else if (k >= Layout::reference && k < Layout::reference + dim)
          rounded.push_back(p[k] - p.position(k - Layout::reference));
        else
          rounded.push_back(p[k] - offset[k]);
    });
  }



  template <int dim>
  void
  PointsCopy<dim>::restore(MaterialPoints<dim> &points) const
  {
    using Layout                  = PointLayout<dim>;
    const SplineSpace<dim> &space = points.space();
    std::vector<double>     p(layout.size);
    const double           *e = exact.data();
    const float            *r = rounded.data();
    points.reinit(space, layout);
    for (unsigned int c = 0; c < cells.size(); ++c)
      {
        const std::vector<double> offset = offsets(points, cells[c]);
        for (unsigned int i = 0; i < counts[c]; ++i)
          {
            for (unsigned int k = 0; k < layout.size; ++k)
              p[k] = is_exact<dim>(k) ? *e++ : *r++ + offset[k];
            for (unsigned int d = 0; d < dim; ++d)
              p[Layout::reference + d] += p[Layout::position + d];
            points.insert(cells[c], make_array_view(p));
          }
      }
    points.defragment();
  }



  template <int dim>
  std::size_t
  PointsCopy<dim>::memory_consumption() const
  {
    return (cells.capacity() + counts.capacity()) * sizeof(unsigned int) +
           exact.capacity() * sizeof(double) +
           rounded.capacity() * sizeof(float);
  }



  template class PointsCopy<2>;
  template class PointsCopy<3>;
} // namespace greville
