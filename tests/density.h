// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <tests.h>

// Densities of the tests: constant, smooth with a ratio of 1:100, with holes.
template <int dim>
std::unique_ptr<Function<dim>>
density(const std::string &name)
{
  return make_function<dim>(name == "constant" ? "1"
                            : name == "smooth"
                              ? "exp(2.302585*sin(2*pi*x)*cos(2*pi*y))"
                              : "if(x<0.5,1+y,0)",
                            "Density");
}
