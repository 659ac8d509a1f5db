#pragma once
// The frame of every HTML report: one file, no network, a content security policy that allows exactly the
// page's own style and script by hash, light and dark, print, keyboard.

#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

struct HtmlPage {
  std::string title;         ///< plain text
  std::string body;          ///< HTML; every foreign text in it has passed figures::escape
  bool with_filter = false;  ///< carries the small script behind the filter row (html_filter_row)
};

/// The whole document. Without JavaScript nothing is missing but the filter row.
std::string html_document(const HtmlPage& page);

/// Hidden controls that the script shows: text filter, verdict choice, open all, close all. The script
/// filters elements <details class="case" data-v="VERDICT" data-t="lower-case text">.
std::string html_filter_row(const std::vector<std::string>& verdicts);

/// Base64 of the SHA-256 of `text`, as a policy wants it: "sha256-...".
std::string csp_hash(std::string_view text);

/// <figure> with a scroll box that the keyboard can reach, and a caption.
std::string html_figure(const std::string& svg, std::string_view label, std::string_view caption_html);

}  // namespace forcegate
