// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks parameter files in JSON and XML, and included files. For refused input
// see tests/run/refusals.txt.
#include <greville/base/parameter_tree.h>

#include <filesystem>
#include <fstream>
#include <tests.h>

namespace
{
  std::string
  lines_of(const std::string &text, const std::string &file)
  {
    std::ofstream(file) << text;
    std::string result;
    try
      {
        for (const ParameterLine &line :
             read_parameter_lines(file, "Grid", {}, ""))
          if (!line.name.empty())
            result += line.section + "|" + line.name + "|" + line.value + "\n";
      }
    catch (const std::exception &error)
      {
        result += message_of(error) + "\n";
      }
    return result;
  }



  void
  show(const std::string &text, const std::string &file = "tree.json")
  {
    print() << lines_of(text, file) << std::endl;
  }
} // namespace



void
test_main()
{
  // Lists, lists of lists, numbers as they stand, sections by slashes, a byte
  // order mark.
  show("\xEF\xBB\xBF{\"Grid\": {\"Cells\": [4, 2.50], \"Order\": 3, \"Kind\": "
       "\"a b\"}, \"Stage one/Time/End\": 1e-3,\n \"Loads\": {\"Gravity\": "
       "[[0, 1], [2]], \"Empty\": \"\", \"Is\": true}}");
  show("{\"Grid\": {\"\": 3}}");

  // The output of ParameterHandler, and our output of the same parameters.
  ParameterHandler prm;
  unsigned int     order = 2;
  std::string      kind = "a \"b\" \\ c", number = "-1.5e+3", word = "01";
  prm.enter_subsection("Body one_two, three");
  add_parameter(prm, "The order", order)("Which it is.");
  add_parameter(prm, "Kind", kind)("Which it is.");
  prm.enter_subsection("Grid");
  add_parameter(prm, "Number", number)("Which it is.");
  add_parameter(prm, "Word", word)("Which it is.");
  prm.leave_subsection();
  prm.leave_subsection();
  std::ostringstream text, xml, json, ours;
  prm.print_parameters(text, ParameterHandler::PRM);
  prm.print_parameters(xml, ParameterHandler::XML);
  prm.print_parameters(json, ParameterHandler::JSON);
  write_as_json(ours, text.str());
  print() << ours.str();
  const std::string lines = lines_of(text.str(), "tree.prm");
  check("XML", lines_of(xml.str(), "tree.xml") == lines);
  check("JSON with descriptions", lines_of(json.str(), "tree.json") == lines);
  check("JSON", lines_of(ours.str(), "tree.json") == lines);

  // A file within a file, as seen from there, within a section.
  std::filesystem::remove_all("below");
  std::filesystem::create_directories("below");
  std::ofstream("below/part.prm")
    << "set Order = 4\nsubsection Inner\n  include more.prm\nend\n";
  std::ofstream("below/more.prm") << "set Kind = two\n";
  std::ofstream("below/all.prm") << "subsection Grid\nend\n";
  show(
    "include below/all.prm\nsubsection Grid\n  include below/part.prm\n  set "
    "Kind = one\nend\n",
    "outer.prm");
}
