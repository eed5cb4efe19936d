// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/ensemble.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /**
     * Where a point has what a kick changes: entries and their number.
     */
    template <int dim>
    std::vector<std::pair<unsigned int, unsigned int>>
    kicked_entries(const PointLayout<dim> &layout)
    {
      std::vector<std::pair<unsigned int, unsigned int>> result = {
        {PointLayout<dim>::velocity, dim}};
      if (const PointField *affine = layout.find("affine"))
        result.emplace_back(affine->first, dim * dim);
      if (const PointField *load = layout.find("load"))
        result.emplace_back(load->first, dim);
      return result;
    }
  } // namespace



  template <int dim>
  void
  UnfinishedState<dim>::add_kicked(const MaterialPoints<dim> &points,
                                   std::vector<double>       &values)
  {
    const auto entries = kicked_entries(points.layout());
    points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
      for (const auto &[first, n] : entries)
        for (unsigned int k = 0; k < n; ++k)
          values.push_back(p[first + k]);
    });
  }



  template <int dim>
  const double *
  UnfinishedState<dim>::set_kicked(MaterialPoints<dim> &points,
                                   const double        *values)
  {
    const auto entries = kicked_entries(points.layout());
    points.for_each([&](const unsigned int, PointRef<dim> p) {
      for (const auto &[first, n] : entries)
        for (unsigned int k = 0; k < n; ++k)
          p[first + k] = *values++;
    });
    return values;
  }



  template <int dim>
  void
  UnfinishedState<dim>::take(const State<dim> &state, const Lag lag)
  {
    rest         = static_cast<const StateWithoutBodies<dim> &>(state);
    points_stamp = state.points_stamp;
    kicked.clear();
    points.clear();
    const auto keep = [&](const MaterialPoints<dim> &of_body) {
      if (lag == Lag::all)
        points.push_back(of_body);
      else
        add_kicked(of_body, kicked);
    };
    for (const Body<dim> &body : state.bodies)
      keep(body.points);
    for (const Surface<dim> &surface : state.surfaces)
      keep(surface.points);
  }



  template <int dim>
  void
  UnfinishedState<dim>::give_back(State<dim> &state)
  {
    static_cast<StateWithoutBodies<dim> &>(state) = std::move(rest);
    state.points_stamp                            = points_stamp;

    const double *values = kicked.data();
    auto          copy   = points.begin();
    const auto    back   = [&](MaterialPoints<dim> &of_body) {
      if (points.empty())
        values = set_kicked(of_body, values);
      else
        of_body = std::move(*copy++);
    };
    for (Body<dim> &body : state.bodies)
      back(body.points);
    for (Surface<dim> &surface : state.surfaces)
      back(surface.points);
    kicked = {};
    points.clear();
  }



  template <int dim>
  EndOfStep<dim>::EndOfStep(Ensemble<dim> &ensemble)
    : EndOfStep()
  {
    for (unsigned int k = 0; k < ensemble.n_parts(); ++k)
      if (ensemble.part(k).begin_output("output"))
        simulations.push_back(&ensemble.part(k));
  }



  template <int dim>
  EndOfStep<dim>::EndOfStep(Simulation<dim>   &simulation,
                            const std::string &part)
    : EndOfStep()
  {
    if (simulation.begin_output(part))
      simulations.push_back(&simulation);
  }



  template <int dim>
  EndOfStep<dim>::~EndOfStep()
  {
    for (Simulation<dim> *simulation : simulations)
      simulation->end_output();
  }



  template class UnfinishedState<2>;
  template class UnfinishedState<3>;
  template class EndOfStep<2>;
  template class EndOfStep<3>;
} // namespace greville
