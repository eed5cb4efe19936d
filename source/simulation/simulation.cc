#include <greville/base/errors.h>
#include <greville/base/memory.h>
#include <greville/simulation/simulation.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Steps between two copies of the points, and between two sortings of their
    // groups.
    constexpr unsigned int remember_every   = 50;
    constexpr unsigned int defragment_every = 200;

    // Runs with more are an error in a parameter.
    constexpr double most_steps = 1e9;

    // Estimates of the critical step of which the smallest counts.
    constexpr unsigned int n_estimates = 3;

    // Steps between two looks at the balance of energy, and before the first:
    // a load that begins at once excites modes whose kinetic energy, half a
    // step behind the strain energy, is not yet that of a mean.
    constexpr unsigned int check_energy_every = 100;

    // Accelerations that change velocities by this fraction of the norm of all
    // velocities in a step are solved for to the tolerance times that change.
    constexpr double negligible_kick = 1e-6;

    // With consistent mass, cells that a point crosses in a step at most, times
    // the order: the filter of the velocity cannot keep up with longer steps.
    constexpr double most_crossings = 0.6;

    // Where an estimate is closer to the last one than this part, the time to
    // the next one is twice as long, up to a factor.
    constexpr double       small_change  = 0.02;
    constexpr unsigned int longest_delay = 8;

    // Growth of the largest wave speed that asks for an estimate at once.
    constexpr double wave_growth = 1.1;

    // Accelerations that change a speed by less than this part of c + |v| in a
    // step are noise.
    constexpr double noise_of_acceleration = 1e-8;



    std::string
    without_stop(std::string text)
    {
      while (!text.empty() && text.back() == '.')
        text.pop_back();
      return text;
    }



    std::string
    text_of(const double value)
    {
      std::ostringstream text;
      text << value;
      return text.str();
    }



    template <int dim>
    MultiIndex<dim>
    to_multi_index(const std::vector<unsigned int> &numbers)
    {
      MultiIndex<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = numbers[d];
      return result;
    }



    template <int dim>
    Point<dim>
    to_point(const std::vector<double> &numbers)
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = numbers[d];
      return result;
    }
  } // namespace



  /**
   * Adds the time of its life to a part.
   */
  template <int dim>
  class Simulation<dim>::PartTimer
  {
  public:
    PartTimer(Simulation &simulation, const std::string &part)
      : sum(simulation.seconds[part])
      , begin(std::chrono::steady_clock::now())
    {}

    ~PartTimer()
    {
      sum +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
          .count();
    }

  private:
    double                               &sum;
    std::chrono::steady_clock::time_point begin;
  };



  template <int dim>
  Simulation<dim>::Simulation(const SimulationParameters &parameters,
                              const SimulationCase       &run_case,
                              const MPI_Comm              comm)
    : parameters(parameters)
    , run_case(run_case)
    , comm(comm)
    , mesh(comm, Triangulation<dim>::none, mesh_settings<dim>)
    , walls(parameters.walls)
    , loads(parameters)
    , reconstruction(run_case.degree + 1,
                     run_case.quadrature == "taylor-least-squares",
                     parameters.scheme.full_cell)
  {
    AssertThrow(parameters.general.dimension == dim &&
                  run_case.cells.size() == dim,
                ExcMessage("The parameters are those of a simulation in " +
                           std::to_string(parameters.general.dimension) +
                           "D, not " + std::to_string(dim) + "D."));
    AssertThrow(!(parameters.scheme.transfer == "APIC" &&
                  run_case.quadrature != "points"),
                ExcMessage("'Scheme/Transfer' = APIC goes with "
                           "'Scheme/Quadrature' = points, not <" +
                           run_case.quadrature + ">."));
    AssertThrow(parameters.scheme.transfer != "APIC" ||
                  run_case.mass == "lumped",
                ExcMessage("'Scheme/Transfer' = APIC goes with 'Scheme/Mass' "
                           "= lumped, not <" +
                           run_case.mass +
                           ">: the momentum of APIC is the right-hand side of "
                           "a lumped solve. With the exact mass, PIC already "
                           "is a projection that keeps linear fields."));
    double n_cells = 1.;
    for (const unsigned int n : run_case.cells)
      n_cells *= n;
    check_memory_of_cells(n_cells,
                          dim,
                          run_case.cells == parameters.grid.cells
                            ? "The parameter 'Grid/Cells'"
                            : "The parameter 'Sweep/Cells'",
                          comm);
    create_box_mesh<dim>(mesh,
                         to_point<dim>(parameters.grid.lower),
                         to_point<dim>(parameters.grid.upper),
                         to_multi_index<dim>(run_case.cells));
    if (!parameters.time.step.empty())
      step_formula.emplace(parameters.time.step,
                           "Time/Step",
                           std::vector<std::string>{"h", "p"});
    balance_load();

    grid_mass = make_grid_mass<dim>(
      run_case.mass, run_case.degree, mesh, parameters, walls);
    consistent = dynamic_cast<ConsistentMass<dim> *>(grid_mass.get());
    walls.reinit(space());
    walls.check_paths(space(), parameters.time.end);
    if (consistent && walls.have_friction())
      contact = std::make_unique<FrictionContact<dim>>(walls, *consistent);
    if (consistent)
      filter.reinit(space());
    transfer.reinit(space());
    transport.reinit(mesh, space());
    space().initialize_vector(lumped_mass);
    for (auto *field : {&momentum,
                        &force,
                        &velocity,
                        &acceleration,
                        &new_velocity,
                        &mapped_velocity,
                        &held_residual,
                        &last_accelerations[0],
                        &last_accelerations[1]})
      for (VectorType &component : *field)
        space().initialize_vector(component);

    make_bodies();
    for (const Body<dim> &body : all_bodies)
      if (!body.imposed_velocity.empty() && !obstacles)
        {
          obstacles = std::make_unique<Obstacles<dim>>();
          obstacles->reinit(space());
        }
    AssertThrow(n_free_points > 0,
                ExcMessage("All bodies have an 'Imposed velocity': there is "
                           "none that feels forces."));
    loads.find_surfaces(all_bodies, comm);
    start_energy();
    remember_state();
  }



  template <int dim>
  Body<dim>
  Simulation<dim>::make_body(const std::string &name) const
  {
    Body<dim> body;
    body.name       = name;
    body.parameters = parameters.bodies.at(name).get();
    body.material   = parameters.materials.at(body.parameters->material).get();
    return body;
  }



  template <int dim>
  void
  Simulation<dim>::balance_load()
  {
    if (Utilities::MPI::n_mpi_processes(comm) == 1)
      return;
    // The work of a point is about four times that of an empty cell.
    const SplineSpace<dim>    cells(mesh, 1);
    std::vector<unsigned int> weights(cells.owned_cells().size(), 1);
    for (const std::string &name : parameters.general.bodies)
      {
        Body<dim> body = make_body(name);
        make_points(body, cells, loads.gravity(0.), false, false);
        for (const unsigned int cell : body.points.cells())
          weights[cell] += 4 * body.points.n_points(cell);
      }
    const auto connection =
      mesh.signals.weight.connect([&](const auto &cell, const auto) {
        return weights[cells.cell_number(cell)];
      });
    mesh.repartition();
    connection.disconnect();
  }



  template <int dim>
  void
  Simulation<dim>::make_bodies()
  {
    for (const std::string &name : parameters.general.bodies)
      {
        Body<dim>  body  = make_body(name);
        const auto left  = make_points(body,
                                      space(),
                                      loads.gravity(0.),
                                      parameters.scheme.transfer == "APIC",
                                      loads.act_on_points());
        const auto moved = transport.move(body.points, left);
        AssertThrow(Utilities::MPI::sum(moved.n_removed, comm) == 0,
                    ExcMessage("The parameter 'Body " + name +
                               "/Displacement' moves points out of the grid."));
        n_all_points += body.n_points;
        if (body.imposed_velocity.empty())
          n_free_points += body.n_points;

        const Moduli moduli = body.material->moduli();
        const double c      = std::sqrt((moduli.bulk + 4. / 3. * moduli.shear) /
                                   body.material->density);
        body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
          double v2 = 0., rate = 0.;
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double v = p.velocity(d);
              v2 += v * v;
              rate += std::abs(v) / space().lattice().cell_size(d);
            }
          fastest_signal = std::max(fastest_signal, c + std::sqrt(v2));
          crossing_rate  = std::max(crossing_rate, rate);
        });
        fastest_wave = std::max(fastest_wave, c);
        all_bodies.push_back(std::move(body));
      }
    fastest_signal = Utilities::MPI::max(fastest_signal, comm);
    crossing_rate  = Utilities::MPI::max(crossing_rate, comm);
    fastest_wave   = Utilities::MPI::max(fastest_wave, comm);
    check_overlap();
    left_cells.resize(all_bodies.size());
    reconstructed.resize(all_bodies.size());
  }



  template <int dim>
  void
  Simulation<dim>::check_overlap() const
  {
    double cell_volume = 1.;
    for (unsigned int d = 0; d < dim; ++d)
      cell_volume *= space().lattice().cell_size(d);

    // Fractions of cells: where the bodies before fill more than what this one
    // leaves, two of them are in the same place.
    const unsigned int  n_cells = space().owned_cells().size();
    std::vector<double> before(n_cells, 0.), own(n_cells);
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      {
        const auto &points = all_bodies[b].points;
        std::fill(own.begin(), own.end(), 0.);
        points.for_each([&](const unsigned int cell, ConstPointRef<dim> p) {
          own[cell] += p.volume() / cell_volume;
        });
        std::ostringstream message;
        for (unsigned int cell = 0; cell < n_cells; ++cell)
          {
            own[cell] = std::min(own[cell], 1.);
            if (own[cell] + before[cell] > 1.5 && message.str().empty())
              {
                const auto index =
                  multi_index<dim>(space().owned_cells()[cell],
                                   space().lattice().n_cells());
                Point<dim> middle = space().lattice().cell_corner(index);
                for (unsigned int d = 0; d < dim; ++d)
                  middle[d] += 0.5 * space().lattice().cell_size(d);
                message << "'Body " << all_bodies[b].name
                        << "' is in the same place as 'Body "
                        << all_bodies[body_at(cell, b)].name
                        << "', for instance at (" << middle
                        << ") m: the mass would be counted twice. In shapes, "
                           "difference(a, b) cuts one body out of another.";
              }
            before[cell] = std::min(own[cell] + before[cell], 1.);
          }
        throw_on_all(message.str(), comm);
      }
  }



  template <int dim>
  unsigned int
  Simulation<dim>::body_at(const unsigned int cell,
                           const unsigned int n_bodies) const
  {
    for (unsigned int b = 0; b < n_bodies; ++b)
      if (all_bodies[b].points.n_points(cell) > 0)
        return b;
    return 0;
  }



  template <int dim>
  bool
  Simulation<dim>::is_finished() const
  {
    const double end = parameters.time.end;
    return t >= end * (1. - 1e-12) || n_free_points == 0 ||
           (parameters.time.max_steps > 0 &&
            steps >= parameters.time.max_steps);
  }



  template <int dim>
  void
  Simulation<dim>::estimate_critical_step()
  {
    const PartTimer                timer(*this, "critical step");
    std::vector<const Body<dim> *> bodies;
    for (const Body<dim> &body : all_bodies)
      bodies.push_back(&body);
    sum_mass();
    // Obstacles may let go before the next estimate.
    if (obstacles)
      grid_mass->hold(
        std::vector<unsigned char>(lumped_mass.locally_owned_size(), 0));
    StepScheme scheme;
    scheme.stress_update = parameters.scheme.stress_update;
    scheme.apic          = parameters.scheme.transfer == "APIC";
    // Smaller shares have the shorter step, and dt is not known yet.
    scheme.flip           = parameters.scheme.transfer == "PIC"
                              ? 0.
                              : std::min(parameters.scheme.flip, flip_share());
    scheme.damping        = damping();
    const double estimate = critical_step.estimate(
      *grid_mass, transfer, bodies, summed_points, walls, scheme);

    // With the exact mass the highest frequency depends on how the surface cuts
    // the cells, and a moving body meets the same cuts again and again.
    estimates.push_back(estimate);
    if (!consistent || estimates.size() > n_estimates)
      estimates.erase(estimates.begin(),
                      estimates.end() - (consistent ? n_estimates : 1));
    critical_dt = *std::min_element(estimates.begin(), estimates.end());

    const unsigned int every = parameters.time.estimate_every;
    if (std::abs(estimate - last_estimate) <= small_change * estimate)
      n_between =
        std::min(std::max(2 * n_between, every), longest_delay * every);
    else
      n_between = every;
    next_estimate  = steps + n_between;
    last_estimate  = estimate;
    estimated_wave = fastest_wave;
  }



  template <int dim>
  bool
  Simulation<dim>::is_estimate_due() const
  {
    return steps == 0 ||
           (parameters.time.estimate_every > 0 && steps >= next_estimate) ||
           fastest_wave > wave_growth * estimated_wave;
  }



  template <int dim>
  void
  Simulation<dim>::sum_mass()
  {
    if (sums_are_current)
      return;
    transfer.points_to_grid(quadrature_points(),
                            &lumped_mass,
                            &momentum,
                            nullptr);
    grid_mass->update(lumped_mass, summed_points, transfer);
    sums_are_current = true;
  }



  template <int dim>
  double
  Simulation<dim>::smallest_edge() const
  {
    double h = std::numeric_limits<double>::max();
    for (unsigned int d = 0; d < dim; ++d)
      h = std::min(h, space().lattice().cell_size(d));
    return h;
  }



  template <int dim>
  std::string
  Simulation<dim>::what_sets_the_step(const bool is_chosen) const
  {
    const TimeParameters &time = parameters.time;
    std::ostringstream    text;
    if (is_chosen && time.step.empty())
      text << "The step is the smaller of 'Time/CFL number' (" << time.cfl
           << ") times h / (c + |v|), with the largest c + |v| = "
           << fastest_signal << " m / s, and 'Time/Safety' (" << time.safety
           << ") times the critical step of " << critical_dt
           << " s; with consistent mass points cross at most " << most_crossings
           << " / p cells. ";
    text << "Critical steps come from the materials:";
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      {
        const Body<dim> &body   = all_bodies[b];
        const Moduli     moduli = body.material->moduli();
        text << (b > 0 ? "," : "") << " 'Material " << body.parameters->material
             << "' in 'Body " << body.name << "' has the density "
             << body.material->density << " kg / m^3, K = " << moduli.bulk
             << " Pa, G = " << moduli.shear << " Pa, and the viscosity "
             << moduli.viscosity << " Pa s";
      }
    return text.str() + ".";
  }



  template <int dim>
  void
  Simulation<dim>::choose_step(const bool estimate)
  {
    const TimeParameters &time = parameters.time;
    const double          h    = smallest_edge();

    // A given step is estimated only to warn.
    const bool is_given = step_formula.has_value();
    const bool has_estimate =
      estimate && (!is_given || time.too_large_step != "ignore");
    if (has_estimate)
      estimate_critical_step();

    double next;
    if (is_given)
      {
        const double arguments[2] = {h, double(run_case.degree)};
        next = (*step_formula)(ArrayView<const double>(arguments, 2));
        AssertThrow(next > 0. && std::isfinite(next),
                    ExcMessage("The parameter 'Time/Step' is <" + time.step +
                               ">, which gives " + text_of(next) +
                               " s: it has to be positive."));
        if (has_estimate && next > critical_dt)
          {
            std::ostringstream message;
            message << "The parameter 'Time/Step' is <" << time.step
                    << ">: the step of " << next
                    << " s is above the critical step of " << critical_dt
                    << " s at t = " << t << " s";
            AssertThrow(time.too_large_step != "refuse",
                        ExcMessage(message.str() +
                                   " ('Time/Too large step' = warn goes on). " +
                                   what_sets_the_step(true)));
            warnings.push_back(message.str() + ".");
          }
      }
    else
      {
        next =
          std::min(time.cfl * h / fastest_signal, time.safety * critical_dt);
        if (consistent && crossing_rate > 0.)
          next =
            std::min(next, most_crossings / (run_case.degree * crossing_rate));
      }
    if (!is_given)
      AssertThrow(std::isfinite(next) && next > 0.,
                  ExcMessage("The automatic time step is " + text_of(next) +
                             " s. " + what_sets_the_step(true)));
    const auto reason = [&]() {
      return is_given ? "'Time/Step' is <" + time.step + ">."
                      : what_sets_the_step(true);
    };
    const double n_left = (time.end - t) / next;
    AssertThrow(n_left <= most_steps || time.max_steps > 0,
                ExcMessage("To 'Time/End' it would take " + text_of(n_left) +
                           " steps of " + text_of(next) + " s; at most " +
                           text_of(most_steps) +
                           " are allowed without 'Time/Maximum steps'. " +
                           reason()));
    const double shortest = std::numeric_limits<double>::epsilon() * time.end;
    AssertThrow(next > shortest,
                ExcMessage("A step of " + text_of(next) +
                           " s is lost to rounding in times near 'Time/End', " +
                           text_of(time.end) +
                           " s: steps have to be longer than " +
                           text_of(shortest) + " s. " + reason()));

    // Equal steps to the end where a step is given; a last one that is not tiny
    // otherwise.
    const double left = time.end - t;
    if (is_given)
      next = left / std::max(1., std::ceil(left / next - 1e-9));
    else if (next >= left)
      next = left;
    else if (next > 0.5 * left)
      next = 0.5 * left;
    velocity_dt = time.velocities == "half steps" ? 0.5 * (dt + next) : next;
    dt          = next;
  }



  template <int dim>
  bool
  Simulation<dim>::shows_faster_mode(const double signal) const
  {
    // Before forces, USF has updated the points: such a step stands.
    if (!consistent || step_formula ||
        parameters.scheme.stress_update == "USF" || n_last_accelerations < 2)
      return false;
    double sums[4] = {0., 0., 0., 0.};
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
        {
          const double m  = lumped_mass.local_element(i);
          const double a2 = acceleration[d].local_element(i);
          const double a1 = last_accelerations[0][d].local_element(i);
          const double a0 = last_accelerations[1][d].local_element(i);
          const double change =
            2. * ((a2 - a1) / last_steps[0] - (a1 - a0) / last_steps[1]) /
            (last_steps[0] + last_steps[1]);
          sums[0] += m * change * change;
          sums[1] += m * a1 * a1;
          sums[2] += m * a2 * a2;
          sums[3] += m / dim;
        }
    Utilities::MPI::sum(ArrayView<const double>(sums, 4),
                        comm,
                        ArrayView<double>(sums, 4));
    const double noise = noise_of_acceleration * signal / dt;
    if (!(sums[2] > noise * noise * sums[3]))
      return false;
    const double omega =
      sums[1] > 0. ? std::sqrt(std::sqrt(sums[0] / sums[1])) : 0.;
    return dt * omega > 2. * parameters.time.safety;
  }



  template <int dim>
  void
  Simulation<dim>::remember_acceleration()
  {
    if (!consistent)
      return;
    std::swap(last_accelerations[0], last_accelerations[1]);
    for (unsigned int d = 0; d < dim; ++d)
      last_accelerations[0][d] = acceleration[d];
    last_steps[1] = last_steps[0];
    last_steps[0] = dt;
    ++n_last_accelerations;
  }



  template <int dim>
  const std::vector<const MaterialPoints<dim> *> &
  Simulation<dim>::quadrature_points()
  {
    summed_points.clear();
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      if (!all_bodies[b].imposed_velocity.empty())
        continue;
      else if (run_case.quadrature == "points")
        summed_points.push_back(&all_bodies[b].points);
      else
        {
          reconstruction.reconstruct(all_bodies[b].points, reconstructed[b]);
          summed_points.push_back(&reconstructed[b]);
        }
    return summed_points;
  }



  template <int dim>
  double
  Simulation<dim>::damping() const
  {
    const LoadParameters &given = parameters.loads;
    return given.damping_end < 0. || t < given.damping_end ? given.cundall : 0.;
  }



  template <int dim>
  void
  Simulation<dim>::add_grid_forces()
  {
    const Tensor<1, dim> g = loads.gravity(t);
    for (unsigned int d = 0; d < dim; ++d)
      if (g[d] != 0.)
        for (unsigned int i = 0; i < force[d].locally_owned_size(); ++i)
          force[d].local_element(i) += g[d] * lumped_mass.local_element(i);
  }



  template <int dim>
  double
  Simulation<dim>::taken_by_damping(const unsigned int i,
                                    const unsigned int d) const
  {
    const double m = lumped_mass.local_element(i);
    const double P = momentum[d].local_element(i);
    if (!(m > 0.) || P == 0. || (grid_mass->held_components(i) & (1 << d)))
      return 0.;
    return damping() *
           std::copysign(std::abs(force[d].local_element(i)) / m, P);
  }



  template <int dim>
  void
  Simulation<dim>::damp_acceleration()
  {
    if (damping() == 0.)
      return;
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        acceleration[d].local_element(i) -= taken_by_damping(i, d);
  }



  template <int dim>
  void
  Simulation<dim>::solve(const std::vector<VectorField<dim> *>       &fields,
                         const std::vector<const VectorField<dim> *> &sums,
                         const std::vector<double>                   &shares)
  {
    const PartTimer timer(*this, "solve");
    try
      {
        grid_mass->solve(fields, sums, shares);
      }
    catch (const std::exception &exception)
      {
        // All processes know it.
        check(message_of(exception));
      }
    iterations = std::max(iterations, grid_mass->n_iterations());
    all_iterations += grid_mass->n_iterations();
  }



  template <int dim>
  void
  Simulation<dim>::fill_grid()
  {
    transfer.points_to_grid(quadrature_points(),
                            &lumped_mass,
                            &momentum,
                            nullptr);
    grid_mass->update(lumped_mass, summed_points, transfer);
    walls.hold_velocity(new_velocity, velocity_time);
    solve({&new_velocity}, {&momentum});
  }



  template <int dim>
  void
  Simulation<dim>::touch_obstacles(const bool with_force)
  {
    if (!obstacles)
      return;
    obstacles->touch(*grid_mass,
                     lumped_mass,
                     momentum,
                     with_force ? &force : nullptr,
                     loads.gravity(t));
    if (!with_force || parameters.scheme.stress_update != "USF")
      obstacles->set_velocity(velocity, false);
    obstacles->set_acceleration(acceleration, velocity);
  }



  template <int dim>
  void
  Simulation<dim>::take_held_residual()
  {
    if (parameters.scheme.transfer != "FLIP" || !(velocity_dt > 0.))
      return;
    grid_mass->held_residual(held_residual, momentum, velocity);
    for (unsigned int d = 0; d < dim; ++d)
      acceleration[d].add(-1. / velocity_dt, held_residual[d]);
  }



  template <int dim>
  void
  Simulation<dim>::add_contact()
  {
    if (!contact)
      {
        walls.add_contact(new_velocity, acceleration, velocity_dt);
        // Obstacles go first.
        if (obstacles)
          {
            obstacles->set_velocity(new_velocity, true);
            obstacles->set_acceleration(acceleration, velocity);
          }
        return;
      }
    const PartTimer timer(*this, "contact");
    try
      {
        contact->add(new_velocity, acceleration, velocity_dt);
      }
    catch (const std::exception &exception)
      {
        check(message_of(exception));
      }
    iterations = std::max(iterations, contact->most_iterations());
    all_iterations += contact->n_iterations();
  }



  template <int dim>
  double
  Simulation<dim>::flip_share() const
  {
    const SchemeParameters &scheme = parameters.scheme;
    if (scheme.transfer == "PIC" || scheme.flip == 0.)
      return 0.;
    if (scheme.flip == 1.)
      return 1.;
    const double time =
      scheme.flip_time > 0. ? scheme.flip_time : smallest_edge() / first_signal;
    return std::pow(scheme.flip, velocity_dt / time);
  }



  template <int dim>
  void
  Simulation<dim>::start_energy()
  {
    first_signal = fastest_signal;
    double mass  = 0.;
    for (const Body<dim> &body : all_bodies)
      {
        body.points.for_each(
          [&](const unsigned int, ConstPointRef<dim> p) { mass += p.mass(); });
      }
    // Speeds of 1e-8 times that of waves are round-off.
    energy.reinit(free_energy<dim>(all_bodies, transfer, comm),
                  1e-16 * Utilities::MPI::sum(mass, comm) * first_signal *
                    first_signal);
  }



  template <int dim>
  void
  Simulation<dim>::add_work()
  {
    const Tensor<1, dim> g    = loads.gravity(t);
    double               work = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      if (g[d] != 0.)
        for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
          work += g[d] * lumped_mass.local_element(i) *
                  new_velocity[d].local_element(i);
    if (loads.act_on_points())
      for (const Body<dim> &body : all_bodies)
        if (body.imposed_velocity.empty())
          {
            const unsigned int load = body.points.layout().load;
            body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
              for (unsigned int d = 0; d < dim; ++d)
                work += p.mass() * p[load + d] * p.velocity(d);
            });
          }
    // Walls and obstacles give what a = (v' - v) / dt' needs beyond the force.
    if ((walls.move() || obstacles) && velocity_dt > 0.)
      {
        grid_mass->held_residual(held_residual, force, acceleration);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
            work -= lumped_mass.local_element(i) *
                    held_residual[d].local_element(i) *
                    new_velocity[d].local_element(i);
      }
    energy.add_work(dt * work);
  }



  template <int dim>
  void
  Simulation<dim>::add_work_of_damping()
  {
    if (damping() == 0.)
      return;
    const PartTimer timer(*this, "energy");

    // P + P' of the points. That of APIC is of the grid.
    const bool        apic = parameters.scheme.transfer == "APIC";
    const double      flip = apic ? 0. : flip_share();
    VectorField<dim> &sum = held_residual, &product = mapped_velocity;
    for (unsigned int d = 0; d < dim; ++d)
      {
        sum[d].equ(1. - flip, new_velocity[d]);
        sum[d].add(flip * velocity_dt, acceleration[d]);
        if (apic)
          {
            product[d] = sum[d];
            product[d].scale(lumped_mass);
          }
      }
    if (!apic)
      transfer.multiply_mass(summed_points, sum, product);

    double power = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      {
        product[d].add(1. + flip, momentum[d]);
        for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
          power -= 0.5 * taken_by_damping(i, d) * product[d].local_element(i);
      }
    energy.add_damping(velocity_dt * power);
  }



  template <int dim>
  void
  Simulation<dim>::check_energy()
  {
    const SchemeParameters &scheme = parameters.scheme;
    if (scheme.energy_gain == "ignore" || steps < check_energy_every ||
        (steps % check_energy_every != 0 && !is_finished()))
      return;
    const PartTimer timer(*this, "energy");
    const double    gain =
      energy.gain(free_energy<dim>(all_bodies, transfer, comm), comm);
    if (!(gain > std::max(scheme.energy_tolerance, 2. * warned_gain)))
      return;
    warned_gain = gain;
    std::ostringstream message;
    message << "energy has come from nothing: " << 100. * gain
            << " % of the largest energy so far, with the work of loads, walls "
               "and damping counted. The steps are unstable with mass <"
            << run_case.mass
            << ">: take 'Scheme/Mass' = lumped or fmpm-2, a larger "
               "'Scheme/Filter' or a smaller 'Time/Safety'";
    if (scheme.energy_gain == "stop")
      check(message.str() + " ('Scheme/Energy gain' = warn goes on)");
    warnings.push_back("Step " + std::to_string(steps) + ": " + message.str() +
                       ".");
  }



  template <int dim>
  void
  Simulation<dim>::check_fragments()
  {
    constexpr double most_fragments = 0.05;
    if (!consistent)
      return;
    const double fraction = consistent->fragment_fraction();
    if (fraction <= most_fragments)
      return;
    std::ostringstream message;
    message << 100. * fraction
            << " % of the cells with points have lumped mass: the bodies are "
               "too thin there for the exact mass. Take more cells.";
    warnings.push_back(message.str());
  }



  template <int dim>
  void
  Simulation<dim>::find_crossing_rate()
  {
    double rates[3] = {fastest_signal, 0., fastest_wave};
    for (unsigned int i = 0; i < lumped_mass.locally_owned_size(); ++i)
      if (!consistent || consistent->extension()[i] == Extension<dim>::stable)
        {
          double rate = 0.;
          for (unsigned int d = 0; d < dim; ++d)
            rate += std::abs(new_velocity[d].local_element(i)) /
                    space().lattice().cell_size(d);
          rates[1] = std::max(rates[1], rate);
        }
    Utilities::MPI::max(ArrayView<const double>(rates, 3),
                        comm,
                        ArrayView<double>(rates, 3));
    fastest_signal = rates[0];
    crossing_rate  = rates[1];
    fastest_wave   = rates[2];
  }



  template <int dim>
  void
  Simulation<dim>::filter_velocity()
  {
    if (!consistent || parameters.scheme.filter == 0.)
      return;
    const PartTimer timer(*this, "filter");
    filter.set_mass(lumped_mass);
    VectorField<dim> &correction = mapped_velocity;
    filter.apply(correction, new_velocity, parameters.scheme.filter, dt);
    consistent->extend(correction);
    for (unsigned int d = 0; d < dim; ++d)
      {
        VectorType &z = correction[d];
        for (unsigned int i = 0; i < z.locally_owned_size(); ++i)
          if ((grid_mass->held_components(i) >> d) & 1)
            z.local_element(i) = 0.;
        new_velocity[d] += z;
        acceleration[d].add(1. / velocity_dt, z);
      }
  }



  template <int dim>
  void
  Simulation<dim>::update_points(const VectorField<dim> *acceleration,
                                 const VectorField<dim> *velocity,
                                 const VectorField<dim> *deformation,
                                 const bool              move)
  {
    const PartTimer  timer(*this, "grid to points");
    PointUpdate<dim> update;
    update.acceleration  = acceleration;
    update.velocity      = velocity;
    update.deformation   = deformation;
    update.move          = move;
    update.velocity_step = velocity_dt;
    update.step          = move ? dt : deformation_dt;
    update.flip          = flip_share();
    update.apic          = parameters.scheme.transfer == "APIC";
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      {
        Body<dim> &body = all_bodies[b];
        if (!body.imposed_velocity.empty())
          {
            if (!move)
              continue;
            double speed = 0.;
            body.points.for_each([&](const unsigned int cell, PointRef<dim> p) {
              double square = 0.;
              for (unsigned int d = 0; d < dim; ++d)
                {
                  const double v = p.velocity(d);
                  p.position(d) += dt * v;
                  square += v * v;
                }
              speed = std::max(speed, std::sqrt(square));
              if (!body.points.is_inside(cell, p) &&
                  (left_cells[b].empty() || left_cells[b].back() != cell))
                left_cells[b].push_back(cell);
            });
            fastest_signal = std::max(fastest_signal, speed);
            continue;
          }
        update.material          = body.material;
        const PointReport report = transfer.grid_to_points(body.points, update);
        fastest_signal = std::max(fastest_signal, report.fastest_signal);
        fastest_wave   = std::max(fastest_wave, report.fastest_wave);
        if (move)
          left_cells[b] = report.left_cells;
        if (report.bad_point >= 0 && problem.empty())
          problem = "point " + std::to_string(report.bad_point) +
                    " of the body '" + body.name + "': " + report.bad_reason;
      }
  }



  template <int dim>
  void
  Simulation<dim>::transport_points()
  {
    const PartTimer timer(*this, "transport");
    std::uint64_t   counts[3] = {0, 0, 0};
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      {
        const auto result = transport.move(all_bodies[b].points, left_cells[b]);
        left_cells[b].clear();
        n_own_sent += result.n_sent;
        counts[0] += all_bodies[b].points.n_points();
        if (all_bodies[b].imposed_velocity.empty())
          counts[2] += all_bodies[b].points.n_points();
        counts[1] += result.n_removed;
        if (result.n_removed > 0 && problem.empty() &&
            (parameters.scheme.outside == "error" ||
             !std::isfinite(result.outside_position.norm())))
          {
            std::ostringstream message;
            message << "point " << result.outside << " of the body '"
                    << all_bodies[b].name << "' has left the grid: it is at ("
                    << result.outside_position << ") m";
            problem = message.str();
          }
        if (steps % defragment_every == defragment_every - 1)
          all_bodies[b].points.defragment();
      }
    Utilities::MPI::sum(ArrayView<const std::uint64_t>(counts, 3),
                        comm,
                        ArrayView<std::uint64_t>(counts, 3));
    n_free_points = counts[2];
    n_all_removed += counts[1];
    AssertThrow(counts[0] + n_all_removed == n_all_points,
                ExcMessage(
                  "Points got lost: there are " + std::to_string(counts[0]) +
                  " and " + std::to_string(n_all_removed) +
                  " were removed, of " + std::to_string(n_all_points) + "."));
  }



  template <int dim>
  void
  Simulation<dim>::share_volume()
  {
    // Slowly, against waves that cross a cell in h / c.
    constexpr unsigned int every = 10;
    constexpr double       rate  = 0.025;
    time_to_share += dt;
    if (steps % every != every - 1)
      return;
    const PartTimer timer(*this, "volume of fluids");
    const double    h = smallest_edge();
    for (Body<dim> &body : all_bodies)
      if (body.material->shares_volume() && body.imposed_velocity.empty())
        {
          const double c =
            std::sqrt(body.material->moduli().bulk / body.material->density);
          transfer.share_volume(body.points,
                                -std::expm1(-rate * c * time_to_share / h));
        }
    time_to_share = 0.;
  }



  template <int dim>
  void
  Simulation<dim>::damp_kinetically()
  {
    const LoadParameters &given = parameters.loads;
    if (!given.kinetic || (given.damping_end >= 0. && t >= given.damping_end))
      return;
    const double kinetic = kinetic_energy<dim>(all_bodies, transfer, comm);
    if (kinetic < last_kinetic)
      {
        for (Body<dim> &body : all_bodies)
          {
            if (!body.imposed_velocity.empty())
              continue;
            const auto &layout = body.points.layout();
            body.points.for_each([&](const unsigned int, PointRef<dim> p) {
              for (unsigned int d = 0; d < dim; ++d)
                p.velocity(d) = 0.;
              if (layout.has_affine)
                for (unsigned int k = 0; k < dim * dim; ++k)
                  p[layout.affine + k] = 0.;
            });
          }
        // The energy is that of all processes.
        if (Utilities::MPI::this_mpi_process(comm) == 0)
          energy.add_damping(-kinetic);
        last_kinetic = 0.;
      }
    else
      last_kinetic = kinetic;
  }



  template <int dim>
  void
  Simulation<dim>::remember_state()
  {
    remembered.t              = t;
    remembered.velocity_time  = velocity_time;
    remembered.n_removed      = n_all_removed;
    remembered.n_free         = n_free_points;
    remembered.last_kinetic   = last_kinetic;
    remembered.energy         = energy;
    remembered.dt             = dt;
    remembered.steps          = steps;
    remembered.velocity_dt    = velocity_dt;
    remembered.critical_dt    = critical_dt;
    remembered.fastest_signal = fastest_signal;
    remembered.crossing_rate  = crossing_rate;
    remembered.fastest_wave   = fastest_wave;
    remembered.estimated_wave = estimated_wave;
    remembered.next_estimate  = next_estimate;
    remembered.n_between      = n_between;
    remembered.last_estimate  = last_estimate;
    remembered.estimates      = estimates;
    if (contact)
      contact->remember();
    remembered.points.resize(all_bodies.size());
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      remembered.points[b].copy(all_bodies[b].points);
  }



  template <int dim>
  void
  Simulation<dim>::check(const std::string message, const bool with_materials)
  {
    if (Utilities::MPI::max<unsigned int>(!message.empty(), comm) == 0)
      return;
    std::ostringstream where;
    where << "Step " << steps + 1 << " at t = " << t << " s, dt = " << dt
          << " s: " << without_stop(message) << ". ";
    if (with_materials)
      where << what_sets_the_step(false) << " "
            << loads.what_is_large(t, dt, smallest_edge(), comm);
    t                    = remembered.t;
    velocity_time        = remembered.velocity_time;
    n_all_removed        = remembered.n_removed;
    n_free_points        = remembered.n_free;
    last_kinetic         = remembered.last_kinetic;
    energy               = remembered.energy;
    dt                   = remembered.dt;
    steps                = remembered.steps;
    velocity_dt          = remembered.velocity_dt;
    critical_dt          = remembered.critical_dt;
    fastest_signal       = remembered.fastest_signal;
    crossing_rate        = remembered.crossing_rate;
    estimates            = remembered.estimates;
    n_last_accelerations = 0;
    fastest_wave         = remembered.fastest_wave;
    estimated_wave       = remembered.estimated_wave;
    next_estimate        = remembered.next_estimate;
    n_between            = remembered.n_between;
    last_estimate        = remembered.last_estimate;
    for (auto &cells : left_cells)
      cells.clear();
    if (contact)
      contact->go_back();
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      remembered.points[b].restore(all_bodies[b].points);
    where << "The state of step " << steps << ", t = " << t
          << " s, is the last good one that was kept.";
    problem.clear();
    throw_on_all(message.empty() ? "" : where.str(), comm);
  }



  template <int dim>
  void
  Simulation<dim>::find_acceleration()
  {
    // Imposed velocities are those of the middle of the step.
    const double middle = t + 0.5 * dt;
    for (Body<dim> &body : all_bodies)
      if (!body.imposed_velocity.empty())
        {
          Tensor<1, dim> v;
          for (unsigned int d = 0; d < dim; ++d)
            v[d] =
              body.imposed_velocity[d](ArrayView<const double>(&middle, 1));
          body.points.for_each([&](const unsigned int, PointRef<dim> p) {
            for (unsigned int d = 0; d < dim; ++d)
              p.velocity(d) = v[d];
          });
          sums_are_current = false;
        }

    if (obstacles)
      obstacles->update(all_bodies,
                        transfer,
                        velocity_time,
                        velocity_time + velocity_dt);

    const std::string &order = parameters.scheme.stress_update;
    {
      const PartTimer timer(*this, "loads");
      std::string     message;
      try
        {
          loads.set(all_bodies, t);
        }
      catch (const std::exception &exception)
        {
          message = message_of(exception);
        }
      if (loads.act_on_points())
        check(message, false);
    }
    const bool has_mass = sums_are_current;
    if (!has_mass || order != "USF")
      {
        const PartTimer timer(*this, "points to grid");
        // Reconstructions hold loads as well, which are those of now.
        transfer.points_to_grid(quadrature_points(),
                                has_mass ? nullptr : &lumped_mass,
                                has_mass ? nullptr : &momentum,
                                order == "USF" ? nullptr : &force);
      }
    if (!has_mass)
      {
        const PartTimer timer(*this, "mass");
        grid_mass->update(lumped_mass, summed_points, transfer);
        sums_are_current = true;
      }

    // Velocity and acceleration come from one solve, unless the stress depends
    // on the velocity. Their guesses are the fields of the step before.
    for (unsigned int d = 0; d < dim; ++d)
      velocity[d] = new_velocity[d];
    walls.hold_velocity(velocity, velocity_time);
    walls.hold_acceleration(acceleration, velocity_time, velocity_dt);
    touch_obstacles(order != "USF");
    if (order == "USF")
      {
        solve({&velocity}, {&momentum});
        walls.stop(velocity);
        update_points(nullptr, nullptr, &velocity, false);
        {
          const PartTimer timer(*this, "points to grid");
          transfer.points_to_grid(quadrature_points(),
                                  nullptr,
                                  nullptr,
                                  &force);
        }
        touch_obstacles(true);
        add_grid_forces();
        solve({&acceleration}, {&force});
      }
    else
      {
        add_grid_forces();
        // Forces of round-off need no solve.
        solve({&velocity, &acceleration},
              {&momentum, &force},
              {1., velocity_dt > 0. ? negligible_kick / velocity_dt : 0.});
      }
    damp_acceleration();
  }



  template <int dim>
  void
  Simulation<dim>::step()
  {
    if (steps > 0 && steps % remember_every == 0)
      remember_state();
    iterations           = 0;
    sums_are_current     = false; // Programs may have changed points.
    const double last_dt = dt, last_signal = fastest_signal,
                 last_wave = fastest_wave;
    choose_step(is_estimate_due());
    // USF deforms by v, which belongs to the middle of the last step.
    deformation_dt = parameters.time.velocities == "half steps" ? last_dt : dt;
    fastest_signal = fastest_wave = 0.;
    find_acceleration();
    if (shows_faster_mode(last_signal))
      {
        dt             = last_dt;
        fastest_signal = last_signal;
        fastest_wave   = last_wave;
        critical_step.begin_with(force);
        choose_step(true);
        fastest_signal = fastest_wave = 0.;
        find_acceleration();
      }
    remember_acceleration();
    const std::string &order = parameters.scheme.stress_update;
    for (unsigned int d = 0; d < dim; ++d)
      {
        new_velocity[d] = velocity[d];
        new_velocity[d].add(velocity_dt, acceleration[d]);
      }
    filter_velocity();
    add_contact();
    take_held_residual();
    add_work();
    add_work_of_damping();

    if (order == "USL")
      update_points(&acceleration, &new_velocity, &new_velocity, true);
    else if (order == "USF")
      update_points(&acceleration, &new_velocity, nullptr, true);
    else
      {
        update_points(&acceleration, &new_velocity, nullptr, false);
        sums_are_current = false;
        {
          const PartTimer timer(*this, "points to grid");
          transfer.points_to_grid(quadrature_points(),
                                  &lumped_mass,
                                  &momentum,
                                  nullptr);
        }
        for (unsigned int d = 0; d < dim; ++d)
          mapped_velocity[d] = new_velocity[d];
        walls.hold_velocity(mapped_velocity, velocity_time + velocity_dt);
        if (obstacles)
          obstacles->set_velocity(mapped_velocity, true);
        solve({&mapped_velocity}, {&momentum});
        walls.stop(mapped_velocity);
        update_points(nullptr, &new_velocity, &mapped_velocity, true);
      }
    transport_points();
    check(problem);
    share_volume();
    find_crossing_rate();
    t += dt;
    velocity_time += velocity_dt;
    ++steps;
    if (steps == 1)
      check_fragments();
    check_energy();
    if (n_free_points == 0)
      warnings.push_back("The last point has left the grid at t = " +
                         std::to_string(t) + " s: the run ends.");
    damp_kinetically();
  }



  template <int dim>
  Statistics<dim>
  Simulation<dim>::statistics() const
  {
    Statistics<dim> result =
      compute_statistics<dim>(all_bodies, transfer, loads.gravity(t), comm);
    result.time       = t;
    result.step       = dt;
    result.iterations = iterations;
    result.active     = grid_mass->n_active();
    result.fragments  = grid_mass->n_fragments();
    return result;
  }



  template <int dim>
  std::uint64_t
  Simulation<dim>::n_sent() const
  {
    return Utilities::MPI::sum(n_own_sent, comm);
  }



  template <int dim>
  std::uint64_t
  Simulation<dim>::n_removed() const
  {
    return n_all_removed;
  }



  template <int dim>
  std::vector<std::string>
  Simulation<dim>::take_warnings()
  {
    std::vector<std::string> result;
    result.swap(warnings);
    return result;
  }



  template <int dim>
  std::size_t
  Simulation<dim>::points_memory() const
  {
    std::size_t n = 0;
    for (unsigned int b = 0; b < all_bodies.size(); ++b)
      n += all_bodies[b].points.memory_consumption() +
           remembered.points[b].memory_consumption();
    return n;
  }



  template class Simulation<2>;
  template class Simulation<3>;
} // namespace greville
