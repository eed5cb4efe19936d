// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/config.h>
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <greville/base/csv.h>
#include <greville/base/errors.h>
#include <greville/particles/points_file.h>

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/join.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <zlib.h>

#ifdef DEAL_II_WITH_CGAL
#  include <CGAL/IO/read_ply_points.h>
#  include <CGAL/property_map.h>
#endif

namespace greville
{
  using namespace dealii;

  namespace
  {
    using Tree = boost::property_tree::ptree;
    using HeaderAction =
      std::function<void(const std::vector<std::string> &names,
                         const std::string              &where,
                         const std::string              &text)>;
    using RowAction = std::function<void(const PointRow &)>;

    // What messages say of a file that is cut off.
    const char *const too_short = "it ends before its data do";



    std::string
    content_of(const std::string &file, const std::string &of)
    {
      const bool    is_folder = std::filesystem::is_directory(file);
      std::ifstream stream(file, std::ios::binary);
      AssertThrow(stream && !is_folder,
                  ExcMessage("Cannot read the file " + of +
                             (is_folder ? ": it is a folder." : ".")));
      return {std::istreambuf_iterator<char>(stream), {}};
    }



    /**
     * Columns of numbers, one after the other.
     */
    void
    visit_columns(const std::vector<std::string>         &names,
                  const std::vector<std::vector<double>> &columns,
                  const std::string                      &of,
                  const HeaderAction                     &header,
                  const RowAction                        &row)
    {
      header(names, of + ": ", boost::algorithm::join(names, ", "));
      const std::size_t n = columns.empty() ? 0 : columns[0].size();
      PointRow          point;
      std::size_t       k = 0;
      point.number        = [&](const unsigned int column) {
        const double value = columns[column][k];
        AssertThrow(std::isfinite(value),
                    ExcMessage(point.where + "no finite number for '" +
                               names[column] + "'."));
        return value;
      };
      for (; k < n; ++k)
        {
          point.where = of + ", point " + std::to_string(k) + ": ";
          point.text.clear();
          for (unsigned int c = 0; c < std::min<std::size_t>(4, columns.size());
               ++c)
            point.text += (c > 0 ? ", " : "") + text_of(columns[c][k]);
          row(point);
        }
    }



    /**
     * The columns of an array with several components.
     */
    std::vector<std::string>
    component_names(const std::string &name, const unsigned int n)
    {
      static const std::vector<std::string> of_vectors   = {"x", "y", "z"},
                                            of_symmetric = {"xx",
                                                            "yy",
                                                            "zz",
                                                            "xy",
                                                            "yz",
                                                            "xz"};
      std::vector<std::string> result;
      for (unsigned int k = 0; k < n; ++k)
        if (n == 1)
          result.push_back(name);
        else if (n <= 3)
          result.push_back(name + "_" + of_vectors[k]);
        else if (n == 6)
          result.push_back(name + "_" + of_symmetric[k]);
        else if (n == 9)
          result.push_back(name + "_" + of_vectors[k / 3] + of_vectors[k % 3]);
        else
          result.push_back(name + "_" + std::to_string(k));
      return result;
    }



    /**
     * A file of VTK's XML formats: numbers of its arrays.
     */
    class VtkFile
    {
    public:
      VtkFile(const std::string &text, const std::string &of)
        : of(of)
      {
        // Appended data may be binary, which no reader of XML takes.
        const std::string tag   = "<AppendedData";
        const std::size_t begin = text.find(tag);
        std::string       xml   = text.substr(0, begin);
        if (begin != std::string::npos)
          {
            const std::size_t end   = text.find('>', begin);
            const std::size_t first = text.find('_', end);
            fail_if(end == std::string::npos || first == std::string::npos,
                    too_short);
            is_raw = text.substr(begin, end - begin).find("\"raw\"") !=
                     std::string::npos;
            appended = text.substr(first + 1);
            if (!is_raw)
              appended.resize(std::min(appended.find('<'), appended.size()));
            xml += "</VTKFile>";
          }
        try
          {
            std::istringstream stream(xml);
            boost::property_tree::read_xml(stream, tree);
          }
        catch (const std::exception &error)
          {
            fail_if(true, std::string("it is no XML: ") + error.what());
          }
        const auto root = tree.get_child_optional("VTKFile");
        fail_if(!root, "it has no element 'VTKFile'");
        type = root->get("<xmlattr>.type", "");
        fail_if(root->get("<xmlattr>.byte_order", "LittleEndian") !=
                  "LittleEndian",
                "its byte order is not LittleEndian");
        const std::string compressor = root->get("<xmlattr>.compressor", "");
        fail_if(!compressor.empty() && compressor != "vtkZLibDataCompressor",
                "it is compressed by " + compressor +
                  ", not by vtkZLibDataCompressor or not at all");
        is_compressed = !compressor.empty();
        header_size =
          root->get("<xmlattr>.header_type", "UInt32") == "UInt64" ? 8 : 4;
        const auto data = root->get_child_optional(type);
        fail_if(!data, "it has no element '" + type + "'");
        pieces_of = &*data;
      }

