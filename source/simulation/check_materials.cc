// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/simulation/check_materials.h>

#include <cmath>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // What check_materials() finds unlikely.
    constexpr double least_density = 500., most_weight = 0.2,
                     least_strength = 1e-3;



    bool
    has_shear_stress(const Material &material, const double stress)
    {
      MaterialPoint         point;
      SymmetricTensor<2, 3> shear;
      shear[0][1] = stress;
      try
        {
          material.initialize(point, shear);
          return true;
        }
      catch (const ExceptionBase &)
        {
          return false;
        }
    }



    /**
     * Collective. The extent of the points of a body along @p gravity, m.
     */
    template <int dim>
    double
    height_of(const Body<dim>      &body,
              const Tensor<1, dim> &gravity,
              const MPI_Comm        comm)
    {
      const Tensor<1, dim> up = -gravity / gravity.norm();
      std::vector<double>  ends(2, std::numeric_limits<double>::lowest());
      body.points.for_each([&](const unsigned int, ConstPointRef<dim> p) {
        const double z = Tensor<1, dim>(p.position()) * up;
        ends[0]        = std::max(ends[0], z);
        ends[1]        = std::max(ends[1], -z);
      });
      Utilities::MPI::max(ends, comm, ends);
      return ends[0] + ends[1];
    }



    std::string
    rounded(const double value)
    {
      std::ostringstream text;
      text << std::setprecision(4) << value;
      return text.str();
    }
  } // namespace



  double
  shear_strength(const Material &material)
  {
    const double most = 0.5 * material.moduli().shear;
    if (!(most > 0.))
      return 0.;
    if (has_shear_stress(material, most))
      return std::numeric_limits<double>::infinity();
    double lower = 1e-12 * most, upper = most;
    if (!has_shear_stress(material, lower))
      return 0.;
    while (upper > 1.001 * lower)
      {
        const double middle = std::sqrt(lower * upper);
        (has_shear_stress(material, middle) ? lower : upper) = middle;
      }
    return lower;
  }



  template <int dim>
  void
  check_materials(std::ostream         &out,
                  const BodyList<dim>  &bodies,
                  const Tensor<1, dim> &gravity,
                  const MPI_Comm        comm)
  {
    const double          g = gravity.norm();
    std::set<std::string> names;
    std::string           notes;
    const auto note = [&](const std::string &name, const std::string &what) {
      notes += "  Note: 'Material " + name + "' " + what + '\n';
    };
    out << "  material         density, kg/m^3  p waves, m/s  s waves, m/s  "
           "shear strength, Pa\n";
    for (const Body<dim> &body : bodies)
      {
        const Material    &material  = *body.material;
        const Moduli       moduli    = material.moduli();
        const double       stiffness = moduli.bulk + 4. / 3. * moduli.shear;
        const double       strength  = shear_strength(material);
        const std::string &name      = body.parameters->material;
        const bool         is_new    = names.insert(name).second;
        const auto         speed     = [&](const double modulus) {
          return rounded(std::sqrt(modulus / material.density));
        };
        if (is_new)
          out << "  " << std::left << std::setw(16) << name << std::right
              << std::setw(16) << rounded(material.density) << std::setw(14)
              << speed(stiffness) << std::setw(14) << speed(moduli.shear)
              << std::setw(20)
              << (moduli.shear == 0.     ? "fluid"
                  : std::isinf(strength) ? "no limit"
                                         : rounded(strength))
              << '\n';
        if (body.rigid_motion)
          continue;
        if (is_new && g > 9. && g < 11. && material.density < least_density)
          note(name,
               "has a density of " + rounded(material.density) +
                 " kg / m^3, and water has 1000. Is it a weight in kN / m^3? "
                 "Divide it by 0.00981.");
        if (g == 0.)
          continue;
        // All processes have to take part.
        const double weight =
          material.density * g * height_of(body, gravity, comm);
        if (weight > most_weight * stiffness)
          note(name,
               "is soft: its weight over the height of 'Body " + body.name +
                 "', rho g H = " + rounded(weight) +
                 " Pa, is more than a fifth of K + 4 G / 3 = " +
                 rounded(stiffness) + " Pa. Is the stiffness in Pa?");
        if (strength > 0. && strength < least_strength * weight)
          note(name,
               "is weak: its shear strength without pressure is less than a "
               "thousandth of its weight over the height of 'Body " +
                 body.name + "', rho g H = " + rounded(weight) +
                 " Pa. Is the strength in Pa?");
      }
    out << notes;
  }



  template decltype(check_materials<2>) check_materials<2>;
  template decltype(check_materials<3>) check_materials<3>;
} // namespace greville
