#include "images/browser/run_page.h"

#include "core/text/format.h"
#include "images/browser/content.h"
#include "images/browser/packed.h"
#include "images/browser/script.h"

namespace photorque {

std::string page_html(const RunPage& page, const PageLimits& limits) {
  // The policy forbids the page to fetch anything, whatever its script would try.
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:\">\n";
  html += "<title>" + xml_text(page.title) + ": " + xml_text(page.verb) + "</title>\n";
  html += "<meta name=\"generator\" content=\"" + xml_text(page.provenance.one_line()) + "\">\n";
  html += "<style>\n";
  html += page_style();
  html += "</style>\n</head>\n<body>\n<main id=\"page\"></main>\n";
  html +=
      "<noscript>This page draws itself with JavaScript, which is switched off. The same "
      "results stand in summary.json and the other files beside it.</noscript>\n";
  html += "<script id=\"run\" type=\"application/json\">";
  html += script_text(page_content(page, limits));
  html += "</script>\n<script>\n";
  html += page_script();
  html += "</script>\n</body>\n</html>\n";
  return html;
}

}  // namespace photorque