      std::string type;
      const Tree *pieces_of = nullptr;

      void
      fail_if(const bool wrong, const std::string &why) const
      {
        AssertThrow(!wrong, ExcMessage("Cannot read " + of + ": " + why + "."));
      }

      /**
       * The numbers of an array with so many components at @p n points.
       */
      std::vector<double>
      numbers(const Tree       &array,
              const std::size_t n,
              const std::size_t n_components) const
      {
        const std::string   name   = array.get("<xmlattr>.Name", "Points");
        const std::string   format = array.get("<xmlattr>.format", "ascii");
        std::vector<double> result;
        if (format == "ascii")
          {
            std::istringstream stream(array.data());
            for (std::string word; stream >> word;)
              try
                {
                  result.push_back(std::stod(word));
                }
              catch (const std::exception &)
                {
                  fail_if(true,
                          "the array '" + name + "' has <" + word +
                            ">, which is not a number");
                }
          }
        else if (format == "binary" || format == "appended")
          result = decode(bytes_of(array, format == "appended"),
                          array.get("<xmlattr>.type", ""),
                          name);
        else
          fail_if(true,
                  "the format of the array '" + name + "' is <" + format +
                    ">, none of ascii, binary, appended");
        // Not the product with n, which may have more than 64 bits.
        fail_if(n_components == 0 || result.size() % n_components > 0 ||
                  result.size() / n_components != n,
                "the array '" + name + "' has " +
                  std::to_string(result.size()) + " numbers, not " +
                  (n_components == 1
                     ? std::to_string(n)
                     : std::to_string(n_components) + " at each of " +
                         std::to_string(n) + " points"));
        return result;
      }

    private:
      using Bytes = std::vector<unsigned char>;

      std::uint64_t
      header_number(const unsigned char *const begin) const
      {
        std::uint64_t result = 0;
        std::memcpy(&result, begin, header_size); // little-endian
        return result;
      }

      /**
       * Base64 text, of several parts that each end with their padding.
       */
      Bytes
      decode_text(const std::string &text) const
      {
        Bytes       result;
        std::string part;
        const auto  flush = [&]() {
          if (part.empty())
            return;
          try
            {
              const Bytes bytes = Utilities::decode_base64(part);
              result.insert(result.end(), bytes.begin(), bytes.end());
            }
          catch (const std::exception &)
            {
              fail_if(true, "its data are not in base64");
            }
          part.clear();
        };
        for (const char c : text)
          {
            if (std::isspace(static_cast<unsigned char>(c)))
              continue;
            if (c != '=' && !part.empty() && part.back() == '=')
              flush();
            part += c;
          }
        flush();
        return result;
      }

      /**
       * The data of an array, not compressed.
       */
      Bytes
      bytes_of(const Tree &array, const bool is_appended) const
      {
        Bytes bytes;
        if (!is_appended)
          bytes = decode_text(array.data());
        else
          {
            const std::size_t offset = array.get("<xmlattr>.offset", 0ul);
            fail_if(offset >= appended.size(), too_short);
            if (is_raw)
              bytes.assign(appended.begin() + offset, appended.end());
            else
              bytes = decode_text(appended.substr(offset, end_of(offset)));
          }
        fail_if(bytes.size() < header_size, too_short);
        if (!is_compressed)
          {
            const std::uint64_t n = header_number(bytes.data());
            fail_if(n > bytes.size() - header_size, too_short);
            return {bytes.begin() + header_size,
                    bytes.begin() + header_size + n};
          }
        // Number of blocks, their size, that of the last one if it differs,
        // and their sizes when compressed.
        const std::uint64_t n_blocks = header_number(bytes.data());
        if (n_blocks == 0)
          return {};
        fail_if(n_blocks > bytes.size() / header_size ||
                  bytes.size() < (3 + n_blocks) * header_size,
                too_short);
        const auto entry = [&](const std::size_t k) {
          return header_number(bytes.data() + k * header_size);
        };
        Bytes       result;
        std::size_t at = (3 + n_blocks) * header_size;
        for (std::uint64_t b = 0; b < n_blocks; ++b)
          {
            const std::uint64_t packed = entry(3 + b);
            const std::uint64_t whole =
              b + 1 == n_blocks && entry(2) > 0 ? entry(2) : entry(1);
            // Deflate packs to a thousandth at best.
            fail_if(packed > bytes.size() - at || whole / 1100 > packed + 1,
                    too_short);
            uLongf            size  = whole;
            const std::size_t begin = result.size();
            result.resize(begin + whole);
            fail_if(uncompress(result.data() + begin,
                               &size,
                               bytes.data() + at,
                               packed) != Z_OK ||
                      size != whole,
                    "its compressed data are damaged");
            at += packed;
          }
        return result;
      }

