// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <greville/base/errors.h>
#include <greville/base/json.h>
#include <greville/base/parameter_tree.h>
#include <greville/base/text_file.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

namespace greville
{
  using namespace dealii;

  namespace
  {
    using Tree = boost::property_tree::ptree;



    bool
    is_xml(const std::string &file)
    {
      return std::filesystem::path(file).extension() == ".xml";
    }



    bool
    is_list(const Tree &tree)
    {
      return !tree.empty() &&
             std::all_of(tree.begin(), tree.end(), [](const auto &child) {
               return child.first.empty();
             });
    }



    /// Return a value, or the value equivalent to a list.
    std::string
    value_of(const Tree &tree)
    {
      if (!is_list(tree))
        return Utilities::trim(tree.data());
      std::vector<std::string> parts;
      bool                     is_nested = false;
      for (const auto &child : tree)
        {
          parts.push_back(value_of(child.second));
          is_nested = is_nested || is_list(child.second);
        }
      return boost::algorithm::join(parts, is_nested ? "; " : ", ");
    }



    /// Return whether this is a parameter as ParameterHandler describes it.
    bool
    is_described(const Tree &tree)
    {
      return tree.find("value") != tree.not_found() &&
             tree.find("default_value") != tree.not_found();
    }



    bool
    has_descriptions(const Tree &tree)
    {
      return is_described(tree) ||
             std::any_of(tree.begin(), tree.end(), [](const auto &child) {
               return has_descriptions(child.second);
             });
    }



    /// "Box_20size" becomes "Box size".
    std::string
    demangle(const std::string &name)
    {
      std::string result;
      for (std::size_t i = 0; i < name.size(); ++i)
        if (name[i] == '_' && i + 2 < name.size() &&
            std::isxdigit(name[i + 1]) && std::isxdigit(name[i + 2]))
          {
            result += char(std::stoi(name.substr(i + 1, 2), nullptr, 16));
            i += 2;
          }
        else
          result += name[i];
      return result;
    }



    class Lines
    {
    public:
      /// Lines of the JSON @p text are found by the names in it.
      Lines(const std::string &file,
            const std::string &text,
            const bool         is_mangled,
            const bool         splits_names)
        : place("<" + file + ">")
        , text(text)
        , is_mangled(is_mangled)
        , splits_names(splits_names)
      {}

      void
      add(const Tree &tree, const std::vector<std::string> &sections)
      {
        for (const auto &child : tree)
          {
            if (child.first == "<xmlattr>" || child.first == "<xmlcomment>")
              continue;
            std::vector<std::string> path = sections;
            std::string              name = child.first;
            if (is_mangled)
              name = demangle(name);
            if (splits_names)
              for (auto slash = name.find('/'); slash != std::string::npos;
                   slash      = name.find('/'))
                {
                       enter(path, Utilities::trim(name.substr(0, slash)));
                       name = name.substr(slash + 1);
                }
            name = Utilities::trim(name);
            Require(!name.empty(),
                    place + ": a section or a parameter has no name.");
            if (is_described(child.second))
              add_line(path, name, child.second.get<std::string>("value"));
            else if (child.second.empty() || is_list(child.second))
              add_line(path, name, value_of(child.second));
            else
              {
                enter(path, name);
                add(child.second, path);
              }
          }
      }

      std::vector<ParameterLine> result;

    private:
      void
      enter(std::vector<std::string> &path, const std::string &section)
      {
        path.push_back(section);
        // A section is known from its lines, so an empty one needs an entry,
        // too.
        result.push_back(
          {boost::algorithm::join(path, "/"), "", "", place, path, false});
      }

      void
      add_line(const std::vector<std::string> &path,
               const std::string              &name,
               const std::string              &value)
      {
        const std::string section = boost::algorithm::join(path, "/");
        Require(value.find_first_of("#\n") == std::string::npos,
                place + ": the parameter '" + section + "/" + name + "' is <" +
                  value + ">; a value cannot contain '#' or a line break.");
        Require(given.insert(section + "/" + name).second,
                place + ": the parameter '" + section + "/" + name +
                  "' is given twice" + lines_with(name) + ".");
        result.push_back(
          {section, name, Utilities::trim(value), place, path, false});
      }

