// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/loads/dashpot.h>
#include <greville/loads/pressure.h>
#include <greville/loads/springs.h>
#include <greville/loads/traction.h>

namespace greville
{
  using namespace dealii;

  namespace
  {
    // All kinds of surface loads, one line each.
    std::vector<std::pair<std::string, MakeSurfaceLoadKind>> &
    kinds_of_loads()
    {
      static std::vector<std::pair<std::string, MakeSurfaceLoadKind>> list = {
        {Traction::name, make_kind<Traction>},
        {Pressure::name, make_kind<Pressure>},
        {Dashpot::name, make_kind<Dashpot>},
        {Springs::name, make_kind<Springs>},
        {GivenDisplacement::name, make_kind<GivenDisplacement>}};
      return list;
    }
  } // namespace



  void
  add_surface_load_kind(const std::string &name, const MakeSurfaceLoadKind make)
  {
    for (const auto &kind : kinds_of_loads())
      Require(kind.first != name,
              "A kind of surface load '" + name +
                "' exists already: choose another name.");
    kinds_of_loads().emplace_back(name, make);
  }



  std::string
  surface_load_kinds()
  {
    std::string result;
    for (const auto &kind : kinds_of_loads())
      result += (result.empty() ? "" : "|") + kind.first;
    return result;
  }



  std::unique_ptr<SurfaceLoadKind>
  make_surface_load_kind(const std::string &name, const std::string &parameter)
  {
    check_word(name, parameter, surface_load_kinds());
    for (const auto &[kind, make] : kinds_of_loads())
      if (kind == name)
        return make();
    AssertThrow(false, ExcInternalError());
    return {};
  }
} // namespace greville
