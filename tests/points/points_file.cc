// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks points of other programs: tables with more columns than positions, and
// refused input.

#include <greville/materials/linear_elastic.h>
#include <greville/materials/neo_hookean.h>
#include <greville/points/body.h>

#include "points.h"
#include <fstream>

namespace
{
  struct Made
  {
    Made(const std::function<void(BodyParameters &)> &set,
         const Material                              &material)
      : box({{4, 4}}, MPI_COMM_WORLD)
      , space(box.mesh, 2)
    {
      set(parameters);
      body.name       = "a";
      body.parameters = &parameters;
      body.material   = &material;
      make_points(body,
                  space,
                  Tensor<1, 2>(),
                  PointLayout<2>(material.state_names()));
    }

    double
    largest(const std::function<double(ConstPointRef<2>)> &f) const
    {
      double result = 0.;
      body.points.for_each([&](const unsigned int, const auto p) {
        const double value = f(p);
        result = std::max(result, value == value ? std::abs(value) : 1e300);
      });
      return max_all(result);
    }

    Box<2>         box;
    SplineSpace<2> space;
    BodyParameters parameters;
    Body<2>        body;
  };



  void
  write(const std::string &name, const std::string &text)
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::ofstream(name, std::ios::binary) << text;
    MPI_Barrier(MPI_COMM_WORLD);
  }

  LinearElastic
  elastic()
  {
    LinearElastic material;
    material.density = 2000.;
    material.reinit("Material");
    return material;
  }

  const double x[4] = {0.3, 1., 0., 0.5}, y[4] = {0.2, 1.5, 0., 0.75};



  // Places, volumes and velocities of the four points; stresses where they
  // are in the file.
  void
  check_four(const std::string &name,
             const std::string &file,
             const bool         stress)
  {
    const LinearElastic material = elastic();
    const Made made([&](BodyParameters &body) { body.points_file = file; },
                    material);
    check(name,
          made.largest([&](const auto p) {
            const unsigned int i     = p.id();
            double             error = std::abs(p.position(0) - x[i]) +
                           std::abs(p.position(1) - y[i]) +
                           std::abs(p.volume() - 0.1 * (i + 1)) +
                           std::abs(p.mass() / (200. * (i + 1)) - 1.) +
                           std::abs(p.velocity(0) - (2. * i + 1.)) +
                           std::abs(p.velocity(1) - (2. * i + 2.));
            const double sigma[4] = {1. + i, -2., 3., 0.5};
            for (unsigned int k = 0; stress && k < 4; ++k)
              error += std::abs(p.stress(k) - sigma[k]);
            return error;
          }),
          1e-6);
    check(name + ", points", made.body.n_points == 4);
  }



  void
  test_formats()
  {
    write("all.csv",
          "x,y,z,volume,velocity_x,velocity_y,body,stress_xx,stress_yy,"
          "stress_zz,stress_xy\n0.3,0.2,0,0.1,1,2,0,1,-2,3,0.5\n"
          "1,1.5,0,0.2,3,4,1,2,-2,3,0.5\n0,0,0,0.3,5,6,1,3,-2,3,0.5\n"
          "0.5,0.75,0,0.4,7,8,0,4,-2,3,0.5\n");
    check_four("all columns", "all.csv", true);
    {
      const LinearElastic material = elastic();
      const Made          made(
        [&](BodyParameters &body) {
          body.points_file = "all.csv";
          body.velocity    = "x; 7";
          body.stress      = "8; 8; 8; 0";
        },
        material);
      check("number of points", made.body.n_points == 4);
      check("formulas take the place of what a file has",
            made.largest([&](const auto p) {
              return std::abs(p.velocity(0) - p.position(0)) +
                     std::abs(p.velocity(1) - 7.) + std::abs(p.stress(0) - 8.) +
                     std::abs(p.position(0) - x[unsigned(p.id())]);
            }),
            1e-6);
    }

    // The mass instead of the volume, and places of the begin.
    write("mass.csv",
          "x,y,mass,velocity_x,velocity_y,displacement_x,displacement_y\n"
          "0.3,0.2,200,1,2,0.1,-0.1\n1,1.5,400,3,4,0.1,-0.1\n"
          "0,0,600,5,6,0.1,-0.1\n0.5,0.75,800,7,8,0.1,-0.1\n");
    check_four("mass", "mass.csv", false);
    const LinearElastic material = elastic();
    const Made          moved(
      [](BodyParameters &body) { body.points_file = "mass.csv"; }, material);
    check("initial positions",
          moved.largest([](const auto p) {
            return std::abs(p.position(0) - p.reference(0) - 0.1) +
                   std::abs(p.position(1) - p.reference(1) + 0.1);
          }),
          1e-12);

    // A deformation whose stress the law finds.
    NeoHookean rubber;
    rubber.reinit("Material");
    write("deformed.csv",
          "x,y,volume,density,F_xx,F_xy,F_yx,F_yy,F_zz\n"
          "0.3,0.2,0.1,500,1.25,0.5,0,0.8,1\n0.6,0.7,0.2,500,2,0,0,1,1\n");
    const Made deformed(
      [](BodyParameters &body) { body.points_file = "deformed.csv"; }, rubber);
    check("deformation",
          deformed.largest([&](const auto p) {
            const bool   second = p.id() == 1.;
            const double J      = second ? 2. : 1.;
            return std::abs(p.F(0, 0) - (second ? 2. : 1.25)) +
                   std::abs(p.F(0, 1) - (second ? 0. : 0.5)) +
                   std::abs(p.J() - J) +
                   std::abs(p.volume() - (second ? 0.2 : 0.1)) +
                   std::abs(p.mass() - (second ? 100. : 50.)) +
                   (std::abs(p.stress(3)) > 1. || second ? 0. : 1.);
          }),
          1e-12);
  }



  void
  refuse(
    const std::string                           &file,
    const std::function<void(BodyParameters &)> &set = [](BodyParameters &) {})
  {
    const LinearElastic material = elastic();
    try
      {
        const Made made(
          [&](BodyParameters &body) {
            body.points_file = file;
            set(body);
          },
          material);
        print() << "  accepted: FAILED" << std::endl;
      }
    catch (const std::exception &error)
      {
        print() << "  " << message_of(error) << std::endl;
      }
  }



  void
  test_errors()
  {
    print() << "Errors" << std::endl;
    refuse("missing.csv");
    write("points.vtu", "");
    refuse("points.vtu");
    write("wrong.csv", "x,y,volume,velocity_x\n0.1,0.2,1,1\n");
    refuse("wrong.csv");
    // Numbers that contradict each other, or the grid of 1.5 m^2.
    for (const std::string text :
         {"x,y,z\n0.1,0.2,0\n",
          "x,y,volume\n0.1,0.2,0.1\n0.3,0.4,nan\n",
          "x,y,volume\n0.1,0.2,0.1\n0.3,0.4,-1\n",
          "x,y,volume,F_xx,F_xy,F_yx,F_yy,F_zz\n0.1,0.2,1,-1,0,0,1,1\n",
          "x,y,volume,F_xx,F_xy,F_yx,F_yy,F_zz,J\n0.1,0.2,1,2,0,0,1,1,1\n",
          "x,y,volume,mass,density\n0.1,0.2,1,2000,2000\n0.3,0.2,1,1,2000\n",
          "x,y,volume,mass\n0.1,0.2,1,0.002\n",
          "x,y,volume,density\n0.1,0.2,1,1e9\n",
          "x,y,volume\n0.1,0.2,1e90\n",
          "x,y,volume\n0.1,0.2,1\n0.3,0.4,1\n",
          "x,y,mass\n0.1,0.2,2000\n0.3,0.4,2000\n",
          "x,y,volume\n# Twice\n0.1,0.2,0.1\n0.3,0.4,0.1\n0.1,0.2,0.1\n"})
      {
        write("wrong.csv", text);
        refuse("wrong.csv");
      }
  }
} // namespace



void
test_main()
{
  test_formats();
  test_errors();
}
