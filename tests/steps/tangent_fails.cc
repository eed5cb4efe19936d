// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks a law with finite stress and a NaN tangent at points of one process:
// steps are shortened, and a run without a shorter step ends with a message on
// the point and the reason, not with the error of the linear solver.
#include <greville/materials/elastic_constants.h>

#include "simulation.h"
#include <cmath>

namespace
{
  const MPI_Comm comm = MPI_COMM_WORLD;

  // Below this J there is no tangent on the last process.
  double smallest_J = 0.;

  // sigma = (b - 1) 100 Pa / J.
  class LawWithoutTangent : public MaterialLaw<LawWithoutTangent>
  {
  public:
    static constexpr const char *name = "without-tangent";

    void
    initialize(MaterialPoint &point,
               const SymmetricTensor<2, 3> &) const override
    {
      update_point(point);
    }

    void
    update_point(MaterialPoint &point) const
    {
      const SymmetricTensor<2, 3> e = left_cauchy_green_less_one(point.F);
      point.stress                  = 100. / point.J * e;
      point.wave_modulus            = 100. * (2. + e.norm()) / point.J;
    }

    void
    tangents(const ArrayView<const MaterialPoint> &points,
             const ArrayView<MaterialTangent>     &result,
             const unsigned int                    dim) const override
    {
      Material::tangents(points, result, dim);
      const bool is_last = Utilities::MPI::this_mpi_process(comm) + 1 ==
                           Utilities::MPI::n_mpi_processes(comm);
      for (unsigned int i = 0; i < points.size(); ++i)
        if (is_last && points[i].J < smallest_J)
          result[i][0][0][0][0] = std::nan("");
    }

    double
    strain_energy(const MaterialPoint &point) const override
    {
      return 50. * trace(left_cauchy_green_less_one(point.F)) -
             100. * std::log(point.J);
    }

    Moduli
    moduli() const override
    {
      Moduli result;
      result.shear = 100.;
      return result;
    }
  };


  /// The weight of a block grows. The time that a run reaches, whose message
  /// names the point and the reason.
  double
  reached_time(const double J)
  {
    smallest_J = J;
    Simulated<2> run(
      Text()
        .add("Simulation", {"Bodies = body", "Materials = solid"})
        .add("Grid", {"Cells = 8, 8"})
        .add("Body body", {"Material = solid", "Shape = box(0, 0, 1, 0.5)"})
        .add("Material solid", {"Model = without-tangent", "Density = 1"})
        .add("Scheme", {"Stress update = quasi-static"})
        .add("Walls", {"Bottom = fixed", "Left = sliding", "Right = sliding"})
        .add("Loads", {"Gravity = 0; -20 * t"})
        .add("Time", {"End = 1", "Step = 0.1"}));
    std::string message;
    try
      {
        run.run();
      }
    catch (const std::exception &error)
      {
        message = message_of(error);
      }
    check(message,
          message.find(" of the body 'body': its stress or tangent becomes "
                       "infinite or NaN") != std::string::npos &&
            message.find("linear solver") == std::string::npos);
    return run->state().time;
  }
} // namespace



void
test_main()
{
  add_material<LawWithoutTangent>();

  // Below 0.98 the run gets as near to it as shorter steps can.
  const double time = reached_time(0.98), steps = 10. * time;
  check("steps are shortened: " + std::to_string(time),
        time > 0. && time < 1. && std::abs(steps - std::round(steps)) > 1e-9);

  // The first step has its tangents and residuals at different times.
  check("no step", reached_time(1. - 1e-12) == 0.);
}
