// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/particles/body.h>

#include "formula_gradient.h"
#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;
  using namespace internal;

  namespace
  {
    /**
     * Initial stress at a point.
     */
    template <int dim>
    class InitialStress
    {
    public:
      InitialStress(const BodyParameters &parameters,
                    const std::string    &section,
                    const Tensor<1, dim> &gravity,
                    const Lattice<dim>   &lattice,
                    const double          density)
        : K0(parameters.K0)
        , weight(density * gravity.norm())
      {
        if (!parameters.stress.empty())
          {
            AssertThrow(K0 < 0.,
                        ExcMessage("'" + section +
                                   "' has both 'Stress' and 'K0': it can be "
                                   "given by one only."));
            components = {parameters.stress,
                          section + "/Stress",
                          coordinate_names<dim>()};
          }
        if (K0 >= 0.)
          {
            for (unsigned int d = 0; d < dim; ++d)
              if (std::abs(gravity[d]) > 0.999 * gravity.norm())
                axis = d;
            AssertThrow(axis < dim && weight > 0.,
                        ExcMessage("The parameter '" + section +
                                   "/K0' needs a gravity along an axis, but "
                                   "'Loads/Gravity' is (" +
                                   text_of(gravity) + ") m / s^2 at t = 0."));
            cell_size   = lattice.cell_size(axis);
            grid_height = lattice.upper(axis) - lattice.lower(axis);
            upwards     = gravity[axis] < 0. ? 1. : -1.;
            surface     = {parameters.surface,
                           section + "/Surface",
                           coordinate_names<dim>()};
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
            AssertThrow(depth > -0.5 * cell_size,
                        ExcMessage(
                          "this point lies " + text_of(-depth) +
                          " m beyond the parameter 'Surface', which is " +
                          text_of(height) +
                          " m there; nothing of a body with K0 does."));
            AssertThrow(depth < deepest * grid_height,
                        ExcMessage(
                          "the parameter 'Surface' is " + text_of(height) +
                          " m there, which is " + text_of(depth) +
                          " m above this point: more than " + text_of(deepest) +
                          " heights of the grid. Is it given in m?"));
            for (unsigned int d = 0; d < 3; ++d)
              result[d][d] =
                -weight * std::max(0., depth) * (d == axis ? 1. : K0);
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
      double       K0;
      double       weight;
      unsigned int axis    = dim;
      double       upwards = 1.;
      // Depths beyond this many heights of the grid are errors.
      static constexpr double                      deepest     = 1000.;
      double                                       cell_size   = 0.;
      double                                       grid_height = 0.;
      VectorExpression<1>                          surface;
      VectorExpression<PointLayout<dim>::n_stress> components;
    };



    /**
     * Initial displacement: it moves a point, deforms it, and lets the
     * material find the stress.
     */
    template <int dim>
    void
    displace(Point<dim>                    &x,
             MaterialPoint                 &state,
             const Material                &material,
             const VectorExpression<dim>   &displacement,
             const std::array<double, dim> &steps)
    {
      if (displacement.is_zero())
        return;
      state.increment =
        unit_symmetric_tensor<3>() + gradient_of<dim>(displacement, x, steps);
      x += displacement(x);
      state.F = state.increment * state.F;
      state.J *= determinant(state.increment);
      state.dt = 0.; // it has no rate
      AssertThrow(state.J > 0.,
                  ExcMessage("the displacement turns the body inside out."));
      material.update(ArrayView<MaterialPoint>(&state, 1));
    }



    /**
     * Throw where a body is given in more than one way, or in none.
     */
    template <int dim>
    void
    check_geometry(const BodyParameters &parameters, const std::string &section)
    {
      std::string last;
      for (const auto &given :
           {std::make_pair("Shape", &parameters.shape),
            std::make_pair("Shape file", &parameters.shape_file),
            std::make_pair("Points file", &parameters.points_file)})
        if (!given.second->empty())
          {
            AssertThrow(last.empty(),
                        ExcMessage("'" + section + "' has both '" + last +
                                   "' and '" + given.first + "'."));
            last = given.first;
          }
      AssertThrow(!last.empty(),
                  ExcMessage(
                    "The parameter '" + section +
                    "/Shape' is empty: it takes a formula like " +
                    (dim == 2 ? "box(0, 0, 1, 2)" : "box(0, 0, 0, 1, 1, 2)") +
                    ", unless there is a 'Shape file' or a 'Points file'."));
    }



    template <int dim>
    void
    insert_points(Body<dim>                           &body,
                  const std::vector<PlacedPoint<dim>> &new_points,
                  const std::string                   &section,
                  const Tensor<1, dim>                &gravity)
    {
      const BodyParameters    &parameters = *body.parameters;
      const Material          &material   = *body.material;
      const PointLayout<dim>  &layout     = body.points.layout();
      const PointField        *affine     = layout.find("affine");
      const Lattice<dim>      &lattice    = body.points.space().lattice();
      const InitialStress<dim> stress(
        parameters, section, gravity, lattice, material.density);
      const auto formulas = [&](const std::string &text, const char *name) {
        return text.empty() ? VectorExpression<dim>()
                            : VectorExpression<dim>(text,
                                                    section + name,
                                                    coordinate_names<dim>());
      };
      const auto displacement =
        formulas(parameters.displacement, "/Displacement");
      const auto velocity = formulas(parameters.velocity, "/Velocity");

      // A velocity that jumps shall not get a steep gradient.
      std::array<double, dim>       steps;
      const std::array<double, dim> small_steps =
        displacement_steps<dim>(lattice);
      for (unsigned int d = 0; d < dim; ++d)
        steps[d] = 0.1 * lattice.cell_size(d);

      const double        strength_reduction = material.strength_reduction(0.);
      std::vector<double> values(layout.size);
      const PointRef<dim> p(values.data());
      for (const PlacedPoint<dim> &point : new_points)
        {
          std::fill(values.begin(), values.end(), 0.);
          MaterialPoint state;
          Point<dim>    x          = point.image;
          double        J_of_shape = 1.;
          state.F                  = unit_symmetric_tensor<3>();
          state.increment          = state.F;
          state.strength_reduction = strength_reduction;
          try
            {
              material.initialize(state, stress(point.image));
              J_of_shape = state.J;
              if (layout.initial_F != 0)
                for (unsigned int d = 0; d < dim; ++d)
                  for (unsigned int e = 0; e < dim; ++e)
                    p[layout.initial_F + d * dim + e] = state.F[d][e];
              displace<dim>(x, state, material, displacement, small_steps);
            }
          catch (const std::exception &error)
            {
              AssertThrow(false,
                          ExcMessage(
                            "'" + section + "'" +
                            (parameters.material.empty()
                               ? ""
                               : " of 'Material " + parameters.material + "'") +
                            " at (" + text_of(point.image) +
                            ") m: " + message_of(error)));
            }
          const Tensor<1, dim> v = velocity(point.image);
          for (unsigned int d = 0; d < dim; ++d)
            {
              p.position(d)  = x[d] + (point.x[d] - point.image[d]);
              p.reference(d) = point.x[d];
              p.velocity(d)  = v[d];
            }
          // APIC's matrix is the gradient of the velocity at the place to
          // which the displacement has moved the point.
          if (affine && !velocity.is_zero() &&
              parameters.imposed_velocity.empty())
            {
              const Tensor<2, 3> C =
                gradient_of<dim>(velocity, point.image, steps) *
                invert(state.increment);
              for (unsigned int d = 0; d < dim; ++d)
                for (unsigned int e = 0; e < dim; ++e)
                  p[affine->first + d * dim + e] = C[d][e];
            }
          p.mass()    = material.density * point.volume;
          p.volume0() = point.volume / J_of_shape;
          p.J()       = state.J;
          p.id()      = double(point.id);
          p.set_F(state.F);
          store_material_point<dim>(state, p, layout);
          body.points.insert(point.cell, make_array_view(values));
        }
    }
  } // namespace



  template <int dim>
  std::vector<unsigned int>
  make_points(Body<dim>              &body,
              const SplineSpace<dim> &space,
              const Tensor<1, dim>   &gravity,
              const PointLayout<dim> &layout)
  {
    const BodyParameters &parameters = *body.parameters;
    const std::string     section    = "Body " + body.name;
    body.points.reinit(space, layout);
    run_on_all(
      [&]() {
        check_geometry<dim>(parameters, section);
        const auto new_points =
          parameters.points_file.empty()
            ? place_points<dim>(parameters, section, space)
            : points_of_file<dim>(parameters.points_file, section, space);
        insert_points(body, new_points, section, gravity);
        if (!parameters.imposed_velocity.empty())
          body.rigid_motion.emplace(parameters.imposed_velocity,
                                    section + "/Imposed velocity",
                                    std::vector<std::string>{"t"});
      },
      space.communicator());

    body.points.defragment();
    body.n_points = Utilities::MPI::sum<std::uint64_t>(body.points.n_points(),
                                                       space.communicator());
    AssertThrow(body.n_points > 0,
                ExcMessage("The body of '" + section +
                           "' is empty: there is no point inside <" +
                           parameters.shape + parameters.shape_file +
                           "> in the grid: is it outside ('Grid/Lower corner', "
                           "'Grid/Upper corner'), or are the cells too large "
                           "('Grid/Cells')?"));
    return parameters.displacement.empty() ? std::vector<unsigned int>()
                                           : body.points.cells();
  }



  template decltype(make_points<2>) make_points<2>;
  template decltype(make_points<3>) make_points<3>;
} // namespace greville
