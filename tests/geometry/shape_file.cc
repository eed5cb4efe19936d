// SPDX-License-Identifier: LGPL-2.1-or-later

// Checks bodies with a surface from a file: a torus and an icosphere as STL,
// PLY and OBJ, polygons as CSV; exact volumes and areas, lattice points, and
// refused input.

#include <greville/geometry/fitted_points.h>
#include <greville/geometry/surface_shape.h>

#include <fstream>
#include <functional>
#include <map>
#include <tests.h>

using Triangle = std::array<unsigned int, 3>;

struct Mesh
{
  std::vector<Point<3>> points;
  std::vector<Triangle> triangles;

  double
  volume() const
  {
    double sum = 0.;
    for (const Triangle &t : triangles)
      sum += points[t[0]] * cross_product_3d(points[t[1]], points[t[2]]) / 6.;
    return sum;
  }

  double
  area() const
  {
    double sum = 0.;
    for (const Triangle &t : triangles)
      sum += 0.5 * cross_product_3d(points[t[1]] - points[t[0]],
                                    points[t[2]] - points[t[0]])
                     .norm();
    return sum;
  }
};



// Coordinates that a file of floats keeps: 24 binary digits.
Point<3>
rounded(const Point<3> &x)
{
  Point<3> result;
  for (unsigned int d = 0; d < 3; ++d)
    {
      int          exponent = 0;
      const double fraction = std::frexp(x[d], &exponent);
      result[d] =
        std::ldexp(std::nearbyint(std::ldexp(fraction, 24)), exponent - 24);
    }
  return result;
}



// Around (0.5, 0.7, 1), the axis along z.
Mesh
make_torus(const double scale)
{
  Mesh               mesh;
  const unsigned int m = 24, n = 12;
  for (unsigned int i = 0; i < m; ++i)
    for (unsigned int j = 0; j < n; ++j)
      {
        const double a = 2. * numbers::PI * i / m, b = 2. * numbers::PI * j / n;
        const double r = 0.3 + 0.12 * std::cos(b);
        mesh.points.push_back(
          rounded(Point<3>(scale * (0.5 + r * std::cos(a)),
                           scale * (0.7 + r * std::sin(a)),
                           scale * (1. + 0.12 * std::sin(b)))));
        const auto at = [&](const unsigned int k, const unsigned int l) {
          return (i + k) % m * n + (j + l) % n;
        };
        mesh.triangles.push_back({{at(0, 0), at(1, 0), at(1, 1)}});
        mesh.triangles.push_back({{at(0, 0), at(1, 1), at(0, 1)}});
      }
  return mesh;
}



// A box whose faces lie in faces of cells.
Mesh
make_box()
{
  Mesh mesh;
  for (unsigned int k = 0; k < 8; ++k)
    mesh.points.push_back(
      Point<3>(k & 1 ? 0.75 : 0.25, k & 2 ? 0.75 : 0.375, k & 4 ? 1.5 : 0.5));
  for (const Triangle &t : {Triangle{{0, 2, 3}},
                            Triangle{{0, 3, 1}},
                            Triangle{{4, 5, 7}},
                            Triangle{{4, 7, 6}},
                            Triangle{{0, 1, 5}},
                            Triangle{{0, 5, 4}},
                            Triangle{{2, 6, 7}},
                            Triangle{{2, 7, 3}},
                            Triangle{{0, 4, 6}},
                            Triangle{{0, 6, 2}},
                            Triangle{{1, 3, 7}},
                            Triangle{{1, 7, 5}}})
    mesh.triangles.push_back(t);
  return mesh;
}



void
write_file(const std::string &file, const std::string &text)
{
  if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::ofstream(file) << text;
  MPI_Barrier(MPI_COMM_WORLD);
}



std::string
as_stl(const Mesh &mesh)
{
  std::ostringstream text;
  text << std::setprecision(9) << "solid body\n";
  for (const Triangle &t : mesh.triangles)
    {
      text << "facet normal 0 0 0\nouter loop\n";
      for (const unsigned int k : t)
        text << "vertex " << mesh.points[k] << "\n";
      text << "endloop\nendfacet\n";
    }
  text << "endsolid body\n";
  return text.str();
}



