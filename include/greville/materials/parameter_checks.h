// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/exceptions.h>
#include <deal.II/base/patterns.h>
#include <deal.II/base/symmetric_tensor.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>

#include <sstream>
#include <string>

namespace greville
{
  /// A pattern for numbers greater than zero.
  inline dealii::Patterns::Double
  positive()
  {
    return dealii::Patterns::Double(1e-300);
  }



  /// Throw dealii::ExcMessage with the parameter, its value and the @p allowed
  /// values if not @p valid.
  inline void
  check_parameter(const bool         valid,
                  const std::string &section,
                  const std::string &name,
                  const double       value,
                  const std::string &allowed)
  {
    Require(valid,
            "The parameter '" + name + "' in section '" + section + "' is " +
              text_of(value) + "; it has to be " + allowed + ".");
  }



  /// Throw dealii::ExcMessage with the @p material, its Cauchy @p stress and
  /// the @p reason if not @p possible. The reason is a text, or a function that
  /// makes the text only if it is needed, since each point is checked.
  template <typename Reason>
  void
  check_stress(const bool                           possible,
               const char                          *material,
               const dealii::SymmetricTensor<2, 3> &stress,
               const Reason                        &reason)
  {
    if (possible)
      return;
    std::ostringstream text;
    text
      << "The material '" << material
      << "' cannot start with the Cauchy stress (xx, yy, zz, xy, xz, yz) = (";
    for (unsigned int i = 0; i < 6; ++i)
      text << (i == 0 ? "" : ", ") << stress.access_raw_entry(i) + 0.;
    text << ") Pa: ";
    if constexpr (std::is_invocable_v<Reason>)
      text << reason();
    else
      text << reason;
    text << ".";
    Require(false, text.str());
  }
} // namespace greville
