// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/boundary/surface_loads.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    double
    smallest_edge(const GridParameters &grid)
    {
      double h = grid.upper[0] - grid.lower[0];
      for (unsigned int d = 0; d < dim; ++d)
        {
          const std::vector<double> edges = grid.edges(d);
          if (edges.empty())
            h = std::min(h, (grid.upper[d] - grid.lower[d]) / grid.cells[d]);
          for (unsigned int k = 1; k < edges.size(); ++k)
            h = std::min(h, edges[k] - edges[k - 1]);
        }
      return h / (1 << grid.n_levels());
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
        loads.push_back(load.kind->make<dim>({"Surface load " + name,
                                              *all.materials.at(body.material),
                                              smallest_edge<dim>(all.grid)}));
      }
    for (const std::string &name : all.general.contacts)
      {
        const ContactParameters &contact = all.contacts.at(name);
        const auto               sides   = contact.sides();
        for (unsigned int side = 0; side < 2; ++side)
          for (const std::string &body : sides[side])
            if (contains(all.general.bodies, body))
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
      for (const auto &[name, value] : parameters[k].kind->strengths())
        if (!value.empty())
          result += (result.empty() ? "" : ", ") +
                    ("'Surface load " + names[k]) + "/" + name + "' <" +
                    formula_text(value) + ">";
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
        run_on_all(space.communicator(), [&]() {
          placed[body_name] = place_surface_points<dim>(*body->parameters,
                                                        "Body " + body_name,
                                                        space);
        });
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
        surfaces[k].points.for_each([&](PointRef<dim> p) {
          const Tensor<1, dim> load =
            loads[k]->load(surface_state<dim>(p, layout), t);
          if (!(load.norm() <= 1e100))
            {
              std::ostringstream message;
              message << "'Surface load " << names[k]
                      << "': the load on the point with the initial position ("
                      << p.reference()
                      << ") m is more than 1e100 Pa at t = " << t << " s";
              Require(false, message.str());
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
        surface.points.for_each([&](PointRef<dim> p) {
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
        run_on_all(comm, [&]() {
          surfaces[k].points.for_each([&](ConstPointRef<dim> p) {
            sum += p.mass() * loads[k]->load(surface_state<dim>(p, layout), t);
          });
        });
        result.emplace_back(names[k], Utilities::MPI::sum(sum, comm));
      }
    return result;
  }



  GREVILLE_INSTANTIATE_CLASS(SurfaceLoads);
} // namespace greville
