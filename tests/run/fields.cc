// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks fields in files: cell classes and forces on the grid, points of
// surface loads, and points that are read back.
#include <deal.II/base/utilities.h>

#include <greville/run/run.h>

#include "simulation.h"
#include <boost/algorithm/string/trim.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cstring>
#include <zlib.h>

namespace
{
  void
  run(const Text &text, const std::string &directory)
  {
    // Others may still read what is removed here.
    MPI_Barrier(MPI_COMM_WORLD);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      {
        std::filesystem::remove_all(directory);
        std::ofstream("run.prm")
          << text.with("Output", {"Directory = " + directory}).content;
      }
    MPI_Barrier(MPI_COMM_WORLD);
    std::streambuf *const buffer = std::cout.rdbuf(nullptr);
    run_simulations("run.prm", MPI_COMM_WORLD);
    std::cout.rdbuf(buffer);
    std::cout.clear();
    std::cout.width(0);
    MPI_Barrier(MPI_COMM_WORLD);
  }



  /// The numbers of an array in a .vtu file as deal.II writes it: in base64,
  /// the number of blocks, which is one, its size, that of the last one and the
  /// compressed one, and the block.
  std::vector<double>
  numbers_of(const std::string &text)
  {
    const std::size_t header = text.find_last_of('=', 30) + 1;
    const auto        sizes  = Utilities::decode_base64(text.substr(0, header));
    const auto        packed = Utilities::decode_base64(text.substr(header));
    std::uint32_t     n_bytes;
    std::memcpy(&n_bytes, sizes.data() + 4, 4);
    std::vector<float> values(n_bytes / sizeof(float));
    uLongf             size = n_bytes;
    AssertThrow(uncompress(reinterpret_cast<Bytef *>(values.data()),
                           &size,
                           packed.data(),
                           packed.size()) == Z_OK,
                ExcInternalError());
    return {values.begin(), values.end()};
  }



  /// All points of a .vtu file with their arrays, by piece.
  std::vector<std::map<std::string, double>>
  read(const std::string &file)
  {
    using boost::property_tree::ptree;
    ptree tree;
    boost::property_tree::read_xml(file, tree);
    std::vector<std::map<std::string, double>> result;
    for (const auto &[kind, piece] : tree.get_child("VTKFile.UnstructuredGrid"))
      {
        if (kind != "Piece")
          continue;
        const std::size_t n =
                            piece.get<std::size_t>("<xmlattr>.NumberOfPoints"),
                          begin = result.size();
        if (n == 0)
          continue;
        result.resize(begin + n);
        const auto add = [&, begin, n](const std::string &name,
                                       const ptree       &array) {
          const auto values =
            numbers_of(boost::algorithm::trim_copy(array.data()));
          const std::size_t m = values.size() / n;
          for (std::size_t k = 0; k < n; ++k)
            for (std::size_t c = 0; c < m; ++c)
              result[begin + k][m == 1 ? name
                                       : name + (name.empty() ? "" : "_") +
                                           "xyz"[c]] = values[k * m + c];
        };
        add("", piece.get_child("Points.DataArray"));
        for (const auto &array : piece.get_child("PointData"))
          if (array.first == "DataArray")
            add(array.second.get<std::string>("<xmlattr>.Name"), array.second);
      }
    return result;
  }



  /// The same as a file of points.
  void
  write_csv(const std::string &from, const std::string &to, const double body)
  {
    const auto points = read(from);
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      {
        std::ofstream out(to);
        out.precision(9);
        std::string separator;
        for (const auto &column : points.at(0))
          {
            out << separator << column.first;
            separator = ",";
          }
        for (const auto &point : points)
          {
            if (point.at("body") != body)
              continue;
            separator = "\n";
            for (const auto &column : point)
              {
                out << separator << column.second;
                separator = ",";
              }
          }
        out << std::endl;
      }
    MPI_Barrier(MPI_COMM_WORLD);
  }



