#include "pipeline/play/play_page.h"

#include <zlib.h>

#include <stdexcept>

#include "pipeline/output/base64.h"
#include "pipeline/output/html/page_frame.h"
#include "pipeline/play/page/page_parts.h"

namespace palpate::pipeline {
namespace {

/// As gzip packs it, without a time in it: the same text gives the same bytes.
std::string compressed(const std::string& text) {
    z_stream stream{};
    constexpr int gzip_window = 15 + 16;
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, gzip_window, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::runtime_error("zlib does not start");
    std::string bytes(deflateBound(&stream, text.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = static_cast<uInt>(bytes.size());
    const int end = deflate(&stream, Z_FINISH);
    bytes.resize(stream.total_out);
    deflateEnd(&stream);
    if (end != Z_STREAM_END) throw std::runtime_error("zlib does not pack the page's data");
    return bytes;
}

/// Data in the page, in gzip and base64.
std::string data_block(const std::string& id, const std::string_view base64) {
    return "<script id=\"" + id + "\" type=\"application/gzip\">" + std::string(base64) + "</script>\n";
}

}  // namespace

std::string play_page(const PlayData& data) {
    return page_head(data.name + ", interactive", play_style) + "<body>\n" + std::string(play_view) +
           data_block("play-data", base64(compressed(data.content.dump()))) + data_block("play-module", play_module) +
           "<script>" + std::string(play_script) + "</script></body></html>\n";
}

}  // namespace palpate::pipeline
