// How deep and how long a JSON text is, before anything of it is kept. Internal.
#pragma once

#include <string>
#include <string_view>

namespace weft::parts {

/// What is wrong with the outline of a text: brackets nested more than 64 deep (glTF itself needs about ten), or more than four million
/// values, of some hundred bytes of memory each. Empty: nothing.
std::string outline_fault(std::string_view text);

}  // namespace weft::parts
