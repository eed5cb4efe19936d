// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/config.h>
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <greville/base/csv.h>
#include <greville/base/errors.h>
#include <greville/geometry/surface_shape.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/case_conv.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#ifdef DEAL_II_WITH_ASSIMP
#  include <assimp/Importer.hpp>
#  include <assimp/postprocess.h>
#  include <assimp/scene.h>
#endif

namespace greville
{
  using namespace dealii;

  namespace
  {
    using Triangle = std::array<unsigned int, 3>;

    /// A mesh given by distinct points and the numbers of its corners.
    struct Mesh
    {
      std::vector<Point<3>> points;
      std::vector<Triangle> triangles;
    };



#ifdef DEAL_II_WITH_ASSIMP
    /// Throw if a PLY file is shorter than its header says: Assimp would not
    /// return.
    void
    check_ply(const std::string &file, const std::string &of)
    {
      const auto size_of = [](const std::string &type) {
        const auto is_in = [&](const std::string &types) {
          return contains(Utilities::split_string_list(types), type);
        };
        return is_in("char, int8, uchar, uint8")                   ? 1
               : is_in("short, int16, ushort, uint16")             ? 2
               : is_in("int, int32, uint, uint32, float, float32") ? 4
               : is_in("double, float64")                          ? 8
                                                                   : 0;
      };
      const auto fail_if = [&](const bool wrong, const std::string &why) {
        Require(!wrong, "Cannot read the file " + of + ": " + why + ".");
      };
      std::ifstream stream(file, std::ios::binary);
      std::string   line, word;
      fail_if(!std::getline(stream, line) || line.compare(0, 3, "ply") != 0,
              "it does not begin with 'ply'");
      bool is_ascii = false;
      // For each kind of elements, their number and the least number of bytes
      // of one element.
      std::vector<std::pair<std::uint64_t, std::uint64_t>> elements;
      while (std::getline(stream, line) && line.compare(0, 10, "end_header"))
        {
          std::istringstream words(line);
          words >> word;
          if (word == "format")
            is_ascii = words >> word && word == "ascii";
          else if (word == "element")
            {
              std::uint64_t n = 0;
              fail_if(!(words >> word >> n) || n > (std::uint64_t(1) << 40),
                      "its header has <" + line + ">");
              elements.emplace_back(n, 0);
            }
          else if (word == "property")
            {
              // A list begins with its length.
              words >> word;
              if (word == "list")
                words >> word;
              fail_if(elements.empty() || size_of(word) == 0,
                      "its header has <" + line + ">");
              elements.back().second += size_of(word);
            }
        }
      fail_if(!stream, "its header has no end");
      std::uint64_t wanted = 0, found = 0;
      for (const auto &[n, bytes] : elements)
        wanted += is_ascii ? n : n * bytes;
      if (is_ascii)
        while (found < wanted && std::getline(stream, line))
          found += line.find_first_not_of(" \t\r") != std::string::npos;
      else
        found = std::filesystem::file_size(file) - stream.tellg();
      fail_if(found < wanted,
              "it ends before its data do: its header promises " +
                std::to_string(wanted) + (is_ascii ? " lines" : " bytes") +
                " at least, and " + std::to_string(found) + " follow");
    }