std::string
as_ply(const Mesh &mesh)
{
  std::ostringstream text;
  text << std::setprecision(9) << "ply\nformat ascii 1.0\nelement vertex "
       << mesh.points.size()
       << "\nproperty float x\nproperty float y\nproperty float z\n"
          "element face "
       << mesh.triangles.size()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto &x : mesh.points)
    text << x << "\n";
  for (const Triangle &t : mesh.triangles)
    text << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  return text.str();
}



std::string
as_obj(const Mesh &mesh)
{
  std::ostringstream text;
  text << std::setprecision(9);
  for (const auto &x : mesh.points)
    text << "v " << x << "\n";
  for (const Triangle &t : mesh.triangles)
    text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return text.str();
}



struct Sums
{
  double volume = 0., second = 0., area = 0., normal = 0., flux = 0.;
};

template <int dim>
Sums
integrate(const PointPlacement &placement, const MultiIndex<dim> &cells)
{
  Box<dim>                       box(cells);
  const SplineSpace<dim>         space(box.mesh, 2);
  std::vector<PlacedPoint<dim>>  points;
  std::vector<SurfacePoint<dim>> surface;
  run_on_all(MPI_COMM_WORLD, [&]() {
    points  = place_points(placement, "Body a", space);
    surface = place_surface_points(placement, "Body a", space);
  });
  Sums           sums;
  Tensor<1, dim> normal;
  bool           ok = true;
  for (const auto &point : points)
    {
      sums.volume += point.volume;
      sums.second += point.volume * point.x[0] * point.x[0];
      ok = ok && point.volume > 0. && space.find(point.x) == point.cell;
    }
  check("  points in their cells", ok);
  for (const auto &point : surface)
    {
      sums.area += point.area;
      normal += point.area * point.normal;
      // The flux of (x^3 / 3, 0), the divergence of which is x^2.
      sums.flux += point.area * point.normal[0] * std::pow(point.x[0], 3) / 3.;
    }
  for (double *sum : {&sums.volume, &sums.second, &sums.area, &sums.flux})
    *sum = Utilities::MPI::sum(*sum, MPI_COMM_WORLD);
  sums.normal = Utilities::MPI::sum(normal, MPI_COMM_WORLD).norm();
  return sums;
}



PointPlacement
from_file(const std::string &file, const double unit = 1.)
{
  PointPlacement placement;
  placement.shape_file           = file;
  placement.shape_file_unit      = unit;
  placement.points_per_direction = {2};
  placement.placement            = Placement::fitted;
  return placement;
}



void
check_sums(const std::string &what,
           const Sums        &sums,
           const double       volume,
           const double       area)
{
  print() << what << std::endl;
  // Triangles of a mesh of floats that are almost in one plane leave slivers.
  check("  volume", std::abs(sums.volume / volume - 1.), 3e-9);
  check("  area", std::abs(sums.area / area - 1.), 1e-11);
  check("  normals", sums.normal / area, 1e-11);
  // Points in faces of cells move into them by 1e-9.
  check("  second moment", std::abs(sums.flux / sums.second - 1.), 1e-8);
}



void
test_meshes()
{
  const Mesh torus = make_torus(1.);
  write_file("torus.stl", as_stl(torus));
  write_file("torus.ply", as_ply(torus));
  write_file("torus.obj", as_obj(torus));
  for (const std::string file : {"torus.stl", "torus.ply", "torus.obj"})
    check_sums(file,
               integrate<3>(from_file(file), {{7, 8, 9}}),
               torus.volume(),
               torus.area());
  check_sums("torus.stl, coarse",
             integrate<3>(from_file("torus.stl"), {{2, 3, 3}}),
             torus.volume(),
             torus.area());
  const Mesh large = make_torus(1000.);
  write_file("torus_mm.stl", as_stl(large));
  check_sums("torus_mm.stl",
             integrate<3>(from_file("torus_mm.stl", 1e-3), {{4, 8, 5}}),
             1e-9 * large.volume(),
             1e-6 * large.area());
  const Mesh box = make_box();
  write_file("box.obj", as_obj(box));
  for (const unsigned int n : {4, 3})
    check_sums("box.obj",
               integrate<3>(from_file("box.obj"), {{n, n, n}}),
               box.volume(),
               box.area());

  auto lattice                 = from_file("torus.stl");
  lattice.placement            = Placement::equidistant;
  lattice.points_per_direction = {4};
  check("  points of a lattice",
        std::abs(integrate<3>(lattice, {{10, 15, 20}}).volume / torus.volume() -
                 1.),
        0.01);
}



