// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/step_errors.h>
#include <greville/parameters/pores.h>
#include <greville/parameters/unit_of_sums.h>
#include <greville/steps/contact.h>
#include <greville/steps/implicit_steps.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

// The forces in a step of ImplicitSteps, its checks and messages, and its
// energy balance.
namespace greville
{
  using namespace dealii;

  template <int dim>
  std::string
  ImplicitSteps<dim>::evaluate(const VectorType &x,
                               const double      dt,
                               const bool        with_stiffness)
  {
    const PartTimer timer(log, with_stiffness ? "stiffness" : "residual");
    system.extend(displacement, x);
    std::string problem = system.evaluate(
      bodies, displacement, dt, scheme.stress, with_stiffness, force);
    has_stiffness = with_stiffness;
    // Formulas may have no value at the trial positions of the points.
    if (!surfaces.empty())
      try
        {
          const bool symmetric = system.surfaces().add(surfaces,
                                                       displacement,
                                                       surface_motion,
                                                       with_stiffness,
                                                       new_surface_loads);
          if (with_stiffness)
            surfaces_are_symmetric = symmetric;
        }
      catch (const ErrorOnAll &error)
        {
          problem = message_of(error);
        }
    return first_of_all(problem, discretization.communicator());
  }



  template <int dim>
  void
  ImplicitSteps<dim>::find_residual(VectorType             &r,
                                    const double            dt,
                                    const VectorField<dim> *of_contacts)
  {
    contact_force = of_contacts;
    const PartTimer timer(log, "residual");
    // Sum all loads; force still holds the forces of stresses.
    for (unsigned int d = 0; d < dim; ++d)
      {
        work[d] = new_loads[d];
        if (!surfaces.empty())
          work[d] += new_surface_loads[d];
        if (contact_force)
          work[d] += (*contact_force)[d];
      }
    system.restrict(r, work, nullptr);
    force_scale = std::max(system.bodies().force_scale(), r.l2_norm());
    if (water)
      force_scale = std::max(force_scale, water->force_scale());
    const double old_share = scheme.alpha_f / (1. - scheme.alpha_f);
    for (unsigned int d = 0; d < dim; ++d)
      {
        force[d] -= work[d];
        if (old_share != 0.)
          force[d].add(-old_share, old_force[d], -old_share, old_loads[d]);
        if (!scheme.is_static)
          {
            // (1 - alpha_m) a' + alpha_m a, over 1 - alpha_f
            const double share = 1. / (1. - scheme.alpha_f);
            const double end   = (1. - scheme.alpha_m) * share;
            work[d].equ(end * scheme.alpha_u / (dt * dt), displacement[d]);
            work[d].add(-end * scheme.alpha_v / dt,
                        velocity[d],
                        scheme.alpha_m * share - end * scheme.alpha_a,
                        acceleration[d]);
          }
      }
    system.restrict(r, force, nullptr);
    if (!scheme.is_static)
      {
        last_residual = r;
        system.restrict(r, force, &work);
        last_residual -= r;
        force_scale = std::max(force_scale, last_residual.l2_norm());
      }
    unit_of_round_off = find_round_off();
  }



  template <int dim>
  double
  ImplicitSteps<dim>::find_inertia_at_begin(const double dt)
  {
    if (scheme.is_static)
      return 0.;
    const double share = 1. / (1. - scheme.alpha_f);
    const double end   = (1. - scheme.alpha_m) * share;
    double       sum   = 0.;
    for (VectorType &component : force)
      component = 0.;
    const auto add = [&](const double factor, const VectorField<dim> &field) {
      if (factor == 0.)
        return;
      system.restrict(last_residual, force, &field);
      sum += std::abs(factor) * last_residual.l2_norm();
    };
    add(end * scheme.alpha_v / dt, velocity);
    add(scheme.alpha_m * share - end * scheme.alpha_a, acceleration);
    return sum;
  }



