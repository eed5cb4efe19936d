// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/named_formulas.h>
#include <greville/boundary/surface_loads.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::vector<std::string>
    load_variables()
    {
      return dim == 2
               ? std::vector<std::string>{"x", "y", "X", "Y", "t"}
               : std::vector<std::string>{"x", "y", "z", "X", "Y", "Z", "t"};
    }



    /**
     * The value of formulas of x, X and t.
     */
    template <int dim, int n>
    Tensor<1, n>
    value_of(const VectorExpression<n> &formulas,
             const SurfaceState<dim>   &state,
             const double               t)
    {
      double arguments[2 * dim + 1];
      for (unsigned int d = 0; d < dim; ++d)
        {
          arguments[d]       = state.x[d];
          arguments[dim + d] = state.X[d];
        }
      arguments[2 * dim] = t;
      return formulas(ArrayView<const double>(arguments, 2 * dim + 1));
    }



    template <int dim>
    class DeadTraction : public SurfaceLoad<dim>
    {
    public:
      DeadTraction(const std::string           &section,
                   const SurfaceLoadParameters &parameters)
        : formulas(parameters.traction,
                   section + "/Traction",
                   load_variables<dim>())
        , per_current_area(parameters.is_per_current_area())
      {}

      Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double t) const override
      {
        const double area = per_current_area ? state.area_vector().norm() : 1.;
        return area * value_of<dim, dim>(formulas, state, t);
      }

    private:
      VectorExpression<dim> formulas;
      const bool            per_current_area;
    };



    template <int dim>
    class Pressure : public SurfaceLoad<dim>
    {
    public:
      Pressure(const std::string           &section,
               const SurfaceLoadParameters &parameters)
        : formula(parameters.pressure,
                  section + "/Pressure",
                  load_variables<dim>())
      {}

      Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double t) const override
      {
        return -value_of<dim, 1>(formula, state, t)[0] * state.area_vector();
      }

    private:
      VectorExpression<1> formula;
    };



    /**
     * What absorbs waves of normal incidence (J. Lysmer, R. Kuhlemeyer, Finite
     * dynamic model for infinite media, 1969), with the normal today.
     */
    template <int dim>
    class Dashpot : public SurfaceLoad<dim>
    {
    public:
      explicit Dashpot(const Material &material)
      {
        const Moduli moduli = material.moduli();
        const double rho    = material.density;
        normal  = std::sqrt(rho * (moduli.bulk + 4. / 3. * moduli.shear));
        tangent = std::sqrt(rho * moduli.shear);
      }

      Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double) const override
      {
        Tensor<1, dim> n = state.area_vector();
        n /= n.norm();
        return -tangent * state.velocity -
               (normal - tangent) * (state.velocity * n) * n;
      }

      double
      damping() const override
      {
        return normal;
      }

    private:
      double normal, tangent; // rho c, Pa s / m
    };



    /**
     * Springs from points to where they were initially, or to a displacement
     * from there.
     */
    template <int dim>
    class Springs : public SurfaceLoad<dim>
    {
    public:
      Springs(const std::string &section,
              const std::string &displacement,
              const double       stiffness)
        : k(stiffness)
      {
        if (displacement.empty())
          return;
        formulas = {displacement,
                    section + "/Displacement",
                    dim == 2 ? std::vector<std::string>{"X", "Y", "t"}
                             : std::vector<std::string>{"X", "Y", "Z", "t"}};
      }

      Tensor<1, dim>
      load(const SurfaceState<dim> &state, const double t) const override
      {
        Tensor<1, dim> u = state.x - state.X;
        if (!formulas.is_zero())
          {
            double arguments[dim + 1];
            for (unsigned int d = 0; d < dim; ++d)
              arguments[d] = state.X[d];
            arguments[dim] = t;
            u -= formulas(ArrayView<const double>(arguments, dim + 1));
          }
        return -k * u;
      }

      double
      stiffness() const override
      {
        return k;
      }

    private:
      const double          k;
      VectorExpression<dim> formulas;
    };



    /**
     * The stiffness of springs that hold a displacement, Pa / m.
     */
    template <int dim>
    double
    penalty(const SurfaceLoadParameters &load,
            const Material              &material,
            const GridParameters        &grid)
    {
      constexpr double factor = 10.;
      if (load.stiffness > 0.)
        return load.stiffness;
      double h = grid.upper[0] - grid.lower[0];
      for (unsigned int d = 0; d < dim; ++d)
        h = std::min(h, (grid.upper[d] - grid.lower[d]) / grid.cells[d]);
      const Moduli moduli = material.moduli();
      return factor * (moduli.bulk + 4. / 3. * moduli.shear) / h;
    }



    // The kinds of SurfaceLoadParameters::kind, one line each.
    template <int dim>
    std::unique_ptr<SurfaceLoad<dim>>
    make_load(const std::string           &section,
              const SurfaceLoadParameters &load,
              const Material              &material,
              const GridParameters        &grid)
    {
      using Load = std::unique_ptr<SurfaceLoad<dim>>;
      const std::map<std::string, std::function<Load()>> kinds = {
        {"traction",
         [&]() { return std::make_unique<DeadTraction<dim>>(section, load); }},
        {"pressure",
         [&]() { return std::make_unique<Pressure<dim>>(section, load); }},
        {"dashpot", [&]() { return std::make_unique<Dashpot<dim>>(material); }},
        {"spring",
         [&]() {
           return std::make_unique<Springs<dim>>(section, "", load.stiffness);
         }},
        {"displacement", [&]() {
           return std::make_unique<Springs<dim>>(
             section, load.displacement, penalty<dim>(load, material, grid));
         }}};
      return kinds.at(load.kind)();
    }
  } // namespace



  template <int dim>
  SurfaceLoads<dim>::SurfaceLoads(const SimulationParameters &all)
    : names(all.general.surface_loads)
  {
    for (const std::string &name : names)
      {
        parameters.push_back(all.surface_loads.at(name));
        const SurfaceLoadParameters &load = parameters.back();
        const BodyParameters        &body = all.bodies.at(load.body);
        loads.push_back(make_load<dim>("Surface load " + name,
                                       load,
                                       *all.materials.at(body.material),
                                       all.grid));
      }
    for (const std::string &name : all.general.contacts)
      {
        const ContactParameters &contact = all.contacts.at(name);
        const auto               sides   = contact.sides();
        for (unsigned int side = 0; side < 2; ++side)
          for (const std::string &body : sides[side])
            if (std::count(all.general.bodies.begin(),
                           all.general.bodies.end(),
                           body) > 0)
              contacts.push_back(
                {name, body, side == 0 && contact.is_by_material_points()});
      }
  }



  template <int dim>
  std::string
  SurfaceLoads<dim>::description() const
  {
    std::string result;
    for (unsigned int k = 0; k < names.size(); ++k)
      {
        const SurfaceLoadParameters &load = parameters[k];
        const auto                   add  = [&](const std::string &name,
                             const std::string &value) {
          if (!value.empty())
            result += (result.empty() ? "" : ", ") +
                      ("'Surface load " + names[k]) + "/" + name + "' <" +
                      formula_text(value) + ">";
        };
        add("Traction", load.traction);
        add("Pressure", load.pressure);
        add("Displacement", load.displacement);
        if (load.stiffness > 0.)
          add("Stiffness", text_of(load.stiffness));
      }
    return result;
  }



  template <int dim>
  std::vector<Surface<dim>>
  SurfaceLoads<dim>::make_surfaces(const std::vector<Body<dim>> &bodies,
                                   const SplineSpace<dim>       &space) const
  {
    std::map<std::string, std::vector<SurfacePoint<dim>>> placed;
    std::vector<Surface<dim>>                             result;
    const auto find_body = [&](const std::string &name) {
      const auto body =
        std::find_if(bodies.begin(), bodies.end(), [&](const auto &body) {
          return body.name == name;
        });
      AssertThrow(body != bodies.end(), ExcInternalError());
      return body;
    };
    const auto add = [&](const std::string &name,
                         const std::string &section,
                         const std::string &where,
                         const std::string &body_name,
                         const std::string &contact) {
      const auto body = find_body(body_name);
      if (placed.count(body_name) == 0)
        run_on_all(
          [&]() {
            placed[body_name] = place_surface_points<dim>(*body->parameters,
                                                          "Body " + body_name,
                                                          space);
          },
          space.communicator());
      result.push_back(make_surface<dim>(
        name, section, where, *body, placed[body_name], space, contact));
      result.back().body = body - bodies.begin();
    };
    for (unsigned int k = 0; k < loads.size(); ++k)
      {
        add(names[k],
            "Surface load " + names[k],
            parameters[k].where,
            parameters[k].body,
            "");
        result.back().stiffness = loads[k]->stiffness();
        result.back().damping   = loads[k]->damping();
      }
    for (const auto &[contact, body_name, is_of_material_points] : contacts)
      {
        const std::string name = contact + " of " + body_name;
        if (is_of_material_points)
          {
            const auto body = find_body(body_name);
            result.push_back(make_contactors<dim>(name, contact, *body, space));
            result.back().body = body - bodies.begin();
          }
        else
          add(name, "Contact " + contact, "", body_name, contact);
      }
    return result;
  }



  template <int dim>
  void
  SurfaceLoads<dim>::set(std::vector<Surface<dim>> &surfaces,
                         const double               t) const
  {
    for (unsigned int k = 0; k < loads.size(); ++k)
      {
        const PointLayout<dim> &layout = surfaces[k].points.layout();
        const unsigned int      first  = layout.first("load");
        surfaces[k].points.for_each([&](const unsigned int, PointRef<dim> p) {
          const Tensor<1, dim> load =
            loads[k]->load(surface_state<dim>(p, layout), t);
          if (!(load.norm() <= 1e100))
            {
              std::ostringstream message;
              message << "'Surface load " << names[k]
                      << "': the point of the initial position ("
                      << p.reference()
                      << ") m gets more than 1e100 Pa at t = " << t << " s";
              AssertThrow(false, ExcMessage(message.str()));
            }
          for (unsigned int d = 0; d < dim; ++d)
            p[first + d] = load[d];
        });
      }
  }



  template <int dim>
  void
  SurfaceLoads<dim>::clear(std::vector<Surface<dim>> &surfaces) const
  {
    for (unsigned int k = 0; k < loads.size(); ++k)
      {
        Surface<dim>      &surface = surfaces[k];
        const unsigned int first   = surface.points.layout().first("load");
        surface.points.for_each([&](const unsigned int, PointRef<dim> p) {
          for (unsigned int d = 0; d < dim; ++d)
            p[first + d] = 0.;
        });
      }
  }



  template <int dim>
  std::vector<LoadedSurface<dim>>
  SurfaceLoads<dim>::loaded(const std::vector<Surface<dim>> &surfaces,
                            const double                     t) const
  {
    std::vector<LoadedSurface<dim>> result;
    for (unsigned int k = 0; k < loads.size(); ++k)
      result.push_back(
        {&surfaces[k].points,
         [load = loads[k].get(), t](const ConstPointRef<dim>,
                                    const SurfaceState<dim> &state) {
           return load->load(state, t);
         }});
    return result;
  }



  template <int dim>
  std::vector<std::pair<std::string, Tensor<1, dim>>>
  SurfaceLoads<dim>::resultants(const std::vector<Surface<dim>> &surfaces,
                                const double                     t,
                                const MPI_Comm                   comm) const
  {
    std::vector<std::pair<std::string, Tensor<1, dim>>> result;
    for (unsigned int k = 0; k < loads.size(); ++k)
      {
        const PointLayout<dim> &layout = surfaces[k].points.layout();
        Tensor<1, dim>          sum;
        run_on_all(
          [&]() {
            surfaces[k].points.for_each(
              [&](const unsigned int, ConstPointRef<dim> p) {
                sum +=
                  p.mass() * loads[k]->load(surface_state<dim>(p, layout), t);
              });
          },
          comm);
        result.emplace_back(names[k], Utilities::MPI::sum(sum, comm));
      }
    return result;
  }



  template class SurfaceLoads<2>;
  template class SurfaceLoads<3>;
} // namespace greville
