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
    struct KindOfLoad
    {
      std::string         name;
      MakeSurfaceLoadKind make;
    };

    template <typename Kind>
    KindOfLoad
    entry()
    {
      return {Kind::name, []() -> std::unique_ptr<SurfaceLoadKind> {
                return std::make_unique<Kind>();
              }};
    }

    // All kinds of surface loads, one line each.
    std::vector<KindOfLoad> &
    kinds_of_loads()
    {
      static std::vector<KindOfLoad> list = {entry<Traction>(),
                                             entry<Pressure>(),
                                             entry<Dashpot>(),
                                             entry<Springs>(),
                                             entry<GivenDisplacement>()};
      return list;
    }
  } // namespace



  void
  add_surface_load_kind(const std::string &name, const MakeSurfaceLoadKind make)
  {
    for (const KindOfLoad &kind : kinds_of_loads())
      Require(kind.name != name,
              "A kind of surface load '" + name +
                "' exists already: choose another name.");
    kinds_of_loads().push_back({name, make});
  }



  std::string
  surface_load_kinds()
  {
    std::string result;
    for (const KindOfLoad &kind : kinds_of_loads())
      result += (result.empty() ? "" : "|") + kind.name;
    return result;
  }



  std::unique_ptr<SurfaceLoadKind>
  make_surface_load_kind(const std::string &name, const std::string &parameter)
  {
    check_word(name, parameter, surface_load_kinds());
    for (const KindOfLoad &kind : kinds_of_loads())
      if (kind.name == name)
        return kind.make();
    AssertThrow(false, ExcInternalError());
    return {};
  }



  void
  check_is_given(const bool         is_given,
                 const std::string &section,
                 const std::string &kind,
                 const std::string &parameter)
  {
    Require(is_given,
            "'" + section + "' has 'Kind' = " + kind +
              " and needs the parameter '" + parameter + "'.");
  }
} // namespace greville
