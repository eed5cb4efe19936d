// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/config.h>

/// The version in CMakeLists.txt; source/base/program.cc compares both.
#define GREVILLE_PLUGIN_VERSION "1.1.0"

#define GREVILLE_QUOTE_(x) #x
#define GREVILLE_QUOTE(x) GREVILLE_QUOTE_(x)

#ifdef __clang__
#  define GREVILLE_COMPILER "clang " GREVILLE_QUOTE(__clang_major__)
#else
#  define GREVILLE_COMPILER "g++ " GREVILLE_QUOTE(__GNUC__)
#endif

// A program cannot contain both libraries of deal.II.
#ifdef DEBUG
#  define GREVILLE_BUILD_TYPE "Debug"
#else
#  define GREVILLE_BUILD_TYPE "Release"
#endif

#ifdef DEAL_II_WITH_64BIT_INDICES
#  define GREVILLE_INDICES "64-bit indices"
#else
#  define GREVILLE_INDICES "32-bit indices"
#endif

/// A string literal with everything on which the layout of classes in the
/// headers depends: it must be the same in a plugin and the program. The number
/// of bytes is the width of the widest vector of the instruction set
/// (base/simd.h).
#define GREVILLE_BUILD                                                     \
  "Greville " GREVILLE_PLUGIN_VERSION ", deal.II " DEAL_II_PACKAGE_VERSION \
  " " GREVILLE_BUILD_TYPE " with " GREVILLE_INDICES ", " GREVILLE_COMPILER \
  ", vectors of " GREVILLE_QUOTE(__BIGGEST_ALIGNMENT__) " bytes"

/// The text before GREVILLE_BUILD in the file of a plugin.
#define GREVILLE_PLUGIN_MARK "greville plugin: "

/**
 * The head of the function of a plugin that adds its parts, once in a plugin:
 * @code
 *   GREVILLE_PLUGIN
 *   {
 *     add_material<MyLaw>();
 *   }
 * @endcode
 * It records the build for which the plugin was compiled.
 */
#define GREVILLE_PLUGIN                                  \
  extern "C"                                             \
  {                                                      \
    extern const char                greville_plugin[];  \
    __attribute__((used)) const char greville_plugin[] = \
      GREVILLE_PLUGIN_MARK           GREVILLE_BUILD;     \
    void                                                 \
    register_in_greville();                              \
  }                                                      \
  void register_in_greville()
