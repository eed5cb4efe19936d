// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_materials_umat_call_h
#define greville_materials_umat_call_h

#include <deal.II/base/exceptions.h>

#include <greville/base/foreign_call.h>
#include <greville/materials/material_point.h>
#include <greville/materials/umat_memory.h>

#include <string>

namespace greville
{
  /**
   * A fault of a UMAT that a shorter step does not mend.
   */
  class UmatFault : public dealii::ExcMessage
  {
  public:
    using dealii::ExcMessage::ExcMessage;
  };



  /**
   * Exists while a UMAT is called, and lets messages say which one and where. A
   * fault that ends the process does so between steps of all processes, so that
   * no file is half written.
   */
  class UmatCall : public ForeignCall
  {
  public:
    /// Of a law: its section and library, and the longest time of a call, s,
    /// or 0 if there is none.
    struct Law
    {
      std::string section, library;
      double      time_limit = 0.;
    };

    /**
     * A call with this @p point at the end of the step, or a null pointer if it
     * asks for the stiffness without an increment. All have to live as long.
     */
    UmatCall(const Law           &law,
             const MaterialPoint *point,
             const UmatMemory    &memory);

    /**
     * "the UMAT of 'Material sand' @p what (<soil.so>, call 7 at (0, 1), t =
     * 0.2 s, step 0.1 s)", of the call under way; "a UMAT @p what" without one.
     */
    static std::string
    message(const std::string &what);

    /**
     * "the UMAT of 'Material sand'".
     */
    static std::string
    caller();

    /**
     * The same as message().
     */
    void
    write_message(char             *buffer,
                  const std::size_t size,
                  const char       *what) const override;

    bool
    is_beyond(const void *address) const override;

    const char *
    text_of_limit() const override;

    const Law           &law;
    const MaterialPoint *point;
    const UmatMemory    &memory;
    /// The number of this call of a UMAT on its process.
    std::uint64_t number;
  };
} // namespace greville

#endif
