#include "pipeline/output/html/page_frame.h"

#include "pipeline/output/html/escape.h"

namespace palpate::pipeline {

std::string page_head(const std::string& title, const std::string_view style) {
    return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
           "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
           "<meta name=\"generator\" content=\"palpate\"><link rel=\"icon\" href=\"data:,\"><title>" +
           escape(title) + "</title><style>" + std::string(style) + "</style></head>";
}

std::string section_links(const std::string& page) {
    std::string html = "<nav aria-label=\"Sections\">";
    for (std::size_t at = page.find("<h2 id=\""); at != std::string::npos; at = page.find("<h2 id=\"", at + 1)) {
        const std::size_t id = at + 8, id_end = page.find('"', id), end = page.find("</h2>", id_end);
        html +=
            "<a href=\"#" + page.substr(id, id_end - id) + "\">" + page.substr(id_end + 2, end - id_end - 2) + "</a>";
    }
    return html + "</nav>";
}

}  // namespace palpate::pipeline