    Mesh
    read_mesh(const std::string &file, const std::string &of, const double unit)
    {
      const std::string ending = boost::algorithm::to_lower_copy(
        std::filesystem::path(file).extension().string());
      if (ending == ".ply")
        check_ply(file, of);
      Assimp::Importer importer;
      const aiScene   *scene = importer.ReadFile(file, aiProcess_Triangulate);
      // Shorten Assimp's reason, which may quote the rest of the file.
      Require(scene != nullptr,
              "Cannot read the file " + of + ": " +
                (importer.IsExtensionSupported(ending)
                   ? "its ending " + ending +
                       " is wrong, or it is damaged. Does it open in another "
                       "program? The reader says: <" +
                       std::string(importer.GetErrorString()).substr(0, 80) +
                       ">"
                   : "it ends with <" + ending +
                       ">. Triangles come as STL, PLY or OBJ") +
                ".");
      Mesh                                         result;
      std::size_t                                  n_triangles = 0;
      std::map<std::array<float, 3>, unsigned int> numbers;
      for (unsigned int m = 0; m < scene->mNumMeshes; ++m)
        {
          const aiMesh &mesh = *scene->mMeshes[m];
          for (unsigned int f = 0; f < mesh.mNumFaces; ++f)
            if (mesh.mFaces[f].mNumIndices == 3)
              {
                Triangle triangle;
                for (unsigned int k = 0; k < 3; ++k)
                  {
                    const aiVector3D &x =
                      mesh.mVertices[mesh.mFaces[f].mIndices[k]];
                    Require(std::isfinite(x.x) && std::isfinite(x.y) &&
                              std::isfinite(x.z),
                            "In the file " + of + ", a vertex of triangle " +
                              std::to_string(n_triangles + 1) +
                              " is infinite or NaN.");
                    const auto found =
                      numbers.insert({{{x.x, x.y, x.z}},
                                      (unsigned int)(result.points.size())});
                    if (found.second)
                      result.points.emplace_back(unit * x.x,
                                                 unit * x.y,
                                                 unit * x.z);
                    triangle[k] = found.first->second;
                  }
                ++n_triangles;
                if (triangle[0] != triangle[1] && triangle[1] != triangle[2] &&
                    triangle[2] != triangle[0])
                  result.triangles.push_back(triangle);
              }
        }
      Require(!result.triangles.empty(),
              "The file " + of + " has no triangles.");
      return result;
    }
#else
    Mesh
    read_mesh(const std::string &, const std::string &of, const double)
    {
      Require(false,
              "Cannot read the file " + of +
                ": deal.II was built without Assimp.");
      return Mesh();
    }
#endif



    void
    check_closed(const Mesh &mesh, const std::string &of)
    {
      // Edges, with their smaller end first, and the numbers of times that they
      // are passed in this direction and in the opposite one.
      std::map<std::pair<unsigned int, unsigned int>, std::array<int, 2>> edges;
      double volume = 0.;
      for (const Triangle &triangle : mesh.triangles)
        {
          for (unsigned int k = 0; k < 3; ++k)
            {
              const unsigned int a = triangle[k], b = triangle[(k + 1) % 3];
              ++edges[{std::min(a, b), std::max(a, b)}][a < b ? 0 : 1];
            }
          volume += mesh.points[triangle[0]] *
                    cross_product_3d(mesh.points[triangle[1]],
                                     mesh.points[triangle[2]]) /
                    6.;
        }
      for (const auto &edge : edges)
        {
          const auto       &count = edge.second;
          const std::string from =
            " from (" + text_of(mesh.points[edge.first.first]) + ") to (" +
            text_of(mesh.points[edge.first.second]) + ") m";
          Require((count[0] + count[1]) % 2 == 0,
                  "The surface in " + of + " is not closed: the edge" + from +
                    " belongs to " + std::to_string(count[0] + count[1]) +
                    " triangle(s).");
          Require(count[0] == count[1],
                  "The triangles in " + of + " at the edge" + from +
                    " have normals that point to different sides. All have to "
                    "point outwards.");
        }
      Require(volume > 0.,
              "The normals of the triangles in " + of +
                " point inwards. They have to point outwards.");
    }



    /// Return twice the area, positive if corners are counterclockwise.
    double
    signed_area(const std::vector<Point<2>> &loop)
    {
      double sum = 0.;
      for (std::size_t i = 0; i < loop.size(); ++i)
        {
          const auto a = loop[i] - loop[0];
          const auto b = loop[(i + 1) % loop.size()] - loop[0];
          sum += a[0] * b[1] - a[1] * b[0];
        }
      return sum;
    }