  double
  sum(const std::vector<std::map<std::string, double>> &points,
      const std::string                                &name)
  {
    double result = 0.;
    for (const auto &point : points)
      result += point.at(name);
    return result;
  }



  const std::string all_fields =
    "Fields = velocity, displacement, stress, pressure, von_mises, J, density, "
    "body, id, reference, F, strain, mass, volume, size, process, history, "
    "acceleration, force, cell_class";



  void
  check_grid_and_surfaces(const std::string &scheme)
  {
    const Text text =
      block_2d("ball(0.5, 0.5, 0.31)", 8)
        .with("Simulation", {"Surface loads = push, all"})
        .with("Body body", {"Placement = fitted", "Points per direction = 3"})
        .with("Scheme",
              {"Mass = consistent",
               "Formulation = total Lagrangian",
               "Stress update = " + scheme})
        .with("Scheme", {"Filling threshold = 0.55"})
        .with("Surface load push",
              {"Body = body", "Where = x > 0.7", "Traction = 2; 0"})
        .with("Surface load all",
              {"Body = body", "Kind = pressure", "Pressure = 3"})
        .with("Loads", {"Gravity = 0; -1"})
        .with("Time", {"End = 0.02", "Step = 0.005"})
        .with("Output", {all_fields});
    run(text, "fields");
    const auto                  grid = read("fields/files/grid_0001.vtu");
    std::array<unsigned int, 4> n{};
    for (const auto &node : grid)
      ++n.at(unsigned(node.at("cell_class")));
    check(scheme + ": all classes of cells",
          *std::min_element(n.begin(), n.end()) > 0);
    // A function of order 2 has the integral h^2: the mean of the force's
    // field at the nodes is not that, but it points the same way.
    check(scheme + ": force to the right and down",
          sum(grid, "force_x") > 0. && sum(grid, "force_y") < 0.);
    check(scheme + ": accelerations",
          std::abs(sum(grid, "acceleration_x")) > 0.);

    const auto surface = read("fields/files/surface_0000.vtu");
    double     length = 0., pressure_x = 0., pressure = 0., worst = 0.;
    for (const auto &point : surface)
      {
        const double area = point.at("area");
        const double nx   = point.at("area_vector_x") / area,
                     ny   = point.at("area_vector_y") / area;
        worst             = std::max(worst,
                         std::abs(nx - (point.at("x") - 0.5) / 0.31) +
                           std::abs(ny - (point.at("y") - 0.5) / 0.31));
        check(scheme + ": body", point.at("body") == 0.);
        if (point.at("surface_load") == 0.)
          check("traction", std::abs(point.at("load_x") - 2.), 1e-6);
        else
          {
            length += area;
            pressure_x += point.at("load_x") * area;
            pressure +=
              -(point.at("load_x") * nx + point.at("load_y") * ny) * area;
          }
      }
    check(scheme + ": length of the surface",
          std::abs(length / (0.62 * numbers::PI) - 1.),
          1e-4);
    check(scheme + ": normals", worst, 1e-4);
    check(scheme + ": pressure",
          std::abs(pressure / length - 3.) + std::abs(pressure_x),
          1e-4);
    const auto later = read("fields/files/surface_0001.vtu");
    check(scheme + ": surfaces move", sum(later, "displacement_x") > 0.);
    check(scheme + ": their loads at the end",
          std::abs(sum(later, "load_x")) > 1.);
  }



  /// Files of a grid of a body have the numbers of the whole run.
  void
  check_numbers_of_surfaces()
  {
    run(block_2d("box(0.1, 0.1, 0.3, 0.3)", 8)
          .with("Simulation",
                {"Bodies = body, other", "Surface loads = first, second"})
          .with("Grid", {"Per body = true"})
          .with("Scheme", {"Formulation = total Lagrangian"})
          .with("Body body", {"Placement = fitted"})
          .with("Body other",
                {"Material = solid",
                 "Shape = box(0.6, 0.6, 0.8, 0.8)",
                 "Placement = fitted"})
          .with("Surface load first", {"Body = other", "Traction = 1; 0"})
          .with("Surface load second", {"Body = body", "Traction = 1; 0"})
          .with("Time", {"End = 0.001"}),
        "numbers");
    for (const unsigned int b : {0, 1})
      for (const auto &point :
           read(b == 0 ? "numbers/files/surface_body_0000.vtu"
                       : "numbers/files/surface_other_0000.vtu"))
        check("numbers of surfaces",
              point.at("surface_load") == 1. - b && point.at("body") == b);
  }



