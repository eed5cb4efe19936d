// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/exceptions.h>

#include <greville/base/foreign_call.h>
#include <greville/materials/material_point.h>
#include <greville/materials/umat_memory.h>

#include <string>

namespace greville
{
  /// A fault of a UMAT that a shorter step cannot remedy.
  class UmatFault : public dealii::ExcMessage
  {
  public:
    using dealii::ExcMessage::ExcMessage;
  };



  /// The call of a UMAT during its lifetime. It lets messages name the law and
  /// the point. A fault that ends the process does so between steps of all
  /// processes, so that all files are complete.
  class UmatCall : public ForeignCall
  {
  public:
    /// The section and the library of a law, and the time limit of a call, s,
    /// or 0 without a limit.
    struct Law
    {
      std::string section, library;
      double      time_limit = 0.;
    };

    /// Begin a call with the @p point at the end of the step, or with a null
    /// pointer for the stiffness without an increment. The arguments must
    /// outlive the object.
    UmatCall(const Law           &law,
             const MaterialPoint *point,
             const UmatMemory    &memory);

    /**
     * "the UMAT of 'Material sand' @p what (<soil.so>, call 7 at (0, 1), t =
     * 0.2 s, step 0.1 s)", for the current call; "a UMAT @p what" without one.
     */
    static std::string
    message(const std::string &what);

    /// Return "the UMAT of 'Material sand'".
    static std::string
    caller();

    /// Write the text of message() into a buffer.
    void
    write_message(char             *buffer,
                  const std::size_t size,
                  const char       *what) const override;

    bool
    is_beyond(const void *address) const override
    {
      return memory.is_beyond(address);
    }

    const char *
    text_of_limit() const override;

    const Law           &law;
    const MaterialPoint *point;
    const UmatMemory    &memory;
    /// The number of this call of a UMAT on its process.
    std::uint64_t number;
  };
} // namespace greville
