#ifndef greville_particles_material_points_h
#define greville_particles_material_points_h

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/array_view.h>

#include <greville/spline/spline_space.h>

#include <string>
#include <vector>

namespace greville
{
  /**
   * Where the numbers of a material point lie. Each is counted in doubles from
   * the begin of the point; symmetric tensors are stored as xx, yy, zz, xy (in
   * 3D then xz, yz), the deformation gradient row by row, in 2D followed by
   * F_zz.
   */
  template <int dim>
  struct PointLayout
  {
    static constexpr unsigned int n_stress = dim == 2 ? 4 : 6;
    static constexpr unsigned int n_F      = dim == 2 ? 5 : 9;

    /// x, m.
    static constexpr unsigned int position = 0;
    /// v, m / s.
    static constexpr unsigned int velocity = position + dim;
    /// m, kg (in 2D per metre of thickness).
    static constexpr unsigned int mass = velocity + dim;
    /// V0, volume of the stress-free state, m^3 (in 2D m^2).
    static constexpr unsigned int volume0 = mass + 1;
    /// J = V / V0.
    static constexpr unsigned int J = volume0 + 1;
    /// Cauchy stress, Pa.
    static constexpr unsigned int stress = J + 1;
    /// rho c^2 of the fastest wave, Pa (MaterialPoint::wave_modulus).
    static constexpr unsigned int wave_modulus = stress + n_stress;
    /// Deformation gradient from the stress-free state.
    static constexpr unsigned int F = wave_modulus + 1;
    /// The initial position, m.
    static constexpr unsigned int reference = F + n_F;
    /// A number that no other point of the body has.
    static constexpr unsigned int id = reference + dim;
    /// Number of doubles that every point has.
    static constexpr unsigned int n_fixed = id + 1;

    PointLayout() = default;

    /**
     * @p n_state history variables, and where asked for the affine matrix of
     * APIC (dim x dim, row by row, 1 / s) and an acceleration by loads (dim
     * numbers, m / s^2).
     */
    PointLayout(const unsigned int n_state,
                const bool         has_affine,
                const bool         has_load);

    unsigned int n_state    = 0;
    bool         has_affine = false;
    bool         has_load   = false;
    unsigned int state      = n_fixed;
    unsigned int affine     = n_fixed;
    unsigned int load       = n_fixed;
    /// Number of doubles of a point.
    unsigned int size = n_fixed;
  };



  /**
   * The material points of one body on this process, sorted by cells.
   *
   * Points lie in *groups* of four points of one cell, an array
   * [number of the point's double][lane] each, so that a kernel loads one
   * number of all points of a group by one instruction. The groups of a cell
   * form a list; all but the first are full. Lanes without a point hold one
   * without mass and volume at the centre of the cell, which adds nothing
   * anywhere: no kernel needs masks. A point that changes its cell is copied,
   * all others stay where they are; defragment() puts groups into the order of
   * the cells again when many have moved.
   *
   * Cells are counted as in SplineSpace::owned_cells().
   */
  template <int dim>
  class MaterialPoints
  {
  public:
    static constexpr unsigned int none = -1;

    /**
     * Points of a group.
     */
    static constexpr unsigned int width = 4;

    /**
     * The space is kept by reference; its order does not matter.
     */
    void
    reinit(const SplineSpace<dim> &space, const PointLayout<dim> &layout);

    const PointLayout<dim> &
    layout() const
    {
      return point_layout;
    }

    const SplineSpace<dim> &
    space() const
    {
      return *spline_space;
    }

    /**
     * Points on this process.
     */
    std::size_t
    n_points() const
    {
      return n_all_points;
    }

    unsigned int
    n_points(const unsigned int cell) const
    {
      return counts[cell];
    }

    /**
     * The cells with points, ascending.
     */
    const std::vector<unsigned int> &
    cells() const;

    /**
     * The first group of a cell, none where there is no point.
     */
    unsigned int
    first_group(const unsigned int cell) const
    {
      return heads[cell];
    }

    /**
     * The group behind @p group in the list of its cell, or none.
     */
    unsigned int
    next_group(const unsigned int group) const
    {
      return links[group];
    }

    /**
     * Number of points in the first group of a cell; the others are full.
     */
    unsigned int
    n_in_first_group(const unsigned int cell) const
    {
      return counts[cell] == 0 ? 0 : (counts[cell] - 1) % width + 1;
    }

    /**
     * The numbers of a group: number k of lane l is at k * width + l.
     */
    double *
    group(const unsigned int g)
    {
      return data.data() + std::size_t(g) * point_layout.size * width;
    }

    const double *
    group(const unsigned int g) const
    {
      return data.data() + std::size_t(g) * point_layout.size * width;
    }

    /**
     * Call @p action(cell, values) for all points, with a strided pointer:
     * number k of the point is values[k * stride()].
     */
    template <typename Action>
    void
    for_each(const Action &action) const
    {
      for (const unsigned int cell : cells())
        {
          unsigned int n = n_in_first_group(cell);
          for (unsigned int g = heads[cell]; g != none; g = links[g], n = width)
            for (unsigned int lane = 0; lane < n; ++lane)
              action(cell, group(g) + lane);
        }
    }

    template <typename Action>
    void
    for_each(const Action &action)
    {
      for (const unsigned int cell : cells())
        {
          unsigned int n = n_in_first_group(cell);
          for (unsigned int g = heads[cell]; g != none; g = links[g], n = width)
            for (unsigned int lane = 0; lane < n; ++lane)
              action(cell, group(g) + lane);
        }
    }

    static constexpr unsigned int
    stride()
    {
      return width;
    }

    /**
     * Add a point with layout().size numbers to a cell.
     */
    void
    insert(const unsigned int                     cell,
           const dealii::ArrayView<const double> &values);

    /**
     * Take the points out of @p cell whose position is not in it any more and
     * append their numbers to @p leaving.
     */
    void
    remove_leaving(const unsigned int cell, std::vector<double> &leaving);

    /**
     * Whether @p position lies in the half-open box of a cell; at the upper
     * walls of the grid in the closed one. False for what is no number.
     */
    bool
    is_inside(const unsigned int cell,
              const double      *position,
              const unsigned int stride) const;

    /**
     * Make the lanes without a point harmless again.
     */
    void
    clean(const unsigned int cell);

    /**
     * Put the groups into the order of the cells.
     */
    void
    defragment();

    /**
     * Bytes of points and lists on this process.
     */
    std::size_t
    memory_consumption() const;

  private:
    unsigned int
    new_group();

    void
    clear_lane(const unsigned int cell,
               const unsigned int g,
               const unsigned int lane);

    const SplineSpace<dim> *spline_space = nullptr;
    PointLayout<dim>        point_layout;
    std::size_t             n_all_points = 0;

    // More than the groups need, so that it seldom has to grow.
    dealii::AlignedVector<double> data;
    std::vector<unsigned int>     heads;  // per cell
    std::vector<unsigned int>     counts; // per cell
    std::vector<unsigned int>     links;  // per group
    unsigned int                  free_groups = none;

    mutable std::vector<unsigned int> filled_cells;
    mutable bool                      filled_cells_are_valid = false;
  };
} // namespace greville

#endif
