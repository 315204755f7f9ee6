# cmake -DOUTPUT=file.cpp -DSHADERS="name=file.spv;..." -P embed.cmake
# Turns compiled shaders into one C++ source with an array each and the function that finds them by name.
set(arrays "")
set(cases "")
set(index 0)
foreach(entry IN LISTS SHADERS)
  string(REGEX MATCH "^([^=]+)=(.+)$" _ "${entry}")
  set(name "${CMAKE_MATCH_1}")
  file(READ "${CMAKE_MATCH_2}" bytes HEX)
  # Little-endian words.
  string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
  string(APPEND arrays "constexpr std::uint32_t kShader${index}[] = {${words}};\n")
  string(APPEND cases "  if (name == \"${name}\") return kShader${index};\n")
  math(EXPR index "${index} + 1")
endforeach()
file(WRITE "${OUTPUT}.tmp" "#include \"shaders/embedded.h\"\n\nnamespace weft {\nnamespace {\n${arrays}}  // namespace\n
std::span<const std::uint32_t> shader(std::string_view name) {\n${cases}  return {};\n}\n\n}  // namespace weft\n")
file(RENAME "${OUTPUT}.tmp" "${OUTPUT}")
