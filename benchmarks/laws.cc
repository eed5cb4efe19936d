// SPDX-License-Identifier: LGPL-2.1-or-later

// Measures the CPU time of constitutive laws in ns per point and step: update
// and tangent of each law in plane strain and in 3D, elastic and with plastic
// flow in each step. Each number is a median of runs paired with a fixed loop
// of square roots. The time of this loop, printed beside it, shows whether the
// machine was busy.
//
//   ninja -C build law_benchmark && build/law_benchmark [LIBRARY ...]
//
// With libraries, it measures their UMATs instead. Their properties are Young's
// modulus, Poisson's ratio and a yield stress, with up to seven state
// variables.

#include <deal.II/base/mpi.h>

#include <greville/materials/hencky.h>
#include <greville/materials/material_lanes.h>

#include "timing.h"
#include <cstdio>
#include <filesystem>
#include <random>

using namespace dealii;
using namespace greville;

namespace
{
  // Return increments of this size that alternate with their inverses.
  std::vector<Tensor<2, 3>>
  increments(const unsigned int n, const double size, const bool plane)
  {
    std::mt19937                           engine;
    std::uniform_real_distribution<double> random(-size, size);
    std::vector<Tensor<2, 3>>              result(n);
    for (Tensor<2, 3> &f : result)
      {
        f = unit_symmetric_tensor<3>();
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            if (!plane || (i < 2 && j < 2))
              f[i][j] += random(engine);
      }
    return result;
  }



  void
  measure(const std::string              &name,
          const std::vector<std::string> &settings,
          const double                    size,
          const std::string              &what)
  {
    const auto       material = make_material(name, "Model");
    ParameterHandler prm;
    material->declare(prm);
    std::string text;
    for (const std::string &setting : settings)
      text += "set " + setting + "\n";
    prm.parse_input_from_string(text);
    material->reinit("Material");

    // As many points at once as in a kernel of the simulation.
    constexpr unsigned int n = 256, group = 4, n_steps = 200, n_pairs = 9;
    double                 nanoseconds[2], tangent[2], reference = 0.;
    std::array<MaterialTangent, group> tangents;
    for (const bool plane : {true, false})
      {
        const auto                 f = increments(n, size, plane);
        std::vector<Tensor<2, 3>>  back;
        std::vector<MaterialPoint> points(n);
        for (const Tensor<2, 3> &there : f)
          back.push_back(invert(there));
        for (MaterialPoint &point : points)
          material->initialize(point, -2e3 * unit_symmetric_tensor<3>());
        std::vector<double> times, times_of_tangents, references;
        for (unsigned int pair = 0; pair < n_pairs; ++pair)
          {
            references.push_back(reference_loop(1000000));
            double seconds = 0., seconds_of_tangents = 0.;
            for (unsigned int step = 0; step < n_steps; ++step)
              {
                for (unsigned int i = 0; i < n; ++i)
                  {
                    points[i].increment = step % 2 == 0 ? f[i] : back[i];
                    points[i].F         = points[i].increment * points[i].F;
                    points[i].J         = determinant(points[i].F);
                    points[i].dt        = 1e-3;
                  }
                double start = cpu_seconds();
                for (unsigned int i = 0; i < n; i += group)
                  material->tangents(
                    ArrayView<const MaterialPoint>(points.data() + i, group),
                    ArrayView<MaterialTangent>(tangents.data(), group),
                    plane ? 2 : 3);
                seconds_of_tangents += cpu_seconds() - start;
                // The call of the kernels of explicit steps.
                std::vector<MaterialLanes> lanes;
                if (material->has_lanes())
                  for (unsigned int i = 0; i < n; i += group)
                    lanes.emplace_back(points.data() + i, group);
                start = cpu_seconds();
                for (MaterialLanes &lane : lanes)
                  material->update_lanes(lane);
                if (lanes.empty())
                  for (unsigned int i = 0; i < n; i += group)
                    material->update(
                      ArrayView<MaterialPoint>(points.data() + i, group));
                seconds += cpu_seconds() - start;
                for (unsigned int i = 0; i < lanes.size(); ++i)
                  lanes[i].write(points.data() + i * group);
              }
            times.push_back(seconds / n_steps / n * 1e9);
            times_of_tangents.push_back(seconds_of_tangents / n_steps / n *
                                        1e9);
          }
        nanoseconds[!plane] = median(times);
        tangent[!plane]     = median(times_of_tangents);
        reference           = median(references) * 1e3;
      }
    std::printf("| %-16s | %-14s | %8.1f | %8.1f | %8.1f | %8.1f | %8.2f |\n",
                name.c_str(),
                what.c_str(),
                nanoseconds[0],
                tangent[0],
                nanoseconds[1],
                tangent[1],
                reference);
  }
} // namespace



int
main(int argc, char **argv)
{
  const std::vector<std::string>   libraries(argv + 1, argv + argc);
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  std::printf(
    "| law | | plane strain, ns | tangent, ns | 3D, ns | tangent, ns | "
    "reference, ns |\n"
    "| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const std::string &library : libraries)
    measure("umat",
            {"Library = " + library,
             "Properties = 1e6, 0.3, 1e9, 0",
             "State variables = 7"},
            1e-2,
            std::filesystem::path(library).stem().string());
  if (!libraries.empty())
    return 0;
  const std::string stiff = "Young modulus = 1e6";
  measure("linear-elastic", {stiff}, 1e-2, "");
  measure("linear-elastic", {stiff}, 0.3, "large strains");
  measure("neo-hookean", {stiff}, 1e-2, "");
  measure("newtonian-fluid", {"Viscosity = 1"}, 1e-3, "");
  measure("bingham", {}, 1e-3, "");
  measure("von-mises", {stiff, "Yield stress = 1e9"}, 1e-2, "elastic");
  measure("von-mises", {stiff, "Yield stress = 1e3"}, 1e-2, "plastic");
  for (const std::string law : {"drucker-prager", "mohr-coulomb"})
    {
      measure(law, {stiff, "Cohesion = 1e9"}, 1e-2, "elastic");
      measure(law, {stiff, "Cohesion = 1e2"}, 1e-2, "plastic");
    }
}
