// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_base_eigenvectors_h
#define greville_base_eigenvectors_h

#include <deal.II/base/symmetric_tensor.h>

/**
 * dealii::eigenvectors(), whose symbol clang names otherwise than g++: a library
 * of deal.II that g++ has built lacks it, so that clang compiles it again.
 */
#ifdef __clang__
#  include <deal.II/base/symmetric_tensor.templates.h>
#endif

#endif
