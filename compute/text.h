// Text whose numbers do not follow the locale that a host has set: 0.5 and 1000, never 0,5 or 1.000. Everything with a number in it
// that Weft says or writes is put together here, or by std::to_chars; std::printf and plain streams follow the host.
#pragma once

#include <locale>
#include <sstream>
#include <string>

namespace weft {

class TextStream : public std::ostringstream {
 public:
  TextStream() {
    imbue(std::locale::classic());
    exceptions(badbit);   // else a text for which there is no memory is cut short, and nobody told
  }
};

/// `value` with so many significant digits at most, as printf's %g writes it.
inline std::string rounded_text(double value, int digits) {
  TextStream text;
  text.precision(digits);
  text << value;
  return text.str();
}

}  // namespace weft
