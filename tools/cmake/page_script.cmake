# Writes a source file OUTPUT with the script and the style of HTML pages in FOLDER.
file(READ ${FOLDER}/page.min.js script)
file(READ ${FOLDER}/page.css style)
foreach(text IN ITEMS "${script}" "${style}")
  string(FIND "${text}" ")photorque\"" end)
  if(NOT end EQUAL -1)
    message(FATAL_ERROR "page.min.js or page.css holds what ends a raw string")
  endif()
endforeach()
file(WRITE ${OUTPUT} "// Generated from images/browser/script by tools/cmake/page_script.cmake.
#include \"images/browser/content.h\"

namespace photorque {

std::string_view page_script() {
  return R\"photorque(${script})photorque\";
}

std::string_view page_style() {
  return R\"photorque(${style})photorque\";
}

}  // namespace photorque
")