      /**
       * The length of what is appended in base64 from an offset on.
       */
      std::size_t
      end_of(const std::size_t offset) const
      {
        std::size_t                             next  = appended.size();
        const std::function<void(const Tree &)> visit = [&](const Tree &node) {
          for (const auto &child : node)
            {
              const std::size_t other =
                child.second.get("<xmlattr>.offset", 0ul);
              if (other > offset)
                next = std::min(next, other);
              visit(child.second);
            }
        };
        visit(tree);
        return next - offset;
      }

      template <typename T>
      static std::vector<double>
      convert(const Bytes &bytes)
      {
        std::vector<double> result(bytes.size() / sizeof(T));
        for (std::size_t k = 0; k < result.size(); ++k)
          {
            T value;
            std::memcpy(&value, bytes.data() + k * sizeof(T), sizeof(T));
            result[k] = double(value);
          }
        return result;
      }

      std::vector<double>
      decode(const Bytes       &bytes,
             const std::string &number,
             const std::string &name) const
      {
        if (number == "Float64")
          return convert<double>(bytes);
        if (number == "Float32")
          return convert<float>(bytes);
        if (number == "Int8")
          return convert<std::int8_t>(bytes);
        if (number == "UInt8")
          return convert<std::uint8_t>(bytes);
        if (number == "Int16")
          return convert<std::int16_t>(bytes);
        if (number == "UInt16")
          return convert<std::uint16_t>(bytes);
        if (number == "Int32")
          return convert<std::int32_t>(bytes);
        if (number == "UInt32")
          return convert<std::uint32_t>(bytes);
        if (number == "Int64")
          return convert<std::int64_t>(bytes);
        if (number == "UInt64")
          return convert<std::uint64_t>(bytes);
        fail_if(true,
                "the numbers of the array '" + name + "' are of the type <" +
                  number + ">");
        return {};
      }

      const std::string of;
      Tree              tree;
      std::string       appended;
      bool              is_raw = false, is_compressed = false;
      std::size_t       header_size = 4;
    };



