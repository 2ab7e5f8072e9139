// The script and the style of a page, put into the program when it is built.
#pragma once

#include <string_view>

namespace photorque {

// script/page.min.js: all that script/*.js and three.js make, bundled by tools/page_script.
std::string_view page_script();
// script/page.css.
std::string_view page_style();

}  // namespace photorque
