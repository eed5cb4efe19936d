// SPDX-License-Identifier: LGPL-2.1-or-later

// Points of other programs: files that VTK has written in all of its XML
// encodings, PLY, CSV with more than places, and what is refused. The files in
// points_file/ come from vtkXMLUnstructuredGridWriter and
// vtkXMLPolyDataWriter 9.1, which ParaView uses.

#include <greville/materials/linear_elastic.h>
#include <greville/materials/neo_hookean.h>
#include <greville/particles/body.h>

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
    for (const std::string file : {"ascii.vtu",
                                   "binary.vtu",
                                   "plain.vtu",
                                   "appended.vtu",
                                   "raw.vtu",
                                   "rawplain.vtu",
                                   "verts.vtp"})
      check_four(file, SOURCE_DIR "/points_file/" + file, true);
    {
      const LinearElastic material = elastic();
      const Made          made(
        [&](BodyParameters &body) {
          body.points_file  = SOURCE_DIR "/points_file/binary.vtu";
          body.body_in_file = 1;
          body.velocity     = "x; 7";
          body.stress       = "8; 8; 8; 0";
        },
        material);
      check("points of one body", made.body.n_points == 2);
      check("formulas take the place of what a file has",
            made.largest([&](const auto p) {
              return std::abs(p.velocity(0) - p.position(0)) +
                     std::abs(p.velocity(1) - 7.) + std::abs(p.stress(0) - 8.) +
                     std::abs(p.position(0) - x[1 + unsigned(p.id())]);
            }),
            1e-6);
    }

    std::ostringstream header, ascii, binary;
    header
      << "element vertex 4\nproperty double x\nproperty double y\nproperty "
         "float z\nproperty uchar red\nproperty double volume\nproperty "
         "float velocity_x\nproperty float velocity_y\nelement face 0\n"
         "property list uchar int vertex_indices\nend_header\n";
    ascii << "ply\nformat ascii 1.0\ncomment points\n" << header.str();
    binary << "ply\nformat binary_little_endian 1.0\n" << header.str();
    const auto put = [&](const auto value) {
      binary.write(reinterpret_cast<const char *>(&value), sizeof(value));
    };
    for (unsigned int i = 0; i < 4; ++i)
      {
        const double volume = 0.1 * (i + 1);
        ascii << x[i] << ' ' << y[i] << " 0 7 " << volume << ' ' << 2 * i + 1
              << ' ' << 2 * i + 2 << '\n';
        put(x[i]);
        put(y[i]);
        put(0.f);
        put((unsigned char)7);
        put(volume);
        put(2.f * i + 1.f);
        put(2.f * i + 2.f);
      }
    write("ascii.ply", ascii.str());
    check_four("ASCII PLY", "ascii.ply", false);
    write("binary.ply", binary.str());
    check_four("binary PLY", "binary.ply", false);
    write("cut.ply", binary.str().substr(0, binary.str().size() - 5));

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



  // An UnstructuredGrid of two points with these arrays.
  std::string
  grid(const std::string &arrays, const std::string &attributes = "")
  {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" "
           "version=\"1.0\" " +
           attributes +
           ">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"2\" "
           "NumberOfCells=\"0\">\n<Points>\n<DataArray type=\"Float64\" "
           "NumberOfComponents=\"3\" format=\"ascii\">0.1 0.2 0 0.3 0.4 "
           "0</DataArray>\n</Points>\n<PointData>\n" +
           arrays + "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  }

  std::string
  array(const std::string &name,
        const std::string &values,
        const std::string &format = "ascii",
        const std::string &type   = "Float64")
  {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"" +
           format + "\">" + values + "</DataArray>\n";
  }



  void
  test_errors()
  {
    print() << "Errors" << std::endl;
    const auto refuse_grid = [](const std::string &text) {
      write("wrong.vtu", text);
      refuse("wrong.vtu");
    };
    refuse("missing.vtu");
    refuse("points.xyz");
    refuse_grid("Hello");
    refuse_grid("<a></a>");
    refuse_grid("<VTKFile type=\"ImageData\"><ImageData/></VTKFile>");
    refuse_grid(grid(""));
    refuse_grid(grid(array("volume", "0.1")));
    refuse_grid(grid(array("volume", "0.1 x")));
    refuse_grid(grid(array("volume", "0.1 nan")));
    refuse_grid(grid(array("volume", "0.1 -1")));
    refuse_grid(grid(array("volume", "CAAAAA==", "binary")));
    refuse_grid(grid(array("volume", "AgAA*AAA", "binary")));
    refuse_grid(grid(array("volume", "AgAAAAAA", "binary", "Float80")));
    refuse_grid(grid(array("volume", "1 1", "octal")));
    refuse_grid(grid(array("volume", "1 1"), "byte_order=\"BigEndian\""));
    refuse_grid(
      grid(array("volume", "1 1"), "compressor=\"vtkLZ4DataCompressor\""));
    refuse_grid(grid(array("volume", "1 1") + array("stress_xx", "1 1")));
    refuse_grid(grid("<DataArray type=\"Float64\" Name=\"volume\" "
                     "NumberOfComponents=\"4294967295\">1 1</DataArray>"));
    // Three times as many have more than 64 bits, the last of which are 2.
    refuse_grid("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece "
                "NumberOfPoints=\"6148914691236517206\"><Points><DataArray "
                "type=\"Float64\">1 1</DataArray></Points></Piece>"
                "</UnstructuredGrid></VTKFile>");
    write("own_piece.pvtu",
          "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid><Piece "
          "Source=\"own_piece.pvtu\"/></PUnstructuredGrid></VTKFile>");
    refuse("own_piece.pvtu");
    write("wrong.vtu", grid(array("volume", "1 1")));
    refuse("wrong.vtu", [](BodyParameters &body) { body.body_in_file = 0; });
    refuse("cut.ply");
    write("wrong.ply", "solid\n");
    refuse("wrong.ply");
    write("wrong.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
          "float y\nend_header\n0.5 0.5\n");
    refuse("wrong.ply");
    write("wrong.csv", "x,y,volume,velocity_x\n0.1,0.2,1,1\n");
    refuse("wrong.csv");
    // Numbers that contradict each other, or the grid of 1.5 m^2.
    for (const std::string text :
         {"x,y,volume,F_xx,F_xy,F_yx,F_yy,F_zz\n0.1,0.2,1,-1,0,0,1,1\n",
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
