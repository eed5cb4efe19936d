// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks lines and settings of the command line, and the description of a
// parameter. For refused input see tests/run/refusals.txt.
#include <greville/base/parameters.h>

#include <fstream>
#include <tests.h>

namespace
{
  struct Parameters
  {
    void
    declare(ParameterHandler &prm)
    {
      add_parameter(prm, "Order", order, Patterns::Integer(1, 5))("The order.");
      add_parameter(prm, "Kind", kind, Patterns::Selection("one|two"))(
        "The kind.");
    }

    unsigned int order = 2;
    std::string  kind  = "one";
  };



  struct All
  {
    All(const std::string &text, const std::vector<std::string> &settings)
    {
      declare_section(prm, "Grid", grid);
      prm.enter_subsection("Body a/b");
      declare_section(prm, "Grid", inner);
      prm.leave_subsection();
      std::ofstream("names.prm") << text;
      parse_parameter_lines(
        prm, read_parameter_lines("names.prm", "Grid", {}, "", settings));
    }

    Parameters       grid, inner;
    ParameterHandler prm;
  };

  const std::string slashes =
    "subsection Body a/b\n  subsection Grid\n    set Order = 3\n  end\nend\n";



  std::string
  grid(const std::string &line)
  {
    return "subsection Grid\n  set " + line + "\nend\n";
  }



  void
  described(const std::string &what)
  {
    const All all(slashes, {});
    try
      {
        describe_parameter(print(), all.prm, what);
      }
    catch (const std::exception &error)
      {
        print() << message_of(error) << std::endl;
      }
  }
} // namespace



void
test_main()
{
  using Settings   = std::vector<std::string>;
  const auto order = [](const std::string &text, const Settings &settings) {
    return All(text, settings).grid.order;
  };
  check("a line", order(grid("Order = 3"), {}) == 3);
  check("the last line wins",
        order(grid("Order = 3") + grid("Order = 4"), {}) == 4);
  check("a setting wins", order(grid("Order = 3"), {"Grid/Order=4"}) == 4);
  check("a setting with spaces",
        order(grid("Order = 3"), {" Grid / Order = 4 "}) == 4);
  check("the last setting wins",
        order("", {"Grid/Order=4", "Grid/Order=5"}) == 5);
  check("inner sections", All(slashes, {}).inner.order == 3);
  check("a setting of an inner section",
        All(slashes, {"Body a/b/Grid/Order=5"}).inner.order == 5);
  {
    const All          all(grid("Order = 4"), {"Grid/Kind=two"});
    std::ostringstream text, reference;
    all.prm.print_parameters(text, ParameterHandler::Text);
    check("used parameters",
          text.str().find("set Order = 4") != std::string::npos &&
            text.str().find("set Kind  = two") != std::string::npos);
    print_parameter_reference(reference, "program", all.prm, "");
    check("the reference",
          reference.str().find("| Order | `2` |") != std::string::npos &&
            reference.str().find("| The order. |") != std::string::npos);
    const auto words = words_of_parameter(all.prm, "Grid/Kind");
    check("words", words == std::vector<std::string>({"one", "two"}));
    check("no words", words_of_parameter(all.prm, "Grid/Order").empty());
  }

  described("Grid");
  described("Grid/Order");
  described("Grid/Kind");
  described("Body a/b/Grid/Order");
  described("Gird");
  described("Gird/Order");
  described("Grid/Oder");
}
