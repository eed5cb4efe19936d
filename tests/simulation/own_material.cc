// SPDX-License-Identifier: LGPL-2.1-or-later

// A material of a program's own, by name and with a parameter, without a change
// of the library: the neo-Hookean law of Poisson's ratio 0 by its shear
// modulus.

#include <greville/materials/elastic_constants.h>

#include "simulation.h"

namespace
{
  // sigma = mu (b - 1) / J.
  class Sponge : public MaterialLaw<Sponge>
  {
  public:
    static constexpr const char *name = "sponge";

    void
    declare(ParameterHandler &prm) override
    {
      Material::declare(prm);
      prm.add_parameter("Shear modulus", mu, "Unit: Pa.", positive());
    }

    void
    initialize(MaterialPoint                       &point,
               const dealii::SymmetricTensor<2, 3> &stress) const override
    {
      AssertThrow(stress.norm() == 0., ExcMessage("A sponge has no stress."));
      update_point(point);
    }

    void
    update_point(MaterialPoint &point) const
    {
      const SymmetricTensor<2, 3> e = left_cauchy_green_less_one(point.F);
      point.stress                  = mu / point.J * e;
      point.wave_modulus            = mu * (2. + e.norm()) / point.J;
    }

    double
    strain_energy(const MaterialPoint &point) const override
    {
      return 0.5 * mu * trace(left_cauchy_green_less_one(point.F)) -
             mu * std::log(point.J);
    }

    Moduli
    moduli() const override
    {
      Moduli result;
      result.bulk  = 2. / 3. * mu;
      result.shear = mu;
      return result;
    }

  private:
    double mu = 1.;
  };



  Statistics<2>
  run(const std::vector<std::string> &law)
  {
    Simulated<2> simulated(
      Text()
        .add("Simulation", {"Bodies = body", "Materials = solid"})
        .add("Scheme", {"Mass = lumped"})
        .add("Grid", {"Cells = 10, 10"})
        .add("Body body",
             {"Material = solid",
              "Shape = box(0.2, 0.2, 0.6, 0.6)",
              "Velocity = 2 * x; -3 * y"})
        .add("Material solid", law)
        .add("Time", {"End = 0.1", "Step = 0.005"}));
    return simulated.run()->statistics();
  }
} // namespace



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  add_material<Sponge>();
  const Statistics<2> own     = run({"Model = sponge",
                                     "Density = 1",
                                     "Shear modulus = 50"}),
                      library = run({"Model = neo-hookean",
                                     "Density = 1",
                                     "Youngs modulus = 100",
                                     "Poissons ratio = 0"});
  check("there is strain", own.strain > 0.);
  check("strain energy",
        std::abs(own.strain - library.strain),
        1e-12 * own.strain);
  check("kinetic energy",
        std::abs(own.kinetic - library.kinetic),
        1e-12 * own.kinetic);
  check("the list of names",
        material_names().find("|sponge") != std::string::npos);
}
