// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/steps/distant_bodies.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // The number of times at which a moving body is compared with the grid.
    constexpr unsigned int n_times = 200;



    /// The motion of a rigid body: it comes near a region, or it moves at all.
    struct Course
    {
      bool comes = false, moves = false;
    };



    /// Follow a rigid body with prescribed motion until it comes near the
    /// region.
    template <int dim, typename IsNear>
    Course
    follow(const RigidBody<dim>   &body,
           RigidPosition<dim>      now,
           const BoundingBox<dim> &region,
           const double            start,
           const double            end,
           const IsNear           &is_near)
    {
      Course             course;
      RigidPosition<dim> before;
      RigidStep<dim>     step;
      step.dt = (end - start) / n_times;
      try
        {
          for (unsigned int k = 0; k < n_times && !course.comes; ++k)
            {
              step.t = start + k * step.dt;
              body.move(now, before, step);
              const double way = body.way(before, now, region);
              course.moves     = course.moves || way > 0.;
              course.comes     = way > 0. && is_near(now, way);
            }
        }
      catch (const ExceptionBase &)
        {
          // The formula fails: the run will end with a message about it.
          course.comes = true;
        }
      return course;
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  notes_of_distant_bodies(const SimulationParameters          &parameters,
                          const std::vector<RigidBody<dim>>   &rigid_bodies,
                          const std::vector<BoundingBox<dim>> &regions)
  {
    std::vector<std::string> notes;
    const bool   may_leave = parameters.scheme.is_total_lagrangian();
    const double start = parameters.time.start, end = parameters.end_of_run();
    for (unsigned int k = 0; k < rigid_bodies.size(); ++k)
      {
        const RigidBody<dim>   &body   = rigid_bodies[k];
        const BoundingBox<dim> &region = regions[k];
        const double size = region.get_boundary_points().first.distance(
          region.get_boundary_points().second);
        const auto is_near = [&](const RigidPosition<dim> &now,
                                 const double              way) {
          return body.may_be_near(region, way + (may_leave ? size : 0.), now);
        };
        const RigidPosition<dim> position = body.position_at_start(start);
        if (is_near(position, 0.))
          continue;
        const std::string name = "'Rigid body " + body.name() + "'",
                          grid = "the grid, (" +
                                 text_of(region.get_boundary_points().first) +
                                 ") to (" +
                                 text_of(region.get_boundary_points().second) +
                                 ") m";
        if (body.is_free())
          {
            notes.push_back(
              name + " is outside of " + grid +
              ", at the start: it has no contact unless it gets there.");
            continue;
          }
        const Course course =
          follow(body, position, region, start, end, is_near);
        if (course.comes)
          continue;
        const std::string problem =
          name + " is " + (may_leave ? "further away from " : "outside of ") +
          grid + (may_leave ? ", than its diagonal" : "") +
          (course.moves
             ? ", until the end of the run, t = " + text_of(end) + " s"
             : ", and does not move") +
          ": nothing meets it. Check its 'Shape'" +
          (course.moves ? " and its motion."
                        : ", or give it a 'Velocity' or a 'Rotation'.");
        Require(course.moves || may_leave, problem);
        notes.push_back(problem);
      }
    return notes;
  }



  GREVILLE_INSTANTIATE(notes_of_distant_bodies);
} // namespace greville
