// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/named_formulas.h>
#include <greville/boundary/loads.h>
#include <greville/materials/umat.h>
#include <greville/parameters/unit_of_sums.h>
#include <greville/points/point_material.h>
#include <greville/run/check_materials.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <set>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // Bounds of input_notes(). Friction is the sine of the friction angle.
    constexpr double smallest_likely_density       = 500.,
                     largest_weight_over_stiffness = 0.2,
                     smallest_strength_over_weight = 1e-3,
                     smallest_unlikely_friction    = 0.0017,
                     largest_unlikely_friction     = 0.016;

    // Mass that may lie above a body without a note, as a fraction of its mass.
    constexpr double negligible_load = 1e-3;



    bool
    has_shear_stress(const Material &material,
                     const double    shear,
                     const double    pressure)
    {
      MaterialPoint         point;
      SymmetricTensor<2, 3> stress = -pressure * unit_symmetric_tensor<3>();
      stress[0][1]                 = shear;
      try
        {
          material.initialize(point, stress);
          return true;
        }
      catch (const ExceptionBase &)
        {
          return false;
        }
    }



    /// Collective. Return the extent of the points of a body along @p gravity,
    /// m.
    template <int dim>
    double
    height_of(const Body<dim>      &body,
              const Tensor<1, dim> &gravity,
              const MPI_Comm        comm)
    {
      const Tensor<1, dim> up = -gravity / gravity.norm();
      std::vector<double>  ends(2, std::numeric_limits<double>::lowest());
      body.points.for_each([&](ConstPointRef<dim> p) {
        const double z = Tensor<1, dim>(p.position()) * up;
        ends[0]        = std::max(ends[0], z);
        ends[1]        = std::max(ends[1], -z);
      });
      Utilities::MPI::max(ends, comm, ends);
      return ends[0] + ends[1];
    }



    /// Return the slope of the shear strength over the pressure: the sine of
    /// the Mohr-Coulomb friction angle. Zero if it is unknown.
    double
    friction_of(const Material &material)
    {
      // A law for the Kirchhoff stress has a larger Cauchy stress in a body
      // that the pressure compresses. This is no friction.
      constexpr double compression = 0.01;
      const double     pressure    = compression * material.moduli().bulk;
      const double     increase    = shear_strength(material, pressure) -
                              (1. + compression) * shear_strength(material);
      return std::isfinite(increase) ? increase / pressure : 0.;
    }



    /// Collective. Return, in kg, the mass of a body with K0 and the mass of
    /// another body on its surface: at most a cell away, and within the extent
    /// of the first body across gravity.
    template <int dim>
    std::pair<double, double>
    mass_above(const Body<dim>      &body,
               const Body<dim>      &other,
               const Tensor<1, dim> &gravity,
               const MPI_Comm        comm)
    {
      unsigned int axis = 0;
      for (unsigned int d = 1; d < dim; ++d)
        if (std::abs(gravity[d]) > std::abs(gravity[axis]))
          axis = d;
      const double              up = gravity[axis] < 0. ? 1. : -1.;
      const VectorExpression<1> surface(body.parameters->surface,
                                        "Body " + body.name + "/Surface",
                                        coordinate_names<dim>());
      double                    own = 0., above = 0.;
      double                    gap = std::numeric_limits<double>::max();
      std::vector<double> ends(2 * dim, std::numeric_limits<double>::lowest());
      body.points.for_each([&](ConstPointRef<dim> p) {
        own += p.mass();
        for (unsigned int d = 0; d < dim; ++d)
          {
            ends[d]       = std::max(ends[d], p.position(d));
            ends[dim + d] = std::max(ends[dim + d], -p.position(d));
          }
      });
      Utilities::MPI::max(ends, comm, ends);
      other.points.for_each([&](ConstPointRef<dim> p) {
        const Point<dim> x     = p.position();
        bool             is_in = true;
        for (unsigned int d = 0; d < dim; ++d)
          is_in =
            is_in && (d == axis || (x[d] <= ends[d] && -x[d] <= ends[dim + d]));
        try
          {
            const double height = is_in ? up * (x[axis] - surface(x)[0]) : 0.;
            if (height > 0.)
              {
                above += p.mass();
                gap = std::min(gap, height);
              }
          }
        catch (const std::exception &)
          {
            // The formula has no value here because the body has no point.
          }
      });
      const bool is_on = Utilities::MPI::min(gap, comm) <=
                         body.points.space().largest_cell_size(axis);
      return {Utilities::MPI::sum(own, comm),
              is_on ? Utilities::MPI::sum(above, comm) : 0.};
    }
  } // namespace



  double
  shear_strength(const Material &material, const double pressure)
  {
    const double largest_stress = 0.5 * material.moduli().shear;
    if (!(largest_stress > 0.))
      return 0.;
    if (has_shear_stress(material, largest_stress, pressure))
      return std::numeric_limits<double>::infinity();
    double lower = 1e-12 * largest_stress, upper = largest_stress;
    if (!has_shear_stress(material, lower, pressure))
      return 0.;
    while (upper > 1.001 * lower)
      {
        const double middle = std::sqrt(lower * upper);
        (has_shear_stress(material, middle, pressure) ? lower : upper) = middle;
      }
    return lower;
  }



  template <int dim>
  void
  print_materials(std::ostream &out, const BodyList<dim> &bodies)
  {
    std::set<std::string> names;
    out << "  material         density, kg/m^3  p waves, m/s  s waves, m/s  "
           "shear strength, Pa\n";
    for (const Body<dim> &body : bodies)
      {
        if (!names.insert(body.parameters->material).second)
          continue;
        const Material &material = *body.material;
        const Moduli    moduli   = material.moduli();
        const double    strength = shear_strength(material);
        const auto      speed    = [&](const double modulus) {
          return rounded(std::sqrt(modulus / material.density));
        };
        out << "  " << std::left << std::setw(16) << body.parameters->material
            << std::right << std::setw(16) << rounded(material.density)
            << std::setw(14) << speed(moduli.bulk + 4. / 3. * moduli.shear)
            << std::setw(14) << speed(moduli.shear) << std::setw(20)
            << (moduli.shear == 0.     ? "fluid"
                : std::isinf(strength) ? "no limit"
                                       : rounded(strength))
            << '\n';
      }
  }



  double
  tangent_error(const Material    &material,
                MaterialPoint      point,
                const double       strain,
                const unsigned int dim)
  {
    constexpr unsigned int n_steps = 10;
    point.dim                      = dim;
    Tensor<2, 3> gradient;
    gradient[0][0] = -1.;
    gradient[0][1] = 0.8;
    gradient[1][1] = 0.3;
    if (dim == 3)
      {
        gradient[1][2] = 0.5;
        gradient[2][2] = -0.4;
      }
    double error = 0.;
    for (unsigned int n = 0; n < n_steps; ++n)
      {
        point.increment = Tensor<2, 3>(unit_symmetric_tensor<3>()) +
                          strain / n_steps * gradient;
        point.F = point.increment * point.F;
        point.J = determinant(point.F);
        point.time += point.dt;
        MaterialTangent                      D, differences;
        const ArrayView<const MaterialPoint> view(&point, 1);
        material.tangents(view, ArrayView<MaterialTangent>(&D, 1), dim);
        material.Material::tangents(view,
                                    ArrayView<MaterialTangent>(&differences, 1),
                                    dim);
        error = std::max(error, (D - differences).norm() / differences.norm());
        material.update(ArrayView<MaterialPoint>(&point, 1));
      }
    return error;
  }



  template <int dim>
  void
  print_tangents(std::ostream        &out,
                 const BodyList<dim> &bodies,
                 const MPI_Comm       comm)
  {
    constexpr double strain = 0.01, dt = 0.1;
    for (const Body<dim> &body : bodies)
      if (dynamic_cast<const Umat *>(body.material))
        {
          double      error   = -1.;
          std::string problem = "", fault = "";
          body.points.for_each([&](ConstPointRef<dim> p) {
            if (error >= 0. || !problem.empty() || !fault.empty())
              return;
            MaterialPoint point;
            load_material_point<dim>(p, body.points.layout(), point);
            point.dt = dt;
            try
              {
                error = tangent_error(*body.material, point, strain, dim);
                // A maximum over processes would drop NaN.
                Require(std::isfinite(error), "it is infinite or NaN");
              }
            catch (const UmatFault &exception)
              {
                fault = message_of(exception);
              }
            catch (const std::exception &exception)
              {
                problem = message_of(exception);
              }
          });
          throw_on_all(fault, comm);
          problem = first_of_all(problem, comm);
          error   = Utilities::MPI::max(error, comm);
          out << "  tangent of 'Material " << body.parameters->material
              << "' in 'Body " << body.name << "': "
              << (problem.empty()
                    ? "DDSDDE is within " + rounded(error, 2) +
                        " of differences, along a path of 1 % strain"
                    : "no path of 1 % strain (" + problem + ")")
              << '\n';
        }
  }



  namespace
  {
    using Notes = std::vector<std::string>;

    /// Note a density or a friction that looks like a number of another unit.
    void
    note_units(Notes             &notes,
               const Material    &material,
               const std::string &name,
               const bool         is_real)
    {
      if (is_real && material.density < smallest_likely_density)
        notes.push_back(
          "'Material " + name + "' has a density of " +
          rounded(material.density) +
          " kg / m^3, and water has 1000. Is it a weight in kN / m^3? "
          "Divide it by 0.00981.");
      const double friction = friction_of(material);
      if (friction > smallest_unlikely_friction &&
          friction < largest_unlikely_friction)
        notes.push_back(
          "'Material " + name + "' has a shear strength that grows by " +
          rounded(friction) + " of the pressure, as by a friction angle of " +
          rounded(std::asin(friction) * 180. / numbers::PI) +
          " degrees. Is the angle in radians? It is given in "
          "degrees.");
    }



    /// Collective. Note an initial velocity that has no effect.
    template <int dim>
    void
    note_velocity(Notes &notes, const Body<dim> &body, const MPI_Comm comm)
    {
      bool moves = false;
      body.points.for_each([&](ConstPointRef<dim> p) {
        for (unsigned int d = 0; d < dim; ++d)
          moves = moves || p.velocity(d) != 0.;
      });
      if (Utilities::MPI::max<unsigned int>(moves, comm) > 0)
        notes.push_back("'Body " + body.name + "/Velocity' is <" +
                        formula_text(body.parameters->velocity) +
                        ">, which quasi-static steps ignore: the body "
                        "is at rest after the first step.");
    }



    /// Collective. Note bodies on the surface of a body with 'K0' whose weight
    /// its initial stress ignores.
    template <int dim>
    void
    note_bodies_above(Notes                &notes,
                      const Body<dim>      &body,
                      const BodyList<dim>  &bodies,
                      const Tensor<1, dim> &gravity,
                      const GridParameters &grid,
                      const MPI_Comm        comm)
    {
      for (const Body<dim> &other : bodies)
        if (&other != &body &&
            !(other.parameters->K0 >= 0. && !other.parameters->shape.empty()))
          {
            const auto above = mass_above(body, other, gravity, comm);
            if (above.second > negligible_load * above.first)
              notes.push_back(
                "'Body " + other.name + "' lies on the 'Surface' of '" +
                "Body " + body.name +
                "', whose initial stress by 'K0' "
                "counts bodies with a 'K0' and a 'Shape' only: " +
                rounded(above.second * gravity.norm()) + ' ' +
                unit_of_sums("N", dim, grid) +
                " are not in balance. A quasi-static stage finds the "
                "equilibrium, or 'Stress' gives the stress of both.");
          }
    }



    /// Collective. Note a stiffness or strength that is small for the weight.
    template <int dim>
    void
    note_weight(Notes                &notes,
                const Body<dim>      &body,
                const Tensor<1, dim> &gravity,
                const MPI_Comm        comm)
    {
      const Material &material = *body.material;
      const Moduli    moduli   = material.moduli();
      const double    weight =
        material.density * gravity.norm() * height_of(body, gravity, comm);
      const double      stiffness = moduli.bulk + 4. / 3. * moduli.shear;
      const double      strength  = shear_strength(material);
      const std::string name = "'Material " + body.parameters->material + "' ";
      if (weight > largest_weight_over_stiffness * stiffness)
        notes.push_back(name + "is soft: its weight over the height of 'Body " +
                        body.name + "', rho g H = " + rounded(weight) +
                        " Pa, is more than a fifth of K + 4 G / 3 = " +
                        rounded(stiffness) + " Pa. Is the stiffness in Pa?");
      if (strength > 0. && strength < smallest_strength_over_weight * weight)
        notes.push_back(
          name +
          "is weak: its shear strength without pressure is less than a "
          "thousandth of its weight over the height of 'Body " +
          body.name + "', rho g H = " + rounded(weight) +
          " Pa. Is the strength in Pa?");
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  input_notes(const BodyList<dim>        &bodies,
              const SimulationParameters &parameters,
              const MPI_Comm              comm)
  {
    SimulationParameters last = parameters;
    last.enter_stage(parameters.n_stages() - 1);
    const Tensor<1, dim> first_gravity =
      Loads<dim>(parameters).gravity(parameters.time.start);
    // A formula without a value at the end stops the run when it fails, with
    // the last good state, not here.
    Tensor<1, dim> gravity = first_gravity;
    try
      {
        gravity = Loads<dim>(last).gravity(parameters.end_of_run());
      }
    catch (const ExceptionBase &)
      {}
    const double g       = gravity.norm();
    const bool   is_real = g > 9. && g < 11.;
    Notes        notes;
    if (is_real &&
        std::all_of(gravity.begin_raw(),
                    gravity.end_raw(),
                    [](const double component) { return component >= 0.; }))
      notes.push_back("'Loads/Gravity' is (" + text_of(gravity) +
                      ") m / s^2, without a negative component: bodies fall "
                      "towards larger coordinates.");

    std::set<std::string> names;
    for (const Body<dim> &body : bodies)
      {
        const std::string &material = body.parameters->material;
        if (names.insert(material).second)
          note_units(notes, *body.material, material, is_real);
        if (!body.parameters->velocity.empty() &&
            parameters.scheme.is_quasi_static())
          note_velocity(notes, body, comm);
        if (body.parameters->K0 >= 0.)
          note_bodies_above(
            notes, body, bodies, first_gravity, parameters.grid, comm);
        if (g > 0.)
          note_weight(notes, body, gravity, comm);
      }
    return notes;
  }



  std::vector<std::string>
  repeated_parameters(const std::string &file)
  {
    std::vector<std::string>                     notes;
    std::map<std::string, const ParameterLine *> given;
    const auto lines   = read_parameter_lines(file, "Simulation", {}, "");
    const auto file_of = [](const ParameterLine &line) {
      return line.place.substr(line.place.find(" of "));
    };
    for (const ParameterLine &line : lines)
      {
        if (line.name.empty())
          continue;
        const ParameterLine *&other = given[line.section + "/" + line.name];
        // A file may override an included file.
        if (other != nullptr && other->value != line.value &&
            file_of(*other) == file_of(line))
          notes.push_back(line.place + ": the parameter '" + line.section +
                          "/" + line.name + "' is <" + line.value +
                          ">, but was <" + other->value + "> (" + other->place +
                          "): the last value counts.");
        other = &line;
      }
    return notes;
  }



  GREVILLE_INSTANTIATE(print_materials);
  GREVILLE_INSTANTIATE(print_tangents);
  GREVILLE_INSTANTIATE(input_notes);
} // namespace greville
