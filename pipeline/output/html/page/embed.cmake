# Writes OUT, a source file that defines NAME in palpate::pipeline as the text of FILES (a comma-separated list), one
# after the other.  cmake -DOUT=... -DNAME=... -DFILES=... -P embed.cmake
string(REPLACE "," ";" files "${FILES}")
set(text "")
foreach(file IN LISTS files)
  file(READ "${file}" part)
  string(APPEND text "${part}")
endforeach()
file(WRITE "${OUT}.new" "// Made from ${FILES}.
#include <string_view>
#ifdef __clang__
#pragma clang diagnostic ignored \"-Woverlength-strings\"
#endif
namespace palpate::pipeline {
extern const std::string_view ${NAME};
const std::string_view ${NAME} = R\"palpate(${text})palpate\";
}
")
file(RENAME "${OUT}.new" "${OUT}")
