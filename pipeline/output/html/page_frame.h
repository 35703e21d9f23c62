#pragma once

#include <string>
#include <string_view>

namespace palpate::pipeline {

/// An HTML page from its doctype to the end of its head: it needs no file beside it. `title` is plain text.
std::string page_head(const std::string& title, std::string_view style);

/// Links to the headings <h2 id="..."> of `page`, in their order.
std::string section_links(const std::string& page);

}  // namespace palpate::pipeline