      /// Return " (lines with this name: 3, 9)"; empty for XML, whose names are
      /// mangled.
      std::string
      lines_with(const std::string &name) const
      {
        std::string        found;
        std::istringstream in(text);
        unsigned int       number = 1;
        for (std::string line; !is_mangled && std::getline(in, line); ++number)
          if (line.find(name + '"') != std::string::npos)
            found += (found.empty() ? "" : ", ") + std::to_string(number);
        return found.empty() ? "" : " (lines with this name: " + found + ")";
      }

      const std::string     place, text;
      std::set<std::string> given;
      const bool            is_mangled, splits_names;
    };



    /// Return the section of a path, which is made if it does not exist.
    Tree &
    section_of(Tree &tree, const std::vector<std::string> &path)
    {
      Tree *section = &tree;
      for (const std::string &name : path)
        {
          const auto found = section->find(name);
          section          = found != section->not_found()
                               ? &found->second
                               : &section->push_back({name, Tree()})->second;
        }
      return *section;
    }



    void
    write_tree(std::ostream &out, const Tree &tree, const std::string &indent)
    {
      static const std::regex plain(
        R"(true|false|-?(0|[1-9]\d*)(\.\d+)?([eE][+-]?\d+)?)");
      if (tree.empty())
        {
          if (std::regex_match(tree.data(), plain))
            out << tree.data();
          else
            JsonWriter::write(out, tree.data());
          return;
        }
      const char *separator = "{\n";
      for (const auto &child : tree)
        {
          out << separator << indent << "  ";
          JsonWriter::write(out, child.first);
          out << ": ";
          write_tree(out, child.second, indent + "  ");
          separator = ",\n";
        }
      out << '\n' << indent << '}';
    }
  } // namespace



  Tree
  tree_of(const ParameterHandler &prm)
  {
    std::stringstream json;
    prm.print_parameters(json, ParameterHandler::JSON);
    Tree tree;
    boost::property_tree::read_json(json, tree);
    return tree;
  }



  void
  for_each_parameter(const ParameterHandler                  &prm,
                     const std::function<void(const std::vector<std::string> &,
                                              const std::string &,
                                              const Tree &)> &visit)
  {
    std::vector<std::string>                path;
    const std::function<void(const Tree &)> walk = [&](const Tree &tree) {
      for (const auto &[name, entry] : tree)
        if (entry.find("value") != entry.not_found())
          visit(path, name, entry);
        else
          {
            path.push_back(name);
            walk(entry);
            path.pop_back();
          }
    };
    walk(tree_of(prm));
  }



  bool
  is_parameter_tree(const std::string &file)
  {
    return is_xml(file) || std::filesystem::path(file).extension() == ".json";
  }



  std::vector<ParameterLine>
  parameter_lines_of_tree(std::istream &stream, const std::string &file)
  {
    std::string  text;
    unsigned int number = 0;
    for (std::string line; read_text_line(stream, line, number);)
      {
        check_utf8(line,
                   "Line " + std::to_string(number) + " of <" + file + ">");
        text += line + '\n';
      }
    std::istringstream in(text);
    Tree               tree;
    try
      {
        if (is_xml(file))
          boost::property_tree::read_xml(in, tree);
        else
          boost::property_tree::read_json(in, tree);
      }
    catch (const boost::property_tree::file_parser_error &error)
      {
        Require(false,
                "Line " + std::to_string(error.line()) + " of <" + file +
                  (is_xml(file) ? "> is not valid XML: "
                                : "> is not valid JSON: ") +
                  error.message() + ".");
      }
    if (is_xml(file))
      {
        const auto root = tree.find("ParameterHandler");
        Require(root != tree.not_found(),
                "<" + file +
                  "> has no element 'ParameterHandler', which greville "
                  "FILE.prm --print-parameters xml writes.");
        const Tree inner = root->second;
        tree             = inner;
      }
    Require(!tree.empty() && !is_list(tree), "<" + file + "> has no sections.");
    Lines lines(file,
                text,
                is_xml(file),
                !is_xml(file) && !has_descriptions(tree));
    lines.add(tree, {});
    return lines.result;
  }



  void
  write_as_json(std::ostream &out, const std::string &text)
  {
    Tree tree;
    for (const ParameterLine &line : parameter_lines_of(text, ""))
      {
        Tree &section = section_of(tree, line.path);
        if (!line.name.empty())
          section.push_back({line.name, Tree(line.value)});
      }
    write_tree(out, tree, "");
    out << '\n';
  }
} // namespace greville
