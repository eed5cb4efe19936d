// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_simulation_comparison_parameters_h
#define greville_simulation_comparison_parameters_h

#include <deal.II/base/parameter_handler.h>

#include <string>

namespace greville
{
  /**
   * Exact solutions to compare with.
   */
  struct ExactParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string displacement;
    std::string velocity;
    std::string stress;
  };



  /**
   * Measured data to compare with.
   */
  struct ReferenceParameters
  {
    void
    declare(dealii::ParameterHandler &prm);

    std::string surface_file;
    std::string failure_line_file;
    double      failure_displacement = 0.002;
    std::string series_file;
    std::string series_quantity = "front";
    double      time_unit       = 1.;
    double      value_unit      = 1.;
  };
} // namespace greville

#endif
