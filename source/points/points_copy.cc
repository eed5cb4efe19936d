// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/points/points_copy.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    constexpr double two_32 = 4294967296.;



    template <int dim>
    bool
    is_exact(const unsigned int k)
    {
      using Layout = PointLayout<dim>;
      return k == Layout::mass || k == Layout::volume0 || k == Layout::id;
    }



    /// Return the offsets that are subtracted from the numbers of a point
    /// before rounding. The position is also subtracted from the initial one.
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
    runs.clear();
    ids.clear();
    rounded.clear();
    // Reserve exactly the required memory.
    ids.reserve(points.n_points());
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
      const double high_id = std::floor(p.id() / two_32);
      if (runs.empty() || runs.back().mass != p.mass() ||
          runs.back().volume0 != p.volume0() || runs.back().high_id != high_id)
        runs.push_back({p.mass(), p.volume0(), high_id, 0});
      ++runs.back().n;
      ids.push_back(std::uint32_t(p.id() - two_32 * high_id));
      for (unsigned int k = 0; k < size; ++k)
        if (is_exact<dim>(k))
          continue;
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
    const PointRef<dim>     target(p.data());
    const float            *r   = rounded.data();
    auto                    id  = ids.begin();
    auto                    run = runs.begin();
    std::size_t             n   = 0; // of the run
    points.reinit(space, layout);
    std::size_t n_groups = 0;
    for (const unsigned int count : counts)
      n_groups += (count + points.width - 1) / points.width;
    points.reserve(n_groups);
    for (unsigned int c = 0; c < cells.size(); ++c)
      {
        const std::vector<double> offset = offsets(points, cells[c]);
        for (unsigned int i = 0; i < counts[c]; ++i)
          {
            for (unsigned int k = 0; k < layout.size; ++k)
              if (!is_exact<dim>(k))
                p[k] = *r++ + offset[k];
            if (n == run->n)
              {
                ++run;
                n = 0;
              }
            ++n;
            target.mass()    = run->mass;
            target.volume0() = run->volume0;
            target.id()      = two_32 * run->high_id + *id++;
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
           runs.capacity() * sizeof(Run) +
           ids.capacity() * sizeof(std::uint32_t) +
           rounded.capacity() * sizeof(float);
  }



  GREVILLE_INSTANTIATE_CLASS(PointsCopy);
} // namespace greville