    void
    read_vtk(const std::string  &file,
             const std::string  &of,
             const bool          is_piece,
             const HeaderAction &header,
             const RowAction    &row)
    {
      const VtkFile     vtk(content_of(file, of), of);
      const std::string pieces = "the file " + of;
      vtk.fail_if(vtk.type != "UnstructuredGrid" && vtk.type != "PolyData" &&
                    vtk.type != "PUnstructuredGrid" && vtk.type != "PPolyData",
                  "its type is <" + vtk.type +
                    ">, neither UnstructuredGrid nor PolyData");
      const bool has_files = vtk.type[0] == 'P' && vtk.type != "PolyData";
      // It may be its own piece.
      vtk.fail_if(is_piece && has_files, "it is a piece that has pieces");
      for (const auto &child : *vtk.pieces_of)
        {
          if (child.first != "Piece")
            continue;
          const Tree &piece = child.second;
          if (has_files)
            {
              const auto source = std::filesystem::path(file).parent_path() /
                                  piece.get("<xmlattr>.Source", "");
              read_vtk(source.string(),
                       "<" + source.string() + ">, a piece of " + of,
                       true,
                       header,
                       row);
              continue;
            }
          const std::size_t n = piece.get("<xmlattr>.NumberOfPoints", 0ul);
          if (n == 0)
            continue;
          std::vector<std::string>         names;
          std::vector<std::vector<double>> columns;
          const auto                       add = [&](const Tree                     &array,
                               const std::vector<std::string> &components) {
            const auto values = vtk.numbers(array, n, components.size());
            for (std::size_t c = 0; c < components.size(); ++c)
              {
                names.push_back(components[c]);
                columns.emplace_back(n);
                for (std::size_t k = 0; k < n; ++k)
                  columns.back()[k] = values[k * components.size() + c];
              }
          };
          const auto points = piece.get_child_optional("Points.DataArray");
          vtk.fail_if(!points, "it has no points");
          add(*points, {"x", "y", "z"});
          if (const auto data = piece.get_child_optional("PointData"))
            for (const auto &array : *data)
              if (array.first == "DataArray" &&
                  array.second.get("<xmlattr>.type", "") != "String")
                {
                  const std::string name =
                    array.second.get("<xmlattr>.Name", "");
                  const unsigned int n_components =
                    array.second.get("<xmlattr>.NumberOfComponents", 1u);
                  vtk.fail_if(n_components > 1000,
                              "the array '" + name + "' has " +
                                std::to_string(n_components) +
                                " components, more than 1000");
                  add(array.second, component_names(name, n_components));
                }
          visit_columns(names, columns, of, header, row);
        }
    }



#ifdef DEAL_II_WITH_CGAL
    void
    read_ply(const std::string  &file,
             const std::string  &of,
             const HeaderAction &header,
             const RowAction    &row)
    {
      const std::string  text = content_of(file, of);
      std::istringstream stream(text);
      const auto fail_if = [&](const bool wrong, const std::string &why) {
        AssertThrow(!wrong,
                    ExcMessage("Cannot read the file " + of + ": " + why +
                               "."));
      };
      std::string line, word, kind, name, element;
      fail_if(!std::getline(stream, line) || line.compare(0, 3, "ply") != 0,
              "it does not begin with 'ply'");
      std::size_t              n = 0;
      std::vector<std::string> names;
      while (std::getline(stream, line) && line.compare(0, 10, "end_header"))
        {
          std::istringstream words(line);
          words >> word;
          if (word == "element")
            {
              std::size_t count = 0;
              words >> element >> count;
              if (element == "vertex")
                n = count;
            }
          else if (word == "property" && element == "vertex")
            {
              words >> kind >> name;
              if (kind == "float" || kind == "double" || kind == "float32" ||
                  kind == "float64")
                names.push_back(name);
            }
        }
      fail_if(!stream, "its header has no end");
      std::vector<std::vector<double>> columns;
      for (const std::string &property : names)
        {
          stream.clear();
          stream.seekg(0);
          columns.emplace_back();
          const bool is_read = CGAL::IO::read_PLY_with_properties<double>(
            stream,
            std::back_inserter(columns.back()),
            std::make_pair(CGAL::Identity_property_map<double>(),
                           CGAL::PLY_property<double>(property.c_str())));
          fail_if(!is_read || columns.back().size() != n, too_short);
        }
      visit_columns(names, columns, of, header, row);
    }
#else
    void
    read_ply(const std::string &,
             const std::string &of,
             const HeaderAction &,
             const RowAction &)
    {
      AssertThrow(false,
                  ExcMessage("Cannot read the file " + of +
                             ": deal.II was built without CGAL."));
    }
#endif



    void
    read_table(const std::string  &file,
               const std::string  &parameter,
               const HeaderAction &header,
               const RowAction    &row)
    {
      std::vector<std::string> names;
      PointRow                 point;
      const CsvLine           *now = nullptr;
      point.number                 = [&](const unsigned int column) {
        return now->number(column, names[column]);
      };
      read_csv(file, parameter, [&](const CsvLine &line) {
        if (line.is_header)
          {
            names = line.words;
            header(names, line.where, line.text);
            return;
          }
        now         = &line;
        point.where = line.where;
        point.text  = line.text;
        row(point);
      });
    }
  } // namespace



  void
  read_point_rows(const std::string  &file,
                  const std::string  &parameter,
                  const HeaderAction &header,
                  const RowAction    &row)
  {
    const std::string of =
      "<" + file + "> of the parameter '" + parameter + "'";
    const std::string ending = boost::algorithm::to_lower_copy(
      std::filesystem::path(file).extension().string());
    const auto is = [&](const std::vector<std::string> &endings) {
      return std::find(endings.begin(), endings.end(), ending) != endings.end();
    };
    std::size_t n     = 0;
    const auto  count = [&](const PointRow &point) {
      ++n;
      row(point);
    };
    if (is({"", ".csv", ".txt", ".dat"}))
      {
        read_table(file, parameter, header, row);
        return;
      }
    if (is({".vtu", ".vtp", ".pvtu", ".pvtp"}))
      read_vtk(file, of, false, header, count);
    else if (is({".ply"}))
      read_ply(file, of, header, count);
    else
      AssertThrow(false,
                  ExcMessage("The file " + of + " ends with <" + ending +
                             ">. Points come as CSV (.csv, .txt, .dat), as "
                             "VTK's .vtu, .vtp, .pvtu, .pvtp, or as .ply."));
    AssertThrow(n > 0, ExcMessage("The file " + of + " has no points."));
  }
} // namespace greville
