// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <cmath>
#include <sstream>
#include <string>

namespace greville
{
  /**
   * A writer for a JSON object that contains objects, numbers and strings:
   *
   *   JsonWriter json;
   *   json.add("points", 100).begin("errors").add("l2", 0.1).end();
   *   json.text();
   *
   * Infinity and NaN, which JSON does not have, are written as null.
   */
  class JsonWriter
  {
  public:
    JsonWriter()
    {
      out.precision(12);
      out << '{';
    }

    JsonWriter &
    add(const std::string &name, const double value)
    {
      key(name);
      if (std::isfinite(value))
        out << value;
      else
        out << "null";
      return *this;
    }

    JsonWriter &
    add(const std::string &name, const std::string &value)
    {
      key(name);
      write(out, value);
      return *this;
    }

    JsonWriter &
    begin(const std::string &name)
    {
      key(name);
      out << '{';
      is_empty = true;
      ++depth;
      return *this;
    }

    JsonWriter &
    end()
    {
      --depth;
      out << '\n' << std::string(2 * depth, ' ') << '}';
      is_empty = false;
      return *this;
    }

    /// Return the object. Call this once, at the end.
    std::string
    text()
    {
      out << "\n}\n";
      return out.str();
    }

    /// Write a text in quotes, with its special letters escaped.
    static void
    write(std::ostream &out, const std::string &value)
    {
      static constexpr char digits[] = "0123456789abcdef";
      out << '"';
      for (const char c : value)
        if (c == '"' || c == '\\')
          out << '\\' << c;
        else if (static_cast<unsigned char>(c) < 0x20)
          out << "\\u00" << digits[c / 16] << digits[c % 16];
        else
          out << c;
      out << '"';
    }

  private:
    void
    key(const std::string &name)
    {
      out << (is_empty ? "\n" : ",\n") << std::string(2 * depth, ' ');
      write(out, name);
      out << ": ";
      is_empty = false;
    }

    std::ostringstream out;
    unsigned int       depth    = 1;
    bool               is_empty = true;
  };
} // namespace greville