void
test_polygons()
{
  // A star in one sense, a square hole in the same.
  std::ostringstream text;
  text << std::setprecision(17) << "x, y, loop\n";
  double                area = 0., length = 0.;
  std::vector<Point<2>> star;
  for (unsigned int k = 0; k < 10; ++k)
    {
      const double r = k % 2 == 0 ? 0.45 : 0.3, a = numbers::PI / 5. * k;
      star.emplace_back(0.5 + r * std::cos(a), 0.75 + r * std::sin(a));
      text << star[k][0] << ", " << star[k][1] << ", 0\n";
    }
  for (unsigned int k = 0; k < 10; ++k)
    {
      const auto &a = star[k], &b = star[(k + 1) % 10];
      area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
      length += a.distance(b);
    }
  text << "0.4, 0.65, 1\n0.6, 0.65, 1\n0.6, 0.85, 1\n0.4, 0.85, 1\n"
          "0.4, 0.65, 1\n";
  write_file("star.csv", text.str());
  for (const unsigned int n : {3, 10, 20})
    check_sums("star.csv",
               integrate<2>(from_file("star.csv"), {{n, n}}),
               area - 0.04,
               length + 0.8);
}



template <int dim>
void
print_error(const PointPlacement &placement)
{
  std::string message = "nothing is wrong";
  try
    {
      integrate<dim>(placement, cube<dim>(4));
    }
  catch (const std::exception &error)
    {
      message = message_of(error);
      // Each process has its own.
      message = message.substr(0, message.find(", for instance"));
    }
  print() << "  " << message << std::endl;
}



void
test_errors()
{
  print() << "Errors" << std::endl;
  print_error<3>(from_file("missing.stl"));
  write_file("text.stl", "nothing\n");
  write_file("text.xyzzy", "nothing\n");
  print_error<3>(from_file("text.xyzzy"));
  const Mesh box = make_box();
  // Words for numbers, a vertex that is NaN, and files that end too soon.
  const std::string stl = as_stl(box), ply = as_ply(box);
  const auto        cut = stl.find("vertex ") + 7;
  const auto        end = stl.find(' ', cut);
  write_file("text.stl", stl.substr(0, cut) + "abc" + stl.substr(end));
  print_error<3>(from_file("text.stl"));
  write_file("text.stl", stl.substr(0, cut) + "nan" + stl.substr(end));
  print_error<3>(from_file("text.stl"));
  const auto header = ply.find("end_header\n") + 11;
  for (const std::size_t size :
       {std::size_t(3), header / 2, header, (header + ply.size()) / 2})
    {
      write_file("text.ply", ply.substr(0, size));
      print_error<3>(from_file("text.ply"));
    }
  std::string binary = ply.substr(0, header);
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  write_file("text.ply", binary + "1234");
  print_error<3>(from_file("text.ply"));
  Mesh open    = box;
  Mesh mixed   = box;
  Mesh inwards = box;
  open.triangles.pop_back();
  std::swap(mixed.triangles[3][0], mixed.triangles[3][1]);
  for (auto &triangle : inwards.triangles)
    std::swap(triangle[0], triangle[1]);
  write_file("wrong.obj", as_obj(open));
  print_error<3>(from_file("wrong.obj"));
  write_file("wrong.obj", as_obj(mixed));
  print_error<3>(from_file("wrong.obj"));
  write_file("wrong.obj", as_obj(inwards));
  print_error<3>(from_file("wrong.obj"));
  print_error<3>(from_file("box.obj", 0.001));
  print_error<3>(from_file("box.obj", 1000.));
  print_error<3>(from_file("box.obj", 2.));
  print_error<2>(from_file("box.obj"));
  write_file("wrong.csv", "x, y\n0.1, 0.2\n0.3, 0.4\n");
  print_error<2>(from_file("wrong.csv"));
  write_file("wrong.csv", "x, y\n0.1, 0.2\n0.3, a\n0.5, 0.5\n");
  print_error<2>(from_file("wrong.csv"));
}



void
test_main()
{
  test_meshes();
  test_polygons();
  test_errors();
}
