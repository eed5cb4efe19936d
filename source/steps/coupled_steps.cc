// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/linear_algebra/krylov.h>
#include <greville/steps/coupled_steps.h>
#include <greville/steps/trial_contacts.h>

#include <algorithm>
#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Multiples of the unit of round-off: its upper bound, and the largest
    // forces that count as vanished.
    constexpr double bound_of_round_off = 16., vanished_forces = 1.6e5;
  } // namespace



  template <int dim>
  CoupledSteps<dim>::CoupledSteps(const std::vector<Part> &parts,
                                  TrialContacts<dim>      *contacts,
                                  const double             dt)
    : parts(parts)
    , contacts(contacts)
    , dt(dt)
    , blocks(parts.size())
  {
    AssertThrow(contacts || parts.size() == 1, ExcInternalError());
    if (has_water())
      blocks.resize(2 * parts.size());
    if (has_rigid_block())
      blocks.emplace_back();
  }



  template <int dim>
  bool
  CoupledSteps<dim>::has_water() const
  {
    return std::any_of(parts.begin(), parts.end(), [](const Part &part) {
      return part.steps->water != nullptr;
    });
  }



  template <int dim>
  bool
  CoupledSteps<dim>::has_rigid_block() const
  {
    return contacts && contacts->n_rigid_unknowns() > 0;
  }



  template <int dim>
  void
  CoupledSteps<dim>::read(std::vector<VectorType> &of_parts,
                          const VectorType        &x) const
  {
    unsigned int first = 0;
    for (VectorType &block : of_parts)
      {
        const unsigned int n = block.locally_owned_size();
        std::copy_n(x.begin() + first, n, block.begin());
        first += n;
      }
  }



  template <int dim>
  void
  CoupledSteps<dim>::write(VectorType                    &x,
                           const std::vector<VectorType> &of_parts) const
  {
    unsigned int first = 0;
    for (const VectorType &block : of_parts)
      {
        const unsigned int n = block.locally_owned_size();
        std::copy_n(block.begin(), n, x.begin() + first);
        first += n;
      }
  }



  template <int dim>
  void
  CoupledSteps<dim>::try_step()
  {
    const std::string impossible =
      contacts ? contacts->check_rigid_bodies() : "";
    if (!impossible.empty())
      {
        for (const Part &part : parts)
          part.steps->rejection = impossible;
        throw StepRejected(impossible);
      }
    for (const Part &part : parts)
      part.steps->begin_trial(*part.state, dt);
    std::uint64_t n_local = 0;
    for (unsigned int k = 0; k < parts.size(); ++k)
      {
        parts[k].steps->system.initialize(blocks[k]);
        parts[k].steps->system.read(blocks[k], parts[k].steps->displacement);
        n_local += blocks[k].locally_owned_size();
      }
    for (unsigned int k = 0; k < parts.size(); ++k)
      if (parts[k].steps->water)
        {
          parts[k].steps->water->guess(pressure(blocks, k));
          n_local += pressure(blocks, k).locally_owned_size();
        }
    if (has_rigid_block())
      {
        contacts->initialize_rigid(blocks.back());
        n_local += blocks.back().locally_owned_size();
      }
    products = blocks;
    if (blocks.size() == 1)
      layout.reinit(blocks[0]);
    else
      {
        const MPI_Comm comm  = parts[0].steps->discretization.communicator();
        std::uint64_t  first = 0;
        const int      ierr =
          MPI_Exscan(&n_local, &first, 1, MPI_UINT64_T, MPI_SUM, comm);
        AssertThrowMPI(ierr);
        IndexSet owned(Utilities::MPI::sum(n_local, comm));
        owned.add_range(first, first + n_local);
        layout.reinit(owned, comm);
      }
    VectorType x;
    x.reinit(layout);
    write(x, blocks);

    ImplicitSteps<dim>     &first_steps  = *parts[0].steps;
    const NewtonParameters &newton       = first_steps.parameters.newton;
    NewtonResult            result       = solve_newton(x, *this, newton);
    const unsigned int      n_iterations = result.n_iterations();
    // Solve again after each update of the pressures of augmented contacts.
    while (result.converged && contacts && contacts->augment())
      {
        const NewtonResult next = solve_newton(x, *this, newton);
        result.converged        = next.converged;
        result.reason           = next.reason;
        result.iterations.insert(result.iterations.end(),
                                 next.iterations.begin(),
                                 next.iterations.end());
      }
    first_steps.log.newton.push_back(
      {parts[0].state->n_steps + 1, 1, parts[0].state->time, dt, result});
    if (!result.converged)
      reject(x, result.reason, contacts ? contacts->describe_changes() : "");
    const std::string problem = contacts ? contacts->check_motion() : "";
    if (!problem.empty())
      reject(x, problem);
    for (const Part &part : parts)
      {
        part.steps->n_newton            = n_iterations;
        part.steps->expected_iterations = std::max(1u, n_iterations);
      }
  }



  template <int dim>
  void
  CoupledSteps<dim>::reject(const VectorType  &x,
                            const std::string &reason,
                            const std::string &changing)
  {
    // Evaluate the reported iterate, which need not be the last trial.
    std::string rejection = reason + changing;
    for (const Part &part : parts)
      part.steps->forces_vanish = false;
    VectorType r;
    r.reinit(layout);
    if (evaluate(r, x, false).empty())
      {
        read(blocks, r);
        const Part *worst   = nullptr;
        double      largest = -1.;
        for (unsigned int k = 0; k < parts.size(); ++k)
          {
            ImplicitSteps<dim> &steps = *parts[k].steps;
            steps.last_residual       = blocks[k];
            const double size         = blocks[k].linfty_norm();
            steps.forces_vanish =
              changing.empty() && std::max(steps.force_scale, size) <=
                                    vanished_forces * steps.unit_of_round_off;
            if (size > largest)
              {
                worst   = &parts[k];
                largest = size;
              }
          }
        rejection += worst->steps->describe_residual();
        if (parts.size() > 1 && largest > 0.)
          rejection += worst->steps->log.of;
      }
    for (const Part &part : parts)
      part.steps->rejection = rejection;
    throw StepRejected(rejection);
  }



  template <int dim>
  std::string
  CoupledSteps<dim>::evaluate(VectorType       &r,
                              const VectorType &x,
                              const bool        with_stiffness)
  {
    read(blocks, x);
    if (has_rigid_block())
      contacts->set_rigid(blocks.back());
    for (unsigned int k = 0; k < parts.size(); ++k)
      {
        const std::string problem =
          parts[k].steps->evaluate(blocks[k], dt, with_stiffness);
        if (!problem.empty())
          return problem;
      }
    if (contacts)
      contacts->set_pore_pressures(blocks);
    for (unsigned int k = 0; k < parts.size(); ++k)
      if (ImplicitSteps<dim> &steps = *parts[k].steps; steps.water)
        {
          const PartTimer timer(steps.log, "water");
          steps.water->evaluate(steps.displacement,
                                pressure(blocks, k),
                                steps.water_force,
                                pressure(blocks, k));
          for (unsigned int d = 0; d < dim; ++d)
            steps.force[d] += steps.water_force[d];
        }
    if (contacts)
      {
        const PartTimer   timer(parts[0].steps->log, "contact");
        const std::string problem = contacts->evaluate(with_stiffness);
        if (!problem.empty())
          return problem;
      }
    for (unsigned int k = 0; k < parts.size(); ++k)
      parts[k].steps->find_residual(blocks[k],
                                    dt,
                                    contacts ? &contacts->force(k) : nullptr);
    if (has_rigid_block())
      contacts->find_rigid_residual(blocks.back());
    write(r, blocks);
    return "";
  }



  template <int dim>
  std::string
  CoupledSteps<dim>::residual(VectorType &r, const VectorType &x)
  {
    const bool with_stiffness =
      n_residuals++ < parts[0].steps->expected_iterations;
    if (with_stiffness)
      linearized = x;
    return evaluate(r, x, with_stiffness);
  }



  template <int dim>
  double
  CoupledSteps<dim>::scale_with(const bool upper_bound) const
  {
    double square = 0.;
    for (const Part &part : parts)
      {
        const ImplicitSteps<dim> &steps     = *part.steps;
        const double              tolerance = steps.parameters.newton.tolerance;
        const double              unit      = steps.unit_of_round_off;
        const double              round_off =
          upper_bound || steps.force_scale <= vanished_forces * unit
                         ? bound_of_round_off * unit
                         : unit;
        const double scale =
          tolerance > 0. ? std::max(steps.force_scale, round_off / tolerance)
                         : steps.force_scale;
        square += scale * scale;
        if (steps.water && tolerance > 0.)
          square += std::pow(steps.water->round_off() / tolerance, 2);
      }
    if (has_rigid_block())
      square += std::pow(contacts->rigid_scale(), 2);
    return std::sqrt(square);
  }



  template <int dim>
  std::string
  CoupledSteps<dim>::linearize(const VectorType &x)
  {
    const auto is_linearized = [&]() {
      VectorType difference = linearized;
      difference -= x;
      return difference.linfty_norm() == 0.;
    };
    if (!parts[0].steps->has_stiffness || !is_linearized())
      {
        VectorType r;
        r.reinit(layout);
        linearized              = x;
        const std::string wrong = evaluate(r, x, true);
        if (!wrong.empty())
          return wrong;
      }
    for (const Part &part : parts)
      {
        ImplicitSteps<dim>   &steps = *part.steps;
        const PartTimer       timer(steps.log, "set-up");
        const ImplicitScheme &scheme      = steps.scheme;
        const double          mass_factor = scheme.is_static
                                              ? 0.
                                              : (1. - scheme.alpha_m) * scheme.alpha_u /
                                         ((1. - scheme.alpha_f) * dt * dt);
        try
          {
            steps.system.set_coupled(contacts != nullptr);
            steps.system.set_operator(mass_factor,
                                      steps.is_symmetric &&
                                        steps.surfaces_are_symmetric);
            if (steps.water)
              steps.water->set_up(mass_factor,
                                  [&](const VectorField<dim> &b,
                                      VectorField<dim>       &u) {
                                    steps.solve_mass(u, b);
                                  });
          }
        catch (const ErrorOnAll &error)
          {
            return "the tangent has no preconditioner: " + message_of(error);
          }
      }
    return "";
  }



  template <int dim>
  SolveResult
  CoupledSteps<dim>::solve(VectorType       &dx,
                           const VectorType &r,
                           const double      tolerance)
  {
    ImplicitSteps<dim> &first_steps = *parts[0].steps;
    const PartTimer     timer(first_steps.log, "solve");
    VectorType          b = r;
    b *= -1.;
    SolveResult result;
    result.iterations = 0;
    result.reduction  = 1.;
    try
      {
        result = contacts || has_water()
                   ? solve_all(dx, b, tolerance)
                   : first_steps.system.solve(dx, b, tolerance);
      }
    catch (const ErrorOnAll &error)
      {
        result.reason = "fails: " + message_of(error);
      }
    first_steps.n_linear = std::max(first_steps.n_linear, *result.iterations);
    first_steps.n_all_linear += *result.iterations;
    return result;
  }



  template <int dim>
  SolveResult
  CoupledSteps<dim>::solve_all(VectorType       &x,
                               const VectorType &b,
                               const double      tolerance)
  {
    std::vector<TangentSystem<dim> *> systems;
    bool         with_cg   = !has_water() && contacts->is_symmetric();
    unsigned int n_vectors = contacts ? 100 : 50;
    for (const Part &part : parts)
      {
        systems.push_back(&part.steps->system);
        with_cg = with_cg && systems.back()->takes_cg();
        if (!has_water())
          n_vectors = std::max(n_vectors, systems.back()->n_basis_vectors());
      }
    const auto multiply = [&](VectorType &dst, const VectorType &src) {
      read(blocks, src);
      for (unsigned int k = 0; k < parts.size(); ++k)
        {
          systems[k]->multiply(products[k], blocks[k]);
          if (parts[k].steps->water)
            add_water(k);
        }
      if (contacts)
        contacts->add_product(products, blocks);
      write(dst, products);
    };
    const auto precondition = [&](VectorType &dst, const VectorType &src) {
      read(blocks, src);
      for (unsigned int k = 0; k < parts.size(); ++k)
        {
          if (parts[k].steps->water)
            precondition_water(k);
          if (!contacts)
            systems[k]->precondition(products[k], blocks[k]);
        }
      if (contacts)
        parts[0].steps->coupled_cycle.vmult(products, blocks);
      if (has_rigid_block())
        contacts->precondition_rigid(products.back(), blocks.back());
      write(dst, products);
    };
    return TangentSystem<dim>::solve_together(
      systems, tolerance, [&](const unsigned int n) {
        if (contacts)
          parts[0].steps->coupled_cycle.update(systems,
                                               contacts->sum_of_stiffness(),
                                               [&]() {
                                                 return contacts->coupling();
                                               });
        // Restarts of FGMRES would lose the coupling of the parts.
        return solve_krylov({tolerance, n},
                            multiply,
                            precondition,
                            x,
                            b,
                            with_cg ? 0 : n_vectors);
      });
  }



  template <int dim>
  void
  CoupledSteps<dim>::add_water(const unsigned int k)
  {
    ImplicitSteps<dim> &steps  = *parts[k].steps;
    TangentSystem<dim> &system = steps.system;
    // These fields are unused until the next evaluate().
    VectorField<dim> &direction = steps.work, &force = steps.water_force;
    for (VectorType &component : direction)
      component = 0.;
    system.extend(direction, blocks[k]);
    steps.water->multiply(direction,
                          pressure(blocks, k),
                          force,
                          pressure(products, k));
    VectorType of_water;
    of_water.reinit(blocks[k]);
    system.restrict(of_water, force, nullptr);
    products[k] += of_water;
  }



  template <int dim>
  void
  CoupledSteps<dim>::precondition_water(const unsigned int k)
  {
    ImplicitSteps<dim> &steps = *parts[k].steps;
    steps.water->precondition(pressure(products, k), pressure(blocks, k));
    steps.water->spread(pressure(products, k), steps.water_force);
    VectorType of_water;
    of_water.reinit(blocks[k]);
    steps.system.restrict(of_water, steps.water_force, nullptr);
    blocks[k] -= of_water;
  }



  GREVILLE_INSTANTIATE_CLASS(CoupledSteps);
} // namespace greville
