// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/parameters/names.h>
#include <greville/spline/level_functions.h>
#include <greville/steps/adapt_grid.h>
#include <greville/steps/body_surfaces.h>
#include <greville/steps/refinement_marks.h>
#include <greville/steps/stage_bodies.h>
#include <greville/steps/state_tables.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Cells at surfaces that are filled less may be cut before the next
    // adaptation.
    constexpr double well_filled = 0.97;

    // A point is divided if its volume exceeds this part of a cell, in units of
    // the cell's 2^dim-th part.
    constexpr double largest_part = 1.5;
  } // namespace



  namespace
  {
    template <int dim>
    std::vector<const MaterialPoints<dim> *>
    points_of(const State<dim> &state)
    {
      std::vector<const MaterialPoints<dim> *> result;
      for (const Body<dim> &body : state.bodies)
        result.push_back(&body.points);
      return result;
    }
  } // namespace



  template <int dim>
  bool
  has_cells_of(const SplineSpace<dim> &space, const CellHierarchy<dim> &levels)
  {
    bool result = true;
    run_on_all(space.communicator(), [&]() {
      for (unsigned int cell = 0; cell < space.owned_cells().size(); ++cell)
        result = result && levels.is_active(space.box(cell).index);
    });
    return !Utilities::MPI::logical_or(!result, space.communicator());
  }



  template <int dim>
  std::vector<std::uint64_t>
  cells_at_surfaces(const SplineSpace<dim>                         &space,
                    const std::vector<const MaterialPoints<dim> *> &points)
  {
    PointTransfer<dim> transfer;
    transfer.reinit(space);
    std::vector<double> parts;
    transfer.filling(points, parts);
    CellFilling<dim> filling(space);
    filling.update(parts, well_filled);
    const Extension<dim> extension(space, filling);
    // Empty cells need no splines.
    std::vector<std::uint64_t> cut;
    for (const std::uint64_t position :
         extension.level_functions().cells_to_refine())
      if (parts[space.find(position)] > 0.)
        cut.push_back(position);
    std::vector<std::uint64_t> cells;
    for (const auto &of_process :
         Utilities::MPI::all_gather(space.communicator(), cut))
      cells.insert(cells.end(), of_process.begin(), of_process.end());
    return cells;
  }



  namespace
  {
    /// Return the id of part @p k of a divided point.
    template <int dim>
    double
    id_of_part(const double id, const unsigned int k)
    {
      constexpr double first = PointLayout<dim>::id_of_parts,
                       base  = 1. + (1u << dim);
      double place           = first;
      for (double parts = std::floor(id / first); parts > 0.;
           parts        = std::floor(parts / base))
        place *= base;
      return id + (k + 1) * place;
    }



    /// Return whether points of this layout are those of a surface.
    template <int dim>
    bool
    is_of_surface(const PointLayout<dim> &layout)
    {
      return layout.find("normal") != nullptr;
    }



    /// Return the edge of a point of a surface, m.
    template <int dim>
    double
    edge_on_surface(const ConstPointRef<dim> p, const PointLayout<dim> &layout)
    {
      return std::pow(p.mass() / layout.thickness(p.reference()),
                      1. / (dim - 1.));
    }



    /// Return whether a point has to be divided in a cell. Material points in
    /// contact are never divided: they follow from the points of their body.
    template <int dim>
    bool
    is_large(const ConstPointRef<dim> p,
             const PointLayout<dim>  &layout,
             const CellBox<dim>      &box)
    {
      // Doubles count to 2^53.
      constexpr double largest_id = 9007199254740992.;
      if (layout.find("radius") ||
          id_of_part<dim>(p.id(), (1u << dim) - 1) > largest_id)
        return false;
      if (is_of_surface(layout))
        return std::pow(2. * edge_on_surface(p, layout), dim) >
               largest_part * box.volume();
      // As for the filled part of a cell, spray does not count as large.
      const double J = layout.is_total_lagrangian() ? 1. : std::min(p.J(), 1.5);
      return p.volume0() * J * (1u << dim) >
             largest_part * box.volume() * layout.thickness(box.center);
    }



    /// Return the places of the parts of a point, relative to it, in its
    /// stress-free state.
    template <int dim>
    std::vector<Tensor<1, dim>>
    places_of_parts(const ConstPointRef<dim> p,
                    const PointLayout<dim>  &layout,
                    const CellBox<dim>      &box)
    {
      std::vector<Tensor<1, dim>> quarters; // of edges
      if (is_of_surface(layout))
        {
          const Tensor<1, dim> normal  = p.vector(layout.first("normal"));
          const double         quarter = 0.25 * edge_on_surface(p, layout);
          // A direction with a small part of the normal, made a tangent.
          Tensor<1, dim> tangent;
          if constexpr (dim == 2)
            tangent = cross_product_2d(normal);
          else
            {
              unsigned int d = 0;
              for (unsigned int e = 1; e < dim; ++e)
                d = std::abs(normal[e]) < std::abs(normal[d]) ? e : d;
              tangent[d] = 1.;
              tangent    = cross_product_3d(normal, tangent);
            }
          quarters.push_back(quarter / tangent.norm() * tangent);
          if constexpr (dim == 3)
            quarters.push_back(quarter / tangent.norm() / normal.norm() *
                               cross_product_3d(normal, tangent));
        }
      else
        {
          const double volume = layout.is_axisymmetric()
                                  ? p.volume0() / p[layout.radius0]
                                  : p.volume0();
          for (unsigned int d = 0; d < dim; ++d)
            {
              quarters.emplace_back();
              quarters.back()[d] =
                0.25 * box.size[d] * std::pow(volume / box.volume(), 1. / dim);
            }
        }
      std::vector<Tensor<1, dim>> result(1u << quarters.size());
      for (unsigned int k = 0; k < result.size(); ++k)
        for (unsigned int d = 0; d < quarters.size(); ++d)
          result[k] += (k >> d) % 2 == 0 ? -quarters[d] : quarters[d];
      return result;
    }



    /// Points in the cells of another grid, and their parts.
    template <int dim>
    class MovedPoints
    {
    public:
      MovedPoints(MaterialPoints<dim> &points, const SplineSpace<dim> &space)
        : points(points)
        , space(space)
        , layout(points.layout())
      {}

      /// Collective. Returns the number of divided points of this process.
      std::uint64_t
      move()
      {
        const MaterialPoints<dim> old = std::move(points);
        points                        = MaterialPoints<dim>();
        points.reinit(space, layout);
        std::vector<double> numbers(layout.size);
        for (const unsigned int cell : old.cells())
          for_each_as_inserted(old, cell, [&](const ConstPointRef<dim> p) {
            for (unsigned int i = 0; i < layout.size; ++i)
              numbers[i] = p[i];
            insert(numbers);
          });
        PointTransport<dim> transport;
        transport.reinit(space);
        transport.insert(points, rows);
        return n_divided;
      }

    private:
      void
      insert(const std::vector<double> &numbers)
      {
        const ConstPointRef<dim> p(numbers.data());
        const Lattice<dim>      &lattice = space.lattice();
        const MultiIndex<dim>    index =
          lattice.find_cell(p.basis_position(layout));
        const CellBox<dim> box = lattice.box(index);
        if (is_large(p, layout, box))
          {
            divide(p, numbers, box);
            return;
          }
        const auto position =
          lexicographic<dim>(index, space.cells_per_direction());
        const unsigned int cell = space.find(position);
        if (cell != numbers::invalid_unsigned_int)
          points.insert(cell, make_array_view(numbers));
        else
          {
            rows.push_back(double(position));
            rows.insert(rows.end(), numbers.begin(), numbers.end());
          }
      }

      void
      divide(const ConstPointRef<dim>   p,
             const std::vector<double> &numbers,
             const CellBox<dim>        &box)
      {
        ++n_divided;
        const Tensor<2, dim> F = p.matrix(PointLayout<dim>::F),
                             initial_F =
                               layout.initial_F > 0
                                 ? p.matrix(layout.initial_F)
                                 : Tensor<2, dim>(unit_symmetric_tensor<dim>());
        auto places = places_of_parts(p, layout, box);
        // Points stay in the grid, and parts opposite to one another.
        while (
          !std::all_of(places.begin(), places.end(), [&](const auto &place) {
            return is_in_grid(p.basis_position(layout) +
                              (layout.is_total_lagrangian() ? initial_F : F) *
                                place);
          }))
          for (Tensor<1, dim> &place : places)
            place *= 0.5;
        const PointField *last_position = layout.find("before");
        unsigned int      k             = 0;
        for (const Tensor<1, dim> &place : places)
          {
            std::vector<double>  part = numbers;
            const PointRef<dim>  q(part.data());
            const Tensor<1, dim> now = F * place, before = initial_F * place;
            for (unsigned int d = 0; d < dim; ++d)
              {
                q.position(d) += now[d];
                q.reference(d) += before[d];
                if (last_position)
                  q[last_position->first + d] += now[d];
              }
            // A point has the volume of its part of the plane times its radius.
            double share = 1. / places.size();
            if (layout.is_axisymmetric())
              {
                share *= (p[layout.radius0] + place[0]) / p[layout.radius0];
                // F_zz is the ratio of radii.
                q[layout.radius0] =
                  q.position(0) * p[layout.radius0] / p.position(0);
              }
            q.mass() *= share;
            q.volume0() *= share;
            q.id() = id_of_part<dim>(p.id(), k++);
            insert(part);
          }
      }

      bool
      is_in_grid(const Point<dim> &x) const
      {
        bool result = true;
        for (unsigned int d = 0; d < dim; ++d)
          result = result && x[d] >= space.lower_corner()[d] &&
                   x[d] <= space.upper_corner()[d];
        return result;
      }

      MaterialPoints<dim>    &points;
      const SplineSpace<dim> &space;
      const PointLayout<dim>  layout;
      std::vector<double>     rows; // of other processes
      std::uint64_t           n_divided = 0;
    };



    /// Collective. Return whether points have to be divided.
    template <int dim>
    bool
    has_large_points(const State<dim> &state, const MPI_Comm comm)
    {
      bool result = false;
      for_all_points(state, [&](const MaterialPoints<dim> &points) {
        points.for_each(
          [&](const unsigned int cell, const ConstPointRef<dim> p) {
            result =
              result || is_large(p, points.layout(), points.space().box(cell));
          });
      });
      return Utilities::MPI::logical_or(result, comm);
    }



    /// Collective. Move all points to the cells of a space, and divide large
    /// ones. Returns the number of divided points of bodies.
    template <int dim>
    std::uint64_t
    move_points(State<dim> &state, const SplineSpace<dim> &space)
    {
      std::uint64_t result = 0;
      for (Body<dim> &body : state.bodies)
        {
          const std::uint64_t n =
            Utilities::MPI::sum(MovedPoints<dim>(body.points, space).move(),
                                space.communicator());
          result += n;
          body.n_points += n * ((1u << dim) - 1);
          state.n_points += n * ((1u << dim) - 1);
        }
      for (Surface<dim> &surface : state.surfaces)
        MovedPoints<dim>(surface.points, space).move();
      state.points_have_changed();
      return result;
    }



    /// Collective. Change the cells of the mesh to @p levels, and refine cells
    /// at surfaces until all functions have well-filled cells. Returns the
    /// number of divided points.
    template <int dim>
    std::uint64_t
    change_cells(State<dim>                               &state,
                 Discretization<dim>                      &discretization,
                 std::shared_ptr<const CellHierarchy<dim>> levels,
                 std::vector<std::uint64_t>              &&at_surfaces)
    {
      const unsigned int degree = discretization.space().degree();
      std::unique_ptr<SplineSpace<dim>> space;
      std::uint64_t                     n_divided = 0;
      while (true)
        {
          adapt_box_mesh(discretization.triangulation(), levels);
          auto next =
            std::make_unique<SplineSpace<dim>>(discretization.triangulation(),
                                               degree);
          n_divided += move_points(state, *next);
          space          = std::move(next);
          const auto cut = cells_at_surfaces(*space, points_of(state));
          if (cut.empty())
            break;
          at_surfaces.insert(at_surfaces.end(), cut.begin(), cut.end());
          levels = levels->refined_also(cut);
        }
      std::sort(at_surfaces.begin(), at_surfaces.end());
      discretization.reinit_adapted(at_surfaces);
      for_all_points(state, [&](MaterialPoints<dim> &points) {
        points.set_space(discretization.space());
      });
      state.partition = discretization.partition();
      discretization.initialize_field(state);
      return n_divided;
    }
  } // namespace



  template <int dim>
  Adaptation
  adapt_grid(State<dim>                  &state,
             Discretization<dim>         &discretization,
             const SimulationParameters  &parameters,
             const std::function<void()> &release)
  {
    Adaptation              result;
    const SplineSpace<dim> &space = discretization.space();
    const auto              is_near =
      find_surfaces(parameters, space, state.bodies, state.rigid_bodies, false);
    const auto marks  = mark_cells(state, discretization, parameters, is_near);
    result.is_limited = marks.is_limited;
    const auto levels = parameters.grid.hierarchy<dim>(state.time, is_near)
                          ->refined_also(marks.cells);
    std::vector<std::uint64_t> at_surfaces =
      state.partition->cells->at_surfaces;
    if (has_cells_of(space, *levels->refined_also(at_surfaces)))
      {
        const auto cut = cells_at_surfaces(space, points_of(state));
        // Divided points change the mass of total Lagrangian steps.
        if (cut.empty() && !parameters.scheme.is_total_lagrangian())
          {
            if (has_large_points(state, space.communicator()))
              result.n_divided = move_points(state, space);
            return result;
          }
        if (cut.empty() && !has_large_points(state, space.communicator()))
          return result;
        at_surfaces.insert(at_surfaces.end(), cut.begin(), cut.end());
      }
    else
      at_surfaces.clear();
    result.changes_cells = true;
    // Accelerations that points keep remain valid; explicit steps keep theirs
    // on the grid.
    const unsigned int n_kept =
      keeps_in_points(state.bodies) &&
          !is_explicit_scheme(parameters.scheme.stress_update)
        ? state.field.history.n
        : 0;
    release();
    result.n_divided = change_cells(state,
                                    discretization,
                                    levels->refined_also(at_surfaces),
                                    std::move(at_surfaces));
    if (n_kept > 0)
      {
        discretization.initialize(state.field.history.accelerations[0]);
        state.field.history.n = n_kept;
      }
    return result;
  }



  GREVILLE_INSTANTIATE(has_cells_of);
  GREVILLE_INSTANTIATE(cells_at_surfaces);
  GREVILLE_INSTANTIATE(adapt_grid);
} // namespace greville
