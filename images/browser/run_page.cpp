#include "images/browser/run_page.h"

#include <cmath>
#include "core/text/format.h"
#include "images/browser/content.h"

namespace photorque {
namespace {

using Json = nlohmann::ordered_json;

// The Content-Security-Policy forbids the page and its script to fetch anything.
std::string document_html(const std::string& title, const Provenance& provenance,
                          const std::string& script_policy, const std::string& body) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; " +
      script_policy + "; style-src 'unsafe-inline'; img-src data: blob:\">\n";
  html += "<title>" + xml_text(title) + "</title>\n";
  html += "<meta name=\"generator\" content=\"" + xml_text(provenance.one_line()) + "\">\n";
  html += "<style>\n";
  html += page_style();
  return html + "</style>\n</head>\n<body>\n" + body + "</body>\n</html>\n";
}

}  // namespace

Json packed_rounded(std::span<const double> numbers) {
  return packed(std::vector<float>(numbers.begin(), numbers.end()));
}

Json packed_coarse(std::span<const double> numbers, double low, double high) {
  constexpr double levels = 65534.0;
  const double step = high > low ? (high - low) / levels : 1.0;
  std::vector<uint16_t> coarse;
  coarse.reserve(numbers.size());
  for (const double number : numbers) {
    const double level = std::clamp(std::round((number - low) / step), 0.0, levels);
    coarse.push_back(std::isfinite(number) ? static_cast<uint16_t>(level) : uint16_t{65535});
  }
  Json json = packed(coarse);
  json["low"] = low;
  json["step"] = step;
  return json;
}

std::string script_text(const Json& json) {
  // In JSON these characters occur only within strings. U+2028 and U+2029 end lines of a script.
  std::string text;
  const std::string plain = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.reserve(plain.size());
  for (size_t i = 0; i < plain.size(); ++i) {
    const char c = plain[i];
    if (c == '<') {
      text += "\\u003c";
    } else if (c == '>') {
      text += "\\u003e";
    } else if (c == '&') {
      text += "\\u0026";
    } else if (plain.compare(i, 3, "\xE2\x80\xA8") == 0 ||
               plain.compare(i, 3, "\xE2\x80\xA9") == 0) {
      text += plain[i + 2] == '\xA8' ? "\\u2028" : "\\u2029";
      i += 2;
    } else {
      text += c;
    }
  }
  return text;
}

std::string page_html(const RunPage& page, const PageLimits& limits) {
  std::string body = page.text ? "<main>\n" + page.text->before + "<div id=\"page\"></div>\n" +
                                     page.text->after + "</main>\n"
                               : "<main id=\"page\"></main>\n";
  body +=
      "<noscript>This page needs JavaScript, which is switched off. summary.json and the other "
      "files beside it have the same results.</noscript>\n";
  body += "<script id=\"run\" type=\"application/json\">";
  const std::string content = script_text(page_content(page, limits));
  body += content;
  // The nonce is a hash of the content, which cannot contain its own hash: no script inside the
  // content can run. Equal runs give equal pages.
  const std::string nonce = content_hash(content);
  body += "</script>\n<script nonce=\"" + nonce + "\">\n";
  body += page_script();
  body += "</script>\n";
  return document_html(page.title + ": " + page.verb, page.provenance,
                       "script-src 'nonce-" + nonce + "'", body);
}

std::string text_page_html(const std::string& title, const Provenance& provenance,
                           const std::string& body) {
  return document_html(title, provenance, "script-src 'none'",
                       "<main class=\"text\">\n" + body + "</main>\n");
}

}  // namespace photorque
