// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks that a plugin of this build is loaded, and that a plugin is refused
// before it is loaded if its build is another or unknown, or if it is linked
// with another deal.II.

#include <greville/base/plugin.h>
#include <greville/base/shared_library.h>
#include <greville/materials/material.h>

#include "../tests.h"
#include <fstream>
#include <iterator>

std::string
content_of(const std::string &file)
{
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}



// Return the message of load_plugin() for the plugin sponge with another text
// in place of one of the same length, or an empty one if it is loaded.
std::string
message_with(const std::string &text, const std::string &other)
{
  std::string content = content_of(BUILD_DIR "/libraries/sponge.so");
  const auto  found   = content.find(text);
  check("the plugin has <" + text + ">", found != std::string::npos);
  content.replace(found, other.size(), other);
  std::ofstream("other.so", std::ios::binary) << content;
  try
    {
      load_plugin("other.so", "Simulation/Additional shared libraries");
      return "";
    }
  catch (const std::exception &error)
    {
      return message_of(error);
    }
}



void
test_main()
{
  const std::string build = GREVILLE_BUILD, mark = GREVILLE_PLUGIN_MARK;
  const auto        has = [](const std::string &text, const std::string &part) {
    check("<" + part + "> is in <" + text + ">",
          text.find(part) != std::string::npos);
  };

  std::string newer = build;
  newer[newer.find('.') - 1]++;
  const std::string of_another_build = message_with(mark + build, mark + newer);
  has(of_another_build,
      "'Simulation/Additional shared libraries' is <other.so>");
  has(of_another_build, "was compiled for another build, <" + newer + ">");
  has(of_another_build, "This program is <" + build + ">");
  has(of_another_build, "-DCMAKE_BUILD_TYPE=");

  const std::string without = message_with(mark, std::string(mark.size(), ' '));
  has(without, "'Simulation/Additional shared libraries' is <other.so>");
  has(without, "does not say for which build it was compiled");
  has(without, "GREVILLE_PLUGIN");
  has(without, "-DCMAKE_BUILD_TYPE=");

  const std::string of_another_deal_ii =
    message_with(std::string("\0libdeal", 8), std::string("\0libdeal~", 9));
  has(of_another_deal_ii,
      "'Simulation/Additional shared libraries' is <other.so>");
  has(of_another_deal_ii, "which is linked with <libdeal~");
  has(of_another_deal_ii, ">. This program has <libdeal");

  const auto has_sponge = [] {
    return material_names().find("sponge") != std::string::npos;
  };
  check("a plugin that is refused adds nothing", !has_sponge());
  check("this build is loaded", message_with(build, build).empty());
  check("the plugin adds its law", has_sponge());
}