    bool
    is_in(const Point<2> &x, const std::vector<Point<2>> &loop)
    {
      bool result = false;
      for (std::size_t i = 0; i < loop.size(); ++i)
        {
          const auto &a = loop[i], &b = loop[(i + 1) % loop.size()];
          if ((a[1] <= x[1]) != (b[1] <= x[1]) &&
              a[0] + (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1]) > x[0])
            result = !result;
        }
      return result;
    }



    void
    check_readable(const std::string &file, const std::string &of)
    {
      std::error_code none;
      Require(std::filesystem::exists(file, none),
              "There is no file " + of + ".");
      Require(std::ifstream(file), "Cannot read the file " + of + ".");
    }
  } // namespace



  template <>
  ClosedSurface<3>
  read_surface<3>(const std::string &file,
                  const std::string &parameter,
                  const double       unit)
  {
    const std::string of =
      "<" + file + "> of the parameter '" + parameter + "'";
    check_readable(file, of);
    const Mesh mesh = read_mesh(file, of, unit);
    check_closed(mesh, of);
    ClosedSurface<3> result;
    for (const Triangle &triangle : mesh.triangles)
      {
        const Facet<3> facet = {mesh.points[triangle[0]],
                                mesh.points[triangle[1]],
                                mesh.points[triangle[2]]};
        // Triangles without area have no normal.
        if (cross_product_3d(facet[1] - facet[0], facet[2] - facet[0]).norm() >
            0.)
          result.push_back(facet);
      }
    return result;
  }



  template <>
  ClosedSurface<2>
  read_surface<2>(const std::string &file,
                  const std::string &parameter,
                  const double       unit)
  {
    std::vector<std::vector<Point<2>>> loops;
    std::array<int, 3>                 columns = {{-1, -1, -1}};
    double                             last    = 0.;
    read_csv(file, parameter, [&](const CsvLine &line) {
      static const std::array<std::string, 3> names = {{"x", "y", "loop"}};
      if (line.is_header)
        {
          for (unsigned int k = 0; k < 3; ++k)
            {
              const auto found =
                std::find(line.words.begin(), line.words.end(), names[k]);
              if (found != line.words.end())
                columns[k] = found - line.words.begin();
              Require(k == 2 || columns[k] >= 0,
                      line.where + "there is no column '" + names[k] +
                        "' in <" + line.text +
                        ">. In 2D the surface of a body is a polygon: a CSV "
                        "file of its vertices.");
            }
          return;
        }
      const double loop =
        columns[2] < 0 ? 0. : line.number(columns[2], names[2]);
      if (loops.empty() || loop != last)
        loops.emplace_back();
      last = loop;
      const Point<2> x(unit * line.number(columns[0], names[0]),
                       unit * line.number(columns[1], names[1]));
      if (loops.back().empty() || loops.back().back() != x)
        loops.back().push_back(x);
    });

    ClosedSurface<2> result;
    for (auto &loop : loops)
      {
        if (loop.size() > 1 && loop.front() == loop.back())
          loop.pop_back();
        Require(loop.size() > 2 && signed_area(loop) != 0.,
                "A polygon in <" + file + "> of the parameter '" + parameter +
                  "' has no area: it has " + std::to_string(loop.size()) +
                  " vertices, the first one at (" + text_of(loop[0]) + ") m.");
      }
    for (const auto &loop : loops)
      {
        bool is_hole = false;
        for (const auto &other : loops)
          if (&other != &loop && is_in(loop[0], other))
            is_hole = !is_hole;
        auto ordered = loop;
        if ((signed_area(loop) < 0.) != is_hole)
          std::reverse(ordered.begin(), ordered.end());
        for (std::size_t i = 0; i < ordered.size(); ++i)
          result.push_back({ordered[i], ordered[(i + 1) % ordered.size()]});
      }
    return result;
  }
} // namespace greville
