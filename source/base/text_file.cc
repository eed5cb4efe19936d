// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/text_file.h>

#include <boost/locale/utf.hpp>
#include <filesystem>

namespace greville
{
  using namespace dealii;

  std::ifstream
  open_text_file(const std::string &file, const std::string &what)
  {
    std::error_code error;
    const auto      type = std::filesystem::status(file, error).type();
    Require(type != std::filesystem::file_type::directory,
            what + ": it is a folder.");
    Require(type != std::filesystem::file_type::character &&
              type != std::filesystem::file_type::block,
            what + ": it is a device, not a file.");
    return std::ifstream(file);
  }



  bool
  read_text_line(std::istream &stream, std::string &line, unsigned int &number)
  {
    if (!std::getline(stream, line))
      return false;
    const std::string mark = "\xEF\xBB\xBF";
    if (number++ == 0 && line.compare(0, mark.size(), mark) == 0)
      line.erase(0, mark.size());
    return true;
  }



  void
  check_utf8(const std::string &text, const std::string &place)
  {
    using Utf = boost::locale::utf::utf_traits<char>;
    for (auto at = text.begin(); at != text.end();)
      {
        const auto begin  = at;
        const auto letter = Utf::decode(at, text.end());
        Require(letter != boost::locale::utf::illegal &&
                  letter != boost::locale::utf::incomplete && letter != 0,
                place + ": what follows <" + std::string(text.begin(), begin) +
                  "> is not UTF-8 (the byte " +
                  std::to_string(static_cast<unsigned char>(*begin)) +
                  "). Save the file in the encoding UTF-8.");
      }
  }
} // namespace greville
