// SPDX-License-Identifier: LGPL-2.1-or-later

// A program with a material law of its own, and a loop over steps that writes
// statistics and files for ParaView: ./own_law sponge.prm

#include <greville/base/csv.h>
#include <greville/base/run_folder.h>
#include <greville/materials/elastic_constants.h>
#include <greville/materials/material.h>
#include <greville/run/output.h>
#include <greville/steps/end_of_step.h>
#include <greville/steps/simulation.h>

#include <cmath>
#include <iostream>

using namespace dealii;
using namespace greville;

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
  initialize(MaterialPoint               &point,
             const SymmetricTensor<2, 3> &stress) const override
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



void
run(const std::string &file)
{
  const MPI_Comm             comm = MPI_COMM_WORLD;
  const SimulationParameters parameters(file);
  Simulation<2>              simulation(parameters, comm);

  const std::string directory = parameters.output.directory;
  RunFolder folder(directory, "Output/Directory", EarlierResults::remove, comm);
  folder.make_room();
  FieldOutput<2> fields(directory, parameters.output);
  CsvWriter      statistics;
  statistics.open(directory + "/statistics.csv",
                  Statistics<2>::names(),
                  14,
                  comm);

  double     next  = 0.;
  const auto write = [&]() {
    // Velocities belong to the time of the positions while it lives.
    const EndOfStep<2> end_of_step(simulation);
    const double       time = simulation.state().time;
    statistics.write(simulation.statistics().values());
    fields.write_points(time, simulation.bodies(), comm);
    next = time + parameters.output.fields_every;
  };
  write();
  while (!simulation.is_finished())
    {
      simulation.step();
      if (simulation.state().time >= next || simulation.is_finished())
        write();
    }
}



int
main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  try
    {
      AssertThrow(argc == 2, ExcMessage("Give one parameter file."));
      add_material<Sponge>();
      run(argv[1]);
    }
  catch (const std::exception &error)
    {
      std::cerr << error.what() << std::endl;
      return 1;
    }
}
