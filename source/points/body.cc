// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/geometry/points_file.h>
#include <greville/geometry/shape.h>
#include <greville/points/body.h>
#include <greville/points/point_fields.h>
#include <greville/points/point_material.h>

#include "formula_gradient.h"
#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /// The initial stress at a point.
    template <int dim>
    class InitialStress
    {
    public:
      InitialStress(const BodyParameters         &parameters,
                    const std::string            &section,
                    const Tensor<1, dim>         &gravity,
                    const SplineSpace<dim>       &space,
                    const double                  density,
                    const std::vector<SoilLayer> &soil,
                    const WaterTable<dim>        &table)
        : K0(parameters.K0)
        , g(gravity)
        , table(table)
        , weight(density * gravity.norm())
      {
        if (!parameters.stress.empty())
          {
            Require(K0 < 0.,
                    "'" + section +
                      "' has both 'Stress' and 'K0': give one of them.");
            components = {parameters.stress,
                          section + "/Stress",
                          coordinate_names<dim>()};
          }
        if (K0 >= 0.)
          {
            for (unsigned int d = 0; d < dim; ++d)
              if (std::abs(gravity[d]) > 0.999 * gravity.norm())
                axis = d;
            Require(
              axis < dim && weight > 0.,
              "The parameter '" + section +
                "/K0' needs a gravity along an axis, but 'Loads/Gravity' is (" +
                text_of(gravity) + ") m / s^2 at t = 0.");
            cell_size = space.largest_cell_size(axis);
            grid_height =
              space.upper_corner()[axis] - space.lower_corner()[axis];
            upwards = gravity[axis] < 0. ? 1. : -1.;
            surface = {parameters.surface,
                       section + "/Surface",
                       coordinate_names<dim>()};
            for (const SoilLayer &layer : soil)
              if (const std::string of = "Body " + layer.name; of != section)
                layers.push_back(
                  {{layer.surface, of + "/Surface", coordinate_names<dim>()},
                   Shape<dim>(layer.shape, of + "/Shape"),
                   layer.density * gravity.norm()});
          }
      }

      SymmetricTensor<2, 3>
      operator()(const Point<dim> &x) const
      {
        SymmetricTensor<2, 3> result;
        if (K0 >= 0.)
          {
            const double height = surface(x)[0];
            const double depth  = upwards * (height - x[axis]);
            Require(
              depth > -0.5 * cell_size,
              "this point lies " + text_of(-depth) +
                " m beyond the parameter 'Surface', which is " +
                text_of(height) +
                " m there: a body with 'K0' has to lie below its 'Surface' "
                "everywhere, in the direction of 'Loads/Gravity' = (" +
                text_of(g) + ") m / s^2.");
            Require(depth < deepest * grid_height,
                    "the parameter 'Surface' is " + text_of(height) +
                      " m there, which is " + text_of(depth) +
                      " m above this point: more than " + text_of(deepest) +
                      " heights of the grid. Is it given in m?");
            const double pressure = weight * std::max(0., depth) +
                                    pressure_above(x, height) - table(x);
            for (unsigned int d = 0; d < 3; ++d)
              result[d][d] = -pressure * (d == axis ? 1. : K0);
          }
        else
          {
            const auto sigma = components(x); // in the order of the entries
            for (unsigned int k = 0; k < PointLayout<dim>::n_stress; ++k)
              result.access_raw_entry(k) = sigma[k];
          }
        return result;
      }

    private:
      struct Layer
      {
        VectorExpression<1> surface;
        Shape<dim>          shape;
        double              weight; // N / m^3
      };

      /// Return the weight of the layers above the surface at a place, and of
      /// the water above them, Pa.
      double
      pressure_above(Point<dim> x, const double height) const
      {
        const double negligible = 1e-9 * cell_size;
        double       last       = upwards * height;
        std::vector<std::pair<double, const Layer *>> above;
        for (const Layer &layer : layers)
          try
            {
              const double h = upwards * layer.surface(x)[0];
              if (h > last + negligible)
                above.emplace_back(h, &layer);
            }
          catch (const std::exception &)
            {
              // The formula need not have a value outside of its body.
            }
        std::sort(above.begin(), above.end());
        double pressure = 0.;
        for (const auto &[h, layer] : above)
          {
            x[axis] = upwards * 0.5 * (last + h);
            if (h > last + negligible && layer->shape.contains(x))
              {
                pressure += layer->weight * (h - last);
                last = h;
              }
          }
        x[axis] = upwards * last;
        return pressure + std::max(0., table(x));
      }

      double             K0;
      Tensor<1, dim>     g;
      WaterTable<dim>    table;
      double             weight;
      std::vector<Layer> layers;
      unsigned int       axis    = dim;
      double             upwards = 1.;
      // Depths beyond this multiple of the grid's height are errors.
      static constexpr double                      deepest     = 1000.;
      double                                       cell_size   = 0.;
      double                                       grid_height = 0.;
      VectorExpression<1>                          surface;
      VectorExpression<PointLayout<dim>::n_stress> components;
    };



    /// The initial displacement. It moves and deforms a point, and lets the
    /// material compute the stress.
    template <int dim>
    void
    displace(Point<dim>                    &x,
             MaterialPoint                 &state,
             const Material                &material,
             const VectorExpression<dim>   &displacement,
             const std::array<double, dim> &steps,
             const bool                     is_axisymmetric)
    {
      if (displacement.is_zero())
        return;
      state.increment =
        unit_symmetric_tensor<3>() + gradient_of<dim>(displacement, x, steps);
      const double radius = x[0];
      x += displacement(x);
      if (is_axisymmetric)
        state.increment[2][2] = x[0] / radius;
      state.F = state.increment * state.F;
      state.J *= determinant(state.increment);
      state.dt = 0.; // it has no rate
      Require(state.J > 0., "the displacement turns the body inside out.");
      material.update(ArrayView<MaterialPoint>(&state, 1));
    }



    /// Throw unless the parameters define the body in exactly one way.
    template <int dim>
    void
    check_geometry(const BodyParameters &parameters, const std::string &section)
    {
      const std::pair<const char *, const std::string *> ways[] = {
        {"Shape", &parameters.shape},
        {"Shape file", &parameters.shape_file},
        {"Points file", &parameters.points_file}};
      std::string last;
      for (const auto &[name, given] : ways)
        if (!given->empty())
          {
            Require(last.empty(),
                    "'" + section + "' has both '" + last + "' and '" + name +
                      "'.");
            last = name;
          }
      Require(!last.empty(),
              "The parameter '" + section +
                "/Shape' is empty: it takes a formula like " +
                (dim == 2 ? "box(0, 0, 1, 2)" : "box(0, 0, 0, 1, 1, 2)") +
                ", unless there is a 'Shape file' or a 'Points file'.");
    }



    /// Return the groups of columns that files of points may contain besides
    /// positions, volume and mass.
    template <int dim>
    std::vector<std::vector<std::string>>
    groups_of_file(const Material &material)
    {
      std::vector<std::string> velocity;
      for (const std::string &axis : coordinate_names<dim>())
        velocity.push_back("velocity_" + axis);
      std::vector<std::vector<std::string>> groups = {
        velocity, symmetric_entries<dim>("stress"), entries_of_F<dim>(), {"J"}};
      if (!material.state_names().empty())
        groups.push_back(material.state_names());
      return groups;
    }



    /// Initialize the state of a point from a file. The deformation of the file
    /// is used if all history variables of the material are given, too;
    /// otherwise, the point belongs to a body at rest with the given stress.
    template <int dim>
    void
    initialize_from_file(MaterialPoint           &state,
                         const PointsOfFile<dim> &file,
                         const std::size_t        k,
                         const Material          &material)
    {
      using Layout          = PointLayout<dim>;
      const auto groups     = groups_of_file<dim>(material);
      const auto state_list = material.state_names();
      const int  stress = file.find(groups[1][0]), F = file.find(groups[2][0]);
      const int  J = file.find("J");
      const int  history =
        state_list.empty() ? -1 : file.find(state_list.front());
      const bool has_history = state_list.empty() || history >= 0;
      std::array<double, Layout::n_fixed> numbers{};
      for (unsigned int i = 0; stress >= 0 && i < Layout::n_stress; ++i)
        numbers[Layout::stress + i] = file.value(k, stress + i);
      for (unsigned int i = 0; F >= 0 && i < Layout::n_F; ++i)
        numbers[Layout::F + i] = file.value(k, F + i);
      const ConstPointRef<dim>    given(numbers.data());
      const SymmetricTensor<2, 3> sigma = given.stress();
      // Fluids use only J.
      const bool is_deformed =
        (F >= 0 && has_history) || (J >= 0 && material.shares_volume());
      material.initialize(state, is_deformed ? SymmetricTensor<2, 3>() : sigma);
      for (unsigned int i = 0; history >= 0 && i < state_list.size(); ++i)
        state.state[i] = file.value(k, history + i);
      if (!is_deformed)
        return;
      state.F = F >= 0 ? given.F() : Tensor<2, 3>(unit_symmetric_tensor<3>());
      state.J = J >= 0 ? file.value(k, J) : determinant(state.F);
      Require(state.J > 0.,
              "the deformation in the points file has J = " + text_of(state.J) +
                "; it has to be positive.");
      // share_volume() changes only J of fluids.
      const double determinant_of_F = determinant(state.F);
      Require(
        F < 0 || J < 0 || material.shares_volume() ||
          std::abs(determinant_of_F - state.J) <=
            0.01 * state.J + 1e-5 * std::pow(state.F.norm(), 3),
        "the columns 'F_xx', ... and 'J' contradict each other: det F = " +
          text_of(determinant_of_F) + ", and J = " + text_of(state.J) + ".");
      state.stress = sigma;
      state.dt     = 0.;
      material.update(ArrayView<MaterialPoint>(&state, 1));
      if (stress >= 0)
        state.stress = sigma;
    }



    /// Set the box of a point to its volume, with edges proportional to the
    /// edges of a cell over the points per direction. With an initial stress, F
    /// deforms the box of the stress-free state into this box. Fitted points
    /// whose volume differs from this box are a quadrature of a cut cell. They
    /// have no box, because boxes around them would not fill the cell.
    template <int dim>
    void
    set_domain(const PointRef<dim>     p,
               const PointLayout<dim> &layout,
               const CellBox<dim>     &box,
               const BodyParameters   &parameters,
               const double            volume)
    {
      Tensor<1, dim> half;
      double         share = volume;
      for (unsigned int d = 0; d < dim; ++d)
        {
          half[d] = 0.5 * box.size[d];
          if (parameters.points_file.empty())
            half[d] /= parameters.points_per_direction[std::min<std::size_t>(
              d, parameters.points_per_direction.size() - 1)];
          share /= 2. * half[d];
        }
      constexpr double negligible = 1e-6;
      if (parameters.placement == Placement::fitted_lattice &&
          std::abs(share - 1.) > negligible)
        return;
      half *= std::pow(share, 1. / dim);
      Tensor<2, dim> squares;
      Tensor<1, dim> square;
      for (unsigned int i = 0; i < dim; ++i)
        {
          square[i] = half[i] * half[i];
          for (unsigned int j = 0; j < dim; ++j)
            squares[i][j] = p.F(i, j) * p.F(i, j);
        }
      const Tensor<1, dim> free = invert(squares) * square;
      for (unsigned int d = 0; d < dim; ++d)
        p[layout.domain + d] =
          std::isfinite(free[d]) && free[d] > 0. ? std::sqrt(free[d]) : half[d];
    }



    /// The initial values of the points of a body.
    template <int dim>
    struct InitialPoints
    {
      const Body<dim>              &body;
      const PointsOfFile<dim>      &file;
      const std::string            &section;
      const Tensor<1, dim>         &gravity;
      const std::vector<SoilLayer> &layers;
      const WaterTable<dim>        &table;

      const BodyParameters    &parameters = *body.parameters;
      const Material          &material   = *body.material;
      const PointLayout<dim>  &layout     = body.points.layout();
      const PointField        *affine     = layout.find("affine");
      const PointField        *pressure   = layout.find("pore_pressure");
      const SplineSpace<dim>  &space      = body.points.space();
      const InitialStress<dim> stress{
        parameters, section, gravity, space, material.density, layers, table};
      const VectorExpression<dim> displacement =
        initial_formulas<dim>(parameters.displacement,
                              section + "/Displacement");
      const VectorExpression<dim> velocity =
        initial_formulas<dim>(parameters.velocity, section + "/Velocity");
      const std::array<double, dim> difference_steps =
        displacement_steps<dim>(space);

      const double strength_reduction = material.strength_reduction(0.);
      const bool has_stress = !parameters.stress.empty() || parameters.K0 >= 0.;
      const int  file_velocity  = file.find("velocity_x");
      const int  file_mass      = file.find("mass");
      const int  file_reference = file.find("reference_x");

      /// Write a point, number @p k of the file, to @p p, which is zero.
      void
      write(const PointRef<dim>     p,
            const PlacedPoint<dim> &point,
            const std::size_t       k) const
      {
        // Volumes in files are per radian, and placed points have areas.
        const double volume =
          point.volume *
          (file.names.empty() ? layout.thickness(point.image) : 1.);
        MaterialPoint state;
        state.F                  = unit_symmetric_tensor<3>();
        state.increment          = state.F;
        state.strength_reduction = strength_reduction;
        state.dim                = dim;
        for (unsigned int d = 0; d < dim; ++d)
          state.position[d] = point.image[d];
        state.state.resize(layout.n_state);
        Point<dim> x          = point.image;
        double     J_of_shape = 1.;
        try
          {
            J_of_shape = initialize(p, x, state, point, k);
          }
        catch (const std::exception &error)
          {
            Require(false,
                    (parameters.points_file.empty()
                       ? ""
                       : find_in_points_file<dim>(parameters.points_file,
                                                  section,
                                                  point.image)
                           .at(0)) +
                      "'" + section + "'" +
                      (parameters.material.empty()
                         ? ""
                         : " of 'Material " + parameters.material + "'") +
                      " at (" + text_of(point.image) +
                      ") m: " + message_of(error));
          }
        write_motion(p, x, state, point, k);
        p.mass() =
          file_mass >= 0 ? file.value(k, file_mass) : material.density * volume;
        p.volume0() = volume / J_of_shape;
        p.J()       = state.J;
        p.id()      = double(point.id);
        p.set_F(state.F);
        if (layout.is_axisymmetric())
          p[layout.radius0] = p.position(0) / p.F(2, 2);
        if (layout.projected_J != 0)
          p[layout.projected_J] = state.J;
        if (layout.domain != 0)
          set_domain(p,
                     layout,
                     space.box(point.cell),
                     parameters,
                     volume / layout.thickness(point.image));
        store_material_point<dim>(state, p, layout);
      }

      /// Initialize the material and displace the point. Returns J of the
      /// initial stress.
      double
      initialize(const PointRef<dim>     p,
                 Point<dim>             &x,
                 MaterialPoint          &state,
                 const PlacedPoint<dim> &point,
                 const std::size_t       k) const
      {
        if (file.names.empty() || has_stress)
          material.initialize(state, stress(point.image));
        else
          initialize_from_file<dim>(state, file, k, material);
        if (pressure)
          p[pressure->first] = table(point.image);
        const double J_of_shape = state.J;
        if (layout.initial_F != 0)
          for (unsigned int d = 0; d < dim; ++d)
            for (unsigned int e = 0; e < dim; ++e)
              p[layout.initial_F + d * dim + e] = state.F[d][e];
        displace<dim>(x,
                      state,
                      material,
                      displacement,
                      difference_steps,
                      layout.is_axisymmetric());
        return J_of_shape;
      }

      /// Write positions, velocity, and the affine matrix of APIC and Taylor.
      void
      write_motion(const PointRef<dim>     p,
                   const Point<dim>       &x,
                   const MaterialPoint    &state,
                   const PlacedPoint<dim> &point,
                   const std::size_t       k) const
      {
        Tensor<1, dim> v = velocity(point.image);
        for (unsigned int d = 0; d < dim; ++d)
          {
            if (file_velocity >= 0 && parameters.velocity.empty())
              v[d] = file.value(k, file_velocity + d);
            p.position(d)  = x[d] + (point.x[d] - point.image[d]);
            p.reference(d) = file_reference >= 0
                               ? file.value(k, file_reference + d)
                               : point.x[d];
            p.velocity(d)  = v[d];
          }
        // The matrix is the gradient of the velocity at the position at which
        // basis functions are evaluated.
        if (affine && !velocity.is_zero())
          {
            // Avoid steep gradients if the velocity jumps.
            std::array<double, dim> steps;
            for (unsigned int d = 0; d < dim; ++d)
              steps[d] = 0.1 * space.cell_size(d);
            Tensor<2, 3> C = gradient_of<dim>(velocity, point.image, steps);
            if (!layout.is_total_lagrangian())
              C = C * invert(state.increment);
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int e = 0; e < dim; ++e)
                p[affine->first + d * dim + e] = C[d][e];
          }
      }
    };
  } // namespace



  template <int dim>
  std::vector<unsigned int>
  make_points(Body<dim>                    &body,
              const SplineSpace<dim>       &space,
              const Tensor<1, dim>         &gravity,
              const PointLayout<dim>       &layout,
              const std::vector<SoilLayer> &layers,
              const WaterTable<dim>        &table)
  {
    const BodyParameters &parameters = *body.parameters;
    const std::string     section    = "Body " + body.name;
    body.points.reinit(space, layout);
    run_on_all(space.communicator(), [&]() {
      check_geometry<dim>(parameters, section);
      PointsOfFile<dim> file;
      if (parameters.points_file.empty())
        file.points = place_points<dim>(parameters, section, space);
      else
        file = points_of_file<dim>(parameters.points_file,
                                   section,
                                   body.material->density,
                                   groups_of_file<dim>(*body.material),
                                   layout.is_total_lagrangian(),
                                   layout.is_axisymmetric(),
                                   space);
      std::vector<unsigned int> n_in_cell(space.owned_cells().size());
      std::size_t               n_groups = 0;
      for (const PlacedPoint<dim> &point : file.points)
        n_groups += n_in_cell[point.cell]++ % body.points.width == 0;
      body.points.reserve(n_groups);
      const InitialPoints<dim> initial{
        body, file, section, gravity, layers, table};
      std::vector<double> values(layout.size);
      for (std::size_t k = 0; k < file.points.size(); ++k)
        {
          std::fill(values.begin(), values.end(), 0.);
          initial.write(PointRef<dim>(values.data()), file.points[k], k);
          body.points.insert(file.points[k].cell, make_array_view(values));
        }
    });

    body.points.defragment();
    body.n_points = Utilities::MPI::sum<std::uint64_t>(body.points.n_points(),
                                                       space.communicator());
    Require(body.n_points > 0,
            "The body of '" + section +
              "' is empty: there is no point inside <" +
              formula_text(parameters.shape) + parameters.shape_file +
              "> in the grid: is it outside ('Grid/Lower corner', 'Grid/Upper "
              "corner'), or are the cells too large ('Grid/Cells')?");
    return parameters.displacement.empty() ? std::vector<unsigned int>()
                                           : body.points.cells();
  }



  GREVILLE_INSTANTIATE(make_points);
} // namespace greville