  /// A second run begins where the first one ends, to the precision of files.
  void
  check_round_trip(const std::string              &name,
                   const Text                     &text,
                   const std::vector<std::string> &bodies,
                   const std::string              &fields,
                   const double                    tolerance)
  {
    run(text.with("Output", {"Fields = " + fields, "Grid fields = false"}),
        "first");
    Simulated<2> first(text);
    first.run();
    first->finish(); // as written
    const auto end   = first->statistics();
    Text       again = text;
    for (unsigned int b = 0; b < bodies.size(); ++b)
      {
        const std::string file = "points_" + std::to_string(b) + ".csv";
        write_csv("first/files/points_0001.vtu", file, b);
        again.add("Body " + bodies[b],
                  {"Shape =", "Velocity =", "Points file = " + file});
      }
    Simulated<2> second(again);
    const auto   begin = second->statistics();
    double       worst = std::abs(begin.mass / end.mass - 1.) +
                   std::abs(begin.kinetic / end.kinetic - 1.) +
                   (begin.momentum - end.momentum).norm() /
                     std::sqrt(end.mass * end.kinetic) +
                   (begin.center - end.center).norm();
    check(name + ": mass, velocities, places", worst, 1e-5);
    check(name + ": strain energy",
          std::abs(begin.strain / end.strain - 1.),
          tolerance);
    check(name + ": points", begin.n_points == end.n_points);
    if (std::getenv("SHOW"))
      print() << name << ' ' << begin.strain / end.strain - 1. << std::endl;
    // And it runs.
    second->step();
  }
} // namespace



void
test_main()
{
  check_grid_and_surfaces("USL");
  check_grid_and_surfaces("newmark");
  check_numbers_of_surfaces();

  const Text disks = block_2d("ball(0.3, 0.5, 0.19)", 16)
                       .with("Simulation", {"Bodies = body, other"})
                       .with("Body body", {"Velocity = 3; 0.1"})
                       .with("Body other",
                             {"Material = solid",
                              "Shape = ball(0.75, 0.5, 0.19)",
                              "Velocity = -2; 0"})
                       .with("Time", {"End = 0.05"});
  const std::string basic = "velocity, stress, body, density, mass";
  check_round_trip(
    "linear elastic", disks, {"body", "other"}, basic + ", volume", 1e-4);
  check_round_trip("neo-Hookean",
                   disks.with("Material solid", {"Model = neo-hookean"}),
                   {"body", "other"},
                   basic + ", F, J, displacement",
                   1e-4);
  check_round_trip("von Mises",
                   disks.with("Material solid",
                              {"Model = von-mises", "Yield stress = 2"}),
                   {"body", "other"},
                   basic + ", F, J, history",
                   1e-3);
  check_round_trip("water",
                   Text()
                     .add("Simulation", {"Bodies = body", "Materials = water"})
                     .add("Grid", {"Cells = 8, 8"})
                     .add("Body body",
                          {"Material = water", "Shape = box(0, 0, 0.5, 0.5)"})
                     .add("Material water",
                          {"Model = newtonian-fluid",
                           "Density = 1",
                           "Sound speed = 10",
                           "Viscosity = 0.1"})
                     .add("Loads", {"Gravity = 0; -1"})
                     .add("Walls", {"Left = sliding", "Bottom = sliding"})
                     .add("Time", {"End = 0.1"}),
                   {"body"},
                   basic + ", J",
                   1e-2);
}