  template <int dim>
  double
  ImplicitSteps<dim>::find_round_off() const
  {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    // Use the mean displacement: coefficients of functions of hardly any mass
    // may have any value.
    const VectorType   &mass = field().lumped_mass;
    std::vector<double> sums(2);
    for (unsigned int i = 0; i < mass.locally_owned_size(); ++i)
      {
        sums[1] += mass.local_element(i);
        for (unsigned int d = 0; d < dim; ++d)
          sums[0] += mass.local_element(i) * displacement[d].local_element(i) *
                     displacement[d].local_element(i);
      }
    Utilities::MPI::sum(sums, discretization.communicator(), sums);
    const double u = sums[1] > 0. ? std::sqrt(sums[0] / sums[1]) : 0.;
    double       x = 0.;
    for (const auto *corner : {&parameters.grid.lower, &parameters.grid.upper})
      for (const double coordinate : *corner)
        x = std::max(x, std::abs(coordinate));
    const double of_surfaces = system.surfaces().stiffness_scale() * x;
    return epsilon * (system.bodies().stiffness_scale() *
                        (1. + u / discretization.cell_size()) +
                      of_surfaces + force_scale + inertia_at_begin);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::check_parameters(const std::string          &name,
                                       const IntegratorParts<dim> &parts) const
  {
    const auto refuse = [&](const bool         wrong,
                            const std::string &parameter,
                            const std::string &why) {
      Require(!wrong,
              "'Scheme/Stress update' = " + name + " does not support " +
                parameter + ": " + why);
    };
    refuse(parameters.time.step.empty(),
           "an empty 'Time/Step'",
           "implicit steps have no critical length; set 'Time/Step'.");
    refuse(discretization.walls().have_friction(),
           "'Walls' = friction",
           "in implicit steps, walls are fixed, sliding or moving.");
    // Contacts of the library are checked above; a program may add others.
    refuse(
      !make_contacts(parts).empty(),
      "a contact of add_contact()",
      "contacts act in explicit steps; its maker has to return null here.");
    for (const Body<dim> &body : parts.initial.bodies)
      refuse(scheme.is_static && body.material->moduli().shear == 0.,
             "the material '" + body.parameters->material + "' of the body '" +
               body.name + "'",
             "only viscosity resists shear in a fluid, so that a sheared "
             "fluid has no equilibrium; take a dynamic scheme such as "
             "backward-euler.");
    refuse(scheme.stress == StepStress::energy_consistent &&
             parameters.scheme.has_projection(),
           "'Scheme/Volumetric projection' = " +
             parameters.scheme.volumetric_projection,
           "the force of the projection does not conserve energy; take another "
           "scheme.");
    refuse(parameters.implicit_solver.method == TangentParameters::Method::cg &&
             parameters.scheme.has_projection(),
           "'Implicit solver/Method' = cg and 'Scheme/Volumetric projection' "
           "= " +
             parameters.scheme.volumetric_projection,
           "the projection makes tangents nonsymmetric; take auto or fgmres.");
    refuse(parameters.scheme.has_affine(),
           "'Scheme/Transfer' = APIC",
           "take FLIP or PIC.");
    refuse(!support_of_mass(parameters.scheme.mass).implicit_steps,
           "'Scheme/Mass' = " + parameters.scheme.mass,
           "take " + masses_with(&MassSupport::implicit_steps) + ".");
    refuse(parameters.loads.cundall != 0.,
           "'Loads/Cundall damping'",
           "quasi-static steps find states at rest without it, and "
           "backward-euler and generalized-alpha damp.");
  }



  template <int dim>
  std::string
  ImplicitSteps<dim>::describe_failure(const State<dim> &state) const
  {
    // Each function needs the strains of some points.
    const unsigned int n_needed_points = std::max(2u, system.space().degree());
    std::string        too_few;
    for (const Body<dim> &body : state.bodies)
      {
        const auto &n = body.parameters->points_per_direction;
        if (body.parameters->points_file.empty() &&
            *std::min_element(n.begin(), n.end()) < n_needed_points)
          too_few = "'Body " + body.name + "/Points per direction' is " +
                    text_of(*std::min_element(n.begin(), n.end())) +
                    ": with fewer than " + text_of(n_needed_points) +
                    " the stiffness of order " +
                    text_of(system.space().degree()) +
                    " is singular, or close to it. ";
      }
    std::string text = too_few;
    if (forces_vanish && too_few.empty())
      text = "only round-off is left of the forces, so that a relative "
             "tolerance cannot be met; 'Newton/Absolute tolerance' sets one "
             "in N. ";
    else if (scheme.is_static && too_few.empty())
      text = "no equilibrium has been found beyond t = " + text_of(state.time) +
             " s. If loads, walls or the strength of materials are still "
             "changing, this is the limit load; a dynamic scheme goes beyond "
             "it. Bodies that are thinner than a cell somewhere need more "
             "points ('Points per direction'). ";
    const std::string acting = loads.surfaces().description();
    if (!acting.empty())
      text += "Loads on surfaces are " + acting + ". ";
    text += describe_water_at_boundaries(parameters);
    if (scheme.is_static && too_few.empty())
      text += "In detail, the";
    else
      text += text.empty() ? "the" : "The";
    text += " step has been cut to " + text_of(state.step_fraction) +
            " of 'Time/Step', and still " + rejection;
    return text;
  }



  template <int dim>
  std::vector<SolverLevel>
  ImplicitSteps<dim>::solver_levels() const
  {
    std::vector<SolverLevel>    result;
    const TangentParameters    &solver    = parameters.implicit_solver;
    const OrderHierarchy<dim>  &hierarchy = system.hierarchy();
    const PMultigridParameters &cycle     = solver.multigrid;
    for (unsigned int l = 0; l < hierarchy.n_levels(); ++l)
      if (l + 1 == hierarchy.n_levels() ||
          solver.use_of_levels != TangentParameters::UseOfLevels::never)
        result.push_back({hierarchy[l].degree(),
                          dim * std::uint64_t(hierarchy[l].n_dofs()),
                          l == 0 && hierarchy.n_levels() > 1
                            ? cycle.coarse_preconditioner
                            : cycle.smoother});
    return result;
  }



  template <int dim>
  void
  ImplicitSteps<dim>::check_support(const State<dim> &state) const
  {
    if (!scheme.is_static)
      return;
    for (const Surface<dim> &surface : state.surfaces)
      if (surface.stiffness > 0.)
        return;
    static const char *names = "xyz";
    const auto        &is_constrained =
      system.finest().extended().unknowns().has_constrained();
    std::string free;
    // Hoop stresses resist radial rigid-body motion.
    for (unsigned int d = parameters.grid.is_axisymmetric() ? 1 : 0; d < dim;
         ++d)
      if (!is_constrained[d])
        free += (free.empty() ? "" : ", ") + std::string(1, names[d]);
    if (!free.empty())
      throw StepFailed("the body can move freely in " + free +
                         ": neither 'Walls' nor springs of a 'Surface load' "
                         "constrain it, so that a quasi-static step has no "
                         "solution",
                       false);
  }



  template <int dim>
  std::string
  ImplicitSteps<dim>::describe_residual() const
  {
    // The largest entry on all processes, and the position of its function.
    const SplineSpace<dim> &space = system.space();
    const auto             &functions =
      system.finest().extended().unknowns().unknown_functions();
    double       largest = 0.;
    unsigned int place   = 0;
    for (unsigned int i = 0; i < last_residual.locally_owned_size(); ++i)
      if (std::abs(last_residual.local_element(i)) > largest)
        {
          largest = std::abs(last_residual.local_element(i));
          place   = functions[i / dim];
        }
    const MPI_Comm comm = discretization.communicator();
    const double   all  = Utilities::MPI::max(largest, comm);
    std::string    text;
    if (all > 0. && largest == all)
      {
        const Point<dim>   x = space.greville_point(place);
        std::ostringstream message;
        message << "; the largest residual, " << all << ' '
                << unit_of_sums("N", dim, parameters.grid) << ", is at (";
        for (unsigned int d = 0; d < dim; ++d)
          message << (d == 0 ? "" : ", ") << x[d];
        message << ") m";
        text = message.str();
      }
    return first_of_all(text, comm);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::find_reactions(State<dim> &state, const double dt)
  {
    // Wall reactions are the residual of the balance at constrained
    // coefficients. There, `force` contains f - F' and `work` the inertia, both
    // divided by 1 - alpha_f.
    const Walls<dim> &walls    = discretization.walls();
    VectorField<dim>  reaction = velocity, known = force;
    for (unsigned int d = 0; d < dim; ++d)
      {
        known[d] *= -1.;
        if (scheme.is_static)
          work[d] = 0.;
      }
    system.finest().extended().constrained_rows(reaction, work, known);
    for (VectorType &component : reaction)
      component *= 1. - scheme.alpha_f;
    const VectorField<dim> of_contacts =
      contact_force ? split_reaction(state, reaction) : VectorField<dim>();
    add_work(state, reaction, dt);
    for (unsigned int d = 0; d < dim && contact_force; ++d)
      reaction[d] += of_contacts[d];
    state.reactions = walls.constrained_sums(reaction);
  }



  template <int dim>
  VectorField<dim>
  ImplicitSteps<dim>::split_reaction(State<dim>       &state,
                                     VectorField<dim> &reaction) const
  {
    VectorField<dim> result = reaction;
    system.finest().extended().constrained_rows(result,
                                                contact_acceleration,
                                                contact_load);
    const double weight = scheme.contact_weight() * (1. - scheme.alpha_f);
    double       work   = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        reaction[d].add(-weight, result[d]);
        for (unsigned int i = 0; i < result[d].locally_owned_size(); ++i)
          work += result[d].local_element(i) * displacement[d].local_element(i);
      }
    state.energy.add_work(EnergyBalance::walls, work);
    return result;
  }



  template <int dim>
  void
  ImplicitSteps<dim>::take_constrained_momentum(State<dim>  &state,
                                                const double dt)
  {
    if (scheme.is_static)
      return;
    // Points lose the constrained momentum by the FLIP kick, or take a velocity
    // without it.
    const bool   is_taken = !scheme.keeps_constrained_momentum;
    const double flip     = discretization.flip_share(state, dt);
    const auto   sums =
      discretization.walls().constrained_sums(constrained_momentum);
    for (unsigned int w = 0; w < 2 * dim; ++w)
      state.reactions[w] += (is_taken ? 1. : 1. - flip) / dt * sums[w];

    const VectorType &lumped      = field().lumped_mass;
    const auto       &constrained = system.finest().constrained_components();
    double            work        = 0.;
    for (unsigned int d = 0; d < dim && is_taken; ++d)
      for (unsigned int i = 0; i < lumped.locally_owned_size(); ++i)
        if (((constrained[i] >> d) & 1) && lumped.local_element(i) > 0.)
          {
            const double momentum = constrained_momentum[d].local_element(i);
            state.field.acceleration[d].local_element(i) +=
              momentum / (dt * lumped.local_element(i));
            work += momentum * velocity[d].local_element(i);
          }
    state.energy.add_work(EnergyBalance::walls, work);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::add_work(State<dim>             &state,
                               const VectorField<dim> &reaction,
                               const double            dt)
  {
    // Forces are taken in the middle of the step, or as means of both ends. At
    // the start, old_loads includes surface loads. If a is known, walls supply
    // the part of M a that loads and stresses do not. The reaction follows from
    // the balance.
    const bool        is_mean        = scheme.load_time == 1.;
    const double      share          = is_mean ? 0.5 : 1.;
    const bool        knows_a        = scheme.needs_acceleration();
    const double      share_of_walls = is_mean && (scheme.is_static || knows_a)
                                         ? 0.5 / (1. - scheme.alpha_f)
                                         : 1.;
    VectorField<dim> &old_rows       = work;
    if (!scheme.is_static)
      {
        // A kept acceleration belongs to another time.
        VectorField<dim> a = acceleration;
        const double     late =
          scheme.keeps_acceleration ? scheme.alpha_f - scheme.alpha_m : 0.;
        if (late != 0.)
          {
            find_new_acceleration(old_rows, dt);
            for (unsigned int d = 0; d < dim; ++d)
              a[d].sadd(1. - late, late, old_rows[d]);
          }
        system.finest().extended().multiply_constrained_rows(old_rows, a);
      }
    const Tensor<1, dim> new_g =
      loads.gravity(state.time + scheme.load_time * dt);
    const Tensor<1, dim> old_g       = loads.gravity(state.time);
    const VectorType    &mass        = field().lumped_mass;
    const auto          &constrained = system.finest().constrained_components();
    double               on_points = 0., by_gravity = 0., by_walls = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < mass.locally_owned_size(); ++i)
        {
          const double u    = displacement[d].local_element(i);
          const double m_u  = mass.local_element(i) * u;
          const double last = old_loads[d].local_element(i);
          const double last_on_points =
            last -
            (surfaces.empty() ? 0. : old_surface_loads[d].local_element(i));
          by_gravity += (share * new_g[d] + (1. - share) * old_g[d]) * m_u;
          on_points += (share * new_loads[d].local_element(i) +
                        (1. - share) * last_on_points) *
                         u -
                       (share * new_g[d] + (1. - share) * old_g[d]) * m_u;
          if ((constrained[i] >> d) & 1)
            {
              const double old_reaction =
                (scheme.is_static ? 0. : old_rows[d].local_element(i)) -
                old_force[d].local_element(i) - last;
              by_walls += (share_of_walls * reaction[d].local_element(i) +
                           (1. - share_of_walls) * old_reaction) *
                          u;
            }
        }
    state.energy.add_work(EnergyBalance::gravity, by_gravity);
    if (loads.act_on_points())
      state.energy.add_work(EnergyBalance::loads, on_points);
    state.energy.add_work(EnergyBalance::walls, by_walls);
    add_work_of_surfaces(state, share);
  }



  template <int dim>
  void
  ImplicitSteps<dim>::add_work_of_surfaces(State<dim>  &state,
                                           const double share)
  {
    // Count each surface load, and then loads that follow the points of bodies.
    // At the start, old_loads contains loads that follow points. Contacts count
    // their own work.
    const unsigned int n_surfaces = loads.surfaces().n_loads();
    const auto         add_power  = [&](const unsigned int      k,
                               const VectorField<dim> &load,
                               const double            factor) {
      double sum = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int i = 0; i < load[d].locally_owned_size(); ++i)
          sum += load[d].local_element(i) * displacement[d].local_element(i);
      state.energy.add_work(k < n_surfaces ? EnergyBalance::surfaces + k
                                           : unsigned(EnergyBalance::loads),
                            factor * sum);
    };
    if (surfaces.size() == 1)
      {
        add_power(0, new_surface_loads, share);
        if (n_surfaces == 1)
          add_power(0, old_surface_loads, 1. - share);
        return;
      }
    SurfaceMotion<dim> begin;
    begin.v           = surface_motion.v ? &velocity : nullptr;
    const auto before = loads.surfaces().loaded(state.surfaces, state.time);
    VectorField<dim> at_rest = displacement;
    for (VectorType &component : at_rest)
      component = 0.;
    for (unsigned int k = 0; k < surfaces.size(); ++k)
      {
        VectorField<dim> &load = new_surface_loads;
        system.surfaces().add(
          {surfaces[k]}, displacement, surface_motion, false, load);
        add_power(k, load, share);
        if (k >= n_surfaces)
          continue;
        system.surfaces().add({before[k]}, at_rest, begin, false, load);
        add_power(k, load, 1. - share);
      }
  }



  GREVILLE_INSTANTIATE_CLASS(ImplicitSteps);
} // namespace greville
