// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/materials/umat_call.h>

#include <cstdio>
#include <cstring>

namespace greville
{
  namespace
  {
    std::uint64_t n_calls = 0;



    const UmatCall *
    call_under_way()
    {
      return dynamic_cast<const UmatCall *>(ForeignCall::under_way());
    }
  } // namespace



  UmatCall::UmatCall(const Law           &law,
                     const MaterialPoint *point,
                     const UmatMemory    &memory)
    : ForeignCall(law.time_limit)
    , law(law)
    , point(point)
    , memory(memory)
    , number(++n_calls)
  {}



  const char *
  UmatCall::text_of_limit() const
  {
    return "does not return within its 'Time limit'";
  }



  void
  UmatCall::write_message(char             *buffer,
                          const std::size_t size,
                          const char       *what) const
  {
    char where[200], third[40] = "";
    if (point == nullptr)
      std::snprintf(where,
                    sizeof(where),
                    "for the stiffness without an increment");
    else
      {
        if (point->dim == 3)
          std::snprintf(third, sizeof(third), ", %g", point->position[2]);
        std::snprintf(where,
                      sizeof(where),
                      "at (%g, %g%s), t = %g s, step %g s",
                      point->position[0],
                      point->position[1],
                      third,
                      point->time - point->dt,
                      point->dt);
      }
    std::snprintf(buffer,
                  size,
                  "the UMAT of '%s' %s (<%s>, call %llu %s)",
                  law.section.c_str(),
                  what,
                  law.library.c_str(),
                  static_cast<unsigned long long>(number),
                  where);
  }



  std::string
  UmatCall::message(const std::string &what)
  {
    const UmatCall *const call = call_under_way();
    if (call == nullptr)
      return "a UMAT " + what;
    std::string text(what.size() + call->law.section.size() +
                       call->law.library.size() + 400,
                     '\0');
    call->write_message(&text[0], text.size(), what.c_str());
    text.resize(std::strlen(text.c_str()));
    return text;
  }



  std::string
  UmatCall::caller()
  {
    const UmatCall *const call = call_under_way();
    return call == nullptr ? "a UMAT"
                           : "the UMAT of '" + call->law.section + "'";
  }
} // namespace greville
